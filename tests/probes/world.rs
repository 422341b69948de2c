//! Teams of agents in random states: what probes of functions on private, workgroup and buffer state start from, on both
//! sides of the border.

use super::harness::{Case, Compared, Expected, Job, Lab, Left};
use super::image::{FAILED, FIXED_IMAGE, image, stored};
use super::numbers::Numbers;
use super::tracked::Tracked;
use crate::backend::gpu::setting::{GainsWords, PlantWords, SettingHead};
use crate::backend::gpu::shader::Shape;
use crate::backend::gpu::words::{self, NEVER, Span};
use crate::draw::member;
use crate::model::condition::Condition;
use crate::model::controller::ChannelGains;
use crate::model::episode::PlantKind;
use crate::model::group::{Agent, Group, Setting};
use crate::model::integrator::Step;
use crate::model::lanes::{Lane, MAX_WIDTH};
use crate::model::metric::{Limits, Sums};
use crate::model::plant::{Plant, ReferenceRow};
use crate::model::rng::key;
use crate::model::signal::{Noise, Signals, Sine, Square, Switch};

/// The fewest invocations of a probe.
const CASES: usize = 400;
/// Purposes of random numbers.
const CONDITION: u32 = 1;
const STATE: u32 = 2;
const SETTING: u32 = 3;
const INPUT: u32 = 4;

/// A plant that worlds are made of.
pub(super) trait Flies<const NC: usize, const NX: usize>:
    Plant<Tracked, NC, NX> + PlantWords
{
}

impl<P: Plant<Tracked, NC, NX> + PlantWords, const NC: usize, const NX: usize> Flies<NC, NX> for P {}

/// Scenes of one shape: a scene is a team in one episode.
pub(super) struct World<P, const NC: usize, const NS: usize, const NX: usize> {
    pub(super) shape: Shape,
    pub(super) plant: P,
    pub(super) gains: [ChannelGains<f32>; NC],
    pub(super) limits: [Limits<f32>; NC],
    pub(super) step_s: f64,
    pub(super) settle_step: u32,
    pub(super) seed: u64,
    pub(super) first: usize,
    pub(super) span: Span,
    pub(super) table: Vec<ReferenceRow<f32>>,
    /// Whether some agents are far away or not finite.
    pub(super) lost: bool,
}

/// One scene while a probe's twin acts on it.
pub(super) struct Scene<const NC: usize, const NS: usize, const NX: usize> {
    pub(super) group: Group<Tracked, NC, NS, NX>,
    /// Its number, counted through all workgroups.
    pub(super) index: usize,
    pub(super) stage: usize,
    pub(super) step: u32,
    /// Inputs of the function, `[agent][channel]`.
    pub(super) asked: Vec<[Vec<u32>; NC]>,
    /// Its results.
    pub(super) answers: Vec<[Vec<Expected>; NC]>,
    /// When the held signals change next, if the probe tells.
    pub(super) next_change: Vec<[Expected; NC]>,
    /// Whether the whole state was left in the buffer, and not the sums and samples alone.
    pub(super) kept: bool,
}

impl<const NC: usize, const NS: usize, const NX: usize> Scene<NC, NS, NX> {
    /// Does something for every agent and channel.
    pub(super) fn each(&mut self, mut act: impl FnMut(&mut Self, usize, usize)) {
        for agent in 0..self.asked.len() {
            for channel in 0..NC {
                act(self, agent, channel);
            }
        }
    }

    /// An input of the function.
    pub(super) fn word(&self, agent: usize, channel: usize, k: usize) -> u32 {
        self.asked[agent][channel][k]
    }

    /// The same as a number.
    pub(super) fn number(&self, agent: usize, channel: usize, k: usize) -> Tracked {
        Tracked::exact(f32::from_bits(self.word(agent, channel, k)))
    }

    /// Some of them from the first on.
    pub(super) fn numbers<const N: usize>(&self, agent: usize, channel: usize) -> [Tracked; N] {
        std::array::from_fn(|k| self.number(agent, channel, k))
    }

    /// A result of the function.
    pub(super) fn answer(&mut self, agent: usize, channel: usize, expected: Expected) {
        self.answers[agent][channel].push(expected);
    }

    /// A number that is a result of the function.
    pub(super) fn answer_number(&mut self, agent: usize, channel: usize, number: Tracked) {
        self.answer(agent, channel, Expected::Near(number));
    }
}

