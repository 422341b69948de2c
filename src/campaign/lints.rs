//! What a campaign may do, but its writer has probably not meant: said before the run, forbidden by nothing.

use super::distribution::Distribution;
use super::disturbances_and_faults::Fault;
use super::group::AgentGroup;
use super::kinds::{COULOMB, DisturbanceKind, SMOOTHING_RATE, VISCOUS};
use super::measure::{Measure, Side};
use super::parameter::Parameter;
use super::plan::ALL;
use super::quantity::RandomQuantity;
use super::requirement::Requirement;
use super::validated::Campaign;
use crate::reference::{AgentWalk, Reference, WaypointPath};
use crate::statistics::{LEVEL, alike_needed, runs_needed, sequential_runs_needed};
use crate::util::format::digits;

/// Steps in which friction may turn a motion; the Runge-Kutta method is unstable beyond 2.78.
const STEPS_OF_FRICTION: f64 = 2.0;

/// A sentence for each of them: requirements that so few episodes cannot prove, references whose end is not reached,
/// faults that nobody has or that are gone before they have come.
#[must_use]
pub fn cautions(campaign: &Campaign) -> Vec<String> {
    let requirements = campaign.requirements.iter();
    let unprovable = requirements.filter_map(|own| unprovable(campaign, own));
    let groups = campaign.groups().iter().enumerate();
    let of_groups = groups.flat_map(|(index, group)| {
        let prefix = match campaign.has_named_groups() {
            true => format!("group[{index}]."),
            false => String::new(),
        };
        of_group(group).map(move |caution| prefix.clone() + &caution)
    });
    repeated(campaign)
        .into_iter()
        .chain(unprovable)
        .chain(of_groups)
        .collect()
}

/// What is said of a group of agents, each beginning with a key.
fn of_group(group: &AgentGroup) -> impl Iterator<Item = String> {
    let faults = group.faults.iter().enumerate();
    let unfinished =
        faults.filter_map(|(index, fault)| absent(index, fault).or(unfinished(index, fault)));
    let robot = group.agent.notes().iter();
    let robot = robot.map(|note| format!("agent.robot: {note}"));
    robot
        .chain(unreached(group))
        .chain(overwhelming(group))
        .chain(stiff(group))
        .chain(unfinished)
}

/// Disturbances that together may be more than the actuators can give: what is flown then is the limits, not the
/// controllers.
fn overwhelming(group: &AgentGroup) -> Option<String> {
    let largest_of = |drawn: &Distribution| match *drawn {
        // Hardly anything lies farther out.
        Distribution::Normal { mean, std } => mean.abs() + 2.0 * std,
        _ => {
            let (low, high) = drawn.support();
            low.abs().max(high.abs())
        }
    };
    let on_channel = |agent: usize, channel: usize| -> f64 {
        let all = group.disturbances.iter().flat_map(|disturbance| {
            let named = disturbance.kind.parameters().iter();
            named.zip(&disturbance.parameters)
        });
        let amplitudes = all.filter(|(parameter, _)| parameter.name == "amplitude");
        let sizes = amplitudes.map(|(_, drawn)| {
            let channel = channel.min(drawn.channels - 1);
            largest_of(drawn.of(agent, channel))
        });
        sizes.sum()
    };
    let of_channel = |(channel, reserve): (usize, f64)| {
        let agents = (0..group.team).map(|agent| on_channel(agent, channel));
        let largest = agents.fold(0.0, f64::max);
        (largest > reserve).then(|| {
            let name = &group.channels()[channel];
            let unit = if group.unit(channel) == "m" {
                "N"
            } else {
                "N m"
            };
            format!(
                "disturbance: up to {} {unit} act on {name}, the actuators can set {} {unit} against them",
                digits(largest, 4),
                digits(reserve.max(0.0), 4)
            )
        })
    };
    group
        .agent
        .reserves()
        .into_iter()
        .enumerate()
        .find_map(of_channel)
}

