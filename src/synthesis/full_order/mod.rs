//! Full-order synthesis: the gains of a group of channels whose sensors do not split into channels.
//!
//! The paper splits an agent into channels because C and B2 of (16) are Kronecker products: each channel has sensors of
//! its own, all alike. Here they may be misaligned, shared, redundant or missing, and a fault may strike several.
//! Flow: [`SensorChanges`] -> [`Sensors`], which show every integral -> K of a channel, L of the filter Riccati
//! equation of all channels -> Clarabel's confirmation of L where there are few channels -> the certificate (27).

mod abscissa;
mod certificate;
mod coupled;
mod detectability;
mod doubling;
mod inequality;
mod norm;
mod sensor;
mod sensor_error;
mod sensor_names;
mod sensors;
mod synthesis;

pub use certificate::FullOrderCertificate;
pub use sensor::{Sensor, SensorChanges, SensorRow};
pub use sensor_error::SensorError;
pub use sensors::Sensors;
pub use synthesis::{
    Confirmation, FullOrderGains, FullOrderSynthesis, MOST_CONFIRMED_CHANNELS,
    MOST_CONFIRMED_STATES, Solver, synthesize_full_order,
};