impl<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize> World<P, NC, NS, NX> {
    /// A world of a plant; the gains of position and of attitude are two sets, as everywhere.
    pub(super) fn new(shape: Shape, plant: P) -> Self {
        let mut numbers = Numbers::new(SETTING, shape.team, NC);
        let mut some = |size: f64| numbers.around(size) as f32;
        let kinds: [ChannelGains<f32>; 2] = std::array::from_fn(|_| ChannelGains {
            feedback: std::array::from_fn(|_| some(3.0)),
            injection: std::array::from_fn(|_| std::array::from_fn(|_| some(5.0))),
            smoothing: std::array::from_fn(|_| some(4.0)),
            sensor_fault_input: std::array::from_fn(|_| some(1.0)),
        });
        let first = match shape.plant {
            PlantKind::Axis => 2,
            PlantKind::Attitude => 3,
            PlantKind::Thrust => 0,
            PlantKind::Leg => 6,
        };
        // A span that crosses a flush, a settle step within it, and the table's window ahead of it.
        let span = Span {
            first: 253,
            until: 258,
            table_first: 3,
            output_first: 0,
        };
        let instants = 3 + 2 * (span.until - span.first) as usize + 1;
        let table = (0..instants * shape.table_rows())
            .map(|_| std::array::from_fn(|_| some(1.0)))
            .collect();
        Self {
            gains: std::array::from_fn(|c| {
                kinds[usize::from(shape.plant == PlantKind::Thrust && c >= 3)]
            }),
            limits: std::array::from_fn(|c| {
                Limits::new(0.4 + 0.1 * c as f64, 0.2 + 0.05 * c as f64)
            }),
            step_s: 0.01,
            settle_step: 255,
            seed: 0x1234_5678_9abc_def0,
            first,
            span,
            table,
            lost: false,
            shape,
            plant,
        }
    }

