//! What travels to and from the shaders of a group of channels, as 32-bit words: the draws, the outcomes.

use super::shader::Shape;
use crate::campaign::{Campaign, Time};
use crate::draw::Episode;
use crate::model::Shown;
use crate::model::condition::{Block, Condition, Entries};
use crate::model::episode::{AgentOutcome, PlantKind};
use crate::model::group::Ending;
use crate::model::metric::{ChannelOutcome, Metrics};
use crate::model::signal::{Signals, Switch};
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

/// Words of an outcome: failed step, finite, last steps outside (two), largest error and command, six sums, episode.
pub(crate) const OUTCOME_WORDS: usize = 13;
/// Words of what a channel shows: the fields of [`Shown`].
pub(crate) const SHOWN_WORDS: usize = 10;
/// A step that never comes.
pub(crate) const NEVER: u32 = u32::MAX;
/// Words of a draw before its signals: episode, int e, e, e', 1 / inertia, kappa, first fault, constant disturbance, scale of
/// the ground's reaction.
const FIXED_WORDS: usize = 9;

/// How many signals of each kind a channel has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) losses: usize,
    pub(crate) command_biases: usize,
    pub(crate) sensor_biases: usize,
    pub(crate) noises: usize,
    pub(crate) squares: usize,
    pub(crate) sines: usize,
}

impl Counts {
    /// The signals of a campaign's agents; all have the same, if listed as [`Entries::Possible`].
    pub(crate) fn of<const NC: usize>(signals: &Signals<f32, NC>) -> Self {
        Self {
            losses: signals.losses.len(),
            command_biases: signals.command_biases.len(),
            sensor_biases: signals.sensor_biases.len(),
            noises: signals.noises.len(),
            squares: signals.squares.len(),
            sines: signals.sines.len(),
        }
    }

    fn switches(self) -> usize {
        self.losses + self.command_biases + self.sensor_biases + self.noises + self.squares
    }
}

/// Where the words of a channel are, in its draw and in its state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Words {
    counts: Counts,
    states: usize,
}

impl Words {
    pub(crate) fn new(counts: Counts, states: usize) -> Self {
        Self { counts, states }
    }

    /// Words of a draw.
    pub(crate) fn drawn(self) -> usize {
        FIXED_WORDS + 2 * self.counts.switches() + 3 * (self.counts.sines + self.counts.squares)
    }

    /// Words of a state: five of the verdict and the extremes, recent and total sums, the channel's own, samples of noise.
    pub(crate) fn stored(self) -> usize {
        17 + self.states + 4 * self.counts.noises
    }

    /// Every place and count by its name in the shaders. Switches have two words each, and are counted through.
    pub(crate) fn named(self) -> Vec<(&'static str, usize)> {
        let counts = self.counts;
        let command_biases = counts.losses;
        let sensor_biases = command_biases + counts.command_biases;
        let noises = sensor_biases + counts.sensor_biases;
        let squares = noises + counts.noises;
        let sines = FIXED_WORDS + 2 * counts.switches();
        vec![
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
            ("LOSSES", 0),
            ("COMMAND_BIASES", command_biases),
            ("SENSOR_BIASES", sensor_biases),
            ("NOISES", noises),
            ("SQUARE_SWITCHES", squares),
            ("SINES", sines),
            ("SQUARES", sines + 3 * counts.sines),
            ("DRAWN_WORDS", self.drawn()),
            ("N_SWITCHES", counts.switches()),
            ("N_LOSSES", counts.losses),
            ("N_COMMAND_BIASES", counts.command_biases),
            ("N_SENSOR_BIASES", counts.sensor_biases),
            ("N_NOISES", counts.noises),
            ("N_SQUARES", counts.squares),
            ("N_SINES", counts.sines),
            ("FAILED", 0),
            ("OUTSIDE", 1),
            ("OUTSIDE_BEFORE_FAULT", 2),
            ("LARGEST", 3),
            ("LARGEST_COMMAND", 4),
            ("RECENT", 5),
            ("TOTALS", 11),
            ("CHANNEL", 17),
            ("SAMPLES", 17 + self.states),
            ("STORED_WORDS", self.stored()),
        ]
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

/// The signals of a group's channels, which are the same for every agent and episode of the campaign.
pub(crate) fn signals<const NC: usize>(
    campaign: &Campaign,
    first: usize,
    episode: &Episode,
) -> (Counts, Vec<u32>) {
    let condition: Condition<f32, NC> = Block {
        campaign,
        episodes: std::slice::from_ref(episode),
    }
    .condition(0, first, Entries::Possible);
    let entries = condition.signals.noises.iter().map(|noise| noise.entry);
    (Counts::of(&condition.signals), entries.collect())
}

/// The draws of a group's channels, `[block of episodes][word][channel][agent][episode]`; the last block is filled up with
/// its last episode.
pub(crate) fn draws(
    campaign: &Campaign,
    shape: &Shape,
    first: usize,
    episodes: &[Episode],
) -> Vec<u32> {
    match shape.plant {
        PlantKind::Axis => draws_of::<1>(campaign, shape, first, episodes),
        PlantKind::Attitude => draws_of::<3>(campaign, shape, first, episodes),
        PlantKind::Thrust | PlantKind::Leg => draws_of::<6>(campaign, shape, first, episodes),
    }
}

fn draws_of<const NC: usize>(
    campaign: &Campaign,
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
                let block = Block {
                    campaign,
                    episodes: std::slice::from_ref(episode),
                };
                for agent in 0..shape.team {
                    let condition: Condition<f32, NC> =
                        block.condition(agent, first, Entries::Possible);
                    for channel in 0..NC {
                        let place = shape.place(channel, agent, lane);
                        for (k, word) in drawn(episode.index, &condition, channel).enumerate() {
                            out[k * workgroup + place] = word;
                        }
                    }
                }
            }
        });
    all
}

