//! UAV-steps per second and core: one UAV-step is one RK4 step of one UAV's six channels with observer, faults and metrics.
//!
//! The draws are those of campaigns/bench-uav.toml, the same work as the hand-written programs count as 3640 floating-point
//! operations per UAV-step under the FTC and 2344 under a PID (a fused multiply-add counts as two). Time is the thread's
//! processor time, so that other work on the machine shows as little as it can; compare ratios of one run only.

#![expect(clippy::print_stdout, reason = "the benchmark's result")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number of steps"
)]

use criterion::{BenchmarkId, Criterion, Throughput};
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};
use urts_mc::backend::cpu::{Cpu, Precision, Simd};
use urts_mc::backend::gpu::{Gpu, GpuFlyer, Tuning, Wanted, adapters};
use urts_mc::campaign::Campaign;
use urts_mc::flight::{Settings, fly};
use urts_mc::gains::GainSet;
use urts_mc::model::lanes::{Kernel, Lane};

/// Floating-point operations per UAV-step, counted on the hand-written programs.
const FLOP: [(&str, f64); 2] = [("ftc", 3640.0), ("pid", 2344.0)];
/// Episodes of one measurement, by layout: a few tenths of a second each.
const LAYOUTS: [(&str, Precision, Option<Simd>, u32); 4] = [
    ("f64", Precision::F64, None, 4),
    ("f32 scalar", Precision::F32, Some(Simd::Scalar), 4),
    ("f32 x 8", Precision::F32, Some(Simd::Avx2), 64),
    ("f32 x 16", Precision::F32, Some(Simd::Avx512), 64),
];

fn main() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("campaigns/bench-uav.toml");
    let campaign = Campaign::load(&path).expect("the benchmark's campaign is valid");
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3))
        .configure_from_args();
    let mut rates = Vec::new();
    for (controller, flop) in FLOP {
        let mut group = criterion.benchmark_group(controller);
        for (name, precision, simd, episodes) in LAYOUTS {
            if simd.is_some_and(|simd| !simd.is_available()) {
                continue;
            }
            let mut campaign = campaign.clone();
            campaign.controllers = vec![controller.to_string()];
            let gains = GainSet::obtain(&campaign).expect("the paper's gains exist");
            let cpu = Cpu::new(&campaign, &gains.loops(), precision, simd);
            let steps = f64::from(campaign.time.steps) * campaign.team as f64 * f64::from(episodes);
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(1)
                .build()
                .expect("one thread");
            let mut best = f64::INFINITY;
            group.throughput(Throughput::Elements(steps as u64));
            group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
                bencher.iter_custom(|iterations| {
                    let time = pool.install(|| {
                        let start = processor_time();
                        for _ in 0..iterations {
                            black_box(cpu.fly(0..episodes, &|_| ()));
                        }
                        processor_time() - start
                    });
                    best = best.min(time.as_secs_f64() / iterations as f64);
                    time
                });
            });
            if best.is_finite() {
                rates.push((controller, name, simd, steps / best, flop));
            }
        }
    }
    println!("\nbest of all samples, one core");
    println!(
        "{:<5} {:<11} {:>18} {:>12} {:>12}",
        "", "", "M UAV-steps/s", "GFLOP/s", "of FMA peak"
    );
    for (controller, name, simd, rate, flop) in &rates {
        let share = peak(*simd).map_or(String::new(), |peak| {
            format!("{:.0} %", 100.0 * rate * flop / peak)
        });
        println!(
            "{controller:<5} {name:<11} {:>18.3} {:>12.1} {share:>12}",
            rate * 1e-6,
            rate * flop * 1e-9
        );
    }
    outside_the_loop(&campaign);
    on_gpu(&campaign);
}

