//! Agents that drop out, and those that go on.

use crate::mission::events::{Event, EventKind};
use crate::mission::motion::{Activity, Motion};
use crate::mission::plane::distance;
use crate::mission::program::{FlightProgram, WalkProgram};
use crate::mission::state::{Mission, Program};
use crate::mission::uav_leg::Knot;

/// Notices agents that have been lost for the time of a heartbeat, and those whose endurance is over.
pub(super) fn retire(mission: &mut Mission<'_>, now_s: f64, acts_s: f64) {
    let parameters = mission.scenario.parameters();
    let heartbeat_s = f64::from(parameters.heartbeat_epochs) * parameters.epoch_s;
    for agent in 0..mission.agents.len() {
        let state = &mut mission.agents[agent];
        if let Some(lost_s) = state.lost_s {
            // Epochs that are no binary fractions add up with rounding.
            if !state.is_known_lost && now_s >= lost_s + heartbeat_s - 1e-9 {
                state.is_known_lost = true;
                state.program = match state.program {
                    Program::Flight(_) => Program::Flight(FlightProgram::default()),
                    Program::Walk(_) => Program::Walk(WalkProgram::default()),
                };
                mission.release(agent);
                mission.allocation_due = true;
                let lost = Event::new(lost_s, EventKind::Lost).agent(agent);
                mission.events.push(lost.value(now_s));
            }
            continue;
        }
        if !state.retires && now_s >= mission.draws.lasts_s(agent) {
            state.retires = true;
            mission.release(agent);
            mission.interrupt(agent);
            mission.allocation_due = true;
        }
        let state = &mut mission.agents[agent];
        if state.retires && !state.is_exhausted && state.program.is_empty() {
            state.is_exhausted = true;
            let exhausted = Event::new(acts_s, EventKind::Exhausted);
            mission.events.push(exhausted.agent(agent));
        }
    }
}

/// Takes the next item of every program as the motion of the epoch to come.
pub(super) fn advance(mission: &mut Mission<'_>) {
    for agent in 0..mission.agents.len() {
        let resting = mission.rest_motion(agent);
        let state = &mut mission.agents[agent];
        let from = state.next;
        let at_rest = Knot::at_rest(from.place_m);
        state.now = from;
        let motion = match &mut state.program {
            _ if state.lost_s.is_some() => {
                state.activity = Activity::Lost;
                resting
            }
            Program::Flight(program) => match program.pop() {
                Some(epoch) => {
                    state.activity = Activity::Fly;
                    state.next = epoch.end;
                    mission.tally.flown_m += distance(from.place_m, epoch.end.place_m);
                    Motion::Flight {
                        from,
                        to: epoch.end,
                    }
                }
                None => {
                    state.activity = Activity::Hover;
                    state.next = at_rest;
                    resting
                }
            },
            Program::Walk(program) => match program.pop() {
                Some(epoch) => {
                    state.activity = epoch.activity;
                    state.next = Knot::at_rest(epoch.place_m);
                    state.direction = epoch.direction;
                    if let Activity::Walk(behaviour) = epoch.activity {
                        let walked_m = distance(from.place_m, epoch.place_m);
                        mission.tally.walked_m[behaviour] += walked_m;
                    }
                    Motion::Walk {
                        page: epoch.page,
                        from_m: from.place_m,
                        to_m: epoch.place_m,
                        direction: epoch.direction,
                    }
                }
                None => {
                    state.activity = Activity::Stand;
                    resting
                }
            },
        };
        if state.is_exhausted && state.lost_s.is_none() {
            state.activity = Activity::Exhausted;
        }
        mission.motions[agent] = motion;
    }
}
