//! The output directory: what may be written, and that it is written whole or not at all.

use super::{Place, smoke};
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

const RUN: [&str; 4] = ["run", "c.toml", "--out", "out"];
/// What every run writes.
const FILES: [&str; 20] = [
    "channels.parquet",
    "comparison.csv",
    "comparison.parquet",
    "conditions.parquet",
    "episodes.parquet",
    "fairness.csv",
    "fairness.parquet",
    "faults.parquet",
    "flights.csv",
    "flights.parquet",
    "gains.json",
    "manifest.json",
    "ranking.csv",
    "ranking.parquet",
    "report.html",
    "report.md",
    "summary.csv",
    "summary.parquet",
    "worst.csv",
    "worst.parquet",
];

/// The names in a folder, hidden ones too.
fn names(dir: &Path) -> Vec<String> {
    let name = |entry: fs::DirEntry| entry.file_name().into_string().unwrap();
    let mut names: Vec<String> = fs::read_dir(dir)
        .unwrap()
        .map(|entry| name(entry.unwrap()))
        .collect();
    names.sort();
    names
}

#[test]
fn a_run_writes_its_files_and_no_others() {
    let place = Place::smoke(&[]);
    place.succeeds(&RUN);
    assert_eq!(names(&place.path("out")), FILES);
    assert_eq!(names(place.0.path()), ["c.toml", "out"]);
    // Without --out, under the campaign's name; folders are made as needed.
    place.succeeds(&["run", "c.toml", "--csv"]);
    let mut more: Vec<&str> = FILES.to_vec();
    more.extend([
        "episodes.csv",
        "channels.csv",
        "faults.csv",
        "conditions.csv",
    ]);
    more.sort_unstable();
    assert_eq!(names(&place.path("reports/smoke")), more);
    assert_eq!(
        place.read("out/summary.csv"),
        place.read("reports/smoke/summary.csv")
    );
    // 3 episodes, 3 controllers, 3 agents, 6 channels.
    assert_eq!(place.rows("reports/smoke/episodes.csv").len(), 27);
    assert_eq!(place.rows("reports/smoke/channels.csv").len(), 27 * 6);
}

#[test]
fn a_directory_that_cannot_be_written_is_refused() {
    let place = Place::smoke(&[]);
    for out in ["c.toml", "c.toml/below", "/proc/urts-mc"] {
        let words = [
            &format!("error: {out}: cannot be written ("),
            "give another directory with --out",
        ];
        place.refuses(&["run", "c.toml", "--out", out], 2, &words);
        place.refuses(&["run", "c.toml", "--overwrite", "--out", out], 2, &words);
    }
}

