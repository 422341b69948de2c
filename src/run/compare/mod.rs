//! Two runs of the same draws, compared episode by episode: two versions, gains, or controllers.

mod draws;
mod error;
mod files;

pub use error::CompareError;
pub use files::{claim, write};

use super::manifest::Manifest;
use super::scores_of_run::scores_of_run;
use super::table_reader::TableReader;
use crate::campaign::{ALL, Campaign, Compared, Detail, Requirement};
use crate::controllers::GainSet;
use crate::results::scores::Scores;
use crate::results::{
    Favour, MetricQuantiles, PairedComparison, RequirementResult, Terms, compare_pairs, judged,
    requirements, summarise, terms, unlike,
};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What is to be compared, beside the runs.
#[derive(Debug, Clone, Default)]
pub struct Asked {
    /// Controllers of the second run, each with one of the first; those of one name in both if none are given.
    pub pairs: Vec<[String; 2]>,
    /// Limits of how a measure of the second run compares with that of the first: "rmse position p50 <= 1.05".
    pub ratios: Vec<String>,
    /// The same of differences.
    pub differences: Vec<String>,
}

/// How two runs compare; for programs it is written as it stands here.
#[derive(Debug, Clone, Serialize)]
pub struct RunComparison {
    /// The first run, "A".
    pub a: ComparedRun,
    /// The second run, "B".
    pub b: ComparedRun,
    /// Episodes that both have.
    pub episodes: usize,
    /// Each pair of controllers.
    pub pairs: Vec<ComparedPair>,
    /// What became of the limits that were given.
    pub requirements: Vec<RequirementResult>,
    /// What there is to know beside.
    pub notes: Vec<String>,
    /// On what terms the controllers are compared.
    #[serde(rename = "fairness")]
    pub terms: Vec<Terms>,
    /// The statistics of each pair, in all episodes and in each stratum.
    pub comparisons: Vec<PairedComparison>,
    /// What the controllers of both runs are called in the tables: "A:ftc", "B:ftc".
    #[serde(skip)]
    pub campaign: Campaign,
    /// How large the errors of all of them are.
    #[serde(skip)]
    pub summary: Vec<MetricQuantiles>,
}

/// A run that is compared.
#[derive(Debug, Clone, Serialize)]
pub struct ComparedRun {
    /// Its directory.
    pub path: PathBuf,
    /// Name of its campaign.
    pub campaign: String,
    /// BLAKE3 hash of the campaign text, and of the settings laid over it.
    pub campaign_blake3: String,
    /// Version of the program.
    pub version: String,
    /// Revision of the program's source, where it was built from a repository.
    pub git_revision: Option<String>,
    /// Its episodes.
    pub episodes: u32,
}

/// How a controller of the second run compares with one of the first.
#[derive(Debug, Clone, Serialize)]
pub struct ComparedPair {
    /// The controller in the second run.
    pub b: String,
    /// The controller in the first.
    pub a: String,
    /// Episodes in which both did the same to the last digit.
    pub same: usize,
    /// What the comparison is for the second run; "against" and "mixed" are regressions.
    pub favour: Favour,
    /// The same in a sentence.
    pub verdict: String,
    /// In what the two are unlike, in a sentence, if they are.
    pub unlike: Option<String>,
}

impl ComparedPair {
    /// Whether the second run is surely worse in something that counts.
    #[must_use]
    pub fn is_regression(&self) -> bool {
        matches!(self.favour, Favour::Against | Favour::Mixed)
    }
}

/// A run, read back as far as a comparison needs it.
struct ReadRun {
    path: PathBuf,
    manifest: Manifest,
    campaign: Campaign,
    gains: Vec<GainSet>,
    episodes: TableReader,
    channels: TableReader,
}

impl ReadRun {
    fn read(path: &Path) -> Result<Self, CompareError> {
        let manifest = Manifest::read_verified(path)?;
        let campaign = manifest.campaign()?;
        if campaign.detail != Detail::All {
            return Err(CompareError::Detail {
                path: path.to_path_buf(),
                detail: campaign.detail.word(),
            });
        }
        let gains = GainSet::read(&campaign, &path.join("gains.json"))?;
        let table = |name: &str| {
            let table = TableReader::read(path, name, |_| true)?;
            table.ok_or_else(|| no_run(path, format!("{name}.parquet is missing")))
        };
        Ok(Self {
            episodes: table("episodes")?,
            channels: table("channels")?,
            path: path.to_path_buf(),
            manifest,
            campaign,
            gains,
        })
    }

