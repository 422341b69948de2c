//! On what terms the controllers are compared.

use crate::campaign::{AgentGroup, ChannelsOfCampaign, Distribution};
use crate::report::page::document::{Block, Cell, Figure, Grid, Section};
use crate::report::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::report::run_data::RunData;
use crate::synthesis::{Response, responses};
use crate::util::format;

/// The lowest frequency that is shown, rad/s, and the highest over it.
const LOWEST_RAD_S: f64 = 0.1;
const DECADES: f64 = 1e4;
/// Frequencies of a curve, less one.
const POINTS: u32 = 120;

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
        "nominal loop settles in, s",
        "settled, median, s",
        "reversals of u per s",
        "rate of u, rms",
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
            number("nominal_settling_s"),
            number("settling_p50_s"),
            number("reversals_per_s"),
            number("command_rate_per_s"),
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
                     agents and channels; reversals are changes of its sign, and both they and its rate, per s, are those \
                     of the median flight. The nominal loop has settled when 5 % of an \
                     initial error are left. A smaller error on unlike terms is not the merit of the structure alone.";
    let figures = data.campaign.channel_groups().into_iter();
    let figures = figures.map(|of| Block::Figure(figure(data, &of)));
    let table = [Block::Grid(grid), Block::text(explained)];
    let blocks = unlike.chain(table).chain(figures);
    Some(Section::new("On what terms", blocks.collect()))
}

/// The answer that a panel shows.
type Picked = fn(&Response) -> f64;

/// What the loops of a channel group make of sines: the errors that faults leave, and the commands that noise costs.
fn figure(data: &RunData, of: &ChannelsOfCampaign) -> Figure {
    let omegas_rad_s: Vec<f64> = (0..=POINTS)
        .map(|k| LOWEST_RAD_S * DECADES.powf(f64::from(k) / f64::from(POINTS)))
        .collect();
    let controllers = data.gains[of.group].controllers.iter();
    let answers: Vec<Vec<Response>> = controllers
        .map(|own| {
            let own = &own.groups[of.place];
            responses(&own.design, &own.gains, &omegas_rad_s).unwrap_or_default()
        })
        .collect();
    let band = disturbed(&data.campaign.groups()[of.group]);
    let kinds: [(_, Picked); 3] = [
        ("|e/f1|, s²", |own| own.from_actuator_fault),
        ("|e/f2|, s", |own| own.from_sensor_fault),
        ("|u/noise|", |own| own.from_noise),
    ];
    let panels = kinds.map(|(label, pick)| {
        let marks = answers.iter().enumerate().map(|(index, own)| {
            let points = own.iter().map(|own| (own.omega_rad_s, pick(own)));
            Mark::Line(points.collect(), Color::Series(index), Stroke::Solid)
        });
        let logarithmic = |label: &str| Axis {
            logarithmic: true,
            ..Axis::new(label)
        };
        Plot {
            title: of.name.to_string(),
            x: logarithmic("frequency, rad/s"),
            y: logarithmic(label),
            marks: marks.collect(),
            spans: band.into_iter().collect(),
            ..Plot::default()
        }
    });
    let shaded = match band {
        Some(_) => " Shaded: the frequencies of the campaign's disturbances.",
        None => "",
    };
    Figure {
        panels: panels.to_vec(),
        legend: data.legend(),
        caption: format!(
            "The loop of one channel of {}: the error that a sine leaves that acts like an actuator fault or any disturbance \
             (f1, an acceleration), the one that a sine on the rate sensor leaves (f2), and the feedback acceleration under \
             noise on x and x'.{shaded}",
            of.name
        ),
    }
}

/// The lowest and the highest frequency of a group's disturbances that have one, rad/s.
fn disturbed(group: &AgentGroup) -> Option<(f64, f64)> {
    let mut band: Option<(f64, f64)> = None;
    for disturbance in &group.disturbances {
        let named = disturbance.kind.parameters().iter();
        for (parameter, drawn) in named.zip(&disturbance.parameters) {
            if parameter.name != "frequency_rad_s" {
                continue;
            }
            for (low, high) in drawn.distributions.iter().map(Distribution::support) {
                let known = band.unwrap_or((low, high));
                band = Some((known.0.min(low), known.1.max(high)));
            }
        }
    }
    // A single frequency is a line.
    band.map(|(low, high)| (0.97 * low, 1.03 * high))
}
