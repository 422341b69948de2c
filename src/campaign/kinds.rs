//! The parameters of every kind of disturbance and fault, by name: one list serves validation, draws and tables.

use super::file::{DisturbanceKind, FaultKind, FaultTarget};
use super::parameter::{Bounds, Parameter, of_agent, required};
use super::time::Timing;
use crate::agent::{FIRST_ATTITUDE, HEIGHT};

const AMPLITUDE: Parameter = required("amplitude", Bounds::Any);
const FREQUENCY: Parameter = required("frequency_rad_s", Bounds::NonNegative);
const PHASE: Parameter = required("phase_rad", Bounds::Any).or(0.0);

/// Sizes of a jet in m: below a millimetre, squares of far distances would leave the singles.
const JET_SIZE: Bounds = Bounds::AtLeast(1e-3);

impl DisturbanceKind {
    /// The name of this kind in a campaign file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sine => "sine",
            Self::Constant => "constant",
            Self::Gust1Cosine => "gust-1-cosine",
            Self::Dryden => "dryden",
            Self::RotorVortex => "rotor-vortex",
            Self::GroundReaction => "ground-reaction",
        }
    }

    /// Whether it acts on a channel: wind does on those of translation alone, and jets blow downwards.
    #[must_use]
    pub fn acts_on(self, channel: usize) -> bool {
        match self {
            Self::Gust1Cosine | Self::Dryden => channel < FIRST_ATTITUDE,
            Self::RotorVortex => channel == HEIGHT,
            Self::Sine | Self::Constant | Self::GroundReaction => true,
        }
    }

    /// The parameters of this kind.
    #[must_use]
    pub fn parameters(self) -> &'static [Parameter] {
        match self {
            Self::Sine => &[AMPLITUDE, FREQUENCY, PHASE],
            Self::Constant => &[AMPLITUDE],
            Self::Gust1Cosine => {
                const {
                    &[
                        required("speed_m_s", Bounds::Any),
                        required("gain_n_s_m", Bounds::NonNegative),
                        of_agent("onset_s", Bounds::NonNegative).timed(Timing::Onset),
                        of_agent("duration_s", Bounds::Positive).timed(Timing::Length),
                    ]
                }
            }
            Self::Dryden => {
                const {
                    &[
                        of_agent("wind_m_s", Bounds::NonNegative),
                        of_agent("altitude_m", Bounds::Between(3.0, 305.0)),
                        of_agent("airspeed_m_s", Bounds::AtLeast(0.5)),
                        required("gain_n_s_m", Bounds::NonNegative),
                    ]
                }
            }
            Self::RotorVortex => {
                const {
                    &[
                        of_agent("force_n", Bounds::NonNegative),
                        of_agent("radius_m", JET_SIZE),
                        of_agent("length_m", JET_SIZE),
                    ]
                }
            }
            Self::GroundReaction => const { &[required("scale", Bounds::Any).or(1.0)] },
        }
    }
}

const MAGNITUDE: Parameter = required("magnitude", Bounds::Any);
/// Share of the command that does not reach the plant.
const LOST_SHARE: Parameter = required("magnitude", Bounds::Share);
/// Share by which a property of the plant grows; less than all of it may be lost.
const GROWTH: Parameter = of_agent("magnitude", Bounds::AtLeast(-0.9));
const PAYLOAD_MASS: Parameter = of_agent("mass_kg", Bounds::NonNegative);
const LARGEST_RATE: Parameter = required("rate", Bounds::NonNegative);
const DRIFT_RATE: Parameter = required("rate", Bounds::Any);
const STD: Parameter = required("std", Bounds::NonNegative);
const DELAY: Parameter = of_agent("delay_s", Bounds::Positive).timed(Timing::Length);
/// Length of the recording that is played again.
const WINDOW: Parameter = of_agent("window_s", Bounds::Positive).timed(Timing::Length);
const PERIOD: Parameter = required("period_s", Bounds::Positive);
const SMOOTHING: Parameter = required("smoothing", Bounds::AtLeast(1e-6));
/// Length of the slots of time that are hit or not.
const SLOT: Parameter = of_agent("burst_s", Bounds::Positive).timed(Timing::Length);
/// Share of the slots that are hit.
const SHARE: Parameter = of_agent("share", Bounds::Chance);
const OFFSET_X: Parameter = of_agent("offset_x_m", Bounds::Any);
const OFFSET_Y: Parameter = of_agent("offset_y_m", Bounds::Any);

