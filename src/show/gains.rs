//! Gains and what is known about them.

use super::line;
use urts_mc::campaign::{Campaign, FTC, PID, PID_TUNED};
use urts_mc::gains::{self, ChannelController, GainSet, ROLES, built_in};
use urts_mc::synthesis::{ChannelSynthesis, ControllerGains};

/// The gains of a campaign and what is known about them.
pub(crate) fn gains(campaign: &Campaign, gains: &GainSet) -> String {
    let mut text = String::new();
    line(
        &mut text,
        &format!(
            "{}: preset {}",
            campaign.path.display(),
            campaign.synthesis.preset
        ),
    );
    let same = campaign.synthesis.designs[0] == campaign.synthesis.designs[1];
    for controller in &gains.controllers {
        line(
            &mut text,
            &format!("\n{} ({})", controller.name, controller.source),
        );
        if same && controller.channels[0].gains == controller.channels[1].gains {
            line(&mut text, "  position and attitude channels");
            channel(
                &mut text,
                &controller.channels[0].gains,
                controller.channels[0].findings.as_ref(),
            );
        } else {
            for (role, name) in ROLES.iter().enumerate() {
                line(&mut text, &format!("  {name} channels"));
                let ChannelController {
                    gains, findings, ..
                } = &controller.channels[role];
                channel(&mut text, gains, findings.as_ref());
            }
        }
    }
    text
}

/// The gains of a preset's channel type and what is known about them.
pub(crate) fn synthesis(role: &str, synthesis: &ChannelSynthesis) -> String {
    let mut text = String::new();
    for name in [FTC, PID, PID_TUNED] {
        line(&mut text, &format!("{name}, {role} channels"));
        let (gains, findings) = built_in(synthesis, name);
        channel(&mut text, gains, Some(&findings));
    }
    text
}

fn channel(text: &mut String, gains: &ControllerGains, findings: Option<&gains::Findings>) {
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
    let Some(findings) = findings else {
        return;
    };
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
        let sign = if check.passed { "ok" } else { "FAILED" };
        line(
            text,
            &format!(
                "    check   {sign}  {}: {}: {:.3e}, must be below {:.3e}",
                check.step, check.name, check.value, check.limit
            ),
        );
    }
}
