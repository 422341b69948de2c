//! Robots of real people: arms, a waist and a head, a frame on the ground, and what a file says beside the legs.

use super::{parse, written};
use crate::agent::robot::load;
use nalgebra::{Isometry3, Vector3};
use urts_mc::agent::robot::kinematics::{by_leg, leg_pose};
use urts_mc::agent::robot::{Robot, Soles, Standing, UrdfOptions};

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
    // The other one by its name says the same.
    let told = UrdfOptions {
        right_hip: Some("l_hip_pitch".into()),
        ..UrdfOptions::default()
    };
    assert_eq!(parse(&swapped, &told).unwrap(), robot);
    // Where no side is told from the other by place, names do.
    let moved = plain().replace("xyz=\"0e0 6.4452e-2", "xyz=\"0e0 -6.4451e-2");
    assert_ne!(moved, plain());
    assert!(read(&moved).legs[0].joints[0].name.starts_with("l_"));
}

#[test]
fn arms_of_six_joints_are_no_legs_where_something_hangs_lower() {
    // The ankles' rolls are fixed: the legs have five joints, and only the arms have six.
    let text = with_upper_body();
    let fixed = ["l", "r"].iter().fold(text, |text, side| {
        let name = format!("<joint name=\"{side}_ankle_roll\" type=");
        text.replace(&format!("{name}\"revolute\""), &format!("{name}\"fixed\""))
    });
    let refused = parse(&fixed, &UrdfOptions::default())
        .unwrap_err()
        .to_string();
    let words = "a biped has two legs, each a chain of six revolute joints, on one link; these are 5; lock joints";
    assert!(refused.contains(words), "{refused}");
    assert!(refused.contains("_knee"), "{refused}");
    // One that follows another is named.
    let follows = with_upper_body().replace(
        "<joint name=\"r_knee\" type=\"revolute\">",
        "<joint name=\"r_knee\" type=\"revolute\"><mimic joint=\"l_knee\"/>",
    );
    let refused = parse(&follows, &UrdfOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("r_knee follows another joint"),
        "{refused}"
    );
}

#[test]
fn legs_on_brackets_of_their_own_have_the_pelvis_that_carries_the_brackets() {
    let bracket = |side: &str| {
        format!(
            "<link name=\"{side}_bracket\"/><joint name=\"{side}_mount\" type=\"fixed\"><origin xyz=\"0 0 0\" rpy=\"0 0 0\"/>\
             <parent link=\"pelvis\"/><child link=\"{side}_bracket\"/></joint>"
        )
    };
    let more = bracket("l") + &bracket("r") + &limb("neck", "pelvis");
    let mut text = plain().replace("</robot>", &format!("{more}</robot>"));
    for side in ["l", "r"] {
        let hip = format!("<parent link=\"pelvis\"/><child link=\"{side}_hip_pitch_link\"/>");
        assert!(text.contains(&hip), "{hip}");
        text = text.replace(
            &hip,
            &hip.replace("\"pelvis\"", &format!("\"{side}_bracket\"")),
        );
    }
    let (robot, plain) = (read(&text), read(&plain()));
    assert_eq!(robot.legs, plain.legs);
    assert!((robot.mass_kg() - plain.mass_kg() - 1.0).abs() < 1e-12);
}

#[test]
fn a_head_and_a_waist_on_the_trunk_are_no_legs_though_they_are_two() {
    let trunk = format!(
        r#"<link name="trunk"><inertial><mass value="5"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
        <joint name="waist" type="revolute"><parent link="trunk"/><child link="pelvis"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>{}"#,
        limb("head", "trunk")
    );
    let robot = read(&plain().replace("</robot>", &format!("{trunk}</robot>")));
    assert_eq!(robot.legs, read(&plain()).legs);
    let held = robot
        .notes
        .iter()
        .find(|note| note.contains("held at zero"))
        .unwrap();
    assert!(held.contains("waist") && held.contains("head"), "{held}");
}

#[test]
fn what_simulators_do_to_parts_that_are_held_still_is_noted() {
    let whole = with_upper_body();
    let padded = whole.replacen(
        "<inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\"",
        "<inertia ixx=\"0.03\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\"",
        1,
    );
    let robot = read(&padded);
    let note = "link waist_link, which is held still, has a mass or an inertia that no body has";
    assert!(
        robot.notes.iter().any(|own| own.contains(note)),
        "{:?}",
        robot.notes
    );
    let more = robot.base.inertia_kg_m2 - read(&whole).base.inertia_kg_m2;
    assert!(
        (more[(0, 0)] - 0.02).abs() < 1e-12 && more[(1, 1)].abs() < 1e-12,
        "{more}"
    );
    // On a leg it is no longer a small matter.
    let leg = plain().replacen("ixx=\"", "ixx=\"9", 2);
    assert!(parse(&leg, &UrdfOptions::default()).is_err());
    // No number is no limit.
    let none = plain().replace("velocity=\"3.2e1\"", "velocity=\"nan\"");
    assert!(parse(&none, &UrdfOptions::default()).is_err());
    // A limit beyond every number is none.
    let free = plain().replace("velocity=\"3.2e1\"", "velocity=\"1e9\"");
    let robot = read(&free);
    assert_eq!(robot.legs[0].joints[0].rate_max_rad_s, 1e6);
    let note = "above 1e6 are taken for none (l_hip_pitch";
    assert!(
        robot.notes.iter().any(|own| own.contains(note)),
        "{:?}",
        robot.notes
    );
}

