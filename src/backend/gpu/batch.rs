//! Simulating batches of episodes: draws up, spans of steps, outcomes down.

use super::GpuError;
use super::buffers::{Buffers, batch, span_stride, storage_limit};
use super::device::{Gpu, Use};
use super::instant::TraceInstant;
use super::layout::{self, OUTCOME_WORDS, SHOWN_WORDS, Span, word};
use super::pipeline::{ENTRIES, Entry, Pipeline, binding_layout, shape};
use super::times::GpuTimes;
use super::tuning::Tuning;
use super::uniforms::setting;
use crate::backend::EpisodeResult;
use crate::campaign::AgentGroup;
use crate::draw::{Episode, draw};
use crate::model::controller::kinds::Controller;
use crate::model::episode::{AgentOutcome, Model};
use crate::synthesis::LoopGains;
use rayon::prelude::*;
use std::ops::Range;
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
    controllers: Vec<Controller<f32>>,
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
            model,
            controllers,
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
        let group = &self.model.group;
        let start = Instant::now();
        let episodes: Vec<Episode> = episodes
            .into_par_iter()
            .map(|episode| draw(group, episode))
            .collect();
        self.load(&episodes)?;
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
        let simulated = self.simulated(episodes)?;
        self.times.read_back_s += start.elapsed().as_secs_f64();
        Ok(simulated)
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
        let episodes: Vec<Episode> = episodes
            .iter()
            .map(|&episode| draw(group, episode))
            .collect();
        let samples = word(self.samples(episodes.len()));
        self.allocate(episodes.len(), samples as usize)?;
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
        self.simulated(episodes)
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
    fn load(&mut self, episodes: &[Episode]) -> Result<(), GpuError> {
        // A trace leaves smaller buffers than a batch needs.
        if episodes.len() > self.buffers.batch {
            self.allocate(episodes.len(), 0)?;
        }
        for (number, (part, buffers)) in self
            .model
            .parts
            .iter()
            .zip(&self.buffers.shared)
            .enumerate()
        {
            let Some(pipeline) = self
                .pipelines
                .iter()
                .find(|pipeline| pipeline.part == number)
            else {
                continue;
            };
            let (group, first) = (&self.model.group, part.channels.start);
            let draws = layout::draws(group, &pipeline.shape, first, episodes);
            self.gpu.upload(&buffers.draws, &draws)?;
        }
        self.dispatch(episodes.len(), Entry::Start, 0..0, 0)
    }

    /// Reads how the episodes of a batch ended.
    fn simulated(&mut self, episodes: Vec<Episode>) -> Result<Vec<EpisodeResult>, GpuError> {
        let group = &self.model.group;
        let steps = group.time.steps;
        let blank = vec![
            vec![AgentOutcome::blank(group.channels().len()); group.team];
            self.controllers.len()
        ];
        self.dispatch(episodes.len(), Entry::Finish, steps..steps, 0)?;
        let mut simulated: Vec<EpisodeResult> = episodes
            .into_iter()
            .map(|episode| EpisodeResult {
                episode,
                outcomes: blank.clone(),
            })
            .collect();
        for (pipeline, buffers) in self.pipelines.iter().zip(&self.buffers.own) {
            let words = pipeline.invocations(simulated.len()) * OUTCOME_WORDS;
            let words = self.gpu.read(&buffers.output, &buffers.read_back, words)?;
            layout::take_outcomes(
                &self.model.group,
                &pipeline.shape,
                self.model.parts[pipeline.part].channels.start,
                &words,
                simulated.iter_mut().map(|simulated| {
                    (
                        simulated.episode.index,
                        &mut simulated.outcomes[pipeline.controller],
                    )
                }),
            )
            .map_err(|error| self.gpu.driver_error(error))?;
        }
        Ok(simulated)
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
