//! The closed loop against trajectories that an independent program integrated (tests/golden/scenarios.json says where
//! they are from): scenario A fully actuated, scenario B with thrust, filter and actuator faults.

use crate::common::{altered, gains, golden};
use serde_json::Value;
use urts_mc::backend::cpu::{Cpu, Precision, Simd};
use urts_mc::campaign::Campaign;
use urts_mc::model::ChannelSample;
use urts_mc::model::episode::Snapshot;

/// What the reference data states for gains of its own, relative to the largest entry of a quantity.
const TRAJECTORY_TOL: f64 = 1e-6;
/// With Clarabel's gains, which differ from the Riccati gains by up to 2e-4 relative.
const OWN_GAINS_TOL: f64 = 1e-4;
/// Samples of the reference's RMSE and maxima, s.
const SAMPLE_S: f64 = 0.01;
const SETTLE_S: f64 = 2.0;

/// A quantity of the golden file and where a snapshot shows it.
type Quantity = (&'static str, fn(&ChannelSample) -> f64);
const QUANTITIES: [Quantity; 7] = [
    ("e", |shown| shown.e),
    ("edot", |shown| shown.e_rate),
    ("f1", |shown| shown.f1),
    ("f1hat", |shown| shown.f1_hat),
    ("f2", |shown| shown.f2),
    ("f2hat", |shown| shown.f2_hat),
    ("u", |shown| shown.u),
];

/// The setting that takes the gains from the reference data.
fn golden_gains(preset: &str) -> String {
    format!("synthesis.gains=\"../tests/golden/gains-{preset}.json\"")
}

fn with_golden_gains(name: &str, preset: &str) -> Campaign {
    altered(name, &[&golden_gains(preset)])
}

/// The trajectory of the first episode under a controller, every 10 ms.
fn trajectory(
    campaign: &Campaign,
    controller: &str,
    precision: Precision,
    simd: Option<Simd>,
) -> Vec<Snapshot> {
    let gains = gains(campaign);
    let index = campaign
        .controllers
        .iter()
        .position(|name| name == controller)
        .unwrap();
    let every = (SAMPLE_S / campaign.time.step_s).round() as u32;
    Cpu::new(campaign.first_group(), &gains.loops(), precision, simd)
        .trace(0, index, every)
        .1
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().unwrap()],
    }
}

/// The largest difference between two lists, relative to the largest entry of the second.
fn relative_difference(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let largest = theirs
        .iter()
        .fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let difference = ours
        .iter()
        .zip(theirs)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    if largest == 0.0 {
        difference
    } else {
        difference / largest
    }
}

/// Samples every second, RMS and largest errors and commands, each as the largest difference to the golden file.
fn differences(expected: &Value, trajectory: &[Snapshot]) -> Vec<(String, f64)> {
    let per_second = (1.0 / SAMPLE_S) as usize;
    let mut found = Vec::new();
    for (name, pick) in QUANTITIES {
        let ours: Vec<f64> = trajectory
            .iter()
            .skip(per_second)
            .step_by(per_second)
            .flat_map(|snapshot| all(snapshot, pick))
            .collect();
        assert_eq!(ours.len(), 20 * 18);
        found.push((
            name.to_string(),
            relative_difference(&ours, &numbers(&expected[name])),
        ));
    }
    let settled = &trajectory[(SETTLE_S / SAMPLE_S) as usize..];
    for (name, samples, pick) in [
        (
            "rmse_t_ge_2",
            settled,
            (|shown| shown.e) as fn(&ChannelSample) -> f64,
        ),
        ("u_rms", trajectory, |shown| shown.u),
        ("f1_rms_err", settled, |shown| shown.f1_hat - shown.f1),
        ("f2_rms_err", settled, |shown| shown.f2_hat - shown.f2),
    ] {
        found.push((
            name.to_string(),
            relative_difference(&root_mean_squares(samples, pick), &numbers(&expected[name])),
        ));
    }
    for (name, samples, pick) in [
        (
            "max_abs_e_t_ge_2",
            settled,
            (|shown| shown.e) as fn(&ChannelSample) -> f64,
        ),
        ("u_max", trajectory, |shown| shown.u),
    ] {
        let mut largest = [0.0_f64; 18];
        for snapshot in samples {
            for (largest, value) in largest.iter_mut().zip(all(snapshot, pick)) {
                *largest = largest.max(value.abs());
            }
        }
        found.push((
            name.to_string(),
            relative_difference(&largest, &numbers(&expected[name])),
        ));
    }
    found
}

fn all(snapshot: &Snapshot, pick: fn(&ChannelSample) -> f64) -> Vec<f64> {
    snapshot.agents.iter().flatten().map(pick).collect()
}

