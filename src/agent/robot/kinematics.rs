//! Where the links of a leg are, in the pelvis frame.

use super::structure::{Body, JOINTS, LEG_JOINTS, Leg, Robot};
use nalgebra::{Isometry3, Matrix3, Matrix6, Rotation3, Vector3, Vector6};

/// A leg at some joint angles. Everything is in the pelvis frame, link i being the one that joint i moves.
#[derive(Debug, Clone)]
pub struct LegPose<'a> {
    pub(super) leg: &'a Leg,
    /// Axes of each link's frame, as columns.
    pub rotations: [Matrix3<f64>; LEG_JOINTS],
    /// Origin of each link's frame, m; it lies on the joint's axis.
    pub origins_m: [Vector3<f64>; LEG_JOINTS],
    /// Unit vector along each joint's axis.
    pub axes: [Vector3<f64>; LEG_JOINTS],
}

/// The joint angles (or rates, torques, ..) of the left and of the right leg.
#[must_use]
pub fn by_leg(joints: &[f64; JOINTS]) -> [Vector6<f64>; 2] {
    let (left, right) = joints.split_at(LEG_JOINTS);
    [left, right].map(Vector6::from_column_slice)
}

/// The inverse of [`by_leg`].
#[must_use]
pub fn joined([left, right]: &[Vector6<f64>; 2]) -> [f64; JOINTS] {
    std::array::from_fn(|i| {
        if i < LEG_JOINTS {
            left[i]
        } else {
            right[i - LEG_JOINTS]
        }
    })
}

/// A leg at the joint angles `q_rad`.
#[must_use]
pub fn leg_pose<'a>(leg: &'a Leg, q_rad: &Vector6<f64>) -> LegPose<'a> {
    let mut pose = LegPose {
        leg,
        rotations: [Matrix3::identity(); LEG_JOINTS],
        origins_m: [Vector3::zeros(); LEG_JOINTS],
        axes: [Vector3::zeros(); LEG_JOINTS],
    };
    let (mut rotation, mut origin) = (Matrix3::identity(), Vector3::zeros());
    for (i, joint) in leg.joints.iter().enumerate() {
        origin += rotation * joint.placement.translation.vector;
        let at_zero = rotation * joint.placement.rotation.to_rotation_matrix().matrix();
        rotation = at_zero * Rotation3::from_axis_angle(&joint.axis, q_rad[i]).matrix();
        pose.rotations[i] = rotation;
        pose.origins_m[i] = origin;
        pose.axes[i] = at_zero * joint.axis.as_ref();
    }
    pose
}

impl LegPose<'_> {
    /// The frame of link i.
    #[must_use]
    pub fn link(&self, i: usize) -> Isometry3<f64> {
        isometry(self.rotations[i], self.origins_m[i])
    }

    /// Origin of the ankle frame, m.
    #[must_use]
    pub fn ankle_m(&self) -> Vector3<f64> {
        let last = LEG_JOINTS - 1;
        self.origins_m[last] + self.rotations[last] * self.leg.foot.ankle_offset_m
    }

    /// The ankle frame; its axes are the last link's.
    #[must_use]
    pub fn ankle(&self) -> Isometry3<f64> {
        isometry(self.rotations[LEG_JOINTS - 1], self.ankle_m())
    }

    /// The sole's frame.
    #[must_use]
    pub fn sole(&self) -> Isometry3<f64> {
        self.link(LEG_JOINTS - 1) * self.leg.foot.sole
    }

    /// Geometric Jacobian of the ankle frame: velocity of its origin (rows 0..3) and angular velocity (rows 3..6) over
    /// the joint rates.
    #[must_use]
    pub fn jacobian(&self) -> Matrix6<f64> {
        let ankle = self.ankle_m();
        let mut jacobian = Matrix6::zeros();
        for (i, (axis, origin)) in self.axes.iter().zip(&self.origins_m).enumerate() {
            let velocity = axis.cross(&(ankle - origin));
            jacobian.fixed_view_mut::<3, 1>(0, i).copy_from(&velocity);
            jacobian.fixed_view_mut::<3, 1>(3, i).copy_from(axis);
        }
        jacobian
    }

    /// The links as bodies.
    #[must_use]
    pub fn bodies(&self) -> [Body; LEG_JOINTS] {
        std::array::from_fn(|i| {
            let body = &self.leg.joints[i].body;
            body.moved(&self.rotations[i], &self.origins_m[i])
        })
    }
}

/// Centre of mass of the whole robot in the pelvis frame, m.
#[must_use]
pub fn com_m(robot: &Robot, q_rad: &[f64; JOINTS]) -> Vector3<f64> {
    let [left, right] = by_leg(q_rad);
    let poses = [
        leg_pose(&robot.legs[0], &left),
        leg_pose(&robot.legs[1], &right),
    ];
    let links = poses.iter().flat_map(LegPose::bodies);
    links
        .fold(robot.base, |whole, link| whole.joined(&link))
        .com_m
}

fn isometry(rotation: Matrix3<f64>, origin_m: Vector3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(
        origin_m.into(),
        Rotation3::from_matrix_unchecked(rotation).into(),
    )
}
