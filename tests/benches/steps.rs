//! UAV-steps and robot-steps per second and core: one step is one RK4 step of one agent with observers, faults and
//! metrics, six channels of a UAV or twelve of a robot, whose legs' forward dynamics are also measured alone.
//!
//! The draws are those of campaigns/bench-uav.toml and bench-biped.toml, the same work as the hand-written programs
//! count as 3640 floating-point operations per UAV-step and 24,848 per robot-step under the FTC, 2344 and 22,256 under
//! a PID (a fused multiply-add counts as two). Time is the thread's processor time, so that other work on the machine
//! shows as little as it can; compare ratios of one run only.

#![expect(clippy::print_stdout, reason = "the benchmark's result")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number of steps"
)]

#[path = "steps/leg.rs"]
mod leg;
#[path = "steps/rates.rs"]
mod rates;

use criterion::Criterion;
use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};
use urts_mc::backend::cpu::Precision;
use urts_mc::backend::gpu::{Gpu, GpuSimulator, Tuning, Wanted, adapters};
use urts_mc::campaign::Campaign;
use urts_mc::controllers::GainSet;
use urts_mc::model::episode::Model;
use urts_mc::reference::Reference;
use urts_mc::simulation::{RunOptions, simulate};

/// Floating-point operations per UAV-step, counted on the hand-written programs.
const FLOP: [(&str, f64); 2] = [("ftc", 3640.0), ("pid", 2344.0)];
/// The same per robot-step.
const ROBOT_FLOP: [(&str, f64); 2] = [("ftc", 24_848.0), ("pid", 22_256.0)];

fn main() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("campaigns/bench-uav.toml");
    let campaign = Campaign::load(&path).expect("the benchmark's campaign is valid");
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3))
        .configure_from_args();
    rates::measure(&mut criterion, &campaign, "UAV-steps", &FLOP);
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("campaigns/bench-biped.toml");
    let robots = Campaign::load(&robots).expect("the benchmark's campaign is valid");
    rates::measure(&mut criterion, &robots, "robot-steps", &ROBOT_FLOP);
    leg::measure();
    tables(&robots);
    outside_the_loop(&campaign);
    on_gpu(&campaign, "UAV-steps", &FLOP);
    on_gpu(&robots, "robot-steps", &ROBOT_FLOP);
}

/// The time that the reference tables of robots take, on all cores: limits and the ground's reaction make them the
/// largest.
fn tables(robots: &Campaign) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("campaigns/biped-ground-reaction.toml");
    let campaign = Campaign::load(&path).expect("the campaign is valid");
    let campaign = campaign.with(|campaign| {
        campaign.reference = robots.first_group().reference.clone();
        if let Reference::Walk(walks) = &mut campaign.reference {
            walks.resize(3, walks[0].clone());
        }
        campaign.team = 3;
        campaign.time.steps = 10_000;
    });
    let start = Instant::now();
    black_box(Model::<f32>::new(campaign.first_group()));
    let time = start.elapsed().as_secs_f64();
    println!("\ntables of three robots over 10,000 steps: {time:.2} s");
}

/// Steps per second on a GPU, all three controllers together, with its times apart: hardware if there is any, else
/// whatever adapter there is, which is a software one.
fn on_gpu(campaign: &Campaign, unit: &str, flop: &[(&str, f64)]) {
    let Some(report) = adapters().into_iter().next() else {
        println!("\nno GPU: not measured");
        return;
    };
    let adapter = &report.adapter;
    let gpu = Gpu::open(Wanted::Named(&adapter.name)).expect("a listed adapter opens");
    let sizes: &[u32] = if adapter.kind.is_hardware() {
        &[1024, 8192, 32_768, 131_072]
    } else {
        &[128]
    };
    println!(
        "\n{} ({:?}, {}, {})\n{:>9} {:>8} {:>16} {:>10} {:>10} {:>10} {:>12} {:>12}",
        adapter.name,
        adapter.kind,
        adapter.api,
        adapter.driver,
        "episodes",
        "batch",
        format!("M {unit}/s"),
        "GFLOP/s",
        "compile, s",
        "upload, s",
        "kernel, s",
        "read-back, s"
    );
    // All but the FTC are PIDs.
    let of = |name: &String| flop[usize::from(name != flop[0].0)].1;
    let flop: f64 = campaign.controllers.iter().map(of).sum();
    for &episodes in sizes {
        let campaign = campaign.clone().with(|own| own.episodes = episodes);
        let gains =
            GainSet::synthesize_or_load(campaign.first_group()).expect("the paper's gains exist");
        let mut simulator = GpuSimulator::new(
            &gpu,
            campaign.first_group(),
            &gains.loops(),
            Tuning::default(),
        )
        .expect("the campaign fits the adapter");
        let mut first = 0;
        while first < episodes {
            let next = (first + simulator.batch()).min(episodes);
            black_box(
                simulator
                    .simulate(first..next, &|_| ())
                    .expect("the GPU goes on"),
            );
            first = next;
        }
        let times = simulator.times();
        let steps = f64::from(campaign.time.steps)
            * campaign.first_group().team as f64
            * f64::from(episodes);
        let controllers = campaign.controllers.len() as f64;
        println!(
            "{episodes:>9} {:>8} {:>16.2} {:>10.1} {:>10.2} {:>10.2} {:>12.2} {:>12.2}",
            simulator.batch(),
            1e-6 * steps * controllers / times.kernel_s,
            1e-9 * steps * flop / times.kernel_s,
            times.compile_s,
            times.upload_s,
            times.kernel_s,
            times.read_back_s
        );
    }
}

/// The share of the wall time that is not the episode loop, over 1000 episodes under all three controllers and on all
/// cores.
fn outside_the_loop(campaign: &Campaign) {
    let campaign = campaign.clone().with(|own| own.episodes = 1000);
    let gains =
        GainSet::synthesize_or_load(campaign.first_group()).expect("the paper's gains exist");
    let settings = RunOptions::cpu(Precision::F32);
    let start = Instant::now();
    let flight = simulate(
        &campaign,
        std::slice::from_ref(&gains),
        &settings,
        None,
        &|_| (),
    )
    .expect("threads");
    let total = start.elapsed().as_secs_f64();
    let outside = total - flight.times.loop_s;
    println!(
        "\n{} episodes: {total:.2} s, of which {:.1} % outside the episode loop (files apart)",
        campaign.episodes,
        100.0 * outside / total
    );
}
