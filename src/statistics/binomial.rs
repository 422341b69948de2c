//! Binomial probabilities for counts in the millions.
//!
//! The tails are the regularised incomplete beta function, evaluated here because the continued
//! fraction of `statrs` 0.19 ends after 140 terms whatever the parameters: near the mean its error
//! is 10^-3 at a million trials, where several hundred terms are needed.

use statrs::function::factorial::ln_binomial;

/// The two sides of a binomial distribution; the smaller one keeps its relative accuracy.
pub(super) struct Tails {
    /// P(X < k).
    pub(super) below: f64,
    /// P(X >= k).
    pub(super) from: f64,
}

/// P(X = `k`) for X binomial with `n` trials and success probability `p` in (0, 1).
pub(super) fn pmf(k: u64, n: u64, p: f64) -> f64 {
    let (successes, losses) = (k as f64, (n - k) as f64);
    (ln_binomial(n, k) + successes * p.ln() + losses * (-p).ln_1p()).exp()
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

/// I_x(a, b) a B(a, b) / (x^a (1 - x)^b) as a continued fraction (DLMF 8.17.22), by the modified
/// Lentz method. For x below the mean the number of terms is of the order of sqrt(a + b).
fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
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
