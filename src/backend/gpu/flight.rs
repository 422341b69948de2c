//! Flying batches of episodes: draws up, spans of steps, outcomes down.

use super::device::{Gpu, Use};
use super::shader::Shape;
use super::words::{self, OUTCOME_WORDS, SHOWN_WORDS, Span, word};
use super::{GpuError, device};
use crate::backend::Flown;
use crate::campaign::{Campaign, ObserverStart};
use crate::draw::{Episode, draw};
use crate::model::Shown;
use crate::model::episode::{AgentOutcome, Controller, Model, Part, PlantKind};
use crate::synthesis::LoopGains;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::time::{Duration, Instant};

/// Invocations that a workgroup should have: several warps, and several workgroups on each multiprocessor.
const WORKGROUP: usize = 256;
/// Episodes that a workgroup has at most.
const MAX_LANES: usize = 64;
/// Episodes that a batch has at most: enough to fill the largest cards several times.
const MAX_BATCH: u32 = 32_768;
/// Device memory that the buffers of a batch take at most, bytes.
const MEMORY: u64 = 1 << 30;
/// Bytes of a reference table that are on the device at once.
const TABLE: usize = 32 << 20;
/// What a dispatch should take: short beside the seconds after which a display driver resets the device, long beside the
/// cost of a submission.
const DISPATCH: Duration = Duration::from_millis(100);
/// Steps of the first dispatch, before anything is known of the device.
const FIRST_STEPS: u32 = 16;
/// Samples of a trace between two read-backs.
const SAMPLES: u32 = 64;

/// How the work is cut up. The result does not depend on it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tuning {
    /// Episodes per batch, as far as the adapter allows; else as many as fit.
    pub batch: Option<u32>,
    /// Steps per dispatch; else what takes about 0.1 s.
    pub steps: Option<u32>,
}

/// Wall-clock times of a GPU's flying, s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GpuTimes {
    /// Opening the device's pipelines: shaders to machine code.
    pub compile_s: f64,
    /// Drawing episodes and sending them.
    pub upload_s: f64,
    /// The episode loop.
    pub kernel_s: f64,
    /// Receiving outcomes.
    pub read_back_s: f64,
}

/// A campaign's controllers, ready to fly on a GPU.
pub struct GpuFlyer<'g> {
    gpu: &'g Gpu,
    model: Model<f32>,
    controllers: Vec<Controller<f32>>,
    groups: Vec<Group>,
    layout: wgpu::BindGroupLayout,
    buffers: Buffers,
    tuning: Tuning,
    /// Steps of the next dispatch.
    steps: u32,
    times: GpuTimes,
}

/// A group of channels under one controller, and its shaders.
struct Group {
    /// Which of the model's groups.
    part: usize,
    controller: usize,
    shape: Shape,
    pipelines: [wgpu::ComputePipeline; 4],
    setting: wgpu::Buffer,
}

/// The entry points, in the order of [`Group::pipelines`].
#[derive(Clone, Copy)]
enum Entry {
    Start,
    Advance,
    Show,
    Finish,
}

const ENTRIES: [&str; 4] = ["start", "advance", "show", "finish"];

/// What a batch needs on the device.
struct Buffers {
    batch: usize,
    spans: wgpu::Buffer,
    /// Of each of the model's groups; all controllers read the same.
    shared: Vec<SharedBuffers>,
    /// Of each group under each controller.
    own: Vec<OwnBuffers>,
    /// The steps whose references are on the device.
    window: Range<u32>,
    /// Steps that a window has at most.
    window_steps: u32,
}

struct SharedBuffers {
    draws: wgpu::Buffer,
    table: wgpu::Buffer,
}

struct OwnBuffers {
    output: wgpu::Buffer,
    read_back: wgpu::Buffer,
    bindings: wgpu::BindGroup,
}

/// What is told of an instant of a trace.
pub struct Instantly<'a> {
    /// Step number.
    pub step: u32,
    groups: &'a [Group],
    /// Of each group, the words of this instant.
    words: Vec<&'a [u32]>,
}

