//! What travels to and from the shaders of a group of channels, as 32-bit words: the draws, the outcomes.

use super::shape::Shape;
use super::signals::Lists;
use crate::campaign::{AgentGroup, Time};
use crate::draw::Episode;
use crate::model::ChannelSample;
use crate::model::episode::AgentOutcome;
use crate::model::exogenous::friction::Friction;
use crate::model::exogenous::lists::{Item, LISTS, Oscillation};
use crate::model::inputs::{ChannelInputs, LaneBlock, Selection};
use crate::model::metric::{ChannelOutcome, Extremes, Metrics, Sums};
use crate::model::team::Ending;
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;
use std::ops::Range;

/// Words of the metrics in an outcome: extremes, then sums.
pub(crate) const N_EXTREMES: usize = Extremes::<f32>::NAMES.len();
pub(crate) const N_SUMS: usize = Sums::<f32>::NAMES.len();
/// Words of an outcome before its metrics: failed step, finite, last steps outside (two).
const VERDICT_WORDS: usize = 4;
/// Words of an outcome: the verdict, the metrics, and the episode.
pub(crate) const OUTCOME_WORDS: usize = VERDICT_WORDS + N_EXTREMES + N_SUMS + 1;
/// Words of a state in their order: the failed step, the last steps outside (two), extremes, recent sums, totals; then
/// the channel.
const LARGEST: usize = 3;
const RECENT: usize = LARGEST + N_EXTREMES;
const TOTALS: usize = RECENT + N_SUMS;
const CHANNEL: usize = TOTALS + N_SUMS;
/// Words of what a channel shows: the fields of [`ChannelSample`].
pub(crate) const SHOWN_WORDS: usize = 10;
/// A step that never comes.
pub(crate) const NEVER: u32 = u32::MAX;
/// Words of a draw before its signals: episode, int e, e, e', 1 / inertia, kappa, first fault, constant disturbance,
/// scale of the ground's reaction.
const FIXED_WORDS: usize = 9;
/// Words of a switch: onset, end, 1 / ramp, value.
const SWITCH_WORDS: usize = 4;
/// Words of a turbulence: keep, cross, noise (three), output (two), states at the start (two).
const TURBULENCE_WORDS: usize = 9;
/// Words of a friction: Coulomb's part, 1 / smoothing, the viscous part.
const FRICTION_WORDS: usize = 3;
/// Words of a vortex: force, 1 / radius, 2 / length.
const VORTEX_WORDS: usize = 3;
/// Words of a channel's memory, where it has one: last command, x and x' as last measured, feedback that is held, the
/// commands that were sent and that arrived last.
const MEMORY_WORDS: usize = 6;

/// Where the words of a channel are, in its draw and in its state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layout<'l> {
    lists: &'l Lists,
    states: usize,
}

impl<'l> Layout<'l> {
    pub(crate) fn new(lists: &'l Lists, states: usize) -> Self {
        Self { lists, states }
    }

    /// Words of a draw.
    pub(crate) fn drawn(self) -> usize {
        let [bursts, waves, rings] = self.lists.groups();
        let turbulences = self.lists.turbulence_entries.len();
        FIXED_WORDS
            + SWITCH_WORDS * self.lists.switches()
            + 2 * bursts
            + 3 * waves
            + rings
            + TURBULENCE_WORDS * turbulences
            + FRICTION_WORDS * self.lists.frictions
            + VORTEX_WORDS * self.lists.vortices
    }

    /// Words of a state: the verdict and the metrics, the channel, samples of noise, states of turbulence, memory and
    /// rings.
    pub(crate) fn stored(self) -> usize {
        self.rings_stored() + self.lists.ring_words()
    }

    fn memory(self) -> usize {
        let noises = self.lists.noise_entries.len();
        CHANNEL + self.states + 4 * noises + 2 * self.lists.turbulence_entries.len()
    }

    fn rings_stored(self) -> usize {
        self.memory()
            + if self.lists.remembers {
                MEMORY_WORDS
            } else {
                0
            }
    }

