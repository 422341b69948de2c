//! The tables of a run, from its parts: what was drawn is drawn again.

use super::error::OutputError;
use super::parts::{Outcomes, Parts};
use super::tables::LargeTables;
use crate::backend::EpisodeResult;
use crate::campaign::Campaign;
use crate::draw::draw;
use crate::results::scores::Scores;
use crate::results::tables::Tables;
use crate::simulation::Segment;
use crate::simulation::stopping::StoppingRule;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::panic::resume_unwind;
use std::sync::mpsc::{self, SyncSender};
use std::thread;

/// What the parts of a run make, beside the files of the large tables.
pub(super) struct Tabulated {
    pub(super) scores: Scores,
    /// What has ended the run early, if it has.
    pub(super) stopping: StoppingRule,
    /// What simulated its episodes, in their order.
    pub(super) segments: Vec<Segment>,
}

/// Makes the tables of the episodes that are kept, from the first to the first that is not, or to the one that ends the
/// run early. Those that grow with the episodes leave memory for their files, which another thread writes meanwhile.
///
/// # Errors
/// If a part is not what was written, or a file cannot be.
pub(super) fn tabulate(
    campaign: &Campaign,
    parts: &Parts,
    pool: &ThreadPool,
    files: LargeTables<'_>,
) -> Result<Tabulated, OutputError> {
    let mut made = Tabulated {
        scores: Tables::new(campaign).scores,
        stopping: StoppingRule::new(campaign),
        segments: Vec::new(),
    };
    thread::scope(|scope| {
        let (sender, pieces) = mpsc::sync_channel(1);
        let writing = scope.spawn(move || files.write(pieces));
        let taken = made.take(campaign, parts, pool, &sender);
        drop(sender);
        let written = writing.join().unwrap_or_else(|panic| resume_unwind(panic));
        // A part that is damaged is told of first: the files end there.
        taken.and(written)
    })?;
    Ok(made)
}

impl Tabulated {
    /// Episodes of the run.
    pub(super) fn episodes(&self) -> u32 {
        self.segments.iter().map(|segment| segment.episodes).sum()
    }

    /// Takes in parts, and hands on their rows.
    fn take(
        &mut self,
        campaign: &Campaign,
        parts: &Parts,
        pool: &ThreadPool,
        rows: &SyncSender<Tables>,
    ) -> Result<(), OutputError> {
        for index in 0..parts.count() {
            if self.stopping.is_done() {
                break;
            }
            let Some((header, bytes)) = parts.read(index)? else {
                break;
            };
            let first = index * parts.size();
            let outcomes = parts.episodes(&bytes);
            let episodes: Vec<(u32, Outcomes)> = (first..).zip(outcomes).collect();
            let Some(mut left) = self.add(campaign, &episodes, pool, rows) else {
                break;
            };
            for segment in &header.segments {
                let mut own = segment.clone();
                own.episodes = own.episodes.min(left);
                left -= own.episodes;
                Segment::append(&mut self.segments, own);
            }
            if header.episodes() < parts.episodes_of(index) {
                break;
            }
        }
        Ok(())
    }

    /// Adds episodes until the stopping rule has seen enough; how many were added, or none if nobody writes their rows
    /// any more.
    fn add(
        &mut self,
        campaign: &Campaign,
        episodes: &[(u32, Outcomes)],
        pool: &ThreadPool,
        rows: &SyncSender<Tables>,
    ) -> Option<u32> {
        let of_thread = episodes.len().div_ceil(pool.current_num_threads()).max(1);
        let chunks = || episodes.par_chunks(of_thread);
        let pieces: Vec<Tables> =
            pool.install(|| chunks().map(|chunk| rows_of(campaign, chunk)).collect());
        let mut added = 0;
        for (chunk, mut piece) in episodes.chunks(of_thread).zip(pieces) {
            let wanted = self.wanted(&piece.scores);
            if wanted < chunk.len() {
                piece = rows_of(campaign, &chunk[..wanted]);
            }
            added += u32::try_from(wanted).unwrap_or(u32::MAX);
            self.scores.append(std::mem::take(&mut piece.scores));
            rows.send(piece).ok()?;
        }
        Some(added)
    }

    /// How many of some episodes the stopping rule wants to see.
    fn wanted(&mut self, scores: &Scores) -> usize {
        let mut seen = 0;
        while seen < scores.episodes() && !self.stopping.is_done() {
            self.stopping
                .take(|controller| scores.status[controller][seen]);
            seen += 1;
        }
        seen
    }
}

/// The rows of some episodes, with what they met.
fn rows_of(campaign: &Campaign, episodes: &[(u32, Outcomes)]) -> Tables {
    let mut tables = Tables::new(campaign);
    for (episode, groups) in episodes {
        let groups = campaign.groups().iter().zip(groups);
        let of_group = |(group, outcomes): (_, &Vec<_>)| EpisodeResult {
            episode: draw(group, *episode),
            outcomes: outcomes.clone(),
        };
        let groups: Vec<EpisodeResult> = groups.map(of_group).collect();
        tables.add(campaign, &groups.iter().collect::<Vec<_>>());
    }
    tables
}
