//! What passed when files and reports of the public were tried on the program, and has to keep passing.

use super::Place;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;
use urts_mc::campaign::Campaign;
use urts_mc::draw::draw;

/// Every table of a run.
fn tables(place: &Place, run: &str) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(place.path(run)).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".parquet")).collect();
    names.sort();
    assert!(names.len() > 5, "{names:?}");
    let of = |name: String| {
        let bytes = place.read_bytes(&format!("{run}/{name}"));
        (name, bytes)
    };
    names.into_iter().map(of).collect()
}

#[test]
fn a_longer_run_in_the_directory_of_a_shorter_one_is_the_longer_run() {
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--episodes", "8", "--out", "grown"]);
    let shorter = tables(&place, "grown");
    place.succeeds(&["run", "c.toml", "--episodes", "12", "--out", "grown"]);
    place.succeeds(&["run", "c.toml", "--episodes", "12", "--out", "once"]);
    let grown = tables(&place, "grown");
    assert_eq!(grown, tables(&place, "once"));
    assert_ne!(grown, shorter);
}

#[test]
fn adjacent_seeds_share_no_number() {
    let place = Place::smoke(&[]);
    let numbers = |seed: u64| -> BTreeSet<u64> {
        let campaign = Campaign::load(&place.path("c.toml"))
            .unwrap()
            .with_seed(seed);
        let group = campaign.first_group();
        let mut numbers = BTreeSet::new();
        for episode in 0..200 {
            for agent in draw(group, episode).agents {
                let drawn = agent.disturbances.iter().flatten().flatten();
                let drawn = drawn.chain(&agent.error).chain(&agent.error_rate);
                numbers.extend(drawn.map(|number| number.to_bits()));
            }
        }
        numbers
    };
    let (one, next) = (numbers(2026), numbers(2027));
    // Three numbers of the sine and two of the initial state, of six channels of three agents.
    assert_eq!(one.len(), 200 * 3 * 6 * 5);
    assert!(one.is_disjoint(&next));
    assert_eq!(one, numbers(2026));
}

/// Runs a line of bash with $PROGRAM in it, in a folder where a run is in `out`.
fn bash(place: &Place, line: &str, clean: bool) -> (i32, String) {
    let mut command = Command::new("/bin/bash");
    if clean {
        command.env_clear();
    }
    let ended = command
        .current_dir(place.0.path())
        .env("PROGRAM", env!("CARGO_BIN_EXE_urts-mc"))
        .args(["--norc", "-c", line])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    (ended.status.code().unwrap_or(-1), said)
}

/// Commands that print much or little.
const COMMANDS: [&str; 11] = [
    "--help",
    "run c.toml --episodes 2 --backend cpu --out out",
    "run c.toml --episodes 2 --backend cpu --out out --json",
    "check c.toml",
    "synthesize c.toml --json",
    "replay out --episode 1",
    "report out",
    "compare out out --out same",
    "columns",
    "schema",
    "completions bash",
];

#[test]
fn a_reader_that_goes_away_is_no_error_and_no_panic() {
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--episodes", "2", "--out", "out"]);
    for command in COMMANDS {
        let (code, said) = bash(
            &place,
            &format!("set -o pipefail; $PROGRAM {command} | head -1"),
            false,
        );
        assert!(
            code == 0 && !said.contains("panicked"),
            "{command}: {code} {said}"
        );
    }
}

#[test]
fn a_full_device_is_said_and_closed_streams_and_an_empty_environment_stop_nothing() {
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--episodes", "2", "--out", "out"]);
    for command in COMMANDS {
        let (code, said) = bash(&place, &format!("$PROGRAM {command} > /dev/full"), false);
        assert!(!said.contains("panicked"), "{command}: {said}");
        // clap prints its help itself.
        if command != "--help" {
            assert!(
                code == 1 && said.contains("standard output: cannot be written"),
                "{command}: {code} {said}"
            );
        }
        let (code, said) = bash(&place, &format!("$PROGRAM {command} <&- >&- 2>&-"), false);
        assert!([0, 1].contains(&code), "{command}: {code} {said}");
        let (code, said) = bash(&place, &format!("$PROGRAM {command} > shown.txt"), true);
        assert!(code == 0 && said.is_empty(), "{command}: {code} {said}");
        assert!(
            !place.read("shown.txt").contains('\u{1b}'),
            "{command} writes colours into a file"
        );
    }
}

#[test]
fn a_sobol_design_of_a_hundred_is_answered_with_the_next_power_of_two() {
    let place = Place::smoke(&[]);
    place.refuses(
        &[
            "check",
            "c.toml",
            "--set",
            "episodes=100",
            "--set",
            "sampling.design=sobol",
        ],
        2,
        &["100", "simulate 128 episodes"],
    );
}

#[test]
fn episodes_that_all_diverge_are_counted_and_have_no_errors_and_no_intervals() {
    let place = Place::smoke(&[]);
    let mut arguments = vec!["run", "c.toml", "--out", "out", "--csv"];
    for setting in [
        "episodes=16",
        "sampling.design=latin-hypercube",
        "initial.error=1e30",
        "coupling.kappa=1.0",
    ] {
        arguments.extend(["--set", setting]);
    }
    let ended = place.program(&arguments);
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    let rows = |name: &str| -> Vec<BTreeMap<String, String>> {
        let table = place.read(&format!("out/{name}.csv"));
        let mut lines = table
            .lines()
            .map(|line| line.split(',').map(str::to_string));
        let head: Vec<String> = lines.next().unwrap().collect();
        lines
            .map(|line| head.iter().cloned().zip(line).collect())
            .collect()
    };
    let summary = rows("summary");
    let of_all =
        |row: &&BTreeMap<String, String>| row["metric"] == "rmse" && row["stratum"] == "all";
    let errors = summary.iter().filter(of_all);
    assert!(errors.clone().count() >= 3);
    for row in errors {
        for (column, cell) in [
            ("failed", "16"),
            ("diverged", "16"),
            ("failure_rate_wilson_lower", ""),
            ("q50", "inf"),
            ("q50_lower", ""),
        ] {
            assert_eq!(row[column], cell, "{column}: {row:?}");
        }
    }
    let channels = rows("channels");
    assert!(channels.len() >= 16 && channels.iter().all(|row| row["rmse"].is_empty()));
}
