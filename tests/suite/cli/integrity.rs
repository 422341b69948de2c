//! A run whose files were changed is not read, and one whose campaign names other files is not replaced.

use super::Place;
use crate::common::{repository, without_hash};
use std::fs;
use std::process::Command;
use urts_mc::run::directory::OutputDir;

#[test]
fn a_changed_or_missing_file_is_named_and_nothing_is_made_of_it() {
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--out", "out"]);
    place.succeeds(&["run", "c.toml", "--out", "same"]);
    let commands = [
        vec!["report", "out"],
        vec!["replay", "out", "--episode", "0"],
        vec!["compare", "same", "out"],
    ];
    let whole = place.read_bytes("out/channels.parquet");
    // A single bit, in the middle of the file: Parquet would read another number there, or fall over it.
    let mut flipped = whole.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    let mut longer = whole.clone();
    longer.push(0);
    for (content, words) in [
        (Some(flipped), "its content was changed"),
        (Some(longer), "bytes, the run wrote "),
        (None, "No such file"),
    ] {
        let path = place.path("out/channels.parquet");
        match content {
            Some(content) => fs::write(&path, content).unwrap(),
            None => fs::remove_file(&path).unwrap(),
        }
        for command in &commands {
            let said = place.program(command);
            assert_eq!(said.code, 2, "{command:?}: {}", said.stderr);
            for word in [
                "error: out/channels.parquet: is not the file that the run wrote (",
                words,
            ] {
                assert!(said.stderr.contains(word), "{command:?}: {}", said.stderr);
            }
        }
    }
    place.write("out/channels.parquet", whole);
    for command in &commands {
        assert_eq!(place.program(command).code, 0, "{command:?}");
    }
    // Nor is the campaign another one than that which was run.
    let manifest = place.read("out/manifest.json");
    let edited = manifest.replace("max_rmse = 1.0", "max_rmse = 0.9");
    assert_ne!(edited, manifest);
    place.write("out/manifest.json", edited);
    for command in &commands {
        let said = place.program(command);
        assert_eq!(said.code, 2, "{command:?}: {}", said.stderr);
        assert!(
            said.stderr.contains("out/manifest.json: is not the file that the run wrote (the campaign in it was changed)"),
            "{command:?}: {}",
            said.stderr
        );
    }
    // Any other bit of it.
    let bytes = manifest.clone().into_bytes();
    let (mut changed, mut other) = (0, 0);
    for place_in_file in (0..bytes.len()).step_by(bytes.len() / 60) {
        let mut flipped = bytes.clone();
        flipped[place_in_file] ^= 1;
        place.write("out/manifest.json", flipped);
        let said = place.program(&commands[0]);
        assert_eq!(said.code, 2, "{place_in_file}: {}", said.stderr);
        let own = said
            .stderr
            .contains("out/manifest.json: is not the file that the run wrote");
        (changed, other) = (changed + usize::from(own), other + usize::from(!own));
        assert!(
            own || said.stderr.contains("manifest.json"),
            "{}",
            said.stderr
        );
    }
    // Some are no JSON any more, or no manifest.
    assert!(changed > 30 && other > 0, "{changed} {other}");
    place.write("out/manifest.json", manifest);
    // What is made of the tables may be changed: CSV files are for other programs.
    place.write("out/summary.csv", "mine");
    place.succeeds(&["report", "out"]);
}

#[test]
fn a_run_with_another_robot_or_other_gains_does_not_replace_the_earlier_one() {
    let robot = fs::read_to_string(repository("campaigns/robots/g1_12dof.toml")).unwrap();
    let walk = fs::read_to_string(repository("campaigns/biped-ground-reaction.toml")).unwrap();
    let walk = walk.replace("[agent]", "[agent]\nrobot = \"robot.toml\"");
    let place = Place::with(&walk);
    place.write("robot.toml", &robot);
    let run = [
        "run",
        "c.toml",
        "--episodes",
        "2",
        "--out",
        "out",
        "--quiet",
    ];
    assert_eq!(place.program(&run).code, 0);
    assert_eq!(place.program(&run).code, 0);
    // A comment is another file: what it says is nobody's to judge but its writer's.
    place.write("robot.toml", format!("{robot}\n# heavier\n"));
    let refused = place.program(&run);
    assert_eq!(refused.code, 2);
    assert!(
        refused.stderr.contains(
            "out: holds a run of this campaign with another robot.toml; give another directory"
        ),
        "{}",
        refused.stderr
    );
    assert_eq!(
        place.program(&[&run[..], &["--overwrite"]].concat()).code,
        0
    );

    let gains = fs::read_to_string(repository("tests/golden/gains-uav-paper.json")).unwrap();
    let named = "[synthesis.named.own]\ngains = \"own.json\"\ncontroller = \"pid\"\n[verdict]";
    let place = Place::smoke(&[
        ("[verdict]", named),
        ("[\"ftc\", \"pid\", \"pid-tuned\"]", "[\"ftc\", \"own\"]"),
    ]);
    place.write("own.json", &gains);
    let run = ["run", "c.toml", "--out", "out", "--quiet"];
    assert_eq!(place.program(&run).code, 0);
    place.write("own.json", format!("{gains}\n"));
    let refused = place.program(&run);
    assert!(
        refused
            .stderr
            .contains("a run of this campaign with another own.json"),
        "{}",
        refused.stderr
    );
}