    fn scores(&self, count: usize) -> Result<Scores, CompareError> {
        let tables = [&self.episodes, &self.channels];
        scores_of_run(&self.campaign, tables, count).map_err(|reason| no_run(&self.path, reason))
    }

    fn shown(&self) -> ComparedRun {
        let manifest = &self.manifest;
        ComparedRun {
            path: self.path.clone(),
            campaign: manifest.name.clone(),
            campaign_blake3: manifest.campaign_blake3.clone(),
            version: manifest.version.clone(),
            git_revision: manifest.git_revision.clone(),
            episodes: manifest.episodes,
        }
    }
}

fn no_run(path: &Path, reason: String) -> CompareError {
    let path = path.to_path_buf();
    super::error::OutputError::NoRun { path, reason }.into()
}

/// Compares the run in the directory `b` with that in `a`, episode by episode.
///
/// # Errors
/// If a directory holds no run, the runs did not meet the same, or have no controllers to compare.
pub fn compare_runs(a: &Path, b: &Path, asked: &Asked) -> Result<RunComparison, CompareError> {
    let (a, b) = (ReadRun::read(a)?, ReadRun::read(b)?);
    let mut what = draws::of_campaigns(&a.campaign, &b.campaign);
    let count = a.manifest.episodes.min(b.manifest.episodes);
    let episodes = count as usize;
    if what.is_empty() {
        let [ours, theirs] = [&a, &b].map(|run| (&run.campaign, &run.episodes));
        what.extend(draws::of_tables(ours, theirs, episodes));
    }
    if !what.is_empty() {
        let [a, b] = [a.path, b.path];
        return Err(CompareError::Differ { a, b, what });
    }
    let pairs = pairs(&a.campaign, &b.campaign, asked)?;
    // The controllers of the second behind those of the first.
    let mut scores = a.scores(episodes)?;
    scores.extend(b.scores(episodes)?);
    let names = |label: char, run: &ReadRun| {
        let names = run.campaign.controllers.iter();
        names
            .map(|name| format!("{label}:{name}"))
            .collect::<Vec<_>>()
    };
    let controllers = [names('A', &a), names('B', &b)].concat();
    let campaign = a.campaign.clone().with(|parts| {
        parts.controllers = controllers;
        parts.episodes = count;
        // Which of the two ended by chance matters to what is compared, whichever it is.
        parts.stop = parts.stop.take().or(b.campaign.stop.clone());
    });
    let demands = demands(&campaign, &pairs, asked)?;
    let campaign = campaign.with(|parts| parts.requirements = demands);
    let gains: Vec<GainSet> = a.gains.iter().zip(&b.gains).map(both).collect();
    let comparisons = compare_pairs(&campaign, &scores, pairs.iter().copied());
    let summary = summarise(&campaign, &scores);
    let terms = terms(&campaign, &gains, &scores);
    Ok(RunComparison {
        episodes,
        pairs: compared(&campaign, &scores, &pairs, &comparisons, &summary, &terms),
        requirements: requirements(&campaign, &gains, &scores),
        notes: notes(&a.manifest, &b.manifest),
        terms,
        comparisons,
        summary,
        a: a.shown(),
        b: b.shown(),
        campaign,
    })
}

/// The controllers of both gain sets.
fn both((a, b): (&GainSet, &GainSet)) -> GainSet {
    GainSet {
        controllers: [&a.controllers[..], &b.controllers].concat(),
    }
}

/// The pairs that are compared, each the place of the second run's controller among all of both runs, then that of the
/// first run's.
fn pairs(a: &Campaign, b: &Campaign, asked: &Asked) -> Result<Vec<[usize; 2]>, CompareError> {
    let (ours, theirs) = (&a.controllers, &b.controllers);
    let place = |all: &[String], name: &String| all.iter().position(|own| own == name);
    if asked.pairs.is_empty() {
        let common = theirs.iter().enumerate();
        let common =
            common.filter_map(|(index, name)| Some([ours.len() + index, place(ours, name)?]));
        let common: Vec<[usize; 2]> = common.collect();
        if common.is_empty() {
            return Err(CompareError::usage(
                "--pair",
                "not given",
                &format!(
                    "no controller is in both runs: {} in the first, {} in the second",
                    ours.join(", "),
                    theirs.join(", ")
                ),
                "name one of each, such as --pair ftc-tuned=ftc (the second run's first)",
            ));
        }
        return Ok(common);
    }
    let of_pair = |[b, a]: &[String; 2]| {
        let found = |all: &[String], name: &String, which: &str| {
            place(all, name).ok_or_else(|| {
                CompareError::usage(
                    "--pair",
                    name,
                    &format!("the {which} run's controllers are {}", all.join(", ")),
                    "name one of them: the second run's first, as in --pair ftc-tuned=ftc",
                )
            })
        };
        Ok([
            ours.len() + found(theirs, b, "second")?,
            found(ours, a, "first")?,
        ])
    };
    asked.pairs.iter().map(of_pair).collect()
}

