//! From (seed, episode) to the effective parameters of an episode: pure, and free of order. Every controller of an
//! episode meets the same draw.

use crate::campaign::{Campaign, Drawn, FaultChannels, Per};
use crate::model::rng::{Address, Stream};

/// Everything random about an episode, as it is applied.
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
    /// Its parameters: `[parameter][channel]`.
    pub parameters: Vec<Vec<f64>>,
}

impl FaultDraw {
    /// Whether the agent has the fault at all.
    #[must_use]
    pub fn occurs(&self) -> bool {
        self.strikes.contains(&true)
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
}

/// Index numbers of a fault's own draws; its parameters follow.
const OCCURRENCE: u32 = 0;
const STRUCK_CHANNEL: u32 = 1;
const ONSET: u32 = 2;
const FIRST_PARAMETER: u32 = 3;

/// Draws an episode of a campaign.
#[must_use]
pub fn draw(campaign: &Campaign, episode: u32) -> Episode {
    let draws = Draws {
        seed: campaign.seed,
        episode,
        channels: campaign.channels().len(),
    };
    Episode {
        index: episode,
        agents: (0..campaign.team)
            .map(|agent| draws.agent(campaign, agent))
            .collect(),
    }
}

struct Draws {
    seed: u64,
    episode: u32,
    channels: usize,
}

impl Draws {
    fn agent(&self, campaign: &Campaign, agent: usize) -> AgentDraw {
        let initial = |quantity: Quantity, drawn: &Drawn| {
            self.values(Stream::Initial, quantity as u32, 0, drawn, agent)
        };
        AgentDraw {
            mass_scale: initial(Quantity::MassScale, &campaign.mass_scale)[0],
            inertia_scale: initial(Quantity::InertiaScale, &campaign.inertia_scale)[0],
            kappa: initial(Quantity::Kappa, &campaign.kappa)[0],
            error: initial(Quantity::Error, &campaign.initial.error),
            error_rate: initial(Quantity::ErrorRate, &campaign.initial.error_rate),
            error_integral: initial(Quantity::ErrorIntegral, &campaign.initial.error_integral),
            disturbances: (0u32..)
                .zip(&campaign.disturbances)
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
                .zip(&campaign.faults)
                .map(|(entry, fault)| self.fault(fault, entry, agent))
                .collect(),
        }
    }

    fn fault(&self, fault: &crate::campaign::Fault, entry: u32, agent: usize) -> FaultDraw {
        let unit = |index| self.unit(Stream::Fault, entry, index, Per::Agent, agent, 0);
        let occurs = unit(OCCURRENCE) < fault.probability;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "a channel number"
        )]
        let one = (unit(STRUCK_CHANNEL) * self.channels as f64) as usize;
        let struck = |channel: usize| match &fault.channels {
            FaultChannels::One => channel == one,
            FaultChannels::These(channels) => channels.contains(&channel),
        };
        FaultDraw {
            strikes: (0..self.channels)
                .map(|channel| occurs && struck(channel))
                .collect(),
            onset_s: self.values(Stream::Fault, entry, ONSET, &fault.onset_s, agent)[0],
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
        drawn: &[Drawn],
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
        drawn: &Drawn,
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
        per: Per,
        agent: usize,
        channel: usize,
    ) -> f64 {
        let member = match per {
            Per::Episode => 0,
            Per::Agent => member(agent, 0),
            Per::Channel => member(agent, channel),
        };
        Address {
            episode: self.episode,
            stream,
            entry,
            member,
            index,
        }
        .unit(self.seed)
    }
}

/// Addresses that an agent has: more than any robot has channels.
pub(crate) const MEMBERS_PER_AGENT: usize = 64;

/// An agent's channel as an address.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    reason = "teams and channels are small"
)]
pub fn member(agent: usize, channel: usize) -> u32 {
    (agent * MEMBERS_PER_AGENT + channel) as u32
}
