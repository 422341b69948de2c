//! Runs that end before they are done: what they flew is kept, and the same command goes on with it.

use super::Place;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Three parts, of which the last is short.
const EPISODES: &str = "2500";

/// The command of such a run.
fn run<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let begin = ["run", "c.toml", "--out", out, "--quiet"].into_iter();
    let all = begin.chain(more.iter().copied());
    match more.contains(&"--episodes") {
        true => all.collect(),
        false => all.chain(["--episodes", EPISODES]).collect(),
    }
}

/// One UAV over half a second: parts of 1,024 episodes that take a fraction of a second each.
const CAMPAIGN: &str = r#"
name = "short"
seed = 5
episodes = 8
controllers = ["ftc", "pid"]

[time]
duration_s = 0.5
step_s = 0.001
settle_s = 0.1

[agent]
kind = "uav"
team = 1

[reference]
kind = "sinusoid"
amplitude = [2.0, 1.5, 1.0, 0.1, 0.1, 0.3]
frequency_rad_s = [0.4, 0.5, 0.3, 0.5, 0.4, 0.2]

[[reference.agents]]
center = [0.0, 0.0, 4.0, 0.0, 0.0, 0.0]
phase_rad = [0.3, 0.7, 1.1, 0.2, 0.4, 0.6]

[synthesis]
preset = "uav-paper"

[initial]
error = { normal = { mean = 0.0, std = 0.1 } }

[[disturbance]]
kind = "sine"
amplitude = { uniform = [0.5, 1.5] }
frequency_rad_s = { uniform = [1.0, 5.0] }
phase_rad = { uniform = [0.0, 6.283185307179586] }
"#;

pub(super) fn place() -> Place {
    Place::with(CAMPAIGN)
}

/// The tables and the gains of a run.
pub(super) fn tables(place: &Place, run: &str) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(place.path(run)).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let is_table = |name: &String| {
        [".parquet", ".csv", "gains.json"]
            .iter()
            .any(|end| name.ends_with(end))
    };
    let mut names: Vec<String> = names.filter(is_table).collect();
    names.sort();
    assert!(names.len() > 10, "{names:?}");
    let of = |name: String| {
        let bytes = place.read_bytes(&format!("{run}/{name}"));
        (name, bytes)
    };
    names.into_iter().map(of).collect()
}

/// Runs to the end, whatever is there.
fn goes_on(place: &Place, out: &str) -> String {
    let ended = place.program(&run(out, &[]));
    assert_eq!(
        (ended.code, ended.stdout.as_str()),
        (0, ""),
        "{}",
        ended.stderr
    );
    ended.stderr
}

/// Sends a signal by its name.
fn signal(child: &Child, name: &str) {
    let number = child.id().to_string();
    let sent = Command::new("kill").args(["-s", name, &number]).status();
    assert!(sent.unwrap().success());
}

