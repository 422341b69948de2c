//! From (seed, episode) to the effective parameters of an episode: pure, and free of order. Every controller of an
//! episode meets the same draw.

pub mod quantities;

use crate::campaign::{
    AgentGroup, FaultChannels, Parameter, RandomQuantity, Sampling, SamplingScope, Stratum,
    StratumFaults, Time, Timing,
};
use crate::random::philox::{Address, Stream};
use crate::random::{MOST_ENTRIES, latin_hypercube, sobol};

/// Everything random about an episode of a group of agents.
#[derive(Debug, Clone, PartialEq)]
pub struct Episode {
    /// Index of the episode.
    pub index: u32,
    /// Draws of each agent.
    pub agents: Vec<AgentDraw>,
}

/// Everything random about an agent. Lists of channels have one value per channel.
#[derive(Debug, Clone, PartialEq)]
pub struct AgentDraw {
    /// True mass over modelled mass.
    pub mass_scale: f64,
    /// True inertia over modelled inertia.
    pub inertia_scale: f64,
    /// Coupling strength.
    pub kappa: f64,
    /// Time that a command takes to the actuator, s.
    pub control_delay_s: f64,
    /// x - r at t = 0.
    pub error: Vec<f64>,
    /// x' - r' at t = 0.
    pub error_rate: Vec<f64>,
    /// Integral of x - r at t = 0.
    pub error_integral: Vec<f64>,
    /// Each disturbance's parameters: `[disturbance][parameter][channel]`.
    pub disturbances: Vec<Vec<Vec<f64>>>,
    /// Each fault.
    pub faults: Vec<FaultDraw>,
}

/// One fault of an agent.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultDraw {
    /// The channels that it strikes; none where it does not occur.
    pub strikes: Vec<bool>,
    /// When it begins, s.
    pub onset_s: f64,
    /// How long it stays, s; infinite if to the end.
    pub duration_s: f64,
    /// The time in which it comes, s; 0 if at once.
    pub ramp_s: f64,
    /// Its parameters: `[parameter][channel]`.
    pub parameters: Vec<Vec<f64>>,
}

/// The draws of an episode with times as they happen, in whole steps: what tables, rankings and pages show.
#[derive(Debug, Clone, PartialEq)]
pub struct AppliedEpisode {
    /// Index of the episode.
    pub index: u32,
    /// Draws of each agent.
    pub agents: Vec<AgentDraw>,
}

impl Episode {
    /// The draws as they act.
    #[must_use]
    pub fn applied(&self, group: &AgentGroup) -> AppliedEpisode {
        let agents = self.agents.iter();
        AppliedEpisode {
            index: self.index,
            agents: agents.map(|draw| draw.applied(group)).collect(),
        }
    }
}

impl AgentDraw {
    /// The same draw with every time rounded to whole steps, as it takes effect.
    fn applied(&self, group: &AgentGroup) -> Self {
        let time = group.time;
        let round = |parameters: &[Parameter], values: &mut [Vec<f64>]| {
            for (parameter, values) in parameters.iter().zip(values) {
                for value in values {
                    *value = time.applied(parameter.timing, *value);
                }
            }
        };
        let mut applied = self.clone();
        if group.control.delay_s.is_some() {
            applied.control_delay_s = time.applied(Timing::Length, self.control_delay_s);
        }
        for (disturbance, values) in group.disturbances.iter().zip(&mut applied.disturbances) {
            round(disturbance.kind.parameters(), values);
        }
        for (fault, draw) in group.faults.iter().zip(&mut applied.faults) {
            draw.onset_s = time.applied(Timing::Onset, draw.onset_s);
            draw.duration_s = time.applied(Timing::Length, draw.duration_s);
            // A ramp of less than half a step is none: the fault is complete at once.
            draw.ramp_s = (draw.ramp_s / time.step_s).round() * time.step_s;
            round(fault.kind.parameters(), &mut draw.parameters);
        }
        applied
    }
}

impl FaultDraw {
    /// Whether the agent has the fault at all.
    #[must_use]
    pub fn occurs(&self) -> bool {
        self.strikes.contains(&true)
    }

    /// The channel that it strikes, if it is a single one.
    #[must_use]
    pub fn only_channel(&self) -> Option<usize> {
        let mut struck = (0..self.strikes.len()).filter(|&channel| self.strikes[channel]);
        struck.next().filter(|_| struck.next().is_none())
    }

