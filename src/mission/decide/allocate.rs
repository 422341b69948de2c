//! Task allocation: optimal pairs of agents and tasks, rescues first.
//!
//! Robots do one task at a time; a search task needs one agent, a rescue as many robots as it has slots; tasks are
//! allocated at events, without plans ahead (ST-SR-IA of Gerkey and Mataric, IJRR 23:939-954, 2004, with slots).

use crate::mission::assignment::{Costs, INFEASIBLE_MS};
use crate::mission::events::{Event, EventKind, Subject};
use crate::mission::plane::{Point, count, distance, number};
use crate::mission::state::{Mission, Program, Target};
use crate::mission::tasks::Task;

/// What every finished sweep of a search task adds to its cost, ms: first sweeps come first.
const ROUND_MS: i64 = 1_000_000_000;
/// Sweeps that are told apart; beyond it costs would reach those of pairs that are not possible.
const MOST_ROUNDS: u32 = 900;

/// Gives tasks to agents; they act from `acts_s` on.
pub(super) fn allocate(mission: &mut Mission<'_>, acts_s: f64) {
    let rescues = allocate_rescues(mission, acts_s);
    let flights = allocate_searches(mission, true, acts_s);
    let walks = allocate_searches(mission, false, acts_s);
    if rescues || flights || walks {
        mission.tally.allocations += 1;
    }
}

/// Round 1: robots that are not on a rescue, and slots of rescues. Who is on a rescue is never moved.
fn allocate_rescues(mission: &mut Mission<'_>, acts_s: f64) -> bool {
    close_unreachable(mission, acts_s);
    let open = |(target, state): (usize, &Target)| {
        let rescue = state.rescue.as_ref();
        let slots: Vec<usize> = rescue.map_or(Vec::new(), |rescue| rescue.open_slots().collect());
        slots.into_iter().map(move |slot| (target, slot))
    };
    let slots: Vec<(usize, usize)> = mission.targets.iter().enumerate().flat_map(open).collect();
    let on_rescue = |agent: usize| matches!(mission.agents[agent].task, Some(Task::Rescue { .. }));
    let free = mission.robots();
    let free: Vec<usize> = free
        .filter(|&agent| mission.agents[agent].is_available() && !on_rescue(agent))
        .collect();
    if slots.is_empty() || free.is_empty() {
        return false;
    }
    let rests: Vec<(i64, Point)> = free.iter().map(|&agent| rest(mission, agent)).collect();
    let costs = Costs::new([free.len(), slots.len()], |row, column| {
        let (rest_ms, place_m) = rests[row];
        let target = slots[column].0;
        let walk_ms = walk_ms(mission, free[row], place_m, target);
        walk_ms.map_or(INFEASIBLE_MS, |walk_ms| walk_ms + rest_ms)
    });
    let pairs = costs.optimum();
    for pair in &pairs {
        let (agent, (target, slot)) = (free[pair.row], slots[pair.column]);
        mission.release(agent);
        if let Some(slot) = mission.slot_mut(target, slot) {
            slot.robot = Some(agent);
        }
        mission.interrupt(agent);
        let task = Task::Rescue {
            target,
            slot,
            supplying: false,
        };
        assign(mission, agent, task, pair.cost_ms, acts_s);
    }
    !pairs.is_empty()
}

/// Closes rescues that are not finished and to which no robot has a way any more.
fn close_unreachable(mission: &mut Mission<'_>, acts_s: f64) {
    for target in 0..mission.targets.len() {
        let rescue = mission.targets[target].rescue.as_ref();
        if rescue.is_none_or(|rescue| rescue.open_slots().next().is_none()) {
            continue;
        }
        refresh_times(mission, target);
        let has_way = |agent: usize| {
            let place_m = rest(mission, agent).1;
            mission.agents[agent].is_available()
                && walk_ms(mission, agent, place_m, target).is_some()
        };
        if mission.robots().any(has_way) {
            continue;
        }
        if let Some(rescue) = mission.targets[target].rescue.as_mut() {
            rescue.closed = true;
        }
        let unreachable = Event::new(acts_s, EventKind::Unreachable);
        mission
            .events
            .push(unreachable.subject(Subject::Target(target)));
    }
}