    /// Every place and count by its name in the shaders.
    pub(crate) fn named(self) -> Vec<(String, usize)> {
        let lists = self.lists;
        let [n_bursts, n_waves, n_rings] = lists.groups();
        let bursts = FIXED_WORDS + SWITCH_WORDS * lists.switches();
        let waves = bursts + 2 * n_bursts;
        let rings = waves + 3 * n_waves;
        let noises = lists.noise_entries.len();
        let turbulences = lists.turbulence_entries.len();
        let frictions = rings + n_rings + TURBULENCE_WORDS * turbulences;
        let mut named: Vec<(String, usize)> = [
            ("EPISODE", 0),
            ("INTEGRAL", 1),
            ("ERROR", 2),
            ("ERROR_RATE", 3),
            ("INVERSE_INERTIA", 4),
            ("KAPPA", 5),
            ("FIRST_FAULT", 6),
            ("CONSTANT", 7),
            ("GROUND", 8),
            ("SWITCHES", FIXED_WORDS),
            ("BURSTS", bursts),
            ("WAVES", waves),
            ("RINGS", rings),
            ("TURBULENCES", rings + n_rings),
            ("FRICTIONS", frictions),
            ("VORTICES", frictions + FRICTION_WORDS * lists.frictions),
            ("DRAWN_WORDS", self.drawn()),
            ("N_SWITCHES", lists.switches()),
            ("N_WAVES", n_waves),
            ("N_TURBULENCES", turbulences),
            ("N_FRICTIONS", lists.frictions),
            ("N_VORTICES", lists.vortices),
            ("FAILED", 0),
            ("OUTSIDE", 1),
            ("OUTSIDE_BEFORE_FAULT", 2),
            ("LARGEST", LARGEST),
            ("RECENT", RECENT),
            ("TOTALS", TOTALS),
            ("N_EXTREMES", N_EXTREMES),
            ("N_SUMS", N_SUMS),
            ("CHANNEL", CHANNEL),
            ("SAMPLES", CHANNEL + self.states),
            ("TURBULENCE_STATE", CHANNEL + self.states + 4 * noises),
            ("MEMORY", self.memory()),
            ("RINGS_STORED", self.rings_stored()),
            ("STORED_WORDS", self.stored()),
            ("RING_STEPS", lists.ring_steps),
            ("HOLD_STEPS", lists.hold_steps as usize),
        ]
        .map(|(name, value)| (name.to_string(), value))
        .to_vec();
        for (list, (name, count)) in LISTS.iter().zip(lists.counts).enumerate() {
            let name = name.to_uppercase();
            named.push((format!("N_{name}"), count));
            named.push((name, lists.first(list)));
        }
        named
    }
}

impl Shape {
    /// Where a channel's words are.
    pub(crate) fn words(&self) -> Layout<'_> {
        Layout::new(&self.lists, self.states())
    }
}

/// Twin of `Span` in shaders/episode.wgsl.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Span {
    pub(crate) first: u32,
    pub(crate) until: u32,
    pub(crate) table_first: u32,
    pub(crate) output_first: u32,
}

/// Calls a function with the number of a group's channels as its constant.
macro_rules! with_channels {
    ($channels:expr, $function:ident($($argument:expr),*)) => {
        match $channels {
            1 => $function::<1>($($argument),*),
            3 => $function::<3>($($argument),*),
            _ => $function::<6>($($argument),*),
        }
    };
}

/// The lists of a group's channels.
pub(crate) fn lists(group: &AgentGroup, channels: Range<usize>, episode: &Episode) -> Lists {
    with_channels!(channels.len(), lists_of(group, channels.start, episode))
}

fn lists_of<const NC: usize>(group: &AgentGroup, first: usize, episode: &Episode) -> Lists {
    let condition: ChannelInputs<f32, NC> = LaneBlock {
        group,
        episodes: std::slice::from_ref(episode),
    }
    .condition(0, first, Selection::Possible);
    Lists::of(
        &condition.signals,
        condition.vortices.len(),
        ring_steps(group),
    )
}

