//! `[[disturbance]]` and `[[fault]]` as they are written.

use super::parameters::{Parameters, table_and_block};
use super::value::{ChannelsFile, Value, some_tables, some_word, word};
use crate::campaign::kinds::{DisturbanceKind, FaultKind, FaultTarget};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

table_and_block! {
    /// `[[disturbance]]`
    DisturbanceFile {
        /// Form of the disturbance.
        #[serde(deserialize_with = "word")]
        kind: DisturbanceKind,
        /// Turbulence: instead of wind_m_s, that of light (15 kn), moderate (30 kn) or severe (45 kn) turbulence.
        #[serde(default, deserialize_with = "some_word")]
        intensity: Option<IntensityKind>,
    }
    /// One agent's parameters of a disturbance; what is absent is taken from the table around it.
    DisturbanceBlock {
    }
    parameters {
        /// Amplitude or constant value, N or N m.
        amplitude,
        /// Sine: angular frequency, rad/s.
        frequency_rad_s,
        /// Sine: phase at t = 0, rad (default 0).
        phase_rad,
        /// Ground reaction: share of the series that acts (default 1).
        scale,
        /// Friction: Coulomb's part, which does not depend on the speed, N or N m.
        coulomb,
        /// Friction: viscous part, N s/m or N m s/rad (default 0).
        viscous,
        /// Friction: the rate within which Coulomb's part changes its sign, m/s or rad/s (default 0.05).
        smoothing_rate,
        /// Gust: its largest speed along the channel, m/s.
        speed_m_s,
        /// Gust and turbulence: drag per speed, N s/m.
        gain_n_s_m,
        /// Gust: beginning, s.
        onset_s,
        /// Gust: length, s.
        duration_s,
        /// Turbulence: mean wind 6 m above the ground, m/s.
        wind_m_s,
        /// Turbulence: height above the ground, m; 3 to 305.
        altitude_m,
        /// Turbulence: speed against the air, m/s; at least 0.5, for the model does not hold in still air.
        airspeed_m_s,
        /// Rotor vortex: the largest force of one jet on the agent, N.
        force_n,
        /// Rotor vortex: how far from a jet's axis half of the force is felt, m; at least 0.001.
        radius_m,
        /// Rotor vortex: how far below the rotors a jet is felt most, m; at least 0.001.
        length_m,
    }
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

table_and_block! {
    /// `[[fault]]`
    FaultFile {
        /// Its name in `[[strata]]` and in what people read (default: target and kind, such as "actuator bias").
        name: Option<String>,
        /// What fails.
        #[serde(deserialize_with = "word")]
        target: FaultTarget,
        /// How it fails.
        #[serde(deserialize_with = "word")]
        kind: FaultKind,
        /// Probability that an agent has this fault (default 1); 0: never, not in a stratum of this fault either.
        probability: Option<f64>,
        /// Whether it is part of the background, such as measurement noise: it has its probability in every stratum,
        /// and none of its own (default false).
        background: Option<bool>,
        /// The channels that fail (default "all").
        channels: Option<ChannelsFile>,
        /// Network: which way is struck (default "command").
        #[serde(default, deserialize_with = "some_word")]
        link: Option<Link>,
        /// Beginning, s (default 0).
        onset_s: Option<Value>,
        /// How long it stays, s (default: to the end).
        duration_s: Option<Value>,
        /// Time in which it comes, in equal parts, s (default 0: at once).
        ramp_s: Option<Value>,
    }
    /// One agent's fault; what is absent is taken from the table around it.
    FaultBlock {
        /// Probability that this agent has it; 0: never, not in a stratum of this fault either.
        probability: Option<f64>,
        /// The channels that fail.
        channels: Option<ChannelsFile>,
        /// Beginning, s.
        onset_s: Option<Value>,
        /// How long it stays, s.
        duration_s: Option<Value>,
        /// Time in which it comes, s.
        ramp_s: Option<Value>,
    }
    parameters {
        /// Loss: lost share of the command; dead zone: half its width, N or N m; bias, hard-over, false data: N or N m
        /// of a command, m/s or rad/s of a measurement (which shows the rate too large by it, and a UAV's position by a
        /// tenth as many m or rad); scale, mass, inertia: share; interference: share of the others' commands.
        magnitude,
        /// Smoothed square, oscillatory, outlier: amplitude, N or N m of a command, m/s or rad/s of a measurement.
        amplitude,
        /// Oscillatory: angular frequency, rad/s.
        frequency_rad_s,
        /// Smoothed square: period, s.
        period_s,
        /// Smoothed square: tau of tanh(sin(..)/tau).
        smoothing,
        /// Smoothed square, oscillatory: phase at t = 0, rad (default 0).
        phase_rad,
        /// Noise: standard deviation, m/s or rad/s.
        std,
        /// Drift, rate limit: change per second.
        rate,
        /// Delay: s; whole steps, at least one.
        delay_s,
        /// Replay: length of the recording before the onset, s.
        window_s,
        /// Intermittent, dropout, denial of service: length of a slot of time, s.
        burst_s,
        /// Intermittent, dropout, denial of service: share of the slots that are struck; outlier: share of the steps.
        share,
        /// Payload: its mass, kg.
        mass_kg,
        /// Payload, centre of mass: how far ahead of the centre of thrust, m.
        offset_x_m,
        /// Payload, centre of mass: how far to the side, m.
        offset_y_m,
    }
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
