//! The trajectory to follow: paths of UAVs, walks of robots.

mod path;
mod walk;
