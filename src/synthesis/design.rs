//! What a channel's controller is designed from.

use super::error::SynthesisError;
use super::smoothing::{Smoothing, SmoothingRule};
use serde::{Deserialize, Serialize};

/// Longest window of a smoothing model; the cost of the inequalities grows with its fifth power.
pub const MAX_WINDOW: usize = 10;

/// Weights and structure of the design of one channel type.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelDesign {
    /// Smoothing model (18) of both faults.
    pub smoothing: Smoothing,
    /// Diagonal of Q1 in (24): weights on int e, e and e'. The fault states carry none.
    pub q1: [f64; 3],
    /// Diagonal of Q2 in (24): weights on the estimation error, one per state.
    pub q2: Vec<f64>,
    /// Weight R on the feedback acceleration in (24).
    pub r: f64,
    /// Attenuation level rho at which both steps are solved.
    pub rho: f64,
    /// Measurement-noise weight nu of the observer step.
    pub nu: f64,
    /// Weight of the sensor fault's model error in the observer step.
    pub eps2: f64,
    /// Direction B20 in which the sensor fault enters (int x, x, x').
    pub sensor_fault_input: [f64; 3],
    /// Measurement-noise weight of the baseline PID's observer.
    pub pid_nu: f64,
}

impl ChannelDesign {
    /// Number of states s = 3 + (w1 + 1) + (w2 + 1) of the augmented channel.
    #[must_use]
    pub fn states(&self) -> usize {
        3 + self.smoothing.taps().iter().sum::<usize>()
    }

    /// Refuses parameters outside their ranges and smoothing models that do not decay.
    ///
    /// # Errors
    /// The first parameter found wrong, with its value and limit.
    pub fn validate(&self) -> Result<(), SynthesisError> {
        self.validate_smoothing()?;
        // Without a weight on the integral its pure integrator is invisible to (31).
        positive("q1[0]", self.q1[0])?;
        for (i, &weight) in self.q1.iter().enumerate().skip(1) {
            non_negative(&format!("q1[{i}]"), weight)?;
        }
        if self.q2.len() != self.states() {
            return Err(SynthesisError::WrongLength {
                key: "q2".into(),
                given: self.q2.len(),
                needed: self.states(),
                why: "3 error states and a value per tap of both smoothing models",
            });
        }
        for (i, &weight) in self.q2.iter().enumerate() {
            non_negative(&format!("q2[{i}]"), weight)?;
        }
        for (key, value) in [
            ("r", self.r),
            ("rho", self.rho),
            ("nu", self.nu),
            ("eps2", self.eps2),
            ("pid_nu", self.pid_nu),
        ] {
            positive(key, value)?;
        }
        for (i, &entry) in self.sensor_fault_input.iter().enumerate() {
            require(
                entry.abs() <= 1e3,
                &format!("sensor_fault_input[{i}]"),
                entry,
                "between -1000 and 1000",
            )?;
        }
        Ok(())
    }

    fn validate_smoothing(&self) -> Result<(), SynthesisError> {
        let Smoothing {
            spacing_s,
            windows,
            rule,
        } = &self.smoothing;
        require(
            (1e-4..=10.0).contains(spacing_s),
            "smoothing.spacing_s",
            *spacing_s,
            "between 0.0001 and 10 s",
        )?;
        for (i, &window) in windows.iter().enumerate() {
            require(
                window <= MAX_WINDOW,
                &format!("smoothing.windows[{i}]"),
                count(window),
                &format!("at most {MAX_WINDOW}"),
            )?;
        }
        let shortest = windows[0].min(windows[1]);
        match rule {
            SmoothingRule::Leaky { order, leak_per_s } => {
                require(
                    *order <= shortest,
                    "smoothing.order",
                    count(*order),
                    &format!("at most the shorter window, {shortest}"),
                )?;
                require(
                    leak_per_s.abs() <= 1e3,
                    "smoothing.leak_per_s",
                    *leak_per_s,
                    "above 0 and at most 1000 1/s",
                )?;
            }
            SmoothingRule::Weights(weights) => {
                require(
                    (1..=shortest + 1).contains(&weights.len()),
                    "number of smoothing.weights",
                    count(weights.len()),
                    &format!(
                        "between 1 and {}, the shorter window plus one",
                        shortest + 1
                    ),
                )?;
                for (i, &weight) in weights.iter().enumerate() {
                    require(
                        weight.abs() <= 1e3,
                        &format!("smoothing.weights[{i}]"),
                        weight,
                        "between -1000 and 1000",
                    )?;
                }
            }
        }
        self.smoothing.require_stable()
    }
}

/// Q2 that falls by ten from tap to tap, as Section V lists it.
///
/// `error` weighs int e, e and e'; `fault1` and `fault2` weigh the newest taps.
#[must_use]
pub fn geometric_q2(smoothing: &Smoothing, error: [f64; 3], fault1: f64, fault2: f64) -> Vec<f64> {
    let [taps1, taps2] = smoothing.taps();
    let falling = |first: f64, taps: usize| {
        std::iter::successors(Some(first), |weight| Some(weight / 10.0)).take(taps)
    };
    error
        .into_iter()
        .chain(falling(fault1, taps1))
        .chain(falling(fault2, taps2))
        .collect()
}

fn positive(key: &str, value: f64) -> Result<(), SynthesisError> {
    require(
        (1e-12..=1e12).contains(&value),
        key,
        value,
        "above 0 (between 1e-12 and 1e12)",
    )
}

fn non_negative(key: &str, value: f64) -> Result<(), SynthesisError> {
    require(
        (0.0..=1e12).contains(&value),
        key,
        value,
        "0 or above (at most 1e12)",
    )
}

fn require(holds: bool, key: &str, value: f64, limit: &str) -> Result<(), SynthesisError> {
    if holds {
        return Ok(());
    }
    Err(SynthesisError::InvalidDesign {
        key: key.into(),
        value,
        limit: limit.into(),
    })
}

#[expect(clippy::cast_precision_loss, reason = "small counts, for a message")]
fn count(n: usize) -> f64 {
    n as f64
}
