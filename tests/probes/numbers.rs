//! Inputs of probes: the same in every run, and none of them trivial.

use crate::random::philox::{Address, Stream};

/// A sequence of random numbers.
pub(super) struct Numbers(Address);

impl Numbers {
    /// The sequence of a purpose, scene and agent.
    pub(super) fn new(purpose: u32, scene: usize, agent: usize) -> Self {
        Self(Address {
            episode: scene as u32,
            stream: Stream::Initial,
            entry: purpose,
            member: agent as u32,
            index: 0,
        })
    }

    fn words(&mut self) -> [u32; 4] {
        self.0.index += 1;
        self.0.words(20_260_201)
    }

    /// A random word.
    pub(super) fn word(&mut self) -> u32 {
        self.words()[0]
    }

    /// A number between two others.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (f64::from(self.word()) + 0.5) / 4_294_967_296.0;
        f64::from((low + (high - low) * unit) as f32)
    }

    /// A number of either sign, up to a size.
    pub(super) fn around(&mut self, size: f64) -> f64 {
        self.between(-size, size)
    }

    /// A number as a word.
    pub(super) fn single(&mut self, size: f64) -> u32 {
        (self.around(size) as f32).to_bits()
    }

    /// One of some values.
    pub(super) fn one_of<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.word() as usize % values.len()]
    }
}
