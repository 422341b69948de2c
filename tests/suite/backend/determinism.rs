//! The same file, seed and precision give the same bytes, whatever the threads, the width, the order and the length;
//! and one episode alone gives its row again.

use crate::common::{altered, campaign, gains};
use std::fs;
use urts_mc::backend::EpisodeResult;
use urts_mc::backend::cpu::{Cpu, Precision, Simd};
use urts_mc::campaign::Campaign;
use urts_mc::run::directory::OutputDir;
use urts_mc::run::replay::replay;
use urts_mc::run::{Extras, run};
use urts_mc::simulation::RunOptions;

/// Campaigns of UAVs and of robots with noise and every other kind of signal, short, and with a number of episodes that
/// fills no block.
fn everything() -> [Campaign; 2] {
    [uavs(), robots()]
}

fn uavs() -> Campaign {
    let more = r#"[[disturbance]]
kind = "constant"
amplitude = { normal = { mean = 0.0, std = 5.0 } }

[[fault]]
target = "sensor"
kind = "noise"
onset_s = 1.0
std = { uniform = [0.001, 0.01] }

[[fault]]
target = "sensor"
kind = "bias"
probability = 0.5
onset_s = { uniform = [0.5, 2.0] }
magnitude = { normal = { mean = 0.0, std = 0.1 } }

[[fault]]
target = "actuator"
kind = "bias"
channels = [1, 5]
onset_s = { uniform = [0.5, 2.0] }
magnitude = 3.0
"#;
    altered("smoke", &[more, "time.duration_s=4.5", "episodes=37"])
}

fn robots() -> Campaign {
    let more = r#"[coupling]
kappa = { choice = [0.0, 1.0] }

[[disturbance]]
kind = "sine"
amplitude = { uniform = [0.0, 5.0] }
frequency_rad_s = 3.0

[[fault]]
target = "sensor"
kind = "noise"
onset_s = 1.0
std = { uniform = [0.0001, 0.001] }

[[fault]]
target = "sensor"
kind = "smoothed-square"
amplitude = { uniform = [0.01, 0.1] }
period_s = 2.0
smoothing = 0.1

[[fault]]
target = "actuator"
kind = "loss-of-effectiveness"
probability = 0.5
channels = "one"
onset_s = { uniform = [0.5, 2.0] }
magnitude = { uniform = [0.1, 0.5] }

[[fault]]
target = "actuator"
kind = "bias"
channels = [1, 11]
onset_s = { uniform = [0.5, 2.0] }
magnitude = 1.0
"#;
    altered(
        "biped-ground-reaction",
        &[
            more,
            "agent.team=2",
            "reference.agents=[{}, { start_s = 0.3 }]",
            "time.duration_s=4.5",
            "episodes=37",
        ],
    )
}

/// Whether two results are the same to the last digit; what is no number is the same as itself.
fn same<T: std::fmt::Debug + ?Sized>(a: &T, b: &T) -> bool {
    format!("{a:?}") == format!("{b:?}")
}

fn simulate(
    campaign: &Campaign,
    simd: Option<Simd>,
    threads: usize,
    precision: Precision,
) -> Vec<EpisodeResult> {
    let gains = gains(campaign);
    let cpu = Cpu::new(campaign.first_group(), &gains.loops(), precision, simd);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| cpu.simulate(0..campaign.episodes, &|_| ()))
}

fn files(
    campaign: &Campaign,
    threads: usize,
    simd: Option<Simd>,
    precision: Precision,
) -> Vec<(String, Vec<u8>)> {
    let dir = tempfile::tempdir().unwrap();
    let out = OutputDir::claim(&dir.path().join("run"), campaign, false).unwrap();
    run(
        campaign,
        &RunOptions {
            simd,
            threads,
            ..RunOptions::cpu(precision)
        },
        &out,
        Extras {
            csv: true,
            cross_check: None,
            ..Extras::default()
        },
        &|_| (),
    )
    .unwrap();
    let path = out.path().to_path_buf();
    // With it goes its lock.
    drop(out);
    let mut files: Vec<(String, Vec<u8>)> = fs::read_dir(path)
        .unwrap()
        .map(|entry| entry.unwrap())
        .map(|entry| {
            (
                entry.file_name().into_string().unwrap(),
                fs::read(entry.path()).unwrap(),
            )
        })
        // These say when, where and on what the run was simulated.
        .filter(|(name, _)| name != "manifest.json" && !name.starts_with("report."))
        .collect();
    files.sort();
    files
}

#[test]
fn the_tables_have_the_same_bytes_for_any_thread_count_and_simd_width() {
    everything().iter().for_each(same_bytes);
}

