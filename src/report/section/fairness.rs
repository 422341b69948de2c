//! On what terms the controllers are compared.

use crate::report::page::document::{Block, Cell, Grid, Section};
use crate::report::run_data::RunData;
use crate::util::format;

/// Bandwidth, margins, commands and effort of every controller; none of runs of older versions.
pub(crate) fn section(data: &RunData) -> Option<Section> {
    let table = &data.fairness;
    let mut grid = Grid::new([
        "controller",
        "channels",
        "crossover, rad/s",
        "phase margin, deg",
        "delay margin, ms",
        "peak of S",
        "noise gain, peak",
        "noise gain, H2",
        "largest command, 95th percentile",
        "effort, median",
        "share of time at a limit",
    ]);
    for row in 0..table.rows() {
        let number = |name: &str| Cell::number(format::number(table.real(row, name)));
        grid.rows.push(vec![
            Cell::text(table.text(row, "controller")),
            Cell::text(table.text(row, "group")),
            number("crossover_rad_s"),
            number("phase_margin_deg"),
            number("delay_margin_ms"),
            number("sensitivity_peak"),
            number("noise_peak"),
            number("noise_h2"),
            number("peak_command_p95"),
            number("effort_p50"),
            Cell::number(format::rate(table.real(row, "saturated_share"), None)),
        ]);
    }
    if grid.rows.is_empty() {
        return None;
    }
    let unlike = data.manifest.unlike.iter();
    let unlike = unlike.map(|own| Block::Text(format!("{own}.")));
    let explained = "Bandwidth and margins are those of the loop of one channel, broken at the plant's input; noise gains lead \
                     from x and x', a unit of noise on each, to the feedback acceleration. The largest command is that of any \
                     agent and channel of an episode, N or N m; the effort is the integral of its square, in the mean over \
                     agents and channels. A smaller error on unlike terms is not the merit of the structure alone.";
    let blocks = unlike.chain([Block::Grid(grid), Block::text(explained)]);
    Some(Section::new("On what terms", blocks.collect()))
}
