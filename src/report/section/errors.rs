//! How closely the controllers follow, pair by pair and as distributions.

use crate::agent::ChannelRole;
use crate::campaign::ALL;
use crate::report::page::document::{Block, Cell, Figure, Grid, Section};
use crate::report::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::report::run_data::RunData;
use crate::results::curves::DISTRIBUTION;
use crate::run::table_reader::TableReader;
use crate::util::format;

/// Points of a drawn distribution: more cannot be told apart.
const MOST_POINTS: usize = 300;

/// Controllers up to which every pair is written out; of more, those with the first: the number of pairs grows as the
/// square of that of the controllers.
const WITH_ALL_PAIRS: usize = 12;

/// The comparison of every pair.
pub(crate) fn pairs(data: &RunData) -> Section {
    let sheet = &data.comparison;
    if sheet.rows() == 0 {
        let text = "One controller has nothing to be compared with.";
        return Section::new("Pair by pair", vec![Block::text(text)]);
    }
    let Columns {
        difference,
        log_ratio,
        interval,
    } = Columns::of(data);
    let head = Grid::new([
        "pair",
        "only the first fails",
        "only the second",
        "both",
        "difference of failure rates, points",
        "McNemar mid-p",
        "after Holm",
    ]);
    let [mut failures, mut other_failures] = [head.clone(), head];
    let head = Grid::new([
        "pair",
        "channel or group",
        "the first's RMS error is smaller by a factor of",
        "it wins",
    ]);
    let [mut errors, mut other_errors, mut channels] = [head.clone(), head.clone(), head];
    let first = data.campaign.controllers.first();
    let with_all = data.campaign.controllers.len() <= WITH_ALL_PAIRS;
    let mut last = String::new();
    for row in sheet.find(&[("stratum", ALL)]) {
        let pair = format!("{} against {}", sheet.text(row, "a"), sheet.text(row, "b"));
        let of_first = first.is_some_and(|first| *first == sheet.text(row, "a"));
        if !with_all && !of_first {
            continue;
        }
        if pair != last {
            let grid = if of_first {
                &mut failures
            } else {
                &mut other_failures
            };
            grid.rows.push(failures_of(sheet, row, &pair, difference));
            last.clone_from(&pair);
        }
        let grid = match (sheet.text(row, "scope"), of_first) {
            ("group", true) => &mut errors,
            ("group", false) => &mut other_errors,
            _ => &mut channels,
        };
        grid.rows.push(errors_of(sheet, row, &pair, log_ratio));
    }
    let explained = format!(
        "The same episodes under both controllers. Factor: median over the episodes of the ratio of RMS errors over the \
         team, {interval}; above 1 the first is closer. A diverged episode counts as \
         infinitely bad, a pair of two as a tie."
    );
    let mut blocks = vec![
        Block::Grid(failures),
        Block::Text(explained),
        Block::Grid(errors),
    ];
    if !other_errors.rows.is_empty() {
        let others = [other_failures, other_errors].map(Block::Grid);
        blocks.push(Block::Folded("Every other pair".into(), others.to_vec()));
    }
    blocks.push(Block::Folded(
        "Every channel".into(),
        vec![Block::Grid(channels)],
    ));
    if !with_all {
        blocks.push(Block::text(
            "Of so many controllers only the pairs with the first are here; comparison.csv has all.",
        ));
    }
    Section::new("Pair by pair", blocks)
}

/// Which columns of the comparison hold what the sampling design allows.
struct Columns {
    /// The difference of failure rates, whose ends are `_lower` and `_upper`.
    difference: &'static str,
    /// The log-ratio of the errors.
    log_ratio: &'static str,
    /// What its interval is.
    interval: &'static str,
}

impl Columns {
    fn of(data: &RunData) -> Self {
        let sheet = &data.comparison;
        let replicates = data.campaign.sampling.replicates().is_some();
        let known =
            (0..sheet.rows()).any(|row| sheet.real(row, "log_ratio_replicates").is_finite());
        let difference = match replicates {
            true => "failure_rate_difference_replicates",
            false => "failure_rate_difference",
        };
        let (log_ratio, interval) = match (replicates, known) {
            (true, true) => (
                "log_ratio_replicates",
                "with its 95 % interval (Student's t over the replicates)",
            ),
            (true, false) => (
                "log_ratio",
                "without an interval, since the replicates are too few",
            ),
            (false, _) => ("log_ratio", "with its 95 % interval (BCa)"),
        };
        Self {
            difference,
            log_ratio,
            interval,
        }
    }
}

/// How the errors of the controllers of a pair compare on some channels.
fn errors_of(sheet: &TableReader, row: usize, pair: &str, log_ratio: &str) -> Vec<Cell> {
    let factor = |side: &str| sheet.real(row, &format!("{log_ratio}{side}")).exp();
    vec![
        Cell::text(pair),
        Cell::text(sheet.text(row, "name")),
        Cell::number(format::measured(
            factor(""),
            factor("_lower"),
            factor("_upper"),
        )),
        Cell::number(format::rate(sheet.real(row, "win_rate"), None)),
    ]
}

