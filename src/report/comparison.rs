//! How two runs of the same draws compare: a page, and what of it the terminal shows.

use super::page::document::{Block, Cell, Document, Grid, Section};
use super::page::html;
use super::page::markdown::{self, Length};
use super::requirements::{bound, demanded};
use crate::campaign::ALL;
use crate::results::{PairedComparison, RateMethod, Terms, how_sure};
use crate::run::compare::{ComparedRun, RunComparison};
use crate::util::format;

/// The page of a comparison in HTML and in Markdown.
#[must_use]
pub fn comparison(found: &RunComparison) -> [String; 2] {
    let document = Document {
        warnings: regressions(found).into_iter().collect(),
        sections: vec![
            pairs(found),
            requirements(found),
            strata(found),
            on_what_terms(found),
            runs(found),
        ]
        .into_iter()
        .filter(|section| !section.is_empty())
        .collect(),
        ..head(found)
    };
    [
        html::html(&document),
        markdown::markdown(&document, Length::Brief),
    ]
}

/// What has become worse, or is not proved, one a line; none if nothing has.
#[must_use]
pub fn regressions(found: &RunComparison) -> Option<String> {
    let worse = found.pairs.iter().filter(|pair| pair.is_regression());
    let worse = worse.map(|pair| pair.verdict.clone());
    let unmet = found.requirements.iter().filter(|own| !own.is_met());
    let all: Vec<String> = worse.chain(unmet.map(demanded)).collect();
    (!all.is_empty()).then(|| all.join("\n"))
}

/// What is compared, and what comes of it.
pub(super) fn head(found: &RunComparison) -> Document {
    let sentences = found.pairs.iter().map(|pair| pair.verdict.clone());
    let unlike = found.pairs.iter().filter_map(|pair| pair.unlike.clone());
    let sure = match found.episodes {
        0 | 1 => None,
        _ => Some(format!("({})", how_sure(&found.campaign))),
    };
    Document {
        title: format!("{} against {}", found.b.campaign, found.a.campaign),
        subtitle: format!(
            "B is {}, A is {}: {} episodes that met the same, compared one by one",
            found.b.path.display(),
            found.a.path.display(),
            found.episodes
        ),
        lead: sentences.chain(unlike).chain(sure).collect(),
        ..Document::default()
    }
}

/// How often each of the pairs fails, and how their errors compare.
pub(super) fn pairs(found: &RunComparison) -> Section {
    let of_all = found.comparisons.iter().filter(|own| *own.stratum == *ALL);
    let grids = grids(of_all.map(|own| (format!("{} against {}", own.a, own.b), own)));
    let mut blocks: Vec<Block> = grids.into_iter().map(Block::Grid).collect();
    let alike = found.pairs.iter().map(|pair| {
        let (b, a, same) = (&pair.b, &pair.a, pair.same);
        format!("{b} and {a}: {same} of {}", found.episodes)
    });
    let alike: Vec<String> = alike.collect();
    blocks.push(Block::Text(format!(
        "Episodes that end alike to the last digit: {}.",
        alike.join("; ")
    )));
    Section::new("Pair by pair", blocks)
}

/// The same of each stratum.
fn strata(found: &RunComparison) -> Section {
    let others = found.comparisons.iter().filter(|own| *own.stratum != *ALL);
    let named = others.map(|own| (format!("{}: {} against {}", own.stratum, own.b, own.a), own));
    let grids = grids(named);
    Section::new(
        "Stratum by stratum",
        grids.into_iter().map(Block::Grid).collect(),
    )
}