/// What a kind of fault is: its name in a campaign file, what it strikes, its parameters.
type Described = (&'static str, &'static [FaultTarget], &'static [Parameter]);

impl FaultKind {
    /// All kinds.
    pub const ALL: [Self; 24] = [
        Self::LossOfEffectiveness,
        Self::Bias,
        Self::Stuck,
        Self::Float,
        Self::HardOver,
        Self::Oscillatory,
        Self::Intermittent,
        Self::RateLimit,
        Self::Delay,
        Self::Drift,
        Self::Scale,
        Self::Noise,
        Self::Freeze,
        Self::Dropout,
        Self::Outlier,
        Self::SmoothedSquare,
        Self::DenialOfService,
        Self::Replay,
        Self::Interference,
        Self::Mass,
        Self::Inertia,
        Self::CenterOfMass,
        Self::Payload,
        Self::FalseData,
    ];

    const fn described(self) -> Described {
        use FaultTarget::{Actuator, Network, Plant, Sensor};
        match self {
            Self::LossOfEffectiveness => ("loss-of-effectiveness", &[Actuator], &[LOST_SHARE]),
            Self::Bias => ("bias", &[Actuator, Sensor], &[MAGNITUDE]),
            Self::Stuck => ("stuck", &[Actuator], &[]),
            Self::Float => ("float", &[Actuator], &[]),
            Self::HardOver => ("hard-over", &[Actuator], &[MAGNITUDE]),
            Self::Oscillatory => (
                "oscillatory",
                &[Actuator, Sensor, Network],
                &[AMPLITUDE, FREQUENCY, PHASE],
            ),
            Self::Intermittent => ("intermittent", &[Actuator], &[LOST_SHARE, SLOT, SHARE]),
            Self::RateLimit => ("rate-limit", &[Actuator], &[LARGEST_RATE]),
            Self::Delay => ("delay", &[Actuator, Sensor, Network], &[DELAY]),
            Self::Drift => ("drift", &[Actuator, Sensor, Network], &[DRIFT_RATE]),
            Self::Scale => ("scale", &[Sensor], &[MAGNITUDE]),
            Self::Noise => ("noise", &[Sensor], &[STD]),
            Self::Freeze => ("freeze", &[Sensor], &[]),
            Self::Dropout => ("dropout", &[Sensor], &[SLOT, SHARE]),
            Self::Outlier => ("outlier", &[Sensor], &[AMPLITUDE, SHARE]),
            Self::SmoothedSquare => (
                "smoothed-square",
                &[Sensor],
                &[AMPLITUDE, PERIOD, SMOOTHING, PHASE],
            ),
            Self::FalseData => ("false-data", &[Network], &[MAGNITUDE]),
            Self::DenialOfService => ("denial-of-service", &[Network], &[SLOT, SHARE]),
            Self::Replay => ("replay", &[Network], &[WINDOW]),
            Self::Interference => ("interference", &[Network], &[MAGNITUDE]),
            Self::Mass => ("mass", &[Plant], &[GROWTH]),
            Self::Inertia => ("inertia", &[Plant], &[GROWTH]),
            Self::CenterOfMass => ("center-of-mass", &[Plant], &[OFFSET_X, OFFSET_Y]),
            Self::Payload => ("payload", &[Plant], &[PAYLOAD_MASS, OFFSET_X, OFFSET_Y]),
        }
    }

    /// The parameters of this kind.
    #[must_use]
    pub const fn parameters(self) -> &'static [Parameter] {
        self.described().2
    }

    /// The name of this kind in a campaign file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.described().0
    }

    /// Whether this kind can strike the target.
    #[must_use]
    pub fn strikes(self, target: FaultTarget) -> bool {
        self.described().1.contains(&target)
    }

    /// Whether it can come little by little.
    #[must_use]
    pub fn can_ramp(self) -> bool {
        match self {
            Self::LossOfEffectiveness
            | Self::Bias
            | Self::Float
            | Self::HardOver
            | Self::Oscillatory
            | Self::Intermittent
            | Self::Scale
            | Self::Noise
            | Self::Outlier
            | Self::SmoothedSquare
            | Self::FalseData
            | Self::Interference
            | Self::Mass
            | Self::Inertia
            | Self::CenterOfMass
            | Self::Payload => true,
            // These are there or not; a drift is a ramp.
            Self::Stuck
            | Self::RateLimit
            | Self::Delay
            | Self::Drift
            | Self::Freeze
            | Self::Dropout
            | Self::DenialOfService
            | Self::Replay => false,
        }
    }
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
