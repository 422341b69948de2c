//! The UAV of (3) in groups of channels that act on each other.
//!
//! Fully actuated, the channels of an axis of translation form a group, and the three of attitude another; with thrust
//! along the body axis all six hang together. The coupling (10) works channel by channel, so groups never meet; rotor
//! vortices depend on distances, and put the three axes into one group.

#![expect(
    clippy::needless_range_loop,
    reason = "a channel is one index of several arrays, as in the shaders"
)]

use super::{Inputs, Plant, ReferenceRow, Response, splat_row, tabulated};
use crate::agent::{HEIGHT, Uav};
use crate::model::lanes::math::clamp;
use crate::model::lanes::{Lane, Real};

/// Modelled inertia of each channel.
#[must_use]
pub fn inertia(uav: &Uav) -> [f64; 6] {
    let [jx, jy, jz] = uav.inertia_kg_m2;
    [uav.mass_kg, uav.mass_kg, uav.mass_kg, jx, jy, jz]
}

/// H(r, r') of (8) with the modelled parameters, gravity acting downwards.
#[must_use]
pub fn non_inertial(uav: &Uav, rate: [f64; 6]) -> [f64; 6] {
    let [jx, jy, jz] = uav.inertia_kg_m2;
    let [vx, vy, vz, p, q, s] = rate;
    let (drag, angular) = (uav.drag_n_s_m, uav.angular_drag_n_m_s);
    [
        drag * vx,
        drag * vy,
        drag * vz + uav.mass_kg * uav.gravity_m_s2,
        q * s * (jz - jy) + angular * p,
        s * p * (jx - jz) + angular * q,
        p * q * (jy - jx) + angular * s,
    ]
}

/// One axis of translation, fully actuated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis<R> {
    pub(crate) mass: R,
    pub(crate) drag: R,
    pub(crate) gravity: R,
}

impl<R: Real> Axis<R> {
    /// The axis x, y or z (0, 1, 2).
    pub(crate) fn new(uav: &Uav, axis: usize) -> Self {
        Self {
            mass: R::from_f64(uav.mass_kg),
            drag: R::from_f64(uav.drag_n_s_m),
            gravity: R::from_f64(if axis == HEIGHT {
                uav.gravity_m_s2
            } else {
                0.0
            }),
        }
    }

    /// x'' - r'' of this axis, which is channel `c` of its group, the command that is demanded and the one that acts.
    #[inline(always)]
    pub(crate) fn answer<L: Lane<Real = R>, const NC: usize>(
        &self,
        inputs: &Inputs<'_, L, NC>,
        c: usize,
    ) -> [L; 3] {
        let [_, _, r_acceleration, feedforward] = splat_row::<L>(&inputs.reference[c]);
        let sent = inputs.feedback[c].mul_add(L::splat(self.mass), feedforward);
        let command = inputs.actuator.command(c, sent);
        let force = inputs.velocity[c].mul_add(-L::splat(self.drag), command + inputs.force[c]);
        let offset = r_acceleration + L::splat(self.gravity);
        let acceleration = force.mul_add(inputs.inverse_inertia[c], -offset);
        [acceleration, sent, command]
    }
}

impl<L: Lane> Plant<L, 1, 0> for Axis<L::Real> {
    const LIMITED: bool = false;
    const ROWS: usize = 1;

    #[inline(always)]
    fn reference(&self, rows: &[ReferenceRow<L::Real>], _extra: &[L; 0]) -> [[L; 1]; 2] {
        tabulated(rows, 1)
    }

    #[inline(always)]
    fn respond(&self, inputs: &Inputs<'_, L, 1>, _extra: &[L; 0]) -> Response<L, 1, 0> {
        let [acceleration, sent, command] = self.answer(inputs, 0);
        Response {
            error_acceleration: [acceleration],
            applied_feedback: inputs.feedback,
            sent: [sent],
            command: [command],
            excess: [L::number(0.0)],
            extra_rate: [],
        }
    }
}

/// The three axes of translation, fully actuated, of agents whose distances matter.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Translation<R> {
    pub(crate) axes: [Axis<R>; 3],
}

