//! The gains that were used, what is certified about them, and what the episodes show beside it.

use crate::controllers::ChannelController;
use crate::report::page::document::{Block, Cell, Grid, Section};
use crate::report::run_data::RunData;
use crate::simulation::attenuation::INEQUALITY;
use crate::util::format;

/// Gains, poles, margins, certificate, and the attenuation that episodes showed.
pub(crate) fn section(data: &RunData) -> Section {
    let groups = data.campaign.channel_groups();
    let mut margins = Grid::new([
        "controller",
        "channels",
        "certified attenuation ρ",
        "H∞ norm",
        "peak of S",
        "phase margin, deg",
        "delay margin, ms",
        "crossover, rad/s",
        "slowest and fastest pole, 1/s",
    ]);
    let mut folded = Vec::new();
    for (index, name) in data.campaign.controllers.iter().enumerate() {
        let of_groups = data.gains.iter().map(|gains| &gains.controllers[index]);
        let channels =
            of_groups.flat_map(|own| own.groups.iter().map(move |channel| (own, channel)));
        for (group, (controller, own)) in groups.iter().zip(channels) {
            margins.rows.push(row(name, &group.name, own));
            folded.push(Block::Text(format!(
                "{name}, {} ({})",
                group.name, controller.source
            )));
            folded.push(Block::Code(numbers(own)));
        }
    }
    let mut blocks = vec![
        Block::Grid(margins),
        Block::Folded("Gains, poles and checks".into(), folded),
        Block::text(attenuation_explained(data)),
    ];
    let attenuation = attenuation(data);
    if !attenuation.rows.is_empty() {
        blocks.push(Block::text(format!("{INEQUALITY}.")));
        blocks.push(Block::Grid(attenuation));
    }
    Section::new("Gains and certificate", blocks)
}

fn row(controller: &str, group: &str, own: &ChannelController) -> Vec<Cell> {
    let number = |value: Option<f64>| Cell::number(format::number(value.unwrap_or(f64::NAN)));
    let findings = own.findings.as_ref();
    let certificate = findings.and_then(|found| found.certificate.as_ref());
    let margins = findings.map(|found| &found.analysis.margins);
    let poles = findings.map(|found| {
        let analysis = &found.analysis;
        let all = analysis
            .controller_poles
            .iter()
            .chain(&analysis.observer_poles);
        let parts: Vec<f64> = all.map(|[re, _]| *re).collect();
        let slowest = parts.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let fastest = parts.iter().copied().fold(f64::INFINITY, f64::min);
        format!("{}, {}", format::number(slowest), format::number(fastest))
    });
    vec![
        Cell::text(controller),
        Cell::text(group),
        number(certificate.map(|found| found.rho)),
        number(certificate.map(|found| found.hinf_norm)),
        number(margins.map(|found| found.sensitivity_peak)),
        number(margins.map(|found| found.phase_margin_deg)),
        number(margins.map(|found| found.delay_margin_ms)),
        number(margins.map(|found| found.crossover_rad_s)),
        Cell::number(poles.unwrap_or("-".into())),
    ]
}

/// K, L, poles and checks as text.
fn numbers(own: &ChannelController) -> String {
    let list = |values: &[f64]| {
        let values = values.iter().map(|value| format::number(*value));
        values.collect::<Vec<_>>().join("  ")
    };
    let mut text = format!("K  {}\n", list(&own.gains.k));
    for (row, values) in own.gains.l.iter().enumerate() {
        let name = if row == 0 { "L" } else { " " };
        text.push_str(&format!("{name}  {}\n", list(values)));
    }
    let Some(found) = &own.findings else {
        return text;
    };
    let poles = |poles: &[[f64; 2]]| {
        let poles = poles.iter().map(|[re, im]| match *im == 0.0 {
            true => format::number(*re),
            false => format!("{}{im:+.3}i", format::number(*re)),
        });
        poles.collect::<Vec<_>>().join("  ")
    };
    text.push_str(&format!(
        "poles of A + B K, 1/s  {}\npoles of A + L C, 1/s  {}\n",
        poles(&found.analysis.controller_poles),
        poles(&found.analysis.observer_poles)
    ));
    for check in &found.checks {
        let sign = if check.passed { "ok" } else { "FAILED" };
        text.push_str(&format!(
            "check {sign}  {}: {}: {:.3e}, must be below {:.3e}\n",
            check.step, check.name, check.value, check.limit
        ));
    }
    text
}

fn attenuation_explained(data: &RunData) -> &'static str {
    match &data.manifest.cross_check {
        Some(check) if !check.attenuation.is_empty() => {
            "Attenuation of the episodes that were cross-checked: the square root of the left side of (24) without V(0), the \
             largest of the channels, beside the certified level; and whether (24) with V(0) holds. A sample shows what \
             happened, the certificate what cannot happen to the linear loop."
        }
        Some(_) => {
            "No controller of this run has a certificate, so there is no level to compare the episodes with."
        }
        None => {
            "The attenuation of the episodes was not measured: it takes f64 on the CPU; run with --cross-check 32, or replay \
             an episode."
        }
    }
}

fn attenuation(data: &RunData) -> Grid {
    let mut grid = Grid::new([
        "controller",
        "channels",
        "largest attenuation",
        "certified",
        "(24)",
        "applicable channels",
    ]);
    let check = data.manifest.cross_check.as_ref();
    for group in check.iter().flat_map(|check| &check.attenuation) {
        let number = |value: Option<f64>| Cell::number(format::number(value.unwrap_or(f64::NAN)));
        let holds = match (&group.largest, group.violated) {
            (None, _) => Cell::text(format!(
                "not applicable: {}",
                group.obstacle.as_deref().unwrap_or("nothing was simulated")
            )),
            (Some(_), 0) => Cell::Verdict(true, "holds".into()),
            (Some(_), violated) => Cell::Verdict(false, format!("fails in {violated}")),
        };
        grid.rows.push(vec![
            Cell::text(group.controller.as_str()),
            Cell::text(&*group.group),
            number(group.largest),
            number(group.certified),
            holds,
            Cell::number(format!("{} of {}", group.applicable, group.flown)),
        ]);
    }
    grid
}
