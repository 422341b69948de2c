//! The tables of a run, from its parts: what was drawn is drawn again.

use super::error::OutputError;
use super::parts::{Outcomes, Parts};
use super::tables::LargeTables;
use crate::backend::EpisodeResult;
use crate::campaign::Campaign;
use crate::draw::draw;
use crate::results::scores::Status;
use crate::results::tables::Tables;
use crate::simulation::Segment;
use crate::simulation::stopping::StoppingRule;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::time::Duration;

/// What the parts of a run make.
pub(super) struct Tabulated {
    pub(super) tables: Tables,
    /// What has ended the run early, if it has.
    pub(super) stopping: StoppingRule,
    /// What simulated its episodes, in their order.
    pub(super) segments: Vec<Segment>,
    /// How long it took to write the tables that grow with the episodes.
    pub(super) writing: Duration,
}

impl Tabulated {
    /// Episodes of the run.
    pub(super) fn episodes(&self) -> u32 {
        self.segments.iter().map(|segment| segment.episodes).sum()
    }
}

/// Makes the tables of the episodes that are kept, from the first to the first that is not, or to the one that ends the
/// run early; those that grow with the episodes leave memory for their files.
///
/// # Errors
/// If a part is not what was written, or a file cannot be.
pub(super) fn tabulate(
    campaign: &Campaign,
    parts: &Parts,
    pool: &ThreadPool,
    mut files: LargeTables<'_>,
) -> Result<Tabulated, OutputError> {
    let mut made = Tabulated {
        tables: Tables::new(campaign),
        stopping: StoppingRule::new(campaign),
        segments: Vec::new(),
        writing: Duration::ZERO,
    };
    for index in 0..parts.count() {
        if made.stopping.is_done() {
            break;
        }
        let Some((header, bytes)) = parts.read(index)? else {
            break;
        };
        let first = index * parts.size();
        let outcomes = parts.episodes(&bytes);
        let numbered = (first..).zip(outcomes).collect::<Vec<(u32, Outcomes)>>();
        let episodes: Vec<Vec<EpisodeResult>> = pool.install(|| {
            let drawn = numbered.into_par_iter();
            drawn.map(|own| drawn_again(campaign, own)).collect()
        });
        let added = made.add(campaign, &episodes);
        files.take(&mut made.tables)?;
        let mut left = added;
        for segment in &header.segments {
            let mut own = segment.clone();
            own.episodes = own.episodes.min(left);
            left -= own.episodes;
            Segment::append(&mut made.segments, own);
        }
        if header.episodes() < parts.episodes_of(index) {
            break;
        }
    }
    made.writing = files.finish(&mut made.tables)?;
    Ok(made)
}

impl Tabulated {
    /// Adds episodes until the stopping rule has seen enough; how many were added.
    fn add(&mut self, campaign: &Campaign, episodes: &[Vec<EpisodeResult>]) -> u32 {
        let mut added = 0;
        for groups in episodes {
            if self.stopping.is_done() {
                break;
            }
            let groups: Vec<&EpisodeResult> = groups.iter().collect();
            self.tables.add(campaign, &groups);
            let status = &self.tables.scores.status;
            let last = |controller: usize| status[controller].last().copied();
            let stopping = &mut self.stopping;
            stopping.take(|controller| last(controller).unwrap_or(Status::Ok));
            added += 1;
        }
        added
    }
}

/// An episode with what it met, of each group of agents.
fn drawn_again(campaign: &Campaign, (episode, groups): (u32, Outcomes)) -> Vec<EpisodeResult> {
    let groups = campaign.groups().iter().zip(groups);
    let of_group = |(group, outcomes)| EpisodeResult {
        episode: draw(group, episode),
        outcomes,
    };
    groups.map(of_group).collect()
}
