//! The GPU backend on whatever adapter there is; CI has a software Vulkan.
//!
//! Without an adapter these tests print SKIPPED, unless URTS_REQUIRE_GPU=1 asks for one.

use crate::common::campaign;
use urts_mc::backend::Flown;
use urts_mc::backend::cpu::{Cpu, Precision};
use urts_mc::backend::gpu::{Gpu, GpuError, GpuFlyer, Tuning, Wanted, adapters};
use urts_mc::campaign::Campaign;
use urts_mc::gains::GainSet;

/// A device: hardware if there is any, else the first adapter; none where there is none and none is required.
fn gpu_or_skip() -> Option<Gpu> {
    let opened = match adapters().first() {
        Some(report) => Gpu::open(Wanted::Named(&report.adapter.name)),
        None => Err(GpuError::NoHardware { found: Vec::new() }),
    };
    match opened {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            assert!(
                std::env::var("URTS_REQUIRE_GPU").as_deref() != Ok("1"),
                "URTS_REQUIRE_GPU=1, but {error}"
            );
            println!("SKIPPED: {error}");
            None
        }
    }
}

/// Flies a campaign on the GPU in one piece.
fn fly(gpu: &Gpu, campaign: &Campaign, tuning: Tuning) -> Vec<Flown> {
    let gains = GainSet::obtain(campaign).unwrap();
    let mut flyer = GpuFlyer::new(gpu, campaign, &gains.loops(), tuning).unwrap();
    let mut flown = Vec::new();
    let mut first = 0;
    while first < campaign.episodes {
        let next = (first + flyer.batch()).min(campaign.episodes);
        flown.extend(flyer.fly(first..next, &|_| ()).unwrap());
        first = next;
    }
    flown
}

#[test]
fn gpu_episodes_agree_with_the_reference() {
    let Some(gpu) = gpu_or_skip() else { return };
    let campaign = campaign("smoke");
    let flown = fly(&gpu, &campaign, Tuning::default());
    let gains = GainSet::obtain(&campaign).unwrap();
    let cpu = Cpu::new(&campaign, &gains.loops(), Precision::F64, None);
    let expected = cpu.fly(0..campaign.episodes, &|_| ());
    let pairs = flown.iter().zip(&expected).flat_map(|(gpu, cpu)| {
        assert_eq!(gpu.episode, cpu.episode);
        gpu.outcomes
            .iter()
            .flatten()
            .zip(cpu.outcomes.iter().flatten())
    });
    for (gpu, cpu) in pairs {
        assert_eq!(gpu.failed_step, cpu.failed_step);
        for (gpu, cpu) in gpu.channels.iter().zip(&cpu.channels) {
            assert!((gpu.max_abs - cpu.max_abs).abs() <= 2e-4);
            assert!((gpu.rmse - cpu.rmse).abs() <= 1e-4 * cpu.rmse);
        }
    }
}
