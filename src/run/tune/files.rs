//! The directory of a search: its findings, every candidate as a row, and the gains that it found.

use super::trial::Evaluation;
use super::tuning::{TuneError, Tuning};
use crate::campaign::{Campaign, Measure};
use crate::controllers::{GainSet, SimulatedController};
use crate::results::Measured;
use crate::results::table::Table;
use crate::run::directory::OutputDir;
use crate::run::error::OutputError;
use crate::run::labels::Labels;
use crate::run::manifest::{GIT_REVISION, campaign_hash};
use crate::util::json::pretty;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The findings of a search, which are written last.
const FINDINGS: &str = "tune.json";
/// The gains that it found.
const GAINS: &str = "gains.json";
/// Every candidate.
const TABLES: [&str; 2] = ["tune.parquet", "tune.csv"];
/// The pages on it.
const PAGES: [&str; 2] = ["tune.html", "tune.md"];

/// Where gains come from that a search found: enough to find them again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// The command.
    pub command: String,
    /// Version of the program.
    pub version: String,
    /// Revision of the program's source, where it was built from a repository.
    pub git_revision: Option<String>,
    /// Name of the campaign.
    pub campaign: String,
    /// BLAKE3 hash of its text, and of the settings laid over it.
    pub campaign_blake3: String,
    /// The seed that all episodes of the search follow from.
    pub seed: u64,
    /// Candidates that were tried.
    pub candidates: usize,
    /// Episodes of each.
    pub episodes: u32,
    /// Fresh episodes of the confirmation.
    pub confirmation: u32,
    /// What was to be small.
    pub minimise: Vec<String>,
    /// What had to hold.
    pub limits: Vec<String>,
    /// The parameters that were found.
    pub parameters: BTreeMap<String, f64>,
    /// What they give in the fresh episodes, with the ends of the 95 % interval where chance is in it.
    pub confirmed: BTreeMap<String, Vec<f64>>,
    /// Which of the limits do not hold in the fresh episodes.
    pub broken: Vec<String>,
}

/// tune.json.
#[derive(Debug, Serialize)]
struct Findings<'a> {
    #[serde(flatten)]
    provenance: Provenance,
    /// What is measured, in the order of the numbers below.
    measures: Vec<String>,
    /// What the search began with, in the fresh episodes.
    start: &'a Evaluation,
    /// What it found, in the same episodes.
    confirmed_evaluation: &'a Evaluation,
    /// What was to choose from, best first.
    finalists: &'a [Evaluation],
}

/// Claims a directory before any work is done: it may be absent, empty, or hold an earlier search of the same campaign;
/// anything else is refused unless `overwrite`.
///
/// # Errors
/// If the directory holds something else or cannot be written. Nothing is left behind then.
pub fn claim(path: &Path, campaign: &Campaign, overwrite: bool) -> Result<OutputDir, OutputError> {
    let is_own = |name: &str| {
        let known = TABLES.iter().chain(&PAGES).chain(&[FINDINGS, GAINS]);
        known.into_iter().any(|own| *own == name)
    };
    let earlier = std::fs::read_to_string(path.join(FINDINGS)).ok();
    let earlier = earlier.and_then(|text| serde_json::from_str::<serde_json::Value>(&text).ok());
    let of_other = earlier.is_some_and(|found| {
        found["campaign_blake3"] != campaign_hash(campaign) || found["seed"] != campaign.seed
    });
    let what = of_other.then(|| "a search on another campaign, or with another seed".to_string());
    OutputDir::claim_for(path, overwrite, &is_own, what)
}

/// Writes a search with its pages, HTML and Markdown: the findings are taken away first and written last, so that a
/// directory that has them is whole.
///
/// # Errors
/// If a file cannot be encoded or written.
pub fn write(tuning: &Tuning, pages: &[String; 2], out: &OutputDir) -> Result<(), TuneError> {
    out.remove(FINDINGS)?;
    let [parquet, csv] = TABLES;
    let table = table(tuning);
    out.write_parquet(parquet, &table, &Labels::new(&tuning.campaign, "tune"))?;
    out.write_csv(csv, &table)?;
    out.write(GAINS, &pretty(&gains(tuning)?)?)?;
    for (name, page) in PAGES.into_iter().zip(pages) {
        out.write(name, page.as_bytes())?;
    }
    out.write(FINDINGS, &pretty(&findings(tuning))?)?;
    Ok(())
}

/// What a search found, for programs.
///
/// # Errors
/// If it cannot be encoded.
pub fn json(tuning: &Tuning) -> Result<serde_json::Value, serde_json::Error> {
    serde_json::to_value(findings(tuning))
}

