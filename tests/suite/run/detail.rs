//! Which of its large tables a run writes.

use crate::common::altered;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::{Campaign, Detail};
use urts_mc::report::{Length, report};
use urts_mc::results::extent::Extent;
use urts_mc::run::compare::{Asked, compare_runs};
use urts_mc::run::directory::OutputDir;
use urts_mc::run::{Extras, RunError, run};
use urts_mc::simulation::RunOptions;

/// Runs short flights with a detail.
fn flown(dir: &Path, detail: Detail) -> PathBuf {
    let detail = format!("output.detail={}", detail.word());
    let campaign = altered("smoke", &[&detail, "episodes=60"]);
    let out = OutputDir::claim(&dir.join(detail), &campaign, false).unwrap();
    let options = RunOptions::cpu(Precision::F32);
    run(&campaign, &options, &out, Extras::default(), &|_| ()).unwrap();
    report(out.path(), Length::Full).unwrap();
    out.path().to_path_buf()
}

fn files(dir: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(dir).unwrap();
    entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect()
}

#[test]
fn what_a_detail_leaves_out_changes_nothing_else() {
    let dir = tempfile::tempdir().unwrap();
    let [summary, episodes, all] = Detail::ALL.map(|detail| flown(dir.path(), detail));
    let names = |names: &[&str]| {
        let names = names.iter().map(|name| format!("{name}.parquet"));
        names.collect::<BTreeSet<String>>()
    };
    let missing = |from: &Path| -> BTreeSet<String> {
        files(&all).difference(&files(from)).cloned().collect()
    };
    let others = ["channels", "faults", "conditions"];
    assert_eq!(missing(&episodes), names(&others));
    assert_eq!(
        missing(&summary),
        names(&[&others[..], &["episodes"]].concat())
    );
    let mut compared = 0;
    for name in files(&all).iter().filter(|name| name.ends_with(".csv")) {
        let of = |dir: &Path| fs::read(dir.join(name)).unwrap();
        assert!(
            of(&summary) == of(&all) && of(&episodes) == of(&all),
            "{name}"
        );
        compared += 1;
    }
    assert_eq!(compared, 7);
    // The reports differ in the hash and the text of the campaign alone.
    let figures = |dir: &Path| {
        let html = fs::read_to_string(dir.join("report.html")).unwrap();
        let figures = html.split("<svg").skip(1);
        let figures = figures.map(|rest| rest.split("</svg>").next().unwrap().to_string());
        figures.collect::<Vec<String>>()
    };
    assert!(figures(&all).len() > 5);
    assert_eq!(figures(&summary), figures(&all));
    let refused = compare_runs(&all, &summary, &Asked::default()).unwrap_err();
    let said = refused.to_string();
    for part in ["[output] detail = \"summary\"", "--set output.detail=all"] {
        assert!(said.contains(part), "{said}");
    }
}

#[test]
fn a_run_that_was_interrupted_goes_on_with_another_detail() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run");
    // The batches of one thread are shorter than the run.
    let options = RunOptions {
        threads: 1,
        ..RunOptions::cpu(Precision::F32)
    };
    let with = |detail: &str| altered("smoke", &["episodes=1100", detail]);
    let fly = |campaign: &Campaign, halt: &(dyn Fn() -> bool + Sync)| {
        let out = OutputDir::claim(&path, campaign, false).unwrap();
        let extras = Extras {
            halt,
            ..Extras::default()
        };
        run(campaign, &options, &out, extras, &|_| ()).map_err(Box::new)
    };
    // It is asked before each batch, and ends after the first one.
    let asked = AtomicU32::new(0);
    let after_one = || asked.fetch_add(1, Ordering::Relaxed) > 0;
    let ended = fly(&with("output.detail=all"), &after_one).unwrap_err();
    let RunError::Partial { kept, .. } = *ended else {
        panic!("{ended}");
    };
    assert!(kept > 0 && kept < 1100, "{kept}");
    let part = fs::read(path.join(".urts-mc-parts/part-00000000")).unwrap();
    // Anything else that is set is another run.
    let other = altered("smoke", &["episodes=1100", "verdict.max_rmse=0.5"]);
    let refused = fly(&other, &|| true).unwrap_err().to_string();
    assert!(refused.contains("other settings"), "{refused}");
    let kept = fs::read(path.join(".urts-mc-parts/part-00000000")).unwrap();
    assert!(part == kept);
    let found = fly(&with("output.detail=summary"), &|| false).unwrap();
    assert_eq!(found.manifest.episodes, 1100);
    assert!(!files(&path).contains("episodes.parquet"));
    // What is written belongs to the run that stands: it is not replaced by another detail unasked.
    let campaign = with("output.detail=all");
    let refused = OutputDir::claim(&path, &campaign, false).unwrap_err();
    assert!(refused.to_string().contains("other settings"), "{refused}");
    report(&path, Length::Brief).unwrap();
}

#[test]
fn the_size_of_large_tables_is_told_to_within_a_half() {
    let dir = tempfile::tempdir().unwrap();
    for (name, changes) in [
        (
            "uav-paper",
            &[
                "episodes=500",
                "time.duration_s=3.0",
                "time.settle_s=0.5",
                "fault.0.onset_s=0.6",
            ][..],
        ),
        (
            "biped-paper",
            &["episodes=200", "time.duration_s=1.0", "time.settle_s=0.2"],
        ),
    ] {
        let campaign = altered(name, changes);
        let out = OutputDir::claim(&dir.path().join(name), &campaign, false).unwrap();
        let options = RunOptions::cpu(Precision::F32);
        run(&campaign, &options, &out, Extras::default(), &|_| ()).unwrap();
        let size = |table: &str| {
            let path = out.path().join(format!("{table}.parquet"));
            fs::metadata(path).map_or(0, |own| own.len()) as f64
        };
        let episodes = size("episodes");
        let others = ["channels", "faults", "conditions"].map(size);
        let told = Extent::of(&campaign).tables.map(|own| own as f64);
        assert_eq!(told[0], 0.0);
        for (told, found) in [
            (told[1], episodes),
            (told[2], episodes + others.iter().sum::<f64>()),
        ] {
            // Enough to choose a disk; what is packed how well is the library's to know.
            assert!(
                (0.67..1.5).contains(&(told / found)),
                "{name}: {told} {found}"
            );
        }
    }
}

#[test]
fn more_episodes_than_memory_holds_are_refused_with_how_many_it_does() {
    let campaign = altered("smoke", &["episodes=4000000000"]);
    let extent = Extent::of(&campaign);
    let refused = extent
        .fits(&campaign, 16_000_000_000)
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("episodes") && refused.contains("4000000000"),
        "{refused}"
    );
    let fitting = refused.split("give ").nth(1).unwrap();
    let fitting: u32 = fitting.split(' ').next().unwrap().parse().unwrap();
    let fits = |episodes: u32| {
        let campaign = altered("smoke", &[&format!("episodes={episodes}")]);
        Extent::of(&campaign).fits(&campaign, 16_000_000_000)
    };
    assert!(fitting > 1_000_000);
    fits(fitting - fitting / 1000).unwrap();
    assert!(fits(fitting + fitting / 100).is_err());
}
