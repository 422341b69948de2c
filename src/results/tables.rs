//! The tables of a run: a row per episode, controller and agent, and one per channel, filled as batches end.

use super::scores::{Scores, Status, status};
use super::table::{Row, Table};
use crate::agent::ChannelGroup;
use crate::backend::EpisodeResult;
use crate::campaign::{Campaign, Time};
use crate::draw::AgentDraw;
use crate::draw::quantities::{Condition, Quantity, Source, conditions, quantities};
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
    /// What the statistics read.
    pub scores: Scores,
    /// Names of the controllers, shared by all rows.
    names: Vec<Arc<str>>,
    /// What is drawn, and what the ranking reads of it.
    quantities: Vec<Quantity>,
    conditions: Vec<Condition>,
}

impl Tables {
    /// Empty tables of a campaign.
    #[must_use]
    pub fn new(campaign: &Campaign) -> Self {
        let controllers = campaign.controllers.len();
        let conditions = conditions(campaign);
        Self {
            episodes: Table::default(),
            channels: Table::default(),
            names: campaign
                .controllers
                .iter()
                .map(|name| Arc::from(name.as_str()))
                .collect(),
            scores: Scores {
                status: vec![Vec::new(); controllers],
                rmse: vec![Vec::new(); controllers],
                max_abs: vec![Vec::new(); controllers],
                failed_step: vec![Vec::new(); controllers],
                fault_occurs: vec![Vec::new(); campaign.faults.len()],
                conditions: conditions
                    .iter()
                    .map(|condition| (condition.key.clone(), Vec::new()))
                    .collect(),
            },
            quantities: quantities(campaign),
            conditions,
        }
    }

    /// Adds an episode; episodes are added in order.
    pub fn add(&mut self, campaign: &Campaign, simulated: &EpisodeResult) {
        // All rows show the times as they happen.
        let applied = simulated.episode.applied(campaign);
        let draws = &applied.agents;
        for (fault, occurs) in self.scores.fault_occurs.iter_mut().enumerate() {
            occurs.push(draws.iter().any(|draw| draw.faults[fault].occurs()));
        }
        for ((_, values), condition) in self.scores.conditions.iter_mut().zip(&self.conditions) {
            values.push(condition.of(&applied));
        }
        for (controller, (name, outcomes)) in self.names.iter().zip(&simulated.outcomes).enumerate()
        {
            let agents: Vec<AgentVerdict<'_>> = outcomes
                .iter()
                .zip(draws)
                .map(|(outcome, draw)| AgentVerdict::new(campaign, outcome, draw))
                .collect();
            let worst = agents
                .iter()
                .map(|agent| agent.status)
                .max()
                .unwrap_or(Status::Ok);
            self.scores.status[controller].push(worst);
            self.scores.failed_step[controller]
                .extend(outcomes.iter().map(|outcome| outcome.failed_step));
            for ((agent, judged), draw) in (0u64..).zip(&agents).zip(draws) {
                let key = |row: &mut Row<'_>| {
                    row.count(|| "episode".into(), u64::from(simulated.episode.index))
                        .name(|| "controller".into(), name.clone())
                        .count(|| "agent".into(), agent);
                };
                let mut row = self.episodes.row();
                key(&mut row);
                if let Some(stratum) = campaign.strata.of(simulated.episode.index) {
                    row.name(|| "stratum".into(), stratum.name.clone());
                }
                if let Some((replicate, _)) = campaign.sampling.place(simulated.episode.index) {
                    row.count(|| "replicate".into(), u64::from(replicate));
                }
                judged.write_agent(&mut row, campaign, worst);
                write_draw(&mut row, campaign, &self.quantities, draw);
                let channels = campaign.channels().iter();
                for (channel, outcome) in channels.zip(&judged.outcome.channels) {
                    let mut row = self.channels.row();
                    key(&mut row);
                    row.name(|| "channel".into(), channel.clone());
                    judged.write_channel(&mut row, campaign.time, outcome);
                    self.scores.rmse[controller].push(outcome.rmse);
                    self.scores.max_abs[controller].push(outcome.max_abs);
                }
            }
        }
    }
}

/// An agent's outcome and what the verdict makes of it.
struct AgentVerdict<'a> {
    outcome: &'a AgentOutcome,
    status: Status,
    /// The step of the agent's first fault that does not begin with the run.
    first_fault: Option<u32>,
}

impl<'a> AgentVerdict<'a> {
    fn new(campaign: &Campaign, outcome: &'a AgentOutcome, draw: &AgentDraw) -> Self {
        Self {
            outcome,
            status: status(campaign, outcome),
            first_fault: later_onsets(campaign, draw).into_iter().min(),
        }
    }

    fn write_agent(&self, row: &mut Row<'_>, campaign: &Campaign, worst: Status) {
        let failed_at_s = match (self.status, self.outcome.failed_step) {
            (Status::Ok, _) => None,
            (_, Some(step)) => Some(f64::from(step) * campaign.time.step_s),
            // A limit on the RMS error is judged, and an overflow of a sum is seen, at the end.
            (_, None) => Some(f64::from(campaign.time.steps) * campaign.time.step_s),
        };
        row.word(|| "status".into(), self.status.word())
            .word(|| "episode_status".into(), worst.word())
            .real_if("failed_at_s", failed_at_s);
        for ChannelGroup { role, channels } in campaign.channel_groups() {
            let group = role.name();
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
            row.real(|| format!("rmse_{group}"), self.finite(mean_square.sqrt()))
                .real(|| format!("max_abs_{group}"), self.finite(largest));
        }
        let all = &self.outcome.channels;
        let slowest = |time: fn(&Self, Time, &ChannelOutcome) -> Option<f64>| {
            all.iter()
                .map(|metrics| time(self, campaign.time, metrics))
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

    fn calm_from(&self, last_outside: Option<u32>, end: u32) -> Option<u32> {
        let calm = last_outside.map_or(0, |step| step + 1);
        (calm < end && !self.outcome.diverged).then_some(calm)
    }
}

/// Every quantity of an agent as it acts; before those of a fault, whether it occurs and, if it strikes one channel,
/// which.
fn write_draw(row: &mut Row<'_>, campaign: &Campaign, quantities: &[Quantity], draw: &AgentDraw) {
    let mut fault = None;
    for quantity in quantities {
        if let Source::Fault(index) = quantity.source
            && fault != Some(index)
        {
            fault = Some(index);
            let drawn = &draw.faults[index];
            row.flag(|| format!("fault{index}_occurs"), drawn.occurs());
            if campaign.faults[index].strikes_one() {
                let struck = drawn.only_channel();
                let struck = struck.map(|channel| campaign.channels()[channel].clone());
                row.name(
                    || format!("fault{index}_channel"),
                    struck.unwrap_or_default(),
                );
            }
        }
        let key = &quantity.key;
        let cells = quantity.cells(draw);
        if quantity.is_of_channels() {
            for (value, channel) in cells.zip(campaign.channels()) {
                row.real(|| format!("{key}_{channel}"), value);
            }
        } else {
            cells.for_each(|value| {
                row.real(|| key.clone(), value);
            });
        }
    }
}
