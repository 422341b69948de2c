//! Which condition breaks it: the effect of what was drawn on how the controllers fared, and the worst episodes.

use super::bad_episode::BadEpisode;
use super::paired::{Measured, log_ratios};
use super::scores::{Scores, Status};
use super::table::Table;
use super::team::TeamNumbers;
use crate::campaign::{AgentGroup, Campaign, ChannelsOfCampaign, Fault, Stratum, StratumFaults};
use crate::draw::quantities::fault_of;
use crate::random::Method;
use crate::statistics::{Effect, LEVEL, Outcome, Permutations, Ranked, effects, holm};
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// Fewest random permutations of a test.
const PERMUTATIONS: u32 = 4_000;
/// Permutations for each condition of a family: so many that the smallest p-value of a condition, which is tested in
/// two ways, is a third of the 5 % after Holm's correction for the family. Fewer, and no effect however strong could be
/// called sure.
const PER_CONDITION: usize = 120;
/// Episodes up to which all of them are permuted: more would take hours, and change nothing.
const SHUFFLED: usize = 1 << 14;

/// What a condition may have an effect on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Target {
    /// "failure", "rmse" or "log_ratio".
    #[serde(rename = "target")]
    pub kind: &'static str,
    /// The controller.
    pub controller: String,
    /// The controller that it is compared with, of a log-ratio: ln(rmse of `against` / rmse of `controller`).
    pub against: Option<String>,
    /// The channel group, unless it is about failures.
    pub group: Option<Arc<str>>,
}

/// The effect of a condition on a target, over the episodes in which it applies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensitivityResult {
    /// What it has an effect on.
    #[serde(flatten)]
    pub target: Target,
    /// The condition, as [`crate::draw::quantities`] names it.
    pub condition: String,
    /// Episodes in which the condition applies.
    pub episodes: usize,
    /// The monotone effect: [`crate::statistics::somers_d`] on failures, Spearman's rank correlation on all else; its
    /// interval is that of independent draws.
    pub trend: Measured,
    /// p-value of no such effect; where there is `p_holm`.
    pub trend_p: Option<f64>,
    /// The effect of any form ([`crate::statistics::Effect::shape`]).
    pub shape: f64,
    /// p-value of no such effect; where there is `p_holm`.
    pub shape_p: Option<f64>,
    /// p-value of no effect, after Holm's correction for all conditions of the target; where permutations are a test of
    /// it: of independent draws and within one hypercube.
    pub p_holm: Option<f64>,
}

/// A bad episode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorstEpisode {
    /// The controller.
    pub controller: String,
    /// 1 is the worst.
    pub rank: usize,
    /// The episode.
    pub episode: u32,
    /// How it ended.
    pub status: Status,
    /// Largest |e| over its limit in the verdict, or in m or rad where there is none; infinite after a divergence.
    #[serde(rename = "largest_error_over_limit")]
    pub excess: f64,
    /// When an agent first broke max_error or left the numbers, s.
    pub failed_at_s: Option<f64>,
    /// The agent and channel of this largest error; after a divergence those of the agent that failed first.
    pub agent: usize,
    /// The channel.
    pub channel: Arc<str>,
    /// Its stratum, of campaigns that have some.
    pub stratum: Option<Arc<str>>,
    /// The faults that struck someone.
    pub faults: Vec<Arc<str>>,
    /// What the episode met.
    #[serde(serialize_with = "by_name")]
    pub conditions: Vec<(String, Option<f64>)>,
}

