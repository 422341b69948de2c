//! What the gains of a campaign do not bear, or do not promise although they were asked to: said before its episodes,
//! forbidden by nothing.

use super::gain_set::GainSet;
use crate::campaign::kinds::DELAY;
use crate::campaign::{AgentGroup, Campaign, Distribution, Fault, FaultKind, RandomQuantity};
use crate::util::format::digits;

/// A sentence for each of them: delays beyond the margin of a controller, and attenuation levels that are not reached.
#[must_use]
pub fn cautions(campaign: &Campaign, gains: &[GainSet]) -> Vec<String> {
    let groups = campaign.groups().iter().zip(gains);
    let of_group = |(group, gains)| {
        let late = late(group, gains);
        late.into_iter()
            .chain(unreached(group, gains))
            .collect::<Vec<_>>()
    };
    groups.flat_map(of_group).collect()
}

/// Delays that destabilize a loop even though nothing else fails.
fn late(group: &AgentGroup, gains: &GainSet) -> Option<String> {
    let longest = |drawn: &RandomQuantity| {
        let supports = drawn.distributions.iter().map(Distribution::support);
        supports.map(|(_, high)| high).fold(0.0, f64::max)
    };
    let delay_s = group.control.delay_s.as_ref().map_or(0.0, longest);
    // A command that is held is on the average half a hold old.
    let held_s = match group.control.hold_steps {
        0 | 1 => 0.0,
        steps => 0.5 * f64::from(steps) * group.time.step_s,
    };
    let is_met = |fault: &&Fault| {
        fault.kind == FaultKind::Delay && fault.probability.iter().any(|own| *own > 0.0)
    };
    let delays = group.faults.iter().filter(is_met).filter_map(|fault| {
        let place = DELAY.place_in(fault.kind.parameters())?;
        fault.parameters.get(place)
    });
    let faults_s = delays.map(longest).fold(0.0, f64::max);
    let total_ms = 1e3 * (delay_s + held_s + faults_s);
    let beyond = gains.controllers.iter().flat_map(|controller| {
        let channels = group.channel_groups().into_iter().zip(&controller.groups);
        channels.filter_map(move |(channels, own)| {
            let margin_ms = own.findings.as_ref()?.analysis.margins.delay_margin_ms;
            (total_ms > margin_ms).then(|| {
                let on = group.titled(channels.role.name());
                format!("{} on {on} ({margin_ms:.1} ms)", controller.name)
            })
        })
    });
    let beyond: Vec<String> = beyond.collect();
    let parts = [
        (delay_s, "control.delay_s"),
        (held_s, "half of what control.rate_hz holds"),
        (faults_s, "the longest delay fault"),
    ];
    let parts = parts.iter().filter(|(part_s, _)| *part_s > 0.0);
    let parts: Vec<String> = parts
        .map(|(part_s, of)| format!("{:.1} ms of {of}", 1e3 * part_s))
        .collect();
    (!beyond.is_empty()).then(|| {
        format!(
            "delays add up to {total_ms:.1} ms ({}), beyond the delay margin of {}: unstable while they last",
            parts.join(", "),
            beyond.join(", ")
        )
    })
}

/// Certified levels above those that were asked for.
fn unreached(group: &AgentGroup, gains: &GainSet) -> Vec<String> {
    let of_controller = gains.controllers.iter().flat_map(|controller| {
        let channels = group.channel_groups().into_iter();
        let channels = channels.zip(&controller.groups);
        channels.filter_map(move |(channels, own)| {
            let certificate = own.certificate()?;
            (!certificate.meets_design_rho).then(|| {
                format!(
                    "{} on {}: the weights ask for an attenuation of rho = {}, the gains certify {:.3} only",
                    controller.name,
                    group.titled(channels.role.name()),
                    digits(own.design.rho, 4),
                    certificate.rho
                )
            })
        })
    });
    of_controller.collect()
}
