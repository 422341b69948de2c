//! The lists of everything that switches on an agent's channels. This is the one place that names a list; what walks
//! all lists, the words of the shaders and their constants among it, follows from it.

use super::delay_line::DelayLine;
use super::noise::Noise;
use super::window::{IntermittentWindow, Window};
use crate::model::lanes::Lane;

/// A periodic signal; its list says of what shape.
#[derive(Clone, Copy)]
pub(crate) struct Oscillation<L: Lane> {
    /// Amplitude, while it is there.
    pub(crate) switch: Window<L>,
    /// 1 / smoothing of a square; nothing to the others.
    pub(crate) inverse_smoothing: L,
    pub(crate) phase: L::Turns,
    /// Turns per half step.
    pub(crate) advance: L::Turns,
    /// The amplitude of this step.
    pub(crate) held: L,
}

/// The sine of a wave's phase, half a step later if it is to `advance`.
#[inline(always)]
pub(crate) fn turned<L: Lane>(wave: &mut Oscillation<L>, advance: bool) -> L {
    if advance {
        wave.phase = L::turns_add(wave.phase, wave.advance);
    }
    L::turns_sin(wave.phase)
}

/// What the items of a list have beside their windows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ListShape {
    Plain,
    Noise,
    Intermittent,
    Oscillation,
    DelayLine,
}

/// An item of some list.
#[derive(Clone, Copy)]
pub(crate) enum Item<'a, L: Lane, const NC: usize> {
    Plain(&'a [Window<L>; NC]),
    Noise(&'a Noise<L, NC>),
    Intermittent(&'a IntermittentWindow<L, NC>),
    Oscillation(&'a [Oscillation<L>; NC]),
    CommandLine(&'a DelayLine<L, NC, 1>),
    MeasurementLine(&'a DelayLine<L, NC, 2>),
}

impl<L: Lane, const NC: usize> Item<'_, L, NC> {
    /// The window of a channel.
    pub(crate) fn window(&self, c: usize) -> Window<L> {
        match self {
            Self::Plain(windows) => windows[c],
            Self::Noise(noise) => noise.switch[c],
            Self::Intermittent(item) => item.switch[c],
            Self::Oscillation(waves) => waves[c].switch,
            Self::CommandLine(line) => line.switch[c],
            Self::MeasurementLine(line) => line.switch[c],
        }
    }
}

/// What may be in a list.
trait Listed<L: Lane, const NC: usize> {
    const SHAPE: ListShape;
    fn item(&self) -> Item<'_, L, NC>;
}

macro_rules! listed {
    ($item:ty, $shape:ident, $variant:ident) => {
        impl<L: Lane, const NC: usize> Listed<L, NC> for $item {
            const SHAPE: ListShape = ListShape::$shape;
            fn item(&self) -> Item<'_, L, NC> {
                Item::$variant(self)
            }
        }
    };
}
listed!([Window<L>; NC], Plain, Plain);
listed!(Noise<L, NC>, Noise, Noise);
listed!(IntermittentWindow<L, NC>, Intermittent, Intermittent);
listed!([Oscillation<L>; NC], Oscillation, Oscillation);
listed!(DelayLine<L, NC, 1>, DelayLine, CommandLine);
listed!(DelayLine<L, NC, 2>, DelayLine, MeasurementLine);

macro_rules! signal_lists {
    ($($(#[$doc:meta])* $list:ident: $item:ty,)*) => {
        /// All lists. Each has an item per campaign entry that strikes these channels, so what a campaign does not use
        /// is not there.
        #[derive(Clone)]
        pub(crate) struct SignalLists<L: Lane, const NC: usize> {
            $($(#[$doc])* pub(crate) $list: Vec<$item>,)*
        }

        /// The names of the lists in their order, which is that of the windows in the shaders.
        pub(crate) const LISTS: &[&str] = &[$(stringify!($list)),*];

        impl<L: Lane, const NC: usize> SignalLists<L, NC> {
            /// The shape of each list.
            pub(crate) const SHAPES: &'static [ListShape] =
                &[$(<$item as Listed<L, NC>>::SHAPE),*];

            /// No signal at all.
            pub(crate) fn none() -> Self {
                Self { $($list: Vec::new(),)* }
            }

            /// All items, list by list.
            pub(crate) fn items(&self) -> impl Iterator<Item = Item<'_, L, NC>> {
                std::iter::empty()$(.chain(self.$list.iter().map(Listed::item)))*
            }

            /// How many items each list has.
            pub(crate) fn counts(&self) -> [usize; LISTS.len()] {
                [$(self.$list.len()),*]
            }
        }
    };
}

// The shaders count windows through all lists, so lists of one shape stand together.
signal_lists! {
    /// Lost shares of the command.
    losses: [Window<L>; NC],
    /// Commands that replace the demanded one.
    hard_overs: [Window<L>; NC],
    command_biases: [Window<L>; NC],
    /// Shares of the other agents' commands that leak in.
    leaks: [Window<L>; NC],
    /// Largest changes of the command per step.
    rate_limits: [Window<L>; NC],
    /// Sizes up to which a command gives nothing.
    dead_zones: [Window<L>; NC],
    /// By what share x and x' are measured too large.
    scales: [Window<L>; NC],
    sensor_biases: [Window<L>; NC],
    /// By what share of its first value the inertia grows.
    inertias: [Window<L>; NC],
    /// Forces that come with a shifted mass.
    weights: [Window<L>; NC],
    noises: Noise<L, NC>,
    /// Lost shares of the command, now and then.
    intermittents: IntermittentWindow<L, NC>,
    /// When the link brings no new command (the value is 1).
    command_holds: IntermittentWindow<L, NC>,
    /// When the measurement stays what it was (the value is 1).
    sensor_holds: IntermittentWindow<L, NC>,
    /// Sizes of measurements that are far off.
    outliers: IntermittentWindow<L, NC>,
    /// amplitude sin(phase), part of d1.
    sines: [Oscillation<L>; NC],
    /// amplitude (1 + sin(phase)) / 2, part of d1; one turn of it is a gust, if it begins at the bottom.
    gusts: [Oscillation<L>; NC],
    /// amplitude sin(phase), added to the command.
    command_waves: [Oscillation<L>; NC],
    /// amplitude sin(phase), part of f2.
    sensor_waves: [Oscillation<L>; NC],
    /// amplitude tanh(sin(phase) / smoothing), part of f2.
    squares: [Oscillation<L>; NC],
    command_rings: DelayLine<L, NC, 1>,
    /// Of x and x'.
    sensor_rings: DelayLine<L, NC, 2>,
}

/// How many lists of oscillations there are.
pub(crate) const WAVE_LISTS: usize = {
    let shapes = SignalLists::<f32, 1>::SHAPES;
    let (mut list, mut count) = (0, 0);
    while list < shapes.len() {
        count += matches!(shapes[list], ListShape::Oscillation) as usize;
        list += 1;
    }
    count
};

impl<L: Lane, const NC: usize> SignalLists<L, NC> {
    /// The lists of oscillations: one that is forgotten here does not compile.
    #[inline(always)]
    pub(crate) fn waves_mut(&mut self) -> [&mut Vec<[Oscillation<L>; NC]>; WAVE_LISTS] {
        [
            &mut self.sines,
            &mut self.gusts,
            &mut self.command_waves,
            &mut self.sensor_waves,
            &mut self.squares,
        ]
    }
}
