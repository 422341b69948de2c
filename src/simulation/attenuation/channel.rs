//! Inequality (24) on one channel of a simulated episode.
//!
//! The state of (23) is x~ = [ebar, e~]: the true error with the true fault signals and the values that they had
//! h, 2 h, .. before, and what the observer misses of it. What the smoothing model (18) leaves of the faults' motion,
//! v = F' - A F, enters both halves alike, so that v~ = [v, v] and the denominator of (24) is twice the energy of v.
//! The certificate (27) allows every pair of disturbances of the two halves; for those that are equal the largest
//! attenuation is lower (7.17 instead of 10.13 for the paper's UAV), so an episode that starts from rest stays well
//! below the certified level.
//!
//! There is no fault before t = 0. A fault that is not zero at t = 0 reaches the later taps as a jump at h, 2 h, ..: v
//! is what lies between the jumps, and V(0) of (24) counts by how much they raise V, as it counts the state at t = 0.

use super::applicability::NotApplicable;
use crate::synthesis::{
    Certificate, ChannelDesign, ControllerGains, ERROR_STATES, LOOP_STATES, MAX_WINDOW, RELAXATION,
    augmented_channel,
};
use nalgebra::DMatrix;

/// Most states of an augmented channel.
const MOST_STATES: usize = ERROR_STATES + 2 * (MAX_WINDOW + 1);
/// Taps of each fault that the loop integrates.
const FLOWN_TAPS: usize = (LOOP_STATES - ERROR_STATES) / 2;

/// Largest share of K's terms by which the feedback may differ from K ehat: rounding, and that of a leg's mass matrix
/// there and back.
const ROUNDING: f64 = 1e-9;
/// Largest relative difference of the energy of v between central differences over one step and over two. A jump
/// doubles its share of the energy from the one to the other, and so does noise that is drawn anew at each step.
const RESOLUTION: f64 = 0.1;

/// One channel at the start of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// int e, e and e'.
    pub error: [f64; ERROR_STATES],
    /// The observer's states that the loop integrates: `[int e, e, e', F1 (2), F2 (2)]`.
    pub estimate: [f64; LOOP_STATES],
    /// f1 of (14) and f2 of (16).
    pub faults: [f64; 2],
    /// The feedback that was applied, of which the observer knows.
    pub applied_feedback: f64,
}

/// An episode of a channel as far as (24) is taken from it.
#[derive(Debug, Clone, Copy)]
pub struct Stretch<'a> {
    /// Time between two samples, s.
    pub step_s: f64,
    /// The channel at every step, the first at t = 0.
    pub samples: &'a [Sample],
    /// The first sample of the integrals.
    pub from: usize,
}

/// Both sides of (24) for one channel of an episode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attenuation {
    /// Integral of ebar' Q1 ebar + e~' Q2 e~ + R u_fb^2: what is to stay small.
    pub weighted: f64,
    /// Integral of v~' v~, twice that of v' v: what the smoothing model leaves of the faults.
    pub model_error: f64,
    /// V at t = 0, and by how much the taps that begin later raise it.
    pub initial: f64,
    /// The certified level rho.
    pub certified: f64,
}

impl Attenuation {
    /// The square root of the left side of (24) without V(0). An episode that starts far off may exceed the certified
    /// level.
    #[must_use]
    pub fn level(&self) -> f64 {
        (self.weighted / self.model_error).sqrt()
    }

    /// Whether (24) holds with V(0), at the multiple of the certified level at which (27) is verified.
    #[must_use]
    pub fn holds(&self) -> bool {
        let level = RELAXATION * self.certified;
        self.weighted <= level.powi(2).mul_add(self.model_error, self.initial)
    }
}

/// A channel's design, gains and certificate: what (24) is about.
#[derive(Debug, Clone)]
pub struct AttenuationInequality {
    design: ChannelDesign,
    gains: ControllerGains,
    /// Abar of (19), s x s.
    a: DMatrix<f64>,
    p1: DMatrix<f64>,
    p2: DMatrix<f64>,
    rho: f64,
}

/// A state of all s, zero beyond.
type Full = [f64; MOST_STATES];

/// What (24) takes of one instant, as seen from one side of it.
struct Instant {
    truth: Full,
    /// v with the derivatives of each width.
    model_error: [Full; 2],
}

