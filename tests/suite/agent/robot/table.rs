//! The joint table.

use super::{load, shipped};
use crate::common::repository;
use proptest::prelude::*;
use std::path::Path;
use urts_mc::agent::robot::dynamics::forward_dynamics;
use urts_mc::agent::robot::kinematics::{by_leg, com_m, leg_pose};
use urts_mc::agent::robot::{LEFT, RIGHT, Robot, RobotError, table};

fn text(name: &str) -> String {
    std::fs::read_to_string(repository(&format!("campaigns/robots/{name}.toml"))).unwrap()
}

fn parse(text: &str) -> Result<Robot, RobotError> {
    table::parse(text, Path::new("robots/x.toml"))
}

/// What is said of the G1's table with the n-th occurrence of a text replaced.
fn refusal_of(nth: usize, old: &str, new: &str) -> String {
    let text = text("g1_12dof");
    let (at, _) = text.match_indices(old).nth(nth).unwrap();
    let changed = format!("{}{new}{}", &text[..at], &text[at + old.len()..]);
    parse(&changed).unwrap_err().to_string()
}

#[test]
fn shipped_tables_are_robots_and_name_their_source() {
    let [g1, berkeley] = shipped();
    assert_eq!(g1, Robot::g1().unwrap());
    for robot in [&g1, &berkeley] {
        assert_eq!(robot.licence, "BSD-3-Clause");
        assert!(robot.attribution.starts_with("Copyright (c)"));
        assert_eq!(robot.joints().count(), 12);
        assert!(robot.joints().all(|joint| joint.damping_n_m_s == 0.0));
    }
    for name in ["g1_12dof", "berkeley_humanoid"] {
        assert!(text(name).contains("BSD-3-Clause, Copyright (c)"), "{name}");
    }
    // Sums of the tables.
    assert!(
        (g1.mass_kg() - 32.106_857_28).abs() < 1e-9,
        "{}",
        g1.mass_kg()
    );
    assert!(
        (berkeley.mass_kg() - 16.056_763_13).abs() < 1e-9,
        "{}",
        berkeley.mass_kg()
    );
}

#[test]
fn values_of_the_table_are_where_they_belong() {
    let g1 = load("g1_12dof");
    let knee = &g1.legs[RIGHT].joints[3];
    assert_eq!(knee.name, "r_knee");
    assert_eq!((knee.q_min_rad, knee.q_max_rad), (-0.087_267, 2.8798));
    assert_eq!((knee.rate_max_rad_s, knee.torque_max_n_m), (20.0, 139.0));
    assert_eq!((knee.armature_kg_m2, knee.body.mass_kg), (0.01, 1.932));
    assert_eq!(knee.body.com_m.y, -0.003_964);
    assert_eq!(knee.body.inertia_kg_m2[(1, 2)], 0.000_714_6);
    assert_eq!(g1.base_height_m, 0.793);
    assert_eq!(g1.standing_rad[3], 0.3);
    let foot = &g1.legs[LEFT].foot;
    assert_eq!(foot.sole.translation.z, -0.035);
    assert_eq!(foot.sole_corners_m[3], [0.12, 0.03]);
}

#[test]
fn soles_of_the_standing_robots_are_level() {
    for robot in shipped() {
        for (leg, q) in robot.legs.iter().zip(by_leg(&robot.standing_rad)) {
            let sole = leg_pose(leg, &q).sole();
            let angle = sole.rotation.angle();
            // The tables give the standing angles to a thousandth of a radian, in five joints of a leg.
            assert!(angle < 0.005, "{}: {angle}", robot.name);
            assert!(sole.translation.z < -0.4, "{}", robot.name);
        }
    }
}

#[test]
fn a_sole_given_by_its_bounds_has_their_corners() {
    let text = text("g1_12dof");
    let start = text.find("sole_corners").unwrap();
    let end = start + text[start..].find('\n').unwrap();
    let robot = parse(&format!("{}{}", &text[..start], &text[end..])).unwrap();
    let corners = &robot.legs[LEFT].foot.sole_corners_m;
    assert_eq!(
        corners[..],
        [[-0.05, 0.03], [-0.05, -0.03], [0.12, -0.03], [0.12, 0.03]]
    );
}

