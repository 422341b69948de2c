//! Simulating batches of episodes: draws up, spans of steps, outcomes down.

use super::GpuError;
use super::buffers::{Buffers, batch, span_stride, storage_limit};
use super::device::{Gpu, Use};
use super::instant::TraceInstant;
use super::layout::{OUTCOME_WORDS, SHOWN_WORDS, Span, word};
use super::packer::{LandedBatch, PackedBatch, Packer};
use super::pipeline::{ENTRIES, Entry, Pipeline, binding_layout, shape};
use super::times::GpuTimes;
use super::tuning::Tuning;
use super::uniforms::setting;
use crate::backend::EpisodeResult;
use crate::campaign::AgentGroup;
use crate::draw::Episode;
use crate::model::controller::kinds::Controller;
use crate::model::episode::Model;
use crate::synthesis::LoopGains;
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What a dispatch should take: short beside the seconds after which a display driver resets the device, long beside
/// the cost of a submission.
const DISPATCH: Duration = Duration::from_millis(100);
/// Steps of the first dispatch, before anything is known of the device.
const FIRST_STEPS: u32 = 4;
/// Samples of a trace between two read-backs.
const SAMPLES: u32 = 64;

/// A campaign's controllers, ready for a GPU.
pub struct GpuSimulator<'g> {
    gpu: &'g Gpu,
    model: Model<f32>,
    packer: Arc<Packer>,
    pipelines: Vec<Pipeline>,
    layout: wgpu::BindGroupLayout,
    buffers: Buffers,
    tuning: Tuning,
    /// Steps of the next dispatch.
    steps: u32,
    /// Steps of a dispatch, at most: what the loops of its shaders and the references on the device allow.
    most_steps: u32,
    times: GpuTimes,
}

impl<'g> GpuSimulator<'g> {
    /// Prepares a campaign: tabulates the references, rounds the gains, compiles the shaders, allocates the buffers;
    /// `gains` as for [`crate::backend::cpu::Cpu::new`].
    ///
    /// # Errors
    /// If the campaign does not fit the adapter, or its driver refuses the shaders.
    pub fn new(
        gpu: &'g Gpu,
        group: &AgentGroup,
        gains: &[Vec<LoopGains>],
        tuning: Tuning,
    ) -> Result<Self, GpuError> {
        Self::rewritten(gpu, group, gains, tuning, &|text| text)
    }

