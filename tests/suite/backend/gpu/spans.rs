//! Spans of steps: the same bits for the shortest, for the longest that an adapter may take, and for those that follow
//! the time of the last. Large teams, many signals and long memories have the most iterations of loops, which software
//! drivers bound.

use super::determinism::digits;
use super::{Gains, gpu_campaign, jets, linked, simulate_all, team_of};
use crate::common::{altered, gains, gpu_or_skip};
use urts_mc::backend::cpu::Precision;
use urts_mc::backend::gpu::{AdapterKind, Gpu, GpuError, GpuSimulator, Tuning};
use urts_mc::campaign::Campaign;
use urts_mc::simulation::cross_check::cross_check;
use urts_mc::simulation::{Backend, RunOptions, simulate};

const PID: &str = "controllers=[\"pid\"]";

/// UAVs under thrust that are coupled: all six channels in one group, whose loops over the team run in each of four
/// stages.
fn thrust(team: usize, episodes: u32, duration_s: f64) -> Campaign {
    let changes = [
        PID,
        &format!("episodes={episodes}"),
        "coupling.kappa.choice=[0.0, 0.001]",
        "initial.error.normal.std=0.05",
        "initial.error_rate.normal.std=0.05",
        "agent.max_torque_n_m=600.0",
        "agent.max_thrust_n=200.0",
        &format!("time.duration_s={duration_s:?}"),
        "time.settle_s=0.2",
        "fault.0.onset_s.uniform=[0.1, 1.0]",
    ];
    team_of(&altered("uav-physical", &changes), team)
}

/// 33 UAVs that feel two kinds of jets of each other, in each of four stages.
fn blown() -> Campaign {
    let base = jets(&[PID, "episodes=2", "time.duration_s=0.8"]);
    team_of(&base, 33)
}

/// Simulates a campaign in spans of every kind and demands the same bits, of episodes and of a trace that shows nothing
/// on the way; returns the longest span and the steps of an episode.
fn alike(gpu: &Gpu, campaign: &Campaign) -> [u32; 2] {
    let gains: Gains = gains(campaign).loops();
    let mut simulator =
        GpuSimulator::new(gpu, campaign.first_group(), &gains, Tuning::default()).unwrap();
    let adapted = digits(&simulate_all(&mut simulator, campaign).unwrap());
    let (most, steps) = (simulator.most_steps(), campaign.time.steps);
    for span in [1, most] {
        simulator.force_steps(span);
        let again = digits(&simulate_all(&mut simulator, campaign).unwrap());
        assert!(again == adapted, "{}: spans of {span}", campaign.name);
        let traced = simulator.trace(&[0], steps, &mut |_| ()).unwrap();
        assert!(
            digits(&traced) == adapted[..1],
            "{}: a trace in spans of {span}",
            campaign.name
        );
    }
    println!("{}: {most} of {steps} steps in a dispatch", campaign.name);
    [most, steps]
}

/// The same of a campaign whose episodes are longer than a dispatch of a software adapter may be, or it would show
/// little.
fn alike_beyond_one_dispatch(campaign: &Campaign) {
    let Some(gpu) = gpu_or_skip() else { return };
    let [most, steps] = alike(&gpu, campaign);
    assert!(most < steps || gpu.adapter().kind.is_hardware());
}

#[test]
fn spans_of_a_team_of_33_under_thrust_do_not_change_a_bit() {
    alike_beyond_one_dispatch(&thrust(33, 2, 1.2));
}

#[test]
fn spans_of_a_team_of_64_on_axes_do_not_change_a_bit() {
    let changes = [
        PID,
        "episodes=2",
        "time.duration_s=0.8",
        "coupling.kappa=0.001",
        "fault.+={ target = \"sensor\", kind = \"noise\", std = 0.001 }",
    ];
    alike_beyond_one_dispatch(&team_of(&altered("no-fault", &changes), 64));
}

#[test]
fn spans_of_a_team_of_33_among_jets_do_not_change_a_bit() {
    alike_beyond_one_dispatch(&blown());
}

