//! Campaigns of bipeds as their user meets them.

use super::Place;
use super::campaign_files::all_refused_of;
use crate::common::repository;
use std::fs;

/// A short campaign of a biped with parts of its text replaced; each part must be there.
fn walk(changes: &[(&str, &str)]) -> String {
    let path = repository("campaigns/biped-ground-reaction.toml");
    let mut text = fs::read_to_string(path).unwrap();
    let shorter = [
        ("episodes = 512", "episodes = 3"),
        ("duration_s = 9.0", "duration_s = 2.0"),
    ];
    for (old, new) in shorter.iter().chain(changes) {
        assert!(text.contains(old), "the campaign does not contain {old:?}");
        text = text.replace(old, new);
    }
    text
}

const POINTS: &str = "points_m = [[0.0, 0.0], [1.0, 0.0]]";

#[test]
fn what_a_biped_does_not_have_is_refused() {
    all_refused_of(
        walk,
        r#"
"limited"         => "thrust"            :: agent.actuation (line 15) = "thrust": a biped's joints have torques; use "full", or "limited"
"limited"         => "full"\nmass_kg = 3.0 :: agent.mass_kg (line 16) ~ "biped" does not have it; remove it
"limited"         => "full"\ninertia_scale = 1.0 :: agent.inertia_scale (line 16) ~ "biped" does not have it; remove it
kind = "biped"    => kind = "uav"        :: agent.actuation (line 15) = "limited": a UAV is actuated in "full" or by "thrust"
kind = "biped"    => kind = "uav"\nrobot = "g1.toml" :: agent.robot (line 15) ~ "uav" does not have it
"biped-paper"     => "uav-paper"         :: synthesis.preset (line 23) = "uav-paper": the presets of robots are "biped-paper"; did you mean
"biped-paper"     => "biped-paper"\nposition.rho = 30.0 :: synthesis.position (line 24) ~ does not have it; remove it
"biped-paper"     => "biped-paper"\njoints.rho = -30.0 :: synthesis.joints.rho (line 24) = -30: must be above 0
kind = "ground-reaction" => kind = "ground-reaction"\namplitude = 1.0 :: disturbance[0].amplitude (line 30) = 1.0 ~ no such parameter ~ scale
kind = "bias"     => kind = "bias"\nchannels = [13] :: fault[0].channels (line 35) = [13] ~ from 1 to 12: 1 l_hip_pitch, 2 l_hip_roll, ~ 12 r_ankle_roll
error = { normal = { mean = 0.0, std = 0.001 } } => error = [0.0, 0.0] :: initial.error (line 26) = a list of 2 ~ each of the 12 channels
"#,
    );
}

#[test]
fn a_walk_that_cannot_be_is_refused_with_what_is_in_its_way() {
    all_refused_of(
        walk,
        r#"
kind = "walk"     => kind = "waypoints"  :: reference.kind (line 19) = "waypoints" ~ a UAV's; use "walk"
kind = "walk"     => kind = "sinusoid"   :: reference.points_m (line 20) ~ "sinusoid" does not have it
points_m = [[0.0, 0.0], [1.0, 0.0]] =>   :: reference.points_m (line 18) = absent ~ add it
[[0.0, 0.0], [1.0, 0.0]] => [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]] :: reference.points_m[0] (line 20) = [0.0, 0.0, 0.0]: a point of this kind has 2 coordinates
[[0.0, 0.0], [1.0, 0.0]] => [[0.0, 0.0], [0.1, 0.0]] :: reference.points_m (line 20) ~ shorter than one step of 0.2 m; move its end or shorten the step
[[0.0, 0.0], [1.0, 0.0]] => [[0.0, 0.0]] :: reference.points_m (line 20) = [[0.0, 0.0]] ~ needs at least 2; add
[[0.0, 0.0], [1.0, 0.0]] => [[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]] :: at waypoint 1 the line turns by 180 degrees ~ spread the turn
[synthesis]       => [reference.gait]\nstep_length_m = 0.6\n[synthesis] :: at 1.86 s no joint angles were found that put the right ankle ~ 0.662 m from the hip: ~ up to 0.65 ~ the nearest gait that can be walked has step_length_m = 0.48, step_height_m = 0.04 in [reference.gait]
[synthesis]       => [reference.gait]\npelvis_height_m = 0.8\n[synthesis] :: at 0.00 s no joint angles were found that put the left ankle ~ up to 0.65 ~ the nearest gait that can be walked has pelvis_height_m = 0.769 in [reference.gait]
[synthesis]       => [reference.gait]\nstep_period_s = -1\n[synthesis] :: reference.gait.step_period_s (line 23) = -1.0: must lie between 0.001 and 100
[synthesis]       => [reference.gait]\nstep_heigth_m = 0.1\n[synthesis] :: unknown key `step_heigth_m` ~ did you mean `step_height_m`?
[synthesis]       => [reference.gait]\nfirst_foot = "both"\n[synthesis] :: unknown value `both` ~ `left` or `right`
[synthesis]       => [reference.gait]\ncom_offset_m = [0.0, 0.0, -1.0]\n[synthesis] :: reference.gait.com_offset_m (line 23) = -1.0 ~ centre of mass in the pelvis frame
[1.0, 0.0]]       => [1.0, 0.0]]\nstart_s = inf :: reference.start_s (line 21) = inf: must be finite
[1.0, 0.0]]       => [1.0, 0.0]]\nstep_m = 1.0 :: reference.step_m (line 21) ~ "walk" does not have it
[1.0, 0.0]]       => [1.0, 0.0]]\n[[reference.agents]]\ncenter = 1.0 :: reference.agents[0].center (line 22) ~ "walk" does not have it
[1.0, 0.0]]       => [1.0, 0.0]]\n[[reference.agents]]\n[[reference.agents]] :: reference.agents (line 21) = 2 blocks ~ each of the 1 agents
"#,
    );
    // Without a walk there is no ground to answer it.
    all_refused_of(
        |changes| {
            let standing = [("kind = \"walk\"", "kind = \"sinusoid\""), (POINTS, "")];
            walk(&[&standing, changes].concat())
        },
        "seed = 11 => seed = 12 :: disturbance[0].kind (line 29) = \"ground-reaction\": a ground reaction needs a walking reference; set reference.kind",
    );
}

