//! When a fault is there, and how much of it: from its onset on, to its end, rising along its ramp, and some faults
//! only now and then.
//!
//! All this is evaluated at the start of a step and held through its stages, or the method would lose its order.

use crate::model::lanes::{Lane, MAX_WIDTH};
use crate::random::philox::{Address, Stream};

/// A value that is there for a while.
#[derive(Clone, Copy)]
pub(crate) struct Window<L> {
    /// First step; infinite if it never comes.
    pub(crate) onset: L,
    /// First step after it; infinite if it stays.
    pub(crate) end: L,
    /// 1 / steps until all of it is there, the first included: 1 if it comes at once.
    pub(crate) inverse_ramp: L,
    /// The value.
    pub(crate) value: L,
}

/// A fault that is there now and then: time from its onset on is cut into slots, and each is hit with a probability.
#[derive(Clone)]
pub(crate) struct IntermittentWindow<L, const NC: usize> {
    /// Which fault of the campaign.
    pub(crate) entry: u32,
    /// Whether all channels of an agent are hit together.
    pub(crate) together: bool,
    /// Address of each channel; one for all where they are hit together.
    pub(crate) members: [u32; NC],
    /// The value, between onset and end.
    pub(crate) switch: [Window<L>; NC],
    /// Steps of a slot, of each lane.
    pub(crate) slot_steps: [[u32; MAX_WIDTH]; NC],
    /// A slot is hit if its random word does not exceed this.
    pub(crate) threshold: [[u32; MAX_WIDTH]; NC],
}

impl<L: Lane> Window<L> {
    /// A value that is always there.
    pub(crate) fn always(value: L) -> Self {
        Self {
            onset: L::number(0.0),
            end: L::number(f64::INFINITY),
            inverse_ramp: L::number(1.0),
            value,
        }
    }

    /// The share of the value that is there at a step.
    #[inline(always)]
    pub(crate) fn weight(self, step: L) -> L {
        let (zero, one) = (L::number(0.0), L::number(1.0));
        let risen = ((step - self.onset + one) * self.inverse_ramp).min(one);
        let begun = L::select_le(self.onset, step, risen, zero);
        L::select_le(self.end, step, zero, begun)
    }

    /// What is there at a step.
    #[inline(always)]
    pub(crate) fn at(self, step: L) -> L {
        self.weight(step) * self.value
    }
}

impl<L: Lane, const NC: usize> IntermittentWindow<L, NC> {
    /// What is there of a channel's value at step number `step`, and 1 or -1 by the toss of a coin for each slot.
    #[inline(always)]
    pub(crate) fn at(
        &self,
        channel: usize,
        step: u32,
        seed: u64,
        episodes: &[u32; MAX_WIDTH],
    ) -> [L; 2] {
        let switch = self.switch[channel];
        let mut onsets = [0.0; MAX_WIDTH];
        switch.onset.store(&mut onsets);
        let (mut hits, mut signs) = ([0.0; MAX_WIDTH], [1.0; MAX_WIDTH]);
        for lane in 0..L::WIDTH {
            // Before the onset the weight is zero, whatever the slot.
            let since = step.wrapping_sub(onset_step(onsets[lane]));
            let address = Address {
                episode: episodes[lane],
                stream: Stream::Intermittent,
                entry: self.entry,
                member: self.members[channel],
                index: since / self.slot_steps[channel][lane],
            };
            let words = address.words(seed);
            if words[0] <= self.threshold[channel][lane] {
                hits[lane] = 1.0;
            }
            if words[1] & 1 == 1 {
                signs[lane] = -1.0;
            }
        }
        let hit: L = L::load(&hits);
        [hit * switch.at(L::number(f64::from(step))), L::load(&signs)]
    }
}

/// A step as a number of 32 bits; the largest for one that never comes.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a step number, or infinity, which saturates"
)]
fn onset_step(onset: f64) -> u32 {
    onset as u32
}
