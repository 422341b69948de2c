//! Rank correlations, with intervals that assume no distribution.

use super::interval::{Estimate, Interval, is_level};
use super::rank::Ranked;
use super::student::t_quantile;

/// Fewer rows leave the interval of a rank correlation at [-1, 1].
const FEWEST_ROWS: usize = 20;

const UNKNOWN: Interval = Interval {
    lower: -1.0,
    upper: 1.0,
};

/// Spearman's rank correlation of `y` with `x`, over the rows where `x` has a value: Pearson's
/// correlation of the mean ranks (so ties are corrected for, and infinities are just the ends).
///
/// **Interval.** Fisher's z with the standard error of the infinitesimal jackknife: the variance of
/// the influence of a row on the correlation, through its own ranks and through those of all the
/// others (Efron 1982, The Jackknife, the Bootstrap and Other Resampling Plans, chapter 6), and
/// Student's t with n - 2 degrees of freedom. It is consistent whatever the joint distribution and
/// its ties. The usual formula, (1 + rho^2 / 2) / (n - 3) of Bonett and Wright (2000, Psychometrika
/// 65:23-28), is for a normal one: where the scatter of y grows with |x|, or y depends on |x|, as
/// metrics do, it covers 85 % to 89 % instead of 95 % at any n.
///
/// **Coverage** at 95 %, simulated on normal, heteroscedastic, V-shaped, tied and censored pairs,
/// rho from 0 to 0.99: 94 % to 97 % from n = 20 on. Below 20 rows the interval is [-1, 1].
///
/// A sample in perfect order, of which the jackknife sees no variance, has an inner end of
/// 1 - 3 q, with q the upper bound of the probability that two rows are not in order: n / 2
/// disjoint pairs all are, and rho >= 1 - 3 q for any continuous distribution (Daniels 1950,
/// Journal of the Royal Statistical Society B 12:171-181).
///
/// `None` if one of them is constant there, `y` has no value in such a row, or the level is not in
/// (0, 1).
pub fn spearman(x: &Ranked, y: &Ranked, level: f64) -> Option<Estimate> {
    // Both in the order of x, so that rows are positions from here on.
    let (x, y) = (x.along(x)?, y.along(x)?);
    if x.distinct() < 2 || y.distinct() < 2 || !is_level(level) {
        return None;
    }
    let n = x.len() as f64;
    let (f, g) = (x.ascending_ranks(), y.ranks_by_row());
    let covariance = mean(f.iter().zip(&g).map(|(f, g)| f * g), n);
    let scale = (mean(f.iter().map(|f| f * f), n) * mean(g.iter().map(|g| g * g), n)).sqrt();
    let value = (covariance / scale).clamp(-1.0, 1.0);

    let interval = if x.len() < FEWEST_ROWS {
        UNKNOWN
    } else if f.iter().zip(&g).all(|(f, g)| (f - g).abs() < 0.5) {
        Interval {
            lower: perfect_order_bound(n, level),
            upper: 1.0,
        }
    } else if f.iter().zip(&g).all(|(f, g)| (f + g).abs() < 0.5) {
        Interval {
            lower: -1.0,
            upper: -perfect_order_bound(n, level),
        }
    } else {
        let error = jackknife_error(&x, &y, &f, &g);
        let half_width = t_quantile(n - 2.0, level)? * error / (1.0 - value * value);
        Interval {
            lower: (value.atanh() - half_width).tanh(),
            upper: (value.atanh() + half_width).tanh(),
        }
    };
    Some(Estimate { value, interval })
}

/// Standard error of the correlation of the ranks `f` of `x` and `g` of `y`, by row.
fn jackknife_error(x: &Ranked, y: &Ranked, f: &[f64], g: &[f64]) -> f64 {
    let n = f.len() as f64;
    // What a row does to the mean of a product a b of ranks: it is a sample of the product, and it
    // lifts the ranks a of the rows above it in one order, and b in the other.
    let influence = |a: &[f64], b: &[f64], lifts_a: &Ranked, lifts_b: &Ranked| -> Vec<f64> {
        let product = mean(a.iter().zip(b).map(|(a, b)| a * b), n);
        let through_a = sums_above(lifts_a, b);
        let through_b = sums_above(lifts_b, a);
        (0..a.len())
            .map(|i| a[i] * b[i] + through_a[i] + through_b[i] - 3.0 * product)
            .collect()
    };
    let variance = |a: &[f64]| mean(a.iter().map(|a| a * a), n);
    let (variance_f, variance_g) = (variance(f), variance(g));
    let scale = (variance_f * variance_g).sqrt();
    let value = mean(f.iter().zip(g).map(|(f, g)| f * g), n) / scale;

    let (on_fg, on_ff, on_gg) = (
        influence(f, g, x, y),
        influence(f, f, x, x),
        influence(g, g, y, y),
    );
    let squares = (0..f.len()).map(|i| {
        let on_scale = on_ff[i] / variance_f + on_gg[i] / variance_g;
        (on_fg[i] / scale - value / 2.0 * on_scale).powi(2)
    });
    (mean(squares, n) / (n - 1.0)).sqrt()
}

