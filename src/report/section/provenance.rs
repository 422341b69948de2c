//! What it takes to do the run again, and what it was done with.

use crate::report::page::document::{Block, Cell, Grid, Section};
use crate::report::run_data::RunData;
use crate::report::times::times;
use crate::simulation::Segment;
use crate::simulation::cross_check::CrossCheck;

/// Version, seed, machine, times, cross-check, and the campaign's text.
pub(crate) fn section(data: &RunData) -> Section {
    let manifest = &data.manifest;
    let mut grid = Grid::new(["what", "value"]);
    let mut add = |name: &str, value: String| {
        grid.rows.push(vec![Cell::text(name), Cell::text(value)]);
    };
    let revision = manifest.git_revision.as_deref();
    add(
        "program",
        match revision {
            Some(revision) => format!("urts-mc {}, revision {revision}", manifest.version),
            None => format!("urts-mc {}", manifest.version),
        },
    );
    add("campaign", manifest.campaign_path.clone());
    let hashed = match manifest.overlay.is_empty() {
        true => "BLAKE3 of its text",
        false => "BLAKE3 of its text and settings",
    };
    add(hashed, manifest.campaign_blake3.clone());
    add("seed", manifest.seed.to_string());
    add(
        "episodes",
        format!(
            "{} of {} asked for",
            manifest.episodes, manifest.episodes_asked
        ),
    );
    for segment in &manifest.segments {
        add("simulated on", engine(segment, manifest.segments.len() > 1));
    }
    add(
        "number format",
        format!("{:?}", manifest.precision).to_lowercase(),
    );
    for note in &manifest.notes {
        add("note", note.clone());
    }
    if let Some(check) = &manifest.cross_check {
        add("cross-check with f64 on the CPU", cross_checked(check));
    }
    add("wall-clock times", times(manifest));
    let mut blocks = vec![Block::Grid(grid)];
    if !manifest.overlay.is_empty() {
        let settings = manifest
            .overlay
            .iter()
            .map(|setting| format!("--set {setting}\n"));
        blocks.push(Block::Folded(
            "The settings laid over the campaign".into(),
            vec![Block::Code(settings.collect())],
        ));
    }
    blocks.push(Block::Folded(
        "The campaign".into(),
        vec![Block::Code(manifest.campaign.clone())],
    ));
    Section::new("Provenance", blocks)
}

/// What a cross-check found.
fn cross_checked(check: &CrossCheck) -> String {
    let left_out = match check.sensitive {
        0 => String::new(),
        count => format!("; {count} left out: {}", CrossCheck::SENSITIVE),
    };
    format!(
        "{} episodes: |e| within {:.1e}, RMS error within {:.1e} relative ({} trajectories compared), {} verdicts differ{left_out}",
        check.episodes.len(),
        check.largest_error_difference,
        check.largest_rmse_difference,
        check.compared,
        check.verdicts_differ,
    )
}

fn engine(segment: &Segment, several: bool) -> String {
    let Segment {
        engine,
        episodes,
        first,
    } = segment;
    match several {
        true => format!("{engine}: {episodes} episodes from number {first}"),
        false => engine.to_string(),
    }
}
