//! The state of one mission: what its agents do and what has happened so far.

use crate::mission::coverage::Coverage;
use crate::mission::draws::MissionDraws;
use crate::mission::events::{Event, Subject};
use crate::mission::motion::{Activity, Motion};
use crate::mission::outcome::Tally;
use crate::mission::plane::{Disc, Point};
use crate::mission::program::{FlightProgram, WalkProgram};
use crate::mission::scenario::Scenario;
use crate::mission::tasks::{RescueTask, SearchTask, Slot, Task};
use crate::mission::travel_time::TravelTimes;
use crate::mission::uav_leg::Knot;
use std::collections::BTreeSet;

/// One mission under one controller. It sees what is given to
/// [`decide`](crate::mission::state::Mission::decide) and nothing else.
#[derive(Clone, Debug)]
pub struct Mission<'a> {
    pub(crate) scenario: &'a Scenario,
    pub(crate) draws: &'a MissionDraws,
    /// How many decisions have been made; the next one is made at this many epochs.
    pub(crate) decisions: u32,
    pub(crate) agents: Vec<Agent>,
    /// What the agents do in the epoch that was decided last.
    pub(crate) motions: Vec<Motion>,
    /// By the agent that each was made for.
    pub(crate) searches: Vec<SearchTask>,
    pub(crate) targets: Vec<Target>,
    pub(crate) is_known: Vec<bool>,
    /// Robots that have no way to a target.
    pub(crate) infeasible: BTreeSet<(usize, usize)>,
    /// Something has happened since tasks were allocated.
    pub(crate) allocation_due: bool,
    /// An obstacle has become known since ways were checked.
    pub(crate) ways_unchecked: bool,
    /// What has touched already: an agent and what it touched.
    pub(crate) touched: BTreeSet<(usize, Touched)>,
    /// Places at the last decision, m.
    pub(crate) places_m: Vec<Point>,
    pub(crate) coverage: Coverage,
    pub(crate) events: Vec<Event>,
    pub(crate) tally: Tally,
    pub(crate) accomplished_s: Option<f64>,
}

/// What a robot's body touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Touched {
    Robot(usize),
    Obstacle(usize),
    Map,
}

/// An agent.
#[derive(Clone, Debug)]
pub(crate) struct Agent {
    /// Its reference at the decision, at the beginning of the epoch that is flown meanwhile.
    pub(crate) now: Knot,
    /// Its reference at the end of that epoch, where its program begins.
    pub(crate) next: Knot,
    /// Where a robot then looks.
    pub(crate) direction: [f64; 2],
    pub(crate) program: Program,
    pub(crate) activity: Activity,
    pub(crate) task: Option<Task>,
    /// Whether its program leads to a goal of its task.
    pub(crate) has_goal: bool,
    /// Plans that it has made.
    pub(crate) plans: u32,
    /// How often in a row no delay has kept its way clear of the others'.
    pub(crate) refusals: u32,
    pub(crate) lost_s: Option<f64>,
    pub(crate) is_known_lost: bool,
    /// Its endurance is over: it stops and takes no task.
    pub(crate) retires: bool,
    pub(crate) is_exhausted: bool,
}

/// What an agent does in the epochs to come.
#[derive(Clone, Debug)]
pub(crate) enum Program {
    Flight(FlightProgram),
    Walk(WalkProgram),
}

/// What is known of a target.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    pub(crate) place_m: Point,
    /// By agent: exposure so far.
    pub(crate) exposures: Vec<f64>,
    pub(crate) found_s: Option<f64>,
    pub(crate) rescued_s: Option<f64>,
    pub(crate) rescue: Option<RescueTask>,
    /// Times to it, with so many obstacles known.
    pub(crate) times: Option<(usize, TravelTimes)>,
}

impl Program {
    pub(crate) fn is_empty(&self) -> bool {
        match self {
            Self::Flight(program) => program.is_empty(),
            Self::Walk(program) => program.is_empty(),
        }
    }
}

impl Agent {
    fn new(is_uav: bool, start_m: Point) -> Self {
        let start = Knot::at_rest(start_m);
        let (program, activity) = if is_uav {
            (Program::Flight(FlightProgram::default()), Activity::Hover)
        } else {
            (Program::Walk(WalkProgram::default()), Activity::Stand)
        };
        Self {
            now: start,
            next: start,
            // Robots look into their area, which lies above its lower edge.
            direction: [0.0, 1.0],
            program,
            activity,
            task: None,
            has_goal: false,
            plans: 0,
            refusals: 0,
            lost_s: None,
            is_known_lost: false,
            retires: false,
            is_exhausted: false,
        }
    }

    /// Whether it senses, and can be touched by others as one that moves.
    pub(crate) fn is_active(&self) -> bool {
        self.lost_s.is_none() && !self.is_exhausted
    }

    /// Whether the ground station counts on it.
    pub(crate) fn is_available(&self) -> bool {
        !self.is_known_lost && !self.retires
    }

    /// Where a robot's reference will be at the end of this epoch and after each of `epochs` more, m.
    pub(crate) fn ahead_m(&self, epochs: usize) -> Vec<Point> {
        let mut places = vec![self.next.place_m];
        if let Program::Walk(program) = &self.program {
            places.extend(program.places_m().take(epochs));
        }
        let last = places.last().copied().unwrap_or(self.next.place_m);
        places.resize(epochs + 1, last);
        places
    }