impl Instantly<'_> {
    /// What every agent and channel of an episode shows, `[agent][channel]`; episodes are counted within the trace.
    #[must_use]
    pub fn agents(&self, episode: usize, controller: usize) -> Vec<Vec<Shown>> {
        let groups = || {
            let groups = self.groups.iter().zip(&self.words);
            groups.filter(|(group, _)| group.controller == controller)
        };
        let team = groups().next().map_or(0, |(group, _)| group.shape.team);
        (0..team)
            .map(|agent| {
                let channels = groups().flat_map(|(Group { shape, .. }, words)| {
                    let (block, lane) = (episode / shape.lanes, episode % shape.lanes);
                    let words = &words[block * SHOWN_WORDS * shape.workgroup()..];
                    (0..shape.channels).map(move |channel| {
                        words::shown(words, shape, shape.place(channel, agent, lane))
                    })
                });
                channels.collect()
            })
            .collect()
    }
}

impl<'g> GpuFlyer<'g> {
    /// Prepares a campaign: tabulates the references, rounds the gains, compiles the shaders, allocates the buffers; `gains`
    /// as for [`crate::backend::cpu::Cpu::new`].
    ///
    /// # Errors
    /// If the campaign does not fit the adapter, or its driver refuses the shaders.
    pub fn new(
        gpu: &'g Gpu,
        campaign: &Campaign,
        gains: &[[LoopGains; 2]],
        tuning: Tuning,
    ) -> Result<Self, GpuError> {
        Self::rewritten(gpu, campaign, gains, tuning, &|text| text)
    }

    /// The same with changed shaders, to test that a test would notice.
    ///
    /// # Errors
    /// As [`GpuFlyer::new`].
    #[doc(hidden)]
    pub fn rewritten(
        gpu: &'g Gpu,
        campaign: &Campaign,
        gains: &[[LoopGains; 2]],
        tuning: Tuning,
        rewrite: &dyn Fn(String) -> String,
    ) -> Result<Self, GpuError> {
        let start = Instant::now();
        let model: Model<f32> = Model::new(campaign);
        let controllers: Vec<_> = gains.iter().map(Controller::new).collect();
        let layout = binding_layout(gpu);
        let mut groups: Vec<Group> = Vec::new();
        for (controller, gains) in controllers.iter().enumerate() {
            for (number, part) in model.parts.iter().enumerate() {
                let shape = shape(gpu, campaign, part, gains.ftc)?;
                // The axes mostly share their shaders, and the PIDs do.
                let known = groups.iter().find(|group| group.shape == shape);
                let pipelines = match known {
                    Some(group) => group.pipelines.clone(),
                    None => gpu.compile(&rewrite(shape.text()), &layout, ENTRIES)?,
                };
                let bytes = words::setting(campaign, part, gains);
                let setting = gpu.buffer(bytes.len().div_ceil(4), Use::Uniform);
                gpu.queue.write_buffer(&setting, 0, &bytes);
                groups.push(Group {
                    part: number,
                    controller,
                    shape,
                    pipelines,
                    setting,
                });
            }
        }
        let compile_s = start.elapsed().as_secs_f64();
        let batch = batch(gpu, &groups, campaign.episodes, tuning);
        let buffers = Buffers::largest(gpu, &layout, &groups, &model, batch)?;
        let most = buffers.window_steps.max(1);
        Ok(Self {
            gpu,
            steps: tuning.steps.unwrap_or(FIRST_STEPS).clamp(1, most),
            model,
            controllers,
            groups,
            layout,
            buffers,
            tuning,
            times: GpuTimes {
                compile_s,
                ..GpuTimes::default()
            },
        })
    }

    /// Episodes of a batch, at most.
    #[must_use]
    pub fn batch(&self) -> u32 {
        word(self.buffers.batch)
    }

    /// Times so far.
    #[must_use]
    pub fn times(&self) -> GpuTimes {
        self.times
    }

