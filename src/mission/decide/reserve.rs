//! Programs of robots keep apart: a new one is delayed until it does (Remark 4: "wait for the other to pass").

use crate::mission::plane::{Disc, Point, distance};
use crate::mission::state::Mission;

/// Epochs that are looked ahead where robots avoid each other.
pub(super) const HORIZON: usize = 6;
/// Longest delay of a program, epochs.
pub(super) const LONGEST_WAIT: usize = 20;
/// Distances that differ less are the same, m.
pub(super) const TOLERANCE_M: f64 = 1e-6;
/// Coordinates that differ less are the same place, m.
const SAME_PLACE_M: f64 = 1e-9;

/// Whether places to come are all the same.
pub(super) fn stands(places: &[Point]) -> bool {
    let first = places.first().copied().unwrap_or_default();
    places.iter().all(|&place| is_same(place, first))
}

/// Other robots as obstacles for a plan of `agent`: those that stand, or will stand within the horizon.
pub(super) fn standing(mission: &Mission<'_>, agent: usize) -> Vec<Disc> {
    let radius_m = mission.scenario.parameters().planner.radius_m;
    let others = mission.robots().filter(|&other| other != agent);
    let place = |other: usize| {
        let state = &mission.agents[other];
        if state.lost_s.is_some() || state.program.is_empty() {
            return Some(state.next.place_m);
        }
        let ahead = state.ahead_m(HORIZON + 1);
        let [.., before, last] = ahead[..] else {
            return None;
        };
        is_same(before, last).then_some(last)
    };
    let disc = |centre_m: Point| Disc { centre_m, radius_m };
    others.filter_map(place).map(disc).collect()
}

/// Epochs that `agent` has to wait where its present program ends until a way, given by its places at the ends of
/// epochs, keeps clear of the programs of all others; none if that takes too long.
///
/// All programs go on with their last place. Robots that are nearer to each other when the new way begins only have to
/// stay as far apart as they are then.
pub(super) fn delay(mission: &Mission<'_>, agent: usize, way: &[Point]) -> Option<usize> {
    let separation_m = mission.scenario.separation_m();
    let own = mission.agents[agent].all_ahead_m();
    let start = own.last().copied().unwrap_or_default();
    let others = mission.robots().filter(|&other| other != agent);
    let others: Vec<Vec<Point>> = others
        .map(|other| mission.agents[other].all_ahead_m())
        .collect();
    // `own` ends where the wait begins, at the index before this one.
    let begin = own.len();
    let keeps_clear = |wait: usize, other: &Vec<Point>| {
        let place = |epoch: usize| match epoch.checked_sub(begin + wait) {
            Some(step) => way.get(step).or(way.last()).copied().unwrap_or(start),
            None => start,
        };
        let other_place = |epoch: usize| other.get(epoch).or(other.last()).copied();
        let apart_m = |epoch: usize| {
            let other = other_place(epoch).unwrap_or(start);
            distance(place(epoch), other)
        };
        let least_m = separation_m.min(apart_m(begin - 1)) - TOLERANCE_M;
        let end = (begin + wait + way.len()).max(other.len());
        (begin..end).all(|epoch| apart_m(epoch) >= least_m)
    };
    (0..=LONGEST_WAIT).find(|&wait| others.iter().all(|other| keeps_clear(wait, other)))
}

fn is_same(a: Point, b: Point) -> bool {
    (a[0] - b[0]).abs() < SAME_PLACE_M && (a[1] - b[1]).abs() < SAME_PLACE_M
}