    /// The first step after it, if it ends.
    #[must_use]
    pub fn end_step(&self, time: Time) -> u32 {
        let steps = time.whole_steps(self.duration_s).min(f64::from(time.steps));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a count of steps"
        )]
        time.onset_step(self.onset_s).saturating_add(steps as u32)
    }
}

/// Quantities of the stream `Initial`, by their entry numbers.
#[derive(Clone, Copy)]
enum Quantity {
    MassScale,
    InertiaScale,
    Kappa,
    Error,
    ErrorRate,
    ErrorIntegral,
    ControlDelay,
}

/// Index numbers of a fault's own draws; its parameters follow.
const OCCURRENCE: u32 = 0;
const STRUCK_CHANNEL: u32 = 1;
const ONSET: u32 = 2;
const FIRST_PARAMETER: u32 = 3;
/// Beyond all parameters.
const DURATION: u32 = 100;
const RAMP: u32 = 101;

/// Draws an episode of a group of agents.
#[must_use]
pub fn draw(group: &AgentGroup, episode: u32) -> Episode {
    let draws = Draws {
        seed: group.seed,
        episode,
        channels: group.channels().len(),
        first_agent: group.first_agent,
        first_fault: group.first_fault,
        stratum: group.strata.of(episode),
        sampling: group.sampling,
        episodes: group.episodes,
    };
    Episode {
        index: episode,
        agents: (0..group.team)
            .map(|agent| draws.agent(group, agent))
            .collect(),
    }
}

struct Draws<'a> {
    seed: u64,
    episode: u32,
    channels: usize,
    /// The numbers in the campaign of the group's first agent and fault.
    first_agent: usize,
    first_fault: usize,
    stratum: Option<&'a Stratum>,
    sampling: Sampling,
    /// Episodes of the campaign: hypercubes belong to their size.
    episodes: u32,
}

