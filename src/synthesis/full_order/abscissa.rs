//! The slowest pole of a system of many states.

use crate::synthesis::linalg::max_abs;
use nalgebra::DMatrix;

/// Squarings of the transition matrix: its time then is 1e18 times that of the first, and what the start adds to the
/// growth, a few powers of ten, no longer counts.
const SQUARINGS: i32 = 60;

/// The largest real part of an eigenvalue of a square matrix, from the growth of exp(A t) over a long time: repeated
/// eigenvalues, which channels that are alike have and on which the QR algorithm may stall, do not matter to it.
pub(super) fn spectral_abscissa(a: &DMatrix<f64>) -> Option<f64> {
    let mut time_s = max_abs(a).recip();
    let mut transition = (a * time_s).exp();
    let mut log_size = 0.0;
    for _ in 0..SQUARINGS {
        let size = transition.norm();
        transition /= size;
        log_size = 2.0 * (log_size + size.ln());
        transition = &transition * &transition;
        time_s *= 2.0;
    }
    let abscissa = (log_size + transition.norm().ln()) / time_s;
    abscissa.is_finite().then_some(abscissa)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
mod tests {
    use super::*;

    #[test]
    fn slowest_pole_of_stable_and_unstable_matrices_is_found() {
        for (entries, expected) in [
            // A double pole that cannot be diagonalised, a pair that turns, and a growing mode.
            ([-2.0, 1.0, 0.0, -2.0], -2.0),
            ([-0.5, 30.0, -30.0, -0.5], -0.5),
            ([0.25, 1e3, 0.0, -4.0], 0.25),
        ] {
            let found = spectral_abscissa(&DMatrix::from_row_slice(2, 2, &entries)).unwrap();
            // A few roundings of exp(A t) at the first t, 1e-3 s.
            assert!((found - expected).abs() < 1e-11, "{found} {expected}");
        }
    }
}
