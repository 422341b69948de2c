//! Gains in the form they are stored and in the form the episode loop integrates.

use super::channel::{ERROR_STATES, error_channel};
use super::design::ChannelDesign;
use super::error::{Step, SynthesisError};
use super::feedback::FeedbackProblem;
use super::linalg::eigenvalues;
use super::observer::ObserverProblem;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};

/// States of the reduced fault-tolerant observer: int e, e, e' and two taps of each fault.
pub const LOOP_STATES: usize = 7;

/// Feedback and observer gain of one controller on one channel.
///
/// s = 3 + (w1 + 1) + (w2 + 1) states for the fault-tolerant controller, 3 for a PID.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerGains {
    /// K of (21), one entry per state.
    pub k: Vec<f64>,
    /// L of (20), one row per state; columns belong to the measured int x, x and x'.
    pub l: Vec<[f64; 3]>,
}

impl ControllerGains {
    pub(super) fn from_matrices(k: &DMatrix<f64>, l: &DMatrix<f64>) -> Self {
        Self {
            k: k.iter().copied().collect(),
            l: l.row_iter().map(|row| [row[0], row[1], row[2]]).collect(),
        }
    }

    /// Refuses gains that do not belong to a controller with `states` states, or are not finite.
    pub(super) fn require_states(&self, states: usize) -> Result<(), SynthesisError> {
        for (key, given) in [("k", self.k.len()), ("l", self.l.len())] {
            if given != states {
                return Err(SynthesisError::WrongLength {
                    key: key.into(),
                    given,
                    needed: states,
                    why: "one per state of the controller",
                });
            }
        }
        let k = self.k.iter().enumerate();
        let l = self.l.iter().flatten().enumerate();
        let named = k
            .map(|(i, &value)| (format!("k[{i}]"), value))
            .chain(l.map(|(i, &value)| (format!("l[{}][{}]", i / 3, i % 3), value)));
        for (key, value) in named {
            if !value.is_finite() {
                return Err(SynthesisError::InvalidDesign {
                    key,
                    value,
                    limit: "finite".into(),
                });
            }
        }
        Ok(())
    }

    /// Whether these are the gains of a PID: feedback of the error alone.
    #[must_use]
    pub fn is_pid(&self) -> bool {
        self.k.len() == ERROR_STATES
    }

    /// K as a row, 1 x s.
    pub(super) fn k_matrix(&self) -> DMatrix<f64> {
        DMatrix::from_row_slice(1, self.k.len(), &self.k)
    }

    /// L, s x 3.
    pub(super) fn l_matrix(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.l.len(), 3, |i, j| self.l[i][j])
    }
}

/// The paper's PID computed torque with a three-state observer that trusts every measurement alike.
///
/// # Errors
/// If a Riccati equation has no solution, which positive weights exclude.
pub fn pid_gains(design: &ChannelDesign) -> Result<ControllerGains, SynthesisError> {
    pid_with(design, 1.0, [design.pid_nu; 3], 1e6)
}

/// The same feedback with an observer tuned to distrust the faulty velocity measurement.
///
/// # Errors
/// If a Riccati equation has no solution, which positive weights exclude.
pub fn pid_robust_observer_gains(
    design: &ChannelDesign,
) -> Result<ControllerGains, SynthesisError> {
    pid_with(design, 100.0, [1e-2, 1e-2, 1.0], 1e9)
}

/// A PID; its feedback is solved at a level so high that the disturbance does not shape it.
fn pid_with(
    design: &ChannelDesign,
    model_error: f64,
    noise: [f64; 3],
    observer_rho: f64,
) -> Result<ControllerGains, SynthesisError> {
    let unsolved = SynthesisError::NotConverged {
        step: Step::Pid,
        what: "a Riccati equation",
    };
    let feedback = FeedbackProblem::pid(design);
    let observer = ObserverProblem::pid(model_error, noise);
    let p = feedback.riccati(1e6).ok_or(unsolved.clone())?;
    let x = observer.riccati(observer_rho).ok_or(unsolved)?;
    Ok(ControllerGains::from_matrices(
        &feedback.gain(&p),
        &observer.gain(&x),
    ))
}