fn by_name<S: Serializer>(
    conditions: &[(String, Option<f64>)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(conditions.iter().map(|(name, size)| (name, size)))
}

/// The effects of all conditions that vary, of each target the largest trend first.
#[must_use]
pub fn rank(campaign: &Campaign, scores: &Scores) -> Vec<SensitivityResult> {
    let named: Vec<(&String, Ranked)> = scores
        .conditions
        .iter()
        .filter_map(|(name, values)| Some((name, Ranked::of(&by_chance(campaign, name, values))?)))
        .filter(|(_, values)| values.distinct() > 1)
        .collect();
    let (names, columns): (Vec<&String>, Vec<Ranked>) = named.into_iter().unzip();
    let sampling = campaign.sampling;
    let with_interval = campaign.allows(Method::EffectInterval);
    let one = sampling
        .replicates()
        .is_none_or(|replicates| replicates == 1);
    let tested = one && campaign.allows(Method::EffectTest);
    let permutations = Permutations {
        seed: campaign.seed,
        most: match tested {
            true => {
                PERMUTATIONS.max(u32::try_from(PER_CONDITION * names.len()).unwrap_or(u32::MAX))
            }
            false => 0,
        },
        shuffled: SHUFFLED,
    };
    let of_target = |(target, pair, numbers): (Target, [usize; 2], Option<TeamNumbers>)| {
        let Some(outcome) = outcome(campaign, scores, pair, numbers.as_ref()) else {
            return Vec::new();
        };
        let effects = effects(&columns, &outcome, LEVEL, permutations);
        let found: Vec<(&&String, Effect)> = names
            .iter()
            .zip(effects)
            .filter_map(|(name, effect)| Some((name, effect?)))
            .collect();
        let p_values: Vec<f64> = found.iter().map(|(_, effect)| effect.p_value()).collect();
        let mut ranked: Vec<SensitivityResult> = found
            .into_iter()
            .zip(holm(&p_values))
            .map(|((name, effect), p_holm)| SensitivityResult {
                target: target.clone(),
                condition: (*name).clone(),
                episodes: effect.n,
                trend: Measured {
                    value: effect.trend.value,
                    // With few episodes the interval may be all of [-1, 1]; then it is omitted.
                    interval: Some(effect.trend.interval)
                        .filter(|own| with_interval && (own.lower > -1.0 || own.upper < 1.0)),
                },
                trend_p: tested.then_some(effect.trend_p),
                shape: effect.shape,
                shape_p: tested.then_some(effect.shape_p),
                p_holm: tested.then_some(p_holm),
            })
            .collect();
        let size = |ranked: &SensitivityResult| ranked.trend.value.abs();
        ranked.sort_by(|a, b| size(b).total_cmp(&size(a)));
        ranked
    };
    targets(campaign).into_iter().flat_map(of_target).collect()
}

/// A condition where it was left to chance; of its values, one that is not a number does not apply. In a stratum whose
/// faults are certain, how many agents have one is not, and what goes with the number (the first onset, the mean over
/// more channels) would be taken for what goes with the stratum: where some strata draw their faults, faults are ranked
/// in those only.
pub(super) fn by_chance(campaign: &Campaign, condition: &str, values: &[f64]) -> Vec<Option<f64>> {
    let draws = |stratum: &Stratum| stratum.faults == StratumFaults::ByProbability;
    let strata = &campaign.strata;
    let has_background = |fault| {
        let mut faults = campaign.faults();
        faults.nth(fault).is_some_and(|(_, fault)| fault.background)
    };
    let only_drawn = match fault_of(condition) {
        Some((fault, _)) if has_background(fault) => false,
        Some((_, "agents")) => !strata.is_empty(),
        Some(_) => strata.all().iter().any(draws),
        None => false,
    };
    let kept = |episode| !only_drawn || strata.of(episode).is_some_and(draws);
    (0..)
        .zip(values)
        .map(|(episode, value)| Some(*value).filter(|value| !value.is_nan() && kept(episode)))
        .collect()
}

/// What the conditions may have an effect on.
fn targets(campaign: &Campaign) -> Vec<(Target, [usize; 2], Option<TeamNumbers>)> {
    let controllers = &campaign.controllers;
    let groups = campaign.channel_groups();
    let target = |kind, a: usize, b: Option<usize>, group: Option<&ChannelsOfCampaign>| {
        let target = Target {
            kind,
            controller: controllers[a].clone(),
            against: b.map(|b| controllers[b].clone()),
            group: group.map(|group| group.name.clone()),
        };
        let numbers = group.map(|group| TeamNumbers::on(campaign, group));
        (target, [a, b.unwrap_or(a)], numbers)
    };
    let mut targets = Vec::new();
    for a in 0..controllers.len() {
        targets.push(target("failure", a, None, None));
        let of_groups = groups.iter();
        targets.extend(of_groups.map(|group| target("rmse", a, None, Some(group))));
    }
    for a in 0..controllers.len() {
        for b in a + 1..controllers.len() {
            let of_groups = groups.iter();
            targets.extend(of_groups.map(|group| target("log_ratio", a, Some(b), Some(group))));
        }
    }
    targets
}

/// How controllers fared by a target, one of them or a pair, on some channels; none of numbers that are none.
fn outcome(
    campaign: &Campaign,
    scores: &Scores,
    [a, b]: [usize; 2],
    numbers: Option<&TeamNumbers>,
) -> Option<Outcome> {
    let Some(numbers) = numbers else {
        let failed = scores.status[a].iter().map(|own| *own != Status::Ok);
        let failed: Vec<bool> = failed.collect();
        return Some(Outcome::Failure(Ranked::of_flags(&failed)));
    };
    let values = match a == b {
        true => numbers.rmse(scores, a),
        false => log_ratios(campaign, scores, [a, b], numbers),
    };
    Ranked::of_all(&values).map(Outcome::Metric)
}

/// The worst episodes of each controller, worst first: by how they ended, then by the largest error over its limit; of
/// those that diverged, the earlier the worse.
#[must_use]
pub fn worst(campaign: &Campaign, scores: &Scores) -> Vec<WorstEpisode> {
    let of_controller = |(name, bad): (&String, &Vec<BadEpisode>)| {
        let named = bad.iter().enumerate();
        let named =
            named.map(|(rank, bad)| WorstEpisode::new(campaign, scores, name, rank + 1, bad));
        named.collect::<Vec<_>>()
    };
    let controllers = campaign.controllers.iter().zip(&scores.worst);
    controllers.flat_map(of_controller).collect()
}

impl WorstEpisode {
    fn new(
        campaign: &Campaign,
        scores: &Scores,
        controller: &str,
        rank: usize,
        bad: &BadEpisode,
    ) -> Self {
        let time = campaign.time;
        let index = u32::try_from(bad.episode).unwrap_or(u32::MAX);
        let faults = campaign.faults().zip(&scores.fault_occurs);
        let struck = faults.filter(|(_, occurs)| occurs.get(bad.episode) == Some(&true));
        let titled = |((group, fault), _): ((&AgentGroup, &Fault), _)| group.titled(&fault.name);
        let conditions = scores.conditions.iter();
        Self {
            controller: controller.to_string(),
            rank,
            episode: index,
            status: bad.status,
            excess: bad.excess,
            failed_at_s: (bad.failed_step != u32::MAX)
                .then(|| f64::from(bad.failed_step) * time.step_s),
            agent: bad.agent,
            channel: campaign.member(bad.agent).0.channels()[bad.channel].clone(),
            stratum: campaign.strata.of(index).map(|own| own.name.clone()),
            faults: struck.map(titled).map(Arc::from).collect(),
            conditions: conditions
                .map(|(name, values)| {
                    let value = values[bad.episode];
                    (name.clone(), (!value.is_nan()).then_some(value))
                })
                .collect(),
        }
    }
}

/// [`rank`] as a table.
#[must_use]
pub fn ranking_table(ranking: &[SensitivityResult]) -> Table {
    let mut table = Table::default();
    for SensitivityResult {
        target,
        condition,
        episodes,
        trend,
        trend_p,
        shape,
        shape_p,
        p_holm,
    } in ranking
    {
        let mut row = table.row();
        row.word(|| "target".into(), target.kind)
            .name(|| "controller".into(), target.controller.as_str().into())
            .name(
                || "against".into(),
                target.against.as_deref().unwrap_or_default().into(),
            )
            .name(|| "group".into(), target.group.clone().unwrap_or_default())
            .name(|| "condition".into(), condition.as_str().into())
            .count(|| "episodes".into(), *episodes as u64)
            .real(|| "trend".into(), trend.value)
            .real_if("trend_lower", trend.interval.map(|own| own.lower))
            .real_if("trend_upper", trend.interval.map(|own| own.upper))
            .real_if("trend_p", *trend_p)
            .real(|| "shape".into(), *shape)
            .real_if("shape_p", *shape_p)
            .real_if("p_holm", *p_holm);
    }
    table
}

/// [`worst`] as a table.
#[must_use]
pub fn worst_table(worst: &[WorstEpisode]) -> Table {
    let mut table = Table::default();
    for episode in worst {
        let mut row = table.row();
        row.name(|| "controller".into(), episode.controller.as_str().into())
            .count(|| "rank".into(), episode.rank as u64)
            .count(|| "episode".into(), u64::from(episode.episode))
            .word(|| "status".into(), episode.status.word())
            .real(|| "largest_error_over_limit".into(), episode.excess)
            .real_if("failed_at_s", episode.failed_at_s)
            .count(|| "agent".into(), episode.agent as u64)
            .name(|| "channel".into(), episode.channel.clone());
        if let Some(stratum) = &episode.stratum {
            row.name(|| "stratum".into(), stratum.clone());
        }
        row.name(|| "faults".into(), episode.faults.join(", ").into());
        for (name, value) in &episode.conditions {
            row.real_if(name, *value);
        }
    }
    table
}
