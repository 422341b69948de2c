//! What was seen during the last epoch: losses, finds, collisions, coverage, obstacles.

use crate::mission::collisions::Sweep;
use crate::mission::events::{Event, EventKind, Subject};
use crate::mission::observed::Observed;
use crate::mission::plane::{Point, distance};
use crate::mission::planner::march;
use crate::mission::state::{Mission, Touched};
use crate::mission::tasks::RescueTask;
use crate::mission::uav_leg::Knot;
use crate::mission::vision::chord;
use crate::mission::world::HALF_DIAGONAL;

/// Takes in what is observed at the end of an epoch, or at the start.
pub(super) fn observe(mission: &mut Mission<'_>, observed: &Observed<'_>) {
    let epoch_s = mission.scenario.parameters().epoch_s;
    note_losses(mission, observed);
    let place_m = |agent: usize| {
        let reference_m = mission.agents[agent].now.place_m;
        let seen = observed.places_m.get(agent).copied();
        let usable = |place: &Point| place.iter().all(|x| x.is_finite());
        let active = mission.agents[agent].is_active();
        seen.filter(usable)
            .filter(|_| active)
            .unwrap_or(reference_m)
    };
    let places_m: Vec<Point> = (0..mission.agents.len()).map(place_m).collect();
    if let Some(epoch) = mission.decisions.checked_sub(1) {
        let begin_s = f64::from(epoch) * epoch_s;
        let end_s = f64::from(mission.decisions) * epoch_s;
        let sweeps = mission.places_m.iter().zip(&places_m);
        let sweeps: Vec<Sweep> = sweeps
            .map(|(&from_m, &to_m)| Sweep { from_m, to_m })
            .collect();
        find_targets(mission, &sweeps, begin_s);
        find_collisions(mission, &sweeps, end_s);
    }
    let scenario = mission.scenario;
    for (agent, &place_m) in places_m.iter().enumerate() {
        if mission.agents[agent].is_active() {
            let range_m = scenario.sensor(agent).range_m;
            mission.coverage.look(scenario.grid(), place_m, range_m);
        }
    }
    mission.tally.coverage.push(mission.coverage.share());
    mission.places_m = places_m;
}

/// Agents that have been lost stand where their references are at the time: those of the epoch to come are not flown.
fn note_losses(mission: &mut Mission<'_>, observed: &Observed<'_>) {
    for (agent, lost_s) in mission.agents.iter_mut().zip(observed.lost_s) {
        if agent.lost_s.is_none() && lost_s.is_some() {
            agent.lost_s = *lost_s;
            agent.next = Knot::at_rest(agent.now.place_m);
            agent.now = agent.next;
        }
    }
}

/// Adds the time within range of every target; the first agent whose exposure reaches its threshold finds it.
fn find_targets(mission: &mut Mission<'_>, sweeps: &[Sweep], begin_s: f64) {
    let scenario = mission.scenario;
    let epoch_s = scenario.parameters().epoch_s;
    for (index, target) in mission.targets.iter_mut().enumerate() {
        if target.found_s.is_some() {
            continue;
        }
        let mut first: Option<(f64, usize)> = None;
        for (agent, sweep) in sweeps.iter().enumerate() {
            let sensor = scenario.sensor(agent);
            let Some([enters, leaves]) =
                chord(sweep.from_m, sweep.to_m, target.place_m, sensor.range_m)
            else {
                continue;
            };
            let world = scenario.world();
            let sees = || {
                march(sweep.to_m, target.place_m, |point| {
                    world.clear_m(point, &[])
                })
            };
            if !mission.agents[agent].is_active() || !(scenario.is_uav(agent) || sees()) {
                continue;
            }
            let gain = sensor.rate_per_s * (leaves - enters) * epoch_s;
            let before = target.exposures[agent];
            target.exposures[agent] += gain;
            let threshold = mission.draws.threshold(agent, index);
            if target.exposures[agent] >= threshold {
                let share = enters + (leaves - enters) * ((threshold - before) / gain);
                let time_s = begin_s + epoch_s * share;
                if first.is_none_or(|(earliest_s, _)| time_s < earliest_s) {
                    first = Some((time_s, agent));
                }
            }
        }
        let Some((time_s, agent)) = first else {
            continue;
        };
        let robots = scenario.parameters().rescue.robots;
        target.found_s = Some(time_s);
        target.rescue = Some(RescueTask::new(robots));
        if robots == 0 {
            target.rescued_s = Some(time_s);
        }
        mission.allocation_due = true;
        let found = Event::new(time_s, EventKind::Found);
        mission
            .events
            .push(found.agent(agent).subject(Subject::Target(index)));
    }
}

