//! Whether a campaign's `[[require]]` hold.

use super::measures::{failed_by, of_loop};
use super::numbers::{of_episodes, sorted};
use super::scores::{Scores, Status};
use super::strata::{Subset, parts};
use super::summary::RateMethod;
use crate::campaign::{
    ALL, Campaign, CampaignError, ChannelsOfCampaign, Compared, EpisodeNumber, LoopNumber, Measure,
    MeasuredChannels, Requirement, Side,
};
use crate::controllers::GainSet;
use crate::statistics::{
    LEVEL, PairedFailures, clopper_pearson_upper, paired_difference, quantile, quantile_lower,
    quantile_upper, sequential_upper,
};
use serde::{Deserialize, Serialize};

/// The level of a two-sided interval each of whose ends is a one-sided bound with confidence [`LEVEL`].
const TWO_SIDED: f64 = 2.0 * LEVEL - 1.0;

/// What became of a `[[require]]`: the bound that was found beside the one that is required.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RequirementResult {
    /// Its place in the campaign file.
    #[serde(default)]
    pub place: usize,
    /// The controller that it is about.
    pub controller: String,
    /// Which episodes: "all", or those of a stratum.
    pub stratum: String,
    /// What is measured, in the words of the file, with the controller that it is compared with.
    #[serde(default = "failure_rate")]
    pub quantity: String,
    /// Which bound is limited.
    #[serde(default)]
    pub side: Side,
    /// The required bound.
    pub limit: f64,
    /// What was found in the episodes; none of a controller of which it is not known.
    #[serde(default)]
    pub value: Option<f64>,
    /// Its one-sided 95 % bound on that side; none where these episodes give none. Of shares Clopper-Pearson's, or that
    /// of the confidence sequence where the campaign has a `[stop]`; of quantiles an order statistic; of the difference
    /// of two shares Tango's. What chance is not in is its own bound.
    #[serde(alias = "upper_95")]
    pub bound_95: Option<f64>,
    /// Episodes that it is known from; of a measure that does not apply to all episodes, those to which it does.
    pub n: u64,
    /// Episodes of the stratum in which the controller failed.
    pub failed: u64,
}

fn failure_rate() -> String {
    Measure::FailureRate.to_string()
}

impl RequirementResult {
    /// Whether the required bound is proved.
    #[must_use]
    pub fn is_met(&self) -> bool {
        let holds = |bound| self.side.holds(bound, self.limit);
        self.bound_95.is_some_and(holds)
    }

    /// Whether what was found would hold if it were sure.
    #[must_use]
    pub fn seems_met(&self) -> bool {
        let holds = |value| self.side.holds(value, self.limit);
        self.value.is_some_and(holds)
    }

    /// Whether it is about how often the controller fails, and nothing else.
    #[must_use]
    pub fn is_failure_rate(&self) -> bool {
        self.quantity == failure_rate() && self.side == Side::AtMost
    }

    /// The controller, with the stratum if it is about one.
    #[must_use]
    pub fn subject(&self) -> String {
        if self.stratum == ALL {
            self.controller.clone()
        } else {
            format!("{} in {:?}", self.controller, self.stratum)
        }
    }
}

/// What became of each requirement, in the campaign's order.
#[must_use]
pub fn requirements(
    campaign: &Campaign,
    gains: &[GainSet],
    scores: &Scores,
) -> Vec<RequirementResult> {
    let parts = parts(campaign, scores);
    let judge = Judge {
        campaign,
        gains,
        scores,
    };
    let result = |requirement: &Requirement| {
        let part = parts.iter().find(|part| part.name == requirement.stratum)?;
        judge.judged(requirement, part)
    };
    campaign.requirements.iter().filter_map(result).collect()
}

/// Whether all that is required of loops is known of these gains, so that a run can be judged.
///
/// # Errors
/// If it is not: a controller without fault estimates has no certified level, and of gains whose design is not at hand
/// no margin is known.
pub fn can_be_judged(campaign: &Campaign, gains: &[GainSet]) -> Result<(), CampaignError> {
    for requirement in &campaign.requirements {
        let Measure::Loop { number, channels } = &requirement.measure else {
            continue;
        };
        let other = requirement.compared.as_ref().map(Compared::other);
        for name in [Some(requirement.controller.as_str()), other]
            .into_iter()
            .flatten()
        {
            let index = campaign.controllers.iter().position(|own| own == name);
            let known = index.and_then(|index| of_loop(campaign, gains, index, *number, channels));
            if known.is_none() {
                return Err(campaign.invalid(
                    &format!("require[{}].measure", requirement.place),
                    format!("{:?}", requirement.measure.to_string()),
                    &format!("this is not known of {name:?}"),
                    "name a controller that has it (certified_rho: one that estimates the faults), or remove the [[require]]",
                ));
            }
        }
    }
    Ok(())
}

/// What is found of a quantity: its value, its bound on the side that is asked for, and from how many episodes.
type Found = (Option<f64>, Option<f64>, u64);

/// What requirements are judged by.
struct Judge<'a> {
    campaign: &'a Campaign,
    gains: &'a [GainSet],
    scores: &'a Scores,
}