/// Friction that turns so suddenly that a step of the integration leaps over it: what is simulated then shakes.
fn stiff(group: &AgentGroup) -> Option<String> {
    let mobilities = group.agent.mobilities();
    let of = |index: usize| {
        let disturbance = &group.disturbances[index];
        let ends = |parameter: &Parameter, agent: usize, channel: usize| {
            let named = disturbance
                .kind
                .parameters()
                .iter()
                .zip(&disturbance.parameters);
            let mut drawn = named.filter(|(own, _)| own.name == parameter.name);
            let (_, drawn) = drawn.next()?;
            let channel = channel.min(drawn.channels - 1);
            Some(drawn.of(agent, channel).support())
        };
        let turns_within_s = |agent: usize, channel: usize| {
            let [(_, coulomb), (_, viscous), (rate, _)] = [
                ends(&COULOMB, agent, channel)?,
                ends(&VISCOUS, agent, channel)?,
                ends(&SMOOTHING_RATE, agent, channel)?,
            ];
            Some(1.0 / ((coulomb / rate + viscous) * mobilities[channel]))
        };
        let everywhere =
            (0..group.team).flat_map(|agent| (0..mobilities.len()).map(move |c| (agent, c)));
        let times = everywhere.filter_map(|(agent, c)| Some((turns_within_s(agent, c)?, c)));
        let (shortest_s, c) = times.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (shortest_s * STEPS_OF_FRICTION < group.time.step_s).then(|| {
            format!(
                "disturbance[{index}]: friction turns {} within {} s and a step takes {} s: what is simulated shakes; raise \
                 smoothing_rate {} times, or shorten the step",
                group.channels()[c],
                digits(shortest_s, 2),
                group.time.step_s,
                (group.time.step_s / (STEPS_OF_FRICTION * shortest_s)).ceil()
            )
        })
    };
    let all = 0..group.disturbances.len();
    all.filter(|index| group.disturbances[*index].kind == DisturbanceKind::Friction)
        .find_map(of)
}

/// Episodes that are all the same.
fn repeated(campaign: &Campaign) -> Option<String> {
    let episodes = campaign.episodes;
    let distinct = campaign.strata.all().len().max(1);
    (!campaign.is_random() && episodes as usize > distinct).then(|| {
        let same = match distinct {
            1 => "one and the same".to_string(),
            _ => format!("one and the same in each of the {distinct} strata"),
        };
        format!("nothing is random: the {episodes} episodes are {same}; {distinct} would say as much, and there are no intervals")
    })
}

/// A requirement that does not hold even if everything goes as it should.
fn unprovable(campaign: &Campaign, requirement: &Requirement) -> Option<String> {
    let Requirement {
        place,
        controller,
        stratum,
        measure,
        side,
        limit,
        compared,
    } = requirement;
    let needed = match campaign.stop {
        Some(_) => sequential_runs_needed,
        None => runs_needed,
    };
    let of_rate = |rate: f64| (rate < 1.0).then(|| needed(rate, LEVEL, 0));
    // Of a share that all episodes have, or none; of a quantile that the largest or smallest of them bounds.
    let enough = match (measure, compared, side) {
        (Measure::Loop { .. }, ..) => None,
        (Measure::Episodes { share, .. }, _, Side::AtMost) => of_rate(1.0 - share),
        (Measure::Episodes { share, .. }, _, Side::AtLeast) => of_rate(*share),
        (_, Some(_), Side::AtMost) if 0.0 < *limit && *limit < 1.0 => {
            Some(alike_needed(*limit, LEVEL))
        }
        (_, Some(_), Side::AtLeast) if -1.0 < *limit && *limit < 0.0 => {
            Some(alike_needed(-limit, LEVEL))
        }
        (_, Some(_), _) => None,
        (_, None, Side::AtMost) => of_rate(*limit),
        (_, None, Side::AtLeast) => of_rate(1.0 - limit),
    }?;
    let strata = &campaign.strata;
    let index = strata.all().iter().position(|own| own.name == *stratum);
    let (n, of_stratum) = match index {
        Some(index) if &**stratum != ALL => (
            strata.count(index, campaign.episodes),
            format!(" of the stratum {stratum:?}"),
        ),
        _ => (u64::from(campaign.episodes), String::new()),
    };
    if enough.is_some_and(|enough| n >= enough) {
        return None;
    }
    let episodes = if n == 1 { "episode" } else { "episodes" };
    let remedy = match (enough, index) {
        (Some(enough), Some(index)) if !of_stratum.is_empty() => format!(
            "simulate at least {} episodes, {enough} of them there",
            strata.episodes_for(index, enough)
        ),
        (Some(enough), _) => format!("simulate at least {enough}"),
        (None, _) => "no number of episodes does".to_string(),
    };
    Some(match (measure, compared) {
        (Measure::FailureRate, None) if *side == Side::AtMost => format!(
            "require[{place}].failure_rate_upper_95 = {limit}: {n} {episodes}{of_stratum} cannot prove it, even if \
             {controller:?} fails in none; {remedy}"
        ),
        _ => format!(
            "require[{place}]: {n} {episodes}{of_stratum} cannot prove {} {} {limit}, whatever they show; {remedy}",
            requirement.quantity(),
            side.words()
        ),
    })
}

