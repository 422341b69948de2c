//! What is measured of a curve.

use std::f64::consts::TAU;
use std::ops::Range;

/// A curve: times, s, and values.
#[derive(Debug, Clone)]
pub(super) struct Series(pub(super) Vec<(f64, f64)>);

impl Series {
    /// The values within a span of time.
    pub(super) fn within(&self, span_s: Range<f64>) -> impl Iterator<Item = f64> + '_ {
        let own = self.0.iter().filter(move |(t_s, _)| span_s.contains(t_s));
        own.map(|(_, value)| *value)
    }

    /// The values from a time on.
    pub(super) fn after(&self, from_s: f64) -> impl Iterator<Item = f64> + '_ {
        self.within(from_s..f64::INFINITY)
    }

    /// The largest size within a span of time.
    pub(super) fn largest(&self, span_s: Range<f64>) -> f64 {
        top(self.within(span_s).map(f64::abs))
    }

    /// The last time within a span at which the size is above a bound, s; the span's begin if it never is.
    pub(super) fn last_above(&self, bound: f64, span_s: Range<f64>) -> f64 {
        let begin_s = span_s.start;
        let own = self.0.iter().filter(|(t_s, _)| span_s.contains(t_s));
        let above = own.filter(|(_, value)| value.abs() > bound);
        above.map(|(t_s, _)| *t_s).fold(begin_s, f64::max)
    }

    /// Another curve at the same times taken off.
    pub(super) fn less(&self, other: &Self) -> Self {
        let pairs = self.0.iter().zip(&other.0);
        Self(pairs.map(|((t_s, a), (_, b))| (*t_s, a - b)).collect())
    }

    /// The curve divided by a number.
    pub(super) fn over(&self, by: f64) -> Self {
        Self(
            self.0
                .iter()
                .map(|(t_s, value)| (*t_s, value / by))
                .collect(),
        )
    }

    /// The slopes between samples, 1/s.
    pub(super) fn slopes(&self) -> Self {
        let pairs = self.0.windows(2).filter_map(|pair| match pair {
            [(t0, a), (t1, b)] => Some((*t0, (b - a) / (t1 - t0))),
            _ => None,
        });
        Self(pairs.collect())
    }

    /// The part at a frequency over whole periods from a time on: amplitude, and the share of the variance that it
    /// explains.
    pub(super) fn wave(&self, rad_s: f64, from_s: f64) -> Wave {
        let end_s = self.0.last().map_or(0.0, |point| point.0);
        let period_s = TAU / rad_s;
        let span_s = from_s..from_s + ((end_s - from_s) / period_s).floor() * period_s;
        let own = || self.0.iter().filter(|(t_s, _)| span_s.contains(t_s));
        let count = own().map(|_| 1.0).sum::<f64>();
        let mean_of = |of: &dyn Fn(f64, f64) -> f64| {
            own().map(|(t_s, value)| of(*t_s, *value)).sum::<f64>() / count
        };
        let mean = mean_of(&|_, value| value);
        let variance = mean_of(&|_, value| (value - mean).powi(2));
        let sine = mean_of(&|t_s, value| value * (rad_s * t_s).sin());
        let cosine = mean_of(&|t_s, value| value * (rad_s * t_s).cos());
        let amplitude = 2.0 * sine.hypot(cosine);
        Wave {
            amplitude,
            share: 0.5 * amplitude.powi(2) / variance,
        }
    }
}

/// The part of a curve at a frequency.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wave {
    pub(super) amplitude: f64,
    /// Of the variance.
    pub(super) share: f64,
}

/// The largest; not a number of none, or if one of them is not.
pub(super) fn top(values: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |a: f64, b: f64| if a.is_nan() || a > b { a } else { b };
    values.into_iter().reduce(larger).unwrap_or(f64::NAN)
}

/// The smallest; not a number of none, or if one of them is not.
pub(super) fn bottom(values: impl IntoIterator<Item = f64>) -> f64 {
    -top(values.into_iter().map(|value| -value))
}

/// A share in percent; a dash for none.
pub(super) fn percent(share: f64) -> String {
    if share.is_nan() {
        return "-".into();
    }
    format!("{:.1} %", 100.0 * share)
}
