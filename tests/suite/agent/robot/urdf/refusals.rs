//! What the URDF reader refuses, and in which words.

use super::{inertial, parse, written};
use crate::agent::robot::load;
use nalgebra::{Isometry3, Vector3};
use proptest::prelude::*;
use urts_mc::agent::robot::{Foot, LEFT, Soles, Standing, UrdfOptions};

/// What is said of the G1's URDF with the first occurrence of a text replaced.
fn refusal_of(old: &str, new: &str) -> String {
    let text = written(&load("g1_12dof"), &Isometry3::identity());
    let changed = text.replacen(old, new, 1);
    assert_ne!(text, changed, "{old} is not there");
    parse(&changed, &UrdfOptions::default())
        .unwrap_err()
        .to_string()
}

#[test]
fn refusals_name_link_or_joint_value_limit_and_remedy() {
    let free = |name: &str| {
        format!(
            r#"<link name="{name}_tip"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
            <joint name="{name}" type="revolute"><parent link="l_ankle_roll_link"/><child link="{name}_tip"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"#
        )
    };
    let cases = [
        (
            refusal_of(r#"<mass value="1.932e0"/>"#, r#"<mass value="-1"/>"#),
            "robots/x.urdf: link inertial mass (l_knee_link) = -1: a mass is positive; give its true value",
        ),
        (
            refusal_of(r#"ixx="1.1329e-2""#, r#"ixx="-1.1329e-2""#),
            "link inertial inertia (l_knee_link) = [-0.011329, 4.82e-5, -4.49e-5, 0.011277, -0.0007146, 0.0015168]: no principal moment of a body is negative or exceeds the sum of the other two",
        ),
        (
            refusal_of(r#"iyy="1.1277e-2""#, r#"iyy="nan""#),
            "link inertial inertia (l_knee_link) = NaN: a number is finite and at most 1e6 in size",
        ),
        (
            refusal_of(
                r#"name="l_knee" type="revolute""#,
                r#"name="l_knee" type="prismatic""#,
            ),
            "joint type (l_knee) = prismatic: the joints of a leg are revolute; make it revolute with limits, or fixed",
        ),
        (
            refusal_of(
                r#"name="l_knee" type="revolute""#,
                r#"name="l_knee" type="continuous""#,
            ),
            "joint type (l_knee) = continuous: the joints of a leg are revolute",
        ),
        (
            refusal_of(
                r#"name="l_knee" type="revolute""#,
                r#"name="l_knee" type="fixed""#,
            ),
            "moving joints of the leg (l_hip_pitch) = 5: a leg is one chain of six revolute joints; l_ankle_roll is the last",
        ),
        (
            refusal_of("</robot>", &free("toe")),
            "moving joints of the leg (l_hip_pitch) = 7: a leg is one chain of six revolute joints; toe is one too many; make the others fixed or lock them",
        ),
        (
            refusal_of(
                "</robot>",
                &free("toe").replace("l_ankle_roll_link", "l_knee_link"),
            ),
            "moving joints of the leg (l_hip_pitch) = 2: a leg is one chain of six revolute joints; this many follow l_knee",
        ),
        (
            refusal_of(r#"<axis xyz="0e0 1e0 0e0"/>"#, r#"<axis xyz="0 0 0"/>"#),
            "joint axis xyz (l_hip_pitch) = [0.0, 0.0, 0.0]: an axis has a direction",
        ),
        (
            refusal_of(r#"lower="-2.5307e0""#, r#"lower="3""#),
            "joint limit lower (l_hip_pitch) = 3: it lies below limit upper = 2.8798; give both limits in rad",
        ),
        (
            refusal_of(r#"effort="8.8e1""#, r#"effort="0""#),
            "joint limit effort (l_hip_pitch) = 0: a largest torque is positive",
        ),
        (
            refusal_of(
                r#"<parent link="pelvis"/>"#,
                r#"<parent link="pelvis"/><mimic joint="r_knee"/>"#,
            ),
            r#"joint mimic (l_hip_pitch) = "r_knee": every joint of a leg has its own actuator"#,
        ),
        (
            refusal_of(r#"name="r_knee""#, r#"name="l_knee""#),
            r#"joint name = "l_knee": this name occurs twice; give each its own"#,
        ),
        (
            refusal_of(r#"name="r_knee_link""#, r#"name="l_knee_link""#),
            r#"link name = "l_knee_link": this name occurs twice"#,
        ),
        (
            refusal_of(
                r#"<child link="r_knee_link"/>"#,
                r#"<child link="l_knee_link"/>"#,
            ),
            r#"joint child link (r_knee) = "l_knee_link": this link hangs on "l_knee" already"#,
        ),
        (
            refusal_of(
                r#"<child link="r_knee_link"/>"#,
                r#"<child link="r_kne_link"/>"#,
            ),
            r#"joint child link (r_knee) = "r_kne_link": no such link; name a link of the file"#,
        ),
        (
            refusal_of("</robot>", r#"<link name="stray"/></robot>"#),
            r#"root link = ["pelvis", "stray"]: one link, and only one, hangs on no joint"#,
        ),
        (
            refusal_of(
                "</robot>",
                r#"<link name="a"/><link name="b"/>
                <joint name="ab" type="fixed"><parent link="a"/><child link="b"/></joint>
                <joint name="ba" type="fixed"><parent link="b"/><child link="a"/></joint></robot>"#,
            ),
            r#"link = "a": it does not hang on the root link "pelvis""#,
        ),
    ];
    for (message, expected) in cases {
        assert!(message.contains(expected), "{message}\n{expected}");
    }
}

#[test]
fn moved_links_without_inertia_are_refused() {
    let robot = load("g1_12dof");
    let text = written(&robot, &Isometry3::identity());
    let shank = inertial(&robot.legs[LEFT].joints[3].body, &Isometry3::identity());
    let said = |with: &str| {
        let changed = text.replace(&shank, with);
        assert_ne!(changed, text);
        parse(&changed, &UrdfOptions::default())
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        said(""),
        "robots/x.urdf: link inertial (l_knee_link) = none: a moving link and the pelvis have a mass and an inertia; add <inertial> to the link or to one fixed to it"
    );
    let point = r#"<inertial><mass value="1"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>"#;
    let said = said(point);
    let expected = "link inertial inertia (l_knee_link) = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]: an inertia tensor about the centre of mass is positive definite";
    assert!(said.contains(expected), "{said}");
}

#[test]
fn syntax_errors_name_line_and_element() {
    let cases = [
        (
            refusal_of(r#"<mass value="1.932e0"/>"#, r#"<mass value="heavy"/>"#),
            r#"<link name="l_knee_link"> <mass>: value = "heavy" is not a number; correct it"#,
        ),
        (
            refusal_of(
                r#"name="l_knee" type="revolute""#,
                r#"name="l_knee" type="hinge""#,
            ),
            r#"<joint name="l_knee">: the type "hinge" is none of revolute, continuous"#,
        ),
        (
            refusal_of(r#"velocity="2e1" "#, ""),
            r#"line 11, <joint name="l_hip_roll"> <limit>: velocity is missing; add this attribute"#,
        ),
        (refusal_of("</joint>", ""), "; write it as XML requires"),
        (
            refusal_of("<link ", r#"<xacro:include filename="a.xacro"/><link "#),
            "; expand the file with xacro first",
        ),
    ];
    for (message, expected) in cases {
        assert!(message.contains(expected), "{message}\n{expected}");
    }
    let empty = "number of <link> = 0: a robot has links; write them and their joints into <robot>";
    let robot = "line 1, <mujoco>: this is no <robot>; name a URDF";
    for (text, expected) in [
        ("", "; write it as XML requires"),
        ("<robot", "; write it as XML requires"),
        ("not a robot", "; write it as XML requires"),
        ("<robot/>", empty),
        ("<mujoco/>", robot),
    ] {
        let said = parse(text, &UrdfOptions::default())
            .unwrap_err()
            .to_string();
        assert!(
            said.starts_with("robots/x.urdf: ") && said.ends_with(expected),
            "{said}"
        );
    }
}

#[test]
fn what_is_no_number_is_refused_with_its_element_and_what_is_not_used_stops_nothing() {
    // A sign that lost its number, a comma, a unit, a number too few.
    for (with, said) in [
        ("0 0 - 0.3", "3 numbers"),
        ("0, 0, 0.3", "3 numbers"),
        ("0 0 0.3m", "3 numbers"),
        ("0 0.3", "3 numbers"),
        ("nan 0 x", "3 numbers"),
    ] {
        let text = written(&load("g1_12dof"), &Isometry3::identity());
        let at = text.find("name=\"l_knee\"").unwrap();
        let origin = at + text[at..].find("xyz=\"").unwrap() + 5;
        let end = origin + text[origin..].find('"').unwrap();
        let text = format!("{}{with}{}", &text[..origin], &text[end..]);
        let refused = parse(&text, &UrdfOptions::default())
            .unwrap_err()
            .to_string();
        let expected = format!("<joint name=\"l_knee\"> <origin>: xyz = {with:?} is not {said}");
        assert!(refused.contains(&expected), "{refused}");
    }
    let plain = written(&load("g1_12dof"), &Isometry3::identity());
    let unused = r#"<link name="l_knee_link"><visual><geometry><mesh filename="a.stl" scale="0.001"/></geometry></visual>
        <collision><geometry/></collision><visual><material/><material><color rgba="red"/></material></visual>"#;
    let more = r#"<transmission name="t"><type/></transmission><gazebo reference="nobody"><mu1>x</mu1></gazebo>
        <ros2_control type="system"/><material/></robot>"#;
    let text = plain
        .replace(r#"<link name="l_knee_link">"#, unused)
        .replace("</robot>", more);
    assert_ne!(text, plain);
    let [with, without] = [&text, &plain].map(|text| parse(text, &UrdfOptions::default()).unwrap());
    assert_eq!(with, without);
}

#[test]
fn options_are_checked_like_the_file() {
    let text = written(&load("g1_12dof"), &Isometry3::identity());
    let said = |options: UrdfOptions| parse(&text, &options).unwrap_err().to_string();
    let none = UrdfOptions::default;
    let foot = Foot {
        ankle_offset_m: Vector3::new(0.0, f64::NAN, 0.0),
        sole: Isometry3::identity(),
        sole_corners_m: Vec::new(),
    };
    let cases = [
        (
            said(UrdfOptions {
                armature_kg_m2: Some([-0.01; 12]),
                ..none()
            }),
            "joint armature_kg_m2 (l_hip_pitch) = -0.01: an armature is not negative",
        ),
        (
            said(UrdfOptions {
                pelvis: Some("hip".into()),
                ..none()
            }),
            r#"pelvis = "hip": no such link; name a link of the file"#,
        ),
        (
            said(UrdfOptions {
                left_hip: Some("hip".into()),
                ..none()
            }),
            r#"left_hip = "hip": the legs begin with "l_hip_pitch" and "r_hip_pitch"; name one of these"#,
        ),
        (
            said(UrdfOptions {
                left_hip: Some("r_hip_pitch".into()),
                right_hip: Some("r_hip_pitch".into()),
                ..none()
            }),
            r#"right_hip = "r_hip_pitch": left_hip names the same joint; name the other one"#,
        ),
        (
            said(UrdfOptions {
                soles: Some(Soles::Frames(["l_knee_link".into(), "sole".into()])),
                ..none()
            }),
            r#"sole = "l_knee_link": it is not fixed to "l_ankle_roll_link"; name a link that is fixed to the last one"#,
        ),
        (
            said(UrdfOptions {
                locked: vec!["waist".into()],
                ..none()
            }),
            r#"locked = "waist": no such joint; name joints of the file"#,
        ),
        (
            said(UrdfOptions {
                soles: Some(Soles::Feet([foot.clone(), foot])),
                ..none()
            }),
            "soles = NaN: a number is finite",
        ),
        (
            said(UrdfOptions {
                standing: Some(Standing::Angles([1.0; 12])),
                ..none()
            }),
            "standing[4] (l_ankle_pitch) = 1: the joint moves from -0.87267 to 0.5236 rad",
        ),
        (
            said(UrdfOptions {
                base_height_m: Some(-0.7),
                ..none()
            }),
            "base_height_m = -0.7: the height of the pelvis above the soles is positive",
        ),
    ];
    for (message, expected) in cases {
        assert!(message.contains(expected), "{message}\n{expected}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, rng_seed: proptest::test_runner::RngSeed::Fixed(5), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn garbled_urdfs_never_panic(cut in 0_usize..9000, skip in 0_usize..300, garbage in ".{0,12}") {
        let text = written(&load("g1_12dof"), &Isometry3::identity());
        let cut = cut.min(text.len());
        let again = (cut + skip).min(text.len());
        let _ = parse(&format!("{}{garbage}{}", &text[..cut], &text[again..]), &UrdfOptions::default());
    }
}
