//! What can go wrong with a device, and what is said of it.

use super::simulate;
use crate::common::{adapter_or_skip, altered, campaign, gains, gpu_or_skip};
use std::process::Command;
use urts_mc::backend::gpu::{Gpu, GpuError, GpuSimulator, Tuning, Wanted};
use urts_mc::campaign::{Campaign, GroupParts};
use urts_mc::reference::Reference;
use urts_mc::synthesis::LoopGains;

fn small() -> (Campaign, Vec<Vec<LoopGains>>) {
    let campaign = altered(
        "smoke",
        &["episodes=6", "time.duration_s=4.2", "controllers=[\"pid\"]"],
    );
    let gains = gains(&campaign).loops();
    (campaign, gains)
}

/// Demands that an error is of a lost device, and says which and why; what to do depends on who was simulating.
fn assert_lost(error: &GpuError, gpu: &Gpu) {
    let GpuError::Lost { adapter, reason } = error else {
        panic!("{error}");
    };
    assert_eq!(*adapter, gpu.adapter().name);
    assert!(reason.contains("Destroyed"), "{reason}");
    let message = error.to_string();
    assert!(
        message.contains(adapter) && message.contains(reason),
        "{message}"
    );
}

#[test]
fn a_device_lost_in_the_middle_of_a_batch_is_an_error() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (campaign, gains) = small();
    let tuning = Tuning {
        batch: None,
        steps: Some(100),
    };
    let mut simulator = GpuSimulator::new(&gpu, campaign.first_group(), &gains, tuning).unwrap();
    let error = simulator.simulate(0..6, &|_| gpu.destroy()).unwrap_err();
    assert_lost(&error, &gpu);
    // It stays lost.
    assert_lost(&simulator.simulate(0..6, &|_| ()).unwrap_err(), &gpu);
    assert_lost(&simulator.trace(&[0], 10, &mut |_| ()).err().unwrap(), &gpu);
}

#[test]
fn a_device_lost_in_the_middle_of_a_trace_is_an_error() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (campaign, gains) = small();
    let mut simulator =
        GpuSimulator::new(&gpu, campaign.first_group(), &gains, Tuning::default()).unwrap();
    let error = simulator.trace(&[3, 1], 10, &mut |_| gpu.destroy());
    assert_lost(&error.err().unwrap(), &gpu);
}

#[test]
fn a_device_lost_between_batches_or_before_the_first_is_an_error() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (campaign, gains) = small();
    let mut simulator =
        GpuSimulator::new(&gpu, campaign.first_group(), &gains, Tuning::default()).unwrap();
    assert_eq!(simulator.simulate(0..3, &|_| ()).unwrap().len(), 3);
    gpu.destroy();
    assert_lost(&simulator.simulate(3..6, &|_| ()).unwrap_err(), &gpu);
    let error = GpuSimulator::new(&gpu, campaign.first_group(), &gains, Tuning::default()).err();
    assert_lost(&error.unwrap(), &gpu);
    // Another device of the same adapter is not concerned.
    let other = gpu_or_skip().unwrap();
    assert_eq!(
        simulate(&other, &campaign, &gains, Tuning::default()).len(),
        6
    );
}

#[test]
fn shaders_that_do_not_compile_are_an_error_in_the_compilers_words() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (campaign, gains) = small();
    for (old, new, words) in [
        // Not WGSL; no such name; a wrong type; no entry point.
        ("fn body_axis(", "fn body_axis((", "expected"),
        (
            "own.first_drawn + word",
            "own.first_drawm + word",
            "first_drawm",
        ),
        ("var sum = 0.0;", "var sum = 0u;", "sum"),
        ("fn finish(", "fn finished(", "finish"),
    ] {
        let rewrite = |text: String| {
            assert!(text.contains(old), "{old}");
            text.replace(old, new)
        };
        let refused = GpuSimulator::rewritten(
            &gpu,
            campaign.first_group(),
            &gains,
            Tuning::default(),
            &rewrite,
        );
        match refused.err() {
            Some(GpuError::Shader { adapter, reason }) => {
                assert_eq!(adapter, gpu.adapter().name);
                assert!(reason.contains(words), "{reason}");
            }
            other => panic!("{new}: {other:?}"),
        }
    }
    // The device is none the worse for it.
    assert_eq!(
        simulate(&gpu, &campaign, &gains, Tuning::default()).len(),
        6
    );
}

