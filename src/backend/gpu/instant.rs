//! An instant of a trace, as it comes back from the device.

use super::layout::{self, SHOWN_WORDS};
use super::pipeline::Pipeline;
use crate::model::ChannelSample;

/// What the channels of some episodes show at one instant.
pub struct TraceInstant<'a> {
    /// Step number.
    pub step: u32,
    pub(super) pipelines: &'a [Pipeline],
    /// Of each group, the words of this instant.
    pub(super) words: Vec<&'a [u32]>,
}

impl TraceInstant<'_> {
    /// What every agent and channel of an episode shows, `[agent][channel]`; episodes are counted within the trace.
    #[must_use]
    pub fn agents(&self, episode: usize, controller: usize) -> Vec<Vec<ChannelSample>> {
        let pipelines = || {
            let pipelines = self.pipelines.iter().zip(&self.words);
            pipelines.filter(|(pipeline, _)| pipeline.controller == controller)
        };
        let team = pipelines()
            .next()
            .map_or(0, |(pipeline, _)| pipeline.shape.team);
        (0..team)
            .map(|agent| {
                let channels = pipelines().flat_map(|(Pipeline { shape, .. }, words)| {
                    let (block, lane) = (episode / shape.lanes, episode % shape.lanes);
                    let words = &words[block * SHOWN_WORDS * shape.workgroup()..];
                    (0..shape.channels).map(move |channel| {
                        layout::shown(words, shape, shape.place(channel, agent, lane))
                    })
                });
                channels.collect()
            })
            .collect()
    }
}
