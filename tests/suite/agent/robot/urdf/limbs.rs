//! Robots of real people: arms, a waist and a head, a frame on the ground, and what a file says beside the legs.

use super::{parse, written};
use crate::agent::robot::load;
use nalgebra::Isometry3;
use urts_mc::agent::robot::{Robot, UrdfOptions};

fn plain() -> String {
    written(&load("g1_12dof"), &Isometry3::identity())
}

fn read(text: &str) -> Robot {
    parse(text, &UrdfOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A link of a kilogram on a revolute joint above another link.
fn limb(name: &str, parent: &str) -> String {
    format!(
        r#"<link name="{name}_link"><inertial><origin xyz="0 0 0.1"/><mass value="1"/>
        <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
        <joint name="{name}" type="revolute"><origin xyz="0 0 0.2"/><parent link="{parent}"/><child link="{name}_link"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>"#
    )
}

/// Arms of six joints are no legs: their ends are higher.
fn with_upper_body() -> String {
    let mut limbs = limb("waist", "pelvis") + &limb("head", "waist_link");
    for side in ["l", "r"] {
        let mut parent = "waist_link".to_string();
        for k in 0..6 {
            let name = format!("{side}_arm{k}");
            limbs += &limb(&name, &parent);
            parent = format!("{name}_link");
        }
    }
    plain().replace("</robot>", &format!("{limbs}</robot>"))
}

#[test]
fn what_hangs_on_the_trunk_is_held_still_and_is_part_of_it() {
    let robot = read(&with_upper_body());
    let held = &robot.notes[0];
    assert!(
        held.starts_with("14 joints outside the legs are held at zero, and what hangs there is part of the pelvis: waist, head"),
        "{held}"
    );
    // The same as when somebody locks them by name.
    let mut locked = vec!["waist".to_string(), "head".to_string()];
    locked.extend(
        ["l", "r"]
            .iter()
            .flat_map(|side| (0..6).map(move |k| format!("{side}_arm{k}"))),
    );
    let named = UrdfOptions {
        locked,
        ..UrdfOptions::default()
    };
    let by_name = parse(&with_upper_body(), &named).unwrap();
    assert_eq!((&robot.legs, &robot.base), (&by_name.legs, &by_name.base));
    assert!(by_name.notes.iter().all(|note| !note.contains("held")));
    let alone = read(&plain());
    assert_eq!(robot.legs, alone.legs);
    // Fourteen limbs of a kilogram.
    assert!((robot.mass_kg() - alone.mass_kg() - 14.0).abs() < 1e-12);
}

#[test]
fn what_drives_a_joint_that_is_held_still_stops_nothing_and_is_not_spoken_of() {
    let whole = with_upper_body();
    let own = r#"<limit lower="-1" upper="1" effort="1" velocity="1"/>"#;
    let notes = read(&whole).notes;
    for other in [
        "",
        r#"<limit lower="-1" upper="1"/>"#,
        r#"<limit effort="many" velocity="fast"/>"#,
        r#"<limit effort="0" velocity="0"/><dynamics damping="x" friction="0.5" armature="1"/>"#,
    ] {
        let robot = read(&whole.replace(own, other));
        assert_eq!(robot, read(&whole), "{other}");
        assert_eq!(robot.notes, notes, "{other}");
    }
}

#[test]
fn the_pelvis_is_found_below_a_torso_that_carries_it() {
    let torso = r#"<link name="torso"><inertial><mass value="5"/>
        <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
        <joint name="waist" type="revolute"><origin xyz="0 0 -0.1"/><parent link="torso"/><child link="pelvis"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"#;
    let robot = read(&plain().replace("</robot>", torso));
    assert_eq!(robot.legs, read(&plain()).legs);
    assert!(
        robot.notes[0].starts_with("1 joint outside the legs is held at zero"),
        "{:?}",
        robot.notes
    );
    assert!((robot.mass_kg() - read(&plain()).mass_kg() - 5.0).abs() < 1e-12);
}

#[test]
fn a_root_frame_on_the_ground_is_no_pelvis() {
    let ground = r#"<link name="base_footprint"/><joint name="up" type="fixed"><origin xyz="0.1 0 0.9"/>
        <parent link="base_footprint"/><child link="pelvis"/></joint></robot>"#;
    let robot = read(&plain().replace("</robot>", ground));
    let alone = read(&plain());
    assert_eq!(
        (&robot.legs, robot.base_height_m),
        (&alone.legs, alone.base_height_m)
    );
    let said = "the root frame lies on the ground; the pelvis is pelvis, which carries the legs";
    assert!(
        robot.notes.iter().any(|note| note == said),
        "{:?}",
        robot.notes
    );
}

#[test]
fn armature_is_read_and_what_is_assumed_or_left_out_is_said() {
    let said = |text: &str| read(text).notes.join("\n");
    assert!(
        said(&plain()).contains("0.01 kg m^2 is assumed of each"),
        "{}",
        said(&plain())
    );
    let dynamics =
        r#"<parent link="pelvis"/><dynamics damping="0.1" friction="0.2" armature="0.037"/>"#;
    let text = plain().replace(r#"<parent link="pelvis"/>"#, dynamics);
    let robot = read(&text);
    for leg in &robot.legs {
        assert_eq!(
            (leg.joints[0].armature_kg_m2, leg.joints[0].damping_n_m_s),
            (0.037, 0.1)
        );
        assert_eq!(leg.joints[1].armature_kg_m2, 0.01);
    }
    // Of the ten others it is assumed still.
    let notes = said(&text);
    let assumed = "the inertia of the rotor is not said of l_hip_roll, l_hip_yaw";
    assert!(notes.contains(assumed), "{notes}");
    assert!(!notes.contains("l_hip_pitch, "), "{notes}");
    let left_out = "that of the file is left out (l_hip_pitch 0.2 N m, r_hip_pitch 0.2 N m)";
    assert!(notes.contains(left_out), "{notes}");
}

#[test]
fn legs_whose_names_contradict_their_sides_are_taken_by_side_and_it_is_said() {
    let swapped = plain()
        .replace("\"l_", "\"x_")
        .replace("\"r_", "\"l_")
        .replace("\"x_", "\"r_");
    let robot = read(&swapped);
    assert!(robot.legs[0].joints[0].name.starts_with("r_"));
    let note = robot
        .notes
        .iter()
        .find(|note| note.contains("is taken for the left one"));
    assert!(
        note.unwrap().contains("though its name says right"),
        "{:?}",
        robot.notes
    );
    let told = UrdfOptions {
        left_hip: Some("r_hip_pitch".into()),
        ..UrdfOptions::default()
    };
    let robot = parse(&swapped, &told).unwrap();
    assert!(
        robot.notes.iter().all(|note| !note.contains("is taken")),
        "{:?}",
        robot.notes
    );
}

#[test]
fn what_a_campaign_says_of_a_urdf_reaches_the_robot_and_a_table_has_no_use_for_it() {
    let place = tempfile::TempDir::new().unwrap();
    let path = |name: &str| place.path().join(name);
    std::fs::write(path("robot.urdf"), plain()).unwrap();
    let table = crate::common::repository("campaigns/robots/g1_12dof.toml");
    std::fs::copy(table, path("robot.toml")).unwrap();
    let walk = crate::common::repository("campaigns/biped-ground-reaction.toml");
    let walk = std::fs::read_to_string(walk).unwrap();
    let load = |robot: &str, keys: &str| {
        let text = walk.replace("[agent]", &format!("[agent]\nrobot = \"{robot}\"\n{keys}"));
        std::fs::write(path("c.toml"), text).unwrap();
        urts_mc::campaign::Campaign::load(&path("c.toml"))
    };
    let robot = |campaign: urts_mc::campaign::Campaign| match &campaign.first_group().agent {
        urts_mc::agent::Agent::Biped(biped) => biped.robot.clone(),
        urts_mc::agent::Agent::Uav(_) => panic!("no biped"),
    };
    let standing = "[-0.2, 0.0, 0.0, 0.4, -0.2, 0.0, -0.2, 0.0, 0.0, 0.4, -0.3, 0.0]";
    let keys = format!("pelvis = \"pelvis\"\narmature_kg_m2 = 0.02\nstanding_rad = {standing}\n");
    let own = robot(load("robot.urdf", &keys).unwrap());
    assert!(own.joints().all(|joint| joint.armature_kg_m2 == 0.02));
    assert_eq!(own.standing_rad[10], -0.3);
    // The right ankle is turned 0.1 rad farther: its sole is level there, and not at zero.
    let turn = |leg: usize| own.legs[leg].foot.sole.rotation.angle();
    assert!((turn(1) - turn(0)).abs() > 0.09, "{} {}", turn(0), turn(1));
    for (robot, keys, words) in [
        (
            "robot.toml",
            "armature_kg_m2 = 0.02",
            "a joint table says this itself",
        ),
        (
            "robot.urdf",
            "armature_kg_m2 = -0.02",
            "agent.armature_kg_m2 (line",
        ),
        ("robot.urdf", "left_hip = \"hip\"", "left_hip = \"hip\""),
        ("robot.urdf", "pelvis = \"hip\"", "no such link"),
        ("robot.urdf", "locked = [\"elbow\"]", "no such joint"),
    ] {
        let refused = load(robot, keys).unwrap_err().to_string();
        assert!(refused.contains(words), "{refused}");
    }
}
