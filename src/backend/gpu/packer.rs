//! The host's part of a batch: episodes drawn and packed for the shaders, and outcomes taken out of what comes back. It
//! needs no device, so that it is done for one batch while another one flies.

use super::GpuError;
use super::layout;
use super::pipeline::Pipeline;
use super::shape::Shape;
use crate::backend::EpisodeResult;
use crate::campaign::AgentGroup;
use crate::draw::{Episode, draw};
use crate::model::episode::{AgentOutcome, Model};
use rayon::prelude::*;

/// Packs and unpacks the batches of a group of agents.
#[derive(Debug)]
pub struct Packer {
    adapter: String,
    group: AgentGroup,
    controllers: usize,
    /// Of each part of the model, a shape of its draws, and its first channel.
    parts: Vec<(Shape, usize)>,
    /// Of each pipeline, its shape, its first channel and its controller.
    pipelines: Vec<(Shape, usize, usize)>,
}

/// Episodes that are ready for a device.
#[derive(Debug)]
pub struct PackedBatch {
    pub(super) episodes: Vec<Episode>,
    /// The draws of each part of the model.
    pub(super) draws: Vec<Vec<u32>>,
}

/// Episodes as they come back from a device.
#[derive(Debug)]
pub struct LandedBatch {
    pub(super) episodes: Vec<Episode>,
    /// The outcomes of each pipeline.
    pub(super) words: Vec<Vec<u32>>,
}

impl Packer {
    pub(super) fn new(
        adapter: &str,
        model: &Model<f32>,
        controllers: usize,
        pipelines: &[Pipeline],
    ) -> Self {
        let first = |part: usize| model.parts[part].channels.start;
        // The shapes of a part under its controllers have the same draws.
        let shape = |part| pipelines.iter().find(|own: &&Pipeline| own.part == part);
        let parts = (0..model.parts.len())
            .filter_map(|part| Some((shape(part)?.shape.clone(), first(part))));
        let of_pipeline = |own: &Pipeline| (own.shape.clone(), first(own.part), own.controller);
        Self {
            adapter: adapter.to_string(),
            group: model.group.clone(),
            controllers,
            parts: parts.collect(),
            pipelines: pipelines.iter().map(of_pipeline).collect(),
        }
    }

    /// Draws episodes and packs them, on the threads of the pool that it is called in.
    #[must_use]
    pub fn pack(&self, episodes: Vec<u32>) -> PackedBatch {
        let episodes = episodes.into_par_iter();
        let episodes: Vec<Episode> = episodes.map(|own| draw(&self.group, own)).collect();
        let parts = self.parts.iter();
        let draws =
            parts.map(|(shape, first)| layout::draws(&self.group, shape, *first, &episodes));
        PackedBatch {
            draws: draws.collect(),
            episodes,
        }
    }

    /// How the episodes of a batch ended.
    ///
    /// # Errors
    /// If what came back is not of these episodes.
    pub fn unpack(&self, landed: LandedBatch) -> Result<Vec<EpisodeResult>, GpuError> {
        let blank = vec![
            vec![AgentOutcome::blank(self.group.channels().len()); self.group.team];
            self.controllers
        ];
        let ended = |episode| EpisodeResult {
            episode,
            outcomes: blank.clone(),
        };
        let mut simulated: Vec<EpisodeResult> =
            landed.episodes.into_par_iter().map(ended).collect();
        for ((shape, first, controller), words) in self.pipelines.iter().zip(&landed.words) {
            let of_controller = simulated.iter_mut().map(|simulated| {
                let outcomes = &mut simulated.outcomes[*controller];
                (simulated.episode.index, outcomes)
            });
            let taken = layout::take_outcomes(&self.group, shape, *first, words, of_controller);
            taken.map_err(|reason| GpuError::Driver {
                adapter: self.adapter.clone(),
                reason,
            })?;
        }
        Ok(simulated)
    }
}