    /// Flies a range of at most [`GpuFlyer::batch`] episodes under every controller, in order; `done` is told how many
    /// episodes' worth of steps came to an end.
    ///
    /// # Errors
    /// If the device fails; nothing of the batch is known then.
    pub fn fly(
        &mut self,
        episodes: Range<u32>,
        done: &(dyn Fn(u32) + Sync),
    ) -> Result<Vec<Flown>, GpuError> {
        let campaign = &self.model.campaign;
        let start = Instant::now();
        let episodes: Vec<Episode> = episodes
            .into_par_iter()
            .map(|episode| draw(campaign, episode))
            .collect();
        self.load(&episodes)?;
        self.times.upload_s += start.elapsed().as_secs_f64();

        let start = Instant::now();
        let steps = self.model.campaign.time.steps;
        let (mut step, mut told) = (0, 0);
        while step < steps {
            let until = step.saturating_add(self.steps).min(steps);
            let began = Instant::now();
            self.dispatch(episodes.len(), Entry::Advance, step..until, 0)?;
            self.adapt(until - step, began.elapsed());
            step = until;
            let share = u64::from(word(episodes.len())) * u64::from(step) / u64::from(steps);
            let share = u32::try_from(share).unwrap_or(u32::MAX);
            done(share - told);
            told = share;
        }
        self.times.kernel_s += start.elapsed().as_secs_f64();

        let start = Instant::now();
        let outcomes = self.outcomes(episodes.len())?;
        self.times.read_back_s += start.elapsed().as_secs_f64();
        Ok(episodes
            .into_iter()
            .zip(outcomes)
            .map(|(episode, outcomes)| Flown { episode, outcomes })
            .collect())
    }