#[test]
fn soles_are_frames_that_are_named_or_level_where_the_robot_stands() {
    // A sole that is tilted by 0.2 rad and lies below the ankle.
    let frame = |side: &str| {
        format!(
            "<link name=\"{side}_sole\"/><joint name=\"{side}_sole_joint\" type=\"fixed\"><origin xyz=\"0.02 0 -0.035\" rpy=\"0 0.2 0\"/>\
             <parent link=\"{side}_ankle_roll_link\"/><child link=\"{side}_sole\"/></joint>"
        )
    };
    let text = plain().replace("</robot>", &format!("{}{}</robot>", frame("l"), frame("r")));
    let named = UrdfOptions {
        soles: Some(Soles::Frames(["l_sole".into(), "r_sole".into()])),
        ..UrdfOptions::default()
    };
    let robot = parse(&text, &named).unwrap();
    let sole = &robot.legs[1].foot.sole;
    assert_eq!(sole.translation.vector, Vector3::new(0.02, 0.0, -0.035));
    assert!((sole.rotation.angle() - 0.2).abs() < 1e-15);
    assert!(
        robot
            .notes
            .iter()
            .all(|note| !note.contains("level at q = 0"))
    );
    // They stand level below the hips, the knees bent forwards, and so high above the ground.
    let bent = UrdfOptions {
        standing: Some(Standing::Bent),
        ..named
    };
    let robot = parse(&text, &bent).unwrap();
    let q = by_leg(&robot.standing_rad);
    for (leg, q_rad) in robot.legs.iter().zip(&q) {
        let pose = leg_pose(leg, q_rad);
        assert!(pose.sole().rotation.angle() < 1e-11);
        assert!(pose.origins_m[3].x > pose.ankle_m().x, "the knee is ahead");
        assert!((pose.ankle_m().x - leg.joints[0].placement.translation.x).abs() < 1e-11);
        assert!((pose.sole().translation.z + robot.base_height_m).abs() < 1e-11);
    }
    assert!(q[0][3] > 0.1, "the knee is bent");
}

#[test]
fn what_a_campaign_says_of_a_robots_file_reaches_the_robot() {
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
    let keys = format!("pelvis = \"pelvis\"\narmature_kg_m2 = 0.02\nstanding = {standing}\n");
    let own = robot(load("robot.urdf", &keys).unwrap());
    assert!(own.joints().all(|joint| joint.armature_kg_m2 == 0.02));
    assert_eq!(own.standing_rad[10], -0.3);
    // The right ankle is turned 0.1 rad farther: its sole is level there, and not at zero.
    let turn = |leg: usize| own.legs[leg].foot.sole.rotation.angle();
    assert!((turn(1) - turn(0)).abs() > 0.09, "{} {}", turn(0), turn(1));
    // A table takes another pose and other rotors, one by one.
    let list = (1..=12).map(|k| format!("0.0{k:02}")).collect::<Vec<_>>();
    let keys = format!(
        "armature_kg_m2 = [{}]\nstanding = \"bent\"\n",
        list.join(", ")
    );
    let table = robot(load("robot.toml", &keys).unwrap());
    let armatures: Vec<f64> = table.joints().map(|joint| joint.armature_kg_m2).collect();
    assert_eq!((armatures[0], armatures[11]), (0.001, 0.012));
    assert!(table.standing_rad[3] > 0.1 && table.base_height_m < 0.79);
    for (robot, keys, words) in [
        (
            "robot.toml",
            "sole = \"standing\"",
            "a joint table says this itself",
        ),
        (
            "robot.urdf",
            "standing = \"crouched\"",
            "unknown value `crouched`, expected `bent`",
        ),
        ("robot.urdf", "standing = 0.1", "expected `bent` or a list"),
        (
            "robot.urdf",
            "sole = [\"a\"]",
            "expected a list of length 2",
        ),
        (
            "robot.urdf",
            "armature_kg_m2 = [0.1]",
            "each of the 12 channels",
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
