//! Bipeds: every episode, controller, agent and joint is compared with the CPU, as those of UAVs are.

use super::agreement::{Expected, TWIN};
use super::parity::{agreement, followed};
use super::{LONGEST, mixed_biped};
use crate::common::{altered, gains, gpu_or_skip};
use urts_mc::backend::cpu::Precision;
use urts_mc::backend::gpu::Tuning;
use urts_mc::simulation::cross_check::cross_check;
use urts_mc::simulation::{Backend, RunOptions, simulate};

/// One controller.
const FTC: &str = "controllers=[\"ftc\"]";

#[test]
fn val_everything_at_once_agrees_for_bipeds_within_their_limits() {
    let Some([double, single]) = agreement(&mixed_biped(&[])) else {
        return;
    };
    assert!(double.compared > 4 && single.compared > 10);
    assert!(single.exceeded > 4 && single.diverged > 4 && single.saturated > 4);
}

#[test]
fn val_everything_at_once_agrees_for_bipeds_without_limits() {
    let campaign = mixed_biped(&["agent.actuation=full", FTC]);
    let Some([double, single]) = agreement(&campaign) else {
        return;
    };
    // What limits would cut is counted.
    assert!(double.compared > 4 && single.compared > 10 && single.saturated > 4);
}

#[test]
fn val_bipeds_that_do_well_under_both_controllers_agree() {
    // One more than a workgroup holds of a team of four.
    let campaign = altered(
        "biped-paper",
        &[
            "episodes=9",
            "controllers=[\"ftc\", \"pid\"]",
            "time.duration_s=0.6",
            "time.settle_s=0.2",
            "reference.agents.0.start_s=-3.0",
            "initial.error.normal.std=0.001",
            "initial.error_rate.normal.std=0.001",
            "disturbance.0.amplitude.uniform=[0.1, 0.3]",
            "fault.0.amplitude.uniform=[0.0001, 0.001]",
            "verdict.max_error=2.0",
            "verdict.max_rmse=1.0",
            "require=",
        ],
    );
    let Some([double, _]) = agreement(&campaign) else {
        return;
    };
    assert!(double.compared > 9);
}

#[test]
fn val_another_robot_agrees() {
    let campaign = altered(
        "biped-berkeley",
        &[
            "episodes=4",
            FTC,
            "time.duration_s=0.6",
            "time.settle_s=0.2",
            "reference.start_s=-2.0",
        ],
    );
    let Some([double, _]) = agreement(&campaign) else {
        return;
    };
    assert!(double.compared == 4);
}

#[test]
fn val_a_team_of_42_bipeds_agrees_though_its_references_take_turns_on_the_device() {
    let Some(gpu) = gpu_or_skip() else { return };
    // Five rows per half step: 42 agents x 6 joints x 5 x 16 bytes, so 32 MiB hold the references of 831 steps.
    let campaign = altered(
        "biped-ground-reaction",
        &[
            "episodes=1",
            FTC,
            "time.duration_s=0.9",
            "time.step_s=0.001",
            "time.settle_s=0.1",
            "agent.team=42",
            "reference.start_s=-2.0",
        ],
    );
    assert!(campaign.time.steps > 831);
    let gains = gains(&campaign).loops();
    let simulated = super::simulate(&gpu, &campaign, &gains, LONGEST);
    let agreed = Expected::new(&campaign, &gains, &TWIN).compare(&simulated);
    let summary = agreed.unwrap();
    println!("{summary}");
    assert!(summary.compared == 1);
}

#[test]
fn val_trajectories_of_bipeds_agree_at_every_sample_and_end_as_episodes_do() {
    let Some(gpu) = gpu_or_skip() else { return };
    assert!(followed(&gpu, &mixed_biped(&[FTC]), &[15, 0, 7, 4, 12]) > 2);
}

#[test]
fn a_run_of_bipeds_passes_its_cross_check() {
    let Some(gpu) = gpu_or_skip() else { return };
    let campaign = mixed_biped(&[FTC]);
    let gains = gains(&campaign);
    let options = RunOptions {
        backend: Backend::Gpu { adapter: None },
        tuning: Tuning::default(),
        ..RunOptions::cpu(Precision::F32)
    };
    let flight = simulate(
        &campaign,
        std::slice::from_ref(gains),
        &options,
        Some(&gpu),
        &|_| (),
    )
    .unwrap();
    let (segment, scores) = (&flight.segments[0], &flight.tables.scores);
    let check = cross_check(
        &campaign,
        std::slice::from_ref(gains),
        &options,
        segment,
        scores,
        Some(&gpu),
        8,
    )
    .unwrap();
    println!("{check:?}");
    assert!(check.holds() && check.compared > 2, "{check:?}");
}
