//! An episode with all that was simulated in it: what every figure looks things up in.

use crate::campaign::{AgentGroup, Campaign};
use crate::draw::quantities::{Quantity, quantities};
use crate::draw::{AgentDraw, AppliedEpisode, FaultDraw, draw};
use crate::model::ChannelSample;
use crate::model::episode::{AgentOutcome, Snapshot};
use crate::report::page::plot::{Color, thinned};
use crate::results::scores::{Status, status};
use crate::run::replay::Replay;
use std::cmp::Ordering;
use std::ops::Range;

/// Points of a curve: one per pixel of a panel.
const POINTS: usize = 400;

/// The episode under one controller.
#[derive(Debug, Clone, Copy)]
pub(super) struct ControllerTrace<'a> {
    /// Which of the campaign's controllers.
    pub(super) controller: usize,
    pub(super) name: &'a str,
    pub(super) outcomes: &'a [AgentOutcome],
    pub(super) snapshots: &'a [Snapshot],
}

impl ControllerTrace<'_> {
    /// The colour of its controller, as in the report.
    pub(super) fn color(&self) -> Color {
        Color::Series(self.controller)
    }
}

/// An episode.
pub(super) struct EpisodeView<'a> {
    pub(super) replay: &'a Replay,
    pub(super) campaign: &'a Campaign,
    /// What each group of agents drew, with times as they happen.
    draws: Vec<AppliedEpisode>,
    /// What is drawn for each group of agents.
    quantities: Vec<Vec<Quantity>>,
    /// The episode under each controller, that of the one that was asked for first.
    pub(super) traces: Vec<ControllerTrace<'a>>,
    pub(super) duration_s: f64,
}

impl<'a> EpisodeView<'a> {
    pub(super) fn new(replay: &'a Replay) -> Self {
        let campaign = &replay.campaign;
        let trace = |controller: usize, outcomes, snapshots| ControllerTrace {
            controller,
            name: &campaign.controllers[controller],
            outcomes,
            snapshots,
        };
        let groups = || campaign.groups().iter();
        let asked = trace(replay.controller, &*replay.outcomes, &*replay.snapshots);
        let others = replay
            .others
            .iter()
            .map(|other| trace(other.controller, &other.outcomes, &other.snapshots));
        Self {
            replay,
            campaign,
            draws: groups()
                .map(|group| draw(group, replay.episode).applied(group))
                .collect(),
            quantities: groups().map(quantities).collect(),
            traces: std::iter::once(asked).chain(others).collect(),
            duration_s: f64::from(campaign.time.steps) * campaign.time.step_s,
        }
    }

