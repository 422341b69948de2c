//! What a loop makes of sines: how large the error of one channel becomes under faults of a frequency, and its feedback
//! under noise.

use super::channel::{ERROR_STATES, augmented_channel, error_channel};
use super::design::ChannelDesign;
use super::gains::ControllerGains;
use super::margins::LoopGain;
use nalgebra::DMatrix;

/// What is left of an initial error that counts as settled, relative to it.
const SETTLED: f64 = 0.05;
/// The longest time that is looked at, s, and the time between two looks.
const LONGEST_S: f64 = 120.0;
const LOOK_S: f64 = 1e-3;

/// How long the error of one channel takes to stay within 5 % of where it starts, s, without faults and with an
/// observer that knows it: that of the feedback alone. None if that is more than two minutes.
#[must_use]
pub fn settling_s(gains: &ControllerGains) -> Option<f64> {
    let channel = error_channel();
    let k = gains.k_matrix();
    let feedback = k.columns(0, ERROR_STATES.min(k.ncols()));
    let step = ((&channel.a + &channel.b * feedback) * LOOK_S).exp();
    // The states are the integral of e, e and e'.
    let mut state = DMatrix::from_column_slice(ERROR_STATES, 1, &[0.0, 1.0, 0.0]);
    let (mut time_s, mut settled_s) = (0.0, 0.0);
    while time_s < LONGEST_S {
        time_s += LOOK_S;
        state = &step * state;
        // A loop that diverges beyond numbers has not settled.
        if state[(1, 0)].abs() > SETTLED || state[(1, 0)].is_nan() {
            settled_s = time_s;
        }
    }
    (settled_s < LONGEST_S - 2.0 * LOOK_S).then_some(settled_s)
}

/// The size of a closed loop's answers to a sine of a frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// The frequency, rad/s.
    pub omega_rad_s: f64,
    /// |e / f1|: the error of the channel in answer to an actuator fault, or any disturbance of its acceleration, s^2.
    pub from_actuator_fault: f64,
    /// |e / f2|: the same of a fault of its rate sensor, s.
    pub from_sensor_fault: f64,
    /// |u / noise|: the feedback acceleration in answer to noise on x and x', one unit on each.
    pub from_noise: f64,
}

/// The answers of the loop of a channel to sines of some frequencies, rad/s; none where its equations have no solution.
/// `gains` have the states of `design` or those of the error alone.
#[must_use]
pub fn responses(
    design: &ChannelDesign,
    gains: &ControllerGains,
    omegas_rad_s: &[f64],
) -> Option<Vec<Response>> {
    let channel = match gains.is_pid() {
        true => error_channel(),
        false => augmented_channel(design),
    };
    gains.require_states(channel.a.nrows()).ok()?;
    let own = LoopGain::of(&channel, gains);
    let at = |&omega_rad_s: &f64| {
        let faults = own.of_faults(omega_rad_s, &design.sensor_fault_input)?;
        Some(Response {
            omega_rad_s,
            from_actuator_fault: faults[0],
            from_sensor_fault: faults[1],
            from_noise: own.of_noise(omega_rad_s)?,
        })
    };
    omegas_rad_s.iter().map(at).collect()
}
