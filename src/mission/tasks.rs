//! Tasks: what is to be searched, and targets to be rescued.

use crate::mission::plane::Point;

/// Goals that one agent after the other visits.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SearchTask {
    pub(crate) for_uav: bool,
    pub(crate) goals_m: Vec<Point>,
    /// The next goal: whoever takes the task goes on where the last one stopped.
    pub(crate) next: usize,
    pub(crate) holder: Option<usize>,
    /// Which sweep this is, from one.
    pub(crate) round: u32,
}

/// A target that has been found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RescueTask {
    pub(crate) slots: Vec<Slot>,
    /// Nobody is sent any more: it has been rescued, or no robot has a way to it.
    pub(crate) closed: bool,
}

/// What one robot does for a rescue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Slot {
    pub(crate) robot: Option<usize>,
    /// Where the robot stands or stood, m.
    pub(crate) place_m: Option<Point>,
    pub(crate) served: bool,
}

/// The task of an agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Task {
    /// The search task of this index.
    Search(usize),
    /// A slot of the rescue of a target.
    Rescue {
        target: usize,
        slot: usize,
        supplying: bool,
    },
}

impl SearchTask {
    pub(crate) fn new(for_uav: bool, goals_m: Vec<Point>) -> Self {
        Self {
            for_uav,
            goals_m,
            next: 0,
            holder: None,
            round: 1,
        }
    }

    pub(crate) fn goal_m(&self) -> Option<Point> {
        self.goals_m.get(self.next).copied()
    }

    pub(crate) fn is_open(&self) -> bool {
        self.holder.is_none() && self.goal_m().is_some()
    }

    /// Ends a sweep; if it is to be repeated, the next one goes back the way that this one came.
    pub(crate) fn end_round(&mut self, repeat: bool) {
        self.holder = None;
        if repeat {
            self.next = 0;
            self.goals_m.reverse();
            self.round = self.round.saturating_add(1);
        }
    }
}

impl RescueTask {
    pub(crate) fn new(robots: u32) -> Self {
        Self {
            slots: (0..robots).map(|_| Slot::default()).collect(),
            closed: robots == 0,
        }
    }

    /// Slots that a robot may be sent to.
    pub(crate) fn open_slots(&self) -> impl Iterator<Item = usize> + '_ {
        let open = |(_, slot): &(usize, &Slot)| !self.closed && slot.robot.is_none();
        self.slots
            .iter()
            .enumerate()
            .filter(open)
            .map(|(slot, _)| slot)
    }

    pub(crate) fn all_served(&self) -> bool {
        self.slots.iter().all(|slot| slot.served)
    }
}
