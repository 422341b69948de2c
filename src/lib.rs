//! Monte Carlo robustness evaluation of fault-tolerant controllers for teams of UAVs or bipeds.
//!
//! A campaign file says which closed loop is simulated, what disturbs it and what counts as failure; a run simulates
//! every episode under every controller on the same draws and compares the controllers pair by pair.
//!
//! # The rooms, from the ground up
//! A module uses those above it in this list only, never one below; a test holds that (`tests/suite/house.rs`).
//!
//! | module | holds |
//! |---|---|
//! | [`util`] | a list of fixed length, spelling suggestions, number formats: no knowledge of the domain |
//! | [`random`] | Philox, Sobol, Latin hypercubes, permutations: numbers by address, no state |
//! | [`statistics`] | intervals, tests and effect sizes on plain slices |
//! | [`agent`] | what flies or walks: parameters of UAVs and robots, channels, actuation; reading robots' files |
//! | [`reference`](mod@reference) | the trajectory to follow as a function of time: path of a UAV, walk of a biped |
//! | [`synthesis`] | H-infinity gains of a linear channel: Riccati equations, Clarabel, certificates |
//! | [`campaign`] | the campaign file, read and validated into a [`campaign::Campaign`] |
//! | [`controllers`] | from a campaign to the gains of every controller: synthesized, or read from a file |
//! | [`draw`] | the random quantities of one episode |
//! | [`mission`] | what teams decide while they search and rescue: allocation, ways, behaviour, and what comes of it |
//! | [`model`] | the equations of one episode, generic over the lane type; `shaders/` are their twins |
//! | [`backend`] | the model on many episodes: SIMD lanes on all cores, or a GPU |
//! | [`results`] | tables by episode, and every statistic on them |
//! | [`simulation`] | draw, backend and results batch by batch; stopping rule, cross-check, attenuation |
//! | [`run`](mod@run) | the directory of a run: manifest, files that appear whole, replay of one episode |
//! | [`report`] | results for people: HTML, Markdown, terminal, JUnit, the paper's figures |
//!
//! The program's own room, `cli` (arguments, exit codes, progress), stands on top of all.
//!
//! # Example
//! From a campaign file to the statistics, without a directory of a run:
//! ```
//! use urts_mc::backend::cpu::Precision;
//! use urts_mc::campaign::Campaign;
//! use urts_mc::controllers::GainSet;
//! use urts_mc::results::Results;
//! use urts_mc::simulation::{RunOptions, simulate};
//!
//! let campaign = Campaign::load("campaigns/smoke.toml".as_ref())?.with_episodes(16)?;
//! let gains = GainSet::of_groups(&campaign)?;
//! let options = RunOptions::cpu(Precision::F64);
//! let simulation = simulate(&campaign, &gains, &options, None, &|_finished| ())?;
//! // Of how restless the commands are, nothing is known without flights.
//! let results = Results::of(&campaign, &gains, &simulation.tables.scores, &[], &simulation.pool);
//!
//! for row in results.summary.iter().filter(|row| row.metric == "rmse") {
//!     let median = row.quantiles[0];
//!     println!("{}, {}: half of the RMS errors are below {:?}", row.failures.controller, row.group, median.value);
//! }
//! assert_eq!(simulation.episodes(), 16);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Invariants
//! - A [`campaign::Campaign`] is complete and consistent; nothing after it checks input again.
//! - An episode depends on (campaign, seed, index) alone: no clock, environment, thread, batch or order reaches a
//!   number.
//! - Agents of one group never act on those of another: [`draw`], [`model`] and [`backend`] know a
//!   [`campaign::AgentGroup`] and nothing else, [`simulation`] brings the groups of an episode together.
//! - [`model`] is written once, generic over the lane type; what a campaign does not use is not in its loop.
//! - Not-a-number is a verdict ("diverged"), never a value in a statistic and never a dropped row.
//! - A directory with a manifest holds all episodes that it counts; files appear under their final name only when
//!   complete.
//! - The library does not print, does not exit and does not panic on input.

pub mod util;

pub mod random;

pub mod statistics;

pub mod agent;

pub mod reference;

pub mod synthesis;

pub mod campaign;

pub mod controllers;

pub mod draw;

pub mod mission;

pub mod model;

pub mod backend;

pub mod results;

pub mod simulation;

pub mod run;

pub mod report;
