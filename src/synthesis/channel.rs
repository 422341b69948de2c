//! The augmented channel (19): error, actuator fault and sensor fault states.

use super::design::ChannelDesign;
use super::linalg::diagonal;
use nalgebra::DMatrix;

/// States of the error part: the integral of e, e and e'.
pub const ERROR_STATES: usize = 3;

/// A linear channel x' = A x + B u, y = C x, with u the feedback acceleration.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// System matrix, s x s.
    pub a: DMatrix<f64>,
    /// Input of the feedback acceleration, s x 1; s x n of n channels that share sensors.
    pub b: DMatrix<f64>,
    /// Measurements (integral of x, x, x'), 3 x s; l x s of l sensors.
    pub c: DMatrix<f64>,
}

/// The error channel (15) alone: A0, B0, C0.
#[must_use]
pub fn error_channel() -> Channel {
    Channel {
        a: DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
        b: DMatrix::from_column_slice(3, 1, &[0.0, 0.0, 1.0]),
        c: DMatrix::identity(3, 3),
    }
}

/// The augmented channel (19), all taps: the states are [int e, e, e', F1, F2].
#[must_use]
pub fn augmented_channel(design: &ChannelDesign) -> Channel {
    channel_with_taps(design, design.smoothing.taps())
}

/// The augmented channel without the delay lines, which never feed back: the
/// same transfer functions with fewer states.
#[must_use]
pub fn reduced_channel(design: &ChannelDesign) -> Channel {
    let active = design.smoothing.active_taps();
    channel_with_taps(design, [active, active])
}

fn channel_with_taps(design: &ChannelDesign, [taps1, taps2]: [usize; 2]) -> Channel {
    let states = ERROR_STATES + taps1 + taps2;
    let (f1, f2) = (ERROR_STATES, ERROR_STATES + taps1);
    let error = error_channel();

    let mut a = DMatrix::zeros(states, states);
    a.view_mut((0, 0), (3, 3)).copy_from(&error.a);
    a.view_mut((0, f1), (3, 1)).copy_from(&error.b);
    a.view_mut((f1, f1), (taps1, taps1))
        .copy_from(&design.smoothing.matrix(taps1));
    a.view_mut((f2, f2), (taps2, taps2))
        .copy_from(&design.smoothing.matrix(taps2));

    let mut b = DMatrix::zeros(states, 1);
    b.view_mut((0, 0), (3, 1)).copy_from(&error.b);

    let mut c = DMatrix::zeros(3, states);
    c.view_mut((0, 0), (3, 3)).copy_from(&error.c);
    c.view_mut((0, f2), (3, 1))
        .copy_from(&DMatrix::from_column_slice(
            3,
            1,
            &design.sensor_fault_input,
        ));
    Channel { a, b, c }
}

/// Q1 of (24) on all states: the weights on the error, zero on the faults.
pub(super) fn tracking_weight(design: &ChannelDesign) -> DMatrix<f64> {
    let states = design.states();
    diagonal(&design.q1).resize(states, states, 0.0)
}

/// Q2 of (24) on all states.
pub(super) fn estimation_weight(design: &ChannelDesign) -> DMatrix<f64> {
    diagonal(&design.q2)
}

/// The columns of the identity that let a model error v into each listed state.
pub(super) fn inputs(states: usize, rows: impl IntoIterator<Item = usize>) -> DMatrix<f64> {
    let rows: Vec<usize> = rows.into_iter().collect();
    DMatrix::from_fn(states, rows.len(), |i, j| f64::from(u8::from(i == rows[j])))
}
