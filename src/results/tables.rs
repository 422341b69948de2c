//! The tables of a run: a row per episode, controller and agent, and one per channel, filled as batches end.

use crate::agent::{Agent, ChannelGroup};
use crate::backend::EpisodeResult;
use crate::campaign::{Campaign, Time};
use crate::draw::AgentDraw;
use crate::draw::quantities::{DrawnQuantity, conditions};
use crate::model::episode::AgentOutcome;
use crate::model::metric::ChannelOutcome;
use polars::prelude::{
    Column, DataFrame, Float64Chunked, IntoColumn, NamedFrom, NewChunkedArray, PlSmallStr,
    PolarsError, Series,
};
use std::sync::Arc;

/// How an agent or an episode ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// Within the limits.
    Ok,
    /// Finite, but a limit of the verdict was broken.
    Exceeded,
    /// Left the numbers; ranks worst in every comparison.
    Diverged,
}

impl Status {
    /// The word in the tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Exceeded => "exceeded",
            Self::Diverged => "diverged",
        }
    }
}

/// A table under construction: columns are made by the first row, and every row fills them in the same order.
#[derive(Debug, Clone, Default)]
pub struct Table {
    columns: Vec<(String, Values)>,
}

/// A column under construction. A real that is not a number stands for "does not apply" and becomes a null.
#[derive(Debug, Clone)]
enum Values {
    Real(Vec<f64>),
    Count(Vec<u64>),
    Word(Vec<&'static str>),
    Name(Vec<Arc<str>>),
    Flag(Vec<bool>),
}

/// A row being added to a [`Table`].
pub struct Row<'a> {
    table: &'a mut Table,
    next: usize,
}

macro_rules! cell {
    ($(#[$doc:meta])* $method:ident, $variant:ident, $value:ty) => {
        $(#[$doc])*
        pub fn $method(&mut self, name: impl FnOnce() -> String, value: $value) -> &mut Self {
            if self.next == self.table.columns.len() {
                self.table.columns.push((name(), Values::$variant(Vec::new())));
            }
            if let Some((_, Values::$variant(values))) = self.table.columns.get_mut(self.next) {
                values.push(value);
            }
            self.next += 1;
            self
        }
    };
}

impl Row<'_> {
    cell!(/// A real number; not a number where it does not apply.
        real, Real, f64);
    cell!(/// A number of things.
        count, Count, u64);
    cell!(/// A word of a fixed list.
        word, Word, &'static str);
    cell!(/// A name.
        name, Name, Arc<str>);
    cell!(/// Yes or no.
        flag, Flag, bool);

    /// A real number where it applies.
    pub fn real_if(&mut self, name: &str, value: Option<f64>) -> &mut Self {
        self.real(|| name.to_string(), value.unwrap_or(f64::NAN))
    }
}

impl Table {
    /// Begins a row.
    pub fn row(&mut self) -> Row<'_> {
        Row {
            table: self,
            next: 0,
        }
    }

    /// Whether no row was begun.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The finished table.
    ///
    /// # Errors
    /// If the rows did not all fill the same columns.
    pub fn to_frame(&self) -> Result<DataFrame, PolarsError> {
        let columns = self.columns.iter().map(|(name, values)| {
            let name = PlSmallStr::from_str(name);
            match values {
                Values::Real(values) => {
                    let present = values
                        .iter()
                        .map(|value| (!value.is_nan()).then_some(*value));
                    Float64Chunked::from_iter_options(name, present).into_column()
                }
                Values::Count(values) => Series::new(name, values).into_column(),
                Values::Word(values) => Series::new(name, values).into_column(),
                Values::Name(values) => {
                    let names: Vec<&str> = values.iter().map(AsRef::as_ref).collect();
                    Series::new(name, names).into_column()
                }
                Values::Flag(values) => Series::new(name, values).into_column(),
            }
        });
        DataFrame::new_infer_height(columns.collect::<Vec<Column>>())
    }
}

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
}

