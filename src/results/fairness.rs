//! On what terms controllers are compared: the bandwidth and the margins of their loops, and what their commands cost.
//!
//! A smaller error that was bought with another bandwidth, smaller margins or more effort is not the merit of a
//! structure.

use super::numbers::{of_episodes, sorted};
use super::scores::Scores;
use crate::campaign::{Campaign, EpisodeNumber};
use crate::controllers::GainSet;
use crate::statistics::quantile;
use crate::synthesis::{Margins, settling_s};
use crate::util::format::digits;
use serde::Serialize;
use std::sync::Arc;

/// Two numbers are unlike if one is larger by more than this factor.
const UNLIKE: f64 = 1.25;
/// Shares of time at a limit are unlike if they differ by more than this.
const UNLIKE_SHARE: f64 = 0.05;

/// The terms of a controller on a channel group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Terms {
    /// The controller.
    pub controller: String,
    /// The channel group.
    pub group: Arc<str>,
    /// Bandwidth and margins of its loop; none of gains whose findings are not at hand.
    #[serde(flatten)]
    pub margins: Option<Margins>,
    /// 95th percentile over the episodes of the largest |u| of any agent and channel, N or N m.
    pub peak_command_p95: Option<f64>,
    /// Median over the episodes of the effort, the integral of u^2, in the mean over agents and channels.
    pub effort_p50: Option<f64>,
    /// Share of the steps at a limit, in the mean over the episodes, of the channel where it is largest.
    pub saturated_share: Option<f64>,
    /// How long the error of one channel takes to stay within 5 % of where it starts, s, without faults; none if it is
    /// more than two minutes.
    pub nominal_settling_s: Option<f64>,
    /// Median over the episodes of when the last agent and channel is settled, s; none where half of them do not.
    pub settling_p50_s: Option<f64>,
    /// Changes of sign per second of the command that has most of them, in the median flight.
    pub reversals_per_s: Option<f64>,
    /// Rate of the commands in the median flight, in the root mean square, N/s or N m/s.
    pub command_rate_per_s: Option<f64>,
}

/// The terms of every controller, in the order of the campaign.
#[must_use]
pub fn terms(campaign: &Campaign, gains: &[GainSet], scores: &Scores) -> Vec<Terms> {
    let groups = campaign.channel_groups();
    let of_controller = |(index, name): (usize, &String)| {
        let of_group = groups.iter().map(|of| {
            let values = |number| of_episodes(campaign, scores, index, number, of);
            let finite = |value: &f64| value.is_finite();
            let of_share = |number, share| {
                let values = values(number);
                quantile(&sorted(&values, 0..values.len()), share).filter(finite)
            };
            let shares = values(EpisodeNumber::SaturatedShare)
                .into_iter()
                .filter(finite);
            let shares: Vec<f64> = shares.collect();
            let mean = shares.iter().sum::<f64>() / shares.len() as f64;
            let own = &gains[of.group].controllers[index].groups[of.place];
            Terms {
                controller: name.clone(),
                group: of.name.clone(),
                margins: own.findings.as_ref().map(|found| found.analysis.margins),
                peak_command_p95: of_share(EpisodeNumber::PeakCommand, 0.95),
                effort_p50: of_share(EpisodeNumber::Effort, 0.5),
                saturated_share: Some(mean).filter(finite),
                nominal_settling_s: settling_s(&own.gains),
                settling_p50_s: of_share(EpisodeNumber::Settling, 0.5),
                reversals_per_s: None,
                command_rate_per_s: None,
            }
        });
        of_group.collect::<Vec<_>>()
    };
    let controllers = campaign.controllers.iter().enumerate();
    controllers.flat_map(of_controller).collect()
}

/// In what the campaign's first controller and each of the others are unlike, a sentence for each of them that is.
#[must_use]
pub fn unlike(terms: &[Terms]) -> Vec<String> {
    let Some(first) = terms.first() else {
        return Vec::new();
    };
    let of_first = terms
        .iter()
        .filter(|own| own.controller == first.controller);
    let of_first: Vec<&Terms> = of_first.collect();
    let others = terms.chunk_by(|a, b| a.controller == b.controller).skip(1);
    let of_pair = |other: &[Terms]| {
        // Channel groups that are unlike in the same are named together.
        let mut all: Vec<(String, Vec<&str>)> = Vec::new();
        for (own, other) in of_first.iter().zip(other) {
            let found = differences(own, other).join(", ");
            match all.iter_mut().find(|(known, _)| *known == found) {
                _ if found.is_empty() => {}
                Some((_, groups)) => groups.push(&own.group),
                None => all.push((found, vec![&own.group])),
            }
        }
        let in_groups =
            |(found, groups): &(String, Vec<&str>)| format!("{found} in {}", groups.join(" and "));
        let found: Vec<String> = all.iter().map(in_groups).collect();
        (!found.is_empty()).then(|| {
            let (a, b) = (&first.controller, &other[0].controller);
            format!(
                "{a} and {b} are compared on unlike terms: {}",
                found.join("; ")
            )
        })
    };
    others.filter_map(of_pair).collect()
}

fn differences(own: &Terms, other: &Terms) -> Vec<String> {
    let mut found = Vec::new();
    let mut compare = |name: &str, unit: &str, own: Option<f64>, other: Option<f64>| {
        if let (Some(own), Some(other)) = (own, other)
            && own.max(other) > UNLIKE * own.min(other)
        {
            let [own, other] = [own, other].map(|value| digits(value, 3));
            found.push(format!("{name} {own} against {other} {unit}"));
        }
    };
    let margin = |terms: &Terms, pick: fn(&Margins) -> f64| terms.margins.as_ref().map(pick);
    let mut of_margins = |name: &str, unit: &str, pick: fn(&Margins) -> f64| {
        compare(name, unit, margin(own, pick), margin(other, pick));
    };
    of_margins("crossover", "rad/s", |own| own.crossover_rad_s);
    of_margins("delay margin", "ms", |own| own.delay_margin_ms);
    of_margins("peak of the sensitivity", "", |own| own.sensitivity_peak);
    of_margins("peak gain from noise", "", |own| own.noise_peak);
    compare(
        "largest command (95th percentile)",
        "N or N m",
        own.peak_command_p95,
        other.peak_command_p95,
    );
    compare(
        "effort (median)",
        "N^2 s or N^2 m^2 s",
        own.effort_p50,
        other.effort_p50,
    );
    compare(
        "settled after (median)",
        "s",
        own.settling_p50_s,
        other.settling_p50_s,
    );
    if let (Some(own), Some(other)) = (own.saturated_share, other.saturated_share)
        && (own - other).abs() > UNLIKE_SHARE
    {
        found.push(format!(
            "{:.0} against {:.0} % of the time at a limit",
            100.0 * own,
            100.0 * other
        ));
    }
    found
        .into_iter()
        .map(|own| own.trim_end().to_string())
        .collect()
}
