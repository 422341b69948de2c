//! A campaign: everything that decides the result of a run, checked, in SI units, with nothing optional left.

mod chance;
mod check;
mod common;
pub mod distribution;
mod disturbances_and_faults;
pub mod error;
pub mod file;
pub mod gallery;
mod group;
pub(crate) mod kinds;
pub mod lints;
mod load;
mod measure;
mod overlay;
mod parameter;
mod plan;
mod quantity;
mod requirement;
mod source;
mod time;
mod tune;
mod validate;
mod validated;

pub use common::{
    BUILT_IN, COMPARED, Common, FTC, FTC_TUNED, PID, PID_PLACED, PID_ROBUST_OBSERVER, PID_TUNED,
    SYNTHESIZED,
};
pub use distribution::Distribution;
pub use disturbances_and_faults::{Disturbance, Fault, FaultChannels};
pub use error::CampaignError;
pub use file::{CouplingCoordinates, IntegralKind, Link, ObserverStart};
pub use group::{
    AgentGroup, ChannelSensors, ChannelsOfCampaign, Control, GainSource, GroupParts, Initial,
    NamedGains, PidPlaced, PlacedPoles, Verdict,
};
pub use kinds::{DisturbanceKind, FaultKind, FaultTarget};
pub use measure::{EpisodeNumber, LoopNumber, Measure, MeasuredChannels, Side};
pub use overlay::{Setting, SettingError};
pub use parameter::{Parameter, SamplingScope};
pub use plan::{ALL, Detail, Goal, Sampling, Stop, Strata, Stratum, StratumFaults};
pub use quantity::RandomQuantity;
pub use requirement::{Compared, Requirement};
pub use time::{Time, Timing};
pub use tune::{Bound, Limit, Term, Tune};
pub use validated::Campaign;
