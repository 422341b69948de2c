//! BCa interval of a median, with infinitely many resamples.

use statrs::function::erf::{erfc, erfc_inv};

use super::binomial;
use super::interval::{Estimate, Interval, is_level};
use super::normal::two_sided_z;
use super::search::first_rank;

/// Median with its bias-corrected and accelerated (BCa) bootstrap interval (Efron 1987, JASA
/// 82:171-185) over the ideal bootstrap, computed exactly instead of by resampling.
///
/// **Bootstrap distribution.** Let k of the n values be at or below t. A resample of size n holds a
/// binomial (n, k/n) number of values at or below t, and its r-th smallest value is at or below t
/// when that number is at least r. So the distribution function of a resampled order statistic is
/// a binomial tail at every value, and constant between them.
///
/// **Even n.** The median is the mean of the two middle values. A resampled median is taken to be
/// either of its two middle values, each with probability 1/2, and not their mean. This keeps the
/// bootstrap a matter of ranks: its distribution is symmetric in them, the ends are values of the
/// data, and the interval of a monotone function of the values is that function of the interval.
///
/// **Bias correction.** z0 is the normal quantile of the probability that a resampled median is
/// below the observed one, ties counted half. It is 0 unless values tie with the median, and that
/// probability stays within [1/4, 3/4].
///
/// **Acceleration.** From the jackknife: 0 for even n and at most about n^(-3/2) / 3 for odd n, as
/// the leave-one-out medians take two values, equally often but for one of them.
///
/// **Coverage** at 95 %, for continuous values of any distribution: 94.1 % to 95.7 % for n from 200
/// to 1000, 93.0 % to 96.0 % from 50, but as low as 90.7 % from 20 and 87.5 % below; for so few values
/// [`quantile_interval`](super::quantile_interval) at q = 1/2 is the safer choice.
///
/// Values may be infinite: log(A / B) is `+inf` where A alone diverged and `-inf` where B alone did.
/// The mean of `-inf` and `+inf` is taken as 0, the tie. Where no distribution-free interval of the level exists
/// (2^(1 - n) > 1 - level; n < 6 at 95 %) the interval is (-inf, +inf). `None` for no values, a NaN,
/// or a level outside (0, 1).
pub fn median_bca(values: &[f64], level: f64) -> Option<Estimate> {
    if values.is_empty() || values.iter().any(|value| value.is_nan()) || !is_level(level) {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let median = middle(&sorted);
    let n = sorted.len();
    if (1.0 - n as f64).exp2() > 1.0 - level {
        return Some(Estimate {
            value: median,
            interval: Interval {
                lower: f64::NEG_INFINITY,
                upper: f64::INFINITY,
            },
        });
    }

    let below = sorted.partition_point(|&value| value < median);
    let at_most = sorted.partition_point(|&value| value <= median);
    let z0 = normal_quantile(f64::midpoint(
        median_distribution(below, n),
        median_distribution(at_most, n),
    ));
    let acceleration = jackknife_acceleration(&sorted);
    let end = |z: f64| {
        let shifted = z0 + z;
        let probability = normal_distribution(z0 + shifted / (1.0 - acceleration * shifted));
        let rank = first_rank(n, |rank| median_distribution(rank, n) >= probability);
        sorted[rank.unwrap_or(n) - 1]
    };
    let z = two_sided_z(level);
    Some(Estimate {
        value: median,
        interval: Interval {
            lower: end(-z),
            upper: end(z),
        },
    })
}

/// Probability that the median of a resample is at or below the `rank`-th smallest of `n` values.
fn median_distribution(rank: usize, n: usize) -> f64 {
    let share = rank as f64 / n as f64;
    let (lower_middle, upper_middle) = (n.div_ceil(2) as u64, n as u64 / 2 + 1);
    let at_least = |order: u64| binomial::tails(order, n as u64, share).from;
    f64::midpoint(at_least(lower_middle), at_least(upper_middle))
}

/// Acceleration of the median of ascending values: the skewness of its n leave-one-out values
/// divided by -6 sqrt(n) (Efron 1987, section 7).
///
/// For even n, leaving out a lower value leaves the upper middle one as median, and conversely:
/// two values n/2 times each, which have no skewness. For odd n = 2m - 1, with the gaps `up` and
/// `down` from the median to its neighbours, the leave-one-out medians are +up/2 and -down/2
/// (m - 1 times each) and (up - down)/2 (once) away from it: only that single value is out of
/// balance.
fn jackknife_acceleration(sorted: &[f64]) -> f64 {
    let n = sorted.len();
    let half = n / 2;
    if n < 3 || n.is_multiple_of(2) {
        return 0.0;
    }
    let down = gap(sorted[half - 1], sorted[half]);
    let up = gap(sorted[half], sorted[half + 1]);
    let wider = down.max(up);
    if wider <= 0.0 {
        return 0.0;
    }
    // Only their ratio matters, and in it an infinite gap outweighs every finite one.
    let relative = |gap: f64| if gap < wider { gap / wider } else { 1.0 };
    let (down, up) = (relative(down), relative(up));

    let weighted = [(up, half as f64), (-down, half as f64), (up - down, 1.0)];
    let mean = weighted.iter().map(|(d, w)| w * d).sum::<f64>() / n as f64;
    let power_sum = |power: i32| -> f64 {
        weighted
            .iter()
            .map(|(d, w)| w * (mean - d).powi(power))
            .sum()
    };
    power_sum(3) / (6.0 * power_sum(2).powf(1.5))
}

/// Distance between ascending values; 0 between equal infinities.
fn gap(lower: f64, upper: f64) -> f64 {
    if lower < upper { upper - lower } else { 0.0 }
}

fn middle(sorted: &[f64]) -> f64 {
    let (lower, upper) = (sorted[(sorted.len() - 1) / 2], sorted[sorted.len() / 2]);
    let mean = f64::midpoint(lower, upper);
    if mean.is_nan() { 0.0 } else { mean }
}

fn normal_distribution(z: f64) -> f64 {
    erfc(-z / std::f64::consts::SQRT_2) / 2.0
}

fn normal_quantile(probability: f64) -> f64 {
    -std::f64::consts::SQRT_2 * erfc_inv(2.0 * probability)
}
