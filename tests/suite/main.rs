//! All integration tests, in one binary: each links the whole program.
//!
//! | module | holds |
//! |---|---|
//! | `scenarios` | the closed loop against independent trajectories |
//! | `synthesis` | gains, certificates and margins against an independent implementation |
//! | `lapack` | the linear algebra under the solver against nalgebra |
//! | `statistics` | estimators against published values, and their coverage |
//! | `sampling` | designs: balance, independence, what they gain and allow |
//! | `ranking` | what the conditions of an episode do to its outcome |
//! | `comparison` | what is said of each stratum, against numbers worked out by hand |
//! | `designs` | sampling designs in campaigns: balance, replicates, what they leave out |
//! | `stop` | early stop: its level, and the same end whatever flies |
//! | `strata` | names of faults, and which episodes meet which |
//! | `path` | the waypoint reference |
//! | `robot` | robot files, kinematics and dynamics of a biped against an independent implementation |
//! | `leg` | the fast dynamics of a leg on every lane type |
//! | `walk` | the walking reference against an independent implementation |
//! | `biped` | robots in the episode loop: against independent trajectories and formulas, at their limits, on every lane type |
//! | `faults` | every kind of fault and disturbance, and every option of the loop, against its definition |
//! | `attenuation` | inequality (24) of the paper on flights, against plain formulas |
//! | `determinism` | the same bytes for any thread count, width and length; replay |
//! | `digests` | the bytes of every shipped campaign's tables, against an earlier version's |
//! | `gpu` | the shaders against the CPU, episode by episode; changed shaders that must be noticed |
//! | `house` | the layout of the sources: order of the rooms, circles, sizes |
//! | `flight` | flights whose GPU fails |
//! | `lanes` | elementary functions, phases and selections on every lane type |
//! | `model` | order of the integration, limits, noise, draws |
//! | `campaigns` | every shipped campaign; what the paper claims |
//! | `overlay` | settings laid over a campaign file |
//! | `paper` | the paper's figures and claims |
//! | `readme` | what the README tells its readers to type |
//! | `report` | what the report of a run says, and what a browser makes of it |
//! | `cli` | commands, exit codes and error messages |
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

mod cli;
mod common;

mod attenuation;
mod biped;
mod campaigns;
mod comparison;
mod designs;
mod determinism;
mod digests;
mod faults;
mod flight;
mod gpu;
mod house;
mod lanes;
mod lapack;
mod leg;
mod metrics;
mod model;
mod overlay;
mod paper;
mod path;
mod ranking;
mod readme;
mod report;
mod robot;
mod sampling;
mod scenarios;
mod statistics;
mod stop;
mod strata;
mod synthesis;
mod walk;
