//! What one agent does during one epoch, for the loops that track it.

use crate::mission::plane::Point;
use crate::mission::quintic::Quintic;
use crate::mission::uav_leg::Knot;

/// The reference of one agent during one epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// A UAV flies, or hovers where both knots are the same.
    Flight {
        /// At the beginning of the epoch.
        from: Knot,
        /// At its end.
        to: Knot,
    },
    /// A robot walks or stands.
    Walk {
        /// The page of its joints.
        page: u32,
        /// Where its reference is at the beginning of the epoch, m.
        from_m: Point,
        /// And at its end, m.
        to_m: Point,
        /// Where it looks: a vector of length one.
        direction: [f64; 2],
    },
    /// The agent is lost or has landed: nobody tracks anything.
    Gone {
        /// Where it is, m.
        at_m: Point,
    },
}

impl Motion {
    /// Where the reference is at the end of the epoch, m.
    #[must_use]
    pub fn end_m(&self) -> Point {
        match *self {
            Self::Flight { to, .. } => to.place_m,
            Self::Walk { to_m, .. } => to_m,
            Self::Gone { at_m } => at_m,
        }
    }

    /// The polynomials of a flight along x and y.
    #[must_use]
    pub fn quintics(&self, epoch_s: f64) -> Option<[Quintic; 2]> {
        match self {
            Self::Flight { from, to } => Some(from.quintics_to(to, epoch_s)),
            Self::Walk { .. } | Self::Gone { .. } => None,
        }
    }
}

/// What an agent does; every agent has one of these states in every epoch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// A robot without anything to do stands.
    Stand,
    /// A UAV without anything to do hovers.
    Hover,
    /// A UAV flies to a goal.
    Fly,
    /// A robot walks with a behaviour.
    Walk(usize),
    /// A robot waits until its way keeps clear of the others'.
    Wait,
    /// A robot looks around at a goal.
    Look,
    /// A robot supplies a target.
    Supply,
    /// An agent whose endurance is over.
    Exhausted,
    /// An agent that has been lost.
    Lost,
}
