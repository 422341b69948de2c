//! When what acts on an agent begins and ends.

use super::block::small;
use crate::campaign::{Campaign, DisturbanceKind};
use crate::draw::AgentDraw;

/// The steps at which what an agent meets begins or ends.
#[must_use]
pub(crate) fn changes(campaign: &Campaign, draw: &AgentDraw) -> Vec<u32> {
    let time = campaign.time;
    let faults = draw.faults.iter().filter(|fault| fault.occurs());
    let ends = faults
        .filter(|fault| fault.duration_s.is_finite())
        .map(|fault| fault.end_step(time));
    let gusts = campaign.disturbances.iter().zip(&draw.disturbances);
    let gusts = gusts.filter(|(gust, _)| gust.kind == DisturbanceKind::Gust1Cosine);
    let gusts = gusts.flat_map(|(_, values)| {
        let spans = values[2].iter().zip(&values[3]);
        spans.flat_map(move |(&onset_s, &duration_s)| {
            let onset = time.onset_step(onset_s);
            [
                onset,
                onset.saturating_add(small(time.whole_steps(duration_s))),
            ]
        })
    });
    let begins = later_onsets(campaign, draw);
    begins.into_iter().chain(ends).chain(gusts).collect()
}

/// The steps at which an agent's faults begin, apart from those that begin with the run.
#[must_use]
pub(crate) fn later_onsets(campaign: &Campaign, draw: &AgentDraw) -> Vec<u32> {
    draw.faults
        .iter()
        .filter(|fault| fault.occurs())
        .map(|fault| campaign.time.onset_step(fault.onset_s))
        .filter(|&step| step > 0)
        .collect()
}
