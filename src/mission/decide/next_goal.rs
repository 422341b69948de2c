//! What an agent does next whose program is empty: the first line of its state machine that applies.

use crate::mission::behaviour::of_legs;
use crate::mission::decide::reserve::{LONGEST_WAIT, delay, standing};
use crate::mission::events::{Event, EventKind, Subject};
use crate::mission::motion::Activity;
use crate::mission::plane::{Disc, Point, distance, length, moved, number};
use crate::mission::planner::{PlanNumbers, Space, Way, polyline};
use crate::mission::program::{FlightProgram, WalkEpoch, walk_epochs};
use crate::mission::state::{Mission, Program};
use crate::mission::tasks::{Slot, Task};
use crate::mission::uav_leg::UavLeg;

/// Nearer goals count as reached, m.
const REACHED_M: f64 = 0.05;
/// How often in a row a robot waits for its way to become free of others before it gives the goal up.
const MOST_REFUSALS: u32 = 3;
/// Cosines of 16 directions all around, from the x axis counterclockwise; sines are those four directions earlier.
const COSINES: [f64; 16] = {
    const C1: f64 = 0.923_879_532_511_286_7;
    const C2: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const C3: f64 = 0.382_683_432_365_089_8;
    [
        1.0, C1, C2, C3, 0.0, -C3, -C2, -C1, -1.0, -C1, -C2, -C3, 0.0, C3, C2, C1,
    ]
};
/// Distances from a search goal at which a free place is looked for, m: so many steps of this length.
const ASIDE_M: f64 = 0.25;
const ASIDE_STEPS: usize = 8;
/// The same beyond the reach of a rescuer.
const BEYOND_M: f64 = 0.5;
const BEYOND_STEPS: usize = 2;

/// What has become of a plan.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Planned {
    /// The program leads to the goal.
    Goes,
    /// The robot waits and plans again.
    Waits,
    /// There is no way.
    Fails,
}

/// Gives an agent something to do from `acts_s` on.
pub(super) fn next_goal(mission: &mut Mission<'_>, agent: usize, acts_s: f64) {
    match mission.agents[agent].task {
        Some(Task::Search(task)) if mission.scenario.is_uav(agent) => {
            fly_on(mission, agent, task, acts_s);
        }
        Some(Task::Search(task)) => search_on(mission, agent, task, acts_s),
        Some(Task::Rescue {
            target,
            slot,
            supplying,
        }) => rescue_on(mission, agent, (target, slot), supplying, acts_s),
        None => {}
    }
}

/// A UAV flies to the next goal, or its task is done.
fn fly_on(mission: &mut Mission<'_>, agent: usize, task: usize, acts_s: f64) {
    pass_goal(mission, agent, task);
    let Some(goal_m) = mission.searches[task].goal_m() else {
        end_search(mission, agent, task, acts_s);
        return;
    };
    let parameters = mission.scenario.parameters();
    let state = &mut mission.agents[agent];
    let from_m = state.next.place_m;
    let leg = UavLeg::between(
        from_m,
        goal_m,
        &parameters.flight.limits,
        parameters.epoch_s,
    );
    let program = leg.map(|leg| FlightProgram::leg(from_m, &leg));
    state.program = Program::Flight(program.unwrap_or_default());
    state.has_goal = true;
}

/// A robot looks around where it has come to, and goes to the next goal to which there is a way.
fn search_on(mission: &mut Mission<'_>, agent: usize, task: usize, acts_s: f64) {
    if pass_goal(mission, agent, task) {
        let look = mission.scenario.parameters().search.look_epochs;
        stay(mission, agent, Activity::Look, look);
    }
    while let Some(goal_m) = mission.searches[task].goal_m() {
        let planned = walk_to(mission, agent, goal_m, None, acts_s);
        if planned != Planned::Fails {
            mission.agents[agent].has_goal = planned == Planned::Goes;
            return;
        }
        let skipped = Event::new(acts_s, EventKind::GoalSkipped).agent(agent);
        let goal = number(mission.searches[task].next);
        mission
            .events
            .push(skipped.subject(Subject::Search(task)).value(goal));
        mission.searches[task].next += 1;
    }
    end_search(mission, agent, task, acts_s);
}

