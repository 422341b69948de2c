//! Every kind of campaign, all episodes of which differ: each episode, controller, agent and channel is compared with
//! the CPU, in double precision within the contract and in single precision within rounding.

use super::agreement::{CONTRACT, Expected, Summary, TWIN, failed, figures, saturated};
use super::altered;
use super::{Gains, LONGEST, mixed, mixed_thrust, simulate, team_of};
use crate::common::{gains, gpu_or_skip};
use urts_mc::backend::cpu::{Cpu, Precision};
use urts_mc::backend::gpu::{Gpu, GpuSimulator, Tuning};
use urts_mc::campaign::Campaign;
use urts_mc::model::ChannelSample;

/// Simulates a campaign and demands agreement, in double and in single precision; none without an adapter.
pub(super) fn agreement(campaign: &Campaign) -> Option<[Summary; 2]> {
    let gpu = gpu_or_skip()?;
    let gains = gains(campaign).loops();
    let simulated = simulate(&gpu, campaign, &gains, LONGEST);
    for (k, one) in simulated.iter().enumerate() {
        let mut before = simulated[..k].iter();
        assert!(before.all(|other| other.episode.agents != one.episode.agents));
    }
    let agreed = [&CONTRACT, &TWIN].map(|against| {
        let compared = Expected::new(campaign, &gains, against).compare(&simulated);
        let summary =
            compared.unwrap_or_else(|difference| panic!("{}: {difference}", campaign.name));
        println!("{}: {summary}", campaign.name);
        assert!(summary.compared > 0, "nothing was compared");
        summary
    });
    Some(agreed)
}

#[test]
fn val_smoke_agrees_beyond_one_workgroup() {
    // A workgroup of an axis holds 64 episodes.
    let campaign = altered("smoke", &["episodes=70"]);
    let Some([double, single]) = agreement(&campaign) else {
        return;
    };
    assert!(double.exceeded > 0 && single.compared > 140);
}

#[test]
fn val_uav_paper_agrees() {
    let campaign = altered("uav-paper", &["episodes=24"]);
    let Some([double, _]) = agreement(&campaign) else {
        return;
    };
    assert!(double.exceeded > 0 && double.compared > 40);
}

#[test]
fn val_uav_physical_agrees_and_saturates() {
    let campaign = altered(
        "uav-physical",
        // Small errors at the start, so that some episodes do not saturate.
        &[
            "episodes=24",
            "time.duration_s=12.0",
            "initial.error.normal.std=0.05",
            "initial.error_rate.normal.std=0.05",
        ],
    );
    let Some([double, single]) = agreement(&campaign) else {
        return;
    };
    assert!(single.saturated > 20 && double.compared > 20);
}

#[test]
fn val_waypoints_with_noise_agree() {
    let campaign = altered("waypoints", &["episodes=16", "time.duration_s=20.0"]);
    assert!(
        campaign
            .first_group()
            .faults
            .iter()
            .any(|fault| fault.kind.name() == "noise")
    );
    let Some([double, _]) = agreement(&campaign) else {
        return;
    };
    assert!(double.compared > 30);
}

#[test]
fn val_the_deterministic_scenarios_agree() {
    let a = altered("scenario-a", &["time.duration_s=8.0"]);
    let b = altered(
        "scenario-b",
        &[
            "time.duration_s=10.0",
            "fault.0.onset_s=4.0",
            "fault.1.onset_s=6.0",
        ],
    );
    for campaign in [a, b] {
        let Some([double, _]) = agreement(&campaign) else {
            return;
        };
        assert!(double.compared == 3);
    }
}

#[test]
fn val_observers_that_start_from_zero_agree() {
    let campaign = altered("no-fault", &["episodes=8", "time.duration_s=4.0"]);
    let Some([double, _]) = agreement(&campaign) else {
        return;
    };
    assert!(double.compared == 24);
}

#[test]
fn val_everything_at_once_agrees_up_to_the_verdicts_of_those_that_fail() {
    let Some([double, single]) = agreement(&mixed(&[])) else {
        return;
    };
    assert!(double.compared > 60 && single.exceeded > 100 && single.diverged > 10);
}

#[test]
fn val_everything_at_once_under_thrust_agrees() {
    let Some([double, single]) = agreement(&mixed_thrust(&[])) else {
        return;
    };
    assert!(double.compared > 5 && single.compared > 50);
    assert!(single.exceeded > 50 && single.diverged > 10 && single.saturated > 40);
}

