//! A campaign simulated into tables in memory.

use super::flight::{Batch, Flight};
use super::options::{RunOptions, SimulationError, threads};
use super::segment::Segment;
use super::stopping::StoppingRule;
use super::times::Times;
use crate::backend::gpu::{Gpu, GpuError};
use crate::campaign::Campaign;
use crate::controllers::GainSet;
use crate::results::scores::Status;
use crate::results::tables::Tables;
use rayon::ThreadPool;
use std::ops::ControlFlow;

/// The tables of a simulated campaign, and how they came about.
pub struct Simulation {
    /// The tables.
    pub tables: Tables,
    /// What has ended the run early, if it has.
    pub stopping: StoppingRule,
    /// Times so far.
    pub times: Times,
    /// What simulated them, in the order of the episodes; together they are the first episodes of the campaign.
    pub segments: Vec<Segment>,
    /// What the user should know of the choice of the backend.
    pub notes: Vec<String>,
    /// Why episodes are missing, if they are.
    pub interrupted: Option<GpuError>,
    /// The threads that were used.
    pub pool: ThreadPool,
}

impl Simulation {
    /// Episodes that were simulated.
    #[must_use]
    pub fn episodes(&self) -> u32 {
        self.segments.iter().map(|segment| segment.episodes).sum()
    }
}

/// Simulates a campaign with gains at hand into tables in memory, on a GPU if one is given; `done` is told of finished
/// episodes.
///
/// # Errors
/// If the threads cannot be started, or a GPU is asked for and simulates nothing. A GPU that fails later leaves the
/// episodes that it finished: the CPU simulates the others if it may, else they are missing and the simulation says
/// why.
pub fn simulate(
    campaign: &Campaign,
    gains: &[GainSet],
    options: &RunOptions,
    gpu: Option<&Gpu>,
    done: &(dyn Fn(u32) + Sync),
) -> Result<Simulation, SimulationError> {
    let pool = threads(options)?;
    let (mut tables, mut stopping) = (Tables::new(campaign), StoppingRule::new(campaign));
    let mut segments = Vec::new();
    let all = 0..campaign.episodes;
    let flight = Flight {
        campaign,
        gains,
        options,
        gpu,
        wanted: std::slice::from_ref(&all),
        pool: &pool,
        done,
        halt: &|| false,
    };
    let flown = flight.fly(&mut |batch: Batch| {
        let first = batch.first;
        let episodes = fill(&mut tables, &mut stopping, campaign, &batch);
        let engine = batch.engine;
        Segment::append(
            &mut segments,
            Segment {
                first,
                episodes,
                engine,
            },
        );
        match stopping.is_done() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    })?;
    let times = Times {
        loop_s: flown.loop_s,
        statistics_s: flown.taking_s,
        ..Times::default()
    };
    Ok(Simulation {
        tables,
        stopping,
        times,
        segments,
        notes: flown.notes,
        interrupted: flown.interrupted,
        pool,
    })
}

/// Adds simulated episodes to the tables, until the stopping rule has seen enough; how many were added.
fn fill(
    tables: &mut Tables,
    stopping: &mut StoppingRule,
    campaign: &Campaign,
    batch: &Batch,
) -> u32 {
    let mut added = 0;
    for place in 0..batch.len() {
        if stopping.is_done() {
            break;
        }
        tables.add(campaign, &batch.episode(place));
        let status = &tables.scores.status;
        stopping.take(|controller| status[controller].last().copied().unwrap_or(Status::Ok));
        added += 1;
    }
    added
}