/// How often the controllers of a pair fail.
fn failures_of(sheet: &TableReader, row: usize, pair: &str, difference: &str) -> Vec<Cell> {
    let of = |name: &str| sheet.real(row, name);
    vec![
        Cell::text(pair),
        Cell::number(format!("{:.0}", of("only_a_failed"))),
        Cell::number(format!("{:.0}", of("only_b_failed"))),
        Cell::number(format!("{:.0}", of("both_failed"))),
        Cell::number(format::points(
            // Over too few replicates there is the plain difference, without an interval.
            Some(of(difference))
                .filter(|own| own.is_finite())
                .unwrap_or_else(|| of("failure_rate_difference")),
            of(&format!("{difference}_lower")),
            of(&format!("{difference}_upper")),
        )),
        Cell::number(format::p_value(of("mcnemar_mid_p"))),
        Cell::number(format::p_value(of("mcnemar_mid_p_holm"))),
    ]
}

/// The distributions of the RMS error.
pub(crate) fn distributions(data: &RunData) -> Section {
    let roles = data.campaign.channel_groups();
    let groups = roles.iter().map(|of| {
        let group = &data.campaign.groups()[of.group];
        let limit = group.verdict.max_rmse[of.channels.start];
        ecdf(data, &of.name, of.role, limit)
    });
    let channels = roles.iter().flat_map(|of| {
        let group = &data.campaign.groups()[of.group];
        of.channels.clone().map(move |channel| {
            let limit = group.verdict.max_rmse[channel];
            ecdf(
                data,
                &group.titled(&group.channels()[channel]),
                of.role,
                limit,
            )
        })
    });
    let figure = |panels: Vec<Plot>, of: &str| Figure {
        panels,
        legend: data.legend(),
        caption: format!(
            "Share of the episodes whose RMS error over the team, {of}, from settle_s on, is at most the value. What \
             diverges or lies beyond the frame is missing: its curve ends below 1."
        ),
    };
    let table = Block::Grid(quantiles(data));
    let blocks = match data.manifest.episodes {
        0 | 1 => vec![table],
        _ if !data.has_curves() => vec![
            Block::text("A run of an older version has no curves to be drawn: run it again."),
            table,
        ],
        _ => vec![
            Block::Figure(figure(groups.collect(), "by channel group")),
            table,
            Block::Folded(
                "Every channel".into(),
                vec![Block::Figure(figure(channels.collect(), "by channel"))],
            ),
        ],
    };
    Section::new("Distribution of the errors", blocks)
}

/// Errors are drawn up to so many times the largest median, or the limit of the RMS error if that is more: those of
/// episodes that are about to diverge would leave no room for the others.
const FRAME: f64 = 20.0;

/// The empirical distribution of the errors on some channels by controller.
fn ecdf(data: &RunData, title: &str, role: ChannelRole, limit: f64) -> Plot {
    let curves = data.points(DISTRIBUTION, Some(title));
    let medians = curves.iter().filter_map(|points| {
        let (median, _) = points.iter().find(|(_, share)| *share > 0.5)?;
        Some(*median)
    });
    let largest = medians.fold(0.0, f64::max);
    let limit = if limit.is_finite() { limit } else { 0.0 };
    let frame = (FRAME * largest).max(2.0 * limit);
    let marks = curves.iter().enumerate().map(|(index, points)| {
        let stride = points.len().div_ceil(MOST_POINTS).max(1);
        let within = points
            .iter()
            .take_while(|(value, _)| *value <= frame)
            .count();
        // The last that is within the frame tells how many are.
        let kept = (0..within).filter(|place| place % stride == 0 || place + 1 == within);
        let kept = kept.map(|place| points[place]);
        // The curve goes on as a line to the end of the frame, beyond which the rest lies.
        let end = kept.clone().next_back();
        let end = end
            .filter(|(_, share)| *share < 1.0)
            .map(|(_, share)| (frame, share));
        Mark::Line(
            kept.chain(end).collect(),
            Color::Series(index),
            Stroke::Steps,
        )
    });
    Plot {
        title: title.into(),
        x: Axis {
            logarithmic: true,
            ..Axis::new(format!("RMS error, {}", role.unit()))
        },
        y: Axis {
            // A little room below, so that the labels of both axes do not meet in the corner.
            range: Some((-0.03, 1.03)),
            ..Axis::new("share of episodes")
        },
        marks: marks.collect(),
        ..Plot::default()
    }
}

fn quantiles(data: &RunData) -> Grid {
    let sheet = &data.summary;
    let mut grid = Grid::new([
        "controller",
        "error",
        "median [95 %]",
        "95th percentile [95 %]",
        "99th percentile [95 %]",
    ]);
    for row in sheet.find(&[("stratum", ALL)]) {
        // What commands cost, and how fast errors settle, is among the terms of the comparison.
        let name = match sheet.text(row, "metric") {
            "rmse" => "RMS",
            "max_abs" => "largest",
            _ => continue,
        };
        let group = sheet.text(row, "group");
        let roles = data.campaign.channel_groups();
        let role = roles.iter().find(|own| *own.name == *group);
        let Some(role) = role else { continue };
        let cell = |q: &str| {
            Cell::number(format::measured(
                sheet.real(row, q),
                sheet.real(row, &format!("{q}_lower")),
                sheet.real(row, &format!("{q}_upper")),
            ))
        };
        grid.rows.push(vec![
            Cell::text(sheet.text(row, "controller")),
            Cell::text(format!("{name}, {group}, {}", role.role.unit())),
            cell("q50"),
            cell("q95"),
            cell("q99"),
        ]);
    }
    grid
}
