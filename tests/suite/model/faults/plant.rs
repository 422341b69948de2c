//! Changes of the plant: the motion is that of the changed body.

use super::{
    AMPLITUDE_M, DRAG_N_S_M, FREQUENCY_RAD_S, GRAVITY_M_S2, MASS_KG, X, campaign, near, time_s,
    trajectory, velocity,
};
use urts_mc::model::ChannelSample;

const ONSET: usize = 150;
const INERTIA_KG_M2: [f64; 3] = [1.25, 1.25, 2.2];
const ANGULAR_DRAG_N_M_S: f64 = 0.012;

fn plant(kind: &str, more: &str) -> Vec<Vec<Vec<ChannelSample>>> {
    trajectory(&campaign(&format!(
        "[[fault]]\ntarget = \"plant\"\nkind = \"{kind}\"\nonset_s = 0.3\n{more}\n"
    )))
}

/// f1 of x if its mass is this: e'' is (u - K v)/mass - r'', what was commanded u/m less the feedforward.
fn f1_of_x(shown: &ChannelSample, step: usize, mass_kg: f64) -> f64 {
    let phase = FREQUENCY_RAD_S * time_s(step);
    let acceleration = -AMPLITUDE_M * FREQUENCY_RAD_S * FREQUENCY_RAD_S * phase.sin();
    let rate = AMPLITUDE_M * FREQUENCY_RAD_S * phase.cos();
    let told = (shown.u - DRAG_N_S_M * rate) / MASS_KG - acceleration;
    (shown.u - DRAG_N_S_M * velocity(shown, step)) / mass_kg - acceleration - told
}

/// f1 of an angle that stands still, if this torque acts on this inertia beside the command.
fn f1_of_angle(
    shown: &ChannelSample,
    inertia_kg_m2: f64,
    modelled_kg_m2: f64,
    torque_n_m: f64,
) -> f64 {
    let net = shown.u + torque_n_m - ANGULAR_DRAG_N_M_S * shown.e_rate;
    net / inertia_kg_m2 - shown.u / modelled_kg_m2
}

#[test]
fn val_a_mass_grows_along_its_ramp() {
    let simulated = plant("mass", "magnitude = 0.5\nramp_s = 0.2");
    for (step, agents) in simulated.iter().enumerate() {
        let risen = if step < ONSET {
            0.0
        } else {
            ((step - ONSET + 1) as f64 / 100.0).min(1.0)
        };
        let shown = &agents[0][X];
        near(
            shown.f1,
            f1_of_x(shown, step, MASS_KG * (1.0 + 0.5 * risen)),
            "f1 of x",
        );
        // Of the three angles only the weight of the others' gyroscopic torques is left.
        near(
            agents[0][5].f1,
            f1_of_angle(&agents[0][5], 2.2, 2.2, 0.0),
            "f1 of yaw",
        );
    }
    assert!(simulated[400][0][2].f1.abs() > 1.0, "z has to carry it");
}

#[test]
fn val_an_inertia_grows_and_a_mass_does_not() {
    let simulated = plant("inertia", "magnitude = -0.3");
    for (step, agents) in simulated.iter().enumerate() {
        let scale = if step < ONSET { 1.0 } else { 0.7 };
        near(
            agents[0][X].f1,
            f1_of_x(&agents[0][X], step, MASS_KG),
            "f1 of x",
        );
        let yaw = &agents[0][5];
        near(yaw.f1, f1_of_angle(yaw, 2.2 * scale, 2.2, 0.0), "f1 of yaw");
    }
    assert!(
        simulated[160..]
            .iter()
            .any(|agents| agents[0][5].f1.abs() > 1e-6)
    );
}

/// Roll and pitch of a UAV whose gyroscopic torques are small: as far as they are not, the channels say it of
/// themselves.
fn gyroscopic(agents: &[Vec<ChannelSample>], axis: usize) -> f64 {
    let rate = |axis: usize| agents[0][3 + axis % 3].e_rate;
    let [j, k] = [INERTIA_KG_M2[(axis + 1) % 3], INERTIA_KG_M2[(axis + 2) % 3]];
    (k - j) / INERTIA_KG_M2[axis] * rate(axis + 1) * rate(axis + 2)
}

#[test]
fn val_a_shifted_centre_of_mass_tilts() {
    let simulated = plant("center-of-mass", "offset_x_m = 0.05\noffset_y_m = -0.02");
    let weight_n = MASS_KG * GRAVITY_M_S2;
    for (step, agents) in simulated.iter().enumerate() {
        let there = if step < ONSET { 0.0 } else { 1.0 };
        let torques = [0.02 * weight_n * there, 0.05 * weight_n * there, 0.0];
        for axis in 0..3 {
            let shown = &agents[0][3 + axis];
            let inertia = INERTIA_KG_M2[axis];
            let expected = f1_of_angle(shown, inertia, inertia, torques[axis]);
            near(
                shown.f1,
                expected - gyroscopic(agents, axis),
                "f1 of an angle",
            );
        }
    }
}

#[test]
fn val_a_payload_weighs_resists_and_tilts() {
    let simulated = plant(
        "payload",
        "mass_kg = 0.4\noffset_x_m = 0.3\noffset_y_m = 0.1\nduration_s = 0.4",
    );
    for (step, agents) in simulated.iter().enumerate() {
        let there = if (ONSET..ONSET + 200).contains(&step) {
            1.0
        } else {
            0.0
        };
        let mass_kg = 0.4 * there;
        near(
            agents[0][X].f1,
            f1_of_x(&agents[0][X], step, MASS_KG + mass_kg),
            "f1 of x",
        );
        let arms2_m2 = [0.01, 0.09, 0.10];
        let torques = [
            -0.1 * mass_kg * GRAVITY_M_S2,
            0.3 * mass_kg * GRAVITY_M_S2,
            0.0,
        ];
        for axis in 0..3 {
            let shown = &agents[0][3 + axis];
            let modelled = INERTIA_KG_M2[axis];
            let inertia = modelled + mass_kg * arms2_m2[axis];
            let expected = f1_of_angle(shown, inertia, modelled, torques[axis]);
            near(
                shown.f1,
                expected - gyroscopic(agents, axis),
                "f1 of an angle",
            );
        }
    }
}
