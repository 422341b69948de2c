//! How long a run took, in words.

use crate::run::manifest::Manifest;
use crate::simulation::Engine;

/// How long the parts of a run took; of a GPU's simulation, how much of it the shaders did and what the rest was.
pub(super) fn times(manifest: &Manifest) -> String {
    let times = manifest.times;
    let of_gpu = manifest.segments.iter().filter_map(|own| match own.engine {
        Engine::Gpu { gpu_times, .. } => Some(gpu_times),
        Engine::Cpu { .. } => None,
    });
    let share = |part_s: f64| {
        format!(
            "{:.0} %",
            100.0 * part_s / times.loop_s.max(f64::MIN_POSITIVE)
        )
    };
    let of_gpu = of_gpu
        .reduce(|all, own| [all, own].into_iter().sum())
        .map(|gpu| {
            format!(
                " (shaders {}, compiling {}, sending {}, receiving {})",
                share(gpu.kernel_s),
                share(gpu.compile_s),
                share(gpu.upload_s),
                share(gpu.read_back_s)
            )
        });
    format!(
        "synthesis {:.1} s, simulation {:.1} s{}, cross-check {:.1} s, statistics {:.1} s, writing {:.1} s",
        times.synthesis_s,
        times.loop_s,
        of_gpu.unwrap_or_default(),
        times.cross_check_s,
        times.statistics_s,
        times.writing_s
    )
}
