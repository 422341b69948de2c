//! From a campaign to the gains of its controllers: synthesized, or from a file and verified the same way; and
//! gains.json.

mod built_in;
mod cautions;
mod error;
mod file;
mod full_order;
mod gain_set;
mod load;
mod step;

pub use built_in::{fault_tolerant, spelled_out, synthesized};
pub use cautions::cautions;
pub use error::GainsError;
pub use file::{ControllerFile, GainsFile, GroupGains};
pub use full_order::{FullOrderFile, full_order};
pub use gain_set::{ChannelController, Findings, GainSet, SimulatedController};
