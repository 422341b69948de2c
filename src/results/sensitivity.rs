//! Which condition breaks it: the effect of what was drawn on how the controllers fared, and the worst episodes.

use super::paired::{Measured, log_ratios};
use super::scores::{Scores, Status};
use super::table::Table;
use super::team::{Layout, team_rmse};
use crate::campaign::{AgentGroup, Campaign, Fault, Stratum, StratumFaults};
use crate::draw::quantities::fault_of;
use crate::random::Method;
use crate::statistics::{Effect, LEVEL, Outcome, Permutations, Ranked, effects, holm};
use serde::{Serialize, Serializer};
use std::cmp::Ordering;
use std::sync::Arc;

/// Fewest random permutations of a test.
const PERMUTATIONS: u32 = 4_000;
/// Permutations for each condition of a family: so many that the smallest p-value of a condition, which is tested in
/// two ways, is a third of the 5 % after Holm's correction for the family. Fewer, and no effect however strong could be
/// called sure.
const PER_CONDITION: usize = 120;
/// Episodes up to which all of them are permuted: more would take hours, and change nothing.
const SHUFFLED: usize = 1 << 14;
/// Worst episodes that are listed of each controller.
const WORST: usize = 10;

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
    let of_target = |(target, outcome): (Target, Outcome)| {
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
    targets(campaign, scores)
        .into_iter()
        .flat_map(of_target)
        .collect()
}

/// A condition where it was left to chance. In a stratum whose faults are certain, how many agents have one is not, and
/// what goes with the number (the first onset, the mean over more channels) would be taken for what goes with the
/// stratum: where some strata draw their faults, faults are ranked in those only.
pub(crate) fn by_chance(
    campaign: &Campaign,
    condition: &str,
    values: &[Option<f64>],
) -> Vec<Option<f64>> {
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
        for of_group in &groups {
            let rmse = team_rmse(scores, index, &Layout::new(campaign, of_group));
            if let Some(ranked) = Ranked::of_all(&rmse) {
                let target = target("rmse", Some(of_group.name.clone()));
                targets.push((target, Outcome::Metric(ranked)));
            }
        }
    }
    for a in 0..controllers.len() {
        for b in a + 1..controllers.len() {
            for of_group in &groups {
                let layout = Layout::new(campaign, of_group);
                if let Some(ranked) = Ranked::of_all(&log_ratios(campaign, scores, [a, b], &layout))
                {
                    let target = Target {
                        kind: "log_ratio",
                        controller: controllers[a].clone(),
                        against: Some(controllers[b].clone()),
                        group: Some(of_group.name.clone()),
                    };
                    targets.push((target, Outcome::Metric(ranked)));
                }
            }
        }
    }
    targets
}

/// The worst episodes of each controller, worst first: by how they ended, then by the largest error over its limit; of
/// those that diverged, the earlier the worse.
#[must_use]
pub fn worst(campaign: &Campaign, scores: &Scores) -> Vec<WorstEpisode> {
    let of_controller = |(index, name): (usize, &String)| {
        let episodes = 0..scores.episodes();
        let mut bad: Vec<Bad> = episodes
            .map(|k| Bad::of(campaign, scores, index, k))
            .collect();
        bad.sort_by(Bad::order);
        let ranked = bad.into_iter().take(WORST).enumerate();
        let named = ranked.map(|(rank, bad)| bad.named(campaign, scores, name, rank + 1));
        named.collect::<Vec<_>>()
    };
    let controllers = campaign.controllers.iter().enumerate();
    controllers.flat_map(of_controller).collect()
}

/// All episodes under a controller, the worst first.
pub(super) fn order(campaign: &Campaign, scores: &Scores, controller: usize) -> Vec<usize> {
    let of_episode = |episode| Bad::of(campaign, scores, controller, episode);
    let mut bad: Vec<Bad> = (0..scores.episodes()).map(of_episode).collect();
    bad.sort_by(Bad::order);
    bad.iter().map(|bad| bad.episode).collect()
}

/// How bad an episode was under a controller.
struct Bad {
    status: Status,
    excess: f64,
    /// Step of the first failure; the last possible one where no single step failed.
    failed_step: u32,
    episode: usize,
    agent: usize,
    channel: usize,
}

impl Bad {
    fn of(campaign: &Campaign, scores: &Scores, controller: usize, episode: usize) -> Self {
        let status = scores.status[controller][episode];
        let step = |agent: usize| {
            let (group, own) = campaign.member(agent);
            let of_group = &scores.groups[campaign.group_index(agent)];
            let steps = &of_group.failed_step[controller];
            steps[episode * group.team + own].unwrap_or(u32::MAX)
        };
        let agents = campaign.agents();
        let first = (0..agents).min_by_key(|&agent| step(agent)).unwrap_or(0);
        // If an episode diverges, only its first failing agent counts: it may have pulled the others along.
        let looked_at = match status {
            Status::Diverged => first..first + 1,
            Status::Ok | Status::Exceeded => 0..agents,
        };
        let of_agent = |agent: usize| {
            let (group, own) = campaign.member(agent);
            let channels = group.channels().len();
            let errors = &scores.groups[campaign.group_index(agent)].max_abs[controller];
            let errors = &errors[(episode * group.team + own) * channels..];
            let limits = group.verdict.max_error.iter().zip(errors).enumerate();
            limits.map(move |(channel, (limit, error))| {
                let limit = if limit.is_finite() { *limit } else { 1.0 };
                let excess = match error / limit {
                    // What left the numbers is as large as can be.
                    excess if excess.is_nan() => f64::INFINITY,
                    excess => excess,
                };
                (excess, agent, channel)
            })
        };
        let largest = looked_at
            .flat_map(of_agent)
            .reduce(|a, b| if b.0 > a.0 { b } else { a });
        let (excess, agent, channel) = largest.unwrap_or_default();
        Self {
            status,
            excess,
            failed_step: step(first),
            episode,
            agent,
            channel,
        }
    }

    /// Worst first.
    fn order(&self, other: &Self) -> Ordering {
        let by_size = match self.status {
            Status::Diverged => self.failed_step.cmp(&other.failed_step),
            Status::Ok | Status::Exceeded => other.excess.total_cmp(&self.excess),
        };
        let by_status = other.status.cmp(&self.status);
        by_status
            .then(by_size)
            .then(self.episode.cmp(&other.episode))
    }

    fn named(
        self,
        campaign: &Campaign,
        scores: &Scores,
        controller: &str,
        rank: usize,
    ) -> WorstEpisode {
        let time = campaign.time;
        let index = u32::try_from(self.episode).unwrap_or(u32::MAX);
        let faults = campaign.faults().zip(&scores.fault_occurs);
        let struck = faults.filter(|(_, occurs)| occurs.get(self.episode) == Some(&true));
        let titled = |((group, fault), _): ((&AgentGroup, &Fault), _)| group.titled(&fault.name);
        let conditions = scores.conditions.iter();
        WorstEpisode {
            controller: controller.to_string(),
            rank,
            episode: index,
            status: self.status,
            excess: self.excess,
            failed_at_s: (self.failed_step != u32::MAX)
                .then(|| f64::from(self.failed_step) * time.step_s),
            agent: self.agent,
            channel: campaign.member(self.agent).0.channels()[self.channel].clone(),
            stratum: campaign.strata.of(index).map(|own| own.name.clone()),
            faults: struck.map(titled).map(Arc::from).collect(),
            conditions: conditions
                .map(|(name, values)| (name.clone(), values[self.episode]))
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
