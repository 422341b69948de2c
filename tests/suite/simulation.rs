//! Batch by batch: early stop, lost devices, attenuation of episodes.

mod attenuation;
mod lost_gpu;
mod stop;
