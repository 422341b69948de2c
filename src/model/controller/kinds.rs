//! The families of controllers, and a controller of one of them on all channel groups of an agent.

use super::OBSERVER;
use super::observer_feedback::{ChannelGains, FTC_STATES};
use super::true_state::TrueState;
use crate::model::lanes::Real;
use crate::synthesis::LoopGains;

/// A controller in the precision of the loop: its gains on each channel group.
#[derive(Debug, Clone)]
pub struct Controller<R> {
    pub(crate) family: Family<R>,
}

/// A family, with the gains of each channel group.
#[derive(Debug, Clone)]
pub(crate) enum Family<R> {
    /// The estimates of an observer with fault states: the paper's fault-tolerant controller.
    FaultTolerant(Vec<ChannelGains<R>>),
    /// The estimates of an observer without them.
    Pid(Vec<ChannelGains<R>>),
    /// The state itself. No campaign names such a controller.
    TrueState(Vec<TrueState<R>>),
}

impl<R: Real> Controller<R> {
    /// A controller from its gains on each channel group, all of one kind (reading a gains file refuses others).
    #[must_use]
    pub fn new(groups: &[LoopGains]) -> Self {
        let fault_tolerant = |gains: &LoopGains| gains.states + OBSERVER == FTC_STATES;
        let gains = groups.iter().map(ChannelGains::new).collect();
        Self {
            family: if groups.iter().all(fault_tolerant) {
                Family::FaultTolerant(gains)
            } else {
                Family::Pid(gains)
            },
        }
    }

    /// Whether it is a fault-tolerant one: what the text of its shaders depends on.
    pub(crate) fn is_fault_tolerant(&self) -> bool {
        matches!(self.family, Family::FaultTolerant(_))
    }

    /// The gains of the observers, if it has any.
    pub(crate) fn observer_gains(&self) -> &[ChannelGains<R>] {
        match &self.family {
            Family::FaultTolerant(gains) | Family::Pid(gains) => gains,
            Family::TrueState(_) => &[],
        }
    }
}

impl Controller<f64> {
    /// A controller that measures without error: u_fb = K [int e, e, e']' with the K of each channel group. It shows
    /// the plant apart from any observer, in double precision; no campaign names it.
    #[must_use]
    pub fn true_state(groups: &[[f64; 3]]) -> Self {
        let gains = groups.iter().map(|&feedback| TrueState::new(feedback));
        Self {
            family: Family::TrueState(gains.collect()),
        }
    }
}

/// Evaluates an expression with the laws of a family of their own type, and a constant for the states of a channel.
macro_rules! with_family {
    ($real:ty, $family:expr, |$laws:ident, $states:ident| $body:expr) => {
        match $family {
            Family::FaultTolerant($laws) => {
                const $states: usize = FTC_STATES;
                $body
            }
            Family::Pid($laws) => {
                const $states: usize = PID_STATES;
                $body
            }
            // `Controller::true_state` exists in double precision only, so no other precision needs this loop.
            Family::TrueState($laws) => {
                if <$real>::IS_REFERENCE {
                    const $states: usize = TRUE_STATES;
                    $body
                }
            }
        }
    };
}
pub(crate) use with_family;
