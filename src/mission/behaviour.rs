//! Behaviour decision: which gait a robot walks with on which part of its way (paper, Fig. 1).

use crate::mission::parameters::Behaviour;
use crate::mission::plane::{Point, between, distance};
use crate::mission::world::World;

/// Where on a leg its terrain is looked up: just before the middle, so that rounding does not decide where the border
/// of two classes runs through it.
const MIDDLE: f64 = 0.5 - 1e-6;
/// Runs of just the least length, up to rounding, are not short, m.
const ROUNDING_M: f64 = 1e-9;

/// The behaviours (beta_n) of the legs of a way through points (sigma_n): those of the terrain under their middles,
/// with short runs merged. The behaviour of a point is that of the leg that it begins. Who carries supplies walks no
/// faster than with the walking gait.
#[must_use]
pub fn of_legs(
    points: &[Point],
    world: &World,
    behaviour: &Behaviour,
    carries: bool,
) -> Vec<usize> {
    let advance_m = |index: usize| behaviour.library.advance_m(index);
    let of_leg = |leg: &[Point]| {
        let class = world.class(between(leg[0], leg[1], MIDDLE));
        let of_class = behaviour.of_class.get(usize::from(class));
        let index = of_class.copied().unwrap_or(behaviour.walking);
        let too_fast = carries && advance_m(index) > advance_m(behaviour.walking);
        if too_fast { behaviour.walking } else { index }
    };
    let of_legs: Vec<usize> = points.windows(2).map(of_leg).collect();
    let lengths = points.windows(2).map(|leg| distance(leg[0], leg[1]));
    let lengths: Vec<f64> = lengths.collect();
    merge(&of_legs, &lengths, behaviour.min_segment_m, advance_m)
}

/// The behaviours of the legs of a way after short changes are left out: repeatedly, from the front, a run of legs of
/// one behaviour that is shorter than `least_m` takes the slower behaviour of its neighbours if that is slower than its
/// own. It never takes a faster one: the slow gait is the safe one.
///
/// `advance_m` is how far a behaviour goes in an epoch, m.
#[must_use]
pub fn merge(
    behaviours: &[usize],
    lengths_m: &[f64],
    least_m: f64,
    advance_m: impl Fn(usize) -> f64,
) -> Vec<usize> {
    let mut behaviours = behaviours.to_vec();
    // Every change makes some legs slower, so the loop ends.
    while let Some((run, slower)) = change(&behaviours, lengths_m, least_m, &advance_m) {
        behaviours[run].fill(slower);
    }
    behaviours
}

/// The runs of equal behaviours.
pub(crate) fn runs(behaviours: &[usize]) -> Vec<std::ops::Range<usize>> {
    let mut begin = 0;
    let lengths = behaviours.chunk_by(|a, b| a == b).map(<[usize]>::len);
    let run = |length: usize| {
        let run = begin..begin + length;
        begin = run.end;
        run
    };
    lengths.map(run).collect()
}

/// The first run that takes another behaviour, and that behaviour.
fn change(
    behaviours: &[usize],
    lengths_m: &[f64],
    least_m: f64,
    advance_m: &impl Fn(usize) -> f64,
) -> Option<(std::ops::Range<usize>, usize)> {
    let runs = runs(behaviours);
    let short = |run: &std::ops::Range<usize>| {
        lengths_m[run.clone()].iter().sum::<f64>() < least_m - ROUNDING_M
    };
    for run in runs.iter().filter(|run| short(run)) {
        let before = run.start.checked_sub(1).and_then(|leg| behaviours.get(leg));
        let after = behaviours.get(run.end);
        let neighbours = before.into_iter().chain(after).copied();
        let slowest = neighbours.min_by(|&a, &b| advance_m(a).total_cmp(&advance_m(b)));
        let slower = slowest.filter(|&other| advance_m(other) < advance_m(behaviours[run.start]));
        if let Some(slower) = slower {
            return Some((run.clone(), slower));
        }
    }
    None
}