#[test]
fn val_a_team_of_64_agrees_though_its_references_take_turns_on_the_device() {
    // One row per half step: 64 agents x 6 channels x 16 bytes, so 32 MiB hold the references of 2730 steps.
    let changes = [
        "episodes=2",
        "coupling.kappa.choice=[0.0, 0.001]",
        "initial.error.normal.std=0.05",
        "initial.error_rate.normal.std=0.05",
        "agent.max_torque_n_m=600.0",
        "agent.max_thrust_n=200.0",
        "time.duration_s=11.0",
        "controllers=[\"pid\"]",
    ];
    let campaign = team_of(&altered("uav-physical", &changes), 64);
    assert!(campaign.time.steps > 2 * 2730);
    let Some([_, single]) = agreement(&campaign) else {
        return;
    };
    assert!(single.compared > 0);
}

/// What is compared of a trajectory, and by how much it may differ.
type Quantity = (&'static str, fn(&ChannelSample) -> f64, f64);
const QUANTITIES: [Quantity; 9] = [
    // m or rad: the contract's for e; what is measured and estimated of the same unit may differ by as much.
    ("x", |shown| shown.x, 2e-4),
    ("e", |shown| shown.e, 2e-4),
    ("e_hat", |shown| shown.e_hat, 2e-4),
    ("f2", |shown| shown.f2, 2e-4),
    ("f2_hat", |shown| shown.f2_hat, 2e-4),
    // m/s or rad/s, and m/s^2 or rad/s^2: errors and disturbances change tens of times a second.
    ("e_rate", |shown| shown.e_rate, 2e-3),
    ("f1", |shown| shown.f1, 2e-2),
    ("f1_hat", |shown| shown.f1_hat, 2e-2),
    // N or N m: a mass of 2 kg is accelerated.
    ("u", |shown| shown.u, 4e-2),
];

/// Follows some episodes of a campaign, every 20 ms, and demands that they agree with double precision and end as they
/// do in a simulation of all episodes; returns how many episodes were followed to the end.
pub(super) fn followed(gpu: &Gpu, campaign: &Campaign, episodes: &[u32]) -> usize {
    let gains: Gains = gains(campaign).loops();
    let mut simulator =
        GpuSimulator::new(gpu, campaign.first_group(), &gains, Tuning::default()).unwrap();
    let cpu = Cpu::new(campaign.first_group(), &gains, Precision::F64, None);
    let mut instants = Vec::new();
    let traced = simulator
        .trace(episodes, 10, &mut |instant| {
            let of = |episode| {
                let controllers = 0..campaign.controllers.len();
                controllers
                    .map(|controller| instant.agents(episode, controller))
                    .collect()
            };
            let shown: Vec<Vec<_>> = (0..episodes.len()).map(of).collect();
            instants.push((instant.step, shown));
        })
        .unwrap();
    let simulated = simulate(gpu, campaign, &gains, Tuning::default());
    let (mut largest, mut count) = ([0.0_f64; QUANTITIES.len()], 0);
    for (k, &episode) in episodes.iter().enumerate() {
        assert_eq!(
            format!("{:?}", traced[k]),
            format!("{:?}", simulated[episode as usize])
        );
        for controller in 0..campaign.controllers.len() {
            let (outcomes, snapshots) = cpu.trace(episode, controller, 10);
            assert_eq!(snapshots.len(), instants.len());
            if outcomes
                .iter()
                .any(|agent| failed(agent) || saturated(agent))
            {
                continue;
            }
            count += 1;
            for (snapshot, (step, shown)) in snapshots.iter().zip(&instants) {
                assert_eq!(snapshot.step, *step);
                let pairs = snapshot
                    .agents
                    .iter()
                    .flatten()
                    .zip(shown[k][controller].iter().flatten());
                for (expected, own) in pairs {
                    for ((name, of, tolerance), largest) in QUANTITIES.iter().zip(&mut largest) {
                        let difference = (of(own) - of(expected)).abs();
                        *largest = largest.max(difference);
                        assert!(
                            difference <= *tolerance,
                            "episode {episode}, controller {controller}, step {step}: {name} {} against {}",
                            of(own),
                            of(expected)
                        );
                    }
                }
            }
        }
    }
    println!("{}: {count} flights, {}", campaign.name, figures(&largest));
    count
}

#[test]
fn val_trajectories_agree_at_every_sample_and_end_as_episodes_do() {
    let Some(gpu) = gpu_or_skip() else { return };
    let full = mixed(&["episodes=20"]);
    assert!(followed(&gpu, &full, &[19, 0, 7, 4, 12]) > 4);
    let thrust = altered(
        "uav-physical",
        &[
            "episodes=10",
            "time.duration_s=11.0",
            "initial.error.normal.std=0.05",
            "initial.error_rate.normal.std=0.05",
        ],
    );
    assert!(followed(&gpu, &thrust, &[9, 2, 3]) > 2);
}
