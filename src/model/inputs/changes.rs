//! When what acts on an agent begins and ends.

use super::block::small;
use crate::campaign::AgentGroup;
use crate::campaign::kinds::{GUST_DURATION, GUST_ONSET};
use crate::draw::AgentDraw;

/// The steps at which what an agent meets begins or ends.
#[must_use]
pub(crate) fn changes(group: &AgentGroup, draw: &AgentDraw) -> Vec<u32> {
    let time = group.time;
    let faults = draw.faults.iter().filter(|fault| fault.occurs());
    let ends = faults
        .filter(|fault| fault.duration_s.is_finite())
        .map(|fault| fault.end_step(time));
    // What begins and ends by parameters of its own.
    let spans = group.disturbances.iter().zip(&draw.disturbances);
    let spans = spans.filter_map(|(disturbance, values)| {
        let parameters = disturbance.kind.parameters();
        let onset_s = &values[GUST_ONSET.place_in(parameters)?];
        let duration_s = &values[GUST_DURATION.place_in(parameters)?];
        Some(onset_s.iter().zip(duration_s))
    });
    let gusts = spans.flatten().flat_map(|(&onset_s, &duration_s)| {
        let onset = time.onset_step(onset_s);
        [
            onset,
            onset.saturating_add(small(time.whole_steps(duration_s))),
        ]
    });
    let begins = later_onsets(group, draw);
    begins.into_iter().chain(ends).chain(gusts).collect()
}

/// The steps at which an agent's faults begin, apart from those that begin with the run.
#[must_use]
pub(crate) fn later_onsets(group: &AgentGroup, draw: &AgentDraw) -> Vec<u32> {
    draw.faults
        .iter()
        .filter(|fault| fault.occurs())
        .map(|fault| group.time.onset_step(fault.onset_s))
        .filter(|&step| step > 0)
        .collect()
}