    /// The same with changed shaders, to test that a test would notice.
    ///
    /// # Errors
    /// As [`GpuSimulator::new`].
    #[doc(hidden)]
    pub fn rewritten(
        gpu: &'g Gpu,
        group: &AgentGroup,
        gains: &[Vec<LoopGains>],
        tuning: Tuning,
        rewrite: &dyn Fn(String) -> String,
    ) -> Result<Self, GpuError> {
        let model: Model<f32> = Model::new(group);
        let controllers: Vec<_> = gains.iter().map(|gains| Controller::new(gains)).collect();
        let layout = binding_layout(gpu);
        let start = Instant::now();
        let mut pipelines: Vec<Pipeline> = Vec::new();
        let mut most_steps = u32::MAX;
        for (controller, gains) in controllers.iter().enumerate() {
            for (number, part) in model.parts.iter().enumerate() {
                let shape = shape(gpu, group, part, gains.is_fault_tolerant())?;
                most_steps = most_steps.min(shape.most_steps(gpu)?);
                // The axes mostly share their shaders, and the PIDs do.
                let known = pipelines.iter().find(|pipeline| pipeline.shape == shape);
                let entries = match known {
                    Some(pipeline) => pipeline.entries.clone(),
                    None => gpu.compile(&rewrite(shape.text()), &layout, ENTRIES)?,
                };
                let bytes = setting(group, part, gains);
                let setting = gpu.checked(
                    || gpu.buffer(bytes.len().div_ceil(4), Use::Uniform),
                    |error| gpu.driver_error(error),
                )?;
                gpu.write(&setting, 0, &bytes)?;
                pipelines.push(Pipeline {
                    part: number,
                    controller,
                    shape,
                    entries,
                    setting,
                });
            }
        }
        let compile_s = start.elapsed().as_secs_f64();
        let batch = batch(gpu, &pipelines, group.episodes, tuning);
        let buffers = Buffers::largest(gpu, &layout, &pipelines, &model, batch)?;
        let most_steps = most_steps.min(buffers.window_steps).max(1);
        Ok(Self {
            gpu,
            steps: tuning.steps.unwrap_or(FIRST_STEPS).clamp(1, most_steps),
            most_steps,
            packer: Arc::new(Packer::new(
                &gpu.adapter().name,
                &model,
                controllers.len(),
                &pipelines,
            )),
            model,
            pipelines,
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

    /// Steps of a dispatch, at most.
    #[must_use]
    pub fn most_steps(&self) -> u32 {
        self.most_steps
    }

    /// Takes so many steps per dispatch, even more than the adapter allows, to test that a test would notice.
    #[doc(hidden)]
    pub fn force_steps(&mut self, steps: u32) {
        self.steps = steps.clamp(1, self.buffers.window_steps);
        self.tuning.steps = Some(self.steps);
    }

    /// Times so far.
    #[must_use]
    pub fn times(&self) -> GpuTimes {
        self.times
    }

    /// What packs batches for this simulator and unpacks them, beside its work.
    #[must_use]
    pub fn packer(&self) -> Arc<Packer> {
        Arc::clone(&self.packer)
    }

    /// Simulates a range of at most [`GpuSimulator::batch`] episodes under every controller, in order; `done` is told
    /// how many episodes' worth of steps came to an end.
    ///
    /// # Errors
    /// If the device fails; nothing of the batch is known then.
    pub fn simulate(
        &mut self,
        episodes: Range<u32>,
        done: &(dyn Fn(u32) + Sync),
    ) -> Result<Vec<EpisodeResult>, GpuError> {
        let packed = self.packer.pack(episodes.collect());
        let landed = self.fly(packed, done)?;
        self.packer.unpack(landed)
    }

    /// The part of [`GpuSimulator::simulate`] that needs the device.
    ///
    /// # Errors
    /// If the device fails; nothing of the batch is known then.
    pub fn fly(
        &mut self,
        packed: PackedBatch,
        done: &(dyn Fn(u32) + Sync),
    ) -> Result<LandedBatch, GpuError> {
        let start = Instant::now();
        self.load(&packed)?;
        // What is on the device takes no more room here.
        let episodes = packed.episodes;
        drop(packed.draws);
        self.times.upload_s += start.elapsed().as_secs_f64();

        let start = Instant::now();
        let steps = self.model.group.time.steps;
        let mut told = 0;
        self.advance(episodes.len(), 0..steps, &mut |step| {
            let share = u64::from(word(episodes.len())) * u64::from(step) / u64::from(steps);
            let share = u32::try_from(share).unwrap_or(u32::MAX);
            done(share - told);
            told = share;
        })?;
        self.times.kernel_s += start.elapsed().as_secs_f64();

        let start = Instant::now();
        let landed = self.landed(episodes)?;
        self.times.read_back_s += start.elapsed().as_secs_f64();
        Ok(landed)
    }

    /// Simulates some episodes and shows them every `every` steps, from the start to the end; returns how each ended,
    /// `[episode]`. The episodes may be any of the campaign's, as many as a batch holds.
    ///
    /// # Errors
    /// If the device fails.
    pub fn trace(
        &mut self,
        episodes: &[u32],
        every: u32,
        visit: &mut dyn FnMut(&TraceInstant<'_>),
    ) -> Result<Vec<EpisodeResult>, GpuError> {
        let group = &self.model.group;
        let (steps, every) = (group.time.steps, every.max(1));
        if episodes.is_empty() {
            return Ok(Vec::new());
        }
        let packed = self.packer.pack(episodes.to_vec());
        let samples = word(self.samples(episodes.len()));
        self.allocate(episodes.len(), samples as usize)?;
        self.load(&packed)?;
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
                .pipelines
                .iter()
                .zip(&self.buffers.own)
                .map(|(pipeline, buffers)| {
                    let words = instants.len() * pipeline.invocations(episodes.len()) * SHOWN_WORDS;
                    self.gpu.read(&buffers.output, &buffers.read_back, words)
                })
                .collect::<Result<_, _>>()?;
            for (sample, &step) in instants.iter().enumerate() {
                let words = self
                    .pipelines
                    .iter()
                    .zip(&read)
                    .map(|(pipeline, read)| {
                        &read[sample * pipeline.invocations(episodes.len()) * SHOWN_WORDS..]
                    })
                    .collect();
                visit(&TraceInstant {
                    step,
                    pipelines: &self.pipelines,
                    words,
                });
            }
        }
        let landed = self.landed(packed.episodes)?;
        self.packer.unpack(landed)
    }

    /// Replaces the buffers.
    fn allocate(&mut self, batch: usize, samples: usize) -> Result<(), GpuError> {
        let (pipelines, model) = (&self.pipelines, &self.model);
        self.buffers = Buffers::new(self.gpu, &self.layout, pipelines, model, batch, samples)?;
        Ok(())
    }

    /// Samples of so many episodes that fit the outputs.
    fn samples(&self, episodes: usize) -> usize {
        let most = self.pipelines.iter().map(|pipeline| {
            let limit = storage_limit(self.gpu) / 4;
            usize::try_from(limit).unwrap_or(usize::MAX)
                / (pipeline.invocations(episodes) * SHOWN_WORDS)
        });
        most.min().unwrap_or(1).clamp(1, SAMPLES as usize)
    }

    /// Sends the draws of a batch and sets the initial state.
    fn load(&mut self, packed: &PackedBatch) -> Result<(), GpuError> {
        let episodes = packed.episodes.len();
        // A trace leaves smaller buffers than a batch needs.
        if episodes > self.buffers.batch {
            self.allocate(episodes, 0)?;
        }
        for (draws, buffers) in packed.draws.iter().zip(&self.buffers.shared) {
            self.gpu.upload(&buffers.draws, draws)?;
        }
        self.dispatch(episodes, Entry::Start, 0..0, 0)
    }

    /// Reads how the episodes of a batch ended.
    fn landed(&mut self, episodes: Vec<Episode>) -> Result<LandedBatch, GpuError> {
        let steps = self.model.group.time.steps;
        self.dispatch(episodes.len(), Entry::Finish, steps..steps, 0)?;
        let pipelines = self.pipelines.iter().zip(&self.buffers.own);
        let words = pipelines.map(|(pipeline, buffers)| {
            let words = pipeline.invocations(episodes.len()) * OUTCOME_WORDS;
            self.gpu.read(&buffers.output, &buffers.read_back, words)
        });
        let words = words.collect::<Result<_, _>>()?;
        Ok(LandedBatch { episodes, words })
    }

    /// Chooses the steps of the next dispatch by the time that the last one took.
    fn adapt(&mut self, steps: u32, took: Duration) {
        if self.tuning.steps.is_some() {
            return;
        }
        let per_step = took.as_secs_f64() / f64::from(steps);
        let wanted = DISPATCH.as_secs_f64() / per_step;
        // A single measurement may be off: no jumps.
        let most = f64::from(self.steps.saturating_mul(4).min(self.most_steps));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the steps of a dispatch"
        )]
        let wanted = wanted.clamp(1.0, most.max(1.0)) as u32;
        self.steps = wanted;
    }

    /// Integrates over some steps, in as many dispatches as it takes; `reached` is told after each where the state
    /// stands.
    fn advance(
        &mut self,
        episodes: usize,
        steps: Range<u32>,
        reached: &mut dyn FnMut(u32),
    ) -> Result<(), GpuError> {
        let mut first = steps.start;
        while first < steps.end {
            let until = first.saturating_add(self.steps).min(steps.end);
            let began = Instant::now();
            self.dispatch(episodes, Entry::Advance, first..until, 0)?;
            self.adapt(until - first, began.elapsed());
            reached(until);
            first = until;
        }
        Ok(())
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
        self.advance(episodes, step..next, &mut |_| ())
    }

    /// Dispatches an entry point of every group over a span of steps, and waits.
    fn dispatch(
        &mut self,
        episodes: usize,
        entry: Entry,
        span: Range<u32>,
        sample: u32,
    ) -> Result<(), GpuError> {
        if matches!(entry, Entry::Start | Entry::Advance | Entry::Show) {
            self.cover(&span)?;
        }
        let stride = span_stride(self.gpu);
        let mut spans = vec![0; stride * self.pipelines.len()];
        for (pipeline, bytes) in self.pipelines.iter().zip(spans.chunks_mut(stride)) {
            let span = Span {
                first: span.start,
                until: span.end,
                table_first: 2 * span.start.saturating_sub(self.buffers.window.start),
                output_first: sample * word(pipeline.invocations(episodes) * SHOWN_WORDS),
            };
            bytes[..size_of::<Span>()].copy_from_slice(bytemuck::bytes_of(&span));
        }
        self.gpu.write(&self.buffers.spans, 0, &spans)?;
        self.gpu.submit(|encoder| {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            for (k, (pipeline, buffers)) in self.pipelines.iter().zip(&self.buffers.own).enumerate()
            {
                pass.set_pipeline(&pipeline.entries[entry as usize]);
                pass.set_bind_group(0, &buffers.bindings, &[word(k * stride)]);
                pass.dispatch_workgroups(word(episodes.div_ceil(pipeline.shape.lanes)), 1, 1);
            }
        })
    }

    /// Sees to it that the references of a span are on the device.
    fn cover(&mut self, span: &Range<u32>) -> Result<(), GpuError> {
        let window = &self.buffers.window;
        if !window.is_empty() && window.start <= span.start && span.end <= window.end {
            return Ok(());
        }
        let steps = self.model.group.time.steps;
        let end = span
            .start
            .saturating_add(self.buffers.window_steps)
            .min(steps);
        for (part, buffers) in self.model.parts.iter().zip(&self.buffers.shared) {
            let stride = self.model.group.team * part.channels.len() * part.rows;
            let rows =
                &part.table[2 * span.start as usize * stride..(2 * end as usize + 1) * stride];
            self.gpu.write(&buffers.table, 0, rows)?;
        }
        self.buffers.window = span.start..end;
        Ok(())
    }
}