    /// Flies some episodes and shows them every `every` steps, from the start to the end; returns how each ended, `[episode]`.
    /// The episodes may be any of the campaign's, as many as a batch holds.
    ///
    /// # Errors
    /// If the device fails.
    pub fn trace(
        &mut self,
        episodes: &[u32],
        every: u32,
        visit: &mut dyn FnMut(&Instantly<'_>),
    ) -> Result<Vec<Flown>, GpuError> {
        let campaign = &self.model.campaign;
        let (steps, every) = (campaign.time.steps, every.max(1));
        let episodes: Vec<Episode> = episodes
            .iter()
            .map(|&episode| draw(campaign, episode))
            .collect();
        let samples = word(self.samples(episodes.len()));
        self.buffers = Buffers::new(
            self.gpu,
            &self.layout,
            &self.groups,
            &self.model,
            episodes.len(),
            samples as usize,
        )?;
        self.load(&episodes)?;
        let mut instants = (0..steps).step_by(every as usize).chain([steps]).peekable();
        while instants.peek().is_some() {
            let instants: Vec<u32> = instants.by_ref().take(samples as usize).collect();
            // Each instant is shown, then left behind: the state stands at the next one, or at the end.
            for &step in &instants {
                let next = step.saturating_add(every).min(steps);
                let sample = (step - instants[0]).div_ceil(every);
                self.run_sampled(episodes.len(), step, next, sample)?;
            }
            let read: Vec<Vec<u32>> = self
                .groups
                .iter()
                .zip(&self.buffers.own)
                .map(|(group, buffers)| {
                    let words = instants.len() * group.invocations(episodes.len()) * SHOWN_WORDS;
                    self.gpu.read(&buffers.output, &buffers.read_back, words)
                })
                .collect::<Result<_, _>>()?;
            for (sample, &step) in instants.iter().enumerate() {
                let words = self
                    .groups
                    .iter()
                    .zip(&read)
                    .map(|(group, read)| {
                        &read[sample * group.invocations(episodes.len()) * SHOWN_WORDS..]
                    })
                    .collect();
                visit(&Instantly {
                    step,
                    groups: &self.groups,
                    words,
                });
            }
        }
        let outcomes = self.outcomes(episodes.len())?;
        Ok(episodes
            .into_iter()
            .zip(outcomes)
            .map(|(episode, outcomes)| Flown { episode, outcomes })
            .collect())
    }

    /// Samples of so many episodes that fit the outputs.
    fn samples(&self, episodes: usize) -> usize {
        let most = self.groups.iter().map(|group| {
            let limit = storage_limit(self.gpu) / 4;
            usize::try_from(limit).unwrap_or(usize::MAX)
                / (group.invocations(episodes) * SHOWN_WORDS)
        });
        most.min().unwrap_or(1).clamp(1, SAMPLES as usize)
    }

    /// Sends the draws of a batch and sets the initial state.
    fn load(&mut self, episodes: &[Episode]) -> Result<(), GpuError> {
        for (number, (part, buffers)) in self
            .model
            .parts
            .iter()
            .zip(&self.buffers.shared)
            .enumerate()
        {
            let Some(group) = self.groups.iter().find(|group| group.part == number) else {
                continue;
            };
            let (campaign, first) = (&self.model.campaign, part.channels.start);
            let draws = words::draws(campaign, &group.shape, first, episodes);
            self.gpu
                .queue
                .write_buffer(&buffers.draws, 0, bytemuck::cast_slice(&draws));
        }
        self.dispatch(episodes.len(), Entry::Start, 0..0, 0)
    }

    /// Reads how a batch ended, `[episode][controller][agent]`.
    fn outcomes(&mut self, episodes: usize) -> Result<Vec<Vec<Vec<AgentOutcome>>>, GpuError> {
        let campaign = &self.model.campaign;
        let steps = campaign.time.steps;
        let blank = vec![AgentOutcome::blank(); campaign.team];
        let mut outcomes = vec![vec![blank; self.controllers.len()]; episodes];
        self.dispatch(episodes, Entry::Finish, steps..steps, 0)?;
        for (group, buffers) in self.groups.iter().zip(&self.buffers.own) {
            let words = group.invocations(episodes) * OUTCOME_WORDS;
            let words = self.gpu.read(&buffers.output, &buffers.read_back, words)?;
            words::take_outcomes(
                &self.model.campaign,
                &group.shape,
                self.model.parts[group.part].channels.start,
                &words,
                outcomes
                    .iter_mut()
                    .map(|controllers| &mut controllers[group.controller]),
            );
        }
        Ok(outcomes)
    }

    /// Chooses the steps of the next dispatch by the time that the last one took.
    fn adapt(&mut self, steps: u32, took: Duration) {
        if self.tuning.steps.is_some() {
            return;
        }
        let per_step = took.as_secs_f64() / f64::from(steps);
        let wanted = DISPATCH.as_secs_f64() / per_step;
        // A single measurement may be off: no jumps.
        let most = f64::from(self.steps.saturating_mul(4).min(self.buffers.window_steps));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the steps of a window"
        )]
        let wanted = wanted.clamp(1.0, most.max(1.0)) as u32;
        self.steps = wanted;
    }

    /// Dispatches an instant of a trace: what it shows, then the steps to the next one.
    fn run_sampled(
        &mut self,
        episodes: usize,
        step: u32,
        next: u32,
        sample: u32,
    ) -> Result<(), GpuError> {
        self.dispatch(episodes, Entry::Show, step..step, sample)?;
        let mut first = step;
        while first < next {
            let until = first.saturating_add(self.buffers.window_steps).min(next);
            self.dispatch(episodes, Entry::Advance, first..until, 0)?;
            first = until;
        }
        Ok(())
    }

    /// Dispatches an entry point of every group over a span of steps, and waits.
    fn dispatch(
        &mut self,
        episodes: usize,
        entry: Entry,
        span: Range<u32>,
        sample: u32,
    ) -> Result<(), GpuError> {
        if matches!(entry, Entry::Advance | Entry::Show) {
            self.cover(&span);
        }
        let stride = span_stride(self.gpu);
        for (k, group) in self.groups.iter().enumerate() {
            let span = Span {
                first: span.start,
                until: span.end,
                table_first: 2 * span.start.saturating_sub(self.buffers.window.start),
                output_first: sample * word(group.invocations(episodes) * SHOWN_WORDS),
            };
            self.gpu.queue.write_buffer(
                &self.buffers.spans,
                (k * stride) as u64,
                bytemuck::bytes_of(&span),
            );
        }
        let mut encoder = self
            .gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        for (k, (group, buffers)) in self.groups.iter().zip(&self.buffers.own).enumerate() {
            pass.set_pipeline(&group.pipelines[entry as usize]);
            pass.set_bind_group(0, &buffers.bindings, &[word(k * stride)]);
            pass.dispatch_workgroups(word(episodes.div_ceil(group.shape.lanes)), 1, 1);
        }
        drop(pass);
        self.gpu.submit(encoder.finish())
    }

    /// Sees to it that the references of a span are on the device.
    fn cover(&mut self, span: &Range<u32>) {
        let window = &self.buffers.window;
        if !window.is_empty() && window.start <= span.start && span.end <= window.end {
            return;
        }
        let steps = self.model.campaign.time.steps;
        let end = span
            .start
            .saturating_add(self.buffers.window_steps)
            .min(steps);
        for (part, buffers) in self.model.parts.iter().zip(&self.buffers.shared) {
            let stride = self.model.campaign.team * part.channels.len();
            let rows =
                &part.table[2 * span.start as usize * stride..(2 * end as usize + 1) * stride];
            self.gpu
                .queue
                .write_buffer(&buffers.table, 0, bytemuck::cast_slice(rows));
        }
        self.buffers.window = span.start..end;
    }
}

