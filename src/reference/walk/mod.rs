//! Joint reference of a walking biped (paper, section III-B).
//!
//! ```text
//! waypoints -> course -> feet -> zmp -> com -> kinematics -> joint splines; ground
//! ```
//!
//! 1. *Course*: waypoints, linear and then cubic smoothing, heading.
//! 2. *Feet*: footholds on both sides of the course, a step apart, and swings between them.
//! 3. *Zero moment point*: under the stance foot, shifting while both feet stand.
//! 4. *Centre of mass*: an LQ tracker on the linear inverted pendulum, (6) and (7).
//! 5. *Kinematics*: joint angles at every sample, by Newton's method.
//! 6. *Splines*: one per joint, so that r' and r'' are the exact derivatives of r.
//!
//! Every stage is a function of the values before it; a [`Walk`] keeps them all.

pub mod com;
pub mod course;
mod error;
pub mod feet;
mod foot;
mod gait;
pub mod ground;
pub mod kinematics;
mod nearest;
mod plan;
mod samples;
pub mod spline;
pub mod zmp;

pub use course::{Course, Placement};
pub use error::WalkError;
pub use feet::{Ankle, Feet, Foothold, Swing};
pub use foot::Foot;
pub use gait::Gait;
pub use ground::{GroundReaction, ground_reaction};
pub use nearest::nearest;
pub use plan::Walk;
pub use spline::Spline;
pub use zmp::ZmpReference;