#[test]
fn an_episode_that_is_not_the_one_of_the_runs_tables_is_shown_with_a_word_about_it() {
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--out", "out"]);
    place.succeeds(&["run", "c.toml", "--out", "other", "--seed", "7"]);
    let replay = ["replay", "out", "--episode", "1", "--json"];
    assert!(place.json(&replay)["differs"].is_null());
    // Runs of older versions have no hashes of their files, so that only the numbers tell.
    let manifest = without_hash(&place.read("out/manifest.json"));
    let mut manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    manifest["files"] = serde_json::json!({});
    place.write("out/manifest.json", manifest.to_string());
    assert!(place.json(&replay)["differs"].is_null());
    place.write(
        "out/channels.parquet",
        place.read_bytes("other/channels.parquet"),
    );
    let said = place.json(&replay)["differs"].to_string();
    assert!(said.contains("channels.parquet has rmse = "), "{said}");
    place.write(
        "out/episodes.parquet",
        place.read_bytes("other/episodes.parquet"),
    );
    let said = place.succeeds(&["replay", "out", "--episode", "1"]);
    // The first that differs is one of the PID's.
    let [table, agent] = [
        "is not the episode of the run: episodes.parquet has ",
        " (agent 0 under pid)",
    ];
    assert!(said.contains(table) && said.contains(agent), "{said}");
    let page = place.read("out/replay-1-ftc.html");
    assert!(page.contains("This is not the episode of the run"));
}

#[test]
fn a_run_that_is_being_replaced_is_neither_reported_nor_replayed() {
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--out", "out"]);
    let campaign = urts_mc::campaign::Campaign::load(&place.path("c.toml")).unwrap();
    let held = OutputDir::claim(&place.path("out"), &campaign, false).unwrap();
    for command in [
        &["report", "out"][..],
        &["replay", "out", "--episode", "0"],
        &["replay", "out", "--episode", "0", "--out", "there.parquet"],
    ] {
        place.refuses(command, 2, &["out: is being written by process "]);
    }
    drop(held);
    place.succeeds(&["report", "out"]);
    place.succeeds(&["replay", "out", "--episode", "0"]);
    // Nothing is made of what is no run, not even a lock.
    place.refuses(&["report", "absent"], 2, &["absent: holds no readable run"]);
}

#[cfg(target_os = "linux")]
#[test]
fn what_a_limit_of_the_address_space_does_not_hold_is_refused_before_work_begins() {
    let place = Place::smoke(&[]);
    let program = env!("CARGO_BIN_EXE_urts-mc");
    let limited = |kib: u32, episodes: &str| {
        let command =
            format!("ulimit -v {kib} && exec {program} check c.toml --episodes {episodes}");
        let mut shell = Command::new("sh");
        let ended = shell
            .args(["-c", &command])
            .current_dir(place.path(""))
            .output();
        let ended = ended.unwrap();
        (
            ended.status.code(),
            String::from_utf8(ended.stderr).unwrap(),
        )
    };
    // As much as many cores may take beside what episodes take.
    let (wide, narrow) = (64 << 20, 900 << 10);
    assert_eq!(limited(wide, "3"), (Some(0), String::new()));
    let (code, said) = limited(narrow, "5000000");
    assert_eq!(code, Some(2), "{said}");
    for word in [
        "--episodes = 5000000: their statistics take about ",
        " of memory, and ",
        "give ",
    ] {
        assert!(said.contains(word), "{said}");
    }
}
