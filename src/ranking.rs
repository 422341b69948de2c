//! Which condition breaks it: the effect of what was drawn on how the controllers fared, and the worst episodes.

use crate::campaign::{Campaign, ChannelGroup, Stratum, StratumFaults};
use crate::comparison::{LEVEL, Layout, log_ratios, team_rmse};
use crate::conditions::fault_of;
use crate::sampling::{Method, allows};
use crate::statistics::{Effect, Interval, Outcome, Permutations, Ranked, effects, holm};
use crate::tables::{Scores, Status, Table};
use std::sync::Arc;

/// Random permutations of a test: enough for a family of 100 conditions at the level of 5 %, each tested in two ways.
const PERMUTATIONS: u32 = 4_000;
/// Worst episodes that are listed of each controller.
const WORST: usize = 10;

/// What a condition may have an effect on.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// "failure", "rmse" or "log_ratio".
    pub kind: &'static str,
    /// The controller.
    pub controller: String,
    /// The controller that it is compared with, of a log-ratio: ln(rmse of `against` / rmse of `controller`).
    pub against: Option<String>,
    /// The channel group, unless it is about failures.
    pub group: Option<&'static str>,
}

/// The effect of a condition on a target, over the episodes in which it applies.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedCondition {
    /// What it has an effect on.
    pub target: Target,
    /// The condition, as [`crate::conditions`] names it.
    pub condition: String,
    /// The effect: [`crate::statistics::somers_d`] on failures, Spearman's rank correlation on all else.
    pub effect: Effect,
    /// Interval of the trend, of independent draws.
    pub interval: Option<Interval>,
    /// p-value of no effect, after Holm's correction for all conditions of the target; where permutations are a test of it: of
    /// independent draws and within one hypercube.
    pub p_holm: Option<f64>,
}

/// A bad episode.
#[derive(Debug, Clone, PartialEq)]
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
    pub excess: f64,
    /// The agent and channel of this largest error.
    pub agent: usize,
    /// The channel.
    pub channel: Arc<str>,
    /// What the episode met.
    pub conditions: Vec<(String, Option<f64>)>,
}

/// The effects of all conditions that vary, of each target the largest trend first.
#[must_use]
pub fn rank(campaign: &Campaign, scores: &Scores) -> Vec<RankedCondition> {
    let named: Vec<(&String, Ranked)> = scores
        .conditions
        .iter()
        .filter_map(|(name, values)| Some((name, Ranked::of(&drawn(campaign, name, values))?)))
        .filter(|(_, values)| values.distinct() > 1)
        .collect();
    let (names, columns): (Vec<&String>, Vec<Ranked>) = named.into_iter().unzip();
    let (sampling, design) = (campaign.sampling, campaign.sampling.design());
    let with_interval = allows(design, Method::EffectInterval);
    let one = sampling
        .replicates()
        .is_none_or(|replicates| replicates == 1);
    let tested = one && allows(design, Method::EffectTest);
    let permutations = Permutations {
        seed: campaign.seed,
        most: if tested { PERMUTATIONS } else { 0 },
    };
    let of_target = |(target, outcome): (Target, Outcome)| {
        let effects = effects(&columns, &outcome, LEVEL, permutations);
        let found: Vec<(&&String, Effect)> = names
            .iter()
            .zip(effects)
            .filter_map(|(name, effect)| Some((name, effect?)))
            .collect();
        let p_values: Vec<f64> = found.iter().map(|(_, effect)| effect.p_value()).collect();
        let mut ranked: Vec<RankedCondition> = found
            .into_iter()
            .zip(holm(&p_values))
            .map(|((name, effect), p_holm)| RankedCondition {
                target: target.clone(),
                condition: (*name).clone(),
                effect,
                interval: with_interval.then_some(effect.trend.interval),
                p_holm: tested.then_some(p_holm),
            })
            .collect();
        let size = |ranked: &RankedCondition| ranked.effect.trend.value.abs();
        ranked.sort_by(|a, b| size(b).total_cmp(&size(a)));
        ranked
    };
    targets(campaign, scores)
        .into_iter()
        .flat_map(of_target)
        .collect()
}

/// A condition where it was left to chance. In a stratum whose faults are certain, how many agents have one is not, and what
/// goes with the number (the first onset, the mean over more channels) would be taken for what goes with the stratum: where
/// some strata draw their faults, faults are ranked in those only.
fn drawn(campaign: &Campaign, condition: &str, values: &[Option<f64>]) -> Vec<Option<f64>> {
    let draws = |stratum: &Stratum| stratum.faults == StratumFaults::Drawn;
    let strata = &campaign.strata;
    let only_drawn = match fault_of(condition) {
        Some((_, "agents")) => !strata.is_empty(),
        Some(_) => strata.all().iter().any(draws),
        None => false,
    };
    let kept = |episode| !only_drawn || strata.of(episode).is_some_and(draws);
    (0..)
        .zip(values)
        .map(|(episode, value)| value.filter(|_| kept(episode)))
        .collect()
}

