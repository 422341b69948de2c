//! What a mission has come to.

use crate::mission::events::{Event, EventKind, Subject};
use crate::mission::parameters::Success;

/// Collisions by what met; each pair counts once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Collisions {
    /// Two robots.
    pub robots: u32,
    /// A robot and an obstacle that was not known at first.
    pub obstacles: u32,
    /// A robot and the map.
    pub map: u32,
}

/// What is counted on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Tally {
    /// Ways that were planned, found or not.
    pub plans: u32,
    /// Of these, and of goals without a free place, those that failed.
    pub plan_failures: u32,
    /// Samples of all plans.
    pub plan_iterations: u64,
    /// Robots that stopped because their way was no longer free.
    pub replans: u32,
    /// Robots that waited until their way kept clear of the others'.
    pub waits: u32,
    /// Decisions in which somebody got a task.
    pub allocations: u32,
    /// Length of all ways that were taken, as planned, m.
    pub planned_m: f64,
    /// Straight distance between their ends, m.
    pub straight_m: f64,
    /// How far robots have walked, by behaviour, m.
    pub walked_m: Vec<f64>,
    /// How far UAVs have flown, m.
    pub flown_m: f64,
    /// Collisions.
    pub collisions: Collisions,
    /// Least distance of two robots, m; infinite if there is only one.
    pub min_separation_m: f64,
    /// At every decision, and at the end: the share of the free coarse cells whose centre has been within range.
    pub coverage: Vec<f64>,
}

/// What one mission has come to.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// When all targets were rescued, s; none if that did not happen within the limit.
    pub accomplished_s: Option<f64>,
    /// By target: when it was found, s.
    pub found_s: Vec<Option<f64>>,
    /// By target: when it was rescued, s.
    pub rescued_s: Vec<Option<f64>>,
    /// By agent: when it was lost, s.
    pub lost_s: Vec<Option<f64>>,
    /// What was counted.
    pub tally: Tally,
    /// What happened.
    pub events: Vec<Event>,
}

impl Tally {
    pub(crate) fn new(gaits: usize) -> Self {
        Self {
            plans: 0,
            plan_failures: 0,
            plan_iterations: 0,
            replans: 0,
            waits: 0,
            allocations: 0,
            planned_m: 0.0,
            straight_m: 0.0,
            walked_m: vec![0.0; gaits],
            flown_m: 0.0,
            collisions: Collisions::default(),
            min_separation_m: f64::INFINITY,
            coverage: Vec::new(),
        }
    }

    /// Length of all ways over the straight distances of their ends; none if no way was planned.
    #[must_use]
    pub fn path_ratio(&self) -> Option<f64> {
        (self.straight_m > 0.0).then(|| self.planned_m / self.straight_m)
    }

    /// The coverage after so many epochs, or at the end if that came earlier.
    #[must_use]
    pub fn coverage_after(&self, epochs: usize) -> Option<f64> {
        let at = self.coverage.get(epochs).or(self.coverage.last());
        at.copied()
    }
}

impl Collisions {
    /// All of them.
    #[must_use]
    pub fn total(&self) -> u32 {
        self.robots + self.obstacles + self.map
    }
}

impl Outcome {
    /// When the first target was found, s.
    #[must_use]
    pub fn first_found_s(&self) -> Option<f64> {
        self.found_s.iter().copied().flatten().reduce(f64::min)
    }

    /// When the last of all targets was found, s; none if one was not.
    #[must_use]
    pub fn all_found_s(&self) -> Option<f64> {
        last_of_all(&self.found_s)
    }

    /// When the last of all targets was rescued, s; none if one was not.
    #[must_use]
    pub fn all_rescued_s(&self) -> Option<f64> {
        last_of_all(&self.rescued_s)
    }

    /// Targets found.
    #[must_use]
    pub fn found(&self) -> usize {
        self.found_s.iter().flatten().count()
    }

    /// Targets rescued.
    #[must_use]
    pub fn rescued(&self) -> usize {
        self.rescued_s.iter().flatten().count()
    }

    /// Agents lost.
    #[must_use]
    pub fn lost(&self) -> usize {
        self.lost_s.iter().flatten().count()
    }

    /// When the first agent was lost, s.
    #[must_use]
    pub fn first_lost_s(&self) -> Option<f64> {
        self.lost_s.iter().copied().flatten().reduce(f64::min)
    }

    /// Whether the mission meets what counts as success.
    #[must_use]
    pub fn succeeds(&self, success: &Success) -> bool {
        let targets = self.found_s.len();
        let enough = |wanted: Option<u32>, number: usize| match wanted {
            Some(wanted) => {
                usize::try_from(wanted).is_ok_and(|wanted| number >= wanted.min(targets))
            }
            None => number >= targets,
        };
        let few = |most: u32, number: usize| u32::try_from(number).is_ok_and(|n| n <= most);
        enough(success.found, self.found())
            && enough(success.rescued, self.rescued())
            && self.tally.collisions.total() <= success.max_collisions
            && few(success.max_lost, self.lost())
    }

    /// The events of a kind about a subject.
    pub fn events_of(
        &self,
        kind: EventKind,
        subject: Option<Subject>,
    ) -> impl Iterator<Item = &Event> {
        let of = move |event: &&Event| {
            event.kind == kind && (subject.is_none() || event.subject == subject)
        };
        self.events.iter().filter(of)
    }
}

fn last_of_all(times_s: &[Option<f64>]) -> Option<f64> {
    let all: Option<Vec<f64>> = times_s.iter().copied().collect();
    all.and_then(|all| all.into_iter().reduce(f64::max))
}