#[test]
fn spans_of_33_robots_do_not_change_a_bit() {
    let campaign = altered(
        "biped-ground-reaction",
        &[
            PID,
            "episodes=1",
            "time.duration_s=0.4",
            "time.step_s=0.001",
            "time.settle_s=0.1",
            "coupling.kappa=1.0",
            "agent.team=33",
            "reference.start_s=-2.0",
        ],
    );
    alike_beyond_one_dispatch(&campaign);
}

#[test]
fn spans_of_many_signals_do_not_change_a_bit() {
    let changes = [PID, "episodes=3", "time.duration_s=1.2"];
    alike_beyond_one_dispatch(&gpu_campaign("uav_faults", &changes));
}

#[test]
fn spans_of_long_memories_do_not_change_a_bit() {
    let changes = [
        PID,
        "episodes=2",
        "fault.1.window_s=0.4",
        "time.duration_s=1.8",
    ];
    let Some(gpu) = gpu_or_skip() else { return };
    alike(&gpu, &linked(&changes));
}

#[test]
fn spans_beyond_the_bound_are_wrong_where_the_driver_ends_loops() {
    // The negative control of the tests above: it is this driver that the bound is for.
    let Some(gpu) = gpu_or_skip() else { return };
    if !gpu.adapter().name.contains("llvmpipe") {
        println!("SKIPPED: a driver that ends no loop");
        return;
    }
    for campaign in [thrust(33, 2, 1.2), blown()] {
        let gains = gains(&campaign).loops();
        let steps = campaign.time.steps;
        // What is asked for by hand is bounded, too.
        let asked = Tuning {
            batch: None,
            steps: Some(steps),
        };
        let mut simulator = GpuSimulator::new(&gpu, campaign.first_group(), &gains, asked).unwrap();
        assert!(simulator.most_steps() < steps);
        let right = digits(&simulate_all(&mut simulator, &campaign).unwrap());
        // The loops of 33 agents in four stages use up 65,535 iterations in fewer than 500 steps, and in half as many
        // under two kinds of jets.
        simulator.force_steps(steps);
        let wrong = digits(&simulate_all(&mut simulator, &campaign).unwrap());
        assert!(
            wrong
                .iter()
                .zip(&right)
                .all(|(wrong, right)| wrong != right)
        );
        let traced = digits(&simulator.trace(&[0], steps, &mut |_| ()).unwrap());
        assert!(traced[0] != right[0], "a trace");
    }
}

#[test]
fn a_run_of_a_team_of_33_passes_its_cross_check() {
    let Some(gpu) = gpu_or_skip() else { return };
    let campaign = thrust(33, 4, 2.0);
    let gains = gains(&campaign);
    let options = RunOptions {
        backend: Backend::Gpu { adapter: None },
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
        2,
    )
    .unwrap();
    println!("{check:?}");
    assert!(check.holds() && check.compared > 0, "{check:?}");
}

#[test]
fn a_step_with_more_iterations_than_loops_may_have_is_refused() {
    let Some(gpu) = gpu_or_skip() else { return };
    if gpu.adapter().kind != AdapterKind::Software {
        println!("SKIPPED: no campaign has a step that is too long for hardware");
        return;
    }
    // 64 agents feel 300 jets of each other in four stages: 78,000 iterations.
    let jet =
        "[[disturbance]]\nkind = \"rotor-vortex\"\nforce_n = 1.0\nradius_m = 1.0\nlength_m = 1.0\n";
    let many = jet.repeat(300);
    let changes = [PID, "episodes=1", &many];
    let campaign = team_of(&altered("no-fault", &changes), 64);
    let gains = gains(&campaign).loops();
    let error = GpuSimulator::new(&gpu, campaign.first_group(), &gains, Tuning::default()).err();
    let Some(error @ GpuError::TooLarge { needed, limit, .. }) = error else {
        panic!("{error:?}");
    };
    assert!(needed > 78_000 && limit < 65_535, "{error}");
    assert!(error.to_string().contains("iterations of loops"), "{error}");
}
