//! The tables of a run: a row per episode, controller and agent, and one per channel, filled as batches end.

use super::long_tables::{add_conditions, add_faults};
use super::scores::{AgentScores, ChannelScores, Scores, Status, status};
use super::table::{Row, Table};
use crate::agent::ChannelGroup;
use crate::backend::EpisodeResult;
use crate::campaign::{AgentGroup, Campaign, Detail, Time};
use crate::draw::quantities::{Condition, Quantity, Source, conditions, quantities};
use crate::draw::{AgentDraw, AppliedEpisode};
use crate::model::episode::AgentOutcome;
use crate::model::inputs::later_onsets;
use crate::model::metric::{ChannelOutcome, ERROR_METRICS, Metric, OTHER_METRICS};
use std::sync::Arc;

/// The tables of a run, and the numbers that its statistics read.
#[derive(Debug, Clone)]
pub struct Tables {
    /// A row per episode, controller and agent.
    pub episodes: Table,
    /// A row per episode, controller, agent and channel.
    pub channels: Table,
    /// A row per fault that an agent has.
    pub faults: Table,
    /// A row per number that was drawn.
    pub conditions_drawn: Table,
    /// What the statistics read.
    pub scores: Scores,
    /// Names of the controllers, shared by all rows.
    names: Vec<Arc<str>>,
    /// What is drawn, by group of agents, and what the ranking reads of it.
    quantities: Vec<Vec<Quantity>>,
    conditions: Vec<Condition>,
}

impl Tables {
    /// Empty tables of a campaign.
    #[must_use]
    pub fn new(campaign: &Campaign) -> Self {
        let conditions = conditions(campaign);
        Self {
            episodes: Table::default(),
            channels: Table::default(),
            faults: Table::default(),
            conditions_drawn: Table::default(),
            names: campaign
                .controllers
                .iter()
                .map(|name| Arc::from(name.as_str()))
                .collect(),
            scores: Scores {
                fault_occurs: vec![Vec::new(); campaign.faults().count()],
                conditions: conditions
                    .iter()
                    .map(|condition| (condition.key.clone(), Vec::new()))
                    .collect(),
                ..Scores::new(campaign)
            },
            quantities: campaign.groups().iter().map(quantities).collect(),
            conditions,
        }
    }

    /// Adds an episode, of which the result of each group of agents is given; episodes are added in order.
    pub fn add(&mut self, campaign: &Campaign, simulated: &[&EpisodeResult]) {
        // All rows show the times as they happen.
        let groups = campaign.groups().iter().zip(simulated);
        let applied: Vec<AppliedEpisode> = groups
            .map(|(group, simulated)| simulated.episode.applied(group))
            .collect();
        let groups = || campaign.groups().iter().zip(&applied);
        let of_groups = groups().flat_map(|(group, applied)| {
            let having = |fault| applied.agents.iter().any(|draw| has(draw, fault));
            (0..group.faults.len()).map(having).collect::<Vec<_>>()
        });
        for (occurs, own) in self.scores.fault_occurs.iter_mut().zip(of_groups) {
            occurs.push(own);
        }
        for ((_, values), condition) in self.scores.conditions.iter_mut().zip(&self.conditions) {
            values.push(condition.of(&applied).unwrap_or(f64::NAN));
        }
        let drawn = groups().enumerate();
        for (index, (group, applied)) in drawn.filter(|_| campaign.detail == Detail::All) {
            let quantities = &self.quantities[index];
            add_faults(&mut self.faults, campaign, group, applied);
            let drawn = &mut self.conditions_drawn;
            add_conditions(drawn, campaign, group, quantities, applied);
        }
        for controller in 0..campaign.controllers.len() {
            let judged: Vec<Vec<AgentVerdict<'_>>> = groups()
                .zip(simulated)
                .map(|((group, applied), simulated)| {
                    let outcomes = simulated.outcomes[controller].iter();
                    let agents = outcomes.zip(&applied.agents);
                    agents
                        .map(|(outcome, draw)| AgentVerdict::new(group, outcome, draw))
                        .collect()
                })
                .collect();
            let scores = groups().zip(&judged).map(|((group, _), judged)| {
                let agents = judged.iter();
                agents.map(|agent| agent.scores(group.time)).collect()
            });
            let scores: Vec<Vec<AgentScores>> = scores.collect();
            let worst = self.scores.add(campaign, controller, &scores);
            for (index, judged) in judged.iter().enumerate() {
                self.add_group(campaign, index, controller, judged, &applied[index], worst);
            }
        }
    }

