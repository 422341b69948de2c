//! Gains and what is known about them.

use super::style::{heading, judged};
use super::text::line;
use crate::campaign::{AgentGroup, Campaign, FTC, PID, PID_TUNED};
use crate::controllers::{self, GainSet, built_in};
use crate::synthesis::{ChannelSynthesis, ControllerGains};

/// The gains of a campaign, a set of each group of agents, and what is known about them.
pub fn gains(campaign: &Campaign, gains: &[GainSet]) -> String {
    let groups = campaign.groups().iter().zip(gains);
    let texts: Vec<String> = groups
        .map(|(group, gains)| of_group(group, gains))
        .collect();
    texts.join("\n")
}

fn of_group(group: &AgentGroup, gains: &GainSet) -> String {
    let mut text = String::new();
    let path = group.path.display().to_string();
    let preset = format!("preset {}", group.synthesis.preset);
    line(&mut text, &format!("{path}: {}", group.titled(&preset)));
    let names = group.channel_groups();
    let designs = &group.synthesis.designs;
    for controller in &gains.controllers {
        let title = heading(&controller.name);
        line(&mut text, &format!("\n{title} ({})", controller.source));
        // Channel groups with the same gains are said once.
        let mut said: Vec<(Vec<&str>, usize)> = Vec::new();
        for (index, (name, own)) in names.iter().zip(&controller.groups).enumerate() {
            let same = said.iter_mut().find(|(_, other)| {
                designs[*other] == designs[index] && controller.groups[*other].gains == own.gains
            });
            match same {
                Some((names, _)) => names.push(name.role.name()),
                None => said.push((vec![name.role.name()], index)),
            }
        }
        for (names, index) in said {
            line(&mut text, &format!("  {}", names.join(" and ")));
            let own = &controller.groups[index];
            channel(&mut text, &own.gains, own.findings.as_ref());
        }
    }
    text
}

/// The gains of a preset's channel group and what is known about them.
pub fn synthesis(role: &str, synthesis: &ChannelSynthesis) -> String {
    let mut text = String::new();
    for name in [FTC, PID, PID_TUNED] {
        line(&mut text, &heading(&format!("{name}, {role}")));
        let (gains, findings) = built_in(synthesis, name);
        channel(&mut text, gains, Some(&findings));
    }
    text
}

/// The gains of a channel group, and what is known about them.
fn channel(text: &mut String, gains: &ControllerGains, findings: Option<&controllers::Findings>) {
    let numbers = |values: &[f64]| {
        values
            .iter()
            .map(|value| format!("{value:.5}"))
            .collect::<Vec<_>>()
            .join("  ")
    };
    line(text, &format!("    K  {}", numbers(&gains.k)));
    for (row, values) in gains.l.iter().enumerate() {
        line(
            text,
            &format!(
                "    {}  {}",
                if row == 0 { "L" } else { " " },
                numbers(values)
            ),
        );
    }
    if let Some(findings) = findings {
        analysis(text, findings);
        proof(text, findings);
    }
}

/// How the closed loop behaves.
fn analysis(text: &mut String, findings: &controllers::Findings) {
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
    line(
        text,
        &format!(
            "    poles of A + B K, 1/s  {}",
            poles(&findings.analysis.controller_poles)
        ),
    );
    line(
        text,
        &format!(
            "    poles of A + L C, 1/s  {}",
            poles(&findings.analysis.observer_poles)
        ),
    );
    let margins = &findings.analysis.margins;
    line(
        text,
        &format!(
            "    margins  Ms {:.3}, phase {:.1} deg, delay {:.2} ms at {:.1} rad/s",
            margins.sensitivity_peak,
            margins.phase_margin_deg,
            margins.delay_margin_ms,
            margins.crossover_rad_s
        ),
    );
}

/// What is certified, and what was checked for it.
fn proof(text: &mut String, findings: &controllers::Findings) {
    if let Some(certificate) = &findings.certificate {
        line(
            text,
            &format!(
                "    certified attenuation rho {:.4} (true H-infinity norm {:.4}); largest eigenvalue of (27) {:.2e}",
                certificate.rho, certificate.hinf_norm, certificate.max_eigenvalue
            ),
        );
    }
    for solved in &findings.solver {
        line(
            text,
            &format!(
                "    solver  {}: {} in {} iterations",
                solved.step, solved.status, solved.iterations
            ),
        );
    }
    for check in &findings.checks {
        let sign = judged(check.passed, "ok", "FAILED");
        line(
            text,
            &format!(
                "    check   {sign}  {}: {}: {:.3e}, must be below {:.3e}",
                check.step, check.name, check.value, check.limit
            ),
        );
    }
}
