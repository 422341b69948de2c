//! The gait nearest to one that cannot be walked.

use super::error::WalkError;
use super::gait::Gait;

/// By which share of its height above the ankles the pelvis is lowered, or raised.
const LOWER: [f64; 13] = [
    0.0, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, -0.01, -0.02, -0.04, -0.06, -0.08,
];
/// To which share the steps are shortened, and lowered with them.
const SHORTER: [f64; 6] = [1.0, 0.8, 0.6, 0.4, 0.25, 0.15];
/// How many times as long a step takes.
const SLOWER: [f64; 3] = [1.0, 1.5, 2.0];
/// How many shares of a shorter step are as bad as one of another height.
const WEIGHT: f64 = 3.0;
/// What is proposed has three digits behind the point: millimetres and milliseconds.
const ROUNDING: f64 = 1e3;

/// Samples that are planned in the search: it takes seconds.
const MOST_SAMPLES: f64 = 1e6;

/// The gait that differs least from `gait` in the height of its pelvis, the length and height of its steps and their
/// period, and with which `plan` finds a walk over a line of so many metres; none where no such gait is found.
pub fn nearest<T>(
    gait: &Gait,
    length_m: f64,
    mut plan: impl FnMut(&Gait) -> Result<T, WalkError>,
) -> Option<Gait> {
    let mut candidates: Vec<(f64, Gait)> = Vec::new();
    for lower in LOWER {
        for shorter in SHORTER {
            for slower in SLOWER {
                let cost = WEIGHT * lower.abs() + (1.0 - shorter) + 0.5 * (slower - 1.0);
                candidates.push((cost, changed(gait, lower, shorter, slower)));
            }
        }
    }
    candidates.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    let mut planned = 0.0;
    let gaits = candidates.into_iter().map(|(_, gait)| gait);
    gaits
        .take_while(|gait| {
            planned += length_m / gait.step_length_m * gait.step_period_s / gait.sampling_s;
            planned < MOST_SAMPLES
        })
        .find(|candidate| plan(candidate).is_ok())
}

fn changed(gait: &Gait, lower: f64, shorter: f64, slower: f64) -> Gait {
    // A number that stays, stays to its last digit.
    let times = |value: f64, factor: f64| {
        let product = value * factor;
        match product.to_bits() == value.to_bits() {
            true => value,
            false => (product * ROUNDING).floor() / ROUNDING,
        }
    };
    let below = 1.0 - lower * (1.0 - gait.ankle_height_m / gait.pelvis_height_m);
    Gait {
        pelvis_height_m: times(gait.pelvis_height_m, below),
        step_length_m: times(gait.step_length_m, shorter),
        step_height_m: times(gait.step_height_m, shorter),
        step_period_s: times(gait.step_period_s, slower),
        double_support_s: times(gait.double_support_s, slower),
        standing_before_s: times(gait.standing_before_s, slower),
        standing_after_s: times(gait.standing_after_s, slower),
        ..*gait
    }
}
