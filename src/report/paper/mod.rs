//! The counterparts of the paper's Figures 8 and 10 to 20 and of the claims in its Section V, each with the number
//! measured here.
//!
//! Two deterministic campaigns are simulated in double precision on the CPU: the three UAVs of scenario A, and four
//! robots on the same walk. The figures are not the paper's: its robot, references and faults are known in part only.

mod claims;
mod error;
mod figures;
mod measures;
mod scenarios;
mod writing;

pub use claims::{Claim, claims};
pub use error::PaperError;
pub use scenarios::Scenarios;
pub use writing::{claim_dir, paper};