/// Waits until something is so, while a process goes on.
pub(super) fn until(flying: &mut Child, what: &dyn Fn() -> bool) {
    while !what() {
        assert!(flying.try_wait().unwrap().is_none(), "it has ended");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Whether a file of the parts of a run is there.
fn part(place: &Place, out: &str, number: u32) -> bool {
    place
        .path(&format!("{out}/.urts-mc-parts/part-{number:08}"))
        .exists()
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_that_is_killed_anywhere_is_gone_on_with_and_ends_as_one_that_was_not() {
    let place = place();
    let begin = Instant::now();
    goes_on(&place, "whole");
    let whole_s = begin.elapsed().as_secs_f64();
    let whole = tables(&place, "whole");
    // Of every third, a shorter run is there before.
    for instant in 0..10 {
        let out = format!("killed-{instant}");
        let over = instant % 3 == 0;
        if over {
            let ended = place.program(&run(&out, &["--episodes", "40"]));
            assert_eq!(ended.code, 0, "{}", ended.stderr);
        }
        let mut flying = place.command(&run(&out, &[])).spawn().unwrap();
        // Golden ratios: spread over the whole, and in no order.
        let share = (0.618_033_988_749_895 * f64::from(instant)).fract();
        std::thread::sleep(Duration::from_secs_f64(share * whole_s));
        let _ = flying.kill();
        flying.wait().unwrap();
        // An earlier run is whole at any time: a report is made of all its files.
        if over {
            let report = place.program(&["report", &out]);
            assert_eq!(report.code, 0, "{}", report.stderr);
        }
        goes_on(&place, &out);
        assert!(tables(&place, &out) == whole, "killed after {share} of it");
        assert!(!place.path(&format!("{out}/.urts-mc-parts")).exists());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_signal_ends_a_run_with_what_it_flew_and_the_same_command_goes_on() {
    let place = place();
    let endless = ["--episodes", "1000000"];
    for (name, out) in [("INT", "int"), ("TERM", "term"), ("USR1", "usr1")] {
        let mut command = place.command(&run(out, &endless));
        let mut flying = command.stderr(Stdio::piped()).spawn().unwrap();
        until(&mut flying, &|| part(&place, out, 0));
        signal(&flying, name);
        let ended = flying.wait_with_output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(5), "{name}: {said}");
        let words = format!("of 1000000 episodes are kept in {out}; the same command goes on");
        assert!(
            said.starts_with("partial: ") && said.contains(&words),
            "{said}"
        );
        assert!(!place.path(&format!("{out}/.urts-mc-lock")).exists());
    }
    // What was flown of a longer run is the beginning of a shorter one.
    let status = place.program(&["status", "int", "--json"]).stdout;
    let status: serde_json::Value = serde_json::from_str(&status).unwrap();
    assert!(status["kept"].as_u64().unwrap() >= 1024);
    goes_on(&place, "int");
    goes_on(&place, "whole");
    assert!(tables(&place, "int") == tables(&place, "whole"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_second_signal_ends_a_run_at_once() {
    let place = place();
    let mut flying = place
        .command(&run("out", &["--episodes", "1000000"]))
        .spawn()
        .unwrap();
    until(&mut flying, &|| part(&place, "out", 0));
    // Before the batch at hand has ended.
    signal(&flying, "INT");
    signal(&flying, "INT");
    let code = flying.wait().unwrap().code();
    // Both are one to a process that has not seen the first yet.
    assert!([Some(130), Some(5)].contains(&code), "{code:?}");
    assert!(part(&place, "out", 0));
}

#[test]
fn a_run_ends_after_the_time_that_it_has_and_says_what_is_kept() {
    let place = place();
    let ended = place.program(&run("out", &["--episodes", "1000000", "--max-time", "3s"]));
    assert_eq!(
        (ended.code, ended.stdout.as_str()),
        (5, ""),
        "{}",
        ended.stderr
    );
    let said = place.program(&["status", "out"]);
    assert_eq!(said.code, 5, "{}", said.stderr);
    for words in [
        "of 1000000 episodes are kept",
        "a process simulates",
        "the command that began it goes on",
    ] {
        assert!(
            said.stdout.contains(words),
            "{words:?} is missing from {}",
            said.stdout
        );
    }
    place.refuses(&run("out", &["--max-time", "soon"]), 2, &["3h50m"]);
    goes_on(&place, "out");
    let said = place.succeeds(&["status", "out"]);
    assert!(said.contains("the run is whole"), "{said}");
}

#[test]
fn parts_of_another_run_are_refused_by_what_differs_and_begun_anew_where_that_is_asked_for() {
    let place = place();
    let ended = place.program(&run("out", &["--episodes", "1000000", "--max-time", "3s"]));
    assert_eq!(ended.code, 5, "{}", ended.stderr);
    let keeps = "out: keeps the episodes of an unfinished run: ";
    for (more, what) in [
        (&["--seed", "6"][..], "seed 5"),
        (
            &["--set", "disturbance.0.amplitude=1.0"],
            "this campaign with other settings",
        ),
        (&["--precision", "f64"], "precision f32"),
        (&["--simd", "scalar"], "not urts-mc"),
    ] {
        let words = [keeps, what, "--restart"];
        place.refuses(&run("out", more), 2, &words);
    }
    // Both may stand in one run, which says so: of the first part, what was flown so far goes on.
    for part in 1..200 {
        let _ = std::fs::remove_file(place.path(&format!("out/.urts-mc-parts/part-{part:08}")));
    }
    let more = ["--simd", "scalar", "--allow-mixed", "--episodes", "1200"];
    let ended = place.program(&run("out", &more));
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    let manifest: serde_json::Value =
        serde_json::from_str(&place.read("out/manifest.json")).unwrap();
    let legs = manifest["legs"].as_array().unwrap();
    let simd: Vec<&str> = legs
        .iter()
        .map(|leg| leg["simd"].as_str().unwrap())
        .collect();
    if place.json(&["devices", "--json"]).is_array() && simd.len() == 2 {
        assert_eq!(simd[1], "scalar");
        let episodes: u64 = legs
            .iter()
            .map(|leg| leg["episodes"].as_u64().unwrap())
            .sum();
        assert_eq!(episodes, 1200);
    }
    // Another campaign begins anew where it is told to.
    let ended = place.program(&run("anew", &["--episodes", "1000000", "--max-time", "3s"]));
    assert_eq!(ended.code, 5, "{}", ended.stderr);
    let ended = place.program(&run("anew", &["--seed", "6", "--restart"]));
    assert_eq!((ended.code, ended.stderr.as_str()), (0, ""));
    let ended = place.program(&run("fresh", &["--seed", "6"]));
    assert_eq!(ended.code, 0);
    assert!(tables(&place, "anew") == tables(&place, "fresh"));
}

#[test]
fn a_part_that_was_changed_is_named_and_its_episodes_are_simulated_again() {
    let place = place();
    goes_on(&place, "whole");
    let ended = place.program(&run("out", &["--episodes", "1000000", "--max-time", "3s"]));
    assert_eq!(ended.code, 5, "{}", ended.stderr);
    let name = "out/.urts-mc-parts/part-00000000";
    let whole = place.read_bytes(name);
    for (change, reason) in [
        (whole.len() / 2, "its content was changed"),
        (20, "its content was changed"),
        (0, "it is no part of a run of this version"),
    ] {
        let mut changed = whole.clone();
        changed[change] ^= 1;
        place.write(name, changed);
        let said = place.program(&run("out", &["--episodes", "64"])).stderr;
        assert!(said.is_empty(), "{said}");
        let notes = place.read("out/manifest.json");
        let note = format!(
            "part-00000000 is left out ({reason}); its episodes have to be simulated again"
        );
        assert!(notes.contains(&note), "{notes}");
        // What the run of 64 episodes left is one whole run; the parts are gone.
        let ended = place.program(&run(
            "out",
            &["--overwrite", "--episodes", "1000000", "--max-time", "3s"],
        ));
        assert_eq!(ended.code, 5, "{}", ended.stderr);
    }
    goes_on(&place, "out");
    assert!(tables(&place, "out") == tables(&place, "whole"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_up_keeps_what_was_flown_says_how_much_is_needed_and_is_gone_on_with() {
    let place = place();
    goes_on(&place, "whole");
    let whole = tables(&place, "whole");
    // Files above these sizes are refused, as on a full disk: a part, then one of the tables.
    for (kilobytes, kept) in [(40, None), (1300, Some("2500"))] {
        let words = run("out", &["--backend", "cpu"]);
        let words: Vec<String> = words.iter().map(|word| format!("'{word}'")).collect();
        let line = format!(
            "trap '' XFSZ; ulimit -f {kilobytes}; exec \"$0\" {}",
            words.join(" ")
        );
        let ended = Command::new("bash")
            .current_dir(place.0.path())
            .args(["-c", &line, env!("CARGO_BIN_EXE_urts-mc")])
            .output()
            .unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(1), "{said}");
        assert!(said.contains("cannot be written (File too large"), "{said}");
        if let Some(kept) = kept {
            let words = format!("; {kept} of 2500 episodes are kept in out: make room, about ");
            assert!(said.contains(&words), "{said}");
            assert!(
                said.contains(" in all, and the same command goes on"),
                "{said}"
            );
        }
    }
    let said = goes_on(&place, "out");
    assert_eq!(said, "");
    assert!(tables(&place, "out") == whole);
}

#[cfg(unix)]
#[test]
fn a_link_in_the_place_of_the_parts_is_followed_by_nobody() {
    let place = place();
    std::fs::create_dir(place.path("out")).unwrap();
    std::fs::create_dir(place.path("victim")).unwrap();
    place.write("victim/part-00000000", "mine");
    let link = place.path("out/.urts-mc-parts");
    std::os::unix::fs::symlink(place.path("victim"), link).unwrap();
    for more in [&[][..], &["--restart"], &["--overwrite"]] {
        let ended = place.program(&run("out", more));
        assert_eq!(ended.code, 2, "{}", ended.stderr);
        assert!(
            ended.stderr.contains(".urts-mc-parts: cannot be written"),
            "{}",
            ended.stderr
        );
        assert_eq!(place.read("victim/part-00000000"), "mine");
    }
}

#[test]
fn a_run_that_may_stop_early_stops_at_the_same_episode_when_it_is_gone_on_with() {
    let place = place();
    let text = place.read("c.toml")
        + "\n[stop]\ncontroller = \"pid\"\nfailure_rate_below = 0.0021\nevery = 100\n";
    place.write("c.toml", text);
    goes_on(&place, "whole");
    let manifest: serde_json::Value =
        serde_json::from_str(&place.read("whole/manifest.json")).unwrap();
    let episodes = manifest["episodes"].as_u64().unwrap();
    assert!((1100..2500).contains(&episodes), "{episodes}");
    let ended = place.program(&run("out", &["--max-time", "3s"]));
    assert!([0, 5].contains(&ended.code), "{}", ended.stderr);
    goes_on(&place, "out");
    assert!(tables(&place, "out") == tables(&place, "whole"));
}