/// A robot goes to its target, supplies it, and is free again.
fn rescue_on(
    mission: &mut Mission<'_>,
    agent: usize,
    (target, slot): (usize, usize),
    supplying: bool,
    acts_s: f64,
) {
    let place_m = mission.targets[target].place_m;
    if !mission.agents[agent].has_goal {
        match walk_to(mission, agent, place_m, Some((target, slot)), acts_s) {
            Planned::Goes => mission.agents[agent].has_goal = true,
            Planned::Waits => {}
            Planned::Fails => {
                mission.infeasible.insert((agent, target));
                mission.release(agent);
                mission.allocation_due = true;
            }
        }
        return;
    }
    let event = |kind: EventKind| Event::new(acts_s, kind).subject(Subject::Target(target));
    if !supplying {
        mission.agents[agent].task = Some(Task::Rescue {
            target,
            slot,
            supplying: true,
        });
        mission
            .events
            .push(event(EventKind::ReachedTarget).agent(agent));
        let supply = mission.scenario.parameters().rescue.supply_epochs;
        stay(mission, agent, Activity::Supply, supply);
        return;
    }
    mission.agents[agent].task = None;
    mission.agents[agent].has_goal = false;
    mission.allocation_due = true;
    if let Some(slot) = mission.slot_mut(target, slot) {
        slot.served = true;
    }
    let state = &mut mission.targets[target];
    if let Some(rescue) = state.rescue.as_mut().filter(|rescue| rescue.all_served()) {
        rescue.closed = true;
        state.rescued_s = Some(acts_s);
        mission.events.push(event(EventKind::Rescued));
    }
}

/// If the agent has come to a goal of its search task, that is behind it.
fn pass_goal(mission: &mut Mission<'_>, agent: usize, task: usize) -> bool {
    let reached = std::mem::take(&mut mission.agents[agent].has_goal);
    mission.searches[task].next += usize::from(reached);
    reached
}

fn end_search(mission: &mut Mission<'_>, agent: usize, task: usize, acts_s: f64) {
    let done = Event::new(acts_s, EventKind::TaskDone).agent(agent);
    mission.events.push(done.subject(Subject::Search(task)));
    let repeat = mission.scenario.parameters().search.repeat;
    mission.searches[task].end_round(repeat);
    mission.agents[agent].task = None;
    mission.allocation_due = true;
}

/// Adds epochs on the spot to a robot's program.
fn stay(mission: &mut Mission<'_>, agent: usize, activity: Activity, epochs: u32) {
    let library = &mission.scenario.parameters().behaviour.library;
    let state = &mut mission.agents[agent];
    let at = (state.next.place_m, state.direction);
    if let Program::Walk(program) = &mut state.program {
        let epochs = usize::try_from(epochs).unwrap_or(usize::MAX);
        program.stay(activity, epochs, at, library);
    }
}

/// Adds to a robot's program the way from where it ends to a goal: a place of a search, or a slot of a rescue.
fn walk_to(
    mission: &mut Mission<'_>,
    agent: usize,
    goal_m: Point,
    slot: Option<(usize, usize)>,
    acts_s: f64,
) -> Planned {
    let scenario = mission.scenario;
    let planner = &scenario.parameters().planner;
    let start = match &mission.agents[agent].program {
        Program::Walk(program) => program.end_m(mission.agents[agent].next.place_m),
        Program::Flight(_) => return Planned::Fails,
    };
    let mut discs = mission.known_obstacles();
    discs.extend(standing(mission, agent));
    let place = match slot {
        Some(slot) => rescue_place(mission, slot, start, &discs),
        None => free_place(mission, goal_m, &discs),
    };
    let Some(place) = place else {
        return fail(mission, agent);
    };
    if distance(place, start) < REACHED_M {
        return Planned::Goes;
    }
    let space = Space::new(scenario.world(), &discs, start, planner.clearance_m());
    let Some(way) = plan(mission, agent, &space, [start, place]) else {
        let no_path = Event::new(acts_s, EventKind::NoPath).agent(agent);
        let task = mission.agents[agent].task;
        let subject = task.map(Mission::subject);
        mission.events.push(Event { subject, ..no_path });
        return fail(mission, agent);
    };
    let carries = slot.is_some() && scenario.parameters().rescue.carry;
    let behaviour = &scenario.parameters().behaviour;
    let behaviours = of_legs(&way.points_m, scenario.world(), behaviour, carries);
    let epochs = walk_epochs(&way, &behaviours, &behaviour.library);
    let places: Vec<Point> = epochs.iter().map(|epoch| epoch.place_m).collect();
    match delay(mission, agent, &places) {
        Some(wait) => {
            append(mission, agent, wait, (epochs, way), acts_s);
            Planned::Goes
        }
        None => refuse(mission, agent, acts_s),
    }
}

/// A way from the first to the second of two places, if the planner finds one.
fn plan(
    mission: &mut Mission<'_>,
    agent: usize,
    space: &Space<'_>,
    [start, place]: [Point; 2],
) -> Option<Way> {
    let planner = &mission.scenario.parameters().planner;
    let state = &mut mission.agents[agent];
    let numbers = PlanNumbers {
        seed: mission.draws.seed,
        episode: mission.draws.episode,
        agent: u32::try_from(agent).unwrap_or(u32::MAX),
        plan: state.plans,
    };
    let searched = polyline(space, start, place, planner, &numbers);
    state.plans += 1;
    mission.tally.plans += 1;
    mission.tally.plan_iterations += u64::from(searched.iterations);
    let polyline = searched.way?;
    let space = space.with_clearance(planner.radius_m);
    Some(Way::along(&polyline, planner.spacing_m, &space))
}

