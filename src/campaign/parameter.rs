//! The parameters that a table of a campaign file may hold: their names, bounds and defaults.

use super::file::*;
use super::time::Timing;

/// The values that a quantity may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Bounds {
    Any,
    NonNegative,
    Positive,
    /// From 0 to 1.
    Share,
    /// More than 0, at most 1.
    Chance,
    /// From a smallest value on.
    AtLeast(f64),
    /// From a smallest value to a largest.
    Between(f64, f64),
}

impl Bounds {
    pub(super) fn broken_by(self, low: f64, high: f64) -> Option<String> {
        let limit = match self {
            Self::NonNegative if low < 0.0 => "must not be negative".into(),
            Self::Positive if low <= 0.0 => "must be positive".into(),
            Self::Share if low < 0.0 || high > 1.0 => "must lie within [0, 1]".into(),
            Self::Chance if low <= 0.0 || high > 1.0 => "must be more than 0 and at most 1".into(),
            Self::Between(least, most) if low < least || high > most => {
                format!("must lie within [{least}, {most}]")
            }
            Self::AtLeast(least) if low < least => format!("must be at least {least:e}"),
            _ => return None,
        };
        Some(limit)
    }
}

/// A parameter of a disturbance or fault.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Its key in the file and its column in the tables.
    pub name: &'static str,
    pub(super) default: Option<f64>,
    pub(super) bounds: Bounds,
    /// Who shares a draw, if the file does not say it: each channel has its own, or the agent one.
    pub(super) per: SamplingScope,
    /// What steps make of its values.
    pub timing: Timing,
}

impl Parameter {
    /// The same with a value where the file gives none.
    pub(super) const fn or(self, default: f64) -> Self {
        Self {
            default: Some(default),
            ..self
        }
    }

    /// The same as a time.
    pub(super) const fn timed(self, timing: Timing) -> Self {
        Self { timing, ..self }
    }
}

/// A parameter of each channel that has to be given.
pub(super) const fn required(name: &'static str, bounds: Bounds) -> Parameter {
    Parameter {
        name,
        default: None,
        bounds,
        per: SamplingScope::Channel,
        timing: Timing::AsDrawn,
    }
}

/// A parameter of the whole agent that has to be given.
pub(super) const fn of_agent(name: &'static str, bounds: Bounds) -> Parameter {
    Parameter {
        name,
        default: None,
        bounds,
        per: SamplingScope::Agent,
        timing: Timing::AsDrawn,
    }
}

/// A table whose parameters are looked up by name.
pub(super) trait Parameters {
    /// All parameters that the table can hold.
    const NAMES: &'static [&'static str];
    fn parameter(&self, name: &str) -> Option<&Value>;
}

macro_rules! parameters {
    ($table:ty: $($name:ident),*) => {
        impl Parameters for $table {
            const NAMES: &'static [&'static str] = &[$(stringify!($name)),*];
            fn parameter(&self, name: &str) -> Option<&Value> {
                match name {
                    $(stringify!($name) => self.$name.as_ref(),)*
                    _ => None,
                }
            }
        }
    };
}
parameters!(InitialFile: error, error_rate, error_integral);
parameters!(InitialBlock: error, error_rate, error_integral);
parameters!(DisturbanceFile: amplitude, frequency_rad_s, phase_rad, scale, speed_m_s, gain_n_s_m, onset_s, duration_s,
    wind_m_s, altitude_m, airspeed_m_s, force_n, radius_m, length_m);
parameters!(FaultFile: magnitude, amplitude, frequency_rad_s, period_s, smoothing, phase_rad, std, rate, delay_s, window_s,
    burst_s, share, mass_kg, offset_x_m, offset_y_m);
parameters!(DisturbanceBlock: amplitude, frequency_rad_s, phase_rad, scale, speed_m_s, gain_n_s_m, onset_s, duration_s,
    wind_m_s, altitude_m, airspeed_m_s, force_n, radius_m, length_m);
parameters!(FaultBlock: magnitude, amplitude, frequency_rad_s, period_s, smoothing, phase_rad, std, rate, delay_s, window_s,
    burst_s, share, mass_kg, offset_x_m, offset_y_m);
