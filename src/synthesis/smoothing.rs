//! Smoothing signal model (18): how a fault signal is expected to move.

use super::error::SynthesisError;
use super::linalg::eigenvalues;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};

/// Real parts above this many 1/h count as not stable: the double root that
/// marks an undamped model is only determined to the square root of f64's resolution.
const STABILITY_MARGIN: f64 = 1e-6;

/// Smoothing model (18) of both fault signals, F' = A F + v with A = (S - I) / h.
///
/// F holds the signal and its w values before, h apart; S is the companion
/// matrix whose first row extrapolates the next value from them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Smoothing {
    /// Time between two taps h, s.
    pub spacing_s: f64,
    /// Windows w1 of the actuator fault and w2 of the sensor fault; a window w has w + 1 taps.
    pub windows: [usize; 2],
    /// How the next value follows from the taps.
    pub rule: SmoothingRule,
}

/// First row of the companion matrix of a smoothing model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub enum SmoothingRule {
    /// Extrapolation of order p with a leak: the weights of 1 - (1 - g z^-1)^(p+1), g = 1 - sigma h.
    Leaky {
        /// Order p, at most the smaller window.
        order: usize,
        /// Leak sigma, 1/s; all p + 1 modes decay with it.
        leak_per_s: f64,
    },
    /// The weights themselves, newest tap first, zero padded to the window.
    Weights(Vec<f64>),
}

impl Smoothing {
    /// The model's default: order 1, leak 1 1/s, taps 0.1 s apart, windows 3 and 4.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            spacing_s: 0.1,
            windows: [3, 4],
            rule: SmoothingRule::Leaky {
                order: 1,
                leak_per_s: 1.0,
            },
        }
    }

    /// Number of taps of the two models, w1 + 1 and w2 + 1.
    #[must_use]
    pub fn taps(&self) -> [usize; 2] {
        self.windows.map(|window| window + 1)
    }

    /// The weights of the first row, without padding.
    #[must_use]
    pub fn weights(&self) -> Vec<f64> {
        match &self.rule {
            SmoothingRule::Leaky { order, leak_per_s } => {
                leaky_weights(*order, 1.0 - leak_per_s * self.spacing_s)
            }
            SmoothingRule::Weights(weights) => weights.clone(),
        }
    }

    /// Number of leading taps that feed back into the signal; later taps are a pure delay line.
    #[must_use]
    pub fn active_taps(&self) -> usize {
        let last = self.weights().iter().rposition(|&weight| weight != 0.0);
        last.map_or(1, |index| index + 1)
    }

    /// A = (S - I) / h with the given number of taps, 1/s.
    pub(super) fn matrix(&self, taps: usize) -> DMatrix<f64> {
        let weights = self.weights();
        DMatrix::from_fn(taps, taps, |i, j| {
            let shift = match i {
                0 => weights.get(j).copied().unwrap_or(0.0),
                _ => f64::from(u8::from(i == j + 1)),
            };
            (shift - f64::from(u8::from(i == j))) / self.spacing_s
        })
    }

    /// Eigenvalues of A with the given number of taps, 1/s; `None` if they do not converge.
    pub(super) fn eigenvalues(&self, taps: usize) -> Option<Vec<Complex<f64>>> {
        let active = self.active_taps();
        let mut values = match &self.rule {
            // Known, and a multiple eigenvalue cannot be computed well.
            SmoothingRule::Leaky { order, leak_per_s } if active == order + 1 => {
                vec![Complex::new(-leak_per_s, 0.0); active]
            }
            _ => eigenvalues(&self.matrix(active))?,
        };
        values.resize(taps, Complex::new(-self.spacing_s.recip(), 0.0));
        Some(values)
    }

    /// Refuses a model whose modes do not all decay: the fault states are not
    /// controllable, so no gain could stabilise them.
    pub(super) fn require_stable(&self) -> Result<(), SynthesisError> {
        let slowest = self
            .eigenvalues(self.active_taps())
            .and_then(|values| values.into_iter().max_by(|a, b| a.re.total_cmp(&b.re)));
        match slowest {
            Some(value) if value.re <= -STABILITY_MARGIN / self.spacing_s => Ok(()),
            slowest => Err(SynthesisError::UnstableSmoothing {
                eigenvalue: slowest.unwrap_or(Complex::new(f64::NAN, f64::NAN)),
            }),
        }
    }
}

/// The coefficients `a_0 .. a_p` of `1 - (1 - g z^-1)^(p+1)`, the sum of `a_k z^-(k+1)`.
fn leaky_weights(order: usize, g: f64) -> Vec<f64> {
    // Multiply (1 - g z^-1) out, order + 1 times.
    let mut polynomial = vec![1.0];
    for _ in 0..=order {
        let mut next = vec![0.0; polynomial.len() + 1];
        for (k, coefficient) in polynomial.iter().enumerate() {
            next[k] += coefficient;
            next[k + 1] -= g * coefficient;
        }
        polynomial = next;
    }
    polynomial[1..]
        .iter()
        .map(|coefficient| -coefficient)
        .collect()
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
mod tests {
    use super::*;

    fn with(rule: SmoothingRule) -> Smoothing {
        Smoothing {
            rule,
            ..Smoothing::paper()
        }
    }

    #[test]
    fn default_weights_are_those_of_the_model() {
        let weights = Smoothing::paper().weights();
        assert_eq!(weights.len(), 2);
        // One rounding each.
        assert!((weights[0] - 1.8).abs() < 1e-15 && (weights[1] + 0.81).abs() < 1e-15);
    }

    #[test]
    fn leaky_eigenvalues_equal_the_leak() {
        for order in 0..3 {
            let smoothing = with(SmoothingRule::Leaky {
                order,
                leak_per_s: 2.0,
            });
            let values = eigenvalues(&smoothing.matrix(order + 1)).unwrap();
            // An eigenvalue of multiplicity m is computed to eps^(1/m), here up to the cube root.
            assert!(values.iter().all(|value| (value + 2.0).norm() < 1e-3));
        }
    }

    #[test]
    fn refuses_plain_extrapolation_with_its_eigenvalue() {
        let error = with(SmoothingRule::Weights(vec![2.0, -1.0]))
            .require_stable()
            .unwrap_err();
        assert!(
            matches!(error, SynthesisError::UnstableSmoothing { eigenvalue } if eigenvalue.norm() < 1e-6)
        );
    }

    #[test]
    fn refuses_a_growing_model() {
        let error = with(SmoothingRule::Weights(vec![1.5]))
            .require_stable()
            .unwrap_err();
        // (1.5 - 1) / 0.1 = 5 1/s.
        assert!(
            matches!(error, SynthesisError::UnstableSmoothing { eigenvalue } if (eigenvalue.re - 5.0).abs() < 1e-9)
        );
    }

    #[test]
    fn trailing_zero_weights_are_a_delay_line() {
        assert_eq!(
            with(SmoothingRule::Weights(vec![0.9, 0.0, 0.0])).active_taps(),
            1
        );
        assert_eq!(Smoothing::paper().active_taps(), 2);
    }
}