impl Judge<'_> {
    fn judged(&self, requirement: &Requirement, part: &Subset) -> Option<RequirementResult> {
        let controller = self.place(&requirement.controller)?;
        let (side, compared) = (requirement.side, &requirement.compared);
        let other = match compared {
            Some(compared) => Some(self.place(compared.other())?),
            None => None,
        };
        let status = &self.scores.status[controller];
        let failed = part
            .episodes
            .iter()
            .filter(|&&own| status[own] != Status::Ok);
        let (value, bound_95, n) = match &requirement.measure {
            Measure::FailureRate => {
                let failed = |controller: usize| {
                    let all = self.scores.status[controller].iter();
                    all.map(|own| *own != Status::Ok).collect::<Vec<bool>>()
                };
                self.of_shares(
                    [Some(controller), other].map(|own| own.map(failed)),
                    part,
                    side,
                )
            }
            Measure::Survival { at_s } => {
                let survived = |controller| {
                    let failed = failed_by(self.campaign, self.scores, controller, *at_s);
                    failed
                        .into_iter()
                        .map(|failed| !failed)
                        .collect::<Vec<bool>>()
                };
                self.of_shares(
                    [Some(controller), other].map(|own| own.map(survived)),
                    part,
                    side,
                )
            }
            Measure::Episodes {
                number,
                channels,
                share,
            } => {
                let values = self.numbers(controller, *number, channels, compared.as_ref());
                let sorted = sorted(&values, part.episodes.iter().copied());
                let bound = match side {
                    Side::AtMost => quantile_upper,
                    Side::AtLeast => quantile_lower,
                };
                let bound = bound(&sorted, *share, LEVEL);
                (quantile(&sorted, *share), bound, sorted.len() as u64)
            }
            Measure::Loop { number, channels } => {
                let value = self.of_loop(controller, *number, channels, compared.as_ref());
                (value, value, part.episodes.len() as u64)
            }
        };
        let finite = |value: &f64| value.is_finite();
        Some(RequirementResult {
            place: requirement.place,
            controller: requirement.controller.clone(),
            stratum: requirement.stratum.to_string(),
            quantity: requirement.quantity(),
            side,
            limit: requirement.limit,
            value: value.filter(finite),
            bound_95: bound_95.filter(finite),
            n,
            failed: failed.count() as u64,
        })
    }

    fn place(&self, controller: &str) -> Option<usize> {
        let mut controllers = self.campaign.controllers.iter();
        controllers.position(|name| name == controller)
    }

    fn channels(&self, channels: &MeasuredChannels) -> ChannelsOfCampaign {
        self.campaign.channel_groups().swap_remove(channels.index)
    }

    /// The share of the episodes in which something happens, or the difference of two such shares.
    fn of_shares(&self, [own, other]: [Option<Vec<bool>>; 2], part: &Subset, side: Side) -> Found {
        let own = own.unwrap_or_default();
        let n = part.episodes.len() as u64;
        let count = |happens: &dyn Fn(usize) -> bool| {
            part.episodes
                .iter()
                .filter(|&&episode| happens(episode))
                .count() as u64
        };
        let Some(other) = other else {
            let happened = count(&|episode| own[episode]);
            let upper = match RateMethod::of(self.campaign) {
                RateMethod::Sequential => sequential_upper,
                RateMethod::Wilson | RateMethod::Replicates => clopper_pearson_upper,
            };
            let bound = match side {
                Side::AtMost => upper(happened, n, LEVEL),
                Side::AtLeast => 1.0 - upper(n - happened, n, LEVEL),
            };
            let value = (n > 0).then(|| happened as f64 / n as f64);
            return (value, Some(bound), n);
        };
        let both = PairedFailures {
            both: count(&|episode| own[episode] && other[episode]),
            only_a: count(&|episode| own[episode] && !other[episode]),
            only_b: count(&|episode| !own[episode] && other[episode]),
            neither: count(&|episode| !own[episode] && !other[episode]),
        };
        let found = paired_difference(&both, TWO_SIDED);
        let bound = found.map(|found| match side {
            Side::AtMost => found.interval.upper,
            Side::AtLeast => found.interval.lower,
        });
        (found.map(|found| found.value), bound, n)
    }

    /// A number of each episode, or how it compares with that of another controller in the same episode. Where both
    /// diverge they are alike; errors that are rounding are taken for equal.
    fn numbers(
        &self,
        controller: usize,
        number: EpisodeNumber,
        channels: &MeasuredChannels,
        compared: Option<&Compared>,
    ) -> Vec<f64> {
        let of = self.channels(channels);
        let numbers = |index| of_episodes(self.campaign, self.scores, index, number, &of);
        let own = numbers(controller);
        let Some(compared) = compared else {
            return own;
        };
        let other = self
            .place(compared.other())
            .map(numbers)
            .unwrap_or_default();
        let smallest = match number {
            EpisodeNumber::Rmse | EpisodeNumber::MaxAbs => {
                self.campaign.groups()[of.group].verdict.smallest_error
            }
            _ => 0.0,
        };
        let of_pair = |(own, other): (f64, f64)| {
            let [own, other] = [own, other].map(|value| match value < smallest {
                true => smallest,
                false => value,
            });
            #[expect(clippy::float_cmp, reason = "two zeros or infinities are alike")]
            match compared {
                Compared::RatioTo(_) if own == other => 1.0,
                Compared::RatioTo(_) => own / other,
                Compared::DifferenceTo(_) if own == other => 0.0,
                Compared::DifferenceTo(_) => own - other,
            }
        };
        own.into_iter().zip(other).map(of_pair).collect()
    }

    fn of_loop(
        &self,
        controller: usize,
        number: LoopNumber,
        channels: &MeasuredChannels,
        compared: Option<&Compared>,
    ) -> Option<f64> {
        let value = |index| of_loop(self.campaign, self.gains, index, number, channels);
        let own = value(controller)?;
        let other = |compared: &Compared| value(self.place(compared.other())?);
        match compared {
            None => Some(own),
            Some(compared @ Compared::RatioTo(_)) => Some(own / other(compared)?),
            Some(compared @ Compared::DifferenceTo(_)) => Some(own - other(compared)?),
        }
    }
}
