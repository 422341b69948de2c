//! A leg: as its robot's description has it, and as the loop has it.

use nalgebra::{Matrix3, Rotation3, Vector3};

/// Joints of a leg.
pub const LEG_JOINTS: usize = 6;

/// A joint and the link that it carries, in the frames of the robot's description.
#[derive(Debug, Clone, PartialEq)]
pub struct LegJoint {
    /// Orientation of the link's frame in that of the link before (of the pelvis, for the first) at q = 0.
    pub rotation: Rotation3<f64>,
    /// Origin of the link's frame in that of the link before, m.
    pub translation_m: Vector3<f64>,
    /// Axis of the joint in the link's frame, of any length but zero.
    pub axis: Vector3<f64>,
    /// Mass of the link, kg.
    pub mass_kg: f64,
    /// Centre of mass in the link's frame, m.
    pub com_m: Vector3<f64>,
    /// Inertia about the centre of mass in the link's frame, kg m^2.
    pub inertia_kg_m2: Matrix3<f64>,
    /// What the rotor adds to the diagonal of M, kg m^2.
    pub armature_kg_m2: f64,
    /// Viscous damping of the joint, N m s/rad.
    pub damping_n_m_s: f64,
}

impl From<&crate::agent::robot::Joint> for LegJoint {
    fn from(joint: &crate::agent::robot::Joint) -> Self {
        Self {
            rotation: joint.placement.rotation.to_rotation_matrix(),
            translation_m: joint.placement.translation.vector,
            axis: joint.axis.into_inner(),
            mass_kg: joint.body.mass_kg,
            com_m: joint.body.com_m,
            inertia_kg_m2: joint.body.inertia_kg_m2,
            armature_kg_m2: joint.armature_kg_m2,
            damping_n_m_s: joint.damping_n_m_s,
        }
    }
}

/// A leg in the precision of the loop.
#[derive(Debug, Clone, Copy)]
pub struct LegModel<R> {
    pub(crate) joints: [Joint<R>; LEG_JOINTS],
    /// Acceleration of the resting pelvis, against gravity: across and along the first axis.
    pub(crate) lift: [R; 2],
    /// 1 / the last entry of M, which is constant.
    pub(crate) tip_inverse: R,
    pub(crate) build: Build,
}

/// Constants of a joint and its link.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Joint<R> {
    /// What is added to q.
    pub(crate) offset: R,
    /// Armature.
    pub(crate) armature: R,
    /// Damping.
    pub(crate) damping: R,
    /// Sine and cosine of the twist.
    pub(crate) twist: [R; 2],
    /// Origin in the frame before.
    pub(crate) lever: [R; 3],
    /// Twice the lever.
    pub(crate) lever_twice: [R; 3],
    /// First moments x, y.
    pub(crate) first: [R; 2],
    /// Second moments xx, yy, xy, xz, yz.
    pub(crate) second: [R; 5],
}

/// How an axis lies to the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Twist {
    /// Parallel, with the lever along x.
    Parallel,
    /// At a right angle, with no lever along y.
    Right,
    /// Neither.
    Any,
}

/// Which kind of leg it is: the loop is compiled for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Build {
    /// Hip pitch at the pelvis: the axes of knee and ankle pitch are parallel, all others at right angles.
    PitchFirst,
    /// Hip pitch next to the knee: the three pitch axes are parallel, all others at right angles.
    PitchLast,
    /// Anything else.
    Any,
}

impl Build {
    /// The twist of each joint; that of the first is of no account.
    pub(crate) const fn twists(self) -> [Twist; LEG_JOINTS] {
        use Twist::{Any, Parallel, Right};
        match self {
            Self::PitchFirst => [Right, Right, Right, Right, Parallel, Right],
            Self::PitchLast => [Right, Right, Right, Parallel, Parallel, Right],
            Self::Any => [Any; LEG_JOINTS],
        }
    }
}