#[test]
fn refusals_name_key_value_limit_and_remedy() {
    let cases = [
        (
            refusal_of(0, "mass = 1.932", "mass = -1.0"),
            "robots/x.toml: joint[3].mass (l_knee) = -1: a mass is positive; give its true value",
        ),
        (
            refusal_of(0, "mass = 17.73485728", "mass = nan"),
            "base.mass (pelvis) = NaN: a number is finite and at most 1e6 in size; give it in m, rad, kg, s and N",
        ),
        (
            refusal_of(1, "q_max = 2.8798", "q_max = -0.1"),
            "joint[3].q_min (l_knee) = -0.087267: it lies below q_max = -0.1; give both limits in rad",
        ),
        (
            refusal_of(1, "axis = [1.0, 0.0, 0.0]", "axis = [0.0, 0.0, 0.0]"),
            "joint[5].axis (l_ankle_roll) = [0.0, 0.0, 0.0]: an axis has a direction",
        ),
        (
            refusal_of(0, "inertia = [0.011329,", "inertia = [-0.011329,"),
            "joint[3].inertia (l_knee) = [-0.011329, 4.82e-5, -4.49e-5, 0.011277, -0.0007146, 0.0015168]: no principal moment of a body is negative or exceeds the sum of the other two; give ixx ixy ixz iyy iyz izz",
        ),
        (
            refusal_of(0, "inertia = [0.011329,", "inertia = [0.021329,"),
            "no principal moment of a body is negative or exceeds the sum of the other two",
        ),
        (
            refusal_of(
                0,
                "inertia = [0.011329, 4.82e-05, -4.49e-05, 0.011277, -0.0007146, 0.0015168]",
                "inertia = [0, 0, 0, 0, 0, 0]",
            ),
            "joint[3].inertia (l_knee) = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]: an inertia tensor about the centre of mass is positive definite",
        ),
        (
            refusal_of(0, "armature = 0.01", "armature = -0.01"),
            "joint[0].armature (l_hip_pitch) = -0.01: an armature is not negative",
        ),
        (
            refusal_of(0, "damping = 0.0", "damping = -1.0"),
            "joint[0].damping (l_hip_pitch) = -1: a damping is not negative",
        ),
        (
            refusal_of(0, "tau_max = 88.0", "tau_max = 0.0"),
            "joint[0].tau_max (l_hip_pitch) = 0: a largest torque is positive",
        ),
        (
            refusal_of(0, "qd_max = 32.0", "qd_max = inf"),
            "joint[0].qd_max (l_hip_pitch) = inf: a number is finite",
        ),
        (
            refusal_of(0, "name = \"r_knee\"", "name = \"l_knee\""),
            "joint name = \"l_knee\": this name occurs twice; give each its own",
        ),
        (
            refusal_of(0, "parent = 7", "parent = 6"),
            "joint[8].parent (r_hip_yaw) = 6: here it is 7",
        ),
        (
            refusal_of(
                0,
                "xyz = [0.0, 0.064452, -0.1027]",
                "xyz = [0.0, -0.07, -0.1]",
            ),
            "joint[0].xyz (l_hip_pitch) = [0.0, -0.07, -0.1]: the left leg has a larger y than r_hip_pitch",
        ),
        (
            refusal_of(0, "0.3, -0.2, 0.0, -0.1", "0.3, -0.9, 0.0, -0.1"),
            "q_nominal[4] (l_ankle_pitch) = -0.9: the joint moves from -0.87267 to 0.5236 rad; give a pose within the limits",
        ),
        (
            refusal_of(0, "root_height_nominal = 0.793", "root_height_nominal = 0"),
            "root_height_nominal = 0: the height of the pelvis is positive",
        ),
        (
            refusal_of(0, "sole_x = [-0.05, 0.12]", "sole_x = [0.12, -0.05]"),
            "foot.sole_x = [0.12, -0.05]: a range goes up",
        ),
        (
            refusal_of(0, "right_joint = 11", "right_joint = 10"),
            "foot.right_joint = 10: here it is 11",
        ),
    ];
    for (message, expected) in cases {
        assert!(message.contains(expected), "{message}\n{expected}");
    }
}

#[test]
fn other_counts_of_joints_are_refused() {
    let text = text("g1_12dof");
    let last = text.rfind("[[joint]]").unwrap();
    let message = parse(&text[..last]).unwrap_err().to_string();
    let expected = "robots/x.toml: number of [[joint]] = 11: a robot has 12 joints, six for each leg; give those of the left leg";
    assert!(message.starts_with(expected), "{message}");
}

#[test]
fn unknown_missing_and_mistyped_keys_are_refused_with_their_line() {
    let cases = [
        (
            refusal_of(0, "armature = 0.01", "armatur = 0.01"),
            [
                "robots/x.toml: line 50, column 1",
                "unknown key `armatur`, expected one of",
            ],
        ),
        (
            refusal_of(0, "tau_max = 139.0\n", ""),
            [
                "robots/x.toml: line 54, column 1",
                "missing key `tau_max`; add it",
            ],
        ),
        (
            refusal_of(0, "mass = 1.932", "mass = \"1.932\""),
            [
                "robots/x.toml: line 104, column 8",
                "expected f64; write it as in campaigns/robots/g1_12dof.toml",
            ],
        ),
        (
            refusal_of(0, "com = [", "com = [["),
            [
                "robots/x.toml: line 24, column 1",
                "missing comma between array elements",
            ],
        ),
    ];
    for (message, expected) in cases {
        for part in expected {
            assert!(message.contains(part), "{message}\n{part}");
        }
    }
}

