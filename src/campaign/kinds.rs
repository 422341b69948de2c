//! The kinds of disturbances and faults: one row each says its word in a campaign file, what it acts on, its parameters
//! and what else depends on the kind alone. What a kind does to an agent is in `model::inputs`.

use super::parameter::{Bounds, Parameter, Resolution, of_agent, required};
use super::time::Timing;
use crate::agent::{FIRST_ATTITUDE, HEIGHT};
use FaultTarget::{Actuator, Network, Plant, Sensor};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An enumeration of kinds from their rows.
macro_rules! kinds {
    ($(#[$outer:meta])* $kinds:ident: $row:ident {
        $($(#[doc = $doc:literal])+ $kind:ident, $name:literal { $($field:ident: $value:expr,)* })*
    }) => {
        $(#[$outer])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
        pub enum $kinds {
            $($(#[doc = $doc])+ #[serde(rename = $name)] $kind,)*
        }

        impl $kinds {
            /// All kinds.
            pub const ALL: &'static [Self] = &[$(Self::$kind),*];

            /// The name of this kind in a campaign file.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$kind => $name,)*
                }
            }

            fn row(self) -> &'static $row {
                match self {
                    $(Self::$kind => const { &$row { $($field: $value,)* } },)*
                }
            }

            /// The parameters of this kind.
            #[must_use]
            pub fn parameters(self) -> &'static [Parameter] {
                self.row().parameters
            }

            /// Whether (24) may be asked about it: whether it is known to be continuously differentiable in time where
            /// it neither begins nor ends within the run. A kind that nobody has examined is not.
            #[must_use]
            pub fn is_smooth(self) -> bool {
                self.row().is_smooth
            }
        }
    };
}

pub(crate) const AMPLITUDE: Parameter = required("amplitude", Bounds::Any);
pub(crate) const FREQUENCY: Parameter =
    required("frequency_rad_s", Bounds::NonNegative).resolved(Resolution::Frequency);
pub(crate) const PHASE: Parameter = required("phase_rad", Bounds::Any).or(0.0);
/// Share of a series that acts.
pub(crate) const SERIES_SHARE: Parameter = required("scale", Bounds::Any).or(1.0);
pub(crate) const GUST_SPEED: Parameter = required("speed_m_s", Bounds::Any);
/// Drag per speed of the wind.
pub(crate) const WIND_GAIN: Parameter = required("gain_n_s_m", Bounds::NonNegative);
pub(crate) const GUST_ONSET: Parameter =
    of_agent("onset_s", Bounds::NonNegative).timed(Timing::Onset);
pub(crate) const GUST_DURATION: Parameter = of_agent("duration_s", Bounds::Positive)
    .timed(Timing::Length)
    .resolved(Resolution::Period);
pub(crate) const MEAN_WIND: Parameter = of_agent("wind_m_s", Bounds::NonNegative);
pub(crate) const ALTITUDE: Parameter = of_agent("altitude_m", Bounds::Between(3.0, 305.0));
pub(crate) const AIRSPEED: Parameter = of_agent("airspeed_m_s", Bounds::AtLeast(0.5));
pub(crate) const COULOMB: Parameter = required("coulomb", Bounds::NonNegative);
pub(crate) const VISCOUS: Parameter = required("viscous", Bounds::NonNegative).or(0.0);
pub(crate) const SMOOTHING_RATE: Parameter =
    required("smoothing_rate", Bounds::AtLeast(1e-3)).or(0.05);
pub(crate) const JET_FORCE: Parameter = of_agent("force_n", Bounds::NonNegative);
pub(crate) const JET_RADIUS: Parameter = of_agent("radius_m", JET_SIZE);
pub(crate) const JET_LENGTH: Parameter = of_agent("length_m", JET_SIZE);

/// Sizes of a jet in m: below a millimetre, squares of far distances would leave the singles.
const JET_SIZE: Bounds = Bounds::AtLeast(1e-3);

/// The channels that a disturbance acts on.
enum Reach {
    All,
    Translation,
    Height,
}

/// What a disturbance acts on or comes from.
pub(super) enum Needs {
    /// Agents of any kind.
    Nothing,
    /// A walk, whose feet the ground answers.
    Walk,
    /// UAVs, on which wind acts.
    Uav,
    /// UAVs that are not alone.
    OtherUavs,
}

/// What a kind of disturbance is.
struct DisturbanceRow {
    reach: Reach,
    needs: Needs,
    parameters: &'static [Parameter],
    is_smooth: bool,
}

kinds! {
    /// Forms of a disturbance.
    DisturbanceKind: DisturbanceRow {
    /// amplitude sin(frequency t + phase).
    Sine, "sine" {
        reach: Reach::All,
        needs: Needs::Nothing,
        parameters: &[AMPLITUDE, FREQUENCY, PHASE],
        is_smooth: true,
    }
    /// A constant.
    Constant, "constant" {
        reach: Reach::All,
        needs: Needs::Nothing,
        parameters: &[AMPLITUDE],
        is_smooth: true,
    }
    /// - coulomb tanh(x' / smoothing_rate) - viscous x', at the true rate x' of each channel.
    Friction, "friction" {
        reach: Reach::All,
        needs: Needs::Nothing,
        parameters: &[COULOMB, VISCOUS, SMOOTHING_RATE],
        // Where an acceleration jumps, so does its rate.
        is_smooth: false,
    }
    /// UAV: gain speed (1 - cos(2 pi (t - onset) / duration)) / 2 while it lasts, on x, y and z.
    Gust1Cosine, "gust-1-cosine" {
        reach: Reach::Translation,
        needs: Needs::Uav,
        parameters: &[GUST_SPEED, WIND_GAIN, GUST_ONSET, GUST_DURATION],
        // It begins and ends with a rate of zero.
        is_smooth: true,
    }
    /// UAV: turbulence at low altitude (MIL-F-8785C) through a drag gain, on x (with the wind), y and z.
    Dryden, "dryden" {
        reach: Reach::Translation,
        needs: Needs::Uav,
        parameters: &[MEAN_WIND, ALTITUDE, AIRSPEED, WIND_GAIN],
        is_smooth: false,
    }
    /// UAV: the jets that the rotors of the others blow downwards. Who is w below another and rho beside it is pushed
    /// down by force p(rho / radius) v(2 w / length), where p(s) = 1 / (1 + 0.414 s^2)^2 and v(x) = 27/4 x^2 / (1 +
    /// x)^3.
    RotorVortex, "rotor-vortex" {
        reach: Reach::Height,
        needs: Needs::OtherUavs,
        parameters: &[JET_FORCE, JET_RADIUS, JET_LENGTH],
        // At the height of the rotors it begins with a rate of zero.
        is_smooth: true,
    }
    /// Biped: the torques J'f with which the ground answers the walk.
    GroundReaction, "ground-reaction" {
        reach: Reach::All,
        needs: Needs::Walk,
        parameters: &[SERIES_SHARE],
        // Feet lift and touch down.
        is_smooth: false,
    }
    }
}

impl DisturbanceKind {
    /// Whether it acts on a channel: wind does on those of translation alone, and jets blow downwards.
    #[must_use]
    pub fn acts_on(self, channel: usize) -> bool {
        match self.row().reach {
            Reach::All => true,
            Reach::Translation => channel < FIRST_ATTITUDE,
            Reach::Height => channel == HEIGHT,
        }
    }

    /// What it acts on or comes from.
    pub(super) fn needs(self) -> &'static Needs {
        &self.row().needs
    }
}

