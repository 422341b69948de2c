//! Where a fault strikes: which way, and which channels.

use crate::agent::{ActuationKind, Agent, HEIGHT};
use crate::campaign::check::Check;
use crate::campaign::disturbances_and_faults::FaultChannels;
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::kinds::{FaultKind, FaultTarget};
use crate::util::suggest::did_you_mean;

/// The channel whose actuator is the thrust where there is no other force.
const THRUST: usize = HEIGHT;

impl Check<'_> {
    /// Which way a fault strikes.
    pub(super) fn link(&self, key: &str, file: &FaultFile) -> Result<Link, CampaignError> {
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
    pub(super) fn struck_channels(
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

    /// Channels by their names.
    fn named_channels(&self, key: &str, names: &[String]) -> Result<FaultChannels, CampaignError> {
        let mut channels = Vec::new();
        for (place, name) in names.iter().enumerate() {
            let key = format!("{key}[{place}]");
            let Some(channel) = self.channels.iter().position(|own| **own == **name) else {
                let known: Vec<&str> = self.channels.iter().map(|own| &**own).collect();
                return Err(self.invalid(
                    key,
                    format!("{name:?}"),
                    &format!("the channels are {}", known.join(", ")),
                    &did_you_mean(name, known, "name one of them"),
                ));
            };
            if channels.contains(&channel) {
                return Err(self.invalid(
                    key,
                    format!("{name:?}"),
                    "this channel is in the list already",
                    "name it once",
                ));
            }
            channels.push(channel);
        }
        Ok(FaultChannels::These(channels))
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
            Some(ChannelsFile::Names(names)) if !names.is_empty() => {
                self.named_channels(key, names)
            }
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
                    "\"all\", \"one\", or a list of different channels, names or numbers from 1 to {count}: {}",
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
        ChannelsFile::Names(names) => format!("{names:?}"),
        ChannelsFile::Others(list) => format!("[{}]", list.join(", ")),
    }
}
