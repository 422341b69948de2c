//! Dynamics (4) of one leg on a fixed pelvis, M(q) q'' + H(q, q') = tau, in f64.
//!
//! The algorithms are those of R. Featherstone, Rigid Body Dynamics Algorithms, Springer 2008: the recursive
//! Newton-Euler algorithm (section 5.3) and the composite-rigid-body algorithm (section 6.2), with all vectors in the
//! pelvis frame and each body's motion taken at the origin of its link. The rotor of each joint adds its armature to
//! the diagonal of M.

use super::kinematics::{LegPose, leg_pose};
use super::structure::{LEG_JOINTS, Leg};
use nalgebra::{Cholesky, Matrix6, Vector3, Vector6};

/// Mass matrix M(q) with the armature on its diagonal, kg m^2; symmetric and positive definite.
#[must_use]
pub fn mass_matrix(leg: &Leg, q_rad: &Vector6<f64>) -> Matrix6<f64> {
    let pose = leg_pose(leg, q_rad);
    let mut composite = pose.bodies();
    for i in (1..LEG_JOINTS).rev() {
        composite[i - 1] = composite[i - 1].joined(&composite[i]);
    }
    let mut mass = Matrix6::zeros();
    for (j, body) in composite.iter().enumerate() {
        // Momentum of everything beyond joint j at unit rate of that joint, the angular one about its centre of mass.
        let linear = body.mass_kg * pose.axes[j].cross(&(body.com_m - pose.origins_m[j]));
        let angular = body.inertia_kg_m2 * pose.axes[j];
        for i in 0..=j {
            let about_joint = angular + (body.com_m - pose.origins_m[i]).cross(&linear);
            mass[(i, j)] = pose.axes[i].dot(&about_joint);
            mass[(j, i)] = mass[(i, j)];
        }
        mass[(j, j)] += leg.joints[j].armature_kg_m2;
    }
    mass
}

/// Non-inertial force H(q, q') = C q' + G, with the joints' damping if they have any, N m.
#[must_use]
pub fn bias_force(
    leg: &Leg,
    gravity_m_s2: &Vector3<f64>,
    q_rad: &Vector6<f64>,
    rate_rad_s: &Vector6<f64>,
) -> Vector6<f64> {
    inverse_dynamics(leg, gravity_m_s2, q_rad, rate_rad_s, &Vector6::zeros())
}

/// Torque that holds the leg against gravity, G(q), N m.
#[must_use]
pub fn gravity_torque(
    leg: &Leg,
    gravity_m_s2: &Vector3<f64>,
    q_rad: &Vector6<f64>,
) -> Vector6<f64> {
    bias_force(leg, gravity_m_s2, q_rad, &Vector6::zeros())
}

/// Torque for the accelerations `acceleration_rad_s2`, N m.
#[must_use]
pub fn inverse_dynamics(
    leg: &Leg,
    gravity_m_s2: &Vector3<f64>,
    q_rad: &Vector6<f64>,
    rate_rad_s: &Vector6<f64>,
    acceleration_rad_s2: &Vector6<f64>,
) -> Vector6<f64> {
    let fixed = BaseMotion::fixed(gravity_m_s2);
    let pose = leg_pose(leg, q_rad);
    newton_euler(&pose, &fixed, rate_rad_s, acceleration_rad_s2).torque_n_m
}

/// Accelerations under the torques `torque_n_m`, rad/s^2; not a number if M(q) is not positive definite in f64.
#[must_use]
pub fn forward_dynamics(
    leg: &Leg,
    gravity_m_s2: &Vector3<f64>,
    q_rad: &Vector6<f64>,
    rate_rad_s: &Vector6<f64>,
    torque_n_m: &Vector6<f64>,
) -> Vector6<f64> {
    let accelerating = torque_n_m - bias_force(leg, gravity_m_s2, q_rad, rate_rad_s);
    Cholesky::new(mass_matrix(leg, q_rad)).map_or(Vector6::repeat(f64::NAN), |factor| {
        factor.solve(&accelerating)
    })
}

/// Motion of the pelvis, in its own axes.
pub(super) struct BaseMotion {
    /// rad/s
    pub angular_velocity: Vector3<f64>,
    /// rad/s^2
    pub angular_acceleration: Vector3<f64>,
    /// Acceleration of the frame's origin less gravity, m/s^2.
    pub acceleration: Vector3<f64>,
}

impl BaseMotion {
    fn fixed(gravity_m_s2: &Vector3<f64>) -> Self {
        Self {
            angular_velocity: Vector3::zeros(),
            angular_acceleration: Vector3::zeros(),
            acceleration: -gravity_m_s2,
        }
    }
}

/// What moves a leg.
pub(super) struct LegForces {
    /// Torque of each joint.
    pub torque_n_m: Vector6<f64>,
    /// Force of the pelvis on the leg.
    pub force_n: Vector3<f64>,
    /// Moment of the pelvis on the leg about the pelvis frame's origin.
    pub moment_n_m: Vector3<f64>,
}

/// The recursive Newton-Euler algorithm: motion outwards, forces inwards.
pub(super) fn newton_euler(
    pose: &LegPose<'_>,
    base: &BaseMotion,
    rates: &Vector6<f64>,
    accelerations: &Vector6<f64>,
) -> LegForces {
    let bodies = pose.bodies();
    let mut forces = [(Vector3::zeros(), Vector3::zeros()); LEG_JOINTS];
    let mut omega = base.angular_velocity;
    let mut alpha = base.angular_acceleration;
    let mut acceleration = base.acceleration;
    let mut origin = Vector3::zeros();
    for i in 0..LEG_JOINTS {
        let (axis, body) = (pose.axes[i], &bodies[i]);
        acceleration += carried(&omega, &alpha, &(pose.origins_m[i] - origin));
        origin = pose.origins_m[i];
        alpha += axis * accelerations[i] + omega.cross(&axis) * rates[i];
        omega += axis * rates[i];
        let of_com = acceleration + carried(&omega, &alpha, &(body.com_m - origin));
        let spin = body.inertia_kg_m2 * omega;
        forces[i] = (
            body.mass_kg * of_com,
            body.inertia_kg_m2 * alpha + omega.cross(&spin),
        );
    }
    let mut torque = Vector6::zeros();
    // Force on everything from link i on, and its moment about the origin of link i.
    let (mut force, mut moment, mut about) = (Vector3::zeros(), Vector3::zeros(), origin);
    for i in (0..LEG_JOINTS).rev() {
        let (own_force, own_moment) = forces[i];
        moment += (about - pose.origins_m[i]).cross(&force);
        about = pose.origins_m[i];
        moment += own_moment + (bodies[i].com_m - about).cross(&own_force);
        force += own_force;
        let joint = &pose.leg.joints[i];
        torque[i] = pose.axes[i].dot(&moment)
            + joint.armature_kg_m2 * accelerations[i]
            + joint.damping_n_m_s * rates[i];
    }
    LegForces {
        torque_n_m: torque,
        force_n: force,
        moment_n_m: moment + about.cross(&force),
    }
}

/// Acceleration of a point of a rigid body relative to the point from which `arm` leads to it.
pub(super) fn carried(
    omega: &Vector3<f64>,
    alpha: &Vector3<f64>,
    arm: &Vector3<f64>,
) -> Vector3<f64> {
    alpha.cross(arm) + omega.cross(&omega.cross(arm))
}