#[test]
fn what_helps_where_nothing_can_be_written_is_an_option_of_the_command() {
    let place = Place::smoke(&[]);
    place.succeeds(&RUN);
    fs::remove_file(place.path("out/report.html")).unwrap();
    for taken in ["out/report.html", "out/replay-0-ftc.parquet", "figures"] {
        fs::create_dir(place.path(taken)).unwrap();
    }
    let words = [
        "error: out/report.html: cannot be written (",
        "make their directory writable",
    ];
    let said = place.refuses(&["report", "out"], 2, &words);
    assert!(!said.contains("--out"), "{said}");
    let replay = ["replay", "out", "--episode", "0"];
    place.refuses(
        &replay,
        2,
        &["out/replay-0-ftc.parquet: cannot be written (it is no file); give another file with --out"],
    );
    place.refuses(
        &[&replay as &[_], &["--overwrite", "--out", "figures"]].concat(),
        2,
        &[
            "figures: cannot be written (",
            "give another file with --out",
        ],
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_takes_no_more_is_named_and_not_the_table() {
    let place = Place::smoke(&[]);
    place.succeeds(&RUN);
    // Files of more than 4 KiB are refused as on a full disk: with an error in the midst of the table.
    let script = "trap '' XFSZ; ulimit -f 4; exec \"$0\" replay out --episode 0 --out far.parquet";
    let ended = std::process::Command::new("bash")
        .current_dir(place.0.path())
        .args(["-c", script, env!("CARGO_BIN_EXE_urts-mc")])
        .output()
        .unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(
        said,
        "error: ./far.parquet: cannot be written (File too large (os error 27)); give another file with --out\n"
    );
    assert_eq!(ended.status.code(), Some(2));
    assert_eq!(names(place.0.path()), ["c.toml", "out"]);
}

#[test]
fn another_campaigns_run_is_replaced_only_on_request() {
    let place = Place::smoke(&[]);
    place.succeeds(&RUN);
    place.write("d.toml", smoke(&[("max_rmse = 1.0", "max_rmse = 0.9")]));
    place.refuses(
        &["run", "d.toml", "--out", "out"],
        2,
        &[
            "error: out: holds a run of another campaign text (\"smoke\")",
            "--out",
            "--overwrite",
        ],
    );
    // Nor may another seed or a shorter run replace what was simulated; the same run may, and a longer one.
    for fewer in [["--seed", "7"], ["--episodes", "2"]] {
        let arguments = [&RUN[..], &fewer[..]].concat();
        place.refuses(
            &arguments,
            2,
            &["holds a run of 3 episodes with seed 2026", "--overwrite"],
        );
    }
    place.succeeds(&RUN);
    place.succeeds(&["run", "c.toml", "--out", "out", "--episodes", "4"]);
    assert!(place.read("out/manifest.json").contains("\"episodes\": 4"));
    place.succeeds(&["run", "d.toml", "--out", "out", "--overwrite"]);
    assert!(place.read("out/manifest.json").contains("max_rmse = 0.9"));
}

#[test]
fn a_directory_with_other_files_is_refused_and_keeps_them_when_overwritten() {
    let place = Place::smoke(&[]);
    fs::create_dir(place.path("out")).unwrap();
    place.write("out/notes.txt", "mine");
    let words = [
        "error: out: holds files, but no finished run",
        "--overwrite",
    ];
    place.refuses(&RUN, 2, &words);
    place.succeeds(&["run", "c.toml", "--out", "out", "--overwrite"]);
    assert_eq!(place.read("out/notes.txt"), "mine");
}

#[test]
fn files_of_an_earlier_run_that_the_new_one_does_not_write_are_removed() {
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--out", "out", "--csv"]);
    place.succeeds(&["replay", "out", "--episode", "0"]);
    assert_eq!(names(&place.path("out")).len(), FILES.len() + 7);
    place.succeeds(&["run", "c.toml", "--out", "out", "--episodes", "4"]);
    assert_eq!(names(&place.path("out")), FILES);
}

#[test]
fn a_run_that_cannot_finish_leaves_no_half_file_and_no_manifest() {
    let place = Place::smoke(&[]);
    place.succeeds(&RUN);
    // A folder stands where a file has to go.
    fs::remove_file(place.path("out/comparison.csv")).unwrap();
    fs::create_dir(place.path("out/comparison.csv")).unwrap();
    let ended = place.program(&RUN);
    assert_eq!((ended.code, ended.stdout.as_str()), (2, ""));
    let said = ended.stderr;
    assert!(
        said.starts_with("error: out/comparison.csv: cannot be written ("),
        "{said}"
    );
    let left = names(&place.path("out"));
    assert!(!left.contains(&"manifest.json".to_string()), "looks whole");
    assert!(!left.iter().any(|name| name.starts_with('.')), "{left:?}");
    for name in left.iter().filter(|name| name.ends_with(".parquet")) {
        let bytes = fs::read(place.path("out").join(name)).unwrap();
        assert!(
            bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"),
            "{name}"
        );
    }
    // Nor does anything take it for a run.
    place.refuses(
        &["replay", "out", "--episode", "0"],
        2,
        &["no readable run"],
    );
    // What it left does not keep it from being run again.
    fs::remove_dir(place.path("out/comparison.csv")).unwrap();
    place.succeeds(&RUN);
    assert_eq!(names(&place.path("out")), FILES);
}

#[test]
fn a_killed_run_leaves_the_earlier_one_as_it_was_or_nothing() {
    let place = Place::smoke(&[]);
    place.succeeds(&RUN);
    let before = place.everything();
    for out in ["out", "new"] {
        let mut flying = place
            .command(&["run", "c.toml", "--episodes", "1000000", "--out", out])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Synthesis takes a fraction of a second, a million episodes minutes: it is simulating.
        sleep(Duration::from_secs(1));
        assert!(
            flying.try_wait().unwrap().is_none(),
            "ended before the kill"
        );
        flying.kill().unwrap();
        flying.wait().unwrap();
        assert!(place.everything() == before, "{out} changed");
    }
}