#[test]
fn a_robot_file_that_is_none_is_refused_with_its_own_name_and_what_is_wrong_in_it() {
    let table = fs::read_to_string(repository("campaigns/robots/g1_12dof.toml")).unwrap();
    for (name, text, words) in [
        (
            "robot.toml",
            table.replacen("[[joint]]", "[[jiont]]", 1),
            "unknown",
        ),
        (
            "heavy.toml",
            table.replacen("mass = ", "mass = -", 1),
            "pelvis",
        ),
    ] {
        let robot = format!("actuation = \"limited\"\nrobot = \"{name}\"");
        let place = Place::with(&walk(&[("actuation = \"limited\"", &robot)]));
        place.write(name, text);
        let said = place.refuses(&["check", "c.toml"], 2, &[words]);
        assert!(said.starts_with(&format!("error: {name}: ")), "{said}");
    }
    // Where there is no such file, the key that names it is to be corrected.
    for (name, words) in [
        (
            "robots/nobody.toml",
            "cannot be read (No such file or directory (os error 2)); name an existing robot file, relative to the campaign",
        ),
        (
            "robot.yaml",
            "a robot file ends in .toml (joint table) or .urdf; rename it or name another",
        ),
    ] {
        let robot = format!("actuation = \"limited\"\nrobot = \"{name}\"");
        let place = Place::with(&walk(&[("actuation = \"limited\"", &robot)]));
        let words = format!("error: c.toml: agent.robot (line 16) = \"{name}\": {words}");
        place.refuses(&["check", "c.toml"], 2, &[&words]);
    }
}

#[test]
fn a_run_of_robots_is_replayed_without_the_robots_file() {
    let robot = ("actuation", "robot = \"own.toml\"\nactuation");
    let place = Place::with(&walk(&[robot]));
    let table = fs::read_to_string(repository("campaigns/robots/g1_12dof.toml")).unwrap();
    place.write("own.toml", &table);
    // It has not gone far in 2 s, which is said before the simulation.
    let ended = place.program(&["run", "c.toml", "--out", "out", "--csv", "--verbose"]);
    let note = "the episode 2 s; its end is not reached\n";
    assert!(ended.stderr.ends_with(note), "{}", ended.stderr);
    assert_eq!((ended.code, ended.stderr.lines().count()), (0, 1));
    let said = ended.stdout;
    for words in ["x 1 robot,", "joints, rad", "10 more channels"] {
        assert!(said.contains(words), "{words:?} is missing from: {said}");
    }
    let rows = place.rows("out/channels.csv");
    assert_eq!(rows.len(), 3 * 3 * 12);
    let row = &rows[12 + 9];
    assert_eq!(
        (row["episode"].as_str(), row["channel"].as_str()),
        ("0", "r_knee")
    );
    let episodes = place.rows("out/episodes.csv");
    assert!(episodes[0].contains_key("rmse_joints") && !episodes[0].contains_key("inertia_scale"));
    assert!(episodes[0].contains_key("disturbance0_scale_l_knee"));

    fs::remove_file(place.path("own.toml")).unwrap();
    let replay = ["replay", "out", "--episode", "0", "--controller", "pid"];
    let said = place.succeeds(&replay);
    let number = |text: &str| text.parse::<f64>().unwrap();
    let line = said.lines().find(|line| line.contains("r_knee")).unwrap();
    let shown: Vec<f64> = line.split_whitespace().skip(2).map(number).collect();
    // To the four digits that are shown.
    assert!((shown[0] / number(&row["rmse"]) - 1.0).abs() < 6e-4);
    assert!((shown[1] / number(&row["max_abs"]) - 1.0).abs() < 6e-4);
    assert!(shown[0] > 1e-4, "{line}");
    // The run itself needs the file.
    place.refuses(
        &["check", "c.toml"],
        2,
        &["agent.robot", "\"own.toml\": cannot be read"],
    );
}