fn findings(tuning: &Tuning) -> Findings<'_> {
    Findings {
        provenance: provenance(tuning),
        measures: tuning.measures.iter().map(Measure::to_string).collect(),
        start: &tuning.start,
        confirmed_evaluation: &tuning.confirmed,
        finalists: &tuning.finalists,
    }
}

/// The gains as a file that `[synthesis.named]` takes.
fn gains(tuning: &Tuning) -> Result<impl Serialize + use<>, serde_json::Error> {
    let campaign = &tuning.campaign;
    let names = vec![tuning.structure.tuned.to_string()];
    let campaign = campaign
        .clone()
        .drawn_anew(campaign.seed, campaign.episodes, names);
    let set = |controller: &SimulatedController| GainSet {
        controllers: vec![controller.clone()],
    };
    let sets: Vec<GainSet> = tuning.controllers.iter().map(set).collect();
    let mut file = GainSet::to_file(&campaign, &sets);
    file.provenance = Some(serde_json::to_value(provenance(tuning))?);
    // They are found anew wherever the gains are named.
    let groups = file.groups.values_mut().map(|own| &mut own.controllers);
    for controllers in groups.chain([&mut file.controllers]) {
        controllers.values_mut().for_each(|own| own.findings = None);
    }
    Ok(file)
}

fn provenance(tuning: &Tuning) -> Provenance {
    let campaign = &tuning.campaign;
    let settings = campaign
        .overlay
        .iter()
        .map(|setting| format!(" --set '{setting}'"));
    let named = tuning.measures.iter().zip(&tuning.confirmed.measured);
    let confirmed = named.map(|(measure, Measured { value, interval })| {
        let ends = interval.iter().flat_map(|own| [own.lower, own.upper]);
        (
            measure.to_string(),
            std::iter::once(*value).chain(ends).collect(),
        )
    });
    let limits = tuning.limits.iter().map(|(_, limit)| limit.to_string());
    let limits: Vec<String> = limits.collect();
    let judged = limits.iter().zip(&tuning.confirmed.holds);
    Provenance {
        command: format!(
            "urts-mc tune {} --controller {} --seed {}{}",
            campaign.path.display(),
            tuning.structure.name,
            campaign.seed,
            settings.collect::<String>()
        ),
        version: env!("CARGO_PKG_VERSION").to_string(),
        git_revision: GIT_REVISION.map(String::from),
        campaign: campaign.name.clone(),
        campaign_blake3: campaign_hash(campaign),
        seed: campaign.seed,
        candidates: tuning.tried(),
        episodes: tuning.asked.episodes,
        confirmation: tuning.asked.confirmation,
        minimise: tuning
            .minimised
            .iter()
            .map(|own| tuning.measures[*own].to_string())
            .collect(),
        broken: judged
            .filter(|(_, holds)| !**holds)
            .map(|(limit, _)| limit.clone())
            .collect(),
        limits,
        parameters: tuning
            .parameters()
            .into_iter()
            .zip(tuning.confirmed.values.iter().copied())
            .collect(),
        confirmed: confirmed.collect(),
    }
}

/// A row for each candidate: of the search, of the choice among the finalists, and of the confirmation.
fn table(tuning: &Tuning) -> Table {
    let mut table = Table::default();
    let mut add = |stage: &'static str, generation: usize, evaluations: &[Evaluation]| {
        for (candidate, own) in evaluations.iter().enumerate() {
            let mut row = table.row();
            row.word(|| "stage".into(), stage)
                .count(|| "generation".into(), generation as u64)
                .count(|| "candidate".into(), candidate as u64);
            for (name, value) in tuning.parameters().iter().zip(&own.values) {
                row.real_if(&column(name), Some(*value));
            }
            row.real_if("objective", Some(own.objective))
                .real_if("excess", Some(own.excess))
                .flag(|| "holds".into(), own.holds_all())
                .name(
                    || "refused".into(),
                    own.refused.as_deref().unwrap_or_default().into(),
                );
            for (place, measure) in tuning.measures.iter().enumerate() {
                let found = own.measured.get(place).map(|found| found.value);
                row.real_if(&column(&measure.to_string()), found);
            }
            for (place, (_, limit)) in tuning.limits.iter().enumerate() {
                let name = format!("bound_{}", column(&limit.measure.to_string()));
                row.real_if(&name, own.bounds.get(place).copied());
            }
        }
    };
    for (number, generation) in tuning.generations.iter().enumerate() {
        add("search", number, generation);
    }
    let after = tuning.generations.len();
    add("choice", after, &tuning.finalists);
    add("start", after, std::slice::from_ref(&tuning.start));
    add(
        "confirmation",
        after,
        std::slice::from_ref(&tuning.confirmed),
    );
    table
}

/// A name as that of a column.
fn column(name: &str) -> String {
    name.replace(' ', "_")
}
