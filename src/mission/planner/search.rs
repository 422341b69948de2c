//! From two points to a short polyline between them.

use crate::mission::parameters::Planner;
use crate::mission::plane::{Point, length};
use crate::mission::planner::segment::Space;
use crate::mission::planner::{rrt_connect, shorten};
use crate::random::philox::{Address, Stream};

/// The random numbers of one plan: sample i takes the numbers 2i and 2i + 1, shortcut s those at 2s and 2s + 1 after
/// the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanNumbers {
    /// The campaign's seed.
    pub seed: u64,
    /// The episode.
    pub episode: u32,
    /// The agent that plans.
    pub agent: u32,
    /// How many plans it has made before.
    pub plan: u32,
}

/// What a search has found.
#[derive(Clone, Debug, PartialEq)]
pub struct Searched {
    /// Vertices from the start to the goal, if there is a way.
    pub way: Option<Vec<Point>>,
    /// Samples that it took.
    pub iterations: u32,
    /// Length of the way before it was shortened, m.
    pub raw_m: f64,
}

impl PlanNumbers {
    /// The number with an index, in (0, 1).
    #[must_use]
    pub fn unit(&self, index: u32) -> f64 {
        let address = Address {
            episode: self.episode,
            stream: Stream::Plan,
            entry: self.plan,
            member: self.agent,
            index,
        };
        address.unit(self.seed)
    }
}

/// A short way from `start` to `goal`: straight if that is free; else the one of RRT-Connect, pruned, with shortcuts,
/// and pruned again.
#[must_use]
pub fn polyline(
    space: &Space<'_>,
    start: Point,
    goal: Point,
    planner: &Planner,
    numbers: &PlanNumbers,
) -> Searched {
    let none = Searched {
        way: None,
        iterations: 0,
        raw_m: 0.0,
    };
    if space.is_free(start, goal) {
        return Searched {
            raw_m: length(&[start, goal]),
            way: Some(vec![start, goal]),
            ..none
        };
    }
    // Negative clearance at the start says that it lies in an obstacle: then the components of free space say nothing.
    let enclosed = !space.world().joined(start, goal) && space.world().clear_m(start, &[]) >= 0.0;
    if space.excess_m(goal) < 0.0 || enclosed {
        return none;
    }
    let unit = |index: u32| numbers.unit(index);
    let ends = [start, goal];
    let (raw, iterations) =
        rrt_connect::search(space, ends, planner.range_m, planner.iterations, unit);
    let Some(raw) = raw else {
        return Searched { iterations, ..none };
    };
    let first = 2 * planner.iterations;
    let units = |attempt: u32| [0, 1].map(|which| numbers.unit(first + 2 * attempt + which));
    let way = shorten::pruned(space, &raw);
    let way = shorten::with_shortcuts(space, way, planner.shortcuts, units);
    Searched {
        way: Some(shorten::pruned(space, &way)),
        iterations,
        raw_m: length(&raw),
    }
}
