//! `[tune]`

use crate::campaign::check::Check;
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::measure::{EpisodeNumber, LoopNumber, Measure, Misnamed, Side};
use crate::campaign::tune::{Bound, Limit, Term, Tune};
use crate::campaign::validated::Campaign;
use crate::util::suggest::did_you_mean;
use std::sync::Arc;

/// Candidates, if the file says nothing.
const BUDGET: u32 = 2000;
/// Episodes of a candidate, if the file says nothing.
const EPISODES: u32 = 64;
/// Episodes of the confirmation, if the file says nothing.
const CONFIRMATION: u32 = 1024;
/// Largest numbers of candidates and of episodes.
const MOST: u32 = 1_000_000;

/// The numbers of `margins_of`.
const MARGINS: [LoopNumber; 5] = [
    LoopNumber::DelayMargin,
    LoopNumber::PhaseMargin,
    LoopNumber::SensitivityPeak,
    LoopNumber::NoisePeak,
    LoopNumber::NoiseH2,
];

impl Check<'_> {
    /// What is to be searched; `known` are the controllers that the campaign can name.
    pub(super) fn tune(
        &self,
        file: &TuneFile,
        campaign: &Campaign,
        known: &[String],
    ) -> Result<Tune, CampaignError> {
        let channels: Vec<Arc<str>> = campaign
            .channel_groups()
            .iter()
            .map(|own| own.name.clone())
            .collect();
        let mut terms: Vec<(String, Measure, f64)> = Vec::new();
        for (key, text) in file.minimise.keyed("tune.minimise") {
            let (weight, words) = self.weighted(&key, text)?;
            for measure in self.measures(&key, text, words, &channels)? {
                terms.push((key.clone(), measure, weight));
            }
        }
        if terms.is_empty() {
            return Err(self.invalid(
                "tune.minimise",
                "[]",
                "something is to be small",
                "name a measure, such as \"rmse p50\"",
            ));
        }
        let several = terms.len() > 1;
        let of_term = |(key, measure, weight): (String, Measure, f64)| {
            let unit = if several {
                self.unit(&key, &measure, campaign)?
            } else {
                1.0
            };
            Ok::<_, CampaignError>(Term {
                measure,
                factor: weight / unit,
            })
        };
        let objective = terms.into_iter().map(of_term).collect::<Result<_, _>>()?;
        let limits = self.limits(file, &channels, known)?;
        // Every stratum has an episode.
        let least = u32::try_from(campaign.strata.turn()).unwrap_or(MOST).max(2);
        let of_episodes = |key: &str, given: Option<u32>, default: u32| {
            self.whole(key, given.unwrap_or(default.max(least)), least)
        };
        Ok(Tune {
            objective,
            limits,
            budget: self.whole("tune.budget", file.budget.unwrap_or(BUDGET), 1)?,
            episodes: of_episodes("tune.episodes", file.episodes, EPISODES)?,
            confirmation: of_episodes("tune.confirmation", file.confirmation, CONFIRMATION)?,
        })
    }

    /// Everything that has to hold.
    fn limits(
        &self,
        file: &TuneFile,
        channels: &[Arc<str>],
        known: &[String],
    ) -> Result<Vec<Limit>, CampaignError> {
        let mut limits = Vec::new();
        let given = file
            .limits
            .as_ref()
            .map_or(Vec::new(), |texts| texts.keyed("tune.limits"));
        for (key, text) in given {
            limits.extend(self.limit(&key, text, channels)?);
        }
        let all = |number: &str, key: &str| self.measures(key, number, number, channels);
        if let Some(name) =
            self.model_controller("tune.margins_of", file.margins_of.as_deref(), known)?
        {
            for number in MARGINS {
                let measures = all(number.name(), "tune.margins_of")?;
                limits.extend(
                    measures
                        .into_iter()
                        .map(|measure| Limit::of(measure, &name)),
                );
            }
        }
        if let Some(name) =
            self.model_controller("tune.commands_of", file.commands_of.as_deref(), known)?
        {
            let words = format!("{} p95", EpisodeNumber::PeakCommand.name());
            let measures = all(&words, "tune.commands_of")?;
            limits.extend(
                measures
                    .into_iter()
                    .map(|measure| Limit::of(measure, &name)),
            );
        }
        Ok(limits)
    }

    /// A summand's weight, and its words.
    fn weighted<'t>(&self, key: &str, text: &'t str) -> Result<(f64, &'t str), CampaignError> {
        let Some((weight, words)) = text.split_once('*') else {
            return Ok((1.0, text));
        };
        match weight.trim().parse() {
            Ok(weight) if f64::is_finite(weight) && weight > 0.0 => Ok((weight, words)),
            _ => Err(self.invalid(
                key,
                format!("{text:?}"),
                "what stands before * is a weight above 0",
                "write it as \"2 * rmse position p50\"",
            )),
        }
    }

    /// The measures that some words of a text name.
    fn measures(
        &self,
        key: &str,
        text: &str,
        words: &str,
        channels: &[Arc<str>],
    ) -> Result<Vec<Measure>, CampaignError> {
        let refused =
            |Misnamed { limit, remedy }| self.invalid(key, format!("{text:?}"), &limit, &remedy);
        Measure::parse(words, channels).map_err(refused)
    }

    /// What a measure is counted in beside others: its limit in the verdict.
    fn unit(
        &self,
        key: &str,
        measure: &Measure,
        campaign: &Campaign,
    ) -> Result<f64, CampaignError> {
        let (limit, channels) = match measure {
            Measure::FailureRate | Measure::Survival { .. } => return Ok(1.0),
            Measure::Episodes {
                number: EpisodeNumber::Rmse,
                channels,
                ..
            } => ("max_rmse", channels),
            Measure::Episodes {
                number: EpisodeNumber::MaxAbs,
                channels,
                ..
            } => ("max_error", channels),
            Measure::Episodes {
                number: EpisodeNumber::SaturatedShare,
                ..
            } => return Ok(1.0),
            Measure::Episodes { .. } | Measure::Loop { .. } => {
                return Err(self.invalid(
                    key,
                    format!("{:?}", measure.to_string()),
                    "several measures are added in units of their limits, and this one has none",
                    "minimise it alone, or give it a limit instead",
                ));
            }
        };
        let own = &campaign.channel_groups()[channels.index];
        let verdict = &campaign.groups()[own.group].verdict;
        let limits = if limit == "max_rmse" {
            &verdict.max_rmse
        } else {
            &verdict.max_error
        };
        let unit = limits[own.channels.clone()]
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        if unit.is_finite() {
            return Ok(unit);
        }
        Err(self.invalid(
            key,
            format!("{:?}", measure.to_string()),
            &format!("several measures are added in units of their limits, and verdict.{limit} gives none"),
            "give the limit, or minimise a single measure",
        ))
    }

    /// What has to hold.
    pub(super) fn limit(
        &self,
        key: &str,
        text: &str,
        channels: &[Arc<str>],
    ) -> Result<Vec<Limit>, CampaignError> {
        let sides = [("<=", Side::AtMost), (">=", Side::AtLeast)];
        let parts = sides.into_iter().find_map(|(sign, side)| {
            let (words, number) = text.split_once(sign)?;
            let number = number
                .trim()
                .parse()
                .ok()
                .filter(|number: &f64| number.is_finite())?;
            Some((words, side, number))
        });
        let Some((words, side, number)) = parts else {
            return Err(self.invalid(
                key,
                format!("{text:?}"),
                "a limit is a measure, <= or >=, and a number",
                "write it as \"delay_margin_ms position >= 7\"",
            ));
        };
        let measures = self.measures(key, text, words, channels)?.into_iter();
        let of = |measure| Limit {
            measure,
            side,
            bound: Bound::Number(number),
        };
        Ok(measures.map(of).collect())
    }

    /// The controller whose measures are bounds.
    fn model_controller(
        &self,
        key: &str,
        name: Option<&str>,
        known: &[String],
    ) -> Result<Option<String>, CampaignError> {
        match name {
            Some(name) if known.iter().all(|own| own != name) => Err(self.invalid(
                key,
                format!("{name:?}"),
                &format!("the controllers are {}", known.join(", ")),
                &did_you_mean(name, known.iter().map(String::as_str), "take one of them"),
            )),
            name => Ok(name.map(String::from)),
        }
    }

    /// A number of things.
    fn whole(&self, key: &str, given: u32, least: u32) -> Result<u32, CampaignError> {
        if (least..=MOST).contains(&given) {
            return Ok(given);
        }
        Err(self.invalid(
            key,
            given,
            &format!("must lie between {least} and {MOST}"),
            "give a whole number within the limits",
        ))
    }
}

impl Limit {
    /// Not to be worse than a controller.
    fn of(measure: Measure, controller: &str) -> Self {
        Self {
            side: if measure.larger_is_better() {
                Side::AtLeast
            } else {
                Side::AtMost
            },
            measure,
            bound: Bound::Of(controller.to_string()),
        }
    }
}