/// UAV-steps per second on a GPU, all three controllers together, with its times apart: hardware if there is any, else
/// whatever adapter there is, which is a software one.
fn on_gpu(campaign: &Campaign) {
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
        "\n{} ({:?}, {}, {})\n{:>9} {:>8} {:>14} {:>10} {:>10} {:>10} {:>12} {:>12}",
        adapter.name,
        adapter.kind,
        adapter.api,
        adapter.driver,
        "episodes",
        "batch",
        "M UAV-steps/s",
        "GFLOP/s",
        "compile, s",
        "upload, s",
        "kernel, s",
        "read-back, s"
    );
    let flop: f64 = campaign.controllers.iter().map(|name| flop(name)).sum();
    for &episodes in sizes {
        let mut campaign = campaign.clone();
        campaign.episodes = episodes;
        let gains = GainSet::obtain(&campaign).expect("the paper's gains exist");
        let mut flyer = GpuFlyer::new(&gpu, &campaign, &gains.loops(), Tuning::default())
            .expect("the campaign fits the adapter");
        let mut first = 0;
        while first < episodes {
            let next = (first + flyer.batch()).min(episodes);
            black_box(flyer.fly(first..next, &|_| ()).expect("the GPU goes on"));
            first = next;
        }
        let times = flyer.times();
        let steps = f64::from(campaign.time.steps) * campaign.team as f64 * f64::from(episodes);
        let controllers = campaign.controllers.len() as f64;
        println!(
            "{episodes:>9} {:>8} {:>14.2} {:>10.1} {:>10.2} {:>10.2} {:>12.2} {:>12.2}",
            flyer.batch(),
            1e-6 * steps * controllers / times.kernel_s,
            1e-9 * steps * flop / times.kernel_s,
            times.compile_s,
            times.upload_s,
            times.kernel_s,
            times.read_back_s
        );
    }
}

/// Floating-point operations of a UAV-step under a controller.
fn flop(controller: &str) -> f64 {
    FLOP[usize::from(controller != FLOP[0].0)].1
}

/// The share of the wall time that is not the episode loop, over 1000 episodes under all three controllers and on all cores.
fn outside_the_loop(campaign: &Campaign) {
    let mut campaign = campaign.clone();
    campaign.episodes = 1000;
    let gains = GainSet::obtain(&campaign).expect("the paper's gains exist");
    let settings = Settings::cpu(Precision::F32);
    let start = Instant::now();
    let flight = fly(&campaign, &gains, &settings, None, &|_| ()).expect("threads");
    let total = start.elapsed().as_secs_f64();
    let outside = total - flight.times.loop_s;
    println!(
        "\n{} episodes: {total:.2} s, of which {:.1} % outside the episode loop (files apart)",
        campaign.episodes,
        100.0 * outside / total
    );
}

/// Processor time of this thread.
fn processor_time() -> Duration {
    let nanoseconds = fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|line| line.split_whitespace().next()?.parse().ok());
    nanoseconds.map_or_else(since_start, Duration::from_nanos)
}

/// Wall-clock time, where the system does not tell the processor's.
fn since_start() -> Duration {
    use std::sync::OnceLock;
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}

/// Measured peak of fused multiply-adds of one core in this layout, FLOP/s.
fn peak(simd: Option<Simd>) -> Option<f64> {
    #[cfg(target_arch = "x86_64")]
    match simd? {
        Simd::Scalar => None,
        Simd::Avx2 => Some(measured_peak::<urts_mc::model::simd::F32x8>()),
        Simd::Avx512 => Some(measured_peak::<urts_mc::model::simd::F32x16>()),
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let _ = simd;
        None
    }
}

fn measured_peak<L: Lane>() -> f64 {
    const ROUNDS: u32 = 20_000_000;
    /// Independent chains: enough to fill two units of latency four.
    const CHAINS: usize = 12;
    struct Chains<L>(std::marker::PhantomData<L>);
    impl<L: Lane> Kernel for Chains<L> {
        type Output = f64;
        #[inline(always)]
        fn run(self) -> f64 {
            let (factor, addend) = (L::number(black_box(0.999_999)), L::number(black_box(1e-6)));
            // Different starts, or the chains would be recognised as one.
            let mut sums = [factor; CHAINS];
            for k in 1..CHAINS {
                sums[k] = sums[k - 1] + addend;
            }
            for _ in 0..ROUNDS {
                for sum in &mut sums {
                    *sum = sum.mul_add(factor, addend);
                }
            }
            let mut stored = [0.0; 16];
            sums.iter()
                .fold(L::number(0.0), |total, sum| total + *sum)
                .store(&mut stored);
            stored[0]
        }
    }
    let best = (0..3)
        .map(|_| {
            let start = processor_time();
            black_box(L::dispatch(Chains::<L>(std::marker::PhantomData)));
            (processor_time() - start).as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min);
    2.0 * f64::from(ROUNDS) * (CHAINS * L::WIDTH) as f64 / best
}
