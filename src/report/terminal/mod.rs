//! What the commands print.

mod amount;
mod attenuation;
mod comparison;
mod conclusion;
mod devices;
mod drawn;
mod effort;
mod findings;
mod full_order;
mod gains;
mod gallery;
mod pairs;
mod plan;
mod replay;
mod robot;
mod runs;
mod screening;
mod status;
mod tuning;
mod written;

pub use crate::report::page::text::BAD;
pub use amount::Amount;
pub use comparison::comparison;
pub use devices::devices;
pub use findings::findings;
pub use full_order::full_order;
pub use gains::{gains, synthesis};
pub use gallery::gallery;
pub use plan::{plan, plan_json};
pub use replay::{replay, replay_json};
pub use robot::{robot, robot_json};
pub use runs::{runs, runs_json};
pub use status::status;
pub use tuning::tuning;
pub use written::{paper, report};
