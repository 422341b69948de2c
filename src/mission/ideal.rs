//! Missions without errors: agents follow their references exactly and are lost when it is said.

use crate::mission::draws::MissionDraws;
use crate::mission::motion::Motion;
use crate::mission::observed::Observed;
use crate::mission::outcome::Outcome;
use crate::mission::plane::Point;
use crate::mission::scenario::Scenario;
use crate::mission::state::Mission;

/// The outcome of a mission whose agents follow exactly; `lost_s` are agents and when they are lost, s.
#[must_use]
pub fn ideal(scenario: &Scenario, draws: &MissionDraws, lost_s: &[(usize, f64)]) -> Outcome {
    ideal_watched(scenario, draws, lost_s, |_| {})
}

/// As [`ideal`], with a look at the mission before every epoch, when its motions are those of that epoch.
#[must_use]
pub fn ideal_watched(
    scenario: &Scenario,
    draws: &MissionDraws,
    lost_s: &[(usize, f64)],
    mut watch: impl FnMut(&Mission<'_>),
) -> Outcome {
    let epoch_s = scenario.parameters().epoch_s;
    let mut mission = Mission::start(scenario, draws);
    let mut places_m: Vec<Point> = scenario.starts_m().to_vec();
    let mut lost: Vec<Option<f64>> = vec![None; scenario.agents()];
    loop {
        let now_s = f64::from(mission.epoch()) * epoch_s;
        for &(agent, time_s) in lost_s.iter().filter(|(_, time_s)| *time_s <= now_s) {
            if let Some(lost) = lost.get_mut(agent) {
                *lost = Some(time_s);
            }
        }
        let observed = Observed {
            places_m: &places_m,
            lost_s: &lost,
        };
        if mission.is_over() {
            return mission.finish(&observed);
        }
        watch(&mission);
        // Epoch k is flown while the motions of epoch k + 1 are decided.
        let ends_m: Vec<Point> = mission.motions().iter().map(Motion::end_m).collect();
        mission.decide(&observed);
        places_m = ends_m;
    }
}
