//! Binomial probabilities for counts in the millions and beyond.
//!
//! The tails are the regularised incomplete beta function, evaluated here because the continued
//! fraction of `statrs` 0.19 ends after 140 terms whatever the parameters: near the mean its error
//! is 10^-3 at a million trials, where several hundred terms are needed.

use std::f64::consts::TAU;

use statrs::function::factorial::ln_factorial;

/// The two sides of a binomial distribution; the smaller one keeps its relative accuracy.
pub(super) struct Tails {
    /// P(X < k).
    pub(super) below: f64,
    /// P(X >= k).
    pub(super) from: f64,
}

/// P(X = `k`) for X binomial with `n` trials and success probability `p` in (0, 1), by the saddle
/// point (Loader 2000, "Fast and accurate computation of binomial probabilities").
///
/// The logarithms of three factorials would leave an error of n ln(n) 10^-16, which is larger than
/// one run's share of a tail as soon as rates of 10^-6 are at stake. Here nothing cancels.
pub(super) fn pmf(k: u64, n: u64, p: f64) -> f64 {
    if k == 0 {
        return (n as f64 * (-p).ln_1p()).exp();
    }
    if k == n {
        return (n as f64 * p.ln()).exp();
    }
    let (trials, successes, losses) = (n as f64, k as f64, (n - k) as f64);
    let exponent = stirling_error(n)
        - stirling_error(k)
        - stirling_error(n - k)
        - deviance(successes, trials * p)
        - deviance(losses, trials * (1.0 - p));
    (trials / (TAU * successes * losses)).sqrt() * exponent.exp()
}

/// ln n! minus Stirling's formula, for n > 0.
fn stirling_error(n: u64) -> f64 {
    let x = n as f64;
    if n < 16 {
        return ln_factorial(n) - (x + 0.5) * x.ln() + x - TAU.ln() / 2.0;
    }
    // From 16 on the first term left out is below 10^-16 (DLMF 5.11.1).
    let y = 1.0 / (x * x);
    (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y * (1.0 / 1680.0 - y / 1188.0)))) / x
}

/// x ln(x / mean) + mean - x, also where the two are close and its terms cancel.
fn deviance(x: f64, mean: f64) -> f64 {
    let difference = x - mean;
    let relative = difference / (x + mean);
    if relative.abs() >= 0.1 {
        return x * (x / mean).ln() - difference;
    }
    // ln(x / mean) = 2 atanh(relative), of which the first term is taken together with the rest.
    let square = relative * relative;
    let mut sum = difference * relative;
    let mut power = 2.0 * x * relative;
    // The square is below 1/100: nine terms fill a double.
    for odd in (3_u32..21).step_by(2) {
        power *= square;
        sum += power / f64::from(odd);
    }
    sum
}

/// The tails of X binomial with `n` trials and success probability `p`, split below `k`.
pub(super) fn tails(k: u64, n: u64, p: f64) -> Tails {
    if k == 0 || (p >= 1.0 && k <= n) {
        return Tails {
            below: 0.0,
            from: 1.0,
        };
    }
    if k > n || p <= 0.0 {
        return Tails {
            below: 1.0,
            from: 0.0,
        };
    }
    if k <= FEW && k as f64 <= n as f64 * p {
        let below = pmf(k - 1, n, p) * falling_terms(k - 1, n, p);
        return Tails {
            below,
            from: 1.0 - below,
        };
    }
    // P(X >= k) = I_p(k, n - k + 1). The fraction converges fast on the far side of the mean, so
    // it gives the smaller tail and the larger one is its complement.
    let (a, b) = (k as f64, (n - k) as f64 + 1.0);
    if p < (a + 1.0) / (a + b + 2.0) {
        let from = pmf(k, n, p) * (1.0 - p) * beta_fraction(a, b, p);
        Tails {
            below: 1.0 - from,
            from,
        }
    } else {
        let below = pmf(k - 1, n, p) * p * beta_fraction(b, a, 1.0 - p);
        Tails {
            below,
            from: 1.0 - below,
        }
    }
}

/// Up to here the lower tail is a sum: its argument in the continued fraction, 1 - p, would lose
/// the digits of a small p, and with them the exactness of run numbers for rates below 10^-7.
const FEW: u64 = 100;

/// P(X <= k) / P(X = k), from the largest term down.
fn falling_terms(k: u64, n: u64, p: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for successes in (1..=k).rev() {
        term *= successes as f64 * (1.0 - p) / ((n - successes + 1) as f64 * p);
        sum += term;
    }
    sum
}

/// I_x(a, b) a B(a, b) / (x^a (1 - x)^b) as a continued fraction (DLMF 8.17.22), by the modified
/// Lentz method. For x below the mean the number of terms is of the order of sqrt(a + b).
pub(super) fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    const MAX_TERMS: u32 = 1_000_000;
    // Lentz's guard: replaces a vanishing denominator without touching any other.
    let away_from_zero = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };

    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut value = d;
    for term in 1..MAX_TERMS {
        let m = f64::from(term);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / away_from_zero(1.0 + even * d);
        c = away_from_zero(1.0 + even / c);
        value *= c * d;
        d = 1.0 / away_from_zero(1.0 + odd * d);
        c = away_from_zero(1.0 + odd / c);
        value *= c * d;
        if (c * d - 1.0).abs() <= f64::EPSILON {
            break;
        }
    }
    value
}