/// What fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FaultTarget {
    /// The command on its way to the plant.
    Actuator,
    /// The measurement where it is made.
    Sensor,
    /// A message between plant and controller.
    Network,
    /// The body that moves.
    Plant,
}

impl FaultTarget {
    /// The name of this target in a campaign file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Actuator => "actuator",
            Self::Sensor => "sensor",
            Self::Network => "network",
            Self::Plant => "plant",
        }
    }
}

pub(crate) const MAGNITUDE: Parameter = required("magnitude", Bounds::Any);
/// Share of the command that does not reach the plant.
pub(crate) const LOST_SHARE: Parameter = required("magnitude", Bounds::Share);
/// Share by which a property of the plant grows; less than all of it may be lost.
pub(crate) const GROWTH: Parameter = of_agent("magnitude", Bounds::AtLeast(-0.9));
pub(crate) const PAYLOAD_MASS: Parameter = of_agent("mass_kg", Bounds::NonNegative);
/// Up to which size a command gives nothing.
pub(crate) const HALF_WIDTH: Parameter = required("magnitude", Bounds::NonNegative);
pub(crate) const LARGEST_RATE: Parameter = required("rate", Bounds::NonNegative);
pub(crate) const DRIFT_RATE: Parameter = required("rate", Bounds::Any);
pub(crate) const STD: Parameter = required("std", Bounds::NonNegative);
pub(crate) const DELAY: Parameter = of_agent("delay_s", Bounds::Positive)
    .timed(Timing::Length)
    .resolved(Resolution::Memory);
