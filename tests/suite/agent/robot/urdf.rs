//! The URDF reader. The URDFs are written here, from the joint tables.

mod limbs;
mod refusals;
mod variants;

use super::{leg_states, load, shipped};
use nalgebra::{Isometry3, Rotation3, Vector3};
use std::fmt::Write;
use std::path::Path;
use urts_mc::agent::robot::dynamics::{bias_force, mass_matrix};
use urts_mc::agent::robot::kinematics::{com_m, leg_pose};
use urts_mc::agent::robot::{
    Body, LEFT, RIGHT, Robot, RobotError, Soles, Standing, UrdfOptions, urdf,
};

fn parse(text: &str, options: &UrdfOptions) -> Result<Robot, RobotError> {
    urdf::parse(text, Path::new("robots/x.urdf"), options)
}

fn origin(pose: &Isometry3<f64>) -> String {
    let xyz = pose.translation.vector;
    // Yaw first, then pitch and roll of what it leaves: exact at a pitch of a right angle, too, where yaw may be any.
    let r = pose.rotation.to_rotation_matrix();
    let yaw = r[(1, 0)].atan2(r[(0, 0)]);
    let r = Rotation3::from_axis_angle(&Vector3::z_axis(), -yaw) * r;
    let (pitch, roll) = ((-r[(2, 0)]).atan2(r[(0, 0)]), (-r[(1, 2)]).atan2(r[(1, 1)]));
    format!(
        r#"<origin xyz="{:e} {:e} {:e}" rpy="{roll:e} {pitch:e} {yaw:e}"/>"#,
        xyz.x, xyz.y, xyz.z
    )
}

/// `<inertial>` of a body, its tensor written in the axes of `frame`.
fn inertial(body: &Body, frame: &Isometry3<f64>) -> String {
    let turned = frame.rotation.to_rotation_matrix();
    let i = turned.transpose() * body.inertia_kg_m2 * turned;
    let pose = Isometry3::from_parts(body.com_m.into(), frame.rotation);
    format!(
        "<inertial>{}<mass value=\"{:e}\"/>\n  <inertia ixx=\"{:e}\" ixy=\"{:e}\" ixz=\"{:e}\" iyy=\"{:e}\" iyz=\"{:e}\" izz=\"{:e}\"/></inertial>",
        origin(&pose),
        body.mass_kg,
        i[(0, 0)],
        i[(0, 1)],
        i[(0, 2)],
        i[(1, 1)],
        i[(1, 2)],
        i[(2, 2)],
    )
}

/// The robot as a URDF, the tensor of every inertia written in the axes of `frame`.
fn written(robot: &Robot, frame: &Isometry3<f64>) -> String {
    let mut text = format!("<robot name=\"{}\">\n", robot.name);
    let base = inertial(&robot.base, frame);
    writeln!(text, "<link name=\"pelvis\">{base}</link>").unwrap();
    for leg in &robot.legs {
        let mut parent = "pelvis".to_string();
        for joint in &leg.joints {
            let link = format!("{}_link", joint.name);
            let body = inertial(&joint.body, frame);
            writeln!(text, "<link name=\"{link}\">{body}</link>").unwrap();
            let [x, y, z]: [f64; 3] = joint.axis.into_inner().into();
            writeln!(
                text,
                "<joint name=\"{}\" type=\"revolute\">{}<parent link=\"{parent}\"/><child link=\"{link}\"/>\n  <axis xyz=\"{x:e} {y:e} {z:e}\"/><limit lower=\"{:e}\" upper=\"{:e}\" velocity=\"{:e}\" effort=\"{:e}\"/></joint>",
                joint.name,
                origin(&joint.placement),
                joint.q_min_rad,
                joint.q_max_rad,
                joint.rate_max_rad_s,
                joint.torque_max_n_m,
            )
            .unwrap();
            parent = link;
        }
    }
    text + "</robot>\n"
}

/// What the table says and a URDF does not.
fn options_of(robot: &Robot) -> UrdfOptions {
    let mut armature = robot.joints().map(|joint| joint.armature_kg_m2);
    UrdfOptions {
        armature_kg_m2: Some(std::array::from_fn(|_| armature.next().unwrap())),
        soles: Some(Soles::Feet(
            robot.legs.each_ref().map(|leg| leg.foot.clone()),
        )),
        standing: Some(Standing::Angles(robot.standing_rad)),
        base_height_m: Some(robot.base_height_m),
        licence: robot.licence.clone(),
        attribution: robot.attribution.clone(),
        ..UrdfOptions::default()
    }
}

fn turned() -> Isometry3<f64> {
    Isometry3::new(Vector3::zeros(), Vector3::new(0.3, -1.1, 0.7))
}