fn root_mean_squares(samples: &[Snapshot], pick: fn(&ChannelSample) -> f64) -> Vec<f64> {
    let mut sums = [0.0; 18];
    for snapshot in samples {
        for (sum, value) in sums.iter_mut().zip(all(snapshot, pick)) {
            *sum += value * value;
        }
    }
    sums.iter()
        .map(|sum| (sum / samples.len() as f64).sqrt())
        .collect()
}

fn check(name: &str, controller: &str, campaign: &Campaign, tolerance: f64) {
    let trajectory = trajectory(campaign, controller, Precision::F64, None);
    let expected = &golden("scenarios.json")[name][controller];
    for (quantity, difference) in differences(expected, &trajectory) {
        println!("{name} {controller} {quantity}: {difference:.2e}");
        assert!(
            difference <= tolerance,
            "{name} {controller}: {quantity} differs by {difference:e} > {tolerance:e}"
        );
    }
}

#[test]
fn val_scenario_a_reproduces_the_independent_trajectories() {
    let campaign = with_golden_gains("scenario-a", "uav-paper");
    check("scenario-a", "ftc", &campaign, TRAJECTORY_TOL);
    check("scenario-a", "pid", &campaign, TRAJECTORY_TOL);
}

#[test]
fn val_scenario_b_reproduces_the_independent_trajectories() {
    let campaign = with_golden_gains("scenario-b", "uav-physical");
    check("scenario-b", "ftc", &campaign, TRAJECTORY_TOL);
    check("scenario-b", "pid", &campaign, TRAJECTORY_TOL);
}

#[test]
fn val_the_scenarios_with_our_own_gains_stay_within_1e_4() {
    for name in ["scenario-a", "scenario-b"] {
        let campaign = altered(name, &[]);
        check(name, "ftc", &campaign, OWN_GAINS_TOL);
        check(name, "pid", &campaign, OWN_GAINS_TOL);
    }
}

#[test]
fn the_scenario_comparison_notices_small_changes_of_the_model() {
    // A hair more than the tolerance on single constants of each part of the model must show.
    let (a, b) = (("scenario-a", "uav-paper"), ("scenario-b", "uav-physical"));
    for ((name, preset), new) in [
        (a, "coupling.kappa=1.0001"),
        (a, "disturbance.0.frequency_rad_s=3.00001"),
        (a, "fault.0.smoothing=0.10001"),
        (a, "agent.angular_drag_n_m_s=0.013"),
        (b, "fault.1.onset_s=12.001"),
        (b, "fault.1.magnitude=0.3001"),
        (b, "agent.command_filter_rad_s=20.01"),
    ] {
        let campaign = altered(name, &[&golden_gains(preset), new]);
        let trajectory = trajectory(&campaign, "ftc", Precision::F64, None);
        let worst = differences(&golden("scenarios.json")[name]["ftc"], &trajectory)
            .into_iter()
            .map(|(_, difference)| difference)
            .fold(0.0, f64::max);
        assert!(
            worst > TRAJECTORY_TOL,
            "{name} with {new:?} still agrees to {worst:e}"
        );
    }
}

#[test]
fn val_pid_tuned_has_the_independent_rmse_on_scenario_a() {
    // The reference states three digits; 1 % is what they carry.
    let campaign = with_golden_gains("scenario-a", "uav-paper");
    let samples = trajectory(&campaign, "pid-tuned", Precision::F64, None);
    let rmse = root_mean_squares(&samples[(SETTLE_S / SAMPLE_S) as usize..], |shown| shown.e);
    println!("pid-tuned rmse x {:.4}, roll {:.4}", rmse[0], rmse[3]);
    for (ours, theirs) in [(rmse[0], 0.231), (rmse[3], 0.332)] {
        assert!(
            (ours / theirs - 1.0).abs() < 0.01,
            "{ours} against {theirs}"
        );
    }
}

#[test]
fn single_precision_stays_within_the_contract_on_the_scenarios() {
    // The contract of the model between precisions: |e| within 2e-4 at any time.
    for name in ["scenario-a", "scenario-b"] {
        let campaign = altered(name, &[]);
        for controller in ["ftc", "pid", "pid-tuned"] {
            let double = trajectory(&campaign, controller, Precision::F64, None);
            for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
                let single = trajectory(&campaign, controller, Precision::F32, Some(simd));
                let worst = double
                    .iter()
                    .zip(&single)
                    .flat_map(|(double, single)| {
                        let errors = |snapshot: &Snapshot| all(snapshot, |shown| shown.e);
                        errors(double)
                            .into_iter()
                            .zip(errors(single))
                            .map(|(a, b)| (a - b).abs())
                    })
                    .fold(0.0, f64::max);
                println!("{name} {controller} {simd:?}: {worst:.2e}");
                assert!(
                    worst <= 2e-4,
                    "{name} {controller} {simd:?} differs by {worst:e}"
                );
                assert!(
                    worst > 0.0,
                    "single precision cannot equal double precision"
                );
            }
        }
    }
}
