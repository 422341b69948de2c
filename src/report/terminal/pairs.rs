//! How each pair of controllers compares.

use crate::campaign::{ALL, Campaign};
use crate::report::page::document::{Block, Cell, Grid, Section};
use crate::results::{Measured, PairedComparison, Ratio};
use crate::run::Findings;
use crate::statistics::Interval;

/// Channels that are shown one by one.
const MOST_CHANNELS: usize = 6;

/// How each pair of controllers compares.
pub(super) fn pairs(campaign: &Campaign, findings: &Findings) -> Section {
    let interval = match campaign.sampling.replicates() {
        Some(_) => "t over replicates",
        None => "BCa",
    };
    let note = format!(
        ": how many times smaller the RMS error of the first is, median [{interval} 95 %], and how often it wins"
    );
    let pairs = findings.results.comparisons.iter();
    let of_all = pairs.filter(|own| *own.stratum == *ALL);
    Section::explained("pair by pair", note, of_all.map(pair).collect())
}

fn pair(comparison: &PairedComparison) -> Block {
    let (shown, left_out) = worth_showing(&comparison.ratios);
    let mut blocks = vec![Block::Grid(Grid {
        head: Vec::new(),
        rows: shown.into_iter().map(ratio_cells).collect(),
    })];
    if left_out > 0 {
        let rest = "between these two; comparison.csv has them all";
        blocks.push(Block::Text(format!("{left_out} more channels lie {rest}")));
    }
    blocks.push(Block::Text(format!(
        "failures  {}",
        failures_text(comparison)
    )));
    let diverged = comparison
        .ratios
        .iter()
        .map(|ratio| ratio.diverged.iter().sum());
    let diverged: u64 = diverged.max().unwrap_or(0);
    if diverged > 0 {
        blocks.push(Block::Text(format!(
            "a diverged episode counts as infinitely bad: {diverged} pairs"
        )));
    }
    let title = format!("{} against {}", comparison.a, comparison.b);
    Block::Folded(title, blocks)
}

/// The groups, and of many channels the one where the first controller gains least and the one where it gains most; and
/// how many are left out.
fn worth_showing(ratios: &[Ratio]) -> (Vec<&Ratio>, usize) {
    let (mut shown, mut channels): (Vec<&Ratio>, Vec<&Ratio>) =
        ratios.iter().partition(|ratio| ratio.scope == "group");
    let mut left_out = 0;
    if channels.len() > MOST_CHANNELS {
        let value = |ratio: &Ratio| ratio.log_ratio.map_or(f64::NAN, |ratio| ratio.value);
        channels.sort_by(|a, b| value(a).total_cmp(&value(b)));
        left_out = channels.len() - 2;
        channels = vec![channels[0], channels[left_out + 1]];
    }
    shown.extend(channels);
    (shown, left_out)
}

fn ratio_cells(ratio: &Ratio) -> Vec<Cell> {
    let name = Cell::text(&*ratio.name);
    let Some(Measured { value, interval }) = ratio.known() else {
        return vec![name, Cell::number("no episodes")];
    };
    // Of a few episodes every ratio may be the median.
    let known = interval.filter(|own| own.lower.is_finite() || own.upper.is_finite());
    let interval = known.map_or("[-]".to_string(), |Interval { lower, upper }| {
        format!("[{}, {}]", times(lower), times(upper))
    });
    let wins = ratio.win_rate.map_or(String::new(), |rate| {
        format!("wins {:>5.1} %", 100.0 * rate.value)
    });
    vec![
        name,
        Cell::number(times(value)),
        Cell::text(interval),
        Cell::text(wins),
    ]
}

fn times(log_ratio: f64) -> String {
    let ratio = log_ratio.exp();
    if ratio.is_infinite() {
        "inf".into()
    } else {
        format!("{ratio:.2}x")
    }
}

fn failures_text(comparison: &PairedComparison) -> String {
    let failures = &comparison.failures;
    let difference = comparison.known().map_or(String::new(), |difference| {
        let interval = difference.interval.map_or(String::new(), |interval| {
            format!(
                " [{:+.2}, {:+.2}]",
                100.0 * interval.lower,
                100.0 * interval.upper
            )
        });
        format!("{:+.2} points{interval}, ", 100.0 * difference.value)
    });
    format!(
        "{difference}only {} {}, only {} {}, both {}{}",
        comparison.a,
        failures.only_a,
        comparison.b,
        failures.only_b,
        failures.both,
        comparison.mid_p.map_or(String::new(), |mid_p| format!(
            ", McNemar mid-p {}",
            if mid_p < 0.001 {
                format!("{mid_p:.1e}")
            } else {
                format!("{mid_p:.3}")
            }
        )),
    )
}
