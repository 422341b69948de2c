//! Checks of single values and of the shapes that all tables share.

use super::distribution::Distribution;
use super::error::CampaignError;
use super::file::*;
use super::parameter::{Bounds, Parameter, SamplingScope};
use super::quantity::RandomQuantity;
use super::source::Source;
use super::time::Timing;
use std::fmt::Display;
use std::sync::Arc;

/// Where a quantity of a table with blocks may be written.
#[derive(Clone, Copy)]
pub(super) struct Written<'a> {
    /// In the table.
    pub(super) base: Option<&'a Value>,
    /// In an agent's block.
    pub(super) own: &'a dyn Fn(usize) -> Option<&'a Value>,
}

impl<'a> Written<'a> {
    /// What holds for an agent, with its key.
    pub(super) fn of(&self, table: &str, name: &str, agent: usize) -> (String, Option<&'a Value>) {
        match (self.own)(agent) {
            Some(own) => (format!("{table}.agents[{agent}].{name}"), Some(own)),
            None => (format!("{table}.{name}"), self.base),
        }
    }
}

/// A campaign file under examination.
pub(super) struct Check<'a> {
    pub(super) source: Source<'a>,
    /// What precedes the keys of a group of agents: `group[1].`, or nothing.
    prefix: String,
    /// Names of an agent's channels, once they are known.
    pub(super) channels: Vec<Arc<str>>,
}

impl<'a> Check<'a> {
    /// Of tables whose keys have a prefix.
    pub(super) fn new(source: Source<'a>, prefix: String) -> Self {
        Self {
            source,
            prefix,
            channels: Vec::new(),
        }
    }
}

/// A value as an error quotes it: of a long list, its beginning tells which it is.
fn shortened(value: String) -> String {
    const LONGEST: usize = 400;
    match value.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &value[..end]),
        None => value,
    }
}

