//! What a campaign's signals are, but for their numbers: what the text of a shader depends on.

use crate::model::exogenous::window::{IntermittentWindow, Window};
use crate::model::exogenous::{ExogenousInputs, Oscillation};
use crate::model::lanes::Lane;

/// The lists of what switches, in their order: switches are counted through, so those of bursts, of waves and of rings
/// lie together.
pub(crate) const LISTS: [&str; 21] = [
    "LOSSES",
    "HARD_OVERS",
    "COMMAND_BIASES",
    "LEAKS",
    "RATE_LIMITS",
    "SCALES",
    "SENSOR_BIASES",
    "INERTIAS",
    "WEIGHTS",
    "NOISES",
    "INTERMITTENTS",
    "COMMAND_HOLDS",
    "SENSOR_HOLDS",
    "OUTLIERS",
    "SINES",
    "GUSTS",
    "COMMAND_WAVES",
    "SENSOR_WAVES",
    "SQUARES",
    "COMMAND_RINGS",
    "SENSOR_RINGS",
];
/// The list of leaks.
const LEAKS: usize = 3;
/// The first list of bursts, of waves and of rings.
const BURSTS: usize = 10;
const WAVES: usize = 14;
const RINGS: usize = 19;
/// Lists of waves, each of which has a loop of its own wherever signals are evaluated.
pub(super) const WAVE_LISTS: usize = RINGS - WAVES;

/// What a campaign's signals are, but for their numbers: the same for every agent, episode and channel of a group.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Lists {
    /// How many items each of [`LISTS`] has.
    pub(crate) counts: [usize; LISTS.len()],
    /// The campaign's number of each noise and of each turbulence.
    pub(crate) noise_entries: Vec<u32>,
    pub(crate) turbulence_entries: Vec<u32>,
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

/// All switches of a channel, `[list][item]`.
pub(crate) fn switches<L: Lane, const NC: usize>(
    signals: &ExogenousInputs<L, NC>,
    c: usize,
) -> [Vec<Window<L>>; LISTS.len()] {
    let plain = |list: &[[Window<L>; NC]]| list.iter().map(|item| item[c]).collect();
    let bursts =
        |list: &[IntermittentWindow<L, NC>]| list.iter().map(|item| item.switch[c]).collect();
    let waves = |list: &[[Oscillation<L>; NC]]| list.iter().map(|item| item[c].switch).collect();
    [
        plain(&signals.losses),
        plain(&signals.hard_overs),
        plain(&signals.command_biases),
        plain(&signals.leaks),
        plain(&signals.rate_limits),
        plain(&signals.scales),
        plain(&signals.sensor_biases),
        plain(&signals.inertias),
        plain(&signals.weights),
        signals.noises.iter().map(|noise| noise.switch[c]).collect(),
        bursts(&signals.intermittents),
        bursts(&signals.command_holds),
        bursts(&signals.sensor_holds),
        bursts(&signals.outliers),
        waves(&signals.sines),
        waves(&signals.gusts),
        waves(&signals.command_waves),
        waves(&signals.sensor_waves),
        waves(&signals.squares),
        signals
            .command_rings
            .iter()
            .map(|ring| ring.switch[c])
            .collect(),
        signals
            .sensor_rings
            .iter()
            .map(|ring| ring.switch[c])
            .collect(),
    ]
}

/// All bursts, in the order of their switches.
pub(crate) fn bursts<L: Lane, const NC: usize>(
    signals: &ExogenousInputs<L, NC>,
) -> impl Iterator<Item = &IntermittentWindow<L, NC>> {
    let lists = [
        &signals.intermittents,
        &signals.command_holds,
        &signals.sensor_holds,
        &signals.outliers,
    ];
    lists.into_iter().flatten()
}

/// All waves, in the order of their switches.
pub(crate) fn waves<L: Lane, const NC: usize>(
    signals: &ExogenousInputs<L, NC>,
) -> impl Iterator<Item = &[Oscillation<L>; NC]> {
    let lists = [
        &signals.sines,
        &signals.gusts,
        &signals.command_waves,
        &signals.sensor_waves,
        &signals.squares,
    ];
    lists.into_iter().flatten()
}

impl Lists {
    /// Those of signals that are listed as [`Selection::Possible`](crate::model::inputs::Selection), and of as many
    /// vortices; rings keep up to `ring_steps` samples.
    pub(crate) fn of<L: Lane, const NC: usize>(
        signals: &ExogenousInputs<L, NC>,
        vortices: usize,
        ring_steps: usize,
    ) -> Self {
        let of_commands = signals.command_rings.iter().map(|ring| ring.records);
        let of_sensors = signals.sensor_rings.iter().map(|ring| ring.records);
        Self {
            counts: switches(signals, 0).map(|list| list.len()),
            noise_entries: signals.noises.iter().map(|noise| noise.entry).collect(),
            turbulence_entries: signals.turbulences.iter().map(|of| of.entry).collect(),
            vortices,
            bursts: bursts(signals)
                .map(|burst| (burst.entry, burst.together))
                .collect(),
            rings: of_commands.chain(of_sensors).collect(),
            ring_steps,
            hold_steps: signals.hold_steps,
            restless: signals.is_restless(),
            remembers: signals.remembers(),
            carries: signals.carries(),
            distorts: signals.distorts(),
        }
    }

    /// Whether commands leak from agent to agent.
    pub(crate) fn leaks(&self) -> bool {
        self.counts[LEAKS] > 0
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
        [BURSTS..WAVES, WAVES..RINGS, RINGS..LISTS.len()]
            .map(|lists| self.counts[lists].iter().sum())
    }

    /// Words that all rings have in a channel's state.
    pub(crate) fn ring_words(&self) -> usize {
        (self.counts[RINGS] + 2 * self.counts[RINGS + 1]) * self.ring_steps
    }
}
