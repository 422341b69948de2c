//! How far a run is that is flown in parts.

use crate::report::page::document::{Block, Cell, Document, Grid, Section};
use crate::report::page::text::text;
use crate::run::status::{ShardStatus, Status};
use crate::util::format::{digits, share, time};

/// A run's progress, with its shards where it has some, and what to do next.
#[must_use]
pub fn status(status: &Status) -> String {
    let Status { kept, asked, .. } = *status;
    let path = status.path.display();
    let mut said = vec![format!(
        "{kept} of {asked} episodes are kept ({})",
        share(f64::from(kept) / f64::from(asked.max(1)))
    )];
    if let Some(rate) = status.rate_per_s {
        said.push(format!("a process simulates {} a second", digits(rate, 3)));
    }
    if let Some(left_s) = status.left_s {
        said.push(format!("about {} left", time(left_s)));
    }
    let mut blocks = vec![Block::Text(said.join(", "))];
    blocks.extend(
        status
            .process
            .as_ref()
            .map(|process| Block::Text(format!("{process} is at it"))),
    );
    if !status.shards.is_empty() {
        blocks.push(Block::Grid(shards(&status.shards)));
    }
    blocks.push(Block::Text(next(status, &path.to_string())));
    text(&Document {
        sections: vec![Section::new(format!("{}: {path}", status.campaign), blocks)],
        ..Document::default()
    })
}

fn shards(shards: &[ShardStatus]) -> Grid {
    let mut grid = Grid::new(["shard", "state", "episodes", "process"]);
    for own in shards {
        grid.rows.push(vec![
            Cell::number(own.number.to_string()),
            Cell::text(own.state.word()),
            Cell::number(format!("{} of {}", own.kept, own.asked)),
            Cell::text(own.process.as_deref().unwrap_or("-")),
        ]);
    }
    grid
}

/// What to do next.
fn next(status: &Status, path: &str) -> String {
    let missing = status.missing();
    if status.is_whole {
        return "the run is whole".to_string();
    }
    if status.kept == status.asked {
        return match status.shards.is_empty() {
            true => "all is flown: the command that began it writes its files".to_string(),
            false => format!("all is flown: urts-mc merge {path} makes it one run"),
        };
    }
    if status.shards.is_empty() {
        return match status.process {
            Some(_) => "wait for it, or end it with SIGTERM: what it flew is kept".to_string(),
            None => "the command that began it goes on".to_string(),
        };
    }
    match missing.is_empty() {
        true => "all shards that are missing are at it".to_string(),
        false => format!("nobody flies these shards: --array={missing}"),
    }
}