    /// Where a robot's reference will be at the end of this epoch and in all epochs of its program, m.
    pub(crate) fn all_ahead_m(&self) -> Vec<Point> {
        match &self.program {
            Program::Walk(program) => self.ahead_m(program.len()),
            Program::Flight(_) => vec![self.next.place_m],
        }
    }
}

impl<'a> Mission<'a> {
    /// A mission before its first decision.
    #[must_use]
    pub fn start(scenario: &'a Scenario, draws: &'a MissionDraws) -> Self {
        let count = scenario.agents();
        let starts = scenario.starts_m();
        let agents: Vec<Agent> = (0..count)
            .map(|agent| Agent::new(scenario.is_uav(agent), starts[agent]))
            .collect();
        let search = |agent| SearchTask::new(scenario.is_uav(agent), scenario.goals(agent));
        let target = |&place_m: &Point| Target {
            place_m,
            exposures: vec![0.0; count],
            found_s: None,
            rescued_s: None,
            rescue: None,
            times: None,
        };
        let gaits = scenario.parameters().behaviour.library.gaits.len();
        let mut mission = Self {
            scenario,
            draws,
            decisions: 0,
            motions: Vec::with_capacity(count),
            searches: (0..count).map(search).collect(),
            targets: draws.targets_m.iter().map(target).collect(),
            is_known: vec![false; draws.obstacles.len()],
            infeasible: BTreeSet::new(),
            allocation_due: true,
            ways_unchecked: false,
            touched: BTreeSet::new(),
            places_m: starts.to_vec(),
            coverage: Coverage::new(scenario.grid()),
            events: Vec::new(),
            tally: Tally::new(gaits),
            accomplished_s: None,
            agents,
        };
        // Epoch 0 is spent at the start while the first decision is made.
        mission.motions = (0..count).map(|agent| mission.rest_motion(agent)).collect();
        mission
    }

    /// The number of the epoch that was decided last; before the first decision: 0.
    #[must_use]
    pub fn epoch(&self) -> u32 {
        self.decisions
    }

    /// The task that every agent holds.
    pub fn tasks(&self) -> impl Iterator<Item = Option<Subject>> + '_ {
        self.agents
            .iter()
            .map(|agent| agent.task.map(Self::subject))
    }

    /// What the agents do in the epoch that was decided last; before the first decision: in epoch 0.
    #[must_use]
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// What every agent does in that epoch.
    pub fn activities(&self) -> impl Iterator<Item = Activity> + '_ {
        self.agents.iter().map(|agent| agent.activity)
    }

    /// What has happened so far.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Whether all targets are rescued or the limit is reached.
    #[must_use]
    pub fn is_over(&self) -> bool {
        let limit = self.scenario.parameters().epochs;
        self.accomplished_s.is_some() || self.decisions >= limit
    }

    /// The obstacles that have been sensed.
    pub(crate) fn known_obstacles(&self) -> Vec<Disc> {
        let obstacles = self.draws.obstacles.iter().zip(&self.is_known);
        let known = obstacles.filter(|(_, is_known)| **is_known);
        known.map(|(disc, _)| *disc).collect()
    }

    pub(crate) fn robots(&self) -> impl Iterator<Item = usize> + use<> {
        let scenario = self.scenario;
        // The list is owned so that callers may change agents meanwhile.
        let robots: Vec<usize> = (0..self.agents.len())
            .filter(|&agent| !scenario.is_uav(agent))
            .collect();
        robots.into_iter()
    }

    /// What an agent does that has nothing to do: it stands or hovers where its reference ends.
    pub(crate) fn rest_motion(&self, agent: usize) -> Motion {
        let is_uav = self.scenario.is_uav(agent);
        let agent = &self.agents[agent];
        let at = agent.next;
        if agent.lost_s.is_some() || (is_uav && agent.is_exhausted) {
            Motion::Gone { at_m: at.place_m }
        } else if is_uav {
            let at = Knot::at_rest(at.place_m);
            Motion::Flight { from: at, to: at }
        } else {
            Motion::Walk {
                page: self.scenario.parameters().behaviour.library.stand,
                from_m: at.place_m,
                to_m: at.place_m,
                direction: agent.direction,
            }
        }
    }

    /// Takes an agent's task away.
    pub(crate) fn release(&mut self, agent: usize) {
        match self.agents[agent].task.take() {
            Some(Task::Search(task)) => self.searches[task].holder = None,
            Some(Task::Rescue { target, slot, .. }) => {
                if let Some(slot) = self.slot_mut(target, slot)
                    && slot.robot == Some(agent)
                {
                    slot.robot = None;
                }
            }
            None => {}
        }
        self.agents[agent].has_goal = false;
    }

    /// A slot of the rescue of a target, if there is one.
    pub(crate) fn slot_mut(&mut self, target: usize, slot: usize) -> Option<&mut Slot> {
        let rescue = self.targets[target].rescue.as_mut();
        rescue.and_then(|rescue| rescue.slots.get_mut(slot))
    }

    /// Tells an agent to stop.
    pub(crate) fn interrupt(&mut self, agent: usize) {
        let library = &self.scenario.parameters().behaviour.library;
        let agent = &mut self.agents[agent];
        match &mut agent.program {
            Program::Flight(program) => *program = program.cut(agent.next.place_m),
            Program::Walk(program) => program.cut(library),
        }
    }

    /// How an agent's search task is named in events.
    pub(crate) fn subject(task: Task) -> Subject {
        match task {
            Task::Search(task) => Subject::Search(task),
            Task::Rescue { target, .. } => Subject::Rescue(target),
        }
    }
}