/// Length of the recording that is played again.
pub(crate) const WINDOW: Parameter = of_agent("window_s", Bounds::Positive)
    .timed(Timing::Length)
    .resolved(Resolution::Memory);
pub(crate) const PERIOD: Parameter =
    required("period_s", Bounds::Positive).resolved(Resolution::Period);
pub(crate) const SMOOTHING: Parameter = required("smoothing", Bounds::AtLeast(1e-6));
/// Length of the slots of time that are hit or not.
pub(crate) const SLOT: Parameter = of_agent("burst_s", Bounds::Positive).timed(Timing::Length);
/// Share of the slots that are hit.
pub(crate) const SHARE: Parameter = of_agent("share", Bounds::Chance);
pub(crate) const OFFSET_X: Parameter = of_agent("offset_x_m", Bounds::Any);
pub(crate) const OFFSET_Y: Parameter = of_agent("offset_y_m", Bounds::Any);

/// What a kind of fault is.
struct FaultRow {
    /// What it can strike.
    strikes: &'static [FaultTarget],
    parameters: &'static [Parameter],
    /// Whether it can come little by little.
    can_ramp: bool,
    is_smooth: bool,
}

kinds! {
    /// How it fails.
    FaultKind: FaultRow {
    /// Actuator: (1 - magnitude) u.
    LossOfEffectiveness, "loss-of-effectiveness" {
        strikes: &[Actuator],
        parameters: &[LOST_SHARE],
        can_ramp: true,
        is_smooth: true,
    }
    /// Actuator or sensor: a constant offset.
    Bias, "bias" {
        strikes: &[Actuator, Sensor],
        parameters: &[MAGNITUDE],
        can_ramp: true,
        is_smooth: true,
    }
    /// Actuator: stays where it is.
    Stuck, "stuck" {
        strikes: &[Actuator],
        parameters: &[],
        can_ramp: false,
        is_smooth: false,
    }
    /// Actuator: gives nothing.
    Float, "float" {
        strikes: &[Actuator],
        parameters: &[],
        can_ramp: true,
        is_smooth: false,
    }
    /// Actuator: goes to a value of its own, `magnitude`.
    HardOver, "hard-over" {
        strikes: &[Actuator],
        parameters: &[MAGNITUDE],
        can_ramp: true,
        is_smooth: false,
    }
    /// Actuator, sensor or network: amplitude sin(frequency t + phase) is added.
    Oscillatory, "oscillatory" {
        strikes: &[Actuator, Sensor, Network],
        parameters: &[AMPLITUDE, FREQUENCY, PHASE],
        can_ramp: true,
        is_smooth: true,
    }
    /// Actuator: a loss of effectiveness in some slots of time.
    Intermittent, "intermittent" {
        strikes: &[Actuator],
        parameters: &[LOST_SHARE, SLOT, SHARE],
        can_ramp: true,
        is_smooth: false,
    }
    /// Actuator: what acts changes by at most `rate` per second, whatever arrives.
    RateLimit, "rate-limit" {
        strikes: &[Actuator],
        parameters: &[LARGEST_RATE],
        can_ramp: false,
        is_smooth: false,
    }
    /// Actuator: of what its other faults leave of the command, up to `magnitude` to either side gives nothing, and
    /// beyond it the rest acts.
    DeadZone, "dead-zone" {
        strikes: &[Actuator],
        parameters: &[HALF_WIDTH],
        can_ramp: true,
        is_smooth: false,
    }
    /// Actuator, sensor or network: the command, or x and x' without f2, arrives `delay_s` later.
    Delay, "delay" {
        strikes: &[Actuator, Sensor, Network],
        parameters: &[DELAY],
        can_ramp: false,
        is_smooth: false,
    }
    /// Actuator, sensor or network: an offset that grows by `rate` per second.
    Drift, "drift" {
        strikes: &[Actuator, Sensor, Network],
        parameters: &[DRIFT_RATE],
        can_ramp: false,
        is_smooth: false,
    }
    /// Sensor: x and x' are measured (1 + magnitude) times as large.
    Scale, "scale" {
        strikes: &[Sensor],
        parameters: &[MAGNITUDE],
        can_ramp: true,
        is_smooth: false,
    }
    /// Sensor: normal noise, held over a step.
    Noise, "noise" {
        strikes: &[Sensor],
        parameters: &[STD],
        can_ramp: true,
        is_smooth: false,
    }
    /// Sensor: shows the last x and x' for ever; what others add to the measurement (f2: bias, noise, outliers, false
    /// data) goes on.
    Freeze, "freeze" {
        strikes: &[Sensor],
        parameters: &[],
        can_ramp: false,
        is_smooth: false,
    }
    /// Sensor: shows the last x and x' in some slots of time; f2 goes on.
    Dropout, "dropout" {
        strikes: &[Sensor],
        parameters: &[SLOT, SHARE],
        can_ramp: false,
        is_smooth: false,
    }
    /// Sensor: in some steps the measurement is off by the amplitude, up or down.
    Outlier, "outlier" {
        strikes: &[Sensor],
        parameters: &[AMPLITUDE, SHARE],
        can_ramp: true,
        is_smooth: false,
    }
    /// Sensor: amplitude tanh(sin(2 pi t / period + phase) / smoothing).
    SmoothedSquare, "smoothed-square" {
        strikes: &[Sensor],
        parameters: &[AMPLITUDE, PERIOD, SMOOTHING, PHASE],
        can_ramp: true,
        is_smooth: true,
    }
    /// Network: an offset that an attacker adds.
    FalseData, "false-data" {
        strikes: &[Network],
        parameters: &[MAGNITUDE],
        can_ramp: true,
        is_smooth: true,
    }
    /// Network: in some slots of time nothing arrives, and the last command, or the last x and x' without f2, is held
    /// ahead of the faults of its receiver.
    DenialOfService, "denial-of-service" {
        strikes: &[Network],
        parameters: &[SLOT, SHARE],
        can_ramp: false,
        is_smooth: false,
    }
    /// Network: the commands, or x and x' without f2, recorded before the onset are played again and again.
    Replay, "replay" {
        strikes: &[Network],
        parameters: &[WINDOW],
        can_ramp: false,
        is_smooth: false,
    }
    /// Network: `magnitude` times the sum of the other agents' commands on this channel leaks into the command.
    Interference, "interference" {
        strikes: &[Network],
        parameters: &[MAGNITUDE],
        can_ramp: true,
        is_smooth: false,
    }
    /// Plant: the mass (of a biped, M and H) grows by this share.
    Mass, "mass" {
        strikes: &[Plant],
        parameters: &[GROWTH],
        can_ramp: true,
        is_smooth: true,
    }
    /// Plant: the inertia of a UAV grows by this share.
    Inertia, "inertia" {
        strikes: &[Plant],
        parameters: &[GROWTH],
        can_ramp: true,
        is_smooth: true,
    }
    /// Plant: the weight of a UAV acts beside its centre of thrust.
    CenterOfMass, "center-of-mass" {
        strikes: &[Plant],
        parameters: &[OFFSET_X, OFFSET_Y],
        can_ramp: true,
        is_smooth: true,
    }
    /// Plant: a point mass is hung on a UAV.
    Payload, "payload" {
        strikes: &[Plant],
        parameters: &[PAYLOAD_MASS, OFFSET_X, OFFSET_Y],
        can_ramp: true,
        is_smooth: true,
    }
    }
}

impl FaultKind {
    /// Whether this kind can strike the target.
    #[must_use]
    pub fn strikes(self, target: FaultTarget) -> bool {
        self.row().strikes.contains(&target)
    }

    /// Whether it can come little by little.
    #[must_use]
    pub fn can_ramp(self) -> bool {
        self.row().can_ramp
    }
}