/// Row by row, twice the sum of `values` over the rows above it in the order, those level with it
/// (and itself) counted half; the row lifts their doubled ranks by that.
fn sums_above(order: &Ranked, values: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; values.len()];
    let mut above = 0.0;
    for run in order.runs().rev() {
        let rows = &order.order()[run];
        let level: f64 = rows.iter().map(|&row| values[row as usize]).sum();
        for &row in rows {
            sums[row as usize] = 2.0 * above + level;
        }
        above += level;
    }
    sums
}

/// Lower end of a rank correlation of which n rows show no exception.
fn perfect_order_bound(n: f64, level: f64) -> f64 {
    let out_of_order = -((1.0 - level).ln() * 2.0 / n).exp_m1();
    1.0 - 3.0 * out_of_order
}

/// Somers' D of a parameter by failure, over the rows where `x` has a value: the probability that
/// a failed episode has a larger x than a survived one minus the probability of a smaller one
/// (2 AUC - 1, the rank-biserial correlation). +1 or -1 means that a threshold separates them.
///
/// **Interval.** Wilson's, for the share (1 + D) / 2 of the pairs and an effective number of
/// independent pairs: the one that gives the variance by placements (DeLong, DeLong and
/// Clarke-Pearson 1988, Biometrics 44:837-845; of Brunner and Munzel 2000, Biometrical Journal
/// 42:17-25, with their degrees of freedom for Student's t). That variance vanishes where a sample
/// separates perfectly, so the number is held between min(m, k) for m failures and k survivals,
/// which no distribution can undercut (van Dantzig 1951), and 3 m k / (m + k + 1), that of a
/// parameter without effect. With one failure, or one survival, it is [-1, 1].
///
/// **Coverage** at 95 %, simulated for shifted, scaled, exponential and tied parameters, D from 0
/// to 0.97, from 3 failures among 300 on: 94 % or more, up to 100 % where failures are few or D is
/// near 1.
///
/// `None` if nothing or everything failed there, `x` is constant, `failed` has no value in such a
/// row or more than two, or the level is not in (0, 1).
pub fn somers_d(x: &Ranked, failed: &Ranked, level: f64) -> Option<Estimate> {
    let failed = failed.along(x)?;
    if x.distinct() < 2 || failed.distinct() != 2 || !is_level(level) {
        return None;
    }
    // Centred ranks of two values: the higher one is above 0.
    let failed: Vec<bool> = failed.ranks_by_row().iter().map(|&g| g > 0.0).collect();
    let count = |rows: &[bool]| rows.iter().filter(|&&failed| failed).count() as f64;
    let failures = count(&failed);
    let survivals = failed.len() as f64 - failures;

    // A row's placement: the share of the other group that it beats, ties counted half.
    let (mut failures_below, mut survivals_below) = (0.0, 0.0);
    let (mut sum, mut failure_squares, mut survival_squares) = (0.0, 0.0, 0.0);
    for run in x.runs() {
        let failures_here = count(&failed[run.clone()]);
        let survivals_here = run.len() as f64 - failures_here;
        let of_failures = (survivals_below + survivals_here / 2.0) / survivals;
        let of_survivals = 1.0 - (failures_below + failures_here / 2.0) / failures;
        sum += failures_here * of_failures;
        failure_squares += failures_here * of_failures.powi(2);
        survival_squares += survivals_here * of_survivals.powi(2);
        failures_below += failures_here;
        survivals_below += survivals_here;
    }
    let share = sum / failures;
    let variance_of_mean = |squares: f64, n: f64| {
        let variance = (squares / n - share * share).max(0.0);
        if n > 1.0 { variance / (n - 1.0) } else { 0.0 }
    };
    let by_failures = variance_of_mean(failure_squares, failures);
    let by_survivals = variance_of_mean(survival_squares, survivals);
    let variance = by_failures + by_survivals;

    let fewer = failures.min(survivals);
    let no_effect = 3.0 * failures * survivals / (failures + survivals + 1.0);
    let (pairs, freedom) = if fewer > 1.0 && variance > 0.0 {
        let parts =
            by_failures.powi(2) / (failures - 1.0) + by_survivals.powi(2) / (survivals - 1.0);
        (share * (1.0 - share) / variance, variance.powi(2) / parts)
    } else {
        (fewer, fewer - 1.0)
    };
    let pairs = pairs.min(no_effect).max(fewer);
    // A single failure or survival has no variance, and nothing is known.
    let interval = t_quantile(freedom, level).map_or(UNKNOWN, |t| {
        let centre = share + t * t / (2.0 * pairs);
        let half_width = t * (share * (1.0 - share) / pairs + (t / (2.0 * pairs)).powi(2)).sqrt();
        let end = |share: f64| (2.0 * share - 1.0).clamp(-1.0, 1.0);
        Interval {
            lower: end((centre - half_width) / (1.0 + t * t / pairs)),
            upper: end((centre + half_width) / (1.0 + t * t / pairs)),
        }
    });
    Some(Estimate {
        value: 2.0 * share - 1.0,
        interval,
    })
}

fn mean(values: impl Iterator<Item = f64>, n: f64) -> f64 {
    values.sum::<f64>() / n
}
