//! What is kept of an episode: sums and extremes of each channel, updated once per step; no trajectory is stored.

use super::lanes::{Lane, Real};

/// Numbers of a channel that are kept by name, and travel to and from the shaders in this order.
macro_rules! kept {
    ($(#[$outer:meta])* $kept:ident { $($(#[$doc:meta])* $name:ident,)* }) => {
        $(#[$outer])*
        #[derive(Clone, Copy)]
        pub(crate) struct $kept<L> { $($(#[$doc])* pub(crate) $name: L,)* }

        impl<L: Copy> $kept<L> {
            /// The names, as in the shaders.
            pub(crate) const NAMES: &'static [&'static str] = &[$(stringify!($name)),*];

            /// Each number from its place.
            pub(crate) fn from_fn(mut number: impl FnMut(usize) -> L) -> Self {
                let mut places = 0..;
                Self { $($name: number(places.next().unwrap_or_default()),)* }
            }

            /// The same of each number.
            pub(crate) fn map<M>(self, of: impl Fn(L) -> M) -> $kept<M> {
                $kept { $($name: of(self.$name),)* }
            }

            /// The numbers in order.
            #[cfg(test)]
            pub(crate) fn numbers(&self) -> Vec<L> {
                vec![$(self.$name),*]
            }
        }

        impl<L: Lane> $kept<L> {
            fn zero() -> Self {
                Self { $($name: L::number(0.0),)* }
            }
        }
    };
}

kept! {
    /// Sums over steps.
    Sums {
        square,
        absolute,
        effort,
        actuator_fault,
        sensor_fault,
        limited,
    }
}

kept! {
    /// Largest sizes.
    Extremes {
        error,
        command,
        rate,
    }
}

/// Metrics of one channel.
#[derive(Clone, Copy)]
pub(crate) struct Metrics<L> {
    /// Of the steps since the last [`Metrics::flush`]: short sums keep the digits of single precision.
    pub(crate) recent: Sums<L>,
    /// Of the steps before.
    pub(crate) total: Sums<L>,
    pub(crate) largest: Extremes<L>,
    /// The last step with |e| above the settled error; -1 if there is none.
    pub(crate) outside: L,
    /// The same, up to the agent's first fault.
    pub(crate) outside_before_fault: L,
}

/// What one channel shows at the start of a step.
pub(crate) struct Sample<L> {
    pub(crate) error: L,
    pub(crate) error_rate: L,
    pub(crate) command: L,
    pub(crate) excess: L,
    /// f1hat - f1.
    pub(crate) actuator_fault_error: L,
    /// f2hat - f2.
    pub(crate) sensor_fault_error: L,
}

/// A metric of a channel.
#[derive(Debug, Clone, Copy)]
pub struct Metric {
    /// Its column in channels.parquet.
    pub name: &'static str,
    /// Its value.
    pub of: fn(&ChannelOutcome) -> f64,
}

macro_rules! metrics {
    (
        errors { $($(#[$error_doc:meta])* $error:ident,)* }
        others { $($(#[$other_doc:meta])* $other:ident,)* }
    ) => {
        /// The metrics of one channel of one episode. Averages and sums are over the steps from settle_s on, each step
        /// counted at its start; effort, largest command and limited share are over the whole run. The command u is
        /// that of [`super::ChannelSample`].
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        pub struct ChannelOutcome {
            $($(#[$error_doc])* pub $error: f64,)*
            $($(#[$other_doc])* pub $other: f64,)*
            /// The last step with |e| above the settled error, if any.
            pub last_outside: Option<u32>,
            /// The same, up to the agent's first fault.
            pub last_outside_before_fault: Option<u32>,
        }

        impl ChannelOutcome {
            /// The metrics in order, to be kept outside of memory.
            pub(crate) fn numbers(&self) -> [f64; METRICS] {
                [$(self.$error,)* $(self.$other,)*]
            }

            /// The outcome of the same numbers.
            pub(crate) fn of_numbers(
                numbers: [f64; METRICS],
                [last_outside, last_outside_before_fault]: [Option<u32>; 2],
            ) -> Self {
                let [$($error,)* $($other,)*] = numbers;
                Self { $($error,)* $($other,)* last_outside, last_outside_before_fault }
            }
        }

        /// Metrics of a channel.
        pub(crate) const METRICS: usize = ERROR_METRICS.len() + OTHER_METRICS.len();

        /// The metrics of the tracking error.
        pub const ERROR_METRICS: &[Metric] = &[
            $(Metric { name: stringify!($error), of: |outcome| outcome.$error }),*
        ];

        /// The metrics of the command and of the estimates.
        pub const OTHER_METRICS: &[Metric] = &[
            $(Metric { name: stringify!($other), of: |outcome| outcome.$other }),*
        ];
    };
}

metrics! {
    errors {
        /// Root mean square of e.
        rmse,
        /// Largest |e|.
        max_abs,
        /// Integral of e^2 dt.
        ise,
        /// Integral of |e| dt.
        iae,
        /// Largest |e'|.
        peak_rate,
    }
    others {
        /// Integral of u^2 dt.
        effort,
        /// Largest |u|.
        u_max,
        /// Share of the steps at which a limit cuts the command.
        saturated_fraction,
        /// Root mean square of f1hat - f1.
        f1_rms_error,
        /// Root mean square of f2hat - f2.
        f2_rms_error,
    }
}

impl<L: Lane> Metrics<L> {
    pub(crate) fn new() -> Self {
        let never = L::number(-1.0);
        Self {
            recent: Sums::zero(),
            total: Sums::zero(),
            largest: Extremes::zero(),
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
        self.largest.command = self.largest.command.max(sample.command.abs());
        let recent = &mut self.recent;
        recent.effort = sample.command.mul_add(sample.command, recent.effort);
        if LIMITED {
            let (zero, one) = (L::number(0.0), L::number(1.0));
            recent.limited = recent.limited + L::select_le(sample.excess.abs(), zero, zero, one);
        }
        if SETTLED {
            self.largest.error = self.largest.error.max(size);
            self.largest.rate = self.largest.rate.max(sample.error_rate.abs());
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
        let (total, largest) = (self.total.map(lanes), self.largest.map(lanes));
        let [outside, before] = [self.outside, self.outside_before_fault].map(lanes);
        let count = f64::from(settled);
        for (lane, out) in out.iter_mut().enumerate() {
            *out = ChannelOutcome {
                rmse: (total.square[lane] / count).sqrt(),
                max_abs: largest.error[lane],
                ise: total.square[lane] * step_s,
                iae: total.absolute[lane] * step_s,
                peak_rate: largest.rate[lane],
                effort: total.effort[lane] * step_s,
                u_max: largest.command[lane],
                saturated_fraction: total.limited[lane] / f64::from(steps),
                f1_rms_error: (total.actuator_fault[lane] / count).sqrt(),
                f2_rms_error: (total.sensor_fault[lane] / count).sqrt(),
                last_outside: step_number(outside[lane]),
                last_outside_before_fault: step_number(before[lane]),
            };
        }
    }
}

impl Metrics<f32> {
    /// The metrics that the shaders kept, with nothing recent left: the extremes, then the sums, each by its place;
    /// steps are -1 where there is none.
    pub(crate) fn kept(
        number: impl Fn(usize) -> f32,
        [outside, outside_before_fault]: [f32; 2],
    ) -> Self {
        let sums = Extremes::<f32>::NAMES.len();
        Self {
            recent: Sums::zero(),
            total: Sums::from_fn(|k| number(sums + k)),
            largest: Extremes::from_fn(&number),
            outside,
            outside_before_fault,
        }
    }
}

impl ChannelOutcome {
    /// Whether every sum stayed finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let mut metrics = ERROR_METRICS.iter().chain(OTHER_METRICS);
        metrics.all(|metric| (metric.of)(self).is_finite())
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