/// Round 2: idle agents of one kind, and search tasks that nobody holds.
fn allocate_searches(mission: &mut Mission<'_>, for_uavs: bool, acts_s: f64) -> bool {
    let scenario = mission.scenario;
    let tasks = mission.searches.iter().enumerate();
    let open = tasks.filter(|(_, task)| task.for_uav == for_uavs && task.is_open());
    let open: Vec<usize> = open.map(|(index, _)| index).collect();
    let is_idle = |&agent: &usize| {
        let state = &mission.agents[agent];
        scenario.is_uav(agent) == for_uavs && state.is_available() && state.task.is_none()
    };
    let idle: Vec<usize> = (0..mission.agents.len()).filter(is_idle).collect();
    let parameters = scenario.parameters();
    let speed_m_s = if for_uavs {
        parameters.flight.limits.speed_m_s
    } else {
        let behaviour = &parameters.behaviour;
        behaviour.library.advance_m(behaviour.walking) / parameters.epoch_s
    };
    let rests: Vec<(i64, Point)> = idle.iter().map(|&agent| rest(mission, agent)).collect();
    let costs = Costs::new([idle.len(), open.len()], |row, column| {
        let (rest_ms, place_m) = rests[row];
        let task = &mission.searches[open[column]];
        let way_m = task.goal_m().map_or(0.0, |goal| distance(goal, place_m));
        let rounds = i64::from((task.round - 1).min(MOST_ROUNDS));
        milliseconds(way_m / speed_m_s) + rest_ms + rounds * ROUND_MS
    });
    let pairs = costs.optimum();
    for pair in &pairs {
        let (agent, task) = (idle[pair.row], open[pair.column]);
        mission.searches[task].holder = Some(agent);
        assign(
            mission,
            agent,
            Task::Search(task),
            pair.cost_ms % ROUND_MS,
            acts_s,
        );
    }
    !pairs.is_empty()
}

fn assign(mission: &mut Mission<'_>, agent: usize, task: Task, cost_ms: i64, acts_s: f64) {
    mission.agents[agent].task = Some(task);
    mission.agents[agent].has_goal = false;
    let assigned = Event::new(acts_s, EventKind::Assigned).agent(agent);
    let cost_s = seconds(cost_ms);
    mission
        .events
        .push(assigned.subject(Mission::subject(task)).value(cost_s));
}

/// How long an agent takes to rest if it is told to stop, ms, and where it then is.
fn rest(mission: &Mission<'_>, agent: usize) -> (i64, Point) {
    let parameters = mission.scenario.parameters();
    let state = &mission.agents[agent];
    let place_m = state.next.place_m;
    let (epochs, place_m) = match &state.program {
        Program::Flight(program) => program.rest(place_m),
        Program::Walk(program) => program.rest(place_m, &parameters.behaviour.library),
    };
    (milliseconds(number(epochs) * parameters.epoch_s), place_m)
}

/// How long a robot walks from a place to a target, ms; none if it has no way.
fn walk_ms(mission: &Mission<'_>, agent: usize, place_m: Point, target: usize) -> Option<i64> {
    if mission.infeasible.contains(&(agent, target)) {
        return None;
    }
    let (_, times) = mission.targets[target].times.as_ref()?;
    times.from_ms(place_m).and_then(|ms| i64::try_from(ms).ok())
}

/// Computes the times to a target anew if obstacles have become known since.
fn refresh_times(mission: &mut Mission<'_>, target: usize) {
    let known = mission.known_obstacles();
    let state = &mut mission.targets[target];
    if state
        .times
        .as_ref()
        .is_none_or(|(number, _)| *number != known.len())
    {
        let times = mission.scenario.grid().times_to(state.place_m, &known);
        state.times = Some((known.len(), times));
    }
}

fn milliseconds(seconds: f64) -> i64 {
    i64::try_from(count(seconds * 1000.0)).unwrap_or(INFEASIBLE_MS)
}

#[expect(clippy::cast_precision_loss, reason = "costs are far below 2^53")]
fn seconds(milliseconds: i64) -> f64 {
    milliseconds as f64 / 1000.0
}
