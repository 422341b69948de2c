//! How long a step the gains and the plant allow.

use super::gain_set::GainSet;
use crate::agent::{ActuationKind, Agent};
use crate::campaign::{AgentGroup, CampaignError, RandomQuantity};
use crate::synthesis::poles;
use nalgebra::Complex;

impl GainSet {
    /// Refuses a step at which the Runge-Kutta method would not be stable on the closed loop.
    ///
    /// # Errors
    /// If the step is too long, with the longest that is not.
    pub fn check_step(&self, group: &AgentGroup) -> Result<(), CampaignError> {
        let step_s = group.time.step_s;
        let of_controllers = self.controllers.iter().flat_map(|controller| {
            let poles = controller
                .groups
                .iter()
                .flat_map(|channel| poles(&channel.loop_gains));
            poles.map(move |pole| (pole, format!("{:?}", controller.name)))
        });
        let of_plant = plant_poles(group)
            .into_iter()
            .map(|(pole, of)| (Complex::new(pole, 0.0), of.to_string()));
        let worst = of_controllers
            .chain(of_plant)
            .map(|(pole, of)| (longest_stable_step(pole), of, pole))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match worst {
            Some((limit_s, of, pole)) if step_s > limit_s => {
                let limit = format!(
                    "above {limit_s:.2e} s the integration is unstable at the pole {:.1} {:+.1}i 1/s of {of}",
                    pole.re, pole.im
                );
                let remedy = format!("use {:.1e} or less", limit_s / 2.0);
                Err(group.invalid("time.step_s", step_s, &limit, &remedy))
            }
            _ => Ok(()),
        }
    }
}

/// The poles of what is not a controller: a UAV's damping at its lightest, and its command filter.
fn plant_poles(group: &AgentGroup) -> Vec<(f64, &'static str)> {
    let Agent::Uav(uav) = &group.agent else {
        return Vec::new();
    };
    let least = |scale: &RandomQuantity| {
        let lows = scale
            .distributions
            .iter()
            .map(|distribution| distribution.support().0);
        lows.fold(f64::INFINITY, f64::min)
    };
    let smallest_inertia = uav.inertia_kg_m2.into_iter().fold(f64::INFINITY, f64::min);
    let filter = match uav.actuation {
        ActuationKind::Thrust => -uav.command_filter_rad_s,
        _ => 0.0,
    };
    vec![
        (
            -uav.drag_n_s_m / (uav.mass_kg * least(&group.mass_scale)),
            "the drag",
        ),
        (
            -uav.angular_drag_n_m_s / (smallest_inertia * least(&group.inertia_scale)),
            "the angular drag",
        ),
        (filter, "the command filter"),
    ]
}

/// The longest step at which the classical Runge-Kutta method damps a mode that decays.
fn longest_stable_step(pole: Complex<f64>) -> f64 {
    let grows = |step_s: f64| {
        let z = pole * step_s;
        let one = Complex::new(1.0, 0.0);
        (one + z * (one + z / 2.0 * (one + z / 3.0 * (one + z / 4.0)))).norm() > 1.0
    };
    // No decaying mode is stable beyond |z| = 4.
    let (mut stable, mut unstable) = (0.0, 4.0 / pole.norm().max(f64::MIN_POSITIVE));
    if !unstable.is_finite() || !grows(unstable) {
        return unstable;
    }
    for _ in 0..60 {
        let middle = f64::midpoint(stable, unstable);
        if grows(middle) {
            unstable = middle;
        } else {
            stable = middle;
        }
    }
    stable
}