/// How a number is compared to that of a controller.
type ComparedTo = fn(String) -> Compared;

/// The limits that were given, for every pair.
fn demands(
    campaign: &Campaign,
    pairs: &[[usize; 2]],
    asked: &Asked,
) -> Result<Vec<Requirement>, CompareError> {
    let mut all = Vec::new();
    let kinds: [(_, _, ComparedTo); 2] = [
        ("--ratio", &asked.ratios, Compared::RatioTo),
        ("--difference", &asked.differences, Compared::DifferenceTo),
    ];
    for [b, a] in pairs {
        let [b, a] = [b, a].map(|place| campaign.controllers[*place].clone());
        for (option, texts, compared_to) in kinds {
            for text in texts {
                let found = campaign.demanded(&b, &compared_to(a.clone()), text);
                all.extend(found.map_err(|error| CompareError::of_option(option, error))?);
            }
        }
    }
    for (place, own) in all.iter_mut().enumerate() {
        own.place = place;
    }
    Ok(all)
}

/// How the pairs compare in all episodes.
fn compared(
    campaign: &Campaign,
    scores: &Scores,
    pairs: &[[usize; 2]],
    comparisons: &[PairedComparison],
    summary: &[MetricQuantiles],
    terms: &[Terms],
) -> Vec<ComparedPair> {
    let of_all = comparisons.iter().filter(|own| *own.stratum == *ALL);
    let of_all: Vec<&PairedComparison> = of_all.collect();
    let judged = judged(campaign, summary, &of_all, &[]);
    let of_pair = |(&[b, a], (favour, verdict)): (&[usize; 2], (Favour, String))| {
        let same = (0..scores.episodes())
            .filter(|&episode| scores.alike([b, a], episode))
            .count();
        let [b, a] = [b, a].map(|place| campaign.controllers[place].clone());
        let of = |name: &str| {
            let own = terms.iter().filter(|own| own.controller == name);
            own.cloned().collect::<Vec<Terms>>()
        };
        let verdict = match same == scores.episodes() {
            true => format!("{b} equals {a}: all {same} episodes end alike, to the last digit"),
            false => verdict,
        };
        ComparedPair {
            unlike: unlike(&[of(&b), of(&a)].concat()).into_iter().next(),
            same,
            favour,
            verdict,
            b,
            a,
        }
    };
    pairs.iter().zip(judged).map(of_pair).collect()
}

/// What may explain a difference, and what was left out.
fn notes(a: &Manifest, b: &Manifest) -> Vec<String> {
    let mut notes = Vec::new();
    let mut differ = |what: &str, a: String, b: String| {
        if a != b {
            notes.push(format!("{what}: {a} in A, {b} in B"));
        }
    };
    let revision = |run: &Manifest| {
        let revision = run.git_revision.as_deref();
        match revision {
            Some(revision) => format!("{} ({revision})", run.version),
            None => run.version.clone(),
        }
    };
    differ("version", revision(a), revision(b));
    let precision = |run: &Manifest| format!("{:?}", run.precision).to_lowercase();
    differ("precision", precision(a), precision(b));
    let engines = |run: &Manifest| {
        let all = run.segments.iter();
        let all: Vec<String> = all.map(|segment| segment.engine.to_string()).collect();
        all.join(", then ")
    };
    differ("simulated on", engines(a), engines(b));
    if a.episodes != b.episodes {
        let (fewer, more) = (a.episodes.min(b.episodes), a.episodes.max(b.episodes));
        notes.push(format!(
            "A has {} episodes, B has {}; the first {fewer} are compared, and the other {} are left out",
            a.episodes,
            b.episodes,
            more - fewer
        ));
    }
    for (name, run) in [("A", a), ("B", b)] {
        if let Some(reason) = &run.interrupted {
            notes.push(format!("{name} was interrupted: {reason}"));
        }
    }
    notes
}