impl<R: Real> Translation<R> {
    pub(crate) fn new(uav: &Uav) -> Self {
        Self {
            axes: std::array::from_fn(|axis| Axis::new(uav, axis)),
        }
    }
}

impl<L: Lane> Plant<L, 3, 0> for Translation<L::Real> {
    const LIMITED: bool = false;
    const ROWS: usize = 1;

    #[inline(always)]
    fn reference(&self, rows: &[ReferenceRow<L::Real>], _extra: &[L; 0]) -> [[L; 3]; 2] {
        tabulated(rows, 1)
    }

    #[inline(always)]
    fn respond(&self, inputs: &Inputs<'_, L, 3>, _extra: &[L; 0]) -> Response<L, 3, 0> {
        let zero = L::number(0.0);
        let (mut acceleration, mut sent, mut command) = ([zero; 3], [zero; 3], [zero; 3]);
        for i in 0..3 {
            [acceleration[i], sent[i], command[i]] = self.axes[i].answer(inputs, i);
        }
        Response {
            error_acceleration: acceleration,
            applied_feedback: inputs.feedback,
            sent,
            command,
            excess: [zero; 3],
            extra_rate: [],
        }
    }
}

/// Rotational constants: inertias, damping, and (J_k - J_j) / J_i of the gyroscopic torque, which a common scale of the
/// true inertias leaves alone.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Attitude<R> {
    pub(crate) inertia: [R; 3],
    pub(crate) drag: R,
    pub(crate) gyro: [R; 3],
}

impl<R: Real> Attitude<R> {
    pub(crate) fn new(uav: &Uav) -> Self {
        let j = uav.inertia_kg_m2;
        Self {
            inertia: j.map(R::from_f64),
            drag: R::from_f64(uav.angular_drag_n_m_s),
            gyro: std::array::from_fn(|i| R::from_f64((j[(i + 2) % 3] - j[(i + 1) % 3]) / j[i])),
        }
    }

    /// Theta'' under a torque per true inertia, (3).
    #[inline(always)]
    pub(crate) fn acceleration<L: Lane<Real = R>>(
        &self,
        torque: [L; 3],
        rate: [L; 3],
        inverse_inertia: [L; 3],
    ) -> [L; 3] {
        let mut acceleration = torque;
        for i in 0..3 {
            let net = rate[i].mul_add(-L::splat(self.drag), torque[i]);
            let gyroscopic = rate[(i + 1) % 3] * rate[(i + 2) % 3];
            acceleration[i] = gyroscopic.mul_add(-L::splat(self.gyro[i]), net * inverse_inertia[i]);
        }
        acceleration
    }
}

impl<L: Lane> Plant<L, 3, 0> for Attitude<L::Real> {
    const LIMITED: bool = false;
    const ROWS: usize = 1;

    #[inline(always)]
    fn reference(&self, rows: &[ReferenceRow<L::Real>], _extra: &[L; 0]) -> [[L; 3]; 2] {
        tabulated(rows, 1)
    }

    #[inline(always)]
    fn respond(&self, inputs: &Inputs<'_, L, 3>, _extra: &[L; 0]) -> Response<L, 3, 0> {
        let zero = L::number(0.0);
        let (mut sent, mut command, mut torque) = ([zero; 3], [zero; 3], [zero; 3]);
        for i in 0..3 {
            let feedforward = L::splat(inputs.reference[i][3]);
            sent[i] = inputs.feedback[i].mul_add(L::splat(self.inertia[i]), feedforward);
            command[i] = inputs.actuator.command(i, sent[i]);
            torque[i] = command[i] + inputs.force[i];
        }
        let mut error_acceleration =
            self.acceleration(torque, inputs.velocity, *inputs.inverse_inertia);
        for i in 0..3 {
            error_acceleration[i] = error_acceleration[i] - L::splat(inputs.reference[i][2]);
        }
        Response {
            error_acceleration,
            applied_feedback: inputs.feedback,
            sent,
            command,
            excess: [zero; 3],
            extra_rate: [],
        }
    }
}

