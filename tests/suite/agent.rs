//! What flies or walks: robots' files and dynamics.

mod robot;
