//! `[[disturbance]]` and `[[fault]]` as they are written.

use super::value::{ChannelsFile, Value, some_tables, some_word, word};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[[disturbance]]`
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DisturbanceFile {
    /// Form of the disturbance.
    #[serde(deserialize_with = "word")]
    pub kind: DisturbanceKind,
    /// Amplitude or constant value, N or N m.
    pub amplitude: Option<Value>,
    /// Sine: angular frequency, rad/s.
    pub frequency_rad_s: Option<Value>,
    /// Sine: phase at t = 0, rad (default 0).
    pub phase_rad: Option<Value>,
    /// Ground reaction: share of the series that acts (default 1).
    pub scale: Option<Value>,
    /// Gust: its largest speed along the channel, m/s.
    pub speed_m_s: Option<Value>,
    /// Gust and turbulence: drag per speed, N s/m.
    pub gain_n_s_m: Option<Value>,
    /// Gust: beginning, s.
    pub onset_s: Option<Value>,
    /// Gust: length, s.
    pub duration_s: Option<Value>,
    /// Turbulence: mean wind 6 m above the ground, m/s.
    pub wind_m_s: Option<Value>,
    /// Turbulence: instead of wind_m_s, that of light (15 kn), moderate (30 kn) or severe (45 kn) turbulence.
    #[serde(default, deserialize_with = "some_word")]
    pub intensity: Option<IntensityKind>,
    /// Turbulence: height above the ground, m; 3 to 305.
    pub altitude_m: Option<Value>,
    /// Turbulence: speed against the air, m/s; at least 0.5, for the model does not hold in still air.
    pub airspeed_m_s: Option<Value>,
    /// Rotor vortex: the largest force of one jet on the agent, N.
    pub force_n: Option<Value>,
    /// Rotor vortex: how far from a jet's axis half of the force is felt, m; at least 0.001.
    pub radius_m: Option<Value>,
    /// Rotor vortex: how far below the rotors a jet is felt most, m; at least 0.001.
    pub length_m: Option<Value>,
    /// Blocks that override the keys above, one per agent.
    #[serde(default, deserialize_with = "some_tables")]
    pub agents: Option<Vec<DisturbanceBlock>>,
}

/// Forms of a disturbance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DisturbanceKind {
    /// amplitude sin(frequency t + phase).
    Sine,
    /// A constant.
    Constant,
    /// UAV: gain speed (1 - cos(2 pi (t - onset) / duration)) / 2 while it lasts, on x, y and z.
    #[serde(rename = "gust-1-cosine")]
    Gust1Cosine,
    /// UAV: turbulence at low altitude (MIL-F-8785C) through a drag gain, on x (with the wind), y and z.
    Dryden,
    /// UAV: the jets that the rotors of the others blow downwards. Who is w below another and rho beside it is pushed
    /// down by force p(rho / radius) v(2 w / length), where p(s) = 1 / (1 + 0.414 s^2)^2 and v(x) = 27/4 x^2 / (1 +
    /// x)^3.
    RotorVortex,
    /// Biped: the torques J'f with which the ground answers the walk.
    GroundReaction,
}

/// Turbulence by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum IntensityKind {
    /// Wind of 15 kn.
    Light,
    /// Wind of 30 kn.
    Moderate,
    /// Wind of 45 kn.
    Severe,
}

/// `[[fault]]`
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaultFile {
    /// Its name in `[[strata]]` and in what people read (default: target and kind, such as "actuator bias").
    pub name: Option<String>,
    /// What fails.
    #[serde(deserialize_with = "word")]
    pub target: FaultTarget,
    /// How it fails.
    #[serde(deserialize_with = "word")]
    pub kind: FaultKind,
    /// Probability that an agent has this fault (default 1); 0: never, not in a stratum of this fault either.
    pub probability: Option<f64>,
    /// Whether it is part of the background, such as measurement noise: it has its probability in every stratum, and
    /// none of its own (default false).
    pub background: Option<bool>,
    /// The channels that fail (default "all").
    pub channels: Option<ChannelsFile>,
    /// Network: which way is struck (default "command").
    #[serde(default, deserialize_with = "some_word")]
    pub link: Option<Link>,
    /// Beginning, s (default 0).
    pub onset_s: Option<Value>,
    /// How long it stays, s (default: to the end).
    pub duration_s: Option<Value>,
    /// Time in which it comes, in equal parts, s (default 0: at once).
    pub ramp_s: Option<Value>,
    /// Loss: lost share of the command; bias, hard-over, false data: N or N m of a command, m/s or rad/s of a
    /// measurement (which shows the rate too large by it, and a UAV's position by a tenth as many m or rad); scale,
    /// mass, inertia: share; interference: share of the others' commands.
    pub magnitude: Option<Value>,
    /// Smoothed square, oscillatory, outlier: amplitude, N or N m of a command, m/s or rad/s of a measurement.
    pub amplitude: Option<Value>,
    /// Oscillatory: angular frequency, rad/s.
    pub frequency_rad_s: Option<Value>,
    /// Smoothed square: period, s.
    pub period_s: Option<Value>,
    /// Smoothed square: tau of tanh(sin(..)/tau).
    pub smoothing: Option<Value>,
    /// Smoothed square, oscillatory: phase at t = 0, rad (default 0).
    pub phase_rad: Option<Value>,
    /// Noise: standard deviation, m/s or rad/s.
    pub std: Option<Value>,
    /// Drift, rate limit: change per second.
    pub rate: Option<Value>,
    /// Delay: s; whole steps, at least one.
    pub delay_s: Option<Value>,
    /// Replay: length of the recording before the onset, s.
    pub window_s: Option<Value>,
    /// Intermittent, dropout, denial of service: length of a slot of time, s.
    pub burst_s: Option<Value>,
    /// Intermittent, dropout, denial of service: share of the slots that are struck; outlier: share of the steps.
    pub share: Option<Value>,
    /// Payload: its mass, kg.
    pub mass_kg: Option<Value>,
    /// Payload, centre of mass: how far ahead of the centre of thrust, m.
    pub offset_x_m: Option<Value>,
    /// Payload, centre of mass: how far to the side, m.
    pub offset_y_m: Option<Value>,
    /// Blocks that override what is above, but not name, target, kind and link, one per agent.
    #[serde(default, deserialize_with = "some_tables")]
    pub agents: Option<Vec<FaultBlock>>,
}

/// One agent's parameters of a disturbance; what is absent is taken from the table around it.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DisturbanceBlock {
    /// Amplitude.
    pub amplitude: Option<Value>,
    /// Angular frequency, rad/s.
    pub frequency_rad_s: Option<Value>,
    /// Phase at t = 0, rad.
    pub phase_rad: Option<Value>,
    /// Share of the ground reaction.
    pub scale: Option<Value>,
    /// Speed of a gust, m/s.
    pub speed_m_s: Option<Value>,
    /// Drag per speed, N s/m.
    pub gain_n_s_m: Option<Value>,
    /// Beginning of a gust, s.
    pub onset_s: Option<Value>,
    /// Length of a gust, s.
    pub duration_s: Option<Value>,
    /// Mean wind, m/s.
    pub wind_m_s: Option<Value>,
    /// Height, m.
    pub altitude_m: Option<Value>,
    /// Speed against the air, m/s.
    pub airspeed_m_s: Option<Value>,
    /// Largest force of a jet, N.
    pub force_n: Option<Value>,
    /// Half-width of a jet, m.
    pub radius_m: Option<Value>,
    /// Where a jet is felt most, m.
    pub length_m: Option<Value>,
}

/// One agent's fault; what is absent is taken from the table around it.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaultBlock {
    /// Probability that this agent has it; 0: never, not in a stratum of this fault either.
    pub probability: Option<f64>,
    /// The channels that fail.
    pub channels: Option<ChannelsFile>,
    /// Beginning, s.
    pub onset_s: Option<Value>,
    /// How long it stays, s.
    pub duration_s: Option<Value>,
    /// Time in which it comes, s.
    pub ramp_s: Option<Value>,
    /// Magnitude.
    pub magnitude: Option<Value>,
    /// Amplitude.
    pub amplitude: Option<Value>,
    /// Angular frequency, rad/s.
    pub frequency_rad_s: Option<Value>,
    /// Period, s.
    pub period_s: Option<Value>,
    /// tau of tanh(sin(..)/tau).
    pub smoothing: Option<Value>,
    /// Phase at t = 0, rad.
    pub phase_rad: Option<Value>,
    /// Standard deviation.
    pub std: Option<Value>,
    /// Change per second.
    pub rate: Option<Value>,
    /// Delay, s.
    pub delay_s: Option<Value>,
    /// Length of a recording, s.
    pub window_s: Option<Value>,
    /// Length of a slot of time, s.
    pub burst_s: Option<Value>,
    /// Share of the slots that are struck.
    pub share: Option<Value>,
    /// Mass, kg.
    pub mass_kg: Option<Value>,
    /// How far ahead, m.
    pub offset_x_m: Option<Value>,
    /// How far to the side, m.
    pub offset_y_m: Option<Value>,
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

/// Which way of the network.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Link {
    /// From the controller to the actuator.
    Command,
    /// From the sensor to the observer.
    Measurement,
}

/// How it fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// Actuator: (1 - magnitude) u.
    LossOfEffectiveness,
    /// Actuator or sensor: a constant offset.
    Bias,
    /// Actuator: stays where it is.
    Stuck,
    /// Actuator: gives nothing.
    Float,
    /// Actuator: goes to a value of its own, `magnitude`.
    HardOver,
    /// Actuator, sensor or network: amplitude sin(frequency t + phase) is added.
    Oscillatory,
    /// Actuator: a loss of effectiveness in some slots of time.
    Intermittent,
    /// Actuator: what acts changes by at most `rate` per second, whatever arrives.
    RateLimit,
    /// Actuator, sensor or network: the command, or x and x' without f2, arrives `delay_s` later.
    Delay,
    /// Actuator, sensor or network: an offset that grows by `rate` per second.
    Drift,
    /// Sensor: x and x' are measured (1 + magnitude) times as large.
    Scale,
    /// Sensor: normal noise, held over a step.
    Noise,
    /// Sensor: shows the last x and x' for ever; what others add to the measurement (f2: bias, noise, outliers, false
    /// data) goes on.
    Freeze,
    /// Sensor: shows the last x and x' in some slots of time; f2 goes on.
    Dropout,
    /// Sensor: in some steps the measurement is off by the amplitude, up or down.
    Outlier,
    /// Sensor: amplitude tanh(sin(2 pi t / period + phase) / smoothing).
    SmoothedSquare,
    /// Network: an offset that an attacker adds.
    FalseData,
    /// Network: in some slots of time nothing arrives, and the last command, or the last x and x' without f2, is held
    /// ahead of the faults of its receiver.
    DenialOfService,
    /// Network: the commands, or x and x' without f2, recorded before the onset are played again and again.
    Replay,
    /// Network: `magnitude` times the sum of the other agents' commands on this channel leaks into the command.
    Interference,
    /// Plant: the mass (of a biped, M and H) grows by this share.
    Mass,
    /// Plant: the inertia of a UAV grows by this share.
    Inertia,
    /// Plant: the weight of a UAV acts beside its centre of thrust.
    CenterOfMass,
    /// Plant: a point mass is hung on a UAV.
    Payload,
}
