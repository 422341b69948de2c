//! What inequality (24) says about episodes.

use crate::report::page::document::{Block, Cell};
use crate::simulation::attenuation::{Attenuations, GroupAttenuation, INEQUALITY};
use crate::util::format::number;

/// The heads of what stands behind the errors of a replay, where (24) applies to some channels.
pub(super) fn heads(found: &Attenuations) -> Vec<String> {
    match found.iter().flatten().any(Result::is_ok) {
        true => ["attenuation", "certified", "(24) with V(0)"]
            .map(String::from)
            .to_vec(),
        false => Vec::new(),
    }
}

/// A channel of a replay, behind its errors.
pub(super) fn of_channel(found: &Attenuations, agent: usize, channel: usize) -> Vec<Cell> {
    if heads(found).is_empty() {
        return Vec::new();
    }
    match &found[agent][channel] {
        Ok(attenuation) => vec![
            Cell::number(number(attenuation.level())),
            Cell::number(number(attenuation.certified)),
            Cell::Verdict(
                attenuation.holds(),
                if attenuation.holds() {
                    "holds"
                } else {
                    "FAILS"
                }
                .into(),
            ),
        ],
        Err(_) => vec![
            Cell::number("-"),
            Cell::number("-"),
            Cell::text("not applicable"),
        ],
    }
}

/// What (24) says where it applies to some channels of a replay, and why it does not to others, each reason once.
pub(super) fn explanation(found: &Attenuations) -> Vec<Block> {
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
    let applies = (!heads(found).is_empty()).then(|| Block::text(INEQUALITY));
    let reasons = reasons.into_iter().map(|(reason, count)| {
        let of = format!("(24) is not applicable to {count} of {all} channels");
        Block::Text(format!("{of}: {reason}"))
    });
    applies.into_iter().chain(reasons).collect()
}

/// What (24) says about the channel groups of the episodes of a cross-check, a sentence each.
pub(super) fn groups(groups: &[GroupAttenuation]) -> Vec<String> {
    let of_group = |group: &GroupAttenuation| {
        let name = format!("attenuation of {} under {}", group.group, group.controller);
        let of = format!("{} of {} channels", group.applicable, group.flown);
        let found = match (group.largest, group.certified) {
            (Some(largest), Some(certified)) => {
                let holds = match group.violated {
                    0 => "(24) holds in all".to_string(),
                    violated => format!("(24) FAILS in {violated}"),
                };
                format!("at most {largest:.4}, certified {certified:.4}; {holds} ({of})")
            }
            _ => {
                let reason = group.obstacle.as_deref().unwrap_or("nothing was simulated");
                format!("not applicable: {reason}")
            }
        };
        format!("{name}: {found}")
    };
    let applies = groups.iter().any(|group| group.largest.is_some());
    let explained = applies.then(|| INEQUALITY.to_string());
    groups.iter().map(of_group).chain(explained).collect()
}
