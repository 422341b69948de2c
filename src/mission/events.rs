//! What happens during a mission.

/// One row of a mission's log. Decisions carry the time from which they act, the end of the epoch during which they are
/// made; finds, losses and collisions the time at which they happen; sensing the time at which it is noticed.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// s.
    pub time_s: f64,
    /// What happens.
    pub kind: EventKind,
    /// The agent that it happens to.
    pub agent: Option<usize>,
    /// What it is about.
    pub subject: Option<Subject>,
    /// The other agent.
    pub other: Option<usize>,
    /// What the kind says.
    pub value: Option<f64>,
}

/// What an event is about; all numbers count from zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The search task that an agent's number stands for.
    Search(usize),
    /// The rescue of a target.
    Rescue(usize),
    /// A target.
    Target(usize),
    /// An obstacle that was not known at first.
    Obstacle(usize),
    /// The obstacles of the map.
    Map,
}

/// A kind of event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// An agent gets a task; value: its cost, s.
    Assigned,
    /// An agent has been at all goals of a search task.
    TaskDone,
    /// No way leads to a goal of a search task; value: its index.
    GoalSkipped,
    /// An agent finds a target.
    Found,
    /// A robot is at a target and begins to supply it.
    ReachedTarget,
    /// All robots that a target needs have supplied it.
    Rescued,
    /// No robot has a way to a target.
    Unreachable,
    /// An agent senses an obstacle.
    ObstacleSensed,
    /// A robot stops because its way is no longer free; other: the robot that it would meet.
    Replan,
    /// A robot waits until its way keeps clear of all others; value: epochs.
    Waits,
    /// The planner finds no way to a goal.
    NoPath,
    /// An agent is lost; value: when the ground station knows, s.
    Lost,
    /// An agent's endurance is over and it rests.
    Exhausted,
    /// Two bodies touch.
    Collision,
    /// All targets are rescued.
    Accomplished,
}

impl EventKind {
    /// All kinds.
    pub const ALL: [Self; 15] = [
        Self::Assigned,
        Self::TaskDone,
        Self::GoalSkipped,
        Self::Found,
        Self::ReachedTarget,
        Self::Rescued,
        Self::Unreachable,
        Self::ObstacleSensed,
        Self::Replan,
        Self::Waits,
        Self::NoPath,
        Self::Lost,
        Self::Exhausted,
        Self::Collision,
        Self::Accomplished,
    ];

    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Assigned => "assigned",
            Self::TaskDone => "task-done",
            Self::GoalSkipped => "goal-skipped",
            Self::Found => "found",
            Self::ReachedTarget => "reached-target",
            Self::Rescued => "rescued",
            Self::Unreachable => "unreachable",
            Self::ObstacleSensed => "obstacle-sensed",
            Self::Replan => "replan",
            Self::Waits => "waits",
            Self::NoPath => "no-path",
            Self::Lost => "lost",
            Self::Exhausted => "exhausted",
            Self::Collision => "collision",
            Self::Accomplished => "accomplished",
        }
    }
}

impl Event {
    /// An event that says nothing further yet.
    pub(crate) fn new(time_s: f64, kind: EventKind) -> Self {
        Self {
            time_s,
            kind,
            agent: None,
            subject: None,
            other: None,
            value: None,
        }
    }

    pub(crate) fn agent(self, agent: usize) -> Self {
        Self {
            agent: Some(agent),
            ..self
        }
    }

    pub(crate) fn subject(self, subject: Subject) -> Self {
        Self {
            subject: Some(subject),
            ..self
        }
    }

    pub(crate) fn other(self, other: usize) -> Self {
        Self {
            other: Some(other),
            ..self
        }
    }

    pub(crate) fn value(self, value: f64) -> Self {
        Self {
            value: Some(value),
            ..self
        }
    }
}