/// The gains of one controller on one channel as the episode loop integrates
/// them: without the delay lines of the smoothing models, which never feed back.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoopGains {
    /// Observer states in use: 7 `[int e, e, e', F1_0, F1_1, F2_0, F2_1]`, or 3 for a PID.
    pub states: usize,
    /// K, zero beyond `states`.
    pub k: [f64; LOOP_STATES],
    /// L, a row per state, zero beyond `states`.
    pub l: [[f64; 3]; LOOP_STATES],
    /// Smoothing model `[a, b, c]` in 1/s: `F_0' = a F_0 + b F_1`, `F_1' = c (F_0 - F_1)`.
    pub smoothing: [f64; 3],
    /// Direction B20 in which the sensor fault enters (int x, x, x').
    pub sensor_fault_input: [f64; 3],
}

/// The reduced form of `gains`, exact for smoothing models of order 0 and 1.
///
/// # Errors
/// If the shape of the gains does not fit the design, the smoothing model feeds
/// back more than two taps, or K uses a tap that the reduction drops.
pub fn loop_gains(
    design: &ChannelDesign,
    gains: &ControllerGains,
) -> Result<LoopGains, SynthesisError> {
    let weights = design.smoothing.weights();
    let rate = design.smoothing.spacing_s.recip();
    let weight = |i: usize| weights.get(i).copied().unwrap_or(0.0);
    let mut reduced = LoopGains {
        states: ERROR_STATES,
        k: [0.0; LOOP_STATES],
        l: [[0.0; 3]; LOOP_STATES],
        smoothing: [(weight(0) - 1.0) * rate, weight(1) * rate, rate],
        sensor_fault_input: design.sensor_fault_input,
    };
    // Index in the reduced state and in the full one.
    let mut kept: Vec<(usize, usize)> = (0..ERROR_STATES).map(|i| (i, i)).collect();
    if gains.is_pid() {
        gains.require_states(ERROR_STATES)?;
    } else {
        gains.require_states(design.states())?;
        if design.smoothing.active_taps() > 2 {
            return Err(SynthesisError::Unsupported(format!(
                "the smoothing model feeds back {} taps but episodes integrate at most 2; \
                 use order 0 or 1, or at most two weights",
                design.smoothing.active_taps()
            )));
        }
        reduced.states = LOOP_STATES;
        let [taps1, taps2] = design.smoothing.taps();
        let (f1, f2) = (ERROR_STATES, ERROR_STATES + taps1);
        kept.extend((0..taps1.min(2)).map(|tap| (3 + tap, f1 + tap)));
        kept.extend((0..taps2.min(2)).map(|tap| (5 + tap, f2 + tap)));
        let dropped = (0..gains.k.len())
            .filter(|full| kept.iter().all(|(_, kept)| kept != full))
            .find(|&full| gains.k[full] != 0.0);
        if let Some(index) = dropped {
            return Err(SynthesisError::Unsupported(format!(
                "k[{index}] = {} acts on a delayed tap, which episodes do not integrate; \
                 only the first two taps of each smoothing model may carry a gain",
                gains.k[index]
            )));
        }
    }
    for (reduced_index, full_index) in kept {
        reduced.k[reduced_index] = gains.k[full_index];
        reduced.l[reduced_index] = gains.l[full_index];
    }
    Ok(reduced)
}

/// All poles of the loop that an episode integrates, 1/s: three of the error
/// and one per observer state; what the step of the integrator must resolve.
///
/// Empty if the gains are not finite.
#[must_use]
pub fn poles(gains: &LoopGains) -> Vec<Complex<f64>> {
    let n = gains.states;
    let error = error_channel();
    let k = DMatrix::from_row_slice(1, ERROR_STATES, &gains.k[..ERROR_STATES]);
    let controlled = &error.a + &error.b * k;

    let mut observer = DMatrix::zeros(n, n);
    observer.view_mut((0, 0), (3, 3)).copy_from(&error.a);
    let mut c = DMatrix::zeros(3, n);
    c.view_mut((0, 0), (3, 3)).copy_from(&error.c);
    if n == LOOP_STATES {
        let [a, b, rate] = gains.smoothing;
        observer[(2, 3)] = 1.0;
        for first in [3, 5] {
            observer[(first, first)] = a;
            observer[(first, first + 1)] = b;
            observer[(first + 1, first)] = rate;
            observer[(first + 1, first + 1)] = -rate;
        }
        for (row, &entry) in gains.sensor_fault_input.iter().enumerate() {
            c[(row, 5)] = entry;
        }
    }
    let l = DMatrix::from_fn(n, 3, |i, j| gains.l[i][j]);
    match (eigenvalues(&controlled), eigenvalues(&(observer + l * c))) {
        (Some(controlled), Some(observer)) => controlled.into_iter().chain(observer).collect(),
        _ => Vec::new(),
    }
}
