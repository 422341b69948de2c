//! Full-order gains and what is known about them.

use super::gains::checks;
use crate::campaign::Campaign;
use crate::report::page::document::{Block, Document, Section};
use crate::report::page::text::text;
use crate::synthesis::FullOrderSynthesis;
use crate::util::format::number;
use std::collections::BTreeMap;

/// The controllers of the channels of a campaign that share sensors, by group of agents and of channels.
pub fn full_order(
    campaign: &Campaign,
    found: &[BTreeMap<&'static str, FullOrderSynthesis>],
) -> String {
    let groups = campaign.groups().iter().zip(found);
    let groups = groups.filter(|(_, own)| !own.is_empty());
    let texts = groups.map(|(group, own)| {
        let preset = format!("preset {}", group.synthesis.preset);
        let sections = own.iter().map(|(name, synthesis)| {
            let channels = synthesis.sensors.channels().join(", ");
            Section::explained(*name, format!(" ({channels})"), channels_of(synthesis))
        });
        text(&Document {
            title: group.path.display().to_string(),
            subtitle: group.titled(&preset),
            sections: sections.collect(),
            ..Document::default()
        })
    });
    texts.collect::<Vec<_>>().join("\n")
}

/// What is known about the controller of a group of channels.
fn channels_of(found: &FullOrderSynthesis) -> Vec<Block> {
    let sensors = &found.sensors;
    let faults = match sensors.faults() {
        [] => "no sensor faults".to_string(),
        faults => format!("sensor faults {}", faults.join(", ")),
    };
    let solver = match &found.confirmation {
        None => found.solver.name().to_string(),
        Some(own) => format!(
            "{}: {} in {} iterations, L differs by {:.1e} of its largest entry",
            found.solver.name(),
            own.report.status,
            own.report.iterations,
            own.difference
        ),
    };
    let certificate = &found.certificate;
    let texts = [
        format!("{} sensors, {faults}", sensors.rows().len()),
        format!("K  {}", size(&found.gains.k)),
        format!("L  {}", size(&found.gains.l)),
        format!("solver  {solver}"),
        format!("residual of the Riccati equation  {:.1e}", found.residual),
        format!(
            "slowest pole of A + L C, 1/s  {:.3}",
            found.slowest_pole_per_s
        ),
        format!(
            "certified attenuation rho {:.4} (true H-infinity norm {:.4} at {} rad/s); largest eigenvalue of (27) {:.2e}",
            certificate.rho,
            certificate.hinf_norm,
            number(certificate.hinf_peak_rad_s),
            certificate.max_eigenvalue
        ),
    ];
    let texts = texts.map(Block::Text).into_iter();
    texts.chain([checks(&found.checks)]).collect()
}

/// The size of a gain and of its entries.
fn size(gain: &[Vec<f64>]) -> String {
    let columns = gain.first().map_or(0, Vec::len);
    let entries = gain.iter().flatten();
    let largest = entries.fold(0.0_f64, |largest, entry| entry.abs().max(largest));
    format!(
        "{} x {columns}, largest entry {}",
        gain.len(),
        number(largest)
    )
}