    /// Adds the agents of a group under a controller; `worst` is how the episode ended.
    fn add_group(
        &mut self,
        campaign: &Campaign,
        index: usize,
        controller: usize,
        judged: &[AgentVerdict<'_>],
        applied: &AppliedEpisode,
        worst: Status,
    ) {
        let group = &campaign.groups()[index];
        let agents = judged.iter().zip(&applied.agents).enumerate();
        for (place, (judged, draw)) in agents.filter(|_| campaign.detail >= Detail::Episodes) {
            let key = |row: &mut Row<'_>| {
                row.count(|| "episode".into(), u64::from(applied.index))
                    .name(|| "controller".into(), self.names[controller].clone());
                if campaign.has_named_groups() {
                    row.name(|| "group".into(), group.name.clone());
                }
                row.count(|| "agent".into(), (group.first_agent + place) as u64);
            };
            let mut row = self.episodes.row_of(index);
            key(&mut row);
            if let Some(stratum) = campaign.strata.of(applied.index) {
                row.name(|| "stratum".into(), stratum.name.clone());
            }
            if let Some((replicate, _)) = campaign.sampling.place(applied.index) {
                row.count(|| "replicate".into(), u64::from(replicate));
            }
            judged.write_agent(&mut row, group, worst);
            write_draw(&mut row, group, &self.quantities[index], draw);
            let channels = group.channels().iter().zip(&judged.outcome.channels);
            for (channel, outcome) in channels.filter(|_| campaign.detail == Detail::All) {
                let mut row = self.channels.row();
                key(&mut row);
                row.name(|| "channel".into(), channel.clone());
                judged.write_channel(&mut row, campaign.time, outcome);
            }
        }
    }
}

/// Whether an agent has a fault of its group.
fn has(draw: &AgentDraw, fault: usize) -> bool {
    draw.faults[fault].occurs()
}

/// An agent's outcome and what the verdict makes of it.
struct AgentVerdict<'a> {
    outcome: &'a AgentOutcome,
    status: Status,
    /// The step of the agent's first fault that does not begin with the run.
    first_fault: Option<u32>,
}

impl<'a> AgentVerdict<'a> {
    fn new(group: &AgentGroup, outcome: &'a AgentOutcome, draw: &AgentDraw) -> Self {
        Self {
            outcome,
            status: status(group, outcome),
            first_fault: later_onsets(group, draw).into_iter().min(),
        }
    }

    fn write_agent(&self, row: &mut Row<'_>, group: &AgentGroup, worst: Status) {
        let failed_at_s = match (self.status, self.outcome.failed_step) {
            (Status::Ok, _) => None,
            (_, Some(step)) => Some(f64::from(step) * group.time.step_s),
            // A limit on the RMS error is judged, and an overflow of a sum is seen, at the end.
            (_, None) => Some(f64::from(group.time.steps) * group.time.step_s),
        };
        row.word(|| "status".into(), self.status.word())
            .word(|| "episode_status".into(), worst.word())
            .real_if("failed_at_s", failed_at_s);
        for ChannelGroup { role, channels } in group.channel_groups() {
            let role = role.name();
            let channels = &self.outcome.channels[channels];
            let mean_square = channels
                .iter()
                .map(|metrics| metrics.rmse.powi(2))
                .sum::<f64>()
                / channels.len() as f64;
            let largest = channels
                .iter()
                .map(|metrics| metrics.max_abs)
                .fold(0.0, f64::max);
            row.real(|| format!("rmse_{role}"), self.finite(mean_square.sqrt()))
                .real(|| format!("max_abs_{role}"), self.finite(largest));
        }
        let all = &self.outcome.channels;
        let slowest = |time: fn(&Self, Time, &ChannelOutcome) -> Option<f64>| {
            all.iter()
                .map(|metrics| time(self, group.time, metrics))
                .try_fold(0.0, |worst, own| own.map(|own| f64::max(worst, own)))
        };
        row.real_if("settling_s", slowest(Self::settling_s))
            .real_if("recovery_s", slowest(Self::recovery_s))
            .real(
                || "saturated_fraction".into(),
                self.finite(
                    all.iter()
                        .map(|metrics| metrics.saturated_fraction)
                        .fold(0.0, f64::max),
                ),
            );
    }