fn same_bytes(campaign: &Campaign) {
    let reference = files(campaign, 1, Some(Simd::Avx2), Precision::F32);
    let names: Vec<&str> = reference.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [
            "channels.csv",
            "channels.parquet",
            "comparison.csv",
            "comparison.parquet",
            "conditions.csv",
            "conditions.parquet",
            "curves.csv",
            "curves.parquet",
            "episodes.csv",
            "episodes.parquet",
            "fairness.csv",
            "fairness.parquet",
            "faults.csv",
            "faults.parquet",
            "flights.csv",
            "flights.parquet",
            "gains.json",
            "ranking.csv",
            "ranking.parquet",
            "summary.csv",
            "summary.parquet",
            "worst.csv",
            "worst.parquet"
        ]
    );
    for (threads, simd) in [(2, Simd::Avx2), (1, Simd::Avx512), (2, Simd::Avx512)] {
        if simd.is_available() {
            assert!(
                files(campaign, threads, Some(simd), Precision::F32) == reference,
                "{threads} threads, {simd:?}"
            );
        }
    }
    // The comparison can fail: another seed must show in both big tables.
    let other = campaign.clone().with_seed(campaign.seed + 1);
    let changed = files(&other, 1, Some(Simd::Avx2), Precision::F32);
    for (name, content) in reference {
        let same = changed
            .iter()
            .any(|(own, bytes)| *own == name && *bytes == content);
        assert_eq!(same, name == "gains.json", "{name}");
    }
}

#[test]
fn the_first_episodes_of_a_longer_run_equal_a_shorter_one() {
    for long in everything() {
        let short = long.clone().with_episodes(10).unwrap();
        let all = simulate(&long, None, 2, Precision::F32);
        assert_eq!(all.len(), 37);
        assert!(same(
            &all[..10],
            &simulate(&short, None, 2, Precision::F32)[..]
        ));
        assert!(all[0].outcomes != all[1].outcomes, "episodes differ");
    }
}

#[test]
fn a_range_of_episodes_gives_the_same_whatever_block_it_begins_in() {
    for campaign in everything() {
        let gains = gains(&campaign);
        let cpu = Cpu::new(campaign.first_group(), &gains.loops(), Precision::F32, None);
        let all = cpu.simulate(0..37, &|_| ());
        assert!(same(&cpu.simulate(5..23, &|_| ())[..], &all[5..23]));
    }
}

#[test]
fn all_controllers_of_an_episode_meet_the_same_draws() {
    everything().iter().for_each(same_draws);
}

fn same_draws(campaign: &Campaign) {
    let reversed = campaign.clone().with(|own| own.controllers.reverse());
    let (forward, backward) = (
        simulate(campaign, None, 1, Precision::F32),
        simulate(&reversed, None, 1, Precision::F32),
    );
    for (a, b) in forward.iter().zip(&backward) {
        assert!(a.episode == b.episode);
        let mut outcomes = b.outcomes.clone();
        outcomes.reverse();
        assert!(same(&a.outcomes, &outcomes));
    }
}

#[test]
fn a_replayed_episode_has_the_metrics_of_its_row() {
    everything().iter().for_each(same_metrics);
}

fn same_metrics(campaign: &Campaign) {
    for precision in [Precision::F32, Precision::F64] {
        let dir = tempfile::tempdir().unwrap();
        let out = OutputDir::claim(&dir.path().join("run"), campaign, false).unwrap();
        run(
            campaign,
            &RunOptions::cpu(precision),
            &out,
            Extras::default(),
            &|_| (),
        )
        .unwrap();
        let simulated = simulate(campaign, None, 1, precision);
        for (episode, controller) in [(0, "ftc"), (21, "pid"), (36, "pid-tuned")] {
            let replayed = replay(out.path(), episode, controller, None).unwrap();
            let index = campaign
                .controllers
                .iter()
                .position(|name| name == controller)
                .unwrap();
            assert!(
                same(
                    &replayed.outcomes,
                    &simulated[episode as usize].outcomes[index]
                ),
                "{precision:?} {episode} {controller}"
            );
            assert_eq!(replayed.snapshots.len(), 451);
            if replayed.outcomes[1].diverged {
                continue;
            }
            // The trajectory is the one that the metrics are of.
            let settle = (campaign.time.settle_step / 5) as usize;
            let largest = replayed.snapshots[settle..450]
                .iter()
                .map(|s| s.agents[1][3].e.abs())
                .fold(0.0, f64::max);
            let recorded = replayed.outcomes[1].channels[3].max_abs;
            assert!(
                largest <= recorded && largest > 0.99 * recorded,
                "{largest} of {recorded}"
            );
        }
    }
}

#[test]
fn the_result_of_the_smoke_campaign_does_not_depend_on_how_often_it_is_simulated() {
    let campaign = campaign("smoke");
    let options = (2, None, Precision::F64);
    assert!(
        files(&campaign, options.0, options.1, options.2)
            == files(&campaign, options.0, options.1, options.2)
    );
}
