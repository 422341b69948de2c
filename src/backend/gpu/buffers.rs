//! What a batch of episodes needs on the device, within the limits of buffers and memory.

use super::GpuError;
use super::device::{self, Gpu, Use};
use super::layout::{OUTCOME_WORDS, SHOWN_WORDS, Span, word};
use super::pipeline::{MAX_BATCH, Pipeline};
use super::tuning::Tuning;
use crate::model::episode::Model;
use std::ops::Range;

/// Device memory that the buffers of a batch take at most, bytes.
pub(super) const MEMORY: u64 = 1 << 30;
/// Bytes of a reference table that are on the device at once.
pub(super) const TABLE: usize = 32 << 20;

/// What a batch needs on the device.
pub(super) struct Buffers {
    pub(super) batch: usize,
    pub(super) spans: wgpu::Buffer,
    /// Of each of the model's groups; all controllers read the same.
    pub(super) shared: Vec<SharedBuffers>,
    /// Of each group under each controller.
    pub(super) own: Vec<OwnBuffers>,
    /// The steps whose references are on the device.
    pub(super) window: Range<u32>,
    /// Steps that a window has at most.
    pub(super) window_steps: u32,
}

pub(super) struct SharedBuffers {
    pub(super) draws: wgpu::Buffer,
    pub(super) table: wgpu::Buffer,
}

pub(super) struct OwnBuffers {
    pub(super) output: wgpu::Buffer,
    pub(super) read_back: wgpu::Buffer,
    pub(super) bindings: wgpu::BindGroup,
}

impl Buffers {
    /// Buffers for as many of `batch` episodes as the device has memory for.
    pub(super) fn largest(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        pipelines: &[Pipeline],
        model: &Model<f32>,
        mut batch: usize,
    ) -> Result<Self, GpuError> {
        let least = pipelines.iter().map(|pipeline| pipeline.shape.lanes).max();
        loop {
            match Self::new(gpu, layout, pipelines, model, batch, 0) {
                Err(GpuError::OutOfMemory { .. }) if Some(batch) > least => batch /= 2,
                result => return result,
            }
        }
    }

    pub(super) fn new(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        pipelines: &[Pipeline],
        model: &Model<f32>,
        batch: usize,
        samples: usize,
    ) -> Result<Self, GpuError> {
        let window_steps = pipelines
            .iter()
            .map(|pipeline| window_steps(pipeline, gpu, model.group.time.steps))
            .min()
            .unwrap_or(1);
        let sizes = |pipeline: &Pipeline| Sizes::new(pipeline, batch, samples, window_steps);
        let words: usize = pipelines
            .iter()
            .map(|pipeline| sizes(pipeline).total())
            .sum();
        gpu.checked(
            || {
                let spans = gpu.buffer(span_stride(gpu) / 4 * pipelines.len(), Use::Uniform);
                // Every controller's groups have the same draws and references.
                let shared: Vec<SharedBuffers> = (0..model.parts.len())
                    .filter_map(|part| pipelines.iter().find(|pipeline| pipeline.part == part))
                    .map(|pipeline| SharedBuffers {
                        draws: gpu.buffer(sizes(pipeline).draws, Use::Storage),
                        table: gpu.buffer(sizes(pipeline).table, Use::Storage),
                    })
                    .collect();
                let own = pipelines
                    .iter()
                    .map(|pipeline| {
                        let shared = &shared[pipeline.part];
                        OwnBuffers::new(gpu, layout, pipeline, shared, &spans, &sizes(pipeline))
                    })
                    .collect();
                Self {
                    batch,
                    spans,
                    shared,
                    own,
                    window: 0..0,
                    window_steps,
                }
            },
            |error| match error {
                wgpu::Error::OutOfMemory { .. } => GpuError::OutOfMemory {
                    adapter: gpu.adapter().name.clone(),
                    bytes: device::bytes(words),
                    episodes: batch,
                },
                other => gpu.driver_error(other),
            },
        )
    }
}

/// Words of a group's buffers.
pub(super) struct Sizes {
    pub(super) draws: usize,
    pub(super) state: usize,
    pub(super) table: usize,
    pub(super) output: usize,
}

