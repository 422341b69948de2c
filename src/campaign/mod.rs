//! A campaign: everything that decides the result of a run, checked, in SI units, with nothing optional left.

mod check;
pub mod distribution;
pub mod error;
pub mod file;
mod kinds;
pub mod lints;
mod load;
mod overlay;
mod plan;
mod quantity;
mod signals;
mod source;
mod time;
mod validate;
mod validated;

pub use check::Parameter;
pub use distribution::Distribution;
pub use error::CampaignError;
pub use file::{
    CouplingCoordinates, DisturbanceKind, FaultKind, FaultTarget, IntegralKind, Link,
    ObserverStart, SamplingScope,
};
pub use overlay::{Setting, SettingError};
pub use plan::{ALL, Goal, Sampling, Stop, Strata, Stratum, StratumFaults};
pub use quantity::RandomQuantity;
pub use signals::{Disturbance, Fault, FaultChannels};
pub use time::Time;
pub use validated::{
    Campaign, Control, FTC, GainSource, Initial, NamedGains, PID, PID_TUNED, Requirement, Verdict,
};