/// The whole UAV with thrust along its body axis, within limits (Remarks 6 and 11). Its own states are those of the
/// command filter: roll, pitch and their rates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Thrust<R> {
    pub(crate) attitude: Attitude<R>,
    pub(crate) mass: R,
    pub(crate) inverse_mass: R,
    pub(crate) drag: R,
    pub(crate) gravity: R,
    pub(crate) inverse_inertia: [R; 3],
    pub(crate) filter: R,
    pub(crate) max_thrust: R,
    pub(crate) max_torque: R,
    pub(crate) max_tilt: R,
}

impl<R: Real> Thrust<R> {
    pub(crate) fn new(uav: &Uav) -> Self {
        let real = R::from_f64;
        Self {
            attitude: Attitude::new(uav),
            mass: real(uav.mass_kg),
            inverse_mass: real(1.0 / uav.mass_kg),
            drag: real(uav.drag_n_s_m),
            gravity: real(uav.gravity_m_s2),
            inverse_inertia: uav.inertia_kg_m2.map(|inertia| real(1.0 / inertia)),
            filter: real(uav.command_filter_rad_s),
            max_thrust: real(uav.max_thrust_n),
            max_torque: real(uav.max_torque_n_m),
            max_tilt: real(uav.max_tilt_rad),
        }
    }
}

/// R(Theta) [0 0 1]', (3).
#[inline(always)]
pub(crate) fn body_axis<L: Lane>(roll: L, pitch: L, (sin_yaw, cos_yaw): (L, L)) -> [L; 3] {
    let ((sin_roll, cos_roll), (sin_pitch, cos_pitch)) = (roll.sin_cos(), pitch.sin_cos());
    let forward = sin_pitch * cos_roll;
    [
        cos_yaw.mul_add(forward, sin_yaw * sin_roll),
        sin_yaw.mul_add(forward, -(cos_yaw * sin_roll)),
        cos_pitch * cos_roll,
    ]
}

impl<L: Lane> Plant<L, 6, 4> for Thrust<L::Real> {
    const LIMITED: bool = true;
    const ROWS: usize = 1;

    #[inline(always)]
    fn reference(&self, rows: &[ReferenceRow<L::Real>], extra: &[L; 4]) -> [[L; 6]; 2] {
        let mut reference = tabulated(rows, 1);
        let [roll, pitch, roll_rate, pitch_rate] = *extra;
        (reference[0][3], reference[0][4]) = (roll, pitch);
        (reference[1][3], reference[1][4]) = (roll_rate, pitch_rate);
        reference
    }

