//! `[sampling]` and `[stop]`: how the episodes are drawn, and when enough is known.

use crate::campaign::check::Check;
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::plan::{Goal, Sampling, Stop};
use crate::random::{MOST_ENTRIES, Method, allows};
use crate::util::suggest::did_you_mean;

/// Replicates of a design, if nothing else is asked for.
const REPLICATES: u32 = 8;
/// Episodes between two looks, if nothing else is asked for.
const EVERY: u32 = 64;
/// Confidence of an early stop, if nothing else is asked for.
const CONFIDENCE: f64 = 0.95;

impl Check<'_> {
    /// The sampling design, and whether it can be had of this campaign, whose largest group has so many disturbances or
    /// faults.
    pub(super) fn sampling(
        &self,
        file: &CampaignFile,
        entries: Option<usize>,
    ) -> Result<Sampling, CampaignError> {
        let own = file.sampling.clone().unwrap_or_default();
        let replicates = own.replicates.unwrap_or(REPLICATES);
        let (sampling, name) = match own.design.unwrap_or(DesignFile::Independent) {
            DesignFile::Independent => {
                return match own.replicates {
                    None => Ok(Sampling::Independent),
                    Some(replicates) => Err(self.invalid(
                        "sampling.replicates",
                        replicates,
                        "independent numbers need no replicates",
                        "remove it, or give a design: \"latin-hypercube\" or \"sobol\"",
                    )),
                };
            }
            DesignFile::LatinHypercube => (
                Sampling::LatinHypercube { replicates },
                "\"latin-hypercube\"",
            ),
            DesignFile::Sobol => (Sampling::Sobol { replicates }, "\"sobol\""),
        };
        let refused =
            |limit: &str, remedy: &str| Err(self.invalid("sampling.design", name, limit, remedy));
        if !file.strata.is_empty() {
            return refused(
                "the design balances all episodes together, and would leave each of the strata without balance",
                "use \"independent\", or remove [[strata]]",
            );
        }
        if entries.is_some_and(|entries| entries > MOST_ENTRIES) {
            return refused(
                &format!("a design has at most {MOST_ENTRIES} disturbances and as many faults"),
                "use \"independent\"",
            );
        }
        self.divides("episodes", sampling, file.episodes)?;
        Ok(sampling)
    }

    /// Refuses a number of episodes, which `key` gives, that makes no equal replicates of a design.
    pub(crate) fn divides(
        &self,
        key: &str,
        sampling: Sampling,
        episodes: u32,
    ) -> Result<(), CampaignError> {
        let Some(replicates) = sampling.replicates() else {
            return Ok(());
        };
        if replicates == 0 {
            return Err(self.invalid(
                "sampling.replicates",
                0,
                "there is at least one replicate",
                "use five or more: their scatter gives the intervals",
            ));
        }
        let rows = episodes.div_ceil(replicates).max(2);
        let (whole, words) = match sampling {
            Sampling::Sobol { .. } => (
                rows.checked_next_power_of_two(),
                "nets, each of a power of two of episodes",
            ),
            _ => (Some(rows), "hypercubes of equal size, 2 or more"),
        };
        let fitting = whole.and_then(|rows| rows.checked_mul(replicates));
        if fitting == Some(episodes) {
            return Ok(());
        }
        let remedy = fitting.map_or("take fewer replicates".to_string(), |fitting| {
            format!("simulate {fitting} episodes, or change sampling.replicates")
        });
        Err(self.invalid(
            key,
            episodes,
            &format!("sampling.replicates = {replicates} makes {replicates} {words}"),
            &remedy,
        ))
    }

    /// When the run may end early.
    pub(super) fn stop(
        &self,
        file: &CampaignFile,
        controllers: &[String],
        sampling: Sampling,
    ) -> Result<Option<Stop>, CampaignError> {
        let Some(own) = &file.stop else {
            return Ok(None);
        };
        if !allows(sampling.design(), Method::FailureRate) {
            return Err(self.invalid(
                "stop",
                "given",
                "what is proved on the way takes independent episodes",
                "remove it, or set sampling.design = \"independent\"",
            ));
        }
        if !file.strata.is_empty() {
            return Err(self.invalid(
                "stop",
                "given",
                "what is proved on the way takes episodes of one kind, and strata are of several",
                "remove it, or remove [[strata]]",
            ));
        }
        let controller = self.controller("stop.controller", &own.controller, controllers)?;
        let goal = |key: &str, value: Option<f64>, most: f64, goal: fn(f64) -> Goal| {
            value.map(|value| self.between(key, value, 0.0, most).map(goal))
        };
        let goals = [
            goal(
                "stop.failure_rate_below",
                own.failure_rate_below,
                1.0,
                Goal::Below,
            ),
            goal(
                "stop.failure_rate_above",
                own.failure_rate_above,
                1.0,
                Goal::Above,
            ),
            goal("stop.half_width", own.half_width, 0.5, Goal::HalfWidth),
        ];
        let goals = goals
            .into_iter()
            .flatten()
            .collect::<Result<Vec<Goal>, _>>()?;
        if goals.is_empty() {
            return Err(self.invalid(
                "stop",
                "without a goal",
                "a run ends early when something is known of the failure rate",
                "give failure_rate_below, failure_rate_above or half_width",
            ));
        }
        let every = own.every.unwrap_or(EVERY);
        if every == 0 {
            return Err(self.invalid(
                "stop.every",
                0,
                "at least one episode lies between two looks",
                "give a positive number",
            ));
        }
        Ok(Some(Stop {
            controller,
            goals,
            confidence: self.between(
                "stop.confidence",
                own.confidence.unwrap_or(CONFIDENCE),
                0.0,
                1.0,
            )?,
            every,
        }))
    }

    /// The index of a controller of the campaign.
    pub(super) fn controller(
        &self,
        key: &str,
        name: &str,
        controllers: &[String],
    ) -> Result<usize, CampaignError> {
        controllers
            .iter()
            .position(|own| own == name)
            .ok_or_else(|| {
                let remedy = did_you_mean(
                    name,
                    controllers.iter().map(String::as_str),
                    "name one of them, or add it to `controllers`",
                );
                let limit = format!("the campaign's controllers are {}", controllers.join(", "));
                self.invalid(key, format!("{name:?}"), &limit, &remedy)
            })
    }

    /// A number between two others.
    fn between(&self, key: &str, value: f64, low: f64, high: f64) -> Result<f64, CampaignError> {
        if low < value && value < high {
            return Ok(value);
        }
        Err(self.invalid(
            key,
            in_toml(value),
            &format!("must lie between {low} and {high}"),
            "give a value within the limits",
        ))
    }
}