/// The numbers that the statistics of a run read. Episodes are in order; so are controllers, agents and channels.
#[derive(Debug, Clone, Default)]
pub struct Scores {
    /// Worst status of the team, `[controller][episode]`.
    pub status: Vec<Vec<Status>>,
    /// RMS error, `[controller]` then episode, agent, channel in one list.
    pub rmse: Vec<Vec<f64>>,
    /// Largest error, laid out like `rmse`.
    pub max_abs: Vec<Vec<f64>>,
    /// Step in which an agent broke max_error or left the numbers, `[controller]` then episode, agent in one list.
    pub failed_step: Vec<Vec<Option<u32>>>,
    /// Whether an agent of the episode has the fault, `[fault][episode]`.
    pub fault_occurs: Vec<Vec<bool>>,
    /// What each episode met: the name of a condition, and its size by episode ([`crate::draw::quantities`]).
    pub conditions: Vec<(String, Vec<Option<f64>>)>,
}

impl Scores {
    /// Episodes so far.
    #[must_use]
    pub fn episodes(&self) -> usize {
        self.status.first().map_or(0, Vec::len)
    }

    /// Whether these are an episode's numbers, to the last digit: its agents' errors under a controller. Numbers that are none
    /// are all alike.
    #[must_use]
    pub fn holds(
        &self,
        campaign: &Campaign,
        controller: usize,
        episode: u32,
        agents: &[AgentOutcome],
    ) -> bool {
        let stride = campaign.team * campaign.channels().len();
        let rows = episode as usize * stride..(episode as usize + 1) * stride;
        let same = |kept: &[f64], pick: fn(&ChannelOutcome) -> f64| {
            let again = agents.iter().flat_map(|agent| &agent.channels).map(pick);
            let kept = kept.get(rows.clone()).unwrap_or_default();
            kept.len() == stride
                && kept.iter().zip(again).all(|(kept, again)| {
                    kept.to_bits() == again.to_bits() || kept.is_nan() && again.is_nan()
                })
        };
        same(&self.rmse[controller], |metrics| metrics.rmse)
            && same(&self.max_abs[controller], |metrics| metrics.max_abs)
    }
}