/// The words of one channel's draw, in the order of [`Words::named`].
pub(crate) fn drawn<const NC: usize>(
    episode: u32,
    condition: &Condition<f32, NC>,
    c: usize,
) -> impl Iterator<Item = u32> {
    let signals = &condition.signals;
    let [integral, error, rate] = condition.initial[c].map(f32::to_bits);
    let switch = |switch: Switch<f32>| [step(switch.onset), switch.value.to_bits()];
    [
        episode,
        integral,
        error,
        rate,
        condition.inverse_inertia[c].to_bits(),
        condition.kappa.to_bits(),
        step(condition.first_fault),
        signals.constant[c].to_bits(),
        signals.ground[c].to_bits(),
    ]
    .into_iter()
    .chain(
        [
            &signals.losses,
            &signals.command_biases,
            &signals.sensor_biases,
        ]
        .into_iter()
        .flatten()
        .flat_map(move |switches| switch(switches[c])),
    )
    .chain(
        signals
            .noises
            .iter()
            .flat_map(move |noise| switch(noise.switch[c])),
    )
    .chain(
        signals
            .squares
            .iter()
            .flat_map(move |square| switch(square[c].switch)),
    )
    .chain(
        signals
            .sines
            .iter()
            .map(move |sine| sine[c])
            .flat_map(|sine| [sine.amplitude.to_bits(), sine.phase, sine.advance]),
    )
    .chain(
        signals
            .squares
            .iter()
            .map(move |square| square[c])
            .flat_map(|square| {
                [
                    square.inverse_smoothing.to_bits(),
                    square.phase,
                    square.advance,
                ]
            }),
    )
}

/// Takes the outcome words of a group under one controller, `[block of episodes][word][channel][agent][episode]`, into the
/// outcomes of each episode's agents.
///
/// # Errors
/// If the words are not of these episodes: a dispatch was not carried out, or a buffer holds something else.
pub(crate) fn take_outcomes<'a>(
    campaign: &Campaign,
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
                if word(12) != episode {
                    return Err(format!(
                        "the outcome of episode {} stands in the place of episode {episode}",
                        word(12)
                    ));
                }
                let (ending, metrics) = ended(campaign.time, word);
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
        std::array::from_fn(|k| number(6 + k)),
        [number(4), number(5)],
        [last_step(word(2)), last_step(word(3))],
    );
    let settled = time.steps.saturating_sub(time.settle_step);
    let mut taken = [ChannelOutcome::default()];
    metrics.outcomes(time.steps, settled, time.step_s, &mut taken);
    (ending, taken[0])
}

/// What a channel shows, from its words `[word][channel][agent][episode]`.
pub(crate) fn shown(words: &[u32], shape: &Shape, place: usize) -> Shown {
    let number = |k: usize| f64::from(f32::from_bits(words[k * shape.workgroup() + place]));
    let [r, x, e, e_rate, e_hat, f1, f1_hat, f2, f2_hat, u] = std::array::from_fn(number);
    Shown {
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