fn targets(campaign: &Campaign, scores: &Scores) -> Vec<(Target, Outcome)> {
    let mut targets = Vec::new();
    let controllers = &campaign.controllers;
    let groups = campaign.channel_groups();
    for (index, name) in controllers.iter().enumerate() {
        let target = |kind, group| Target {
            kind,
            controller: name.clone(),
            against: None,
            group,
        };
        let failed = scores.status[index]
            .iter()
            .map(|status| *status != Status::Ok);
        let failed: Vec<bool> = failed.collect();
        let outcome = Outcome::Failure(Ranked::of_flags(&failed));
        targets.push((target("failure", None), outcome));
        for ChannelGroup { role, channels } in &groups {
            let rmse = team_rmse(scores, index, &Layout::new(campaign, channels.clone()));
            if let Some(ranked) = Ranked::of_all(&rmse) {
                let target = target("rmse", Some(role.name()));
                targets.push((target, Outcome::Metric(ranked)));
            }
        }
    }
    for a in 0..controllers.len() {
        for b in a + 1..controllers.len() {
            for ChannelGroup { role, channels } in &groups {
                let layout = Layout::new(campaign, channels.clone());
                if let Some(ranked) = Ranked::of_all(&log_ratios(scores, [a, b], &layout)) {
                    let target = Target {
                        kind: "log_ratio",
                        controller: controllers[a].clone(),
                        against: Some(controllers[b].clone()),
                        group: Some(role.name()),
                    };
                    targets.push((target, Outcome::Metric(ranked)));
                }
            }
        }
    }
    targets
}

/// The worst episodes of each controller, worst first: by how they ended, then by the largest error over its limit.
#[must_use]
pub fn worst(campaign: &Campaign, scores: &Scores) -> Vec<WorstEpisode> {
    let channels = campaign.channels();
    let stride = campaign.team * channels.len();
    let mut all = Vec::new();
    for (index, name) in campaign.controllers.iter().enumerate() {
        let mut episodes: Vec<(Status, f64, usize, usize)> = scores.status[index]
            .iter()
            .enumerate()
            .map(|(episode, status)| {
                let errors = &scores.max_abs[index][episode * stride..(episode + 1) * stride];
                let over = |(place, error): (usize, &f64)| {
                    let limit = campaign.verdict.max_error[place % channels.len()];
                    let limit = if limit.is_finite() { limit } else { 1.0 };
                    // What left the numbers is as large as can be.
                    let excess = if error.is_nan() {
                        f64::INFINITY
                    } else {
                        error / limit
                    };
                    (excess, place)
                };
                let worst = errors.iter().enumerate().map(over);
                let (excess, place) = worst
                    .reduce(|a, b| if b.0 > a.0 { b } else { a })
                    .unwrap_or((0.0, 0));
                (*status, excess, episode, place)
            })
            .collect();
        episodes.sort_by(|a, b| b.0.cmp(&a.0).then(b.1.total_cmp(&a.1)).then(a.2.cmp(&b.2)));
        let of_rank = |(rank, bad): (usize, (Status, f64, usize, usize))| {
            let (status, excess, episode, place) = bad;
            WorstEpisode {
                controller: name.clone(),
                rank: rank + 1,
                episode: u32::try_from(episode).unwrap_or(u32::MAX),
                status,
                excess,
                agent: place / channels.len(),
                channel: channels[place % channels.len()].clone(),
                conditions: scores
                    .conditions
                    .iter()
                    .map(|(name, values)| (name.clone(), values[episode]))
                    .collect(),
            }
        };
        all.extend(episodes.into_iter().take(WORST).enumerate().map(of_rank));
    }
    all
}

/// [`rank`] as a table.
#[must_use]
pub fn ranking_table(ranking: &[RankedCondition]) -> Table {
    let mut table = Table::default();
    for RankedCondition {
        target,
        condition,
        effect,
        interval,
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
            .word(|| "group".into(), target.group.unwrap_or_default())
            .name(|| "condition".into(), condition.as_str().into())
            .count(|| "episodes".into(), effect.n as u64)
            .real(|| "trend".into(), effect.trend.value)
            .real_if("trend_lower", interval.map(|interval| interval.lower))
            .real_if("trend_upper", interval.map(|interval| interval.upper))
            .real_if("trend_p", p_holm.map(|_| effect.trend_p))
            .real(|| "shape".into(), effect.shape)
            .real_if("shape_p", p_holm.map(|_| effect.shape_p))
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
            .count(|| "agent".into(), episode.agent as u64)
            .name(|| "channel".into(), episode.channel.clone());
        for (name, value) in &episode.conditions {
            row.real_if(name, *value);
        }
    }
    table
}
