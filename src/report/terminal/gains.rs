//! Gains and what is known about them.

use crate::campaign::{AgentGroup, Campaign, SYNTHESIZED};
use crate::controllers::{self, GainSet, SimulatedController, synthesized};
use crate::report::page::document::{Block, Cell, Document, Grid, Section};
use crate::report::page::text::text;
use crate::synthesis::{ChannelSynthesis, Check, ControllerGains};

/// The gains of a campaign, a set of each group of agents, and what is known about them.
pub fn gains(campaign: &Campaign, gains: &[GainSet]) -> String {
    let groups = campaign.groups().iter().zip(gains);
    let texts: Vec<String> = groups
        .map(|(group, gains)| of_group(group, gains))
        .collect();
    texts.join("\n")
}

fn of_group(group: &AgentGroup, gains: &GainSet) -> String {
    let controllers = gains.controllers.iter();
    let preset = format!("preset {}", group.synthesis.preset);
    text(&Document {
        title: group.path.display().to_string(),
        subtitle: group.titled(&preset),
        sections: controllers.map(|own| of_controller(group, own)).collect(),
        ..Document::default()
    })
}

fn of_controller(group: &AgentGroup, controller: &SimulatedController) -> Section {
    // Channel groups with the same gains are said once.
    let mut said: Vec<(Vec<&str>, usize)> = Vec::new();
    let channels = group.channel_groups();
    for (index, (channels, own)) in channels.iter().zip(&controller.groups).enumerate() {
        let same = said.iter_mut().find(|(_, other)| {
            let other = &controller.groups[*other];
            other.design == own.design && other.gains == own.gains
        });
        match same {
            Some((names, _)) => names.push(channels.role.name()),
            None => said.push((vec![channels.role.name()], index)),
        }
    }
    let blocks = said.into_iter().map(|(names, index)| {
        let own = &controller.groups[index];
        let inner = channel(&own.gains, own.findings.as_ref());
        Block::Folded(names.join(" and "), inner)
    });
    let source = format!(" ({})", controller.source);
    Section::explained(&controller.name, source, blocks.collect())
}

/// The gains of a preset's channel group and what is known about them.
pub fn synthesis(role: &str, synthesis: &ChannelSynthesis) -> String {
    let of_controller = |name: &str| {
        let (gains, findings) = synthesized(synthesis, name)?;
        let blocks = channel(&gains, Some(&findings));
        Some(Section::new(format!("{name}, {role}"), blocks))
    };
    text(&Document {
        sections: SYNTHESIZED.into_iter().filter_map(of_controller).collect(),
        ..Document::default()
    })
}

/// The gains of a channel group, and what is known about them.
fn channel(gains: &ControllerGains, findings: Option<&controllers::Findings>) -> Vec<Block> {
    let numbers = |values: &[f64]| {
        let values = values.iter().map(|value| format!("{value:.5}"));
        Cell::Text(values.collect::<Vec<_>>().join("  "))
    };
    let mut grid = Grid::default();
    grid.rows.push(vec![Cell::text("K"), numbers(&gains.k)]);
    for (row, values) in gains.l.iter().enumerate() {
        let name = if row == 0 { "L" } else { "" };
        grid.rows.push(vec![Cell::text(name), numbers(values)]);
    }
    let mut blocks = vec![Block::Grid(grid)];
    if let Some(findings) = findings {
        blocks.extend(analysis(findings));
        blocks.extend(proof(findings));
    }
    blocks
}

/// How the closed loop behaves.
fn analysis(findings: &controllers::Findings) -> [Block; 3] {
    let poles = |poles: &[[f64; 2]]| {
        let pole = |[re, im]: &[f64; 2]| {
            if *im == 0.0 {
                format!("{re:.3}")
            } else {
                format!("{re:.3}{im:+.3}i")
            }
        };
        poles.iter().map(pole).collect::<Vec<_>>().join("  ")
    };
    let found = &findings.analysis;
    let margins = &found.margins;
    [
        format!("poles of A + B K, 1/s  {}", poles(&found.controller_poles)),
        format!("poles of A + L C, 1/s  {}", poles(&found.observer_poles)),
        format!(
            "margins  Ms {:.3}, phase {:.1} deg, delay {:.2} ms at {:.1} rad/s",
            margins.sensitivity_peak,
            margins.phase_margin_deg,
            margins.delay_margin_ms,
            margins.crossover_rad_s
        ),
    ]
    .map(Block::Text)
}

/// What is certified, and what was checked for it.
fn proof(findings: &controllers::Findings) -> Vec<Block> {
    let certificate = findings.certificate.iter().map(|certificate| {
        format!(
            "certified attenuation rho {:.4} (true H-infinity norm {:.4}); largest eigenvalue of (27) {:.2e}",
            certificate.rho, certificate.hinf_norm, certificate.max_eigenvalue
        )
    });
    let solver = findings.solver.iter().map(|solved| {
        format!(
            "solver  {}: {} in {} iterations",
            solved.step, solved.status, solved.iterations
        )
    });
    let texts = certificate.chain(solver).map(Block::Text);
    texts.chain([checks(&findings.checks)]).collect()
}

/// What was checked.
pub(super) fn checks(checks: &[Check]) -> Block {
    let rows = checks.iter().map(|check| {
        let passed = if check.passed { "ok" } else { "FAILED" };
        vec![
            Cell::text("check"),
            Cell::Verdict(check.passed, passed.into()),
            Cell::Text(format!(
                "{}: {}: {:.3e}, must be below {:.3e}",
                check.step, check.name, check.value, check.limit
            )),
        ]
    });
    Block::Grid(Grid {
        head: Vec::new(),
        rows: rows.collect(),
    })
}
