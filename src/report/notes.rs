//! What has to be known to read the statistics of a run: its sampling design, and what ended it.

use crate::campaign::Campaign;
use crate::results::FEWEST_REPLICATES;
use crate::run::manifest::Manifest;
use crate::simulation::stopping::Stopped;

/// A sentence for each thing that makes a run's statistics other than usual; nothing where nothing does.
#[must_use]
pub fn caveats(campaign: &Campaign, manifest: &Manifest) -> Vec<String> {
    let replicates = campaign.sampling.replicates();
    let design = replicates.map(|replicates| of_design(campaign, replicates));
    let stopped = manifest.stopped.as_ref();
    let stop = stopped.map(|stopped| of_stop(stopped, manifest.episodes_asked));
    let repeated = (!campaign.is_random() && manifest.episodes > 1).then(|| {
        "nothing is random: the episodes are all the same, so that there are no intervals and no tests".to_string()
    });
    repeated.into_iter().chain(design).chain(stop).collect()
}

fn of_design(campaign: &Campaign, replicates: u32) -> String {
    let design = campaign.sampling.design().replicates_noun();
    let instead = if replicates as usize >= FEWEST_REPLICATES {
        format!("the intervals here are Student's t over the {replicates} replicates")
    } else {
        format!("with {FEWEST_REPLICATES} replicates or more there would be intervals over them")
    };
    format!(
        "design: {replicates} {design} of {} episodes, which are not independent of each other: intervals and tests that need \
         that are left out; {instead}",
        campaign.episodes / replicates.max(1),
    )
}

fn of_stop(stopped: &Stopped, asked: u32) -> String {
    let Stopped {
        controller,
        episodes,
        failures,
        confidence,
        lower,
        upper,
        reached,
    } = stopped;
    let ended = match reached {
        Some(goal) if *episodes < u64::from(asked) => {
            format!("stopped after {episodes} of {asked} episodes, as {goal} is reached")
        }
        Some(goal) => format!("{goal} is reached after all {asked} episodes"),
        None => format!("no goal of [stop] is reached in {episodes} of {asked} episodes"),
    };
    let rate = match (*lower > 0.0, *upper < 1.0) {
        (false, _) => format!("below {:.2} %", 100.0 * upper),
        (true, false) => format!("above {:.2} %", 100.0 * lower),
        (true, true) => format!("between {:.2} and {:.2} %", 100.0 * lower, 100.0 * upper),
    };
    format!(
        "{ended}: the failure rate of {controller} is {rate} with {} % confidence, whenever one looks ({failures} failed); \
         failure rates have such bounds here, all other intervals are those of a fixed number of episodes and only nearly right",
        100.0 * confidence,
    )
}
