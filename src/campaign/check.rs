//! Checks of single values and of the shapes that all tables share.

use super::distribution::Distribution;
use super::error::CampaignError;
use super::file::*;
use super::{Drawn, UAV_CHANNELS};
use std::fmt::Display;
use std::path::Path;

/// Channels of one UAV.
pub(super) const CHANNELS: usize = UAV_CHANNELS.len();

/// The values that a quantity may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Bounds {
    Any,
    NonNegative,
    Positive,
    /// From 0 to 1.
    Share,
}

impl Bounds {
    fn broken_by(self, low: f64, high: f64) -> Option<&'static str> {
        match self {
            Self::Any => None,
            Self::NonNegative if low < 0.0 => Some("must not be negative"),
            Self::Positive if low <= 0.0 => Some("must be positive"),
            Self::Share if low < 0.0 || high > 1.0 => Some("must lie within [0, 1]"),
            _ => None,
        }
    }
}

/// A parameter of a disturbance or fault.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Its key in the file and its column in the tables.
    pub name: &'static str,
    pub(super) default: Option<f64>,
    pub(super) bounds: Bounds,
}

/// A parameter that has to be given.
pub(super) const fn required(name: &'static str, bounds: Bounds) -> Parameter {
    Parameter {
        name,
        default: None,
        bounds,
    }
}

/// A table whose parameters are looked up by name.
pub(super) trait Parameters {
    /// All parameters that the table can hold.
    const NAMES: &'static [&'static str];
    fn parameter(&self, name: &str) -> Option<&Value>;
}

macro_rules! parameters {
    ($table:ty: $($name:ident),*) => {
        impl Parameters for $table {
            const NAMES: &'static [&'static str] = &[$(stringify!($name)),*];
            fn parameter(&self, name: &str) -> Option<&Value> {
                match name {
                    $(stringify!($name) => self.$name.as_ref(),)*
                    _ => None,
                }
            }
        }
    };
}
parameters!(InitialFile: error, error_rate, error_integral);
parameters!(InitialBlock: error, error_rate, error_integral);
parameters!(DisturbanceFile: amplitude, frequency_rad_s, phase_rad);
parameters!(FaultFile: magnitude, amplitude, period_s, smoothing, phase_rad, std);
parameters!(SignalBlock: amplitude, frequency_rad_s, phase_rad, magnitude, period_s, smoothing, std);

/// A campaign file under examination.
pub(super) struct Check<'a> {
    pub(super) path: &'a Path,
}

