//! Running a probe: the joined shaders of a shape, [`PRELUDE`] and the body that calls the function; inputs up, results
//! down, and the comparison with what the Rust twin makes of the same inputs.

use super::tracked::Tracked;
use crate::backend::gpu::device::Use;
use crate::backend::gpu::layout::{Span, word};
use crate::backend::gpu::pipeline::binding_layout;
use crate::backend::gpu::shape::Shape;
use crate::backend::gpu::{Gpu, GpuError, Wanted, adapters};
use crate::model::metric::{Extremes, Sums};
use std::sync::{Mutex, OnceLock, PoisonError};

/// What every probe's text has after the joined shaders.
const PRELUDE: &str = include_str!("probe.wgsl");
/// What results hold before a probe: a NaN, so that what is not written cannot pass for a number.
pub(super) const BLANK: u32 = 0x7fc0_0000;

/// An allowed error, relative to a number or to one, that would hide mistakes. Bounds are that wide where a branch is
/// taken by a hair and where a divergence is played.
const LOOSE: f64 = 1e-4;

/// A device, and a change of the shaders that probes must notice, if any.
pub(super) struct Lab {
    gpu: &'static Mutex<Gpu>,
    change: Option<(&'static str, &'static str)>,
}

/// What is probed, and with what.
pub(super) struct Job<'a> {
    pub(super) shape: &'a Shape,
    pub(super) setting: &'a [u8],
    pub(super) span: Span,
    pub(super) table: &'a [[f32; 4]],
    /// Statements that call the function.
    pub(super) body: &'a str,
    /// Words of the image of the private state that come before the inputs and results of the function.
    pub(super) image: usize,
    /// One per invocation, a whole number of workgroups.
    pub(super) cases: &'a [Case],
    /// Words that an invocation gives.
    pub(super) given: usize,
}

/// What an invocation is given: its words of the buffers, and of the probe.
#[derive(Clone, Default)]
pub(super) struct Case {
    pub(super) drawn: Vec<u32>,
    pub(super) stored: Vec<u32>,
    pub(super) taken: Vec<u32>,
}

/// What an invocation left.
pub(super) struct Left {
    pub(super) given: Vec<u32>,
    pub(super) stored: Vec<u32>,
}

impl Lab {
    /// The unchanged shaders on whatever adapter there is, hardware before software; none where there is none and none
    /// is required.
    pub(super) fn open() -> Option<Self> {
        static GPU: OnceLock<Result<Mutex<Gpu>, GpuError>> = OnceLock::new();
        let opened = GPU.get_or_init(|| match adapters().first() {
            Some(report) => Gpu::open(Wanted::Named(&report.adapter.name)).map(Mutex::new),
            None => Err(GpuError::NoHardware { found: Vec::new() }),
        });
        match opened {
            Ok(gpu) => Some(Self { gpu, change: None }),
            Err(error) => {
                assert!(
                    std::env::var("URTS_REQUIRE_GPU").as_deref() != Ok("1"),
                    "URTS_REQUIRE_GPU=1, but {error}"
                );
                println!("SKIPPED: no adapter");
                None
            }
        }
    }

    /// The same device, and shaders with one change.
    pub(super) fn changed(&self, old: &'static str, new: &'static str) -> Self {
        Self {
            gpu: self.gpu,
            change: Some((old, new)),
        }
    }

    /// Whether shaders may have 64-bit integers here.
    pub(super) fn has_int64(&self) -> bool {
        self.gpu
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .has_int64()
    }

    /// What a probe leaves, of each invocation.
    pub(super) fn run(&self, job: &Job<'_>) -> Vec<Left> {
        let text = self.text(job);
        let words = job.shape.words();
        let (workgroup, drawn, stored) = (job.shape.workgroup(), words.drawn(), words.stored());
        assert!(
            job.cases.len().is_multiple_of(workgroup),
            "whole workgroups"
        );

        let mut draws = interleaved(job.cases, workgroup, drawn, |case| &case.drawn);
        for case in job.cases {
            draws.extend(&case.taken);
        }
        let state = interleaved(job.cases, workgroup, stored, |case| &case.stored);
        let results = vec![BLANK; job.cases.len() * job.given];

        let contents = [
            job.setting,
            bytemuck::bytes_of(&job.span),
            bytemuck::cast_slice(&draws),
            bytemuck::cast_slice(&state),
            bytemuck::cast_slice(job.table),
            bytemuck::cast_slice(&results),
        ];
        let [left, given] = self.dispatch(&text, contents, job.cases.len() / workgroup);
        (0..job.cases.len())
            .map(|case| {
                let first = case / workgroup * (stored * workgroup) + case % workgroup;
                Left {
                    given: given[case * job.given..][..job.given].to_vec(),
                    stored: (0..stored).map(|k| left[first + k * workgroup]).collect(),
                }
            })
            .collect()
    }

