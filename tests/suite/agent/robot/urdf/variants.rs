//! Files that are odd but valid: each says the same robot as the plain one, however it says it.

use super::{options_of, parse, written};
use crate::agent::robot::load;
use nalgebra::Isometry3;
use urts_mc::agent::robot::Robot;

/// A change of a file that changes no robot.
type Variant = (&'static str, fn(&str) -> String);

/// The file with one more element.
fn at_the_end(text: &str, element: &str) -> String {
    text.replace("</robot>", &format!("{element}</robot>"))
}

/// The elements of the file, one after the other: links, then joints.
fn elements(text: &str) -> (Vec<String>, Vec<String>) {
    let body = text.split_once('\n').unwrap().1.replace("</robot>", "");
    let split = |tag: &str| -> Vec<String> {
        let (begin, end) = (format!("<{tag} "), format!("</{tag}>"));
        let of_tag = body.split(&*begin).skip(1);
        of_tag
            .map(|own| format!("<{tag} {}{end}\n", own.split(&end).next().unwrap()))
            .collect()
    };
    (split("link"), split("joint"))
}

const HEAD: &str = "<robot name=\"g1_12dof\">";

/// In a link of its own, every element that a model of rigid bodies does not use; some are not even right.
const VISUAL: &str = r#"<visual><origin xyz="a b" rpy="0 0"/><geometry><mesh filename="package://x/y.stl" scale="0.001"/></geometry>
    <material><color rgba="1"/></material></visual><visual/><collision><geometry/></collision>"#;

/// Leaves every variant's robot as it is.
const VARIANTS: [Variant; 36] = [
    ("byte order mark", |text| format!("\u{feff}{text}")),
    ("lines that end in CR LF", |text| text.replace('\n', "\r\n")),
    ("no line ends", |text| text.replace('\n', " ")),
    ("tabs between the elements", |text| {
        text.replace("<link", "\t\t<link")
            .replace("<joint", "\t<joint")
    }),
    ("tabs between the numbers", |text| {
        text.replace("xyz=\"0e0 0e0", "xyz=\"0e0\t0e0")
    }),
    ("line ends between the numbers", |text| {
        text.replace("rpy=\"-0e0 -0e0 0e0\"", "rpy=\"-0e0\n-0e0\n0e0\"")
    }),
    ("blanks around the numbers", |text| {
        text.replace("rpy=\"-0e0 -0e0 0e0\"", "rpy=\"  -0e0   -0e0 0e0  \"")
    }),
    ("signs of positive numbers", |text| {
        text.replace("velocity=\"", "velocity=\"+")
    }),
    ("capital exponents", |text| {
        text.replace("rpy=\"-0e0 -0e0 0e0\"", "rpy=\"-0E0 -0.0E+00 0e-0\"")
    }),
    ("an XML declaration", |text| {
        format!("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n{text}")
    }),
    ("a comment before the robot", |text| {
        format!("<!-- <robot name=\"no\"> -->\n{text}")
    }),
    ("comments in the robot", |text| {
        text.replace("<link", "<!-- a -- >b --><link")
            .replace("a -- >b", "a > b")
    }),
    ("a comment in an element", |text| {
        text.replace("<limit", "<!-- <limit lower=\"7\"/> --><limit")
    }),
    ("a processing instruction", |text| {
        text.replace(HEAD, &format!("{HEAD}<?editor fold?>"))
    }),
    ("a namespace", |text| {
        text.replace(
            HEAD,
            "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\" name=\"g1_12dof\">",
        )
    }),
    ("a version", |text| {
        text.replace(HEAD, "<robot version=\"1.0\" name=\"g1_12dof\">")
    }),
    ("attributes in single quotes", |text| {
        text.replace("velocity=\"3.2e1\"", "velocity='3.2e1'")
    }),
    ("elements with ends of their own", |text| {
        text.replace("<mass value=\"1.35e0\"/>", "<mass value=\"1.35e0\"></mass>")
    }),
    ("attributes in another order", |text| {
        text.replace(" type=\"revolute\">", ">")
            .replace("<joint name", "<joint type=\"revolute\" name")
    }),
    ("joints before links", |text| {
        let (links, joints) = elements(text);
        format!("{HEAD}\n{}{}</robot>", joints.concat(), links.concat())
    }),
    ("everything backwards", |text| {
        let (links, joints) = elements(text);
        let all: Vec<String> = links.into_iter().chain(joints).rev().collect();
        format!("{HEAD}\n{}</robot>", all.concat())
    }),
    ("visual and collision, right or not", |text| {
        text.replace("</inertial>", &format!("</inertial>{VISUAL}"))
    }),
    ("visual before inertial", |text| {
        text.replace("<inertial>", &format!("{VISUAL}<inertial>"))
    }),
    ("materials", |text| {
        at_the_end(text, "<material name=\"a\"><color/></material><material/>")
    }),
    ("transmissions", |text| {
        at_the_end(
            text,
            "<transmission><type>x</type><joint name=\"nobody\"/></transmission>",
        )
    }),
    ("gazebo", |text| {
        at_the_end(
            text,
            "<gazebo reference=\"nobody\"><mu1>x</mu1></gazebo><gazebo><plugin/></gazebo>",
        )
    }),
    ("ros2_control", |text| {
        at_the_end(
            text,
            "<ros2_control name=\"a\" type=\"system\"><joint name=\"l_hip_pitch\"><param name=\"x\">y</param></joint></ros2_control>",
        )
    }),
    ("mujoco", |text| {
        at_the_end(
            text,
            "<mujoco><compiler meshdir=\"m\" balanceinertia=\"true\"/></mujoco>",
        )
    }),
    ("a sensor of the file", |text| {
        at_the_end(
            text,
            "<sensor name=\"imu\" type=\"imu\"><parent link=\"pelvis\"/></sensor>",
        )
    }),
    ("safety and calibration", |text| {
        text.replace(
            "<limit",
            "<safety_controller soft_lower_limit=\"x\"/><calibration rising=\"y\"/><limit",
        )
    }),
    ("no dynamics and empty dynamics", |text| {
        text.replace("<limit", "<dynamics/><limit")
    }),
    ("a bare frame", |text| {
        at_the_end(
            text,
            "<link name=\"imu\"/><joint name=\"imu_joint\" type=\"fixed\"><parent link=\"pelvis\"/><child link=\"imu\"/></joint>",
        )
    }),
    ("a frame without mass", |text| {
        at_the_end(
            text,
            r#"<link name="imu"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
        <joint name="imu_joint" type="fixed"><origin xyz="0 0 1"/><parent link="l_knee_link"/><child link="imu"/></joint>"#,
        )
    }),
    ("a floating root", |text| {
        at_the_end(
            text,
            "<link name=\"world\"/><joint name=\"free\" type=\"floating\"><parent link=\"world\"/><child link=\"pelvis\"/></joint>",
        )
    }),
    ("a fixed root", |text| {
        at_the_end(text, "<link name=\"base\"/><joint name=\"held\" type=\"fixed\"><parent link=\"base\"/><child link=\"pelvis\"/></joint>")
        .replace("<link name=\"base\"/>", "<link name=\"base\"></link>")
    }),
    ("axes of other lengths", |text| {
        text.replace("<axis xyz=\"0e0 1e0 0e0\"/>", "<axis xyz=\"0 4 0\"/>")
    }),
];

fn plain() -> String {
    written(&load("g1_12dof"), &Isometry3::identity())
}

fn read(text: &str, what: &str) -> Robot {
    parse(text, &options_of(&load("g1_12dof"))).unwrap_or_else(|error| panic!("{what}: {error}"))
}

#[test]
fn odd_but_valid_files_say_the_same_robot() {
    let plain = plain();
    let robot = read(&plain, "plain");
    for (what, variant) in VARIANTS {
        let text = variant(&plain);
        assert_ne!(text, plain, "{what} changes nothing");
        assert_eq!(read(&text, what), robot, "{what}");
    }
}

#[test]
fn names_may_be_of_any_script_and_axes_may_point_the_other_way() {
    let plain = plain();
    let robot = read(&plain, "plain");
    let text = plain.replace("l_knee", "左膝 ü");
    let named = read(&text, "names");
    assert_eq!(named.legs[0].joints[3].name, "左膝 ü");
    assert_eq!(named.legs[0].joints[3].body, robot.legs[0].joints[3].body);
    // A negative axis turns the other way: at the negative angle it is where the positive one was.
    let text = plain.replace("<axis xyz=\"0e0 1e0 0e0\"/>", "<axis xyz=\"0 -0.5 0\"/>");
    let turned = read(&text, "axes");
    let axis = |robot: &Robot| robot.legs[0].joints[0].axis.into_inner();
    assert_eq!(axis(&turned), -axis(&robot));
}

#[test]
fn another_robot_is_another_robot() {
    // The comparison above would notice a changed digit of any number that the model uses.
    let plain = plain();
    let robot = read(&plain, "plain");
    for (from, to) in [
        ("<mass value=\"1.35e0\"/>", "<mass value=\"1.3500001e0\"/>"),
        ("velocity=\"3.2e1\"", "velocity=\"3.3e1\""),
        ("ixx=\"1.811e-3\"", "ixx=\"1.812e-3\""),
        ("<axis xyz=\"0e0 1e0 0e0\"/>", "<axis xyz=\"0 1 0.001\"/>"),
        (
            "xyz=\"0e0 6.4452e-2 -1.027e-1\"",
            "xyz=\"0e0 6.4453e-2 -1.027e-1\"",
        ),
    ] {
        let text = plain.replacen(from, to, 1);
        assert_ne!(text, plain, "{from}");
        assert_ne!(read(&text, to), robot, "{from}");
    }
}