    /// The group of an agent.
    pub(super) fn group(&self, agent: usize) -> &'a AgentGroup {
        self.campaign.member(agent).0
    }

    /// The agents of a group.
    pub(super) fn agents_of(group: &AgentGroup) -> Range<usize> {
        group.first_agent..group.first_agent + group.team
    }

    /// What an agent drew.
    pub(super) fn draw(&self, agent: usize) -> &AgentDraw {
        let (_, own) = self.campaign.member(agent);
        &self.draws[self.campaign.group_index(agent)].agents[own]
    }

    /// What is drawn for an agent.
    pub(super) fn quantities(&self, agent: usize) -> &[Quantity] {
        &self.quantities[self.campaign.group_index(agent)]
    }

    /// The episode under the controller that was asked for.
    pub(super) fn asked(&self) -> &ControllerTrace<'a> {
        &self.traces[0]
    }

    /// The episode under the others.
    pub(super) fn others(&self) -> impl Iterator<Item = &ControllerTrace<'a>> {
        self.traces[1..].iter()
    }

    /// The colour of an estimate: that of none of the controllers.
    pub(super) fn estimate_color(&self) -> Color {
        Color::Series(self.campaign.controllers.len().max(3))
    }

    /// Whether inequality (24) bounds the errors of a channel under the controller that was asked for.
    pub(super) fn is_bounded(&self) -> bool {
        self.replay.attenuations.iter().flatten().any(Result::is_ok)
    }

    /// The time of a snapshot, s.
    pub(super) fn time_s(&self, snapshot: &Snapshot) -> f64 {
        f64::from(snapshot.step) * self.campaign.time.step_s
    }

    /// When an agent broke max_error or left the numbers, s.
    pub(super) fn failed_at_s(&self, trace: &ControllerTrace<'_>, agent: usize) -> Option<f64> {
        let outcome = &trace.outcomes[agent];
        let step = outcome.failed_step?;
        Some(f64::from(step) * self.campaign.time.step_s)
    }

    /// Until when what an agent did belongs into a frame, s: one that diverges leaves every frame after it failed.
    pub(super) fn until_s(&self, trace: &ControllerTrace<'_>, agent: usize) -> f64 {
        match trace.outcomes[agent].diverged {
            true => self.failed_at_s(trace, agent).unwrap_or(f64::INFINITY),
            false => f64::INFINITY,
        }
    }

    /// When an agent left the numbers, s; after that its reference stands still, too.
    pub(super) fn left_s(&self, trace: &ControllerTrace<'_>, agent: usize) -> f64 {
        let gone = |snapshot: &&Snapshot| {
            let channels = snapshot.agents.get(agent).into_iter().flatten();
            channels.into_iter().any(|shown| !shown.x.is_finite())
        };
        let first = trace.snapshots.iter().find(gone);
        match trace.outcomes[agent].diverged {
            true => first.map_or(f64::INFINITY, |snapshot| self.time_s(snapshot)),
            false => f64::INFINITY,
        }
    }

    /// What a channel showed over time.
    pub(super) fn curve(
        &self,
        trace: &ControllerTrace<'_>,
        (agent, channel): (usize, usize),
        pick: fn(&ChannelSample) -> f64,
    ) -> Vec<(f64, f64)> {
        let point = |snapshot: &Snapshot| {
            let shown = snapshot.agents.get(agent)?.get(channel)?;
            Some((self.time_s(snapshot), pick(shown)))
        };
        trace.snapshots.iter().filter_map(point).collect()
    }

    /// A curve as it is drawn: in few points, between which straight lines are right to `within`.
    pub(super) fn thin(curve: &[(f64, f64)], within: f64) -> Vec<(f64, f64)> {
        let gap = (f64::NAN, f64::NAN);
        let finite = |&(_, value): &(f64, f64)| !value.is_finite();
        let pieces = curve.split(finite).filter(|piece| !piece.is_empty());
        let mut kept = Vec::new();
        for piece in pieces {
            kept.extend(straightened(&thinned(piece, POINTS), within));
            kept.push(gap);
        }
        kept
    }

    /// Points of an agent's curve that are shown, of which `is_outside` says whether they lie far outside the frame: of
    /// an episode that diverges, those until it is there after it failed.
    pub(super) fn shown(
        &self,
        trace: &ControllerTrace<'_>,
        agent: usize,
        is_outside: impl Fn(usize) -> bool,
    ) -> usize {
        let all = trace.snapshots.len();
        let failed_s = self.failed_at_s(trace, agent).unwrap_or(f64::INFINITY);
        if !trace.outcomes[agent].diverged {
            return all;
        }
        let gone = |&k: &usize| self.time_s(&trace.snapshots[k]) >= failed_s && is_outside(k);
        // With the first point outside, so that the line leaves.
        (0..all).find(gone).map_or(all, |k| k + 1)
    }

    /// When faults struck a channel, s: from the step at which one comes to that at which it goes.
    pub(super) fn windows(&self, agent: usize, channel: usize) -> Vec<(f64, f64)> {
        let faults = self.draw(agent).faults.iter();
        let striking = faults.filter(|fault| fault.strikes.get(channel) == Some(&true));
        striking.map(|fault| self.window(fault)).collect()
    }

    /// When a fault was there, s.
    pub(super) fn window(&self, fault: &FaultDraw) -> (f64, f64) {
        let time = self.campaign.time;
        let end_step = fault.end_step(time).min(time.steps);
        let at = |step: u32| f64::from(step) * time.step_s;
        (at(time.onset_step(fault.onset_s)), at(end_step))
    }

    /// The agents, from the one that fared worst under the controller that was asked for.
    pub(super) fn worst_first(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.campaign.agents()).collect();
        order.sort_by(|&a, &b| self.fared(b, a));
        order
    }

    pub(super) fn worst_agent(&self) -> usize {
        self.worst_first().first().copied().unwrap_or(0)
    }

    /// Compares how badly two agents fared: by their verdicts, then who failed first, then the errors.
    fn fared(&self, a: usize, b: usize) -> Ordering {
        let outcomes = self.asked().outcomes;
        let verdict = |agent: usize| -> Status { status(self.group(agent), &outcomes[agent]) };
        let lasted = |agent: usize| outcomes[agent].failed_step.unwrap_or(u32::MAX);
        verdict(a)
            .cmp(&verdict(b))
            .then(lasted(b).cmp(&lasted(a)))
            .then(self.error_of(a).1.total_cmp(&self.error_of(b).1))
    }

    /// The channel of an agent with the largest error, and that error.
    pub(super) fn error_of(&self, agent: usize) -> (usize, f64) {
        let outcome = &self.asked().outcomes[agent];
        let errors = outcome
            .channels
            .iter()
            .zip(&self.group(agent).verdict.settled_error);
        // In units of what counts as settled: metres and radians are not compared.
        let errors = errors.map(|(metrics, settled)| match metrics.rmse / settled {
            error if error.is_nan() => f64::INFINITY,
            error => error,
        });
        let worst =
            |worst: (usize, f64), own: (usize, f64)| if own.1 > worst.1 { own } else { worst };
        errors.enumerate().fold((0, f64::NEG_INFINITY), worst)
    }
}

/// Some of the points of a line over time, between which straight lines pass by the others at no more than `within`
/// (the swinging door).
fn straightened(points: &[(f64, f64)], within: f64) -> Vec<(f64, f64)> {
    let Some((&first, rest)) = points.split_first() else {
        return Vec::new();
    };
    let mut kept = vec![first];
    let (mut anchor, mut last) = (first, first);
    let mut door = (f64::NEG_INFINITY, f64::INFINITY);
    for &point in rest {
        let slope = |from: (f64, f64), above: f64| (point.1 + above - from.1) / (point.0 - from.0);
        let straight = slope(anchor, 0.0);
        if straight < door.0 || straight > door.1 {
            kept.push(last);
            anchor = last;
            door = (f64::NEG_INFINITY, f64::INFINITY);
        }
        door.0 = door.0.max(slope(anchor, -within));
        door.1 = door.1.min(slope(anchor, within));
        last = point;
    }
    if !rest.is_empty() {
        kept.push(last);
    }
    kept
}