/// The longest past that a campaign's channels may have to remember, in steps.
fn ring_steps(group: &AgentGroup) -> usize {
    let parameters = group
        .faults
        .iter()
        .flat_map(|fault| fault.kind.parameters().iter().zip(&fault.parameters));
    let lengths = parameters
        .filter(|(parameter, _)| parameter.is_remembered())
        .map(|(_, length_s)| length_s);
    let longest_s = lengths
        .chain(&group.control.delay_s)
        .flat_map(|length_s| &length_s.distributions)
        .map(|length_s| length_s.support().1)
        .reduce(f64::max);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "validated to be small"
    )]
    longest_s.map_or(1, |longest_s| group.time.whole_steps(longest_s) as usize)
}

/// The draws of a group's channels, `[block of episodes][word][channel][agent][episode]`; the last block is filled up
/// with its last episode.
pub(crate) fn draws(
    group: &AgentGroup,
    shape: &Shape,
    first: usize,
    episodes: &[Episode],
) -> Vec<u32> {
    with_channels!(shape.channels, draws_of(group, shape, first, episodes))
}

fn draws_of<const NC: usize>(
    group: &AgentGroup,
    shape: &Shape,
    first: usize,
    episodes: &[Episode],
) -> Vec<u32> {
    let (workgroup, words) = (shape.workgroup(), shape.words().drawn());
    let blocks = episodes.len().div_ceil(shape.lanes);
    let mut all = vec![0; blocks * words * workgroup];
    all.par_chunks_mut(words * workgroup)
        .zip(episodes.par_chunks(shape.lanes))
        .for_each(|(out, episodes)| {
            for lane in 0..shape.lanes {
                let episode = &episodes[lane.min(episodes.len() - 1)];
                let block = LaneBlock {
                    group,
                    episodes: std::slice::from_ref(episode),
                };
                for agent in 0..shape.team {
                    let condition: ChannelInputs<f32, NC> =
                        block.condition(agent, first, Selection::Possible);
                    for channel in 0..NC {
                        let place = shape.place(channel, agent, lane);
                        let drawn = drawn(episode.index, &condition, channel);
                        for (k, word) in drawn.into_iter().enumerate() {
                            out[k * workgroup + place] = word;
                        }
                    }
                }
            }
        });
    all
}

/// The words of one channel's draw, in the order of [`Layout::named`].
pub(crate) fn drawn<const NC: usize>(
    episode: u32,
    condition: &ChannelInputs<f32, NC>,
    c: usize,
) -> Vec<u32> {
    let signals = &condition.signals;
    let [integral, error, rate] = condition.initial[c].map(f32::to_bits);
    let mut words = vec![
        episode,
        integral,
        error,
        rate,
        signals.first_inverse_inertia[c].to_bits(),
        condition.kappa.to_bits(),
        step(condition.first_fault),
        signals.constant[c].to_bits(),
        signals.ground[c].to_bits(),
    ];
    for item in signals.lists.items() {
        let window = item.window(c);
        let (ramp, value) = (window.inverse_ramp.to_bits(), window.value.to_bits());
        words.extend([step(window.onset), step(window.end), ramp, value]);
    }
    // Lists of one shape stand together, so each of these is the words of one shape.
    for item in signals.lists.items() {
        match item {
            Item::Plain(_) | Item::Noise(_) => {}
            Item::Intermittent(item) => {
                words.extend([item.slot_steps[c][0], item.threshold[c][0]]);
            }
            Item::Oscillation(waves) => {
                let Oscillation {
                    inverse_smoothing,
                    phase,
                    advance,
                    ..
                } = waves[c];
                words.extend([inverse_smoothing.to_bits(), phase, advance]);
            }
            Item::CommandLine(line) => words.push(line.length[c][0]),
            Item::MeasurementLine(line) => words.push(line.length[c][0]),
        }
    }
    for turbulence in &signals.turbulences {
        let filter = &turbulence.filter[c];
        let fixed = [filter.keep, filter.cross].into_iter();
        let numbers = fixed.chain(filter.noise).chain(filter.output);
        words.extend(numbers.chain(turbulence.state[c]).map(f32::to_bits));
    }
    for friction in &signals.frictions {
        let Friction {
            coulomb,
            inverse_smoothing,
            viscous,
        } = friction[c];
        words.extend([coulomb, inverse_smoothing, viscous].map(f32::to_bits));
    }
    for vortex in &condition.vortices {
        let numbers = [vortex.force, vortex.inverse_radius, vortex.inverse_length];
        words.extend(numbers.map(f32::to_bits));
    }
    words
}