    // In one piece, as `thrust_respond` of shaders/plant_uav.wgsl: the two are compared statement by statement.
    #[inline(always)]
    fn respond(&self, inputs: &Inputs<'_, L, 6>, extra: &[L; 4]) -> Response<L, 6, 4> {
        let zero = L::number(0.0);
        let [roll, pitch, roll_rate, pitch_rate] = *extra;
        let [yaw, yaw_rate, yaw_acceleration, _] = splat_row::<L>(&inputs.reference[5]);
        let (mut applied_feedback, mut excess) = ([zero; 6], [zero; 6]);
        let (mut sent, mut command) = ([zero; 6], [zero; 6]);
        let mut error_acceleration = [zero; 6];

        // The force that the position loop demands, (9).
        let mut force = [zero; 3];
        for i in 0..3 {
            let feedforward = L::splat(inputs.reference[i][3]);
            force[i] = inputs.feedback[i].mul_add(L::splat(self.mass), feedforward);
        }
        let [fx, fy, fz] = force;
        let yaw_sin_cos = yaw.sin_cos();
        let (sin_yaw, cos_yaw) = yaw_sin_cos;
        // Its direction in the frame turned by the yaw reference is that of the commanded body axis (Remark 11).
        let ahead = cos_yaw.mul_add(fx, sin_yaw * fy);
        let aside = cos_yaw.mul_add(fy, -(sin_yaw * fx));
        let upright = ahead.mul_add(ahead, fz * fz).sqrt();
        let roll_demanded = -aside.atan2(upright);
        let pitch_demanded = ahead.atan2(fz);
        let tilt = L::splat(self.max_tilt);
        let (roll_command, pitch_command) = (
            clamp(roll_demanded, -tilt, tilt),
            clamp(pitch_demanded, -tilt, tilt),
        );
        excess[0] = pitch_demanded - pitch_command;
        excess[1] = roll_demanded - roll_command;

        // Critically damped command filter: q'' = w^2 (command - q) - 2 w q'.
        let w = L::splat(self.filter);
        let roll_acceleration = (w * (roll_command - roll) - (roll_rate + roll_rate)) * w;
        let pitch_acceleration = (w * (pitch_command - pitch) - (pitch_rate + pitch_rate)) * w;

        // Thrust: demanded, then limited; the acceleration that it can give is the applied feedback.
        let thrust_demanded = fx.mul_add(fx, fy.mul_add(fy, fz * fz)).sqrt();
        let thrust = clamp(thrust_demanded, zero, L::splat(self.max_thrust));
        excess[2] = thrust_demanded - thrust;
        let commanded_axis = body_axis(roll, pitch, yaw_sin_cos);
        for i in 0..3 {
            let feedforward = L::splat(inputs.reference[i][3]);
            applied_feedback[i] =
                thrust.mul_add(commanded_axis[i], -feedforward) * L::splat(self.inverse_mass);
        }

        // Torques: demanded along the filtered attitude, then limited.
        let rates = [roll_rate, pitch_rate, yaw_rate];
        let accelerations = [roll_acceleration, pitch_acceleration, yaw_acceleration];
        let limit = L::splat(self.max_torque);
        let mut torque = [zero; 3];
        for i in 0..3 {
            let c = i + 3;
            let inertia = L::splat(self.attitude.inertia[i]);
            let gyroscopic =
                rates[(i + 1) % 3] * rates[(i + 2) % 3] * L::splat(self.attitude.gyro[i]);
            let non_inertial = gyroscopic.mul_add(inertia, rates[i] * L::splat(self.attitude.drag));
            let demanded = (accelerations[i] + inputs.feedback[c]).mul_add(inertia, non_inertial);
            let limited = clamp(demanded, -limit, limit);
            excess[c] = demanded - limited;
            applied_feedback[c] = (limited - non_inertial)
                .mul_add(L::splat(self.inverse_inertia[i]), -accelerations[i]);
            sent[c] = limited;
            command[c] = inputs.actuator.command(c, limited);
            torque[i] = command[c] + inputs.force[c];
        }

        // What the faults leave of the thrust acts along the true body axis.
        let applied = inputs.actuator.command(2, thrust);
        [sent[0], sent[1], sent[2]] = [fx, fy, thrust];
        for i in 0..3 {
            command[i] = force[i].mul_add(inputs.actuator.gain[i], inputs.actuator.bias[i]);
        }
        let [_, _, _, true_roll, true_pitch, true_yaw] = inputs.position;
        let true_axis = body_axis(true_roll, true_pitch, true_yaw.sin_cos());
        for i in 0..3 {
            let net = applied.mul_add(true_axis[i], inputs.force[i]);
            let net = inputs.velocity[i].mul_add(-L::splat(self.drag), net);
            let gravity = if i == 2 {
                self.gravity
            } else {
                L::Real::default()
            };
            let offset = L::splat(inputs.reference[i][2]) + L::splat(gravity);
            error_acceleration[i] = net.mul_add(inputs.inverse_inertia[i], -offset);
        }
        let [_, _, _, p, q, s] = inputs.velocity;
        let [_, _, _, ix, iy, iz] = *inputs.inverse_inertia;
        let angular = self.attitude.acceleration(torque, [p, q, s], [ix, iy, iz]);
        for i in 0..3 {
            error_acceleration[i + 3] = angular[i] - accelerations[i];
        }
        Response {
            error_acceleration,
            applied_feedback,
            sent,
            command,
            excess,
            extra_rate: [roll_rate, pitch_rate, roll_acceleration, pitch_acceleration],
        }
    }
}
