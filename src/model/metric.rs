//! What is kept of an episode: sums and extremes of each channel, updated once per step; no trajectory is stored.

use super::lanes::{Lane, Real};

/// Sums over steps.
#[derive(Clone, Copy)]
pub(crate) struct Sums<L> {
    pub(crate) square: L,
    pub(crate) absolute: L,
    pub(crate) effort: L,
    pub(crate) actuator_fault: L,
    pub(crate) sensor_fault: L,
    pub(crate) limited: L,
}

/// Metrics of one channel.
#[derive(Clone, Copy)]
pub(crate) struct Metrics<L> {
    /// Of the steps since the last [`Metrics::flush`]: short sums keep the digits of single precision.
    pub(crate) recent: Sums<L>,
    /// Of the steps before.
    pub(crate) total: Sums<L>,
    pub(crate) largest: L,
    pub(crate) largest_command: L,
    /// The last step with |e| above the settled error; -1 if there is none.
    pub(crate) outside: L,
    /// The same, up to the agent's first fault.
    pub(crate) outside_before_fault: L,
}

/// What one channel shows at the start of a step.
pub(crate) struct Sample<L> {
    pub(crate) error: L,
    pub(crate) command: L,
    pub(crate) excess: L,
    /// f1hat - f1.
    pub(crate) actuator_fault_error: L,
    /// f2hat - f2.
    pub(crate) sensor_fault_error: L,
}

/// The metrics of one channel of one episode. Averages and sums are over the steps from settle_s on, each step counted
/// at its start; effort, largest command and limited share are over the whole run. The command u is that of
/// [`super::ChannelSample`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ChannelOutcome {
    /// Root mean square of e.
    pub rmse: f64,
    /// Largest |e|.
    pub max_abs: f64,
    /// Integral of e^2 dt.
    pub ise: f64,
    /// Integral of |e| dt.
    pub iae: f64,
    /// Integral of u^2 dt.
    pub effort: f64,
    /// Largest |u|.
    pub u_max: f64,
    /// Share of the steps at which a limit cuts the command.
    pub saturated_fraction: f64,
    /// Root mean square of f1hat - f1.
    pub f1_rms_error: f64,
    /// Root mean square of f2hat - f2.
    pub f2_rms_error: f64,
    /// The last step with |e| above the settled error, if any.
    pub last_outside: Option<u32>,
    /// The same, up to the agent's first fault.
    pub last_outside_before_fault: Option<u32>,
}

impl<L: Lane> Sums<L> {
    fn zero() -> Self {
        let zero = L::number(0.0);
        Self {
            square: zero,
            absolute: zero,
            effort: zero,
            actuator_fault: zero,
            sensor_fault: zero,
            limited: zero,
        }
    }
}

impl<L: Lane> Metrics<L> {
    pub(crate) fn new() -> Self {
        let (zero, never) = (L::number(0.0), L::number(-1.0));
        Self {
            recent: Sums::zero(),
            total: Sums::zero(),
            largest: zero,
            largest_command: zero,
            outside: never,
            outside_before_fault: never,
        }
    }

    /// Takes in a sample at step `now`; `SETTLED` from settle_s on.
    #[inline(always)]
    pub(crate) fn take<const SETTLED: bool, const LIMITED: bool>(
        &mut self,
        sample: &Sample<L>,
        settled_error: L::Real,
        now: L,
    ) {
        let size = sample.error.abs();
        self.outside = L::select_le(size, L::splat(settled_error), self.outside, now);
        self.largest_command = self.largest_command.max(sample.command.abs());
        let recent = &mut self.recent;
        recent.effort = sample.command.mul_add(sample.command, recent.effort);
        if LIMITED {
            let (zero, one) = (L::number(0.0), L::number(1.0));
            recent.limited = recent.limited + L::select_le(sample.excess.abs(), zero, zero, one);
        }
        if SETTLED {
            self.largest = self.largest.max(size);
            recent.square = size.mul_add(size, recent.square);
            recent.absolute = recent.absolute + size;
            let (first, second) = (sample.actuator_fault_error, sample.sensor_fault_error);
            recent.actuator_fault = first.mul_add(first, recent.actuator_fault);
            recent.sensor_fault = second.mul_add(second, recent.sensor_fault);
        }
    }