impl Check<'_> {
    pub(super) fn invalid(
        &self,
        key: impl Into<String>,
        value: impl Display,
        limit: &str,
        remedy: &str,
    ) -> CampaignError {
        CampaignError::Invalid {
            path: self.path.to_path_buf(),
            key: key.into(),
            value: value.to_string(),
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
            return Err(self.invalid(key, value, "must be finite", "give a number"));
        }
        match bounds.broken_by(value, value) {
            Some(limit) => Err(self.invalid(key, value, limit, "give a value within the limit")),
            None => Ok(value),
        }
    }

    /// The parameters of a disturbance or fault; one that its kind does not have is refused.
    pub(super) fn parameters<T: Parameters>(
        &self,
        table: &str,
        base: &T,
        blocks: Option<&[SignalBlock]>,
        parameters: &'static [Parameter],
        team: usize,
    ) -> Result<Vec<Drawn>, CampaignError> {
        let has = |name: &str| parameters.iter().any(|parameter| parameter.name == name);
        let foreign = |present: &dyn Fn(&str) -> bool, names: &'static [&'static str]| {
            names
                .iter()
                .find(|name| present(name) && !has(name))
                .copied()
        };
        let unknown = foreign(&|name| base.parameter(name).is_some(), T::NAMES).or_else(|| {
            blocks?.iter().find_map(|block| {
                foreign(&|name| block.parameter(name).is_some(), SignalBlock::NAMES)
            })
        });
        if let Some(name) = unknown {
            let known: Vec<&str> = parameters.iter().map(|parameter| parameter.name).collect();
            return Err(self.invalid(
                format!("{table}.{name}"),
                "given",
                "this kind has no such parameter",
                &format!("remove it; its parameters are {}", known.join(", ")),
            ));
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
    ) -> Result<Drawn, CampaignError> {
        let name = parameter.name;
        let mut drawn = Drawn {
            per: Per::Channel,
            channels: CHANNELS,
            distributions: Vec::new(),
        };
        let mut per = None;
        for agent in 0..team {
            let own = blocks.and_then(|blocks| blocks[agent].parameter(name));
            let key = if own.is_some() {
                format!("{table}.agents[{agent}].{name}")
            } else {
                format!("{table}.{name}")
            };
            let value = own.or_else(|| base.and_then(|base| base.parameter(name)));
            for channel in 0..CHANNELS {
                let (distribution, own_per) =
                    self.channel_value(&key, value, parameter, channel)?;
                self.same_per(&key, &mut per, own_per)?;
                drawn.distributions.push(distribution);
            }
        }
        drawn.per = per.flatten().unwrap_or(Per::Channel);
        Ok(drawn)
    }

    /// A quantity of each agent.
    pub(super) fn of_agents(
        &self,
        key: &str,
        value: Option<&Value>,
        default: Option<f64>,
        default_per: Per,
        bounds: Bounds,
        team: usize,
    ) -> Result<Drawn, CampaignError> {
        if let Some(Value::List(list)) = value {
            return Err(self.invalid(
                key,
                format!("a list of {}", list.len()),
                "this is a quantity of the agent, not of its channels",
                "give one number or distribution",
            ));
        }
        let parameter = Parameter {
            name: "",
            default,
            bounds,
        };
        let (distribution, per) = self.channel_value(key, value, parameter, 0)?;
        if per == Some(Per::Channel) {
            return Err(self.invalid(
                key,
                "per = \"channel\"",
                "it has no channels",
                "use \"episode\" or \"agent\"",
            ));
        }
        Ok(Drawn {
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
    ) -> Result<(Distribution, Option<Per>), CampaignError> {
        let (distribution, per) = match (value, parameter.default) {
            (None, Some(default)) => (Distribution::Constant(default), None),
            (None, None) => {
                return Err(self.invalid(key, "absent", "this kind needs it", "add it"));
            }
            (Some(Value::List(list)), _) => {
                if list.len() != CHANNELS {
                    return Err(self.invalid(
                        key,
                        format!("a list of {}", list.len()),
                        &format!("a list has one value for each of the {CHANNELS} channels"),
                        "complete it, or give one value for all",
                    ));
                }
                self.distribution(key, &list[channel])?
            }
            (Some(one), _) => self.distribution(key, one)?,
        };
        let (low, high) = distribution.support();
        match parameter.bounds.broken_by(low, high) {
            Some(limit) => {
                let remedy = if low.is_infinite() {
                    "a normal distribution has no bounds: use truncated_normal"
                } else {
                    "give values within the limit"
                };
                Err(self.invalid(key, &distribution, limit, remedy))
            }
            None => Ok((distribution, per)),
        }
    }

    fn same_per(
        &self,
        key: &str,
        all: &mut Option<Option<Per>>,
        own: Option<Per>,
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
    ) -> Result<[f64; CHANNELS], CampaignError> {
        let values = match numbers {
            None => [default; CHANNELS],
            Some(Numbers::One(value)) => [*value; CHANNELS],
            Some(Numbers::List(list)) => {
                <[f64; CHANNELS]>::try_from(list.as_slice()).map_err(|_| {
                    self.invalid(
                        key,
                        format!("a list of {}", list.len()),
                        &format!("a list has one value for each of the {CHANNELS} channels"),
                        "complete it, or give one value for all",
                    )
                })?
            }
        };
        for value in values {
            self.number(key, value, bounds)?;
        }
        Ok(values)
    }

    fn distribution(
        &self,
        key: &str,
        value: &Value,
    ) -> Result<(Distribution, Option<Per>), CampaignError> {
        let file = match value {
            Value::Number(number) => {
                return self
                    .number(key, *number, Bounds::Any)
                    .map(|n| (Distribution::Constant(n), None));
            }
            Value::Distribution(file) => file,
            Value::List(_) => {
                return Err(self.invalid(
                    key,
                    "a list of lists",
                    "lists do not nest",
                    "flatten it",
                ));
            }
        };
        let range = |form: &str, [low, high]: [f64; 2]| {
            if low.is_finite() && high.is_finite() && low <= high {
                return Ok((low, high));
            }
            let value = format!("{{ {form} = [{low}, {high}] }}");
            Err(self.invalid(
                key,
                value,
                "a range goes from a low to a high finite number",
                "swap or correct its ends",
            ))
        };
        let spread = |form: &str, std: f64| {
            if std.is_finite() && std >= 0.0 {
                return Ok(std);
            }
            let value = format!("{{ {form} = {{ std = {std} }} }}");
            Err(self.invalid(
                key,
                value,
                "a standard deviation is not negative",
                "give a finite number from 0",
            ))
        };
        let mut forms = Vec::new();
        if let Some(ends) = file.uniform {
            let (low, high) = range("uniform", ends)?;
            forms.push(Distribution::Uniform { low, high });
        }
        if let Some(ends) = file.log_uniform {
            let (low, high) = range("log_uniform", ends)?;
            if low <= 0.0 {
                let value = format!("{{ log_uniform = [{low}, {high}] }}");
                return Err(self.invalid(
                    key,
                    value,
                    "a logarithm needs positive ends",
                    "use uniform or a positive range",
                ));
            }
            forms.push(Distribution::LogUniform { low, high });
        }
        if let Some(normal) = &file.normal {
            let mean = self.number(key, normal.mean, Bounds::Any)?;
            forms.push(Distribution::Normal {
                mean,
                std: spread("normal", normal.std)?,
            });
        }
        if let Some(normal) = &file.truncated_normal {
            let (low, high) = range("truncated_normal", [normal.low, normal.high])?;
            let mean = self.number(key, normal.mean, Bounds::Any)?;
            let std = spread("truncated_normal", normal.std)?;
            // Beyond six deviations the tail holds too few doubles to draw from.
            if std == 0.0 || low > mean + 6.0 * std || high < mean - 6.0 * std {
                let value = format!(
                    "{{ truncated_normal = {{ mean = {mean}, std = {std}, low = {low}, high = {high} }} }}"
                );
                let limit = "the interval must meet the six standard deviations around the mean";
                return Err(self.invalid(key, value, limit, "widen the interval or the deviation"));
            }
            forms.push(Distribution::TruncatedNormal {
                mean,
                std,
                low,
                high,
            });
        }
        if let Some(values) = &file.choice {
            forms.push(self.choice(key, values, file.weights.as_deref())?);
        } else if file.weights.is_some() {
            return Err(self.invalid(
                key,
                "weights without choice",
                "weights belong to a choice",
                "add `choice`",
            ));
        }
        match <[Distribution; 1]>::try_from(forms) {
            Ok([distribution]) => Ok((distribution, file.per)),
            Err(forms) => Err(self.invalid(
                key,
                format!("{} forms", forms.len()),
                "a distribution has exactly one of uniform, log_uniform, normal, truncated_normal, choice",
                "keep one",
            )),
        }
    }

    fn choice(
        &self,
        key: &str,
        values: &[f64],
        weights: Option<&[f64]>,
    ) -> Result<Distribution, CampaignError> {
        for value in values {
            self.number(key, *value, Bounds::Any)?;
        }
        let weights = weights.map_or_else(|| vec![1.0; values.len()], <[f64]>::to_vec);
        let sum: f64 = weights.iter().sum();
        if values.is_empty()
            || weights.len() != values.len()
            || !weights.iter().all(|w| *w >= 0.0)
            || !(sum > 0.0)
            || !sum.is_finite()
        {
            return Err(self.invalid(
                key,
                format!("{{ choice = {values:?}, weights = {weights:?} }}"),
                "a choice has values, and as many weights, none negative and not all zero",
                "correct the lists",
            ));
        }
        let cumulative = weights
            .iter()
            .scan(0.0, |running, weight| {
                *running += weight / sum;
                Some(*running)
            })
            .collect();
        Ok(Distribution::Choice {
            values: values.to_vec(),
            cumulative,
        })
    }
}
