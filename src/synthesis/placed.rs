//! A PID by the placement of its poles: one number, which anyone can choose.

use super::channel::{ERROR_STATES, error_channel};
use super::gains::ControllerGains;
use super::margins::margins;
use nalgebra::DMatrix;

/// Where the poles of a placed PID may lie, rad/s.
pub const PLACED_RAD_S: [f64; 2] = [0.01, 1000.0];

/// A PID whose error has a triple pole at -`poles_rad_s`, K = -(N^3, 3 N^2, 3 N), behind an observer that follows what
/// is measured with poles at -`observer_rad_s`.
#[must_use]
pub fn placed_gains(poles_rad_s: f64, observer_rad_s: f64) -> ControllerGains {
    let n = poles_rad_s;
    // The measurements are the states: A + L = -M I, whatever A is.
    let observer = -error_channel().a
        - DMatrix::from_diagonal_element(ERROR_STATES, ERROR_STATES, observer_rad_s);
    let k = DMatrix::from_row_slice(1, ERROR_STATES, &[-n.powi(3), -3.0 * n.powi(2), -3.0 * n]);
    ControllerGains::from_matrices(&k, &observer)
}

/// The poles, rad/s, of the fastest placed PID that still has a delay margin, ms: the faster it is, the smaller is its
/// margin. None if no such PID has its poles in [`PLACED_RAD_S`].
#[must_use]
pub fn poles_for_delay_margin(delay_margin_ms: f64, observer_rad_s: f64) -> Option<f64> {
    let channel = error_channel();
    let margin = |poles_rad_s: f64| {
        let found = margins(&channel, &placed_gains(poles_rad_s, observer_rad_s));
        found.map_or(0.0, |found| found.delay_margin_ms)
    };
    let [mut slow, mut fast] = PLACED_RAD_S;
    if margin(slow) < delay_margin_ms || margin(fast) >= delay_margin_ms {
        return None;
    }
    while fast / slow > 1.0 + 1e-12 {
        let middle = (slow * fast).sqrt();
        if margin(middle) >= delay_margin_ms {
            slow = middle;
        } else {
            fast = middle;
        }
    }
    Some(slow)
}