/// Refuses robots that differ in more than rounding.
fn assert_same(one: &Robot, other: &Robot) {
    assert_eq!(
        (&one.name, &one.licence, &one.attribution),
        (&other.name, &other.licence, &other.attribution)
    );
    assert_eq!(one.gravity_m_s2, other.gravity_m_s2);
    assert_eq!(one.standing_rad, other.standing_rad);
    assert_eq!(one.base_height_m, other.base_height_m);
    for (a, b) in one.joints().zip(other.joints()) {
        assert_eq!(a.name, b.name);
        let limits = |joint: &urts_mc::agent::robot::Joint| {
            [
                joint.q_min_rad,
                joint.q_max_rad,
                joint.rate_max_rad_s,
                joint.torque_max_n_m,
                joint.armature_kg_m2,
                joint.damping_n_m_s,
            ]
        };
        assert_eq!(limits(a), limits(b), "{}", a.name);
    }
    // Some ten roundings of lengths below a metre and of masses of some 10 kg.
    const ROUNDING: f64 = 1e-13;
    for (a, b) in one.legs.iter().zip(&other.legs) {
        assert_eq!(a.foot.sole_corners_m, b.foot.sole_corners_m);
        for state in leg_states(13, 20) {
            let [mass, theirs] = [a, b].map(|leg| mass_matrix(leg, &state.q));
            assert!((mass - theirs).amax() <= ROUNDING, "{}", one.name);
            let [force, theirs] =
                [a, b].map(|leg| bias_force(leg, &one.gravity_m_s2, &state.q, &state.rate));
            assert!((force - theirs).amax() <= ROUNDING * (1.0 + force.amax()));
            let [sole, theirs] = [a, b].map(|leg| leg_pose(leg, &state.q).sole().to_homogeneous());
            assert!((sole - theirs).amax() <= ROUNDING);
        }
    }
    let [com, theirs] = [one, other].map(|robot| com_m(robot, &robot.standing_rad));
    assert!((com - theirs).amax() <= ROUNDING);
    let [base, theirs] = [one, other].map(|robot| robot.base);
    assert!((base.inertia_kg_m2 - theirs.inertia_kg_m2).amax() <= ROUNDING);
}

#[test]
fn a_urdf_of_a_table_is_the_robot_of_the_table() {
    for robot in shipped() {
        for frame in [Isometry3::identity(), turned()] {
            let read = parse(&written(&robot, &frame), &options_of(&robot)).unwrap();
            assert_same(&read, &robot);
        }
    }
}

#[test]
fn a_file_is_read_by_its_extension() {
    let robot = load("g1_12dof");
    let text = written(&robot, &Isometry3::identity());
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("g1_of_the_table.URDF");
    std::fs::write(&path, &text).unwrap();
    let read = Robot::load(&path).unwrap();
    assert_eq!(read, parse(&text, &UrdfOptions::default()).unwrap());
}

/// Half of the left shank as a link of its own, fixed to a frame that is fixed to the shank.
#[test]
fn fixed_links_are_part_of_the_one_that_carries_them() {
    let robot = load("g1_12dof");
    let text = written(&robot, &Isometry3::identity());
    let shank = robot.legs[LEFT].joints[3].body;
    let whole = inertial(&shank, &Isometry3::identity());
    // Two halves 0.02 m apart along x, their tensors less what the distance adds.
    let apart = Vector3::new(0.01, 0.0, 0.0);
    let mut half = shank;
    half.mass_kg /= 2.0;
    half.inertia_kg_m2 /= 2.0;
    let parallel = half.mass_kg * apart.norm_squared();
    half.inertia_kg_m2[(1, 1)] -= parallel;
    half.inertia_kg_m2[(2, 2)] -= parallel;
    let mut one = half;
    one.com_m += apart;
    let place = Isometry3::new(Vector3::new(0.1, -0.2, 0.3), Vector3::new(0.5, 0.4, -0.3));
    let from_place = place.inverse();
    let mut other = half;
    other.com_m -= apart;
    let other = other.moved(
        from_place.rotation.to_rotation_matrix().matrix(),
        &from_place.translation.vector,
    );
    let split = text.replace(&whole, &inertial(&one, &turned())).replace(
        "</robot>",
        &format!(
            r#"<link name="frame"/><link name="part">{}</link>
            <joint name="to_part" type="fixed"><parent link="frame"/><child link="part"/></joint>
            <joint name="to_frame" type="fixed">{}<parent link="l_knee_link"/><child link="frame"/></joint></robot>"#,
            inertial(&other, &turned()),
            origin(&place)
        ),
    );
    assert_ne!(split, text);
    assert_same(&parse(&split, &options_of(&robot)).unwrap(), &robot);
}

