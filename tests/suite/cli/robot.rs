//! `urts-mc robot`: what was understood of a robot's file, and whether it can walk.

use super::Place;
use crate::common::repository;
use std::fs;

const G1: &str = "g1.toml";

/// A folder with the table of the G1.
fn place() -> Place {
    let place = Place::smoke(&[]);
    fs::copy(repository("campaigns/robots/g1_12dof.toml"), place.path(G1)).unwrap();
    place
}

#[test]
fn a_robot_is_shown_with_its_legs_its_pose_and_its_walk() {
    let place = place();
    let said = place.succeeds(&["robot", G1]);
    for words in [
        "g1_12dof: 12 joints, 32.11 kg",
        "left leg: 7.186 kg, reaches 0.6920 m from its hip",
        "l_hip_roll     (0.985, 0.000, 0.174)    -0.5236 .. 2.967  20.00  139.0",
        "right leg",
        "pelvis frame above the soles then, m       0.7930",
        "can be walked: 6 steps over 1.000 m in 8.200 s",
        "pelvis_height_m     0.7400",
    ] {
        assert!(said.contains(words), "{words}\n{said}");
    }
    let found: serde_json::Value =
        serde_json::from_str(&place.succeeds(&["robot", G1, "--json"])).unwrap();
    assert_eq!(found["legs"][1]["joints"][3]["name"], "r_knee");
    assert_eq!(found["walk"]["can_be_walked"], true);
    assert_eq!(found["walk"]["gait"]["step_length_m"], 0.2);
}

#[test]
fn a_gait_that_cannot_be_walked_is_answered_with_one_that_can() {
    let place = place();
    let high = "reference.gait.pelvis_height_m=0.8";
    let said = place.succeeds(&["robot", G1, "--set", high]);
    assert!(
        said.contains("cannot be walked: at 0.00 s no joint angles were found"),
        "{said}"
    );
    // What it proposes is written as it is set.
    let (_, proposed) = said
        .split_once("the nearest gait that can be walked has ")
        .unwrap();
    let (proposed, _) = proposed.split_once(" in [reference.gait]").unwrap();
    let mut arguments = vec![
        "robot".to_string(),
        G1.to_string(),
        "--set".into(),
        high.into(),
    ];
    for change in proposed.split(", ") {
        let (key, value) = change.split_once(" = ").unwrap();
        arguments.extend(["--set".to_string(), format!("reference.gait.{key}={value}")]);
    }
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    assert!(
        place
            .succeeds(&arguments)
            .contains("can be walked: 6 steps")
    );
    // What no gait can be is said with its key.
    let said = place.succeeds(&["robot", G1, "--set", "reference.gait.step_period_s=-1"]);
    assert!(
        said.contains("cannot be walked: reference.gait.step_period_s"),
        "{said}"
    );
}

#[test]
fn a_picture_of_the_legs_is_written_and_replaces_nothing_unasked() {
    let place = place();
    place.succeeds(&[
        "robot",
        G1,
        "--svg",
        "legs.svg",
        "--set",
        "agent.standing=bent",
    ]);
    let drawn = place.read("legs.svg");
    assert!(drawn.starts_with("<svg") && drawn.contains("knees bent, from the side"));
    let refused = place.program(&["robot", G1, "--svg", "legs.svg"]);
    assert_eq!(refused.code, 2);
    assert!(
        refused
            .stderr
            .contains("exists already; give another name, or --overwrite"),
        "{}",
        refused.stderr
    );
    place.succeeds(&["robot", G1, "--svg", "legs.svg", "--overwrite"]);
    assert_ne!(place.read("legs.svg"), drawn, "another pose is drawn");
}

#[test]
fn what_a_foreign_robot_is_called_commands_no_terminal() {
    let place = place();
    let named = place
        .read(G1)
        .replace("name = \"g1_12dof\"", "name = \"g1\\u001b[2J\\u202e\"");
    place.write(G1, named);
    let said = place.succeeds(&["robot", G1]);
    assert!(
        said.starts_with("g1\\u{1b}[2J\\u{202e}: 12 joints"),
        "{said:?}"
    );
}

#[test]
fn what_is_no_robot_and_what_no_robot_has_is_refused() {
    let place = place();
    for (arguments, words) in [
        (&["robot", "c.toml"][..], "unknown key"),
        (&["robot", "legs.txt"], "agent.robot"),
        (
            &["robot", G1, "--set", "agent.pelvis=hip"],
            "a joint table says this itself",
        ),
        (
            &["robot", G1, "--set", "agent.mass_kg=2.0"],
            "does not have it",
        ),
    ] {
        let refused = place.program(arguments);
        assert_eq!(refused.code, 2, "{arguments:?}");
        assert!(
            refused.stderr.contains(words),
            "{arguments:?}: {}",
            refused.stderr
        );
    }
}