    fn write_channel(&self, row: &mut Row<'_>, time: Time, metrics: &ChannelOutcome) {
        let write = |row: &mut Row<'_>, metric: &Metric| {
            row.real(|| metric.name.into(), self.finite((metric.of)(metrics)));
        };
        ERROR_METRICS.iter().for_each(|metric| write(row, metric));
        row.real_if("settling_s", self.settling_s(time, metrics))
            .real_if("recovery_s", self.recovery_s(time, metrics));
        OTHER_METRICS.iter().for_each(|metric| write(row, metric));
    }

    /// A metric, or "does not apply" after a divergence: no average may take it in.
    fn finite(&self, value: f64) -> f64 {
        if self.outcome.diverged || !value.is_finite() {
            f64::NAN
        } else {
            value
        }
    }

    /// When the error went below the settled error for good, before the first fault; absent if it did not.
    fn settling_s(&self, time: Time, metrics: &ChannelOutcome) -> Option<f64> {
        let (end, last) = match self.first_fault {
            Some(step) => (step, metrics.last_outside_before_fault),
            None => (time.steps, metrics.last_outside),
        };
        self.calm_from(last, end)
            .map(|step| f64::from(step) * time.step_s)
    }

    /// How long after the first fault the error went below the settled error for good; absent without a fault or if it
    /// did not.
    fn recovery_s(&self, time: Time, metrics: &ChannelOutcome) -> Option<f64> {
        let fault = self.first_fault?;
        let calm = self.calm_from(metrics.last_outside, time.steps)?;
        Some(f64::from(calm.saturating_sub(fault)) * time.step_s)
    }

    /// What the statistics read.
    fn scores(&self, time: Time) -> AgentScores {
        let never = |time_s: Option<f64>| time_s.unwrap_or(f64::INFINITY);
        let channels = self.outcome.channels.iter();
        let channels = channels.map(|metrics| ChannelScores {
            rmse: metrics.rmse,
            max_abs: metrics.max_abs,
            peak: metrics.u_max,
            effort: metrics.effort,
            saturated: metrics.saturated_fraction,
            settling_s: never(self.settling_s(time, metrics)),
            recovery_s: self
                .first_fault
                .map(|_| never(self.recovery_s(time, metrics))),
        });
        AgentScores {
            status: self.status,
            failed_step: self.outcome.failed_step,
            channels: channels.collect(),
        }
    }

    fn calm_from(&self, last_outside: Option<u32>, end: u32) -> Option<u32> {
        let calm = last_outside.map_or(0, |step| step + 1);
        (calm < end && !self.outcome.diverged).then_some(calm)
    }
}

/// Every quantity of an agent as it acts; before those of a fault, whether it occurs, its name, and, if it strikes one
/// channel, which.
fn write_draw(row: &mut Row<'_>, group: &AgentGroup, quantities: &[Quantity], draw: &AgentDraw) {
    let mut fault = None;
    for quantity in quantities {
        if let Source::Fault(index) = quantity.source
            && fault != Some(index)
        {
            fault = Some(index);
            let number = group.first_fault + index;
            let drawn = &draw.faults[index];
            row.flag(|| format!("fault{number}_occurs"), drawn.occurs());
            let name = drawn.occurs().then(|| group.faults[index].name.clone());
            row.name(|| format!("fault{number}_name"), name.unwrap_or_default());
            if group.faults[index].strikes_one() {
                let struck = drawn.only_channel();
                let struck = struck.map(|channel| group.channels()[channel].clone());
                row.name(
                    || format!("fault{number}_channel"),
                    struck.unwrap_or_default(),
                );
            }
        }
        let key = &quantity.key;
        let cells = quantity.cells(draw);
        if quantity.is_of_channels() {
            for (value, channel) in cells.zip(group.channels()) {
                row.real(|| format!("{key}_{channel}"), value);
            }
        } else {
            cells.for_each(|value| {
                row.real(|| key.clone(), value);
            });
        }
    }
}