/// The hips moved from the pelvis to links that are fixed to it, and a locked waist.
#[test]
fn fixed_and_locked_joints_of_the_pelvis_carry_legs_and_upper_body() {
    let robot = load("g1_12dof");
    let text = written(&robot, &Isometry3::identity());
    let whole = inertial(&robot.base, &Isometry3::identity());
    let waist = Isometry3::new(Vector3::new(0.0, 0.01, 0.1), Vector3::new(0.0, 0.2, 0.0));
    let torso = robot.base.moved(
        waist.rotation.inverse().to_rotation_matrix().matrix(),
        &waist.inverse().translation.vector,
    );
    let text = text
        .replace(&whole, "")
        .replace(
            "</robot>",
            &format!(
                r#"<link name="torso">{}</link><joint name="waist" type="revolute">{}<parent link="pelvis"/><child link="torso"/>
                <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"#,
                inertial(&torso, &Isometry3::identity()),
                origin(&waist)
            ),
        );
    // A joint outside the legs is held still whether it is named or not; of the unnamed one the user is told.
    let found = parse(&text, &options_of(&robot)).unwrap();
    assert_same(&found, &robot);
    assert!(found.notes[0].starts_with("1 joint outside the legs is held at zero"));
    let options = UrdfOptions {
        locked: vec!["waist".into()],
        ..options_of(&robot)
    };
    assert_same(&parse(&text, &options).unwrap(), &robot);
}

#[test]
fn the_pelvis_is_the_named_link_or_what_a_floating_joint_carries() {
    let robot = load("g1_12dof");
    let text = written(&robot, &Isometry3::identity());
    let floating = text.replace(
        "</robot>",
        r#"<link name="world"/><joint name="free" type="floating"><parent link="world"/><child link="pelvis"/></joint></robot>"#,
    );
    assert_same(&parse(&floating, &options_of(&robot)).unwrap(), &robot);
    // The pelvis as a bare frame on a root link that has its mass.
    let above = Isometry3::new(Vector3::new(0.1, 0.0, -0.5), Vector3::new(0.0, 0.0, 0.4));
    let turn = above.rotation.to_rotation_matrix();
    let of_root = robot.base.moved(turn.matrix(), &above.translation.vector);
    let whole = inertial(&robot.base, &Isometry3::identity());
    let fixed = text.replace(&whole, "").replace(
        "</robot>",
        &format!(
            r#"<link name="base">{}</link><joint name="mount" type="fixed">{}<parent link="base"/><child link="pelvis"/></joint></robot>"#,
            inertial(&of_root, &Isometry3::identity()),
            origin(&above)
        ),
    );
    let options = UrdfOptions {
        pelvis: Some("pelvis".into()),
        ..options_of(&robot)
    };
    assert_same(&parse(&fixed, &options).unwrap(), &robot);
    // Without a name it is the root, whose frame is another.
    let other = parse(&fixed, &options_of(&robot)).unwrap();
    assert_eq!(other.base.com_m, of_root.com_m);
}

#[test]
fn which_leg_is_left_is_told_by_y_or_by_name() {
    let robot = load("g1_12dof");
    let text = written(&robot, &Isometry3::identity());
    let names = |robot: &Robot| [LEFT, RIGHT].map(|leg| robot.legs[leg].joints[0].name.clone());
    let named = UrdfOptions {
        left_hip: Some("r_hip_pitch".into()),
        ..UrdfOptions::default()
    };
    let by_name = parse(&text, &named).unwrap();
    assert_eq!(names(&by_name), ["r_hip_pitch", "l_hip_pitch"]);
    let by_y = parse(&text, &UrdfOptions::default()).unwrap();
    assert_eq!(names(&by_y), ["l_hip_pitch", "r_hip_pitch"]);
    // On one side, and by names that say nothing.
    let same_side = text.replace("-6.4452e-2", "6.4452e-2");
    let same_side = same_side
        .replace("\"l_", "\"one_")
        .replace("\"r_", "\"other_");
    let refused = parse(&same_side, &UrdfOptions::default()).unwrap_err();
    let expected = "robots/x.urdf: origin y of (one_hip_pitch, other_hip_pitch) = [0.064452, 0.064452]: the left leg begins at y > 0 of the pelvis and the right one at y < 0; name the first joint of the left leg as left_hip";
    assert_eq!(refused.to_string(), expected);
}

#[test]
fn defaults_stand_on_level_soles_at_the_ankles() {
    for robot in shipped() {
        let text = written(&robot, &Isometry3::identity());
        let read = parse(&text, &UrdfOptions::default()).unwrap();
        assert!(read.joints().all(|joint| joint.armature_kg_m2 == 0.01));
        assert_eq!(read.standing_rad, [0.0; 12]);
        for leg in &read.legs {
            let pose = leg_pose(leg, &nalgebra::Vector6::zeros());
            // Rounding only.
            assert!(pose.sole().rotation.angle() < 1e-7);
            assert!((pose.sole().translation.vector - pose.ankle_m()).norm() < 1e-15);
            assert!((read.base_height_m + pose.ankle_m().z).abs() < 1e-3);
        }
    }
}