impl Sizes {
    pub(super) fn new(
        pipeline: &Pipeline,
        batch: usize,
        samples: usize,
        window_steps: u32,
    ) -> Self {
        let shape = &pipeline.shape;
        let words = shape.words();
        let invocations = pipeline.invocations(batch);
        Self {
            draws: invocations * words.drawn(),
            state: invocations * words.stored(),
            table: (2 * window_steps as usize + 1) * shape.table_rows() * 4,
            output: invocations * OUTCOME_WORDS.max(samples * SHOWN_WORDS),
        }
    }

    pub(super) fn total(&self) -> usize {
        self.draws + self.state + self.table + 2 * self.output
    }
}

impl OwnBuffers {
    pub(super) fn new(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        pipeline: &Pipeline,
        shared: &SharedBuffers,
        spans: &wgpu::Buffer,
        sizes: &Sizes,
    ) -> Self {
        let state = gpu.buffer(sizes.state, Use::Storage);
        let output = gpu.buffer(sizes.output, Use::Storage);
        let span = wgpu::BufferBinding {
            buffer: spans,
            offset: 0,
            size: wgpu::BufferSize::new(size_of::<Span>() as u64),
        };
        let resources = [
            pipeline.setting.as_entire_binding(),
            wgpu::BindingResource::Buffer(span),
            shared.draws.as_entire_binding(),
            state.as_entire_binding(),
            shared.table.as_entire_binding(),
            output.as_entire_binding(),
        ];
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let bindings = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout,
            entries: &entries,
        });
        Self {
            read_back: gpu.buffer(sizes.output, Use::ReadBack),
            output,
            bindings,
        }
    }
}

/// Bytes that a storage buffer may have.
pub(super) fn storage_limit(gpu: &Gpu) -> u64 {
    let limits = gpu.limits();
    limits
        .max_storage_buffer_binding_size
        .min(limits.max_buffer_size)
        .min(u64::from(u32::MAX))
}

/// Steps whose references fit the table on the device.
pub(super) fn window_steps(pipeline: &Pipeline, gpu: &Gpu, steps: u32) -> u32 {
    let instant = 16 * pipeline.shape.table_rows();
    let bytes = TABLE.min(usize::try_from(storage_limit(gpu)).unwrap_or(TABLE));
    word((bytes / instant).saturating_sub(1) / 2).clamp(1, steps)
}

/// Bytes from one span to the next.
pub(super) fn span_stride(gpu: &Gpu) -> usize {
    gpu.limits().min_uniform_buffer_offset_alignment as usize
}

/// Episodes of a batch: what is asked for, or what fills the device, within the limits of buffers and memory.
pub(super) fn batch(gpu: &Gpu, pipelines: &[Pipeline], episodes: u32, tuning: Tuning) -> usize {
    let limit = storage_limit(gpu);
    let per_episode = |pipeline: &Pipeline| {
        let sizes = Sizes::new(pipeline, pipeline.shape.lanes, 0, 0);
        let largest = sizes.state.max(sizes.draws).max(sizes.output);
        (
            device::bytes(largest.div_ceil(pipeline.shape.lanes)),
            device::bytes(sizes.total().div_ceil(pipeline.shape.lanes)),
        )
    };
    let fits = pipelines
        .iter()
        .map(|pipeline| limit / per_episode(pipeline).0)
        .min()
        .unwrap_or(1);
    let total: u64 = pipelines
        .iter()
        .map(|pipeline| per_episode(pipeline).1)
        .sum();
    // Whole blocks, so that the limits hold for the padding too.
    let lanes = pipelines
        .iter()
        .map(|pipeline| pipeline.shape.lanes as u64)
        .max()
        .unwrap_or(1);
    let most = (fits.min(MEMORY / total) / lanes * lanes).max(1);
    let wanted = tuning.batch.unwrap_or(MAX_BATCH).min(episodes).max(1);
    usize::try_from(most.min(u64::from(wanted))).unwrap_or(usize::MAX)
}
