//! The plants, one row each: what the loop and the shaders have to know of a plant beside its equations.

use super::biped::LegPlant;
use super::uav::{Attitude, Axis, Thrust, Translation};

/// What holds a group of channels together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PlantKind {
    /// One axis of translation, fully actuated.
    Axis,
    /// All three of them, where rotor vortices make distances matter.
    Translation,
    /// The attitude, fully actuated.
    Attitude,
    /// All channels of a UAV, with thrust along the body axis.
    Thrust,
    /// A leg of a biped.
    Leg,
}

/// What a plant is, but for its numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlantSpec {
    /// Its name in the shaders.
    pub(crate) name: &'static str,
    /// Channels of its group.
    pub(crate) channels: usize,
    /// States of its own that each channel keeps.
    pub(crate) own_states: usize,
    /// Numbers that a channel shows to the others of its group.
    pub(crate) shared: usize,
    /// Kinds of its channels, each with gains of its own.
    pub(crate) kinds: usize,
    /// Whether its commands have limits, whose excess is counted.
    pub(crate) limited: bool,
}

impl PlantSpec {
    /// One without limits and states of its own, all of whose channels are alike.
    const fn free(name: &'static str, channels: usize, shared: usize) -> Self {
        Self {
            name,
            channels,
            own_states: 0,
            shared,
            kinds: 1,
            limited: false,
        }
    }
}

/// States that the command filter adds to a channel under thrust: its angle and rate.
pub(crate) const FILTER_STATES: usize = 2;

impl PlantKind {
    /// All kinds, in their order.
    pub(crate) const ALL: [Self; 5] = [
        Self::Axis,
        Self::Translation,
        Self::Attitude,
        Self::Thrust,
        Self::Leg,
    ];

    /// What this kind is.
    pub(crate) const fn spec(self) -> PlantSpec {
        match self {
            Self::Axis => PlantSpec::free("AXIS", 1, 1),
            Self::Translation => PlantSpec::free("TRANSLATION", 3, 1),
            Self::Attitude => PlantSpec::free("ATTITUDE", 3, 2),
            Self::Thrust => PlantSpec {
                name: "THRUST",
                channels: 6,
                own_states: FILTER_STATES,
                shared: 6,
                kinds: 2,
                limited: true,
            },
            Self::Leg => PlantSpec {
                name: "LEG",
                channels: 6,
                own_states: 0,
                shared: 7,
                kinds: 1,
                limited: true,
            },
        }
    }
}

/// A plant with its numbers.
#[derive(Clone, Copy)]
pub(crate) enum AnyPlant<R> {
    Axis(Axis<R>),
    Translation(Translation<R>),
    Attitude(Attitude<R>),
    Thrust(Thrust<R>),
    /// A leg whose commands have no limits.
    FreeLeg(LegPlant<R, false>),
    /// A leg whose commands are cut.
    CutLeg(LegPlant<R, true>),
}

impl<R> AnyPlant<R> {
    /// What it is.
    pub(crate) fn kind(&self) -> PlantKind {
        match self {
            Self::Axis(_) => PlantKind::Axis,
            Self::Translation(_) => PlantKind::Translation,
            Self::Attitude(_) => PlantKind::Attitude,
            Self::Thrust(_) => PlantKind::Thrust,
            Self::FreeLeg(_) | Self::CutLeg(_) => PlantKind::Leg,
        }
    }
}

/// Evaluates an expression with a plant of its own type, and with constants for its channels and for the states that it
/// has beside theirs.
macro_rules! with_plant {
    ($any:expr, |$plant:ident, $channels:ident, $states:ident| $body:expr) => {
        with_plant!(@rows $any, $plant, $channels, $states, $body,
            Axis 1 0, Translation 3 0, Attitude 3 0, Thrust 6 4, FreeLeg 6 0, CutLeg 6 0)
    };
    (
        @rows $any:expr, $plant:ident, $channels:ident, $states:ident, $body:expr,
        $($row:ident $count:literal $own:literal),*
    ) => {
        match $any {
            $(AnyPlant::$row($plant) => {
                const $channels: usize = $count;
                const $states: usize = $own;
                $body
            })*
        }
    };
}
pub(crate) use with_plant;
