//! Shards on a real Slurm, which `tests/slurm` starts on this machine.

use super::Place;
use super::parts::{place, tables};
use super::shards::run;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// Whether there is one; a machine that has to have it (URTS_REQUIRE_SLURM=1) fails without.
fn is_there() -> bool {
    let is_there = std::env::var_os("SLURM_CONF").is_some();
    let required = std::env::var("URTS_REQUIRE_SLURM").is_ok_and(|own| own == "1");
    assert!(is_there || !required, "SLURM_CONF names no configuration");
    if !is_there {
        println!("SKIPPED: tests/slurm starts a Slurm, whose configuration SLURM_CONF names");
    }
    is_there
}

/// What a command of Slurm prints.
fn slurm(place: &Place, words: &[&str]) -> String {
    let mut command = Command::new(words[0]);
    let output = command
        .args(&words[1..])
        .current_dir(place.0.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{words:?}: {said}");
    String::from_utf8(output.stdout).unwrap()
}

/// Waits until no job of these is queued or runs.
fn ended(place: &Place, jobs: &str) {
    let begin = Instant::now();
    loop {
        let left = slurm(
            place,
            &[
                "squeue",
                "--noheader",
                "--array",
                "--jobs",
                jobs,
                "--format=%i %r",
            ],
        );
        if left.trim().is_empty() {
            return;
        }
        let long = begin.elapsed() > Duration::from_secs(240);
        assert!(!long, "still there:\n{left}{}", logs(place.0.path()));
        std::thread::sleep(Duration::from_millis(300));
    }
}

/// What the jobs wrote.
fn logs(dir: &Path) -> String {
    let entries = std::fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let logs = entries.filter(|path| path.extension().is_some_and(|own| own == "log"));
    let texts = logs.map(|path| std::fs::read_to_string(path).unwrap_or_default());
    texts.collect()
}

#[test]
fn an_array_of_shards_of_which_one_is_killed_and_submitted_again_makes_the_run_of_one_process() {
    if !is_there() {
        return;
    }
    let place = place();
    assert_eq!(place.program(&run("whole", &[])).code, 0);
    let submit = [
        "submit",
        "c.toml",
        "--episodes",
        "4500",
        "--slurm",
        "8",
        "--backend",
        "cpu",
        "--threads",
        "1",
        "--out",
        "out",
        "--time",
        "10m",
    ];
    let script = place.succeeds(&submit);
    // A task that is killed as if its node went down: no word, and no second try by Slurm itself.
    let killed = script.replace(
        "code=0\n",
        "if [ \"$SLURM_ARRAY_TASK_ID\" -eq 4 ] && [ ! -e second ]; then kill -9 $$; fi\ncode=0\n",
    );
    assert_ne!(killed, script);
    place.write("submit.sh", &killed);
    let said = slurm(&place, &["sh", "submit.sh"]);
    let numbers: Vec<&str> = said
        .split(|c: char| !c.is_ascii_digit())
        .filter(|own| !own.is_empty())
        .collect();
    let [array, merge] = numbers[..] else {
        panic!("{said}");
    };
    ended(&place, array);
    // The merge waits for all to end well, which they did not.
    assert!(!place.path("out/manifest.json").exists());
    let missing = place.succeeds(&["status", "out", "--missing"]);
    assert_eq!(missing.trim(), "4");
    let _ = Command::new("scancel").arg(merge).status();
    place.write("second", "");
    let again = killed.replace("--array=1-8", &format!("--array={}", missing.trim()));
    place.write("again.sh", &again);
    let said = slurm(&place, &["sh", "again.sh"]);
    let numbers: Vec<&str> = said
        .split(|c: char| !c.is_ascii_digit())
        .filter(|own| !own.is_empty())
        .collect();
    ended(&place, &numbers.join(","));
    assert!(
        place.path("out/manifest.json").exists(),
        "{}",
        logs(place.0.path())
    );
    assert!(tables(&place, "out") == tables(&place, "whole"));
}

#[test]
fn a_task_that_runs_out_of_time_is_queued_again_and_goes_on() {
    if !is_there() {
        return;
    }
    let place = place();
    let submit = [
        "submit",
        "c.toml",
        "--episodes",
        "4500",
        "--set",
        "time.duration_s=100.0",
        "--slurm",
        "2",
        "--backend",
        "cpu",
        "--out",
        "out",
        "--time",
        "122s",
    ];
    // Two seconds of flight at a time, of which the margin for start and end leaves that much.
    let script = place.succeeds(&submit);
    assert!(script.contains("--max-time 2s"), "{script}");
    let script = script.replace("--max-time 2s", "--max-time 1s");
    place.write("submit.sh", &script);
    let said = slurm(&place, &["sh", "submit.sh"]);
    let numbers: Vec<&str> = said
        .split(|c: char| !c.is_ascii_digit())
        .filter(|own| !own.is_empty())
        .collect();
    ended(&place, &numbers.join(","));
    let logs = logs(place.0.path());
    assert!(
        logs.contains("the same command goes on with them"),
        "{logs}"
    );
    assert!(place.path("out/manifest.json").exists(), "{logs}");
    assert_eq!(
        place
            .program(&run("whole", &["--set", "time.duration_s=100.0"]))
            .code,
        0
    );
    assert!(tables(&place, "out") == tables(&place, "whole"));
}
