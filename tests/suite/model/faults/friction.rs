//! Friction: its force at every step, and what is said where a step leaps over it.

use super::{DRAG_N_S_M, MASS_KG, near, parsed, trajectory, velocity};
use urts_mc::campaign::lints::cautions;

const FRICTION: &str = "[[disturbance]]\nkind = \"friction\"\ncoulomb = [3.0, 0.0, 0.0, 0.0, 0.0, 0.0]\nviscous = 0.7\nsmoothing_rate = 0.4\n";

#[test]
fn val_friction_is_coulombs_smoothed_and_viscous() {
    let simulated = trajectory(&parsed(FRICTION, &["time.duration_s=2.0"]).unwrap());
    let mut turned = [false; 2];
    for (step, agents) in simulated.iter().enumerate() {
        let shown = &agents[0][0];
        let rate = velocity(shown, step);
        turned[usize::from(rate > 0.0)] = true;
        let force_n = MASS_KG * shown.f1 + DRAG_N_S_M * shown.e_rate;
        near(force_n, -3.0 * (rate / 0.4).tanh() - 0.7 * rate, "friction");
        // y has its viscous part alone.
        let shown = &agents[0][1];
        let rate = shown.e_rate + (step as f64 * 0.002).cos();
        let force_n = MASS_KG * shown.f1 + DRAG_N_S_M * shown.e_rate;
        near(force_n, -0.7 * rate, "viscous friction");
    }
    assert_eq!(turned, [true; 2], "the motion turns");
}

#[test]
fn friction_that_a_step_leaps_over_is_said_before_the_run() {
    let said = |changes: &[&str]| {
        let campaign = parsed(FRICTION, changes).unwrap();
        cautions(&campaign)
            .into_iter()
            .find(|said| said.starts_with("disturbance[0]"))
    };
    assert_eq!(said(&[]), None);
    // 3 N over 0.004 m/s turn 2 kg within 1.3 ms; a step takes 2 ms.
    assert_eq!(said(&["disturbance.0.smoothing_rate=0.004"]), None);
    let said = said(&[
        "disturbance.0.smoothing_rate={ uniform = [0.001, 1.0] }",
        "disturbance.0.coulomb=6.0",
    ])
    .unwrap();
    assert!(
        said.contains("friction turns roll within 2.1e-4 s and a step takes 0.002 s"),
        "{said}"
    );
    assert!(said.contains("raise smoothing_rate 5 times"), "{said}");
}
