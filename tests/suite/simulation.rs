//! Groups of agents in one episode, and batch by batch: early stop, lost devices, attenuation of episodes.

mod attenuation;
mod groups;
mod lost_gpu;
mod stop;
