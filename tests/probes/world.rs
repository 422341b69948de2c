//! Teams of agents in random states: what probes of functions on private, workgroup and buffer state start from, on
//! both sides of the border.

use super::harness::{Case, Compared, Expected, Job, Lab, Left};
use super::image::{FAILED, image, image_words, stored};
use super::numbers::Numbers;
use super::tracked::Tracked;
use crate::backend::gpu::layout::{self, NEVER, Span};
use crate::backend::gpu::shape::Shape;
use crate::backend::gpu::uniforms::{GainsUniforms, PlantUniforms, SettingHead};
use crate::model::agent::GroupParameters;
use crate::model::controller::observer_feedback::ChannelGains;
use crate::model::integrator::Step;
use crate::model::lanes::MAX_WIDTH;
use crate::model::metric::Limits;
use crate::model::plant::kinds::PlantKind;
use crate::model::plant::{Plant, ReferenceRow};
use crate::model::team::TeamState;
use crate::random::philox::key;

/// The fewest invocations of a probe.
const CASES: usize = 400;
/// Purposes of random numbers.
const SETTING: u32 = 3;
const INPUT: u32 = 4;

/// A plant that worlds are made of.
pub(super) trait Flies<const NC: usize, const NX: usize>:
    Plant<Tracked, NC, NX> + PlantUniforms
{
}

impl<P: Plant<Tracked, NC, NX> + PlantUniforms, const NC: usize, const NX: usize> Flies<NC, NX>
    for P
{
}

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
    pub(super) group: TeamState<Tracked, NC, NS, NX>,
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
    /// Whether the whole state was left in the buffer, and not only what is always there.
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
            PlantKind::Translation | PlantKind::Thrust => 0,
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
    pub(super) fn setting<'t>(
        &self,
        table: &'t [ReferenceRow<f32>],
    ) -> GroupParameters<'t, P, ChannelGains<f32>, f32, NC> {
        GroupParameters {
            plant: self.plant,
            controller: self.gains,
            limits: self.limits,
            coupling: self.shape.coupling,
            measured_integral: self.shape.measured_integral,
            step_s: self.step_s,
            settle_step: self.settle_step,
            seed: self.seed,
            table,
        }
    }

    /// The bytes of the shaders' `GroupParameters`.
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
            bytes.extend(bytemuck::bytes_of(&GainsUniforms::from(
                &self.gains[3 * kind],
            )));
        }
        bytes
    }

    /// The step at which a scene is.
    pub(super) fn step(scene: usize) -> u32 {
        scene as u32 * 7 % 1000
    }

    fn scene(&self, scene: usize) -> TeamState<Tracked, NC, NS, NX> {
        let agents = (0..self.shape.team).map(|agent| self.agent(scene, agent));
        let mut group = TeamState::new(agents.collect(), [episode(scene); MAX_WIDTH], Vec::new());
        group.step = Self::step(scene);
        group
    }

    /// Runs a probe and compares all that it leaves with its twin: `asked` and `answers` are the numbers of the
    /// function's inputs and results, `inputs` makes the former, `twin` does to a scene what the body does.
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
        let image_words = image_words(&shape.lists);
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
                        drawn: layout::drawn(episode(index), &condition, channel),
                        stored: stored(made, channel, &shape.lists)
                            .into_iter()
                            .map(|(word, _)| word.word())
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
            assert_eq!(
                state.len() + answers.len(),
                left.given.len(),
                "all is applied_feedback"
            );
            for (k, &expected) in state.iter().enumerate() {
                compared.take(expected, left.given[k], || at("state", k));
            }
            for (k, &expected) in answers.iter().enumerate() {
                compared.take(expected, left.given[state.len() + k], || at("result", k));
            }
            let kept = stored(made, channel, &self.shape.lists);
            assert_eq!(
                kept.len(),
                self.shape.words().stored(),
                "all that is stored"
            );
            for (k, (expected, always)) in kept.into_iter().enumerate() {
                let expected = if scene.kept || always {
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