    /// Runs the entry point `probe` of a text with these contents of the bindings; what it leaves in the two that it
    /// may write: state and output.
    pub(super) fn dispatch(
        &self,
        text: &str,
        contents: [&[u8]; 6],
        workgroups: usize,
    ) -> [Vec<u32>; 2] {
        // One at a time: a device's errors and results are told to who happens to wait.
        let gpu = self.gpu.lock().unwrap_or_else(PoisonError::into_inner);
        let layout = binding_layout(&gpu);
        let [pipeline] = gpu.compile(text, &layout, ["probe"]).unwrap();
        let mut binding = 0;
        let buffers = contents.map(|bytes| {
            let usage = if binding < 2 {
                Use::Uniform
            } else {
                Use::Storage
            };
            binding += 1;
            let buffer = gpu.buffer(bytes.len().div_ceil(4), usage);
            gpu.queue.write_buffer(&buffer, 0, bytes);
            buffer
        });
        let entries: Vec<_> = (0..)
            .zip(&buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let bindings = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &entries,
        });
        gpu.submit(|encoder| {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bindings, &[0]);
            pass.dispatch_workgroups(word(workgroups), 1, 1);
        })
        .unwrap();
        [3, 5].map(|binding: usize| {
            let words = contents[binding].len() / 4;
            gpu.read(&buffers[binding], &gpu.buffer(words, Use::ReadBack), words)
                .unwrap()
        })
    }

    fn text(&self, job: &Job<'_>) -> String {
        let mut text = job.shape.text();
        if let Some((old, new)) = self.change {
            // In the text of another plant, it need not be there.
            assert!(text.matches(old).count() <= 1, "{old:?} is there once");
            text = text.replace(old, new);
        }
        let first = job.cases.len() * job.shape.words().drawn();
        let taken = job.cases[0].taken.len();
        format!(
            "{text}\n{PRELUDE}\nconst PROBE_FIRST = {first}u;\nconst PROBE_TAKEN = {taken}u;\n\
             const PROBE_GIVEN = {}u;\nconst PROBE_IMAGE = {}u;\n\
             fn load_metrics(first: u32) {{\n{}}}\nfn leave_metrics(first: u32) {{\n{}}}\n\
             fn probe_body(stage: u32, step: u32) {{\n{}\n}}\n",
            job.given,
            job.image,
            each_metric(|k, name| format!("{name} = taken_number(first + {k}u);\n")),
            each_metric(|k, name| format!("give_number(first + {k}u, {name});\n")),
            job.body
        )
    }
}

/// A statement for each metric that is kept, in the order of the image.
fn each_metric(statement: impl Fn(usize, String) -> String) -> String {
    let extremes = Extremes::<f32>::NAMES
        .iter()
        .map(|name| format!("largest.{name}"));
    let sums = Sums::<f32>::NAMES
        .iter()
        .map(|name| format!("recent.{name}"));
    let all = extremes.chain(sums).enumerate();
    all.map(|(k, name)| statement(k, name)).collect()
}

/// The words of all cases as the shaders keep them, `[workgroup][word][invocation]`.
fn interleaved(
    cases: &[Case],
    workgroup: usize,
    words: usize,
    of: impl Fn(&Case) -> &Vec<u32>,
) -> Vec<u32> {
    let mut all = vec![0; cases.len() * words];
    for (index, case) in cases.iter().enumerate() {
        let first = index / workgroup * (words * workgroup) + index % workgroup;
        for (k, &word) in of(case).iter().enumerate() {
            all[first + k * workgroup] = word;
        }
    }
    all
}

/// What a result must be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Expected {
    /// Anything: there is no twin.
    Any,
    /// These bits.
    Bits(u32),
    /// A number within its error.
    Near(Tracked),
    /// A step number within its error: -1 where there is none.
    Last(Tracked),
    /// A step number within its error: infinite where there is none.
    First(Tracked),
}

/// How a probe went.
#[derive(Debug, Default)]
pub(super) struct Compared {
    /// Results that had to be something.
    pub(super) words: usize,
    /// Largest difference of a number.
    pub(super) difference: f64,
    /// Largest share of its allowed error that a difference took.
    pub(super) share: f64,
    /// Numbers that a shader may round differently.
    pub(super) rounded: usize,
    /// Those of them whose allowed error is above [`LOOSE`].
    pub(super) loose: usize,
    /// What differed.
    pub(super) wrong: Vec<String>,
}

impl Expected {
    /// The word of this value.
    pub(super) fn word(self) -> u32 {
        match self {
            Self::Any => 0,
            Self::Bits(bits) => bits,
            Self::Near(number) => number.value.to_bits(),
            Self::Last(step) => (step.value as i32) as u32,
            Self::First(step) if step.value.is_finite() => step.value as u32,
            Self::First(_) => u32::MAX,
        }
    }
}

impl Compared {
    /// Takes in a result.
    pub(super) fn take(&mut self, expected: Expected, got: u32, at: impl Fn() -> String) {
        let holds = match expected {
            Expected::Any => return,
            Expected::Bits(bits) => bits == got,
            Expected::Near(number) => self.near(number, f32::from_bits(got)),
            Expected::Last(step) | Expected::First(step) => {
                expected.word() == got
                    || (f64::from(step.value) - f64::from(got as i32)).abs() <= step.error
            }
        };
        self.words += 1;
        if !holds {
            self.wrong.push(format!(
                "{}: {expected:?}, but the shader has {got:#010x} ({:?})",
                at(),
                f32::from_bits(got)
            ));
        }
    }

    /// Takes in how another part of a probe went.
    pub(super) fn add(&mut self, other: Self) {
        self.words += other.words;
        self.difference = self.difference.max(other.difference);
        self.share = self.share.max(other.share);
        self.rounded += other.rounded;
        self.loose += other.loose;
        self.wrong.extend(other.wrong);
    }

    fn near(&mut self, number: Tracked, got: f32) -> bool {
        self.rounded += usize::from(number.error > 0.0);
        self.loose += usize::from(number.error > LOOSE * f64::from(number.value.abs().max(1.0)));
        if number.value == got || (number.value.is_nan() && got.is_nan()) {
            return true;
        }
        let difference = (f64::from(number.value) - f64::from(got)).abs();
        if number.error > 0.0 {
            self.share = self.share.max(difference / number.error);
        }
        if difference <= number.error {
            self.difference = self.difference.max(difference);
        }
        // False if one of them is NaN, too.
        difference <= number.error
    }
}
