//! What the channels of one agent start from and meet.

use super::block::{LaneBlock, Selection, small};
use super::changes::later_onsets;
use super::fault::FaultLanes;
use crate::agent::{Agent, FIRST_ATTITUDE};
use crate::draw::AgentDraw;
use crate::model::exogenous::ExogenousInputs;
use crate::model::exogenous::delay_line::DelayLine;
use crate::model::exogenous::vortex::Vortex;
use crate::model::exogenous::window::Window;
use crate::model::lanes::Lane;
use crate::model::plant::uav::inertia;

/// What the channels of one agent start from and meet.
pub(crate) struct ChannelInputs<L: Lane, const NC: usize> {
    /// int e, e and e' at t = 0.
    pub(crate) initial: [[L; 3]; NC],
    pub(crate) signals: ExogenousInputs<L, NC>,
    pub(crate) kappa: L,
    pub(crate) vortices: Vec<Vortex<L>>,
    /// The step of the first fault that does not begin with the run; infinite if there is none.
    pub(crate) first_fault: L,
}

impl LaneBlock<'_> {
    /// What the channels from `first` on of an agent start from and meet.
    pub(crate) fn condition<L: Lane, const NC: usize>(
        &self,
        agent: usize,
        first: usize,
        entries: Selection,
    ) -> ChannelInputs<L, NC> {
        let group = self.group;
        let mut signals = ExogenousInputs::none();
        signals.hold_steps = group.control.hold_steps;
        if group.control.delay_s.is_some() {
            signals.lists.command_rings.push(self.control_delay(agent));
        }
        for (index, disturbance) in group.disturbances.iter().enumerate() {
            self.add_disturbance(&mut signals, disturbance, index, agent, first, entries);
        }
        for (index, fault) in group.faults.iter().enumerate() {
            let lanes = FaultLanes {
                block: self,
                fault,
                index,
                agent,
                first,
            };
            lanes.add(&mut signals, entries);
        }
        // A biped's scale is that of M and H as a whole.
        let inertia = match &group.agent {
            Agent::Uav(uav) => inertia(uav).to_vec(),
            Agent::Biped(_) => vec![1.0; group.channels().len()],
        };
        let turns =
            |channel: usize| matches!(group.agent, Agent::Uav(_)) && channel >= FIRST_ATTITUDE;
        let channel = |pick: &dyn Fn(&AgentDraw) -> f64| -> L { self.load(agent, pick) };
        signals.first_inverse_inertia = std::array::from_fn(|c| {
            channel(&|draw| {
                let scale = if turns(first + c) {
                    draw.inertia_scale
                } else {
                    draw.mass_scale
                };
                1.0 / (inertia[first + c] * scale)
            })
        });
        ChannelInputs {
            initial: std::array::from_fn(|c| {
                [
                    channel(&|draw| draw.error_integral[first + c]),
                    channel(&|draw| draw.error[first + c]),
                    channel(&|draw| draw.error_rate[first + c]),
                ]
            }),
            signals,
            kappa: channel(&|draw| draw.kappa),
            vortices: self.vortices::<L, NC>(agent, first, entries),
            first_fault: channel(&|draw| {
                later_onsets(group, draw)
                    .into_iter()
                    .map(f64::from)
                    .fold(f64::INFINITY, f64::min)
            }),
        }
    }

    /// The delay of a control loop, which is there from the start to the end.
    fn control_delay<L: Lane, const NC: usize>(&self, agent: usize) -> DelayLine<L, NC, 1> {
        let steps = |draw: &AgentDraw| self.group.time.whole_steps(draw.control_delay_s);
        let lengths = self.lanes::<L>(agent, steps).map(small);
        DelayLine::new(true, [Window::always(L::number(1.0)); NC], [lengths; NC])
    }
}