impl Check<'_> {
    pub(super) fn invalid(
        &self,
        key: impl Into<String>,
        value: impl Display,
        limit: &str,
        remedy: &str,
    ) -> CampaignError {
        let mut key = self.prefix.clone() + &key.into();
        // The file's own number is not the one that is wrong.
        if key == "episodes" && self.source.episodes.is_some() {
            key = "--episodes".to_string();
        }
        let place = self.source.place_of(&key);
        let place = place.map_or(String::new(), |place| format!(" ({place})"));
        CampaignError::Invalid {
            path: self.source.path.to_path_buf(),
            key: key + &place,
            value: shortened(value.to_string()),
            limit: limit.to_string(),
            remedy: remedy.to_string(),
        }
    }

    pub(super) fn number(
        &self,
        key: &str,
        value: f64,
        bounds: Bounds,
    ) -> Result<f64, CampaignError> {
        if !value.is_finite() {
            return Err(self.invalid(key, in_toml(value), "must be finite", "give a number"));
        }
        match bounds.broken_by(value, value) {
            Some(limit) => {
                Err(self.invalid(key, in_toml(value), &limit, "give a value within the limit"))
            }
            None => Ok(value),
        }
    }

    /// The parameters of a disturbance or fault; one that its kind does not have is refused.
    pub(super) fn parameters<T: Parameters, B: Parameters>(
        &self,
        table: &str,
        base: &T,
        blocks: Option<&[B]>,
        parameters: &'static [Parameter],
        team: usize,
    ) -> Result<Vec<RandomQuantity>, CampaignError> {
        let foreign = |name: &str| parameters.iter().all(|parameter| parameter.name != name);
        let in_base = T::NAMES.iter().copied().find_map(|name| {
            let value = base.parameter(name).filter(|_| foreign(name))?;
            Some((format!("{table}.{name}"), value))
        });
        let in_blocks = || {
            blocks?.iter().enumerate().find_map(|(agent, block)| {
                B::NAMES.iter().copied().find_map(|name| {
                    let value = block.parameter(name).filter(|_| foreign(name))?;
                    Some((format!("{table}.agents[{agent}].{name}"), value))
                })
            })
        };
        if let Some((key, value)) = in_base.or_else(in_blocks) {
            let known: Vec<&str> = parameters.iter().map(|parameter| parameter.name).collect();
            let remedy = match known.as_slice() {
                [] => "remove it; it has no parameters at all".to_string(),
                known => format!("remove it; its parameters are {}", known.join(", ")),
            };
            return Err(self.invalid(key, value, "this kind has no such parameter", &remedy));
        }
        self.blocks(&format!("{table}.agents"), blocks, team)?;
        parameters
            .iter()
            .map(|&parameter| self.per_channel(table, Some(base), blocks, parameter, team))
            .collect()
    }

    /// A parameter of each agent and channel: from the agent's block, else from the table, else the default.
    pub(super) fn per_channel<T: Parameters, B: Parameters>(
        &self,
        table: &str,
        base: Option<&T>,
        blocks: Option<&[B]>,
        parameter: Parameter,
        team: usize,
    ) -> Result<RandomQuantity, CampaignError> {
        let written = Written {
            base: base.and_then(|base| base.parameter(parameter.name)),
            own: &|agent| blocks.and_then(|blocks| blocks[agent].parameter(parameter.name)),
        };
        self.of_team(table, written, parameter, team, self.channels.len())
    }

    /// A parameter of each agent and of so many channels.
    pub(super) fn of_team(
        &self,
        table: &str,
        written: Written<'_>,
        parameter: Parameter,
        team: usize,
        channels: usize,
    ) -> Result<RandomQuantity, CampaignError> {
        let mut drawn = RandomQuantity {
            per: SamplingScope::Channel,
            channels,
            distributions: Vec::new(),
        };
        let mut per = None;
        for agent in 0..team {
            let (key, value) = written.of(table, parameter.name, agent);
            if parameter.per != SamplingScope::Channel {
                self.is_of_agent(&key, value)?;
            }
            for channel in 0..channels {
                let (distribution, own_per) =
                    self.channel_value(&key, value, parameter, channel)?;
                // Whoever shares a constant, it is the same.
                if !distribution.is_constant() {
                    self.same_per(&key, &mut per, own_per)?;
                }
                drawn.distributions.push(distribution);
            }
        }
        drawn.per = per.flatten().unwrap_or(parameter.per);
        Ok(drawn)
    }

    /// Refuses values that differ from channel to channel.
    fn is_of_agent(&self, key: &str, value: Option<&Value>) -> Result<(), CampaignError> {
        let (key, shown, remedy) = match value {
            Some(Value::List(list)) => (
                key.to_string(),
                format!("a list of {}", list.len()),
                "give one number or distribution",
            ),
            Some(Value::Distribution(file)) if file.per == Some(SamplingScope::Channel) => (
                format!("{key}.per"),
                "\"channel\"".to_string(),
                "use \"episode\" or \"agent\"",
            ),
            _ => return Ok(()),
        };
        let limit = "this is a quantity of the agent, not of its channels";
        Err(self.invalid(key, shown, limit, remedy))
    }

    /// A quantity of each agent.
    pub(super) fn of_agents(
        &self,
        key: &str,
        value: Option<&Value>,
        default: Option<f64>,
        default_per: SamplingScope,
        bounds: Bounds,
        team: usize,
    ) -> Result<RandomQuantity, CampaignError> {
        self.is_of_agent(key, value)?;
        let parameter = Parameter {
            name: "",
            default,
            bounds,
            per: default_per,
            timing: Timing::AsDrawn,
            resolution: None,
        };
        let (distribution, per) = self.channel_value(key, value, parameter, 0)?;
        Ok(RandomQuantity {
            per: per.unwrap_or(default_per),
            channels: 1,
            distributions: vec![distribution; team],
        })
    }

    fn channel_value(
        &self,
        key: &str,
        value: Option<&Value>,
        parameter: Parameter,
        channel: usize,
    ) -> Result<(Distribution, Option<SamplingScope>), CampaignError> {
        let (key, value) = match (value, parameter.default) {
            (None, Some(default)) => return Ok((Distribution::Constant(default), None)),
            (None, None) => {
                return Err(self.invalid(key, "absent", "this kind needs it", "add it"));
            }
            (Some(Value::List(list)), _) => match list.get(channel) {
                Some(own) if list.len() == self.channels.len() => {
                    (format!("{key}[{channel}]"), own)
                }
                _ => return Err(self.wrong_length(key, list.len(), self.channels.len())),
            },
            (Some(one), _) => (key.to_string(), one),
        };
        let (distribution, per) = self.distribution(&key, value)?;
        let (low, high) = distribution.support();
        match parameter.bounds.broken_by(low, high) {
            Some(limit) => {
                let remedy = if low.is_infinite() {
                    "a normal distribution has no bounds: use truncated_normal"
                } else {
                    "give values within the limit"
                };
                Err(self.invalid(key, value, &limit, remedy))
            }
            None => Ok((distribution, per)),
        }
    }

    fn same_per(
        &self,
        key: &str,
        all: &mut Option<Option<SamplingScope>>,
        own: Option<SamplingScope>,
    ) -> Result<(), CampaignError> {
        match *all {
            None => *all = Some(own),
            Some(first) if first != own => {
                return Err(self.invalid(
                    key,
                    "a mixture",
                    "all agents and channels of a quantity share one `per`",
                    "write the same `per` in each of its distributions",
                ));
            }
            Some(_) => {}
        }
        Ok(())
    }

    /// One value for each item of a list of blocks.
    pub(super) fn blocks<T>(
        &self,
        key: &str,
        blocks: Option<&[T]>,
        team: usize,
    ) -> Result<(), CampaignError> {
        match blocks {
            Some(blocks) if blocks.len() != team => Err(self.invalid(
                key,
                format!("{} blocks", blocks.len()),
                &format!("there is one block for each of the {team} agents"),
                "add or remove blocks, or change agent.team",
            )),
            _ => Ok(()),
        }
    }

    pub(super) fn unused(
        &self,
        table: &str,
        kind: &str,
        keys: &[(&str, bool)],
    ) -> Result<(), CampaignError> {
        match keys.iter().find(|(_, present)| *present) {
            Some((key, _)) => Err(self.invalid(
                format!("{table}.{key}"),
                "given",
                &format!("the kind {kind:?} does not have it"),
                "remove it or change the kind",
            )),
            None => Ok(()),
        }
    }

    pub(super) fn numbers(
        &self,
        key: &str,
        numbers: Option<&Numbers>,
        default: f64,
        bounds: Bounds,
    ) -> Result<Vec<f64>, CampaignError> {
        self.numbers_of(key, numbers, default, bounds, self.channels.len())
    }

    /// The same before the channels are known, of which there are so many.
    pub(super) fn numbers_of(
        &self,
        key: &str,
        numbers: Option<&Numbers>,
        default: f64,
        bounds: Bounds,
        channels: usize,
    ) -> Result<Vec<f64>, CampaignError> {
        let values = match numbers {
            None => vec![default; channels],
            Some(Numbers::One(value)) => vec![*value; channels],
            Some(Numbers::List(list)) if list.len() == channels => list.clone(),
            Some(Numbers::List(list)) => return Err(self.wrong_length(key, list.len(), channels)),
        };
        for (channel, &value) in values.iter().enumerate() {
            let own = match numbers {
                Some(Numbers::List(_)) => format!("{key}[{channel}]"),
                _ => key.to_string(),
            };
            self.number(&own, value, bounds)?;
        }
        Ok(values)
    }

    fn wrong_length(&self, key: &str, length: usize, channels: usize) -> CampaignError {
        self.invalid(
            key,
            format!("a list of {length}"),
            &format!("a list has one value for each of the {channels} channels"),
            "complete it, or give one value for all",
        )
    }

    fn distribution(
        &self,
        key: &str,
        value: &Value,
    ) -> Result<(Distribution, Option<SamplingScope>), CampaignError> {
        match value {
            Value::Number(number) => self
                .number(key, *number, Bounds::Any)
                .map(|number| (Distribution::Constant(number), None)),
            Value::Distribution(file) => match Distribution::read(file) {
                Ok(distribution) => Ok((distribution, file.per)),
                Err([limit, remedy]) => Err(self.invalid(key, file, limit, remedy)),
            },
            Value::List(_) => Err(self.invalid(
                key,
                value,
                "lists do not nest",
                "give one number or distribution per channel",
            )),
        }
    }
}