    /// Moves the recent sums to the totals.
    #[inline(always)]
    pub(crate) fn flush(&mut self) {
        let (recent, total) = (self.recent, &mut self.total);
        total.square = total.square + recent.square;
        total.absolute = total.absolute + recent.absolute;
        total.effort = total.effort + recent.effort;
        total.actuator_fault = total.actuator_fault + recent.actuator_fault;
        total.sensor_fault = total.sensor_fault + recent.sensor_fault;
        total.limited = total.limited + recent.limited;
        self.recent = Sums::zero();
    }

    /// Remembers, in the lanes whose first fault is at `step` or later, how the error stood until then.
    #[inline(always)]
    pub(crate) fn before_fault(&mut self, first_fault: L, step: L) {
        self.outside_before_fault =
            L::select_le(step, first_fault, self.outside, self.outside_before_fault);
    }

    /// The outcome of each lane after `steps` steps, of which `settled` were from settle_s on.
    pub(crate) fn outcomes(
        &self,
        steps: u32,
        settled: u32,
        step_s: f64,
        out: &mut [ChannelOutcome],
    ) {
        let lanes = |value: L| {
            let mut stored = [0.0; super::lanes::MAX_WIDTH];
            value.store(&mut stored);
            stored
        };
        let total = self.total;
        let [square, absolute, effort] = [total.square, total.absolute, total.effort].map(lanes);
        let [first, second, limited] =
            [total.actuator_fault, total.sensor_fault, total.limited].map(lanes);
        let [largest, largest_command] = [self.largest, self.largest_command].map(lanes);
        let [outside, before] = [self.outside, self.outside_before_fault].map(lanes);
        let count = f64::from(settled);
        for (lane, out) in out.iter_mut().enumerate() {
            *out = ChannelOutcome {
                rmse: (square[lane] / count).sqrt(),
                max_abs: largest[lane],
                ise: square[lane] * step_s,
                iae: absolute[lane] * step_s,
                effort: effort[lane] * step_s,
                u_max: largest_command[lane],
                saturated_fraction: limited[lane] / f64::from(steps),
                f1_rms_error: (first[lane] / count).sqrt(),
                f2_rms_error: (second[lane] / count).sqrt(),
                last_outside: step_number(outside[lane]),
                last_outside_before_fault: step_number(before[lane]),
            };
        }
    }
}

impl Metrics<f32> {
    /// The metrics that the shaders kept: the sums in the order of [`Sums`], with nothing recent left; steps are -1
    /// where there is none.
    pub(crate) fn kept(
        [
            square,
            absolute,
            effort,
            actuator_fault,
            sensor_fault,
            limited,
        ]: [f32; 6],
        [largest, largest_command]: [f32; 2],
        [outside, outside_before_fault]: [f32; 2],
    ) -> Self {
        let total = Sums {
            square,
            absolute,
            effort,
            actuator_fault,
            sensor_fault,
            limited,
        };
        Self {
            recent: Sums::zero(),
            total,
            largest,
            largest_command,
            outside,
            outside_before_fault,
        }
    }
}

impl ChannelOutcome {
    /// Whether every sum stayed finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        [
            self.rmse,
            self.max_abs,
            self.effort,
            self.u_max,
            self.f1_rms_error,
            self.f2_rms_error,
        ]
        .iter()
        .all(|value| value.is_finite())
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "step numbers, or -1"
)]
fn step_number(step: f64) -> Option<u32> {
    (step >= 0.0).then_some(step as u32)
}

/// Limits of one channel in the precision of the loop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits<R> {
    /// The largest finite number before settle_s, `max_error` after.
    pub(crate) max_error: R,
    /// |e| at or below this counts as settled.
    pub(crate) settled_error: R,
}

impl<R: Real> Limits<R> {
    pub(crate) fn new(max_error: f64, settled_error: f64) -> Self {
        let finite = R::from_f64(max_error);
        Self {
            max_error: if finite <= R::MAX { finite } else { R::MAX },
            settled_error: R::from_f64(settled_error),
        }
    }
}
