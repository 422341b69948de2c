//! Robots that stop because their way is no longer free.

use crate::mission::decide::reserve::{HORIZON, TOLERANCE_M, stands};
use crate::mission::events::{Event, EventKind};
use crate::mission::plane::{Disc, Point, distance, number};
use crate::mission::state::{Mission, Program};

/// How much farther from an obstacle than its radius the rest of a robot's way must stay, m.
const OBSTACLE_MARGIN_M: f64 = 0.05;

/// After an obstacle has become known: robots whose way comes too near stop, and plan anew from there.
pub(super) fn stop_before_obstacles(mission: &mut Mission<'_>, acts_s: f64) {
    if !std::mem::take(&mut mission.ways_unchecked) {
        return;
    }
    let known = mission.known_obstacles();
    let clearance_m = mission.scenario.parameters().planner.radius_m + OBSTACLE_MARGIN_M;
    let too_near = |place: Point| {
        let near = |disc: &Disc| distance(place, disc.centre_m) - disc.radius_m < clearance_m;
        known.iter().any(near)
    };
    for agent in mission.robots() {
        let state = &mission.agents[agent];
        let Program::Walk(program) = &state.program else {
            continue;
        };
        if !state.is_known_lost && program.places_m().any(too_near) {
            stop(mission, agent, None, acts_s);
        }
    }
}

/// After stops and losses: a robot that would soon come too near to one that rests, or to a moving one with a lower
/// number, stops and plans anew (Remark 4). Too near is nearer than programs are planned, or than the two are now.
pub(super) fn stop_before_robots(mission: &mut Mission<'_>, acts_s: f64) {
    let scenario = mission.scenario;
    let behaviour = &scenario.parameters().behaviour;
    let advances = behaviour.of_class.iter();
    let advances = advances.map(|&behaviour_of| behaviour.library.advance_m(behaviour_of));
    let reach_m = 2.0 * number(HORIZON) * advances.fold(0.0, f64::max);
    let separation_m = scenario.separation_m();
    let robots: Vec<usize> = mission.robots().collect();
    let mut ahead: Vec<Vec<Point>> = mission
        .agents
        .iter()
        .map(|agent| agent.ahead_m(HORIZON))
        .collect();
    let rests: Vec<bool> = ahead.iter().map(|places| stands(places)).collect();
    for &agent in &robots {
        if mission.agents[agent].is_known_lost || rests[agent] {
            continue;
        }
        let gives_way = |&other: &usize| {
            other != agent
                && (other < agent || rests[other] || mission.agents[other].lost_s.is_some())
        };
        let meets = |&other: &usize| {
            let now_m = distance(ahead[agent][0], ahead[other][0]);
            let pairs = ahead[agent].iter().zip(&ahead[other]);
            let nearest_m = pairs.map(|(&a, &b)| distance(a, b));
            let least_m = separation_m.min(now_m) - TOLERANCE_M;
            now_m <= separation_m + reach_m && nearest_m.fold(f64::INFINITY, f64::min) < least_m
        };
        let other = robots.iter().copied().filter(gives_way).find(meets);
        if let Some(other) = other {
            stop(mission, agent, Some(other), acts_s);
            ahead[agent] = mission.agents[agent].ahead_m(HORIZON);
        }
    }
}

fn stop(mission: &mut Mission<'_>, agent: usize, other: Option<usize>, acts_s: f64) {
    mission.interrupt(agent);
    mission.agents[agent].has_goal = false;
    mission.tally.replans += 1;
    let replan = Event::new(acts_s, EventKind::Replan).agent(agent);
    mission.events.push(Event { other, ..replan });
}