    /// Constants of the group, with a reference table.
    pub(super) fn setting<'t>(&self, table: &'t [ReferenceRow<f32>]) -> Setting<'t, P, f32, NC> {
        Setting {
            plant: self.plant,
            gains: self.gains,
            limits: self.limits,
            coupled: self.shape.coupled,
            step_s: self.step_s,
            settle_step: self.settle_step,
            seed: self.seed,
            table,
        }
    }

    /// The bytes of the shaders' `Setting`.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let h = Step::<f32>::new(self.step_s);
        let head = SettingHead {
            seed: key(self.seed),
            settle_step: self.settle_step,
            first_channel: self.first as u32,
            h: [h.sixth, h.third, h.half, h.whole],
        };
        let mut bytes = bytemuck::bytes_of(&head).to_vec();
        bytes.extend(self.plant.bytes());
        for limits in self.limits {
            let limits = [limits.max_error, limits.settled_error, 0.0, 0.0];
            bytes.extend(bytemuck::bytes_of(&limits));
        }
        for kind in 0..self.shape.kinds() {
            bytes.extend(bytemuck::bytes_of(&GainsWords::from(&self.gains[3 * kind])));
        }
        bytes
    }

    /// The step at which a scene is.
    fn step(scene: usize) -> u32 {
        scene as u32 * 7 % 1000
    }

    /// What an agent meets: signals of every kind that the shape has, switching around the scene's step and in its span.
    pub(super) fn condition<L: Lane<Real = f32>>(
        &self,
        scene: usize,
        agent: usize,
    ) -> Condition<L, NC> {
        let mut numbers = Numbers::new(CONDITION, scene, agent);
        let counts = self.shape.counts;
        let step = Self::step(scene);
        let onsets = [
            0.0,
            f64::from(step),
            f64::from(step + 1),
            254.0,
            256.0,
            f64::INFINITY,
        ];
        let mut signals = Signals::none();
        let some = &mut |low, high| L::number(numbers.between(low, high));
        signals.constant = std::array::from_fn(|_| some(-0.5, 0.5));
        signals.ground = std::array::from_fn(|_| some(-1.0, 1.0));
        let switches = |numbers: &mut Numbers, low: f64, high: f64| -> [Switch<L>; NC] {
            std::array::from_fn(|_| Switch {
                onset: L::number(numbers.one_of(&onsets)),
                value: L::number(numbers.between(low, high)),
            })
        };
        let numbers = &mut numbers;
        for _ in 0..counts.losses {
            signals.losses.push(switches(numbers, 0.0, 0.9));
        }
        for _ in 0..counts.command_biases {
            signals.command_biases.push(switches(numbers, -0.5, 0.5));
        }
        for _ in 0..counts.sensor_biases {
            signals.sensor_biases.push(switches(numbers, -0.5, 0.5));
        }
        for &entry in &self.shape.noise_entries {
            signals.noises.push(Noise {
                entry,
                members: std::array::from_fn(|c| member(agent, self.first + c)),
                switch: switches(numbers, 0.1, 0.5),
                samples: std::array::from_fn(|_| {
                    std::array::from_fn(|_| L::number(numbers.around(2.0)))
                }),
            });
        }
        for _ in 0..counts.squares {
            let switch = switches(numbers, -1.0, 1.0);
            signals.squares.push(std::array::from_fn(|c| Square {
                switch: switch[c],
                inverse_smoothing: L::number(numbers.between(1.0, 50.0)),
                phase: L::turns_from_words(&[numbers.word()]),
                advance: L::turns_from_words(&[numbers.word()]),
                held: L::number(numbers.around(1.0)),
            }));
        }
        for _ in 0..counts.sines {
            signals.sines.push(std::array::from_fn(|_| Sine {
                amplitude: L::number(numbers.around(1.0)),
                phase: L::turns_from_words(&[numbers.word()]),
                advance: L::turns_from_words(&[numbers.word()]),
            }));
        }
        Condition {
            initial: std::array::from_fn(|_| {
                std::array::from_fn(|_| L::number(numbers.around(1.0)))
            }),
            signals,
            inverse_inertia: std::array::from_fn(|_| L::number(numbers.between(0.3, 3.0))),
            kappa: L::number(numbers.around(0.1)),
            first_fault: L::number(numbers.one_of(&onsets)),
        }
    }

    /// An agent in a random state.
    fn agent(&self, scene: usize, agent: usize) -> Agent<Tracked, NC, NS, NX> {
        let mut numbers = Numbers::new(STATE, scene, agent);
        let mut some = |size: f64| Tracked::number(numbers.around(size));
        let mut made = Agent::new(
            std::array::from_fn(|_| std::array::from_fn(|_| some(1.0))),
            self.condition(scene, agent),
        );
        for channel in &mut made.channels {
            channel.point = channel.point.map(|_| some(1.0));
            channel.sum = channel.sum.map(|_| some(1.0));
        }
        let extra = &mut made.extra;
        for states in [&mut extra.start, &mut extra.point, &mut extra.sum] {
            *states = states.map(|_| some(0.8));
        }
        let signals = &mut made.signals;
        for held in [
            &mut signals.held_sensor,
            &mut signals.command_gain,
            &mut signals.command_bias,
            &mut signals.disturbance,
            &mut signals.sensor_fault,
        ] {
            *held = held.map(|_| some(1.0));
        }
        for metrics in &mut made.metrics {
            for sums in [&mut metrics.recent, &mut metrics.total] {
                *sums = Sums {
                    square: some(9.0).abs(),
                    absolute: some(9.0).abs(),
                    effort: some(9.0).abs(),
                    actuator_fault: some(9.0).abs(),
                    sensor_fault: some(9.0).abs(),
                    limited: some(200.0).abs().floor(),
                };
            }
            metrics.largest = some(1.0).abs();
            metrics.largest_command = some(1.0).abs();
            metrics.outside = some(250.0).floor().max(Tracked::exact(-1.0));
            metrics.outside_before_fault = some(250.0).floor().max(Tracked::exact(-1.0));
        }
        made.failed = Tracked::number(numbers.one_of(&[0.0, 100.0, 900.0, f64::INFINITY]));
        if self.lost && scene.is_multiple_of(2) {
            let place = [
                1e30,
                -1e30,
                1e15,
                f64::INFINITY,
                f64::NEG_INFINITY,
                f64::NAN,
            ];
            for channel in &mut made.channels {
                channel.start[1] = Tracked::number(numbers.one_of(&place));
                channel.point[1] = Tracked::number(numbers.one_of(&place));
            }
        }
        made
    }

    fn scene(&self, scene: usize) -> Group<Tracked, NC, NS, NX> {
        let agents = (0..self.shape.team).map(|agent| self.agent(scene, agent));
        let mut group = Group::new(agents.collect(), [episode(scene); MAX_WIDTH], Vec::new());
        group.step = Self::step(scene);
        group
    }

    /// Runs a probe and compares all that it leaves with its twin: `asked` and `answers` are the numbers of the function's
    /// inputs and results, `inputs` makes the former, `twin` does to a scene what the body does.
    pub(super) fn check(
        &self,
        lab: &Lab,
        body: &str,
        answers: usize,
        inputs: impl Fn(&mut Numbers, usize) -> Vec<u32>,
        twin: impl Fn(&mut Scene<NC, NS, NX>),
    ) -> Compared {
        let shape = &self.shape;
        let blocks = CASES.div_ceil(shape.workgroup()).next_multiple_of(4);
        let counts = shape.counts;
        let image_words = FIXED_IMAGE + counts.sines + 2 * counts.squares;
        let mut scenes: Vec<Scene<NC, NS, NX>> = (0..blocks * shape.lanes)
            .map(|scene| Scene {
                group: self.scene(scene),
                index: scene,
                stage: scene / shape.lanes % 4,
                step: Self::step(scene),
                asked: (0..shape.team)
                    .map(|agent| {
                        let mut numbers = Numbers::new(INPUT, scene, agent);
                        std::array::from_fn(|channel| inputs(&mut numbers, channel))
                    })
                    .collect(),
                answers: vec![std::array::from_fn(|_| Vec::new()); shape.team],
                next_change: vec![[Expected::Any; NC]; shape.team],
                kept: false,
            })
            .collect();
        let mut cases = vec![Case::default(); blocks * shape.workgroup()];
        for (index, scene) in scenes.iter().enumerate() {
            for (agent, made) in scene.group.agents.iter().enumerate() {
                let condition = self.condition::<f32>(index, agent);
                for channel in 0..NC {
                    let before = image(made, channel, Expected::Bits(NEVER));
                    let asked = &scene.asked[agent][channel];
                    cases[self.case(index, channel, agent)] = Case {
                        drawn: words::drawn(episode(index), &condition, channel).collect(),
                        stored: stored(made, channel)
                            .into_iter()
                            .map(Expected::word)
                            .collect(),
                        taken: before
                            .into_iter()
                            .map(Expected::word)
                            .chain(asked.iter().copied())
                            .collect(),
                    };
                }
            }
        }
        let left = lab.run(&Job {
            shape,
            setting: &self.bytes(),
            span: self.span,
            table: &self.table,
            body: &format!("{body}\nleave();"),
            image: image_words,
            cases: &cases,
            given: image_words + answers,
        });
        let mut compared = Compared::default();
        for (index, scene) in scenes.iter_mut().enumerate() {
            twin(scene);
            for agent in 0..shape.team {
                self.compare(scene, agent, &cases, &left, index, &mut compared);
            }
        }
        compared
    }

    fn compare(
        &self,
        scene: &Scene<NC, NS, NX>,
        agent: usize,
        cases: &[Case],
        left: &[Left],
        index: usize,
        compared: &mut Compared,
    ) {
        let made = &scene.group.agents[agent];
        let mut failed = NEVER;
        for channel in 0..NC {
            let at = |what: &str, k: usize| {
                format!(
                    "{what} {k}, scene {index}, agent {agent}, channel {channel}, stage {}, step {}",
                    scene.stage, scene.step
                )
            };
            let case = self.case(index, channel, agent);
            let (before, left) = (&cases[case].stored, &left[case]);
            let mut state = image(made, channel, scene.next_change[agent][channel]);
            // The shaders tell of each channel when it failed, the twin of all at once.
            state[FAILED] = Expected::Any;
            failed = failed.min(left.given[FAILED]);
            let answers = &scene.answers[agent][channel];
            assert_eq!(state.len() + answers.len(), left.given.len(), "all is told");
            for (k, &expected) in state.iter().enumerate() {
                compared.take(expected, left.given[k], || at("state", k));
            }
            for (k, &expected) in answers.iter().enumerate() {
                compared.take(expected, left.given[state.len() + k], || at("result", k));
            }
            let kept = stored(made, channel);
            assert_eq!(kept.len(), before.len(), "all that is stored");
            let sums_and_samples =
                |k: usize| (11..17).contains(&k) || k >= 17 + self.shape.states();
            for (k, expected) in kept.into_iter().enumerate() {
                let expected = if scene.kept || sums_and_samples(k) {
                    expected
                } else {
                    Expected::Bits(before[k])
                };
                compared.take(expected, left.stored[k], || at("stored word", k));
            }
        }
        compared.take(Expected::First(made.failed), failed, || {
            format!("first failed step, scene {index}, agent {agent}")
        });
    }

    fn case(&self, scene: usize, channel: usize, agent: usize) -> usize {
        let (block, lane) = (scene / self.shape.lanes, scene % self.shape.lanes);
        block * self.shape.workgroup() + self.shape.place(channel, agent, lane)
    }
}

/// The number of a scene's episode.
pub(super) fn episode(scene: usize) -> u32 {
    1000 + scene as u32
}
