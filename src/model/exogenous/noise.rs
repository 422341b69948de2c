//! What is random in every step: the noise of a sensor, and turbulence, which is noise through a filter.

use super::window::Window;
use crate::model::lanes::{Lane, MAX_WIDTH};
use crate::random::philox::{Address, Stream};

/// Normal noise of one agent, held over each step.
#[derive(Clone)]
pub(crate) struct Noise<L, const NC: usize> {
    /// Which fault of the campaign.
    pub(crate) entry: u32,
    /// Address of each channel.
    pub(crate) members: [u32; NC],
    /// Standard deviation, while there is noise.
    pub(crate) switch: [Window<L>; NC],
    /// The samples of four steps: one counter gives them all.
    pub(crate) samples: [[L; 4]; NC],
}

/// Turbulence on one agent, held over each step: two states per channel that follow white noise,
/// z1' = (w - z1) / T and z2' = (z1 - z2) / T, sampled exactly.
#[derive(Clone)]
pub(crate) struct Turbulence<L, const NC: usize> {
    /// Which disturbance of the campaign.
    pub(crate) entry: u32,
    /// Address of each channel.
    pub(crate) members: [u32; NC],
    /// What is the same in every step.
    pub(crate) filter: [Filter<L>; NC],
    /// z1 and z2 at the start of the step.
    pub(crate) state: [[L; 2]; NC],
}

/// A step of the filter: z1 <- keep z1 + n1 and z2 <- keep z2 + cross z1 + n2, with (n1, n2) = noise (two normal
/// numbers); the force is output z.
#[derive(Clone, Copy)]
pub(crate) struct Filter<L> {
    pub(crate) keep: L,
    pub(crate) cross: L,
    /// The lower triangle: n1 by the first number; n2 by both.
    pub(crate) noise: [L; 3],
    pub(crate) output: [L; 2],
}

/// Two independent normal numbers from two random words of each lane (Box and Muller's transform).
#[inline(always)]
pub(crate) fn normal_pair<L: Lane>(word: &[u32], turn: &[u32]) -> [L; 2] {
    let radius = (L::unit_from_words(word).ln() * L::number(-2.0)).sqrt();
    let turn = L::turns_from_words(turn);
    let quarter = L::turns(&[0.25; MAX_WIDTH]);
    [
        radius * L::turns_sin(turn),
        radius * L::turns_sin(L::turns_add(turn, quarter)),
    ]
}

/// The random words of an address in every lane, `[word][lane]`.
#[inline(always)]
fn words_of<L: Lane>(
    address: Address,
    seed: u64,
    episodes: &[u32; MAX_WIDTH],
) -> [[u32; MAX_WIDTH]; 4] {
    let mut words = [[0; MAX_WIDTH]; 4];
    for lane in 0..L::WIDTH {
        let own = Address {
            episode: episodes[lane],
            ..address
        };
        let drawn = own.words(seed);
        for k in 0..4 {
            words[k][lane] = drawn[k];
        }
    }
    words
}

impl<L: Lane, const NC: usize> Noise<L, NC> {
    /// Draws the four samples of a channel that block number `index` holds.
    #[inline(always)]
    pub(crate) fn draw(
        &mut self,
        channel: usize,
        index: u32,
        seed: u64,
        episodes: &[u32; MAX_WIDTH],
    ) {
        let address = Address {
            episode: 0,
            stream: Stream::Noise,
            entry: self.entry,
            member: self.members[channel],
            index,
        };
        let words = words_of::<L>(address, seed, episodes);
        let [first, second] = normal_pair(&words[0], &words[1]);
        let [third, fourth] = normal_pair(&words[2], &words[3]);
        self.samples[channel] = [first, second, third, fourth];
    }
}

impl<L: Lane, const NC: usize> Turbulence<L, NC> {
    /// The force on a channel in this step.
    #[inline(always)]
    pub(crate) fn force(&self, channel: usize) -> L {
        let [z1, z2] = self.state[channel];
        let [by_z1, by_z2] = self.filter[channel].output;
        z1.mul_add(by_z1, z2 * by_z2)
    }

    /// Moves a channel from step number `step` to the next.
    #[inline(always)]
    pub(crate) fn advance(
        &mut self,
        channel: usize,
        step: u32,
        seed: u64,
        episodes: &[u32; MAX_WIDTH],
    ) {
        let address = Address {
            episode: 0,
            stream: Stream::Turbulence,
            entry: self.entry,
            member: self.members[channel],
            index: step,
        };
        let words = words_of::<L>(address, seed, episodes);
        let [first, second] = normal_pair::<L>(&words[0], &words[1]);
        let filter = &self.filter[channel];
        let [z1, z2] = self.state[channel];
        let [n11, n21, n22] = filter.noise;
        let pushed = first.mul_add(n21, second * n22);
        let carried = z1.mul_add(filter.cross, pushed);
        self.state[channel] = [
            z1.mul_add(filter.keep, first * n11),
            z2.mul_add(filter.keep, carried),
        ];
    }
}
