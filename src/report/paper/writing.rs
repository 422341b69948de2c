//! The directory of the figures: what may stand there, and what is written.

use super::claims::{Claim, claims};
use super::error::PaperError;
use super::figures;
use super::scenarios::Scenarios;
use crate::campaign::Campaign;
use crate::report::page::document::{Block, Cell, Document, Grid, Section};
use crate::report::page::markdown::{Length, markdown};
use crate::run::directory::OutputDir;
use crate::run::error::OutputError;
use crate::run::file_names::ON_THE_WAY;
use crate::run::output_file::OutputFile;
use std::fs;
use std::path::Path;

/// The campaign of the UAVs.
const UAVS: &str = include_str!("../../../campaigns/scenario-a.toml");
/// The campaign of the robots.
const ROBOTS: &str = include_str!("../../../campaigns/paper-robots.toml");
/// The text that lists figures and claims; it is written last.
const README: &str = "README.md";
/// Its title, by which a directory of these figures is known.
const TITLE: &str = "The paper's figures and claims";

/// Claims a directory for the figures before any work is done. It may be absent, empty, or hold these figures already;
/// anything else is refused unless `overwrite`.
///
/// # Errors
/// If the directory holds something else or cannot be written. Nothing is left behind then.
pub fn claim_dir(path: &Path, overwrite: bool) -> Result<OutputDir, OutputError> {
    if path.exists() && !path.is_dir() {
        return Err(OutputError::Unwritable {
            path: path.to_path_buf(),
            source: std::io::ErrorKind::NotADirectory.into(),
        });
    }
    if !overwrite && !is_ours(path) {
        return Err(OutputError::Taken {
            path: path.to_path_buf(),
            what: "files that are not the paper's figures".into(),
        });
    }
    OutputFile::claim(&path.join(README))?;
    Ok(OutputDir::existing(path))
}

/// Whether a directory holds nothing, or these figures: by the first line of its text, or, if it has none, by the
/// names.
fn is_ours(dir: &Path) -> bool {
    let text = dir.join(README);
    if text.exists() {
        let title = format!("# {TITLE}");
        return fs::read_to_string(text).is_ok_and(|text| text.lines().next() == Some(&*title));
    }
    let ours = |name: &str| {
        let half = name.starts_with(ON_THE_WAY);
        half || name == README || name.starts_with("figure-") && name.ends_with(".svg")
    };
    let entries = fs::read_dir(dir).into_iter().flatten().flatten();
    let mut names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.all(|name| ours(&name))
}

/// Writes the figures as SVG and a README that lists them and the claims.
///
/// # Errors
/// If a file cannot be written, or a campaign that is part of the program has become unfit.
pub fn paper(out: &OutputDir) -> Result<Vec<Claim>, PaperError> {
    let simulate = |text, path| Scenarios::simulate(&Campaign::parse(text, Path::new(path))?);
    let uavs = simulate(UAVS, "campaigns/scenario-a.toml")?;
    let robots = simulate(ROBOTS, "campaigns/paper-robots.toml")?;
    let claims = claims(&uavs, &robots);
    let figures = figures::all(&uavs, &robots)?;
    for figure in &figures {
        out.write(&figure.file, figure.svg.as_bytes())?;
    }
    let mut text = markdown(&document(&claims), Length::Full);
    for figure in &figures {
        text.push_str(&format!(
            "\n## {}\n\n{}\n\n![{}]({})\n",
            figure.title, figure.caption, figure.title, figure.file
        ));
    }
    out.write(README, text.as_bytes())?;
    Ok(claims)
}

fn document(claims: &[Claim]) -> Document {
    let mut grid = Grid::new(["where", "the paper says", "holds here", "measured"]);
    for claim in claims {
        grid.rows.push(vec![
            Cell::text(claim.place),
            Cell::text(claim.claim),
            match claim.holds {
                Some(true) => Cell::Verdict(true, "yes".into()),
                Some(false) => Cell::Verdict(false, "no".into()),
                None => Cell::text("not decided"),
            },
            Cell::text(claim.measured.clone()),
        ]);
    }
    let count = |holds: Option<bool>| claims.iter().filter(|claim| claim.holds == holds).count();
    Document {
        title: TITLE.into(),
        subtitle: "Written by `urts-mc paper`: two deterministic episodes in double precision, three UAVs (campaigns/scenario-a.toml) \
                   and four robots (campaigns/paper-robots.toml), of which the first is shown."
            .into(),
        lead: vec![format!(
            "{} of {} claims of Section V hold in these episodes, {} do not, {} are not decided.",
            count(Some(true)),
            claims.len(),
            count(Some(false)),
            count(None),
        )],
        warnings: Vec::new(),
        sections: vec![Section::new(
            "Claims",
            vec![
                Block::Grid(grid),
                Block::text(
                    "The paper is on teams of UAVs and biped robots for search and rescue, with a fault-tolerant H-infinity controller. \
                     The copy that was used has neither title nor authors, so it is not cited.",
                ),
                Block::text(
                    "The robot is a Unitree G1 (the paper's is not published), the amplitudes of the sensor faults are ours, the \
                     initial errors have the size of the paper's but are the same on all channels. What the paper calls brief, high, \
                     much or insignificant has no number there: the bounds are ours, and stand with the measurements.",
                ),
                Block::text(
                    "Neither weights nor observer of the paper's PID are given. Read plainly (the weights of the FTC, an observer of \
                     three states that trusts every measurement alike) it has hardly any integral action: its poles lie at -0.1, -3.2 \
                     and -500 1/s. On the UAV it flies; on the robot it does not, while the paper's Figure 20 shows one that does. So \
                     every claim about the PID is judged under a second reading too, a PID whose error has a triple pole, which is \
                     what one would tune; of the robot the figure and the verdict are those of that reading.",
                ),
            ],
        )],
        ..Document::default()
    }
}