/// Demands that an error is of too little memory, and says how much was wanted.
fn assert_out_of_memory(error: &GpuError, gpu: &Gpu) {
    let GpuError::OutOfMemory {
        adapter,
        bytes,
        episodes,
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!(*adapter, gpu.adapter().name);
    let message = error.to_string();
    assert!(message.contains(&format!("{bytes} bytes for {episodes} episodes")));
    assert!(*bytes > 1000 && *episodes > 0, "{message}");
}

/// Set where this test runs as a process of little memory.
const STARVED: &str = "URTS_TEST_STARVED";

#[test]
fn too_little_memory_is_an_error_that_says_how_much_was_needed() {
    let Some(name) = adapter_or_skip() else {
        return;
    };
    if std::env::var_os(STARVED).is_some() {
        // The samples of so many episodes, of four groups under three controllers, take more than a gigabyte.
        let campaign = campaign("smoke");
        let gains = gains(&campaign).loops();
        let gpu = Gpu::open(Wanted::Named(&name)).unwrap();
        let mut simulator =
            GpuSimulator::new(&gpu, campaign.first_group(), &gains, Tuning::default()).unwrap();
        let many: Vec<u32> = (0..30_000).collect();
        let error = simulator.trace(&many, 1, &mut |_| ()).err().unwrap();
        println!("{error}");
        assert_out_of_memory(&error, &gpu);
        // What takes less is still simulated.
        assert_eq!(
            simulator.trace(&[0, 1], 1000, &mut |_| ()).unwrap().len(),
            2
        );
        return;
    }
    let (campaign, gains) = small();
    // A budget of nothing, where the driver tells how much of its memory is in use.
    let gpu = Gpu::open_within(Wanted::Named(&name), 0).unwrap();
    match GpuSimulator::new(&gpu, campaign.first_group(), &gains, Tuning::default()) {
        Err(error) => assert_out_of_memory(&error, &gpu),
        // A software driver does not tell, but its memory is the process's own, which can be limited.
        Ok(_) if cfg!(unix) => {
            let own = std::thread::current().name().unwrap().to_string();
            let starved = Command::new("sh")
                .args(["-c", "ulimit -v 900000 && exec \"$@\"", "sh"])
                .arg(std::env::current_exe().unwrap())
                .args(["--exact", &own, "--nocapture"])
                .env(STARVED, "1")
                // Threads take address space too.
                .envs([("LP_NUM_THREADS", "1"), ("RAYON_NUM_THREADS", "1")])
                .env("MALLOC_ARENA_MAX", "1")
                .output()
                .unwrap();
            println!("{}", String::from_utf8_lossy(&starved.stdout));
            assert!(
                starved.status.success(),
                "{}",
                String::from_utf8_lossy(&starved.stderr)
            );
        }
        Ok(_) => println!("SKIPPED: memory that cannot be limited"),
    }
}

#[test]
fn an_adapter_that_does_not_exist_is_an_error_that_lists_those_that_do() {
    let wanted = Gpu::open(Wanted::Named("no such adapter"));
    let Some(error @ GpuError::NoSuchAdapter { .. }) = wanted.err() else {
        panic!("there is an adapter of this name");
    };
    let message = error.to_string();
    assert!(message.contains("no such adapter") && message.contains("urts-mc devices"));
    match adapter_or_skip() {
        Some(name) => assert!(message.contains(&name), "{message}"),
        None => assert!(message.contains("no adapter at all"), "{message}"),
    }
}

/// Gives a campaign more agents than its file may have: the others are as the last.
fn with_team(campaign: &mut GroupParts, team: usize) {
    for fault in &mut campaign.faults {
        fault.probability.resize(team, fault.probability[0]);
        fault.channels.resize(team, fault.channels[0].clone());
    }
    let faults = campaign.faults.iter_mut().flat_map(|fault| {
        let onset = std::iter::once(&mut fault.onset_s);
        onset.chain(&mut fault.parameters)
    });
    let disturbances = campaign.disturbances.iter_mut();
    let drawn = disturbances
        .flat_map(|disturbance| &mut disturbance.parameters)
        .chain(faults)
        .chain([
            &mut campaign.mass_scale,
            &mut campaign.inertia_scale,
            &mut campaign.kappa,
            &mut campaign.initial.error,
            &mut campaign.initial.error_rate,
            &mut campaign.initial.error_integral,
        ]);
    for drawn in drawn {
        let last = drawn.distributions.len() - drawn.channels;
        let last = drawn.distributions[last..].to_vec();
        for _ in campaign.team..team {
            drawn.distributions.extend(last.iter().cloned());
        }
    }
    let Reference::Sinusoid(agents) = &mut campaign.reference else {
        panic!("a campaign on sinusoids");
    };
    agents.resize(team, agents[agents.len() - 1].clone());
    campaign.team = team;
}

#[test]
fn a_team_too_large_for_a_workgroup_is_an_error_that_says_how_large() {
    let Some(gpu) = gpu_or_skip() else { return };
    // A campaign file may have 64 agents, which fit most adapters; what is refused must be said before it is simulated.
    let team = 2000;
    let campaign = campaign("scenario-b").with(|campaign| {
        with_team(campaign, team);
        campaign.time.steps = 1;
    });
    let gains = gains(&campaign).loops();
    match GpuSimulator::new(&gpu, campaign.first_group(), &gains, Tuning::default()).err() {
        Some(GpuError::TooLarge {
            adapter,
            needed,
            limit,
            ..
        }) => {
            assert_eq!(adapter, gpu.adapter().name);
            assert_eq!(needed, 6 * team as u64);
            assert!(limit < needed);
        }
        other => panic!("{other:?}"),
    }
}