impl Draws<'_> {
    fn agent(&self, group: &AgentGroup, agent: usize) -> AgentDraw {
        let initial = |quantity: Quantity, drawn: &RandomQuantity| {
            self.values(Stream::Initial, quantity as u32, 0, drawn, agent)
        };
        AgentDraw {
            mass_scale: initial(Quantity::MassScale, &group.mass_scale)[0],
            inertia_scale: initial(Quantity::InertiaScale, &group.inertia_scale)[0],
            kappa: initial(Quantity::Kappa, &group.kappa)[0],
            control_delay_s: match &group.control.delay_s {
                Some(delay_s) => initial(Quantity::ControlDelay, delay_s)[0],
                None => 0.0,
            },
            error: initial(Quantity::Error, &group.initial.error),
            error_rate: initial(Quantity::ErrorRate, &group.initial.error_rate),
            error_integral: initial(Quantity::ErrorIntegral, &group.initial.error_integral),
            disturbances: (0u32..)
                .zip(&group.disturbances)
                .map(|(entry, disturbance)| {
                    self.parameters(
                        Stream::Disturbance,
                        entry,
                        0,
                        &disturbance.parameters,
                        agent,
                    )
                })
                .collect(),
            faults: (0u32..)
                .zip(&group.faults)
                .map(|(entry, fault)| self.fault(fault, entry, agent))
                .collect(),
        }
    }

    fn fault(&self, fault: &crate::campaign::Fault, entry: u32, agent: usize) -> FaultDraw {
        let unit = |index| self.unit(Stream::Fault, entry, index, SamplingScope::Agent, agent, 0);
        let occurs = match self.stratum.map(|stratum| &stratum.faults) {
            Some(StratumFaults::Certain(faults)) if !fault.background => {
                faults.contains(&(self.first_fault + entry as usize))
                    && fault.probability[agent] > 0.0
            }
            _ => unit(OCCURRENCE) < fault.probability[agent],
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "a channel number"
        )]
        let one = (unit(STRUCK_CHANNEL) * self.channels as f64) as usize;
        let struck = |channel: usize| match &fault.channels[agent] {
            FaultChannels::One => channel == one,
            FaultChannels::These(channels) => channels.contains(&channel),
        };
        let of_agent = |index: u32, drawn: Option<&RandomQuantity>, absent: f64| {
            drawn.map_or(absent, |drawn| {
                self.values(Stream::Fault, entry, index, drawn, agent)[0]
            })
        };
        FaultDraw {
            strikes: (0..self.channels)
                .map(|channel| occurs && struck(channel))
                .collect(),
            onset_s: of_agent(ONSET, Some(&fault.onset_s), 0.0),
            duration_s: of_agent(DURATION, fault.duration_s.as_ref(), f64::INFINITY),
            ramp_s: of_agent(RAMP, fault.ramp_s.as_ref(), 0.0),
            parameters: self.parameters(
                Stream::Fault,
                entry,
                FIRST_PARAMETER,
                &fault.parameters,
                agent,
            ),
        }
    }

    fn parameters(
        &self,
        stream: Stream,
        entry: u32,
        first: u32,
        drawn: &[RandomQuantity],
        agent: usize,
    ) -> Vec<Vec<f64>> {
        (first..)
            .zip(drawn)
            .map(|(index, drawn)| self.values(stream, entry, index, drawn, agent))
            .collect()
    }

    fn values(
        &self,
        stream: Stream,
        entry: u32,
        index: u32,
        drawn: &RandomQuantity,
        agent: usize,
    ) -> Vec<f64> {
        (0..drawn.channels)
            .map(|channel| match drawn.of(agent, channel) {
                distribution if distribution.is_constant() => distribution.support().0,
                distribution => distribution
                    .quantile(self.unit(stream, entry, index, drawn.per, agent, channel)),
            })
            .collect()
    }

    /// The uniform number of a quantity; those who share a draw share its address.
    fn unit(
        &self,
        stream: Stream,
        entry: u32,
        index: u32,
        per: SamplingScope,
        agent: usize,
        channel: usize,
    ) -> f64 {
        let member = match per {
            SamplingScope::Episode => member(self.first_agent, 0),
            SamplingScope::Agent => member(self.first_agent + agent, 0),
            SamplingScope::Channel => member(self.first_agent + agent, channel),
        };
        let address = Address {
            episode: self.episode,
            stream,
            entry,
            member,
            index,
        };
        let place = self.sampling.place(self.episode);
        match (self.sampling, place) {
            (Sampling::LatinHypercube { replicates }, Some((replicate, row))) => {
                let rows = self.episodes / replicates.max(1);
                let row = replicate * rows + row;
                latin_hypercube(self.seed, dimension(address), rows, row)
            }
            (Sampling::Sobol { .. }, Some((replicate, row))) => {
                sobol(self.seed, replicate, dimension(address), row)
            }
            _ => address.unit(self.seed),
        }
    }
}

/// The dimension of a design that stands for the address of a quantity: a number that depends on nothing else, so that
/// it stays when a campaign gets another fault. Nets are balanced best within four dimensions from a multiple of four
/// on; these are the parameters of a channel's disturbance, those of an agent's fault, and the masses, coupling and
/// error that a quantity of the stream `Initial` begins with.
fn dimension(address: Address) -> u32 {
    const INDEX_BITS: u32 = 7;
    const MEMBER_BITS: u32 = 12;
    const ENTRY_BITS: u32 = MOST_ENTRIES.ilog2();
    const STREAM_BITS: u32 = 2;
    const {
        assert!(INDEX_BITS + MEMBER_BITS + ENTRY_BITS + STREAM_BITS == u32::BITS);
        assert!(RAMP < 1 << INDEX_BITS && DURATION < 1 << INDEX_BITS);
    };
    // The stream `Initial` has many entries of one number each.
    let (entry, index) = match address.stream {
        Stream::Initial => (address.index, address.entry),
        _ => (address.entry, address.index),
    };
    let parts = [
        (address.stream as u32, STREAM_BITS),
        (entry, ENTRY_BITS),
        (address.member, MEMBER_BITS),
        (index, INDEX_BITS),
    ];
    parts
        .into_iter()
        .fold(0, |number, (part, bits)| (number << bits) | part)
}

/// Addresses that an agent has: more than any robot has channels.
pub(crate) const MEMBERS_PER_AGENT: usize = 64;

/// A channel as an address; agents are numbered through all groups of a campaign.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    reason = "teams and channels are small"
)]
pub fn member(agent: usize, channel: usize) -> u32 {
    (agent * MEMBERS_PER_AGENT + channel) as u32
}
