//! Curves of a run, of so few points that nobody reads the large tables for a picture: how the errors are distributed,
//! how many episodes have not failed yet, and what the strongest condition does to the errors.

use super::scores::Scores;
use super::sensitivity::{SensitivityResult, by_chance};
use super::table::Table;
use super::team::TeamNumbers;
use crate::campaign::{Campaign, ChannelsOfCampaign};
use crate::statistics::SIGNIFICANCE;

/// The name of a curve of [`curves_table`]: the share of the episodes whose RMS error over the team is at most `x`.
pub const DISTRIBUTION: &str = "distribution";
/// The share of the episodes that have not failed by the time `x`.
pub const SURVIVAL: &str = "survival";
/// The median RMS error over the team of episodes whose condition is about `x`, between the 5th and 95th percentiles.
pub const BAND: &str = "band";

/// Points of a curve, at most, and one more where it ends: of fewer episodes every one is there.
const MOST_POINTS: usize = 1_000;
/// Groups of episodes, from the lowest to the highest value of a condition.
const BINS: usize = 10;
/// Episodes that such a group has in the mean, at least.
const FEWEST_IN_A_BIN: usize = 5;

/// What a curve is about.
struct Named<'a> {
    curve: &'static str,
    controller: &'a str,
    group: Option<&'a str>,
    condition: Option<&'a str>,
}

/// All curves of a run, point by point.
#[must_use]
pub fn curves_table(campaign: &Campaign, scores: &Scores, ranking: &[SensitivityResult]) -> Table {
    let mut table = Table::default();
    for (name, numbers) in TeamNumbers::all(campaign) {
        for (index, controller) in campaign.controllers.iter().enumerate() {
            let named = Named {
                curve: DISTRIBUTION,
                controller,
                group: Some(&name),
                condition: None,
            };
            let mut values = numbers.rmse(scores, index);
            values.sort_unstable_by(f64::total_cmp);
            for (value, upto) in steps(&values) {
                let share = upto as f64 / values.len() as f64;
                add(&mut table, &named, [value, share], None);
            }
        }
    }
    for (index, controller) in campaign.controllers.iter().enumerate() {
        let named = Named {
            curve: SURVIVAL,
            controller,
            group: None,
            condition: None,
        };
        let episodes = 0..scores.episodes();
        let times = episodes.filter_map(|own| scores.failed_at_s(campaign.time, index, own));
        let mut times: Vec<f64> = times.collect();
        times.sort_unstable_by(f64::total_cmp);
        for (time_s, upto) in steps(&times) {
            let share = 1.0 - upto as f64 / scores.episodes() as f64;
            add(&mut table, &named, [time_s, share], None);
        }
    }
    if let Some((condition, of)) = strongest(campaign, ranking) {
        add_bands(&mut table, campaign, scores, condition, &of);
    }
    table
}

/// Of values in their order each finite one with how many are no larger, thinned: of equal values the last alone, and
/// the last of all.
fn steps(sorted: &[f64]) -> Vec<(f64, usize)> {
    let finite = sorted.iter().take_while(|value| value.is_finite()).count();
    let of_equals = |place: &usize| place + 1 == finite || sorted[*place] < sorted[place + 1];
    let all: Vec<usize> = (0..finite).filter(of_equals).collect();
    let stride = all.len().div_ceil(MOST_POINTS).max(1);
    let places = all.iter().enumerate();
    let kept = places.filter(|(index, _)| index % stride == 0 || index + 1 == all.len());
    kept.map(|(_, place)| (sorted[*place], place + 1)).collect()
}

fn add(table: &mut Table, named: &Named<'_>, [x, y]: [f64; 2], between: Option<[f64; 2]>) {
    let text = |name: Option<&str>| name.unwrap_or_default().into();
    table
        .row()
        .word(|| "curve".into(), named.curve)
        .name(|| "controller".into(), named.controller.into())
        .name(|| "group".into(), text(named.group))
        .name(|| "condition".into(), text(named.condition))
        .real(|| "x".into(), x)
        .real(|| "y".into(), y)
        .real_if("y_lower", between.map(|[lower, _]| lower))
        .real_if("y_upper", between.map(|[_, upper]| upper));
}

/// The condition that moves the errors of a controller most, and on which channels: of those that chance does not
/// explain as well, where they are tested.
fn strongest<'a>(
    campaign: &Campaign,
    ranking: &'a [SensitivityResult],
) -> Option<(&'a str, ChannelsOfCampaign)> {
    let tested = ranking.iter().any(|own| own.p_holm.is_some());
    let sure = |own: &&SensitivityResult| {
        own.target.kind == "rmse" && (!tested || own.p_holm.is_some_and(|p| p <= SIGNIFICANCE))
    };
    let first = ranking.iter().find(sure)?;
    let mut groups = campaign.channel_groups().into_iter();
    let of = groups.find(|own| Some(&own.name) == first.target.group.as_ref())?;
    Some((&first.condition, of))
}

fn add_bands(
    table: &mut Table,
    campaign: &Campaign,
    scores: &Scores,
    condition: &str,
    of: &ChannelsOfCampaign,
) {
    let mut conditions = scores.conditions.iter();
    let Some((_, sizes)) = conditions.find(|(name, _)| name == condition) else {
        return;
    };
    let sizes = by_chance(campaign, condition, sizes).into_iter();
    let met = sizes
        .enumerate()
        .filter_map(|(episode, size)| Some((size?, episode)));
    let mut met: Vec<(f64, usize)> = met.filter(|(size, _)| size.is_finite()).collect();
    met.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    if met.len() < FEWEST_IN_A_BIN * BINS {
        return;
    }
    // Of a count, whose values are few, all episodes with the same belong together.
    let by_value = || met.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq());
    let bins: Vec<&[(f64, usize)]> = match by_value().nth(BINS).is_none() {
        true => by_value().collect(),
        false => met.chunks(met.len().div_ceil(BINS)).collect(),
    };
    let numbers = TeamNumbers::on(campaign, of);
    for (index, controller) in campaign.controllers.iter().enumerate() {
        let named = Named {
            curve: BAND,
            controller,
            group: Some(&of.name),
            condition: Some(condition),
        };
        let values = numbers.rmse(scores, index);
        for bin in &bins {
            let mut of_bin: Vec<f64> = bin.iter().map(|(_, episode)| values[*episode]).collect();
            of_bin.sort_unstable_by(f64::total_cmp);
            let last = of_bin.len() - 1;
            let percentile = |percent: usize| of_bin[(percent * of_bin.len() / 100).min(last)];
            let point = [bin[bin.len() / 2].0, percentile(50)];
            let between = [percentile(5), percentile(95)];
            add(table, &named, point, Some(between));
        }
    }
}
