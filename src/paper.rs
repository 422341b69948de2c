//! The counterparts of the paper's Figures 8 and 10 to 20 and of the claims in its Section V, each with the number measured here.
//!
//! Two deterministic campaigns are flown in double precision on the CPU: the three UAVs of scenario A, and four robots on the same
//! walk. The figures are not the paper's: its robot, references and faults are known in part only.

mod claims;
mod figures;

use crate::backend::cpu::{Cpu, Precision};
use crate::campaign::{Campaign, CampaignError, FTC, PID};
use crate::gains::{GainSet, GainsError};
use crate::model::Shown;
use crate::model::episode::Snapshot;
use crate::output::{OutputDir, OutputError};
use crate::report::document::{Block, Cell, Document, Grid, Section};
use crate::report::markdown::markdown;
use std::path::Path;
use thiserror::Error;

/// The campaign of the UAVs.
const UAVS: &str = include_str!("../campaigns/scenario-a.toml");
/// The campaign of the robots.
const ROBOTS: &str = include_str!("../campaigns/paper-robots.toml");
/// Steps between two samples: 10 ms.
const EVERY: u32 = 10;

/// Why the figures cannot be made.
#[derive(Debug, Error)]
pub enum PaperError {
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A campaign that is part of the program is not one.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// Its gains cannot be had.
    #[error(transparent)]
    Gains(#[from] GainsError),
}

/// A claim of the paper, and what was measured.
#[derive(Debug, Clone)]
pub struct Claim {
    /// Where the paper says so.
    pub place: &'static str,
    /// What it says, in short.
    pub claim: &'static str,
    /// What was measured here.
    pub measured: String,
    /// Whether it holds; none where the flight does not decide.
    pub holds: Option<bool>,
}

/// The first agent of a campaign under the FTC and under the PID.
struct Flights {
    campaign: Campaign,
    ftc: Vec<Snapshot>,
    pid: Vec<Snapshot>,
}

impl Flights {
    fn of(text: &str, name: &str) -> Result<Self, PaperError> {
        let mut campaign = Campaign::parse(text, Path::new(name))?;
        campaign.controllers = [FTC, PID].map(Into::into).to_vec();
        let gains = GainSet::obtain(&campaign)?;
        let cpu = Cpu::new(&campaign, &gains.loops(), Precision::F64, None);
        let (ftc, pid) = rayon::join(|| cpu.trace(0, 0, EVERY).1, || cpu.trace(0, 1, EVERY).1);
        Ok(Self { campaign, ftc, pid })
    }

    /// A quantity of a channel of the first agent over time, s.
    fn series(
        &self,
        flight: &[Snapshot],
        channel: usize,
        pick: fn(&Shown) -> f64,
    ) -> Vec<(f64, f64)> {
        let of_channel = |snapshot: &Snapshot| {
            let shown = snapshot.agents.first()?.get(channel)?;
            Some((
                f64::from(snapshot.step) * self.campaign.time.step_s,
                pick(shown),
            ))
        };
        flight.iter().filter_map(of_channel).collect()
    }
}

/// Writes the figures as SVG and a README that lists them and the claims.
///
/// # Errors
/// If a file cannot be written.
pub fn paper(out: &OutputDir) -> Result<Vec<Claim>, PaperError> {
    let uavs = Flights::of(UAVS, "campaigns/scenario-a.toml")?;
    let robots = Flights::of(ROBOTS, "campaigns/paper-robots.toml")?;
    let claims = claims::all(&uavs, &robots);
    let figures = figures::all(&uavs, &robots);
    for figure in &figures {
        out.write(&figure.file, figure.svg.as_bytes())?;
    }
    let mut text = markdown(&document(&claims));
    for figure in &figures {
        text.push_str(&format!(
            "\n## {}\n\n{}\n\n![{}]({})\n",
            figure.title, figure.caption, figure.title, figure.file
        ));
    }
    out.write("README.md", text.as_bytes())?;
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
    let holding = claims
        .iter()
        .filter(|claim| claim.holds == Some(true))
        .count();
    Document {
        title: "The paper's figures and claims".into(),
        subtitle: "Written by `urts-mc paper`: two deterministic flights in double precision, three UAVs (campaigns/scenario-a.toml) \
                   and four robots (campaigns/paper-robots.toml), of which the first is shown."
            .into(),
        lead: vec![format!(
            "{holding} of {} claims of Section V hold in these flights.",
            claims.len()
        )],
        warnings: Vec::new(),
        sections: vec![Section::new(
            "Claims",
            vec![
                Block::Grid(grid),
                Block::text(
                    "The robot is a Unitree G1 (the paper's is not published), the amplitude of its sensor fault is ours, and the \
                     observer of the paper's PID is not specified: it is the one of three states that its text suggests.",
                ),
            ],
        )],
    }
}
