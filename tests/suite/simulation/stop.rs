//! Early stop: the level of what a run claims when it ends, and the same end whatever simulates it.

use crate::common::{altered, gains, gpu_or_skip};
use urts_mc::backend::cpu::{Precision, Simd};
use urts_mc::backend::gpu::Tuning;
use urts_mc::campaign::{Campaign, Goal};
use urts_mc::random::philox::{Address, Stream};
use urts_mc::results::scores::Status;
use urts_mc::results::{RateMethod, summarise, summary_table};
use urts_mc::run::directory::OutputDir;
use urts_mc::run::manifest::Manifest;
use urts_mc::run::replay::replay;
use urts_mc::run::{Extras, run};
use urts_mc::simulation::stopping::{Stopped, StoppingRule};
use urts_mc::simulation::{Backend, RunOptions, Simulation, simulate};
use urts_mc::statistics::{clopper_pearson_upper, sequential_interval, sequential_upper};

fn stopping(keys: &str, episodes: u32) -> Campaign {
    altered(
        "smoke",
        &[
            &format!("[stop]\n{keys}"),
            "time.duration_s=4.5",
            &format!("episodes={episodes}"),
        ],
    )
}

/// A run whose controller fails at this rate: what it knows at its end.
fn synthetic(campaign: &Campaign, rate: f64, experiment: u32) -> (Stopped, bool) {
    let mut stopping = StoppingRule::new(campaign);
    for episode in 0..campaign.episodes {
        let address = Address {
            episode,
            stream: Stream::Initial,
            entry: 77,
            member: experiment,
            index: 0,
        };
        let fails = address.unit(3) < rate;
        stopping.take(|_| if fails { Status::Exceeded } else { Status::Ok });
        if stopping.is_done() {
            break;
        }
    }
    (stopping.found(campaign).unwrap(), stopping.is_done())
}

/// Of 2,000 runs: the shares that end early, and whose bounds miss the rate at their end.
fn shares(campaign: &Campaign, rate: f64) -> (f64, f64) {
    let (mut ended, mut missed) = (0, 0);
    for experiment in 0..2000 {
        let (found, done) = synthetic(campaign, rate, experiment);
        ended += u32::from(done);
        missed += u32::from(rate < found.lower || found.upper < rate);
        assert!(!done || found.reached.is_some());
    }
    (f64::from(ended) / 2000.0, f64::from(missed) / 2000.0)
}

#[test]
fn a_run_that_ends_when_it_likes_what_it_sees_still_errs_as_rarely_as_it_says() {
    let looks = "controller = \"ftc\"\nevery = 8\n";
    let with = |goals: &str| stopping(&format!("{looks}{goals}"), 2000);
    // At the limit itself every proof is an error. 1.5 points are three standard errors.
    for goals in [
        "failure_rate_below = 0.1",
        "failure_rate_above = 0.1",
        "failure_rate_below = 0.1\nfailure_rate_above = 0.1",
    ] {
        let (ended, missed) = shares(&with(goals), 0.1);
        println!("{goals:?}: {ended} end, {missed} miss");
        assert!(ended <= 0.05 + 0.015 && missed <= 0.05 + 0.015);
    }
    let narrow = stopping("controller = \"ftc\"\nevery = 40\nhalf_width = 0.04", 2000);
    let (ended, missed) = shares(&narrow, 0.1);
    println!("half width: {ended} end, {missed} miss");
    assert!(ended > 0.99 && missed <= 0.05 + 0.015);
    // What is clearly below is found to be.
    let (ended, missed) = shares(&with("failure_rate_below = 0.1"), 0.03);
    assert!(ended > 0.99 && missed <= 0.05 + 0.015);
    // Negative control: a bound for a fixed number, looked at as often, errs several times as often.
    let campaign = with("failure_rate_below = 0.1");
    let naive = (0..2000).filter(|&experiment| {
        let mut failures = 0;
        (1..=campaign.episodes).any(|n| {
            let address = Address {
                episode: n - 1,
                stream: Stream::Initial,
                entry: 77,
                member: experiment,
                index: 0,
            };
            failures += u64::from(address.unit(3) < 0.1);
            n % 8 == 0 && clopper_pearson_upper(failures, u64::from(n), 0.95) < 0.1
        })
    });
    let naive = naive.count() as f64 / 2000.0;
    println!("fixed bound: {naive} err");
    assert!(naive > 0.12, "{naive}");
}

