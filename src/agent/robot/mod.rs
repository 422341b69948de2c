//! The biped: two legs of six revolute joints each on a pelvis (paper, section II-B; the upper body is part of the
//! pelvis).
//!
//! ```text
//! table (.toml) | urdf (.urdf) -> Robot -> kinematics -> dynamics -> wrench
//! ```
//!
//! A [`Robot`] is made only by its readers, which refuse what is no robot; nothing after them checks it again. Frames
//! follow URDF: a link's frame is its joint's frame, and the pelvis frame has x forward, y to the left and z up. Joint
//! vectors hold the left leg in 0..6 and the right leg in 6..12, each from the hip to the ankle.

mod check;
pub mod dynamics;
mod error;
pub mod inverse;
pub mod kinematics;
mod load;
mod standing;
mod structure;
pub mod table;
pub mod urdf;
pub mod wrench;

pub use error::RobotError;
pub(crate) use load::{G1, G1_PATH, is_urdf};
pub use structure::{Body, Foot, JOINTS, Joint, LEFT, LEG_JOINTS, Leg, RIGHT, Robot};
pub use urdf::{Soles, Standing, UrdfOptions};
