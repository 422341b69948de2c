//! Searches for the place where something begins to hold.

/// The smallest rank in `1..=n` for which `holds`; `holds` must stay true once it is.
pub(super) fn first_rank(n: usize, holds: impl Fn(usize) -> bool) -> Option<usize> {
    let (mut first, mut end) = (1, n + 1);
    while first < end {
        let middle = usize::midpoint(first, end);
        if holds(middle) {
            end = middle;
        } else {
            first = middle + 1;
        }
    }
    (first <= n).then_some(first)
}

/// The point of [`lower`, `upper`] where `is_below` changes from true to false, to the last bit.
pub(super) fn bisect(mut lower: f64, mut upper: f64, is_below: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = f64::midpoint(lower, upper);
        if middle <= lower || upper <= middle {
            return upper;
        }
        if is_below(middle) {
            lower = middle;
        } else {
            upper = middle;
        }
    }
}