#[test]
fn lists_take_neither_more_nor_fewer_values() {
    // With the keys of the right foot, which the shipped table takes from the left one.
    let whole = text("g1_12dof").replace(
        "sole_offset = ",
        "right_foot_xyz = [0.0, 0.0, -0.035]\nleft_foot_rpy = [0.0, 0.0, 0.0]\nright_foot_rpy = [0.0, 0.0, 0.0]\nsole_offset = ",
    );
    parse(&whole).unwrap();
    let mut keys = std::collections::BTreeSet::new();
    for (at, _) in whole.match_indices(" = [") {
        let (key, rest) = whole.split_at(at);
        let key = key.rsplit('\n').next().unwrap();
        let list = &rest[3..3 + rest[3..].find(']').unwrap()];
        // The innermost list: that of the first corner.
        let first = list.trim_start_matches('[');
        let opening = at + 3 + list.len() - first.len();
        let (before, after) = (&whole[..opening], &whole[opening..]);
        let count = first.split(',').count();
        let fewer = first.split_once(',').unwrap().0.len() + 1;
        for (changed, given) in [
            (format!("{before}0.5, {after}"), count + 1),
            (format!("{before}{}", &after[fewer..]), count - 1),
        ] {
            let said = parse(&changed).unwrap_err().to_string();
            let expected = format!(
                "invalid length {given}, expected a list of length {count}; give exactly so many values"
            );
            assert!(
                said.starts_with("robots/x.toml: line ") && said.ends_with(&expected),
                "{key}: {said}"
            );
        }
        keys.insert(key);
    }
    // gravity, q_nominal, com, inertia, xyz, rpy, axis, and eight of the feet.
    assert_eq!(keys.len(), 15, "{keys:?}");
}

#[test]
fn unreadable_files_and_other_formats_are_refused() {
    let missing = Robot::load(Path::new("robots/none.toml")).unwrap_err();
    assert!(matches!(missing, RobotError::Read { .. }));
    let said = missing.to_string();
    assert!(
        said.starts_with("robots/none.toml: cannot be read (")
            && said.ends_with("name an existing robot file"),
        "{said}"
    );
    let other = Robot::load(Path::new("robots/g1.xml")).unwrap_err();
    assert_eq!(
        other.to_string(),
        "robots/g1.xml: a robot file ends in .toml (joint table) or .urdf; rename it or name another"
    );
}

/// The n-th number of a text replaced.
fn with_number(text: &str, nth: usize, new: &str) -> String {
    let is_numeral = |c: char| c.is_ascii_digit() || "+-.e".contains(c);
    let mut spans = Vec::new();
    let mut at = 0;
    for word in text.split_inclusive(|c: char| !is_numeral(c)) {
        let numeral = word.trim_end_matches(|c: char| !is_numeral(c));
        if numeral.parse::<f64>().is_ok() {
            spans.push(at..at + numeral.len());
        }
        at += word.len();
    }
    let span = spans[nth % spans.len()].clone();
    format!("{}{new}{}", &text[..span.start], &text[span.end..])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, rng_seed: proptest::test_runner::RngSeed::Fixed(5), failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever number stands in the table, it is a robot or a refusal, and a robot can be computed with.
    #[test]
    fn mutated_numbers_never_panic(
        nth in 0_usize..500,
        number in prop_oneof![
            any::<f64>().prop_map(|number| format!("{number:e}")),
            (-30.0..30.0_f64).prop_map(|number| format!("{number:.3}")),
            prop::sample::select(vec!["nan", "inf", "-inf", "0.0", "-0.0", "5e-324", "1e308", "-7", "1e", "99999999999999999999", "true"])
                .prop_map(String::from),
        ],
        berkeley in any::<bool>(),
    ) {
        let text = text(if berkeley { "berkeley_humanoid" } else { "g1_12dof" });
        match parse(&with_number(&text, nth, &number)) {
            Ok(robot) => {
                let com = com_m(&robot, &robot.standing_rad);
                prop_assert!(com.iter().all(|x| x.is_finite()));
                for (leg, q) in robot.legs.iter().zip(by_leg(&robot.standing_rad)) {
                    // May be no number where a link is next to weightless, but must come.
                    let _ = forward_dynamics(leg, &robot.gravity_m_s2, &q, &q, &q);
                }
            }
            Err(error) => prop_assert!(error.to_string().starts_with("robots/x.toml: ")),
        }
    }

    #[test]
    fn truncated_and_garbled_tables_never_panic(cut in 0_usize..8000, garbage in ".{0,20}") {
        let text = text("g1_12dof");
        let cut = cut.min(text.len());
        let _ = parse(&format!("{}{garbage}", &text[..cut]));
        let _ = parse(&format!("{}{garbage}{}", &text[..cut], &text[cut..]));
    }
}
