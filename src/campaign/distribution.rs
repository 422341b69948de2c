//! Distributions of a campaign's random quantities, sampled by inversion: one uniform number in, one value out, so that
//! a quantity's draw has one address whatever its distribution.

use super::file::{DistributionFile, TruncatedNormalFile};
use serde::Serialize;
use statrs::function::erf::{erf, erfc_inv};
use std::f64::consts::SQRT_2;

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
    /// The distribution that a file describes; what is wrong and what to do if it describes none.
    pub(super) fn read(file: &DistributionFile) -> Result<Self, Refusal> {
        if file.weights.is_some() && file.choice.is_none() {
            return Err(["weights belong to a choice", "add `choice` or remove them"]);
        }
        let DistributionFile {
            uniform,
            log_uniform,
            normal,
            truncated_normal,
            choice,
            weights,
            per: _,
        } = file;
        match (uniform, log_uniform, normal, truncated_normal, choice) {
            (Some(ends), None, None, None, None) => {
                let (low, high) = range(ends.0)?;
                Ok(Self::Uniform { low, high })
            }
            (None, Some(ends), None, None, None) => log_uniform_on(ends.0),
            (None, None, Some(normal), None, None) => {
                let (mean, std) = mean_and_spread(normal.mean, normal.std)?;
                Ok(Self::Normal { mean, std })
            }
            (None, None, None, Some(normal), None) => truncated(normal),
            (None, None, None, None, Some(values)) => choose(values, weights.as_deref()),
            (None, None, None, None, None) => Err([
                "a distribution has one of uniform, log_uniform, normal, truncated_normal, choice",
                "add one",
            ]),
            _ => Err([
                "a distribution has only one of uniform, log_uniform, normal, truncated_normal, choice",
                "keep one",
            ]),
        }
    }

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

/// What is wrong with a distribution, and what to do.
type Refusal = [&'static str; 2];

fn range([low, high]: [f64; 2]) -> Result<(f64, f64), Refusal> {
    if low <= high && (high - low).is_finite() {
        Ok((low, high))
    } else {
        Err([
            "a range goes from a low to a high finite number",
            "swap or correct its ends",
        ])
    }
}

fn mean_and_spread(mean: f64, std: f64) -> Result<(f64, f64), Refusal> {
    if mean.is_finite() && std.is_finite() && std >= 0.0 {
        Ok((mean, std))
    } else {
        Err([
            "a mean is finite, a standard deviation is finite and not negative",
            "correct them",
        ])
    }
}

fn log_uniform_on(ends: [f64; 2]) -> Result<Distribution, Refusal> {
    let (low, high) = range(ends)?;
    if low > 0.0 {
        Ok(Distribution::LogUniform { low, high })
    } else {
        Err([
            "a logarithm needs positive ends",
            "use uniform or a positive range",
        ])
    }
}

fn truncated(normal: &TruncatedNormalFile) -> Result<Distribution, Refusal> {
    let (low, high) = range([normal.low, normal.high])?;
    let (mean, std) = mean_and_spread(normal.mean, normal.std)?;
    // Beyond six deviations the tail holds too few doubles to draw from.
    if std > 0.0 && low <= mean + 6.0 * std && high >= mean - 6.0 * std {
        Ok(Distribution::TruncatedNormal {
            mean,
            std,
            low,
            high,
        })
    } else {
        Err([
            "the interval must meet the six standard deviations around the mean",
            "widen the interval or the deviation",
        ])
    }
}

fn choose(values: &[f64], weights: Option<&[f64]>) -> Result<Distribution, Refusal> {
    let weights = weights.map_or_else(|| vec![1.0; values.len()], <[f64]>::to_vec);
    let sum: f64 = weights.iter().sum();
    if !values.iter().all(|value| value.is_finite()) {
        return Err(["the values must be finite", "give numbers"]);
    }
    if values.is_empty()
        || weights.len() != values.len()
        || !weights.iter().all(|weight| *weight >= 0.0)
        || !(sum > 0.0 && sum.is_finite())
    {
        return Err([
            "a choice has values, and as many weights, none negative and not all zero",
            "correct the lists",
        ]);
    }
    let cumulative = weights
        .iter()
        .scan(0.0, |running, weight| {
            *running += weight / sum;
            Some(*running)
        })
        .collect();
    Ok(Distribution::Choice {
        values: values.to_vec(),
        cumulative,
    })
}

/// Standard normal quantile.
fn normal_quantile(unit: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * unit)
}

/// Standard normal distribution function.
fn normal_cdf(x: f64) -> f64 {
    0.5 * (1.0 + erf(x / SQRT_2))
}
