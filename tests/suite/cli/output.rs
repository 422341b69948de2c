//! The output directory: what may be written, and that it is written whole or not at all.

use super::{Place, smoke};
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

const RUN: [&str; 4] = ["run", "c.toml", "--out", "out"];
/// What every run writes.
const FILES: [&str; 22] = [
    "channels.parquet",
    "comparison.csv",
    "comparison.parquet",
    "conditions.parquet",
    "curves.csv",
    "curves.parquet",
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
    assert_eq!(ended.status.code(), Some(1));
    assert_eq!(names(place.0.path()), ["c.toml", "out"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_up_leaves_the_earlier_run_as_it_was() {
    let place = Place::smoke(&[]);
    place.succeeds(&RUN);
    let before = place.everything();
    let script =
        "trap '' XFSZ; ulimit -f 32; exec \"$0\" run c.toml --out out --episodes 40 --backend cpu";
    let ended = std::process::Command::new("bash")
        .current_dir(place.0.path())
        .args(["-c", script, env!("CARGO_BIN_EXE_urts-mc")])
        .output()
        .unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(1), "{said}");
    assert!(said.starts_with("error: out/"), "{said}");
    assert!(
        said.contains(": cannot be written (File too large"),
        "{said}"
    );
    assert!(place.everything() == before, "the earlier run changed");
}

#[test]
fn a_second_run_into_the_same_directory_is_refused_while_the_first_one_writes() {
    let place = Place::smoke(&[]);
    let mut flying = place
        .command(&["run", "c.toml", "--episodes", "1000000", "--out", "out"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !place.path("out/.urts-mc-lock").exists() {
        sleep(Duration::from_millis(10));
    }
    let holder = format!("out: is being written by process {} on ", flying.id());
    // Who holds it is written after it is held.
    while place.read("out/.urts-mc-lock").is_empty() {
        sleep(Duration::from_millis(10));
    }
    for overwrite in [&[][..], &["--overwrite"]] {
        let arguments = [&RUN[..], overwrite].concat();
        place.refuses(&arguments, 2, &[&holder, "wait until it has ended"]);
    }
    flying.kill().unwrap();
    flying.wait().unwrap();
    // What a killed process leaves is taken over.
    place.succeeds(&RUN);
    assert_eq!(names(&place.path("out")), FILES);
}

#[test]
fn a_run_that_was_whole_when_its_process_ended_is_brought_to_its_place() {
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--out", "longer", "--episodes", "5"]);
    place.succeeds(&["run", "c.toml", "--out", "out", "--csv"]);
    let longer = place.read_bytes("longer/episodes.parquet");
    // Ended while files were moved: some of them are there, the earlier manifest is gone.
    for (moved, begins) in [
        (false, ".urts-mc-a1b2c3.run"),
        (true, ".urts-mc-ready-a1b2c3.run"),
    ] {
        let on_the_way = format!("out/{begins}");
        fs::create_dir(place.path(&on_the_way)).unwrap();
        for name in names(&place.path("longer")) {
            let (from, to) = (format!("longer/{name}"), format!("{on_the_way}/{name}"));
            fs::copy(place.path(&from), place.path(&to)).unwrap();
        }
        if moved {
            fs::remove_file(place.path("out/manifest.json")).unwrap();
            let name = format!("{on_the_way}/summary.parquet");
            fs::rename(place.path(&name), place.path("out/summary.parquet")).unwrap();
        }
        // A shorter run may not replace it.
        let ended = place.program(&RUN);
        assert_eq!(ended.code, 2, "{}", ended.stderr);
        assert!(
            ended.stderr.contains("holds a run of 5 episodes"),
            "{}",
            ended.stderr
        );
        assert_eq!(place.read_bytes("out/episodes.parquet"), longer);
        assert_eq!(names(&place.path("out")), FILES);
        place.succeeds(&[
            "replay",
            "out",
            "--episode",
            "4",
            "--out",
            "far.parquet",
            "--overwrite",
        ]);
    }
    // One that was not whole is gone.
    fs::create_dir(place.path("out/.urts-mc-d4e5f6.run")).unwrap();
    place.write("out/.urts-mc-d4e5f6.run/episodes.parquet", "half");
    place.succeeds(&["run", "c.toml", "--out", "out", "--episodes", "5"]);
    assert_eq!(names(&place.path("out")), FILES);
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

#[cfg(unix)]
#[test]
fn links_with_the_names_of_what_is_on_the_way_lead_nowhere() {
    use std::os::unix::fs::symlink;
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--out", "good"]);
    place.succeeds(&RUN);
    let good = tables(&place);
    symlink("../good", place.path("out/.urts-mc-a1b2c3.run")).unwrap();
    place.succeeds(&RUN);
    assert!(tables(&place) == good && place.path("out/.urts-mc-a1b2c3.run").is_symlink());
    // What has the lock's name and is none is not written.
    place.write("thesis.tex", "mine");
    symlink("../thesis.tex", place.path("out/.urts-mc-lock")).unwrap();
    place.refuses(&RUN, 2, &["out: cannot be written (", "is no lock"]);
    assert_eq!(place.read("thesis.tex"), "mine");
    fs::remove_file(place.path("out/.urts-mc-lock")).unwrap();
    place.write("out/.urts-mc-lock", "mine");
    place.refuses(&RUN, 2, &["is no lock"]);
    assert_eq!(place.read("out/.urts-mc-lock"), "mine");
}

/// The files of the run in `good`.
#[cfg(unix)]
fn tables(place: &Place) -> Vec<(String, Vec<u8>)> {
    let of = |name: String| {
        let bytes = place.read_bytes(&format!("good/{name}"));
        (name, bytes)
    };
    names(&place.path("good")).into_iter().map(of).collect()
}

#[test]
fn a_run_that_cannot_take_its_place_leaves_the_earlier_one_whole_and_is_kept() {
    let place = Place::smoke(&[]);
    place.succeeds(&RUN);
    // A folder stands where a file has to go.
    fs::remove_file(place.path("out/comparison.csv")).unwrap();
    fs::create_dir(place.path("out/comparison.csv")).unwrap();
    let longer = ["run", "c.toml", "--out", "out", "--episodes", "4"];
    let ended = place.program(&longer);
    assert_eq!((ended.code, ended.stdout.as_str()), (2, ""));
    let said = ended.stderr;
    assert!(
        said.starts_with("error: out/comparison.csv: cannot be written ("),
        "{said}"
    );
    assert!(place.read("out/manifest.json").contains("\"episodes\": 3"));
    place.succeeds(&["replay", "out", "--episode", "0"]);
    // When it is away, the one that flew comes to its place.
    fs::remove_dir(place.path("out/comparison.csv")).unwrap();
    let ended = place.program(&RUN);
    assert_eq!(ended.code, 2);
    assert!(
        ended.stderr.contains("holds a run of 4 episodes"),
        "{}",
        ended.stderr
    );
    // Its episodes were kept until it was there.
    let ended = place.program(&longer);
    let note = "note: goes on after 4 of 4 episodes that are kept in out\n";
    assert_eq!((ended.code, ended.stderr.as_str()), (0, note));
    assert_eq!(names(&place.path("out")), FILES);
}

#[test]
fn what_stands_without_a_manifest_is_nobodys_run() {
    let place = Place::smoke(&[]);
    fs::create_dir(place.path("out")).unwrap();
    for name in ["report.md", "gains.json", "summary.csv", ".thesis.part"] {
        let file = format!("out/{name}");
        place.write(&file, "mine");
        place.refuses(&RUN, 2, &["out: holds files, but no finished run"]);
        assert_eq!(place.read(&file), "mine");
        fs::remove_file(place.path(&file)).unwrap();
    }
    // Beside a run they stay, but for what a run has the names of.
    place.succeeds(&RUN);
    for name in [".thesis.part", "replay-notes.html"] {
        place.write(&format!("out/{name}"), "mine");
    }
    place.succeeds(&RUN);
    for name in [".thesis.part", "replay-notes.html"] {
        assert_eq!(place.read(&format!("out/{name}")), "mine");
    }
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
        // Nothing but the lock, which the next run takes over, and what was flown.
        let mut after = place.everything();
        after.retain(|path, _| {
            let path = path.display().to_string();
            !path.contains(".urts-mc-") && !path.ends_with("new")
        });
        assert!(after == before, "{out} changed");
    }
}
