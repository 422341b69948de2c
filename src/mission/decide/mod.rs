//! One decision: what was seen up to now, and what is done from the end of the present epoch on.

mod allocate;
mod avoid;
mod fleet;
mod next_goal;
mod observe;
mod reserve;

use crate::mission::events::{Event, EventKind};
use crate::mission::motion::Motion;
use crate::mission::observed::Observed;
use crate::mission::outcome::Outcome;
use crate::mission::state::{Mission, Target};

/// How often tasks are allocated anew within one decision: an agent that ends a task gets another at once.
const ROUNDS: u32 = 4;

impl Mission<'_> {
    /// The decision at the beginning of an epoch k: sees what is observed and fixes the motions of epoch k + 1, while
    /// epoch k is flown. The first call is that of epoch 0.
    ///
    /// Agents come in ascending order everywhere; what is decided acts from the end of epoch k.
    pub fn decide(&mut self, observed: &Observed<'_>) -> &[Motion] {
        let epoch_s = self.scenario.parameters().epoch_s;
        let now_s = f64::from(self.decisions) * epoch_s;
        let acts_s = f64::from(self.decisions + 1) * epoch_s;
        observe::observe(self, observed);
        observe::sense(self, now_s);
        fleet::retire(self, now_s, acts_s);
        avoid::stop_before_obstacles(self, acts_s);
        avoid::stop_before_robots(self, acts_s);
        for _ in 0..ROUNDS {
            if std::mem::take(&mut self.allocation_due) {
                allocate::allocate(self, acts_s);
            }
            for agent in 0..self.agents.len() {
                let state = &self.agents[agent];
                let waits_for_orders = state.is_available() && state.lost_s.is_none();
                if waits_for_orders && state.program.is_empty() {
                    next_goal::next_goal(self, agent, acts_s);
                }
            }
            if !self.allocation_due {
                break;
            }
        }
        fleet::advance(self);
        self.decisions += 1;
        let rescued = |target: &Target| target.rescued_s.is_some();
        if self.accomplished_s.is_none() && self.targets.iter().all(rescued) {
            self.accomplished_s = Some(acts_s);
            self.events
                .push(Event::new(acts_s, EventKind::Accomplished));
        }
        &self.motions
    }

    /// Ends the mission after its last epoch, whose end is observed.
    #[must_use]
    pub fn finish(mut self, observed: &Observed<'_>) -> Outcome {
        observe::observe(&mut self, observed);
        let of_targets = |time: fn(&Target) -> Option<f64>| self.targets.iter().map(time).collect();
        Outcome {
            accomplished_s: self.accomplished_s,
            found_s: of_targets(|target| target.found_s),
            rescued_s: of_targets(|target| target.rescued_s),
            lost_s: self.agents.iter().map(|agent| agent.lost_s).collect(),
            tally: self.tally,
            events: self.events,
        }
    }
}