impl AttenuationInequality {
    /// The inequality for gains that are simulated and their certificate.
    ///
    /// # Errors
    /// If (27) does not hold for them: the certificate belongs to other gains or weights, or was changed.
    pub fn new(
        design: &ChannelDesign,
        gains: &ControllerGains,
        certificate: &Certificate,
    ) -> Result<Self, NotApplicable> {
        match certificate.max_eigenvalue_with(design, gains) {
            Ok(eigenvalue) if eigenvalue < 0.0 => {}
            _ => return Err(NotApplicable::OtherCertificate),
        }
        let square =
            |rows: &[Vec<f64>]| DMatrix::from_fn(rows.len(), rows.len(), |i, j| rows[i][j]);
        Ok(Self {
            a: augmented_channel(design).a,
            design: design.clone(),
            gains: gains.clone(),
            p1: square(&certificate.p1),
            p2: square(&certificate.p2),
            rho: certificate.rho,
        })
    }

    /// Both sides of (24) over an episode, from stretches of it that follow each other; the first begins at t = 0.
    ///
    /// Integrals by the trapezoidal rule, derivatives of the faults by central differences: the result converges with
    /// the square of the step, with the step itself where the taps' spacing is no multiple of it.
    ///
    /// # Errors
    /// Why (24) does not apply: numbers that are not finite, a feedback other than K ehat, an integral other than that
    /// of e, faults that the step does not resolve, or none at all.
    pub fn attenuation(&self, stretches: &[Stretch<'_>]) -> Result<Attenuation, NotApplicable> {
        let mut whole = Sums::default();
        for stretch in stretches {
            self.require_loop(stretch)?;
            whole.add(&self.sums(stretch));
        }
        let [model_error, wider] = whole.energy;
        if model_error == 0.0 {
            return Err(NotApplicable::NoModelError);
        }
        let difference = (model_error - wider).abs() / model_error;
        if difference.is_nan() || difference > RESOLUTION {
            return Err(NotApplicable::Unresolved);
        }
        Ok(Attenuation {
            weighted: whole.weighted,
            model_error,
            initial: whole.initial,
            certified: self.rho,
        })
    }

    /// The integrals of (24) over a stretch.
    fn sums(&self, stretch: &Stretch<'_>) -> Sums {
        let Stretch {
            step_s,
            samples,
            from,
        } = *stretch;
        let trajectory = ChannelTrajectory {
            inequality: self,
            stretch,
            lags: self.lags(step_s),
            rates: &[1, 2].map(|width| rates(step_s, samples, width)),
        };
        let mut sums = Sums::default();
        let mut estimate = self.start(&samples[0]);
        let mut start = trajectory.instant(from, from);
        for k in 0..samples.len() - 1 {
            let next = self.advance(&estimate, &samples[k..k + 2], step_s);
            if k >= from {
                if k == 0 {
                    sums.initial = self.lyapunov(&start.truth, &estimate);
                } else if trajectory.begins(k) {
                    let before = self.lyapunov(&start.truth, &estimate);
                    start = trajectory.instant(k, k);
                    sums.initial += self.lyapunov(&start.truth, &estimate) - before;
                }
                let end = trajectory.instant(k + 1, k);
                for (instant, estimate) in [(&start, &estimate), (&end, &next)] {
                    sums.weighted += self.weighted(&instant.truth, estimate) * step_s / 2.0;
                    for (energy, v) in sums.energy.iter_mut().zip(&instant.model_error) {
                        // Once for each half of x~.
                        *energy += v.iter().map(|v| v * v).sum::<f64>() * step_s;
                    }
                }
                start = end;
            }
            estimate = next;
        }
        sums
    }

    /// Refuses an episode whose loop is not that of (19) to (21).
    fn require_loop(&self, stretch: &Stretch<'_>) -> Result<(), NotApplicable> {
        let Stretch {
            step_s, samples, ..
        } = *stretch;
        let (mut integral, mut scale, mut off) = (0.0, 0.0, 0.0_f64);
        for (k, sample) in samples.iter().enumerate() {
            let t_s = k as f64 * step_s;
            let numbers = sample.error.iter().chain(&sample.estimate);
            let mut numbers = numbers
                .chain(&sample.faults)
                .chain([&sample.applied_feedback]);
            if !numbers.all(|number| number.is_finite()) {
                return Err(NotApplicable::NotFinite { t_s });
            }
            let estimate = self.start(sample);
            let [sum, size] = self.terms(&estimate).fold([0.0, 0.0], |[sum, size], term| {
                [sum + term, size + term.abs()]
            });
            if (sample.applied_feedback - sum).abs() > ROUNDING * (1.0 + size) {
                return Err(NotApplicable::OtherFeedback { t_s });
            }
            if k > 0 {
                let [before, now] = [samples[k - 1].error, sample.error];
                integral += (before[1] + now[1]) * step_s / 2.0;
                scale += (before[1].abs() + now[1].abs()) * step_s / 2.0;
                off = off.max((now[0] - samples[0].error[0] - integral).abs());
            }
        }
        if off > RESOLUTION * scale {
            return Err(NotApplicable::OtherIntegral);
        }
        // The wider differences take six samples at the ends.
        if samples.len() < 6 {
            return Err(NotApplicable::Unresolved);
        }
        Ok(())
    }

    /// The first state of each fault, and how many it has.
    fn taps(&self) -> [(usize, usize); 2] {
        let [taps1, taps2] = self.design.smoothing.taps();
        [(ERROR_STATES, taps1), (ERROR_STATES + taps1, taps2)]
    }

    /// By how many samples each tap lags, in ascending order.
    fn lags(&self, step_s: f64) -> Vec<f64> {
        let [taps1, taps2] = self.design.smoothing.taps();
        let lag = |tap: usize| {
            let lag = tap as f64 * self.design.smoothing.spacing_s / step_s;
            // A decimal multiple of the step is one up to rounding.
            if (lag - lag.round()).abs() < 1e-6 {
                lag.round()
            } else {
                lag
            }
        };
        (0..taps1.max(taps2)).map(lag).collect()
    }

    /// The observer's state with all taps, those that the loop leaves out at rest.
    fn start(&self, sample: &Sample) -> Full {
        let mut full = [0.0; MOST_STATES];
        full[..ERROR_STATES].copy_from_slice(&sample.estimate[..ERROR_STATES]);
        let simulated = sample.estimate[ERROR_STATES..].chunks(FLOWN_TAPS);
        for ((first, taps), simulated) in self.taps().into_iter().zip(simulated) {
            for (tap, &value) in simulated.iter().enumerate().take(taps) {
                full[first + tap] = value;
            }
        }
        full
    }

    /// The observer's state at the next sample: what the loop integrates as it ran, the taps that it leaves out, a
    /// delay line driven by the taps before and by the innovation, by the implicit trapezoidal rule.
    fn advance(&self, estimate: &Full, samples: &[Sample], step_s: f64) -> Full {
        let mut next = self.start(&samples[1]);
        let spacing_s = self.design.smoothing.spacing_s;
        let decay = step_s / (2.0 * spacing_s);
        let innovations = [&samples[0], &samples[1]].map(|sample| self.innovation(sample));
        for (first, taps) in self.taps() {
            for state in first + FLOWN_TAPS..first + taps {
                let row = &self.gains.l[state];
                let driven = |before: f64, innovation: &[f64; 3]| {
                    let injected: f64 = row.iter().zip(innovation).map(|(l, y)| l * y).sum();
                    before / spacing_s - injected
                };
                let drive = driven(estimate[state - 1], &innovations[0])
                    + driven(next[state - 1], &innovations[1]);
                next[state] =
                    (estimate[state] * (1.0 - decay) + drive * step_s / 2.0) / (1.0 + decay);
            }
        }
        next
    }

    /// y - yhat of (20); C0 r cancels.
    fn innovation(&self, sample: &Sample) -> [f64; 3] {
        let missed = sample.faults[1] - sample.estimate[ERROR_STATES + FLOWN_TAPS];
        let enters = self.design.sensor_fault_input;
        std::array::from_fn(|row| sample.error[row] - sample.estimate[row] + enters[row] * missed)
    }

    /// The terms of u_fb = K ehat, (21).
    fn terms(&self, estimate: &Full) -> impl Iterator<Item = f64> {
        self.gains
            .k
            .iter()
            .zip(*estimate)
            .map(|(k, state)| k * state)
    }

    /// ebar' Q1 ebar + e~' Q2 e~ + R u_fb^2.
    fn weighted(&self, truth: &Full, estimate: &Full) -> f64 {
        let ChannelDesign { q1, q2, r, .. } = &self.design;
        let tracking = q1.iter().zip(truth).map(|(q, error)| q * error * error);
        let missed = truth.iter().zip(estimate).map(|(truth, own)| truth - own);
        let estimation = q2.iter().zip(missed).map(|(q, missed)| q * missed * missed);
        let feedback: f64 = self.terms(estimate).sum();
        tracking.chain(estimation).sum::<f64>() + r * feedback * feedback
    }

    /// V = ebar' P1 ebar + e~' P2 e~.
    fn lyapunov(&self, truth: &Full, estimate: &Full) -> f64 {
        let missed: Full = std::array::from_fn(|i| truth[i] - estimate[i]);
        let of = |p: &DMatrix<f64>, state: &Full| {
            let entries = (0..p.nrows()).flat_map(|i| (0..p.ncols()).map(move |j| (i, j)));
            entries
                .map(|(i, j)| p[(i, j)] * state[i] * state[j])
                .sum::<f64>()
        };
        of(&self.p1, truth) + of(&self.p2, &missed)
    }
}

/// What (24) adds up.
#[derive(Default)]
struct Sums {
    weighted: f64,
    /// Of v~, with the derivatives of each width.
    energy: [f64; 2],
    initial: f64,
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.weighted += other.weighted;
        self.initial += other.initial;
        for (energy, other) in self.energy.iter_mut().zip(other.energy) {
            *energy += other;
        }
    }
}

