//! Forward dynamics of a robot's leg, (4): six revolute joints in a chain, on a pelvis that stands still.
//!
//! q'' = M(q)^-1 (tau - H(q, q')): the bias H by the recursive Newton-Euler method, M by that of composite bodies, then
//! M = L' D L from the foot upwards (Featherstone, Rigid Body Dynamics Algorithms, chapters 5, 6 and 8). With six
//! joints this is less work than the articulated-body method.
//!
//! Three choices make it cheap; `frames` computes the constants once, in double precision.
//! - The z axis of a link's frame is its joint's axis, and all constant turns about z go into the angles: from a link
//!   to the next there is a lever, a twist about x, and the joint's turn about z. In legs, neighbouring axes are
//!   parallel or at right angles, and a right twist only renames coordinates.
//! - Mass on a joint's axis may as well belong to the link before. Moved there (the base parameters of Gautier and
//!   Khalil), it leaves the links without mass, first moment along z, and second moment zz.
//! - Inertia is the second moments J = int r r' dm. With the spin U = `[w']x + [w]x [w]x` of a link and the
//!   acceleration a of its origin, its points accelerate by a + U r: its force is U h, its moment h x a + int r x U r
//!   dm.

mod dynamics;
mod frames;
mod link;
mod parameters;
mod uniforms;

pub use dynamics::forward_dynamics;
pub use parameters::{LEG_JOINTS, LegJoint, LegModel};
pub use uniforms::LegUniforms;