impl Tables {
    /// Empty tables of a campaign.
    #[must_use]
    pub fn new(campaign: &Campaign) -> Self {
        let controllers = campaign.controllers.len();
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
                conditions: Vec::new(),
            },
        }
    }

    /// Adds an episode; episodes are added in order.
    pub fn add(&mut self, campaign: &Campaign, flown: &EpisodeResult) {
        // All rows show the times as they happen.
        let draws = &flown.episode.applied(campaign).agents;
        for (fault, occurs) in self.scores.fault_occurs.iter_mut().enumerate() {
            occurs.push(draws.iter().any(|draw| draw.faults[fault].occurs()));
        }
        let conditions = conditions(campaign, &flown.episode);
        if self.scores.conditions.is_empty() {
            let named = |(name, _): &DrawnQuantity| (name.clone(), Vec::new());
            self.scores.conditions = conditions.iter().map(named).collect();
        }
        for ((_, values), (_, value)) in self.scores.conditions.iter_mut().zip(conditions) {
            values.push(value);
        }
        for (controller, (name, outcomes)) in self.names.iter().zip(&flown.outcomes).enumerate() {
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
                    row.count(|| "episode".into(), u64::from(flown.episode.index))
                        .name(|| "controller".into(), name.clone())
                        .count(|| "agent".into(), agent);
                };
                let mut row = self.episodes.row();
                key(&mut row);
                if let Some(stratum) = campaign.strata.of(flown.episode.index) {
                    row.name(|| "stratum".into(), stratum.name.clone());
                }
                if let Some((replicate, _)) = campaign.sampling.place(flown.episode.index) {
                    row.count(|| "replicate".into(), u64::from(replicate));
                }
                judged.write_agent(&mut row, campaign, worst, draw);
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

/// What the verdict of a campaign makes of an agent's outcome.
#[must_use]
pub fn status(campaign: &Campaign, outcome: &AgentOutcome) -> Status {
    // max_error was judged step by step, in the precision of the loop.
    let too_large = |(channel, metrics): (usize, &ChannelOutcome)| {
        metrics.rmse > campaign.verdict.max_rmse[channel]
    };
    if outcome.diverged {
        Status::Diverged
    } else if outcome.failed_step.is_some() || outcome.channels.iter().enumerate().any(too_large) {
        Status::Exceeded
    } else {
        Status::Ok
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
            first_fault: crate::model::inputs::later_onsets(campaign, draw)
                .into_iter()
                .min(),
        }
    }

    fn write_agent(&self, row: &mut Row<'_>, campaign: &Campaign, worst: Status, draw: &AgentDraw) {
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
        write_draw(row, campaign, draw);
    }

    fn write_channel(&self, row: &mut Row<'_>, time: Time, metrics: &ChannelOutcome) {
        row.real(|| "rmse".into(), self.finite(metrics.rmse))
            .real(|| "max_abs".into(), self.finite(metrics.max_abs))
            .real(|| "ise".into(), self.finite(metrics.ise))
            .real(|| "iae".into(), self.finite(metrics.iae))
            .real_if("settling_s", self.settling_s(time, metrics))
            .real_if("recovery_s", self.recovery_s(time, metrics))
            .real(|| "effort".into(), self.finite(metrics.effort))
            .real(|| "u_max".into(), self.finite(metrics.u_max))
            .real(
                || "saturated_fraction".into(),
                self.finite(metrics.saturated_fraction),
            )
            .real(|| "f1_rms_error".into(), self.finite(metrics.f1_rms_error))
            .real(|| "f2_rms_error".into(), self.finite(metrics.f2_rms_error));
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

    /// How long after the first fault the error went below the settled error for good; absent without a fault or if it did not.
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

/// Every effective parameter of an agent.
fn write_draw(row: &mut Row<'_>, campaign: &Campaign, draw: &AgentDraw) {
    row.real(|| "mass_scale".into(), draw.mass_scale);
    if let Agent::Uav(_) = campaign.agent {
        row.real(|| "inertia_scale".into(), draw.inertia_scale);
    }
    row.real(|| "kappa".into(), draw.kappa);
    if campaign.control.delay_s.is_some() {
        row.real(|| "control_delay_s".into(), draw.control_delay_s);
    }
    let initial = [
        ("error", &draw.error),
        ("error_rate", &draw.error_rate),
        ("error_integral", &draw.error_integral),
    ];
    for (name, values) in initial {
        write_channels(row, campaign, values, |channel| {
            format!("initial_{name}_{channel}")
        });
    }
    for (index, (disturbance, values)) in campaign
        .disturbances
        .iter()
        .zip(&draw.disturbances)
        .enumerate()
    {
        for (parameter, values) in disturbance.kind.parameters().iter().zip(values) {
            let acts = |channel: usize| disturbance.kind.acts_on(channel);
            let applied = where_it(values, acts);
            write_channels(row, campaign, &applied, |channel| {
                format!("disturbance{index}_{}_{channel}", parameter.name)
            });
        }
    }
    for (index, (fault, drawn)) in campaign.faults.iter().zip(&draw.faults).enumerate() {
        row.flag(|| format!("fault{index}_occurs"), drawn.occurs());
        if fault.strikes_one() {
            let names = campaign.channels();
            let struck = drawn.only_channel().map(|channel| names[channel].clone());
            row.name(
                || format!("fault{index}_channel"),
                struck.unwrap_or_default(),
            );
        }
        let mut of_time = |name: &str, time_s: f64| {
            let time_s = drawn.occurs().then_some(time_s).unwrap_or(f64::NAN);
            row.real(|| format!("fault{index}_{name}"), time_s);
        };
        of_time("onset_s", drawn.onset_s);
        if fault.duration_s.is_some() {
            of_time("duration_s", drawn.duration_s);
        }
        if fault.ramp_s.is_some() {
            of_time("ramp_s", drawn.ramp_s);
        }
        for (parameter, values) in fault.kind.parameters().iter().zip(&drawn.parameters) {
            let applied = where_it(values, |channel| drawn.strikes[channel]);
            write_channels(row, campaign, &applied, |channel| {
                format!("fault{index}_{}_{channel}", parameter.name)
            });
        }
    }
}

/// The values of the channels on which something acts; not a number elsewhere.
fn where_it(values: &[f64], acts: impl Fn(usize) -> bool) -> Vec<f64> {
    let kept = |(channel, &value)| if acts(channel) { value } else { f64::NAN };
    values.iter().enumerate().map(kept).collect()
}

fn write_channels(
    row: &mut Row<'_>,
    campaign: &Campaign,
    values: &[f64],
    name: impl Fn(&str) -> String,
) {
    for (value, channel) in values.iter().zip(campaign.channels()) {
        row.real(|| name(channel), *value);
    }
}