#[test]
fn looks_are_where_the_campaign_says_and_one_sided_goals_spend_all_doubt_on_their_side() {
    // Without failure 5 % is proved after 88 episodes: the next multiple of 10 is 90.
    let campaign = stopping(
        "controller = \"pid\"\nevery = 10\nfailure_rate_below = 0.05",
        1000,
    );
    let (found, done) = synthetic(&campaign, 0.0, 0);
    assert!(done && found.episodes == 90 && found.failures == 0 && found.lower == 0.0);
    assert_eq!(found.upper, sequential_upper(0, 90, 0.95));
    assert_eq!(found.reached.as_deref(), Some("failure_rate_below = 0.05"));
    assert_eq!(found.controller, "pid");
    // Two sides share the doubt.
    let both = stopping(
        "controller = \"pid\"\nevery = 10\nfailure_rate_below = 0.05\nfailure_rate_above = 0.2",
        1000,
    );
    let stop = both.stop.as_ref().unwrap();
    assert_eq!(stop.bounds(3, 40), sequential_interval(3, 40, 0.95));
    let (found, _) = synthetic(&both, 1.0, 0);
    assert_eq!(found.reached.as_deref(), Some("failure_rate_above = 0.2"));
    assert_eq!(stop.reached(10, 10), Some(Goal::Above(0.2)));
    // Nothing is stopped, and nothing found, without [stop].
    let plain = altered("smoke", &[]);
    assert_eq!(StoppingRule::new(&plain).found(&plain), None);
}

/// The plain PID fails in most episodes, which proves a rate above 50 % soon.
fn failing() -> Campaign {
    stopping(
        "controller = \"pid\"\nevery = 6\nfailure_rate_above = 0.5",
        300,
    )
}

fn simulated(options: &RunOptions, gpu: Option<&urts_mc::backend::gpu::Gpu>) -> Simulation {
    let campaign = failing();
    let gains = gains(&campaign);
    simulate(
        &campaign,
        std::slice::from_ref(gains),
        options,
        gpu,
        &|_| (),
    )
    .unwrap()
}

#[test]
fn a_run_ends_at_the_same_episode_whatever_simulates_it() {
    let options = |threads, simd| RunOptions {
        threads,
        simd,
        ..RunOptions::cpu(Precision::F32)
    };
    let first = simulated(&options(1, None), None);
    let episodes = first.episodes();
    println!("ended after {episodes}");
    assert!((7..300).contains(&episodes) && episodes.is_multiple_of(6));
    assert_eq!(first.tables.scores.episodes(), episodes as usize);
    let statuses = &first.tables.scores.status;
    for (threads, simd) in [(2, None), (3, Some(Simd::Scalar)), (2, Some(Simd::Avx2))] {
        let other = simulated(&options(threads, simd), None);
        assert_eq!(other.episodes(), episodes);
        assert_eq!(&other.tables.scores.status, statuses);
    }
    let Some(gpu) = gpu_or_skip() else { return };
    for batch in [4, 7, 64] {
        let tuning = Tuning {
            batch: Some(batch),
            steps: None,
        };
        let options = RunOptions {
            backend: Backend::Gpu { adapter: None },
            tuning,
            ..RunOptions::cpu(Precision::F32)
        };
        let other = simulated(&options, Some(&gpu));
        assert_eq!(other.episodes(), episodes);
        assert_eq!(
            (other.segments.len(), other.segments[0].episodes),
            (1, episodes)
        );
        assert_eq!(&other.tables.scores.status, statuses);
    }
}

#[test]
fn a_stopped_run_is_whole_says_why_it_ended_and_has_the_bounds_that_hold() {
    let campaign = failing();
    let dir = tempfile::tempdir().unwrap();
    let out = OutputDir::claim(&dir.path().join("run"), &campaign, false).unwrap();
    let options = RunOptions::cpu(Precision::F32);
    let extras = Extras {
        csv: false,
        cross_check: Some(2),
        ..Extras::default()
    };
    let findings = run(&campaign, &options, &out, extras, &|_| ()).unwrap();
    let manifest = Manifest::read(out.path()).unwrap();
    let stopped = manifest.stopped.unwrap();
    assert_eq!(manifest.episodes_asked, 300);
    assert_eq!(u64::from(manifest.episodes), stopped.episodes);
    assert!(manifest.episodes < 300 && manifest.interrupted.is_none());
    assert!(stopped.lower > 0.5 && stopped.upper == 1.0);
    // Its directory is a run's, of which every episode is there again.
    assert!(
        findings
            .manifest
            .cross_check
            .is_some_and(|check| check.not_repeated == 0)
    );
    assert!(replay(out.path(), manifest.episodes - 1, "pid", None).is_ok());
    assert!(replay(out.path(), manifest.episodes, "pid", None).is_err());
    let path = out.path().to_path_buf();
    drop(out);
    assert!(OutputDir::claim(&path, &campaign, false).is_ok());
    // The bounds of its failure rates are those that hold at any number, of every controller.
    for row in &findings.results.summary {
        let rate = &row.failures;
        assert_eq!(rate.method, RateMethod::Sequential);
        let expected = sequential_interval(rate.failed(), rate.n, 0.95);
        assert_eq!(rate.interval, Some(expected));
        assert_eq!(
            rate.upper_95,
            Some(sequential_upper(rate.failed(), rate.n, 0.95))
        );
    }
    let frame = summary_table(&findings.results.summary).to_frame().unwrap();
    assert!(frame.column("failure_rate_sequential_lower").is_ok());
    let plain = altered("smoke", &[]);
    let scores = crate::common::tables(&plain, Precision::F32).scores;
    let frame = summary_table(&summarise(&plain, &scores))
        .to_frame()
        .unwrap();
    assert!(frame.column("failure_rate_sequential_lower").is_err());
}
