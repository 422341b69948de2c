//! How fast steps are taken: rates by layout, and what they are measured against.

use criterion::{BenchmarkId, Criterion, Throughput};
use std::fs;
use std::hint::black_box;
use std::time::{Duration, Instant};
use urts_mc::backend::cpu::{Cpu, Precision, Simd};
use urts_mc::campaign::Campaign;
use urts_mc::controllers::GainSet;
use urts_mc::model::lanes::{Kernel, Lane};

/// Layouts and the episodes of one measurement: a few tenths of a second each.
const LAYOUTS: [(&str, Precision, Option<Simd>, u32); 4] = [
    ("f64", Precision::F64, None, 4),
    ("f32 scalar", Precision::F32, Some(Simd::Scalar), 4),
    ("f32 x 8", Precision::F32, Some(Simd::Avx2), 64),
    ("f32 x 16", Precision::F32, Some(Simd::Avx512), 64),
];

/// Steps of one agent per second and core under every controller and in every layout; `flop` are the floating-point
/// operations of a step under each controller, and `unit` is what a step is called.
pub(crate) fn measure(
    criterion: &mut Criterion,
    campaign: &Campaign,
    unit: &str,
    flop: &[(&str, f64)],
) {
    println!("\n{unit}");
    let mut rates = Vec::new();
    for (controller, flop) in flop {
        let mut group = criterion.benchmark_group(format!("{unit} {controller}"));
        for (name, precision, simd, episodes) in LAYOUTS {
            if simd.is_some_and(|simd| !simd.is_available()) {
                continue;
            }
            let alone = vec![(*controller).to_string()];
            let campaign = campaign.clone().with(|own| own.controllers = alone);
            let gains = GainSet::synthesize_or_load(campaign.first_group())
                .expect("the paper's gains exist");
            let cpu = Cpu::new(campaign.first_group(), &gains.loops(), precision, simd);
            let steps = f64::from(campaign.time.steps)
                * campaign.first_group().team as f64
                * f64::from(episodes);
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
                            black_box(cpu.simulate(0..episodes, &|_| ()));
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
        "",
        "",
        format!("M {unit}/s"),
        "GFLOP/s",
        "of FMA peak"
    );
    for (controller, name, simd, rate, flop) in &rates {
        let share = peak(*simd).map_or(String::new(), |peak| {
            format!("{:.0} %", 100.0 * rate * *flop / peak)
        });
        println!(
            "{controller:<5} {name:<11} {:>18.3} {:>12.1} {share:>12}",
            rate * 1e-6,
            rate * *flop * 1e-9
        );
    }
}

/// Processor time of this thread.
pub(crate) fn processor_time() -> Duration {
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
        Simd::Avx2 => Some(measured_peak::<urts_mc::model::lanes::simd::F32x8>()),
        Simd::Avx512 => Some(measured_peak::<urts_mc::model::lanes::simd::F32x16>()),
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
