//! `[[disturbance]]` and `[[fault]]`.

use crate::agent::ActuationKind;
use crate::agent::{Agent, FIRST_ATTITUDE};
use crate::campaign::check::{Bounds, Check, Parameter, Written, of_agent};
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::{Distribution, Disturbance, Fault, FaultChannels, RandomQuantity, Time};
use std::borrow::Cow;
use std::f64::consts::TAU;
use std::sync::Arc;

/// A knot, m/s.
const KNOT_M_S: f64 = 0.514_444;

/// How far a signal may turn in one step, rad; beyond it the method's stages no longer see its shape.
const MAX_STEP_RAD: f64 = 0.5;
/// The channel whose actuator is the thrust where there is no other force.
const THRUST: usize = FIRST_ATTITUDE - 1;

/// Samples that a delay or a replay may keep of each channel.
const MAX_REMEMBERED: f64 = 1024.0;

/// When a fault begins.
const ONSET: Parameter = Parameter {
    name: "onset_s",
    default: Some(0.0),
    bounds: Bounds::NonNegative,
    per: SamplingScope::Agent,
};
/// How long it stays: to the end, if nothing is said.
const DURATION: Parameter = of_agent("duration_s", Bounds::Positive);
/// The time in which it comes.
const RAMP: Parameter = Parameter {
    name: "ramp_s",
    ..ONSET
};