/// Adds a way to a robot's program, after epochs of waiting.
fn append(
    mission: &mut Mission<'_>,
    agent: usize,
    wait: usize,
    (epochs, way): (Vec<WalkEpoch>, Way),
    acts_s: f64,
) {
    if wait > 0 {
        wait_for_others(mission, agent, wait, acts_s);
    }
    if let [first, .., last] = way.points_m[..] {
        mission.tally.planned_m += length(&way.points_m);
        mission.tally.straight_m += distance(first, last);
    }
    let state = &mut mission.agents[agent];
    state.refusals = 0;
    if let Program::Walk(program) = &mut state.program {
        program.walk(epochs, way.curve);
    }
}

/// No delay keeps a way clear of the others': the robot waits for long, and after three such waits gives the goal up.
fn refuse(mission: &mut Mission<'_>, agent: usize, acts_s: f64) -> Planned {
    wait_for_others(mission, agent, LONGEST_WAIT, acts_s);
    let refusals = &mut mission.agents[agent].refusals;
    *refusals += 1;
    if *refusals <= MOST_REFUSALS {
        return Planned::Waits;
    }
    *refusals = 0;
    Planned::Fails
}

fn wait_for_others(mission: &mut Mission<'_>, agent: usize, epochs: usize, acts_s: f64) {
    mission.tally.waits += 1;
    let waits = Event::new(acts_s, EventKind::Waits).agent(agent);
    mission.events.push(waits.value(number(epochs)));
    stay(
        mission,
        agent,
        Activity::Wait,
        u32::try_from(epochs).unwrap_or(u32::MAX),
    );
}

fn fail(mission: &mut Mission<'_>, agent: usize) -> Planned {
    mission.tally.plan_failures += 1;
    mission.agents[agent].refusals = 0;
    Planned::Fails
}

/// The points around a centre in 16 directions, m.
fn ring(centre: Point, radius_m: f64) -> impl Iterator<Item = Point> {
    (0..COSINES.len()).map(move |k| {
        let direction = [COSINES[k], COSINES[(k + 12) % COSINES.len()]];
        moved(centre, radius_m, direction)
    })
}

/// A search goal, or the first place around it, from near to far, that keeps clear of everything.
fn free_place(mission: &Mission<'_>, goal_m: Point, discs: &[Disc]) -> Option<Point> {
    let world = mission.scenario.world();
    let clearance_m = mission.scenario.parameters().planner.clearance_m();
    let radii = (1..=ASIDE_STEPS).map(|step| ASIDE_M * number(step));
    let aside = radii.flat_map(|radius_m| ring(goal_m, radius_m));
    let mut places = std::iter::once(goal_m).chain(aside);
    places.find(|&place| world.clear_m(place, discs) >= clearance_m)
}

/// Where a rescuer stands: of 16 places about the target, at its reach or else farther away, the nearest one that keeps
/// clear of everything and of the places of the other rescuers.
fn rescue_place(
    mission: &mut Mission<'_>,
    (target, slot): (usize, usize),
    start: Point,
    discs: &[Disc],
) -> Option<Point> {
    let parameters = mission.scenario.parameters();
    let planner = &parameters.planner;
    let target_m = mission.targets[target].place_m;
    let slots = mission.targets[target]
        .rescue
        .iter()
        .flat_map(|rescue| &rescue.slots);
    let is_other = |(index, other): &(usize, &Slot)| *index != slot && other.robot.is_some();
    let taken = slots
        .enumerate()
        .filter(is_other)
        .filter_map(|(_, other)| other.place_m);
    let taken = taken.map(|centre_m| Disc {
        centre_m,
        radius_m: planner.radius_m,
    });
    let discs: Vec<Disc> = discs.iter().copied().chain(taken).collect();
    let world = mission.scenario.world();
    let is_clear = |place: &Point| world.clear_m(*place, &discs) >= planner.clearance_m();
    let nearest = |step: usize| {
        let radius_m = parameters.rescue.reach_m + BEYOND_M * number(step);
        let clear = ring(target_m, radius_m).filter(is_clear);
        clear.min_by(|&a, &b| distance(a, start).total_cmp(&distance(b, start)))
    };
    let place = (0..=BEYOND_STEPS).find_map(nearest);
    if let Some(slot) = mission.slot_mut(target, slot).filter(|_| place.is_some()) {
        slot.place_m = place;
    }
    place
}
