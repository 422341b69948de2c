//! What a campaign's signals are, but for their numbers: what the text of a shader depends on.

use crate::model::exogenous::ExogenousInputs;
use crate::model::exogenous::lists::{Item, LISTS, ListShape, SignalLists};
use crate::model::lanes::Lane;

/// What a campaign's signals are, but for their numbers: the same for every agent, episode and channel of a group.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Lists {
    /// How many items each of [`LISTS`] has.
    pub(crate) counts: [usize; LISTS.len()],
    /// The campaign's number of each noise and of each turbulence.
    pub(crate) noise_entries: Vec<u32>,
    pub(crate) turbulence_entries: Vec<u32>,
    /// How many frictions there are.
    pub(crate) frictions: usize,
    /// How many kinds of jets an agent feels.
    pub(crate) vortices: usize,
    /// The campaign's number of each burst, and whether it hits all channels of an agent together.
    pub(crate) bursts: Vec<(u32, bool)>,
    /// Whether each ring goes on recording while it plays: first those of commands, then those of measurements.
    pub(crate) rings: Vec<bool>,
    /// Samples that each ring has room for.
    pub(crate) ring_steps: usize,
    /// Steps for which a command is held.
    pub(crate) hold_steps: u32,
    /// [`ExogenousInputs::is_restless`], [`ExogenousInputs::remembers`], [`ExogenousInputs::carries`],
    /// [`ExogenousInputs::distorts`].
    pub(crate) restless: bool,
    pub(crate) remembers: bool,
    pub(crate) carries: bool,
    pub(crate) distorts: bool,
}

impl Lists {
    /// Those of signals that are listed as [`Selection::Possible`](crate::model::inputs::Selection), and of as many
    /// vortices; rings keep up to `ring_steps` samples.
    pub(crate) fn of<L: Lane, const NC: usize>(
        signals: &ExogenousInputs<L, NC>,
        vortices: usize,
        ring_steps: usize,
    ) -> Self {
        let (mut noise_entries, mut bursts, mut rings) = (Vec::new(), Vec::new(), Vec::new());
        for item in signals.lists.items() {
            match item {
                Item::Plain(_) | Item::Oscillation(_) => {}
                Item::Noise(noise) => noise_entries.push(noise.entry),
                Item::Intermittent(item) => bursts.push((item.entry, item.together)),
                Item::CommandLine(line) => rings.push(line.records),
                Item::MeasurementLine(line) => rings.push(line.records),
            }
        }
        Self {
            counts: signals.lists.counts(),
            noise_entries,
            turbulence_entries: signals.turbulences.iter().map(|of| of.entry).collect(),
            frictions: signals.frictions.len(),
            vortices,
            bursts,
            rings,
            ring_steps,
            hold_steps: signals.hold_steps,
            restless: signals.is_restless(),
            remembers: signals.remembers(),
            carries: signals.carries(),
            distorts: signals.distorts(),
        }
    }

    /// How many items the list of this name has.
    pub(crate) fn count(&self, name: &str) -> usize {
        let lists = LISTS.iter().zip(self.counts);
        lists
            .filter(|(list, _)| **list == name)
            .map(|(_, count)| count)
            .sum()
    }

    /// How many items the lists of this shape have.
    pub(crate) fn of_shape(&self, shape: ListShape) -> usize {
        let lists = SignalLists::<f32, 1>::SHAPES.iter().zip(self.counts);
        lists
            .filter(|(list, _)| **list == shape)
            .map(|(_, count)| count)
            .sum()
    }

    /// Whether commands leak from agent to agent.
    pub(crate) fn leaks(&self) -> bool {
        self.count("leaks") > 0
    }

    /// The number of a list's first switch.
    pub(crate) fn first(&self, list: usize) -> usize {
        self.counts[..list].iter().sum()
    }

    /// All switches.
    pub(crate) fn switches(&self) -> usize {
        self.first(LISTS.len())
    }

    /// Bursts, waves and rings.
    pub(crate) fn groups(&self) -> [usize; 3] {
        [
            ListShape::Intermittent,
            ListShape::Oscillation,
            ListShape::DelayLine,
        ]
        .map(|shape| self.of_shape(shape))
    }

    /// Words that all rings have in a channel's state.
    pub(crate) fn ring_words(&self) -> usize {
        (self.count("command_rings") + 2 * self.count("sensor_rings")) * self.ring_steps
    }
}
