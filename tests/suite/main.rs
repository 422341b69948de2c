//! All integration tests, in one binary: each links the whole program.
//!
//! | module | holds |
//! |---|---|
//! | `random` | designs: balance, independence, what they gain and allow |
//! | `statistics` | estimators against published values, and their coverage |
//! | `agent` | robot files, kinematics and dynamics of a biped against an independent implementation |
//! | `reference` | the waypoint reference; the walk against an independent implementation |
//! | `synthesis` | gains, certificates and margins against an independent implementation; the linear algebra under the solver |
//! | `campaign` | every shipped campaign; settings laid over a file |
//! | `draw` | sampling designs in campaigns; names of faults, and which episodes meet which |
//! | `mission` | decisions of missions against an independent implementation, closed forms and their invariants |
//! | `model` | the closed loop against independent trajectories; every fault, disturbance and option against its definition; robots, lanes, metrics |
//! | `backend` | the same bytes for any thread count, width and length; the shaders against the CPU, and changed shaders that must be noticed |
//! | `results` | what is said of each stratum, against numbers worked out by hand; what the conditions of an episode do to its outcome |
//! | `simulation` | early stop: its level, and the same end whatever simulates; runs whose GPU fails; inequality (24) of the paper |
//! | `run` | the bytes of every shipped campaign's tables, against an earlier version's |
//! | `report` | what the report of a run says, and what a browser makes of it; the paper's figures and claims |
//! | `cli` | commands, exit codes and error messages |
//! | `house` | the layout of the sources: order of the rooms, circles, sizes |
//! | `readers` | the tables in the hands of those who read them |
//! | `readme` | what the README tells its readers to type |
//!
//! A test's name is a sentence. `val_` marks comparison with an independent source, `regress_` comparison with
//! ourselves.
#![expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
#![expect(
    clippy::float_cmp,
    reason = "tests of ranks, copies and determinism mean equality"
)]
#![expect(clippy::print_stdout, reason = "measured figures, shown on demand")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small counts"
)]

mod common;

mod agent;
mod backend;
mod campaign;
mod cli;
mod draw;
mod house;
mod mission;
mod model;
mod random;
mod readers;
mod readme;
mod reference;
mod report;
mod results;
mod run;
mod simulation;
mod statistics;
mod synthesis;