/// Takes the outcome words of a group under one controller, `[block of episodes][word][channel][agent][episode]`, into
/// the outcomes of each episode's agents.
///
/// # Errors
/// If the words are not of these episodes: a dispatch was not carried out, or a buffer holds something else.
pub(crate) fn take_outcomes<'a>(
    group: &AgentGroup,
    shape: &Shape,
    first: usize,
    words: &[u32],
    outcomes: impl Iterator<Item = (u32, &'a mut Vec<AgentOutcome>)>,
) -> Result<(), String> {
    let workgroup = shape.workgroup();
    let outcomes: Vec<_> = outcomes.collect();
    let each = outcomes.into_par_iter().enumerate();
    each.try_for_each(|(index, (episode, agents))| {
        let (block, lane) = (index / shape.lanes, index % shape.lanes);
        let words = &words[block * OUTCOME_WORDS * workgroup..];
        for (agent, outcome) in agents.iter_mut().enumerate() {
            for channel in 0..shape.channels {
                let place = shape.place(channel, agent, lane);
                let word = |k: usize| words[k * workgroup + place];
                let marked = word(OUTCOME_WORDS - 1);
                if marked != episode {
                    return Err(format!(
                        "the outcome of episode {marked} stands in the place of episode {episode}"
                    ));
                }
                let (ending, metrics) = ended(group.time, word);
                outcome.take(first + channel, ending, metrics);
            }
        }
        Ok(())
    })
}

/// How a channel ended, from its outcome words.
fn ended(time: Time, word: impl Fn(usize) -> u32) -> (Ending, ChannelOutcome) {
    let number = |k: usize| f32::from_bits(word(k));
    let ending = Ending {
        failed_step: Some(word(0)).filter(|&step| step != NEVER),
        finite: word(1) != 0,
    };
    let metrics = Metrics::kept(
        |k| number(VERDICT_WORDS + k),
        [last_step(word(2)), last_step(word(3))],
    );
    let settled = time.steps.saturating_sub(time.settle_step);
    let mut taken = [ChannelOutcome::default()];
    metrics.outcomes(time.steps, settled, time.step_s, &mut taken);
    (ending, taken[0])
}

/// What a channel shows, from its words `[word][channel][agent][episode]`.
pub(crate) fn shown(words: &[u32], shape: &Shape, place: usize) -> ChannelSample {
    let number = |k: usize| f64::from(f32::from_bits(words[k * shape.workgroup() + place]));
    let [r, x, e, e_rate, e_hat, f1, f1_hat, f2, f2_hat, u] = std::array::from_fn(number);
    ChannelSample {
        r,
        x,
        e,
        e_rate,
        e_hat,
        f1,
        f1_hat,
        f2,
        f2_hat,
        u,
    }
}

/// A step number as the shaders count it.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a step number, or infinity"
)]
fn step(step: f32) -> u32 {
    if step.is_finite() { step as u32 } else { NEVER }
}

/// A last step as the lanes count it: -1 if there is none.
#[expect(
    clippy::cast_possible_wrap,
    clippy::cast_precision_loss,
    reason = "a step number below 2^24, or -1"
)]
fn last_step(word: u32) -> f32 {
    word as i32 as f32
}

/// A small count as a word.
pub(crate) fn word(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
