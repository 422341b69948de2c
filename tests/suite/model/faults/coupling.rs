//! The coupling (10) from the origin and from the team's centroid.

use super::{DRAG_N_S_M, MASS_KG, X, campaign, near, trajectory};
use urts_mc::model::ChannelSample;

const KAPPA: f64 = 0.7;

/// A team of two, the second of which is elsewhere; both may be moved by as much.
fn coupled(coordinates: &str, moved_m: f64) -> Vec<Vec<Vec<ChannelSample>>> {
    let center = |x_m: f64| {
        format!(
            "[[reference.agents]]\ncenter = [{:?}, 0.0, 0.0, 0.0, 0.0, 0.0]\n",
            x_m + moved_m
        )
    };
    trajectory(&campaign(&format!(
        "[coupling]\nkappa = {KAPPA}\ncoordinates = {coordinates:?}\n{}{}",
        center(0.0),
        center(1.5)
    )))
}

/// Holds the force on x of each agent against a formula of its x and the other's.
fn holds(simulated: &[Vec<Vec<ChannelSample>>], force_n: impl Fn(f64, f64) -> f64) {
    for agents in simulated {
        for (own, other) in [(0, 1), (1, 0)] {
            let shown = &agents[own][X];
            let found = MASS_KG * shown.f1 + DRAG_N_S_M * shown.e_rate;
            near(
                found,
                force_n(shown.x, agents[other][X].x),
                "the force of the coupling",
            );
        }
    }
}

#[test]
fn val_the_coupling_is_the_product_of_the_coordinates() {
    holds(&coupled("absolute", 0.0), |own, other| KAPPA * own * other);
}

#[test]
fn val_from_the_centroid_it_does_not_matter_where_the_team_is() {
    let here = coupled("centroid", 0.0);
    holds(&here, |own, other| {
        let centroid = (own + other) / 2.0;
        KAPPA * (own - centroid) * (other - centroid)
    });
    let [there, absolute, absolute_there] = [
        coupled("centroid", 10.0),
        coupled("absolute", 0.0),
        coupled("absolute", 10.0),
    ];
    let (mut same, mut other) = (0.0_f64, 0.0_f64);
    for step in 0..here.len() {
        same = same.max((here[step][0][X].e - there[step][0][X].e).abs());
        other = other.max((absolute[step][0][X].e - absolute_there[step][0][X].e).abs());
    }
    // Coordinates of ten metres round by 1e-15 of them.
    assert!(same < 1e-11 && other > 1e-3, "{same:e} and {other:e} m");
}
