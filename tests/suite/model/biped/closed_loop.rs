//! A robot under a controller that measures without error, against an independent program's trajectories
//! (tests/golden/biped_closed_loop.json says where they are from).
//!
//! Its coupling is to the same walk at shifted times. Here those are three robots that walk ahead of the first and,
//! since nothing disturbs them, stay on their references.

use crate::common::{campaign, golden};
use serde_json::Value;
use urts_mc::agent::Agent;
use urts_mc::campaign::Campaign;
use urts_mc::draw::draw;
use urts_mc::model::controller::kinds::Controller;
use urts_mc::model::episode::{Model, Snapshot};
use urts_mc::reference::Reference;

/// What the reference states for a step of 1 ms, rad.
const TOLERANCE: f64 = 1e-7;
/// Steps between two of its rows.
const EVERY: u32 = 100;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The campaign of the reference, which the case must describe.
fn scenario(case: &Value) -> Campaign {
    let campaign = campaign("scenario-biped");
    assert_eq!(campaign.time.step_s, 1e-3);
    let Reference::Walk(walks) = &campaign.first_group().reference else {
        panic!("scenario-biped walks");
    };
    let shifts = case["coupling_time_shifts"].as_array().unwrap();
    assert_eq!((walks.len(), walks[0].start_s), (1 + shifts.len(), 0.0));
    for (walk, shift) in walks[1..].iter().zip(shifts) {
        assert_eq!(walk.start_s, -number(shift));
    }
    let offset = &golden("walking_straight6.json")["com_offset_m"];
    for k in 0..2 {
        assert_eq!(walks[0].walk.com_offset_m[k], number(&offset[k]));
    }
    let sine = &draw(campaign.first_group(), 0).agents[0].disturbances[0];
    let of_case = [number(&case["A"]), number(&case["omega"]), 0.0];
    for (drawn, of_case) in sine.iter().zip(of_case) {
        assert!(drawn.iter().all(|&drawn| drawn == of_case));
    }
    campaign
}

/// u_fb = -(K_I, K_P, K_D) [int e, e, e'].
fn gains(case: &Value) -> [f64; 3] {
    ["KI", "KP", "KD"].map(|key| -number(&case["gains"][key]))
}

fn trajectory(campaign: &Campaign, case: &Value, gains: [f64; 3]) -> Vec<Snapshot> {
    let mut episode = draw(campaign.first_group(), 0);
    for (agent, draw) in episode.agents.iter_mut().enumerate() {
        draw.kappa = if agent == 0 {
            number(&case["coupling"])
        } else {
            0.0
        };
    }
    let model = Model::<f64>::new(campaign.first_group());
    let controller = Controller::true_state(&[gains]);
    model
        .trace::<f64>(&controller, &[episode], EVERY)
        .remove(0)
        .1
}

/// The largest difference of a joint's angle from the case, rad.
fn difference(campaign: &Campaign, case: &Value, gains: [f64; 3]) -> f64 {
    let snapshots = trajectory(campaign, case, gains);
    let rows = case["q"].as_array().unwrap();
    assert_eq!(rows.len(), 80);
    let mut worst: f64 = 0.0;
    for (snapshot, row) in snapshots.iter().zip(rows) {
        for (joint, shown) in snapshot.agents[0].iter().enumerate() {
            let difference = (shown.x - number(&row[joint])).abs();
            // Not-a-number must not pass.
            worst = if difference <= worst {
                worst
            } else {
                difference
            };
        }
        for shown in snapshot.agents[1..].iter().flatten() {
            // Rounding of a feedforward of up to 100 N m on inertias of 0.01 kg m^2.
            assert!(shown.e.abs() < 1e-12, "off its reference by {}", shown.e);
        }
    }
    worst
}

#[test]
fn val_a_walk_under_disturbance_and_coupling_follows_the_independent_trajectories() {
    for (name, case) in golden("biped_closed_loop.json")["cases"]
        .as_object()
        .unwrap()
    {
        let difference = difference(&scenario(case), case, gains(case));
        println!("{name}: {difference:.1e} rad");
        assert!(difference <= TOLERANCE, "{name} differs by {difference:e}");
    }
}

#[test]
fn the_comparison_notices_a_changed_digit_of_a_gain_or_an_inertia() {
    let file = golden("biped_closed_loop.json");
    let case = &file["cases"]["A10_coupling1"];
    let mut wrong = vec![];
    for (k, change) in [0.1, 1.0, 0.1].into_iter().enumerate() {
        let mut gains = gains(case);
        gains[k] += change;
        wrong.push(difference(&scenario(case), case, gains));
    }
    let other: [Campaign; 3] = std::array::from_fn(|change| {
        scenario(case).with(|campaign| {
            let Agent::Biped(biped) = &mut campaign.agent else {
                panic!("scenario-biped is of robots");
            };
            let joint = &mut biped.robot.legs[0].joints[3];
            match change {
                // 1.932 kg, 0.01 kg m^2; a damping of which the feedforward knows acts only on the errors.
                0 => joint.body.mass_kg += 0.001,
                1 => joint.armature_kg_m2 += 1e-5,
                _ => joint.damping_n_m_s += 1e-3,
            }
        })
    });
    wrong.extend(other.map(|campaign| difference(&campaign, case, gains(case))));
    let mut uncoupled = case.clone();
    uncoupled["coupling"] = Value::from(0.9999);
    wrong.push(difference(&scenario(case), &uncoupled, gains(case)));
    println!("{wrong:?}");
    assert!(wrong.iter().all(|&wrong| wrong > TOLERANCE), "{wrong:?}");
}