impl Check<'_> {
    /// A disturbance; `walks` says whether the reference is a walk.
    pub(super) fn disturbance(
        &self,
        index: usize,
        file: &DisturbanceFile,
        team: usize,
        time: Time,
        agent: &Agent,
        walks: bool,
    ) -> Result<Disturbance, CampaignError> {
        let table = format!("disturbance[{index}]");
        let kind = file.kind;
        if kind == DisturbanceKind::GroundReaction && !walks {
            return Err(self.invalid(
                format!("{table}.kind"),
                "\"ground-reaction\"",
                "the ground answers a walk",
                "set reference.kind = \"walk\", or remove it",
            ));
        }
        let flies = matches!(agent, Agent::Uav(_));
        if matches!(kind, DisturbanceKind::Gust1Cosine | DisturbanceKind::Dryden) && !flies {
            return Err(self.invalid(
                format!("{table}.kind"),
                format!("{:?}", kind.name()),
                "wind acts on a UAV, not on joints",
                "use \"sine\" or \"constant\" for a biped",
            ));
        }
        if kind == DisturbanceKind::RotorVortex {
            let refused = |limit, remedy| {
                let key = format!("{table}.kind");
                Err(self.invalid(key, "\"rotor-vortex\"", limit, remedy))
            };
            if !flies {
                return refused(
                    "rotors blow on UAVs, not on joints",
                    "use \"sine\" or \"constant\" for a biped",
                );
            }
            if team == 1 {
                return refused(
                    "a UAV alone flies in nobody's jet",
                    "remove it, or raise agent.team",
                );
            }
        }
        let file = self.with_wind(&table, file)?;
        let file = file.as_ref();
        let parameters = self.parameters(
            &table,
            file,
            file.agents.as_deref(),
            kind.parameters(),
            team,
        )?;
        let key = |name: &str| format!("{table}.{name}");
        match kind {
            DisturbanceKind::Sine => {
                self.resolved(
                    &key("frequency_rad_s"),
                    &parameters[1],
                    |(_, high)| high,
                    time,
                )?;
            }
            DisturbanceKind::Gust1Cosine => {
                let written = Written {
                    base: file.onset_s.as_ref(),
                    own: &|agent| file.agents.as_ref()?[agent].onset_s.as_ref(),
                };
                self.begins(&table, written, &parameters[2], time)?;
                self.resolved(
                    &key("duration_s"),
                    &parameters[3],
                    |(low, _)| TAU / low,
                    time,
                )?;
            }
            DisturbanceKind::Constant
            | DisturbanceKind::GroundReaction
            | DisturbanceKind::RotorVortex
            | DisturbanceKind::Dryden => {}
        }
        Ok(Disturbance { kind, parameters })
    }

    /// The table of a disturbance with the wind speed of its intensity.
    fn with_wind<'f>(
        &self,
        table: &str,
        file: &'f DisturbanceFile,
    ) -> Result<Cow<'f, DisturbanceFile>, CampaignError> {
        let Some(intensity) = file.intensity else {
            return Ok(Cow::Borrowed(file));
        };
        let (name, wind_kn) = match intensity {
            IntensityKind::Light => ("light", 15.0),
            IntensityKind::Moderate => ("moderate", 30.0),
            IntensityKind::Severe => ("severe", 45.0),
        };
        let refused = |remedy: &str| {
            Err(self.invalid(
                format!("{table}.intensity"),
                format!("{name:?}"),
                "it stands for the wind_m_s of turbulence",
                remedy,
            ))
        };
        if file.kind != DisturbanceKind::Dryden {
            return refused("remove it, or set kind = \"dryden\"");
        }
        if file.wind_m_s.is_some() {
            return refused("remove it, or remove wind_m_s");
        }
        Ok(Cow::Owned(DisturbanceFile {
            wind_m_s: Some(Value::Number(wind_kn * KNOT_M_S)),
            ..file.clone()
        }))
    }

    /// A fault.
    pub(super) fn fault(
        &self,
        index: usize,
        file: &FaultFile,
        name: Arc<str>,
        team: usize,
        time: Time,
        agent: &Agent,
    ) -> Result<Fault, CampaignError> {
        let table = format!("fault[{index}]");
        let key = |name: &str| format!("{table}.{name}");
        let (kind, target) = (file.kind, file.target);
        if !kind.strikes(target) {
            let those = FaultKind::ALL
                .into_iter()
                .filter(|kind| kind.strikes(target));
            let names: Vec<&str> = those.map(FaultKind::name).collect();
            return Err(self.invalid(
                key("kind"),
                format!("{:?}", kind.name()),
                "this kind does not strike this target",
                &format!("the target {:?} has {}", target.name(), names.join(", ")),
            ));
        }
        let link = self.link(&key("link"), file)?;
        let blocks = file.agents.as_deref();
        let parameters = self.parameters(&table, file, blocks, kind.parameters(), team)?;
        let onset = Written {
            base: file.onset_s.as_ref(),
            own: &|agent| blocks?[agent].onset_s.as_ref(),
        };
        let onset_s = self.of_team(&table, onset, ONSET, team, 1)?;
        self.begins(&table, onset, &onset_s, time)?;
        let duration = Written {
            base: file.duration_s.as_ref(),
            own: &|agent| blocks?[agent].duration_s.as_ref(),
        };
        let duration_s = self.perhaps(&table, duration, DURATION, team)?;
        let ramp = Written {
            base: file.ramp_s.as_ref(),
            own: &|agent| blocks?[agent].ramp_s.as_ref(),
        };
        let ramp_s = self.perhaps(&table, ramp, RAMP, team)?;
        let mut ramps = (0..team).map(|agent| ramp.of(&table, RAMP.name, agent));
        if let Some((key, ramp_s)) = ramps.find_map(|(key, value)| Some((key, value?)))
            && !kind.can_ramp()
        {
            return Err(self.invalid(
                key,
                ramp_s,
                &format!("{:?} is there or not", kind.name()),
                "remove it",
            ));
        }
        match kind {
            FaultKind::SmoothedSquare => {
                self.resolved(&key("period_s"), &parameters[1], |(low, _)| TAU / low, time)?;
            }
            FaultKind::Oscillatory => {
                self.resolved(
                    &key("frequency_rad_s"),
                    &parameters[1],
                    |(_, high)| high,
                    time,
                )?;
            }
            FaultKind::Delay => self.remembered(&key("delay_s"), &parameters[0], time)?,
            FaultKind::Replay => self.remembered(&key("window_s"), &parameters[0], time)?,
            _ => {}
        }
        let (mut probability, mut channels) = (Vec::new(), Vec::new());
        for agent_index in 0..team {
            let own = blocks.map(|blocks| &blocks[agent_index]);
            let of_block = |name: &str| format!("{table}.agents[{agent_index}].{name}");
            let (probability_key, value) = match own.and_then(|own| own.probability) {
                Some(own) => (of_block("probability"), own),
                None => (key("probability"), file.probability.unwrap_or(1.0)),
            };
            probability.push(self.number(&probability_key, value, Bounds::Share)?);
            let (channels_key, value) = match own.and_then(|own| own.channels.as_ref()) {
                Some(own) => (of_block("channels"), Some(own)),
                None => (key("channels"), file.channels.as_ref()),
            };
            channels.push(self.struck_channels(&channels_key, value, &table, file, link, agent)?);
        }
        Ok(Fault {
            name,
            target,
            link,
            kind,
            probability,
            background: file.background.unwrap_or(false),
            channels,
            onset_s,
            duration_s,
            ramp_s,
            parameters,
        })
    }

    /// A quantity of each agent that a fault may have or not.
    fn perhaps(
        &self,
        table: &str,
        written: Written<'_>,
        parameter: Parameter,
        team: usize,
    ) -> Result<Option<RandomQuantity>, CampaignError> {
        let given = |agent: &usize| written.of(table, parameter.name, *agent).1.is_some();
        match (0..team).filter(given).count() {
            0 => Ok(None),
            some if some < team && parameter.default.is_none() => Err(self.invalid(
                format!("{table}.{}", parameter.name),
                "absent",
                "some agents have one and others do not",
                "give it here for those that have none of their own",
            )),
            _ => self.of_team(table, written, parameter, team, 1).map(Some),
        }
    }

    /// Which way a fault strikes.
    fn link(&self, key: &str, file: &FaultFile) -> Result<Link, CampaignError> {
        match (file.target, file.link) {
            (FaultTarget::Actuator | FaultTarget::Plant, None) => Ok(Link::Command),
            (FaultTarget::Sensor, None) => Ok(Link::Measurement),
            (FaultTarget::Network, Some(Link::Measurement))
                if file.kind == FaultKind::Interference =>
            {
                Err(self.invalid(
                    key,
                    "\"measurement\"",
                    "channels interfere on the way of the command",
                    "remove it",
                ))
            }
            (FaultTarget::Network, link) => Ok(link.unwrap_or(Link::Command)),
            (_, Some(_)) => Err(self.invalid(
                key,
                "given",
                "only the network has two ways",
                "remove it, or set target = \"network\"",
            )),
        }
    }

    /// The channels that a fault strikes: on these actuators and this plant.
    fn struck_channels(
        &self,
        key: &str,
        written: Option<&ChannelsFile>,
        table: &str,
        file: &FaultFile,
        link: Link,
        agent: &Agent,
    ) -> Result<FaultChannels, CampaignError> {
        let value = || written.map_or("\"all\"".into(), shown);
        let channels = self.fault_channels(key, written)?;
        let all = FaultChannels::These((0..self.channels.len()).collect());
        if file.target == FaultTarget::Plant {
            let whole = matches!(agent, Agent::Uav(_)) || file.kind == FaultKind::Mass;
            if !whole {
                return Err(self.invalid(
                    format!("{table}.kind"),
                    format!("{:?}", file.kind.name()),
                    "a biped stands on a pelvis that does not move: its plant can only change its mass",
                    "use \"mass\"",
                ));
            }
            if channels != all {
                return Err(self.invalid(
                    key,
                    value(),
                    "the plant changes as a whole",
                    "remove it",
                ));
            }
        }
        let strikes_force = match &channels {
            FaultChannels::One => true,
            FaultChannels::These(channels) => channels.iter().any(|channel| *channel < THRUST),
        };
        if agent.actuation() == ActuationKind::Thrust
            && file.target != FaultTarget::Plant
            && link == Link::Command
            && strikes_force
        {
            return Err(self.invalid(
                key,
                value(),
                "the actuation \"thrust\" has no actuators along x and y",
                "list some of [3, 4, 5, 6]: the thrust and three torques",
            ));
        }
        Ok(channels)
    }

    /// Refuses what begins after the run has ended.
    fn begins(
        &self,
        table: &str,
        written: Written<'_>,
        onset_s: &RandomQuantity,
        time: Time,
    ) -> Result<(), CampaignError> {
        let latest =
            |own: &[Distribution]| own.iter().map(|own| own.support().1).fold(0.0, f64::max);
        let of_agents = onset_s.distributions.chunks(onset_s.channels).enumerate();
        let mut late = of_agents.filter(|(_, own)| time.onset_step(latest(own)) >= time.steps);
        match late
            .next()
            .map(|(agent, _)| written.of(table, ONSET.name, agent))
        {
            Some((key, Some(value))) => {
                let last_step_s = time.shown_s(time.steps - 1);
                Err(self.invalid(
                    key,
                    value,
                    &format!("it must begin before the end, by the last step at {last_step_s} s"),
                    "begin it earlier",
                ))
            }
            _ => Ok(()),
        }
    }

    /// Refuses pasts that no memory would hold.
    pub(super) fn remembered(
        &self,
        key: &str,
        length_s: &RandomQuantity,
        time: Time,
    ) -> Result<(), CampaignError> {
        let supports = length_s.distributions.iter().map(Distribution::support);
        let longest_s = supports.map(|(_, high)| high).fold(0.0, f64::max);
        if time.whole_steps(longest_s) <= MAX_REMEMBERED {
            return Ok(());
        }
        Err(self.invalid(
            key,
            format!("up to {longest_s} s"),
            &format!(
                "at most {MAX_REMEMBERED} steps of {} s are remembered, {:.3} s",
                time.step_s,
                MAX_REMEMBERED * time.step_s
            ),
            "shorten it, or lengthen time.step_s",
        ))
    }

    /// Refuses frequencies that a step cannot resolve: they would be seen as others.
    fn resolved(
        &self,
        key: &str,
        drawn: &RandomQuantity,
        fastest_rad_s: fn((f64, f64)) -> f64,
        time: Time,
    ) -> Result<(), CampaignError> {
        let limit_rad_s = MAX_STEP_RAD / time.step_s;
        let supports = drawn.distributions.iter().map(Distribution::support);
        let fastest = supports.map(fastest_rad_s).fold(0.0, f64::max);
        if fastest <= limit_rad_s {
            return Ok(());
        }
        Err(self.invalid(
            key,
            format!("up to {fastest:.1} rad/s"),
            &format!(
                "steps of {} s resolve at most {limit_rad_s:.1} rad/s",
                time.step_s
            ),
            "make it slower, or shorten time.step_s",
        ))
    }

    fn fault_channels(
        &self,
        key: &str,
        file: Option<&ChannelsFile>,
    ) -> Result<FaultChannels, CampaignError> {
        let count = self.channels.len();
        match file {
            None => Ok(FaultChannels::These((0..count).collect())),
            Some(ChannelsFile::Word(word)) if word == "all" => {
                Ok(FaultChannels::These((0..count).collect()))
            }
            Some(ChannelsFile::Word(word)) if word == "one" => Ok(FaultChannels::One),
            Some(ChannelsFile::Numbers(numbers))
                if !numbers.is_empty()
                    && numbers
                        .iter()
                        .all(|number| (1..=count).contains(&(*number as usize)))
                    && (1..numbers.len()).all(|k| !numbers[..k].contains(&numbers[k])) =>
            {
                Ok(FaultChannels::These(
                    numbers.iter().map(|number| *number as usize - 1).collect(),
                ))
            }
            Some(other) => {
                let names = (1..).zip(&self.channels);
                let names: Vec<String> = names.map(|(k, name)| format!("{k} {name}")).collect();
                let limit = format!(
                    "\"all\", \"one\", or a list of different channel numbers from 1 to {count}: {}",
                    names.join(", ")
                );
                Err(self.invalid(key, shown(other), &limit, "give such a list"))
            }
        }
    }
}

/// The channels of a fault as a campaign file would say them.
fn shown(channels: &ChannelsFile) -> String {
    match channels {
        ChannelsFile::Word(word) => format!("{word:?}"),
        ChannelsFile::Numbers(numbers) => format!("{numbers:?}"),
        ChannelsFile::Others(list) => format!("[{}]", list.join(", ")),
    }
}
