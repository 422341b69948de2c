//! Whether anything in a campaign is left to chance, and which statistics its episodes allow.

use super::disturbances_and_faults::{Fault, FaultChannels};
use super::group::GroupParts;
use super::kinds::{DisturbanceKind, MEAN_WIND, SHARE, STD};
use super::parameter::Parameter;
use super::quantity::RandomQuantity;
use super::validated::Campaign;
use crate::random::{Method, allows};

impl Campaign {
    /// Whether episodes differ by chance. If not, all episodes of a stratum are one and the same, however many there
    /// are, and say no more than one.
    #[must_use]
    pub fn is_random(&self) -> bool {
        self.groups().iter().any(|group| group.is_random())
    }

    /// Whether a statistic keeps what it promises for the episodes of this campaign.
    #[must_use]
    pub fn allows(&self, method: Method) -> bool {
        allows(self.sampling.design(), method) && (self.is_random() || method == Method::Estimate)
    }
}

impl GroupParts {
    /// Whether something of its agents is drawn, or changes by chance in the course of an episode.
    fn is_random(&self) -> bool {
        let initial = &self.initial;
        let of_agents = [
            &self.mass_scale,
            &self.inertia_scale,
            &self.kappa,
            &initial.error,
            &initial.error_rate,
            &initial.error_integral,
        ];
        let mut drawn = of_agents.into_iter().chain(&self.control.delay_s);
        drawn.any(RandomQuantity::varies)
            || self.disturbances.iter().any(|one| {
                let turbulent = one.kind == DisturbanceKind::Dryden
                    && is_there(&MEAN_WIND, one.kind.parameters(), &one.parameters);
                turbulent || one.parameters.iter().any(RandomQuantity::varies)
            })
            || self.faults.iter().any(Fault::is_random)
    }
}

impl Fault {
    /// Whether it differs from episode to episode, or from step to step by chance.
    fn is_random(&self) -> bool {
        if self.probability.iter().all(|own| *own == 0.0) {
            return false;
        }
        let when = [
            Some(&self.onset_s),
            self.duration_s.as_ref(),
            self.ramp_s.as_ref(),
        ];
        let mut drawn = when.into_iter().flatten().chain(&self.parameters);
        let parameters = self.kind.parameters();
        self.probability.iter().any(|own| 0.0 < *own && *own < 1.0)
            || self.channels.contains(&FaultChannels::One)
            || drawn.any(RandomQuantity::varies)
            // What is there in some slots or steps, and noise.
            || SHARE.place_in(parameters).is_some()
            || is_there(&STD, parameters, &self.parameters)
    }
}

/// Whether a kind has a parameter that is not zero everywhere.
fn is_there(parameter: &Parameter, of_kind: &[Parameter], drawn: &[RandomQuantity]) -> bool {
    let place = parameter.place_in(of_kind);
    place.is_some_and(|place| !drawn[place].is_zero())
}
