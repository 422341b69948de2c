//! Designs without chance: levels are the middles of equally likely ranges.

/// The number in (0, 1) of a `dimension` in the run `index` of a full factorial design with so many
/// `levels` per dimension: the first dimension varies fastest, and further runs repeat the design.
/// A dimension without levels stays at its median.
#[must_use]
pub fn factorial(levels: &[u32], dimension: usize, index: u64) -> f64 {
    let count = |levels: &u32| u64::from((*levels).max(1));
    let Some(own) = levels.get(dimension).map(count) else {
        return 0.5;
    };
    // A stride beyond u64 is beyond every index.
    let stride = levels[..dimension]
        .iter()
        .map(count)
        .try_fold(1_u64, u64::checked_mul);
    level_middle(stride.map_or(0, |stride| index / stride % own), own)
}

/// Runs of a full factorial design; none if there are more than fit 64 bits.
#[must_use]
pub fn factorial_runs(levels: &[u32]) -> Option<u64> {
    let counts = levels.iter().map(|&levels| u64::from(levels.max(1)));
    counts.into_iter().try_fold(1, u64::checked_mul)
}

/// The number in (0, 1) of a `dimension` in the run `index` of a one-at-a-time design: run 0 has all
/// dimensions at their medians, and the next `levels` runs vary dimension 0 alone, the `levels` runs
/// after them dimension 1, and so on.
#[must_use]
pub fn one_at_a_time(levels: u32, dimension: u32, index: u64) -> f64 {
    let levels = u64::from(levels.max(1));
    match index.checked_sub(1) {
        Some(run) if run / levels == u64::from(dimension) => level_middle(run % levels, levels),
        _ => 0.5,
    }
}

/// Runs of a one-at-a-time design.
#[must_use]
pub fn one_at_a_time_runs(levels: u32, dimensions: u32) -> u64 {
    1 + u64::from(levels.max(1)) * u64::from(dimensions)
}

fn level_middle(level: u64, levels: u64) -> f64 {
    (level as f64 + 0.5) / levels as f64
}