/// When somebody sets out, how long it moves, and how long all takes that is planned, s.
type Way = [f64; 3];

/// The walk or path that moves longest beyond the end of an episode. Who only stands has arrived.
fn unreached(group: &AgentGroup) -> Option<String> {
    let (what, ways): (_, Vec<Way>) = match &group.reference {
        Reference::Sinusoid(_) => return None,
        Reference::Waypoints(paths) => {
            let way = |path: &WaypointPath| [0.0, path.duration_s(), path.duration_s()];
            ("path", paths.iter().map(way).collect())
        }
        Reference::Walk(walks) => {
            let way = |AgentWalk { walk, start_s }: &AgentWalk| {
                let takes_s = walk.duration_s();
                [*start_s, takes_s - walk.gait.standing_after_s, takes_s]
            };
            ("walk", walks.iter().map(way).collect())
        }
    };
    let ends = ways.iter().map(|[start_s, moves_s, _]| start_s + moves_s);
    let (agent, end_s) = ends.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let episode_s = group.time.shown_s(group.time.steps);
    // A step is as near as an end can be met.
    if end_s <= episode_s + group.time.step_s {
        return None;
    }
    let [start_s, _, takes_s] = ways[agent];
    let whose = match ways.len() {
        1 => String::new(),
        _ => format!(" of agent {agent}"),
    };
    let begins = if start_s == 0.0 {
        String::new()
    } else {
        format!(" begins at {start_s} s and")
    };
    Some(format!(
        "reference: the {what}{whose}{begins} takes {} s, the episode {episode_s} s; its end is not reached",
        // Not shorter than it is.
        (100.0 * takes_s).ceil() / 100.0
    ))
}

/// A fault that nobody has.
fn absent(index: usize, fault: &Fault) -> Option<String> {
    let never = fault.probability.iter().all(|own| *own == 0.0);
    never.then(|| {
        format!(
            "fault[{index}].probability = 0: nobody ever has {}",
            fault.name
        )
    })
}

/// A fault that is never there as a whole, as it ends before it has come.
fn unfinished(index: usize, fault: &Fault) -> Option<String> {
    let ends = |drawn: &RandomQuantity| {
        let supports = drawn.distributions.iter().map(Distribution::support);
        supports.fold([f64::INFINITY, 0.0], |[low, high], own| {
            [f64::min(low, own.0), f64::max(high, own.1)]
        })
    };
    let [comes_s, _] = ends(fault.ramp_s.as_ref()?);
    let [_, stays_s] = ends(fault.duration_s.as_ref()?);
    (comes_s > stays_s).then(|| {
        format!(
            "fault[{index}].ramp_s: {} takes at least {comes_s} s to come and stays at most {stays_s} s; it never comes as a whole",
            fault.name
        )
    })
}