/// Robots that touched an obstacle, the map or each other during the epoch; each pair is counted once.
fn find_collisions(mission: &mut Mission<'_>, sweeps: &[Sweep], end_s: f64) {
    let radius_m = mission.scenario.parameters().planner.radius_m;
    let world = mission.scenario.world();
    // The clearance is from below by up to half of a cell's diagonal: only what touches for certain counts.
    let surely_m = radius_m - HALF_DIAGONAL * world.raster().resolution_m();
    let robots: Vec<usize> = mission.robots().collect();
    for (position, &agent) in robots.iter().enumerate() {
        let sweep = sweeps[agent];
        let moves = mission.agents[agent].lost_s.is_none();
        if moves {
            for (index, disc) in mission.draws.obstacles.iter().enumerate() {
                if sweep.closest_m(&Sweep::still(disc.centre_m)) < disc.radius_m + radius_m {
                    touch(mission, agent, Touched::Obstacle(index), end_s);
                }
            }
            let excess_m = |point: Point| world.clear_m(point, &[]) - surely_m;
            if !march(sweep.from_m, sweep.to_m, excess_m) {
                touch(mission, agent, Touched::Map, end_s);
            }
        }
        for &other in &robots[position + 1..] {
            if !moves && mission.agents[other].lost_s.is_some() {
                continue;
            }
            let apart_m = sweep.closest_m(&sweeps[other]);
            mission.tally.min_separation_m = mission.tally.min_separation_m.min(apart_m);
            if apart_m < 2.0 * radius_m {
                touch(mission, agent, Touched::Robot(other), end_s);
            }
        }
    }
}

fn touch(mission: &mut Mission<'_>, agent: usize, touched: Touched, time_s: f64) {
    if !mission.touched.insert((agent, touched)) {
        return;
    }
    let event = Event::new(time_s, EventKind::Collision).agent(agent);
    let collisions = &mut mission.tally.collisions;
    let (count, event) = match touched {
        Touched::Robot(other) => (&mut collisions.robots, event.other(other)),
        Touched::Obstacle(index) => (
            &mut collisions.obstacles,
            event.subject(Subject::Obstacle(index)),
        ),
        Touched::Map => (&mut collisions.map, event.subject(Subject::Map)),
    };
    *count += 1;
    mission.events.push(event);
}

/// Obstacles that come within range of somebody's reference become known to all.
pub(super) fn sense(mission: &mut Mission<'_>, now_s: f64) {
    for (index, disc) in mission.draws.obstacles.iter().enumerate() {
        if mission.is_known[index] {
            continue;
        }
        let senses = |&agent: &usize| {
            let state = &mission.agents[agent];
            let border_m = distance(state.now.place_m, disc.centre_m) - disc.radius_m;
            state.is_active() && border_m <= mission.scenario.sense_obstacles_m(agent)
        };
        if let Some(agent) = (0..mission.agents.len()).find(senses) {
            mission.is_known[index] = true;
            mission.ways_unchecked = true;
            let sensed = Event::new(now_s, EventKind::ObstacleSensed);
            let subject = Subject::Obstacle(index);
            mission.events.push(sensed.agent(agent).subject(subject));
        }
    }
}
