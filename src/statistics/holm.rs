//! Many tests at once.

/// Holm's adjusted p-values of a family of tests (Holm 1979, Scandinavian Journal of Statistics
/// 6:65-70), in the order given.
///
/// Rejecting where the adjusted value is at most alpha wrongly rejects any true hypothesis of the
/// family with probability at most alpha, however the tests depend on each other. Each value is the
/// p-value times the number of values at least as large (ranked from the smallest), never below
/// that of a smaller one and never above 1. What is no p-value, outside [0, 1] or NaN, counts as 1.
///
/// Where p-values come from m permutations none is below 1 / (m + 1), so that a family of k tests
/// can reject at alpha only if m >= k / alpha.
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let valid = |p: f64| if (0.0..=1.0).contains(&p) { p } else { 1.0 };
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| valid(p_values[a]).total_cmp(&valid(p_values[b])));

    let mut adjusted = vec![1.0; p_values.len()];
    let mut largest = 0.0_f64;
    for (rank, test) in order.into_iter().enumerate() {
        let remaining = (p_values.len() - rank) as f64;
        largest = largest.max(valid(p_values[test]) * remaining).min(1.0);
        adjusted[test] = largest;
    }
    adjusted
}
