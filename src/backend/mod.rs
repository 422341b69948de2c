//! Where episodes are flown: draws in, outcomes out.

pub mod cpu;