impl Group {
    /// Invocations of a dispatch.
    fn invocations(&self, episodes: usize) -> usize {
        episodes.div_ceil(self.shape.lanes) * self.shape.workgroup()
    }
}

impl Buffers {
    /// Buffers for as many of `batch` episodes as the device has memory for.
    fn largest(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        groups: &[Group],
        model: &Model<f32>,
        mut batch: usize,
    ) -> Result<Self, GpuError> {
        let least = groups.iter().map(|group| group.shape.lanes).max();
        loop {
            match Self::new(gpu, layout, groups, model, batch, 0) {
                Err(GpuError::OutOfMemory { .. }) if Some(batch) > least => batch /= 2,
                result => return result,
            }
        }
    }

    fn new(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        groups: &[Group],
        model: &Model<f32>,
        batch: usize,
        samples: usize,
    ) -> Result<Self, GpuError> {
        let window_steps = groups
            .iter()
            .map(|group| window_steps(group, gpu, model.campaign.time.steps))
            .min()
            .unwrap_or(1);
        let sizes = |group: &Group| Sizes::new(group, batch, samples, window_steps);
        let words: usize = groups.iter().map(|group| sizes(group).total()).sum();
        gpu.checked(
            || {
                let spans = gpu.buffer(span_stride(gpu) / 4 * groups.len(), Use::Uniform);
                // Every controller's groups have the same draws and references.
                let shared: Vec<SharedBuffers> = (0..model.parts.len())
                    .filter_map(|part| groups.iter().find(|group| group.part == part))
                    .map(|group| SharedBuffers {
                        draws: gpu.buffer(sizes(group).draws, Use::Storage),
                        table: gpu.buffer(sizes(group).table, Use::Storage),
                    })
                    .collect();
                let own = groups
                    .iter()
                    .map(|group| {
                        let shared = &shared[group.part];
                        OwnBuffers::new(gpu, layout, group, shared, &spans, &sizes(group))
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
struct Sizes {
    draws: usize,
    state: usize,
    table: usize,
    output: usize,
}

impl Sizes {
    fn new(group: &Group, batch: usize, samples: usize, window_steps: u32) -> Self {
        let shape = &group.shape;
        let words = shape.words();
        let invocations = group.invocations(batch);
        Self {
            draws: invocations * words.drawn(),
            state: invocations * words.stored(),
            table: (2 * window_steps as usize + 1) * shape.team * shape.channels * 4,
            output: invocations * OUTCOME_WORDS.max(samples * SHOWN_WORDS),
        }
    }

    fn total(&self) -> usize {
        self.draws + self.state + self.table + 2 * self.output
    }
}

impl OwnBuffers {
    fn new(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        group: &Group,
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
            group.setting.as_entire_binding(),
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

/// The bindings of shaders/episode.wgsl.
fn binding_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    use wgpu::BufferBindingType::{Storage, Uniform};
    let (read, write) = (Storage { read_only: true }, Storage { read_only: false });
    let kinds = [Uniform, Uniform, read, write, read, write];
    let entries: Vec<_> = (0..)
        .zip(kinds)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty,
                // The span moves from group to group.
                has_dynamic_offset: binding == 1,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &entries,
        })
}

/// The shape of a part's shaders on this adapter.
fn shape(gpu: &Gpu, campaign: &Campaign, part: &Part<f32>, ftc: bool) -> Result<Shape, GpuError> {
    let first = part.channels.start;
    let episode = draw(campaign, 0);
    let (counts, noise_entries) = match part.plant {
        PlantKind::Axis => words::signals::<1>(campaign, first, &episode),
        PlantKind::Attitude => words::signals::<3>(campaign, first, &episode),
        PlantKind::Thrust => words::signals::<6>(campaign, first, &episode),
    };
    let limits = gpu.limits();
    let mut shape = Shape {
        plant: part.plant,
        channels: part.channels.len(),
        team: campaign.team,
        lanes: MAX_LANES,
        ftc,
        coupled: campaign.is_coupled(),
        observer_measured: campaign.initial.observer == ObserverStart::Measured,
        counts,
        noise_entries,
    };
    while shape.lanes > 1 && shape.workgroup() > WORKGROUP {
        shape.lanes /= 2;
    }
    for (what, needed, limit) in [
        (
            "a team in one workgroup, in invocations,",
            shape.workgroup(),
            limits.max_compute_invocations_per_workgroup,
        ),
        (
            "a team in one workgroup, in bytes of its memory,",
            shape.shared_bytes(),
            limits.max_compute_workgroup_storage_size,
        ),
    ] {
        if needed as u64 > u64::from(limit) {
            return Err(GpuError::TooLarge {
                adapter: gpu.adapter().name.clone(),
                what,
                needed: needed as u64,
                limit: u64::from(limit),
            });
        }
    }
    Ok(shape)
}

/// Bytes that a storage buffer may have.
fn storage_limit(gpu: &Gpu) -> u64 {
    let limits = gpu.limits();
    limits
        .max_storage_buffer_binding_size
        .min(limits.max_buffer_size)
        .min(u64::from(u32::MAX))
}

/// Steps whose references fit the table on the device.
fn window_steps(group: &Group, gpu: &Gpu, steps: u32) -> u32 {
    let row = 16 * group.shape.team * group.shape.channels;
    let bytes = TABLE.min(usize::try_from(storage_limit(gpu)).unwrap_or(TABLE));
    word((bytes / row).saturating_sub(1) / 2).clamp(1, steps)
}

/// Bytes from one span to the next.
fn span_stride(gpu: &Gpu) -> usize {
    gpu.limits().min_uniform_buffer_offset_alignment as usize
}

/// Episodes of a batch: what is asked for, or what fills the device, within the limits of buffers and memory.
fn batch(gpu: &Gpu, groups: &[Group], episodes: u32, tuning: Tuning) -> usize {
    let limit = storage_limit(gpu);
    let per_episode = |group: &Group| {
        let sizes = Sizes::new(group, group.shape.lanes, 0, 0);
        let largest = sizes.state.max(sizes.draws).max(sizes.output);
        (
            device::bytes(largest.div_ceil(group.shape.lanes)),
            device::bytes(sizes.total().div_ceil(group.shape.lanes)),
        )
    };
    let fits = groups
        .iter()
        .map(|group| limit / per_episode(group).0)
        .min()
        .unwrap_or(1);
    let total: u64 = groups.iter().map(|group| per_episode(group).1).sum();
    // Whole blocks, so that the limits hold for the padding too.
    let lanes = groups
        .iter()
        .map(|group| group.shape.lanes as u64)
        .max()
        .unwrap_or(1);
    let most = (fits.min(MEMORY / total) / lanes * lanes).max(1);
    let wanted = tuning.batch.unwrap_or(MAX_BATCH).min(episodes).max(1);
    usize::try_from(most.min(u64::from(wanted))).unwrap_or(usize::MAX)
}
