//! What inequality (24) says about episodes.

use super::style::{bad, judged};
use super::text::line;
use crate::simulation::attenuation::{Attenuations, GroupAttenuation, INEQUALITY};
use crate::util::format::number;

/// The heads of what stands behind the errors of a replay, where (24) applies to some channels.
pub(crate) fn heading(found: &Attenuations) -> &'static str {
    if found.iter().flatten().any(Result::is_ok) {
        "  attenuation  certified  (24) with V(0)"
    } else {
        ""
    }
}

/// A channel of a replay, behind its errors.
pub(crate) fn of_channel(found: &Attenuations, agent: usize, channel: usize) -> String {
    if heading(found).is_empty() {
        return String::new();
    }
    match &found[agent][channel] {
        Ok(attenuation) => format!(
            "  {:>11}  {:>9}  {}",
            number(attenuation.level()),
            number(attenuation.certified),
            judged(attenuation.holds(), "holds", "FAILS")
        ),
        Err(_) => "  not applicable".to_string(),
    }
}

/// What (24) says where it applies to some channels of a replay, and why it does not to others, each reason once.
pub(crate) fn explanation(found: &Attenuations) -> String {
    let mut reasons: Vec<(String, usize)> = Vec::new();
    for reason in found
        .iter()
        .flatten()
        .filter_map(|found| found.as_ref().err())
    {
        let reason = reason.to_string();
        match reasons.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, count)) => *count += 1,
            None => reasons.push((reason, 1)),
        }
    }
    let all = found.iter().map(Vec::len).sum::<usize>();
    let mut text = String::new();
    if !heading(found).is_empty() {
        line(&mut text, INEQUALITY);
    }
    for (reason, count) in reasons {
        let of = format!("(24) is not applicable to {count} of {all} channels");
        line(&mut text, &format!("{of}: {reason}"));
    }
    text
}

/// What (24) says about the channel groups of the episodes of a cross-check, a line each.
pub(crate) fn groups(groups: &[GroupAttenuation]) -> String {
    let mut text = String::new();
    for group in groups {
        let name = format!("attenuation of {} under {}", group.group, group.controller);
        let of = format!("{} of {} channels", group.applicable, group.flown);
        let found = match (group.largest, group.certified) {
            (Some(largest), Some(certified)) => {
                let holds = match group.violated {
                    0 => "(24) holds in all".to_string(),
                    violated => format!("(24) {} in {violated}", bad("FAILS")),
                };
                format!("at most {largest:.4}, certified {certified:.4}; {holds} ({of})")
            }
            _ => {
                let reason = group.obstacle.as_deref().unwrap_or("nothing was simulated");
                format!("not applicable: {reason}")
            }
        };
        line(&mut text, &format!("{name}: {found}"));
    }
    if groups.iter().any(|group| group.largest.is_some()) {
        line(&mut text, INEQUALITY);
    }
    text
}
