//! Distributions of a campaign's random quantities, sampled by inversion: one uniform number in, one value out, so that
//! a quantity's draw has one address whatever its distribution.

use serde::Serialize;
use statrs::function::erf::{erf, erfc_inv};
use std::f64::consts::SQRT_2;
use std::fmt;

/// A distribution with parameters that make sense.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Distribution {
    /// Always the same value.
    Constant(f64),
    /// Uniform on [low, high].
    Uniform {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// Uniform in the logarithm on [low, high], 0 < low.
    LogUniform {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// Normal.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        std: f64,
    },
    /// Normal, restricted to [low, high].
    TruncatedNormal {
        /// Mean before truncation.
        mean: f64,
        /// Standard deviation before truncation.
        std: f64,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// One of `values`, with probabilities whose running sums are `cumulative` (the last is 1).
    Choice {
        /// The values.
        values: Vec<f64>,
        /// Running sums of the probabilities.
        cumulative: Vec<f64>,
    },
}

impl Distribution {
    /// The value at probability `unit` in (0, 1).
    #[must_use]
    pub fn quantile(&self, unit: f64) -> f64 {
        match *self {
            Self::Constant(value) => value,
            Self::Uniform { low, high } => low + (high - low) * unit,
            Self::LogUniform { low, high } => (low.ln() + (high.ln() - low.ln()) * unit)
                .exp()
                .clamp(low, high),
            Self::Normal { mean, std } => mean + std * normal_quantile(unit),
            Self::TruncatedNormal {
                mean,
                std,
                low,
                high,
            } => {
                let (below, above) = (
                    normal_cdf((low - mean) / std),
                    normal_cdf((high - mean) / std),
                );
                (mean + std * normal_quantile(below + (above - below) * unit)).clamp(low, high)
            }
            Self::Choice {
                ref values,
                ref cumulative,
            } => {
                let chosen = cumulative
                    .partition_point(|&sum| sum < unit)
                    .min(values.len() - 1);
                values[chosen]
            }
        }
    }

    /// The smallest interval that holds every value.
    #[must_use]
    pub fn support(&self) -> (f64, f64) {
        match *self {
            Self::Constant(value) => (value, value),
            Self::Uniform { low, high }
            | Self::LogUniform { low, high }
            | Self::TruncatedNormal { low, high, .. } => (low, high),
            Self::Normal { mean, std: 0.0 } => (mean, mean),
            Self::Normal { .. } => (f64::NEG_INFINITY, f64::INFINITY),
            Self::Choice { ref values, .. } => values
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| {
                    (low.min(v), high.max(v))
                }),
        }
    }

    /// Whether every draw is the same.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        let (low, high) = self.support();
        low >= high
    }
}

/// The distribution as a campaign file would say it.
impl fmt::Display for Distribution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(value) => write!(f, "{value}"),
            Self::Uniform { low, high } => write!(f, "uniform [{low}, {high}]"),
            Self::LogUniform { low, high } => write!(f, "log-uniform [{low}, {high}]"),
            Self::Normal { mean, std } => write!(f, "normal, mean {mean}, std {std}"),
            Self::TruncatedNormal {
                mean,
                std,
                low,
                high,
            } => {
                write!(f, "normal, mean {mean}, std {std}, within [{low}, {high}]")
            }
            Self::Choice { values, .. } => write!(f, "one of {values:?}"),
        }
    }
}

/// Standard normal quantile.
fn normal_quantile(unit: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * unit)
}

/// Standard normal distribution function.
fn normal_cdf(x: f64) -> f64 {
    0.5 * (1.0 + erf(x / SQRT_2))
}