/// Failures, and errors, of some comparisons.
fn grids<'a>(comparisons: impl Iterator<Item = (String, &'a PairedComparison)>) -> [Grid; 2] {
    let mut failures = Grid::new([
        "pair",
        "only the first fails",
        "only the second",
        "both",
        "difference of failure rates, points",
        "McNemar mid-p",
    ]);
    let mut errors = Grid::new([
        "pair",
        "channels",
        "the first's RMS error is smaller by a factor of",
        "it wins",
    ]);
    for (name, own) in comparisons {
        let counted = |count: u64| Cell::number(count.to_string());
        let known = own.known();
        let ends = known.and_then(|known| known.interval);
        let ends = ends.map_or([f64::NAN; 2], |ends| [ends.lower, ends.upper]);
        failures.rows.push(vec![
            Cell::text(&*name),
            counted(own.failures.only_a),
            counted(own.failures.only_b),
            counted(own.failures.both),
            Cell::number(known.map_or("-".to_string(), |known| {
                format::points(known.value, ends[0], ends[1])
            })),
            Cell::number(own.p().map_or("-".to_string(), format::p_value)),
        ]);
        for ratio in own.ratios.iter().filter(|ratio| ratio.scope == "group") {
            let known = ratio.known();
            let ends = known.and_then(|known| known.interval);
            let factor = |value: Option<f64>| value.map_or(f64::NAN, f64::exp);
            let wins = ratio.win_rate.map(|own| own.value);
            errors.rows.push(vec![
                Cell::text(&*name),
                Cell::text(&*ratio.name),
                Cell::number(format::measured(
                    factor(known.map(|known| known.value)),
                    factor(ends.map(|ends| ends.lower)),
                    factor(ends.map(|ends| ends.upper)),
                )),
                Cell::number(wins.map_or("-".to_string(), |wins| format::rate(wins, None))),
            ]);
        }
    }
    [failures, errors]
}

/// What became of the limits that were given.
pub(super) fn requirements(found: &RunComparison) -> Section {
    let mut grid = Grid::new([
        "limit",
        "measure",
        "asked",
        "95 % sure",
        "found",
        "episodes",
    ]);
    for result in &found.requirements {
        let met = result.is_met();
        grid.rows.push(vec![
            Cell::Verdict(met, if met { "holds" } else { "NOT PROVED" }.to_string()),
            Cell::text(format!("{} of {}", result.quantity, result.subject())),
            Cell::number(format!("{} {}", result.side.words(), result.limit)),
            Cell::number(bound(result)),
            Cell::number(result.value.map_or("-".to_string(), format::number)),
            Cell::number(result.n.to_string()),
        ]);
    }
    Section::new("Limits", vec![Block::Grid(grid)])
}

/// Bandwidth, margins and costs of every controller.
fn on_what_terms(found: &RunComparison) -> Section {
    let mut grid = Grid::new([
        "controller",
        "channels",
        "crossover, rad/s",
        "delay margin, ms",
        "peak of S",
        "noise gain, peak",
        "largest command, 95th percentile",
        "effort, median",
        "share of time at a limit",
        "settled, median, s",
    ]);
    let compared = |own: &&Terms| {
        let name = &own.controller;
        found
            .pairs
            .iter()
            .any(|pair| pair.a == *name || pair.b == *name)
    };
    for own in found.terms.iter().filter(compared) {
        let number = |value: Option<f64>| Cell::number(format::number(value.unwrap_or(f64::NAN)));
        let margins = own.margins.as_ref();
        grid.rows.push(vec![
            Cell::text(&*own.controller),
            Cell::text(&*own.group),
            number(margins.map(|own| own.crossover_rad_s)),
            number(margins.map(|own| own.delay_margin_ms)),
            number(margins.map(|own| own.sensitivity_peak)),
            number(margins.map(|own| own.noise_peak)),
            number(own.peak_command_p95),
            number(own.effort_p50),
            Cell::number(format::rate(own.saturated_share.unwrap_or(f64::NAN), None)),
            number(own.settling_p50_s),
        ]);
    }
    Section::new("On what terms", vec![Block::Grid(grid)])
}

/// Where the runs come from.
fn runs(found: &RunComparison) -> Section {
    let mut grid = Grid::new([
        "run",
        "directory",
        "campaign",
        "version",
        "episodes",
        "campaign hash",
    ]);
    for (name, run) in [("A", &found.a), ("B", &found.b)] {
        let ComparedRun {
            path,
            campaign,
            campaign_blake3,
            version,
            git_revision,
            episodes,
        } = run;
        let version = match git_revision {
            Some(revision) => format!("{version} ({revision})"),
            None => version.clone(),
        };
        let hash: String = campaign_blake3.chars().take(12).collect();
        grid.rows.push(vec![
            Cell::text(name),
            Cell::Code(path.display().to_string()),
            Cell::text(&**campaign),
            Cell::text(version),
            Cell::number(episodes.to_string()),
            Cell::Code(hash),
        ]);
    }
    let notes = found.notes.iter().map(Block::text);
    let intervals = format!(
        "Intervals of failure rates: {}.",
        RateMethod::of(&found.campaign).short()
    );
    let blocks = std::iter::once(Block::Grid(grid))
        .chain(notes)
        .chain([Block::Text(intervals)]);
    Section::new("The runs", blocks.collect())
}