/// A stretch of an episode and the derivatives of its faults.
struct ChannelTrajectory<'a> {
    inequality: &'a AttenuationInequality,
    stretch: &'a Stretch<'a>,
    /// By how many samples each tap lags.
    lags: Vec<f64>,
    /// Of each width, `[sample][fault]`.
    rates: &'a [Vec<[f64; 2]>; 2],
}

impl ChannelTrajectory<'_> {
    /// Whether a tap of a fault begins at sample `k`, `k` at least 1.
    fn begins(&self, k: usize) -> bool {
        let reach = (k - 1) as f64..k as f64;
        let begins = |lag: &f64| reach.start < *lag && *lag <= reach.end;
        self.lags.iter().any(begins)
    }

    /// The channel at sample `k`, with the taps of the faults that have begun by sample `since`: a tap that lags is
    /// zero until then.
    fn instant(&self, k: usize, since: usize) -> Instant {
        let inequality = self.inequality;
        let mut truth = [0.0; MOST_STATES];
        let mut model_error = [[0.0; MOST_STATES]; 2];
        truth[..ERROR_STATES].copy_from_slice(&self.stretch.samples[k].error);
        for (fault, (first, taps)) in inequality.taps().into_iter().enumerate() {
            for tap in 0..taps {
                let lag = self.lags[tap];
                if lag <= since as f64 {
                    let place = k as f64 - lag;
                    truth[first + tap] = between(place, |k| self.stretch.samples[k].faults[fault]);
                    for (v, rates) in model_error.iter_mut().zip(self.rates) {
                        v[first + tap] = between(place, |k| rates[k][fault]);
                    }
                }
            }
            for row in first..first + taps {
                let expected: f64 = (first..first + taps)
                    .map(|column| inequality.a[(row, column)] * truth[column])
                    .sum();
                for v in &mut model_error {
                    v[row] -= expected;
                }
            }
        }
        Instant { truth, model_error }
    }
}

/// A sampled value at a place between samples, linearly.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a place within the samples"
)]
fn between(place: f64, value: impl Fn(usize) -> f64) -> f64 {
    let before = place.floor() as usize;
    let share = place - place.floor();
    if share == 0.0 {
        value(before)
    } else {
        value(before) * (1.0 - share) + value(before + 1) * share
    }
}

/// Derivatives of both faults at every sample: central differences over `width` steps to each side, one-sided of the
/// same order at the ends.
fn rates(step_s: f64, samples: &[Sample], width: usize) -> Vec<[f64; 2]> {
    let last = samples.len() - 1;
    let over = 1.0 / (2.0 * width as f64 * step_s);
    let at = |k: usize| samples[k].faults;
    let rate = |k: usize| -> [f64; 2] {
        std::array::from_fn(|fault| {
            let f = |k: usize| at(k)[fault];
            over * if k < width {
                4.0 * f(k + width) - 3.0 * f(k) - f(k + 2 * width)
            } else if k + width > last {
                3.0 * f(k) - 4.0 * f(k - width) + f(k - 2 * width)
            } else {
                f(k + width) - f(k - width)
            }
        })
    };
    (0..samples.len()).map(rate).collect()
}
