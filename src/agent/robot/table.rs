//! The joint table: a robot as a TOML file of plain numbers, one `[[joint]]` per joint and its link
//! (campaigns/robots/*.toml).

use super::check::{Check, Names, Place, RawJoint, tensor};
use super::error::RobotError;
use super::structure::{Body, Foot, JOINTS, Joint, LEG_JOINTS, Leg, Robot};
use crate::util::fixed_list::List;
use nalgebra::Vector3;
use serde::Deserialize;
use std::path::Path;

pub(super) const NAMES: Names = Names {
    mass: "mass",
    com: "com",
    inertia: "inertia",
    xyz: "xyz",
    rpy: "rpy",
    axis: "axis",
    q_min: "q_min",
    q_max: "q_max",
    rate_max: "qd_max",
    torque_max: "tau_max",
    armature: "armature",
    damping: "damping",
};

/// Checks the text of a joint table; `path` is for messages.
///
/// # Errors
/// The first thing that is wrong with it, with file, key, value, limit and remedy.
pub fn parse(text: &str, path: &Path) -> Result<Robot, RobotError> {
    let file: RobotFile = toml::from_str(text).map_err(|error| syntax(path, &error))?;
    let names = &NAMES;
    let check = Check { path, names };
    check.finite("gravity", &file.gravity.0)?;
    let height_m = file.root_height_nominal;
    check.positive("root_height_nominal", height_m, "the height of the pelvis")?;
    let place = Place {
        prefix: "base.",
        name: &file.base.name,
    };
    let inertial = Inertial {
        mass: file.base.mass,
        com: file.base.com.0,
        inertia: file.base.inertia.0,
    };
    let base = body(&check, place, &inertial)?;
    let legs = legs(&check, &file.joint, &file.foot)?;
    check.standing("q_nominal", &legs, &file.q_nominal.0)?;
    Ok(Robot {
        name: file.name,
        licence: file.licence,
        attribution: file.attribution,
        gravity_m_s2: file.gravity.0.into(),
        base,
        base_height_m: height_m,
        standing_rad: file.q_nominal.0,
        legs,
        notes: Vec::new(),
    })
}

fn legs(check: &Check<'_>, rows: &[JointRow], foot: &FootTable) -> Result<[Leg; 2], RobotError> {
    let rows = rows.try_into().map_err(|_| {
        check.invalid(
            "number of [[joint]]",
            rows.len(),
            "a robot has 12 joints, six for each leg",
            "give those of the left leg, then those of the right leg, and lock all others",
        )
    })?;
    in_order(check, rows, foot)?;
    let [left_foot, right_foot] = feet(check, foot)?;
    Ok([
        Leg {
            joints: leg_joints(check, rows, 0)?,
            foot: left_foot,
        },
        Leg {
            joints: leg_joints(check, rows, LEG_JOINTS)?,
            foot: right_foot,
        },
    ])
}

/// Refuses any order of the joints but left leg, right leg, each from the hip to the ankle.
fn in_order(
    check: &Check<'_>,
    rows: &[JointRow; JOINTS],
    foot: &FootTable,
) -> Result<(), RobotError> {
    check.unique("joint name", rows.iter().map(|row| row.name.as_str()))?;
    let expect = |key: String, value: i64, expected: i64| {
        if value == expected {
            return Ok(());
        }
        Err(check.invalid(
            key,
            value,
            format!("here it is {expected}: six joints of the left leg, six of the right, each from the hip down"),
            "put the joints in this order",
        ))
    };
    for ((i, row), index) in rows.iter().enumerate().zip(0..) {
        let prefix = &format!("joint[{i}].");
        let name = &row.name;
        let place = Place { prefix, name };
        let parent = if i % LEG_JOINTS == 0 { -1 } else { index - 1 };
        expect(place.key("index"), row.index, index)?;
        expect(place.key("parent"), row.parent, parent)?;
    }
    expect("foot.left_joint".into(), foot.left_joint, 5)?;
    expect("foot.right_joint".into(), foot.right_joint, 11)?;
    let [left, right] = [&rows[0], &rows[LEG_JOINTS]];
    if left.xyz.0[1] <= right.xyz.0[1] {
        return Err(check.invalid(
            format!("joint[0].xyz ({})", left.name),
            format!("{:?}", left.xyz.0),
            format!(
                "the left leg has a larger y than {} at {:?}",
                right.name, right.xyz.0
            ),
            "give the left leg first, in a pelvis frame with y to the left",
        ));
    }
    Ok(())
}

fn leg_joints(
    check: &Check<'_>,
    rows: &[JointRow; JOINTS],
    first: usize,
) -> Result<[Joint; LEG_JOINTS], RobotError> {
    let at = |i| joint(check, first + i, &rows[first + i]);
    Ok([at(0)?, at(1)?, at(2)?, at(3)?, at(4)?, at(5)?])
}

fn joint(check: &Check<'_>, i: usize, row: &JointRow) -> Result<Joint, RobotError> {
    let prefix = &format!("joint[{i}].");
    let name = &row.name;
    let place = Place { prefix, name };
    if let Some(alternative) = row.armature_alt {
        check.not_negative(&place.key("armature_alt"), alternative, "an armature")?;
    }
    let inertial = Inertial {
        mass: row.mass,
        com: row.com.0,
        inertia: row.inertia.0,
    };
    let raw = RawJoint {
        xyz: row.xyz.0,
        rpy: row.rpy.0,
        axis: row.axis.0,
        q_min: row.q_min,
        q_max: row.q_max,
        rate_max: row.qd_max,
        torque_max: row.tau_max,
        armature: row.armature,
        damping: row.damping,
    };
    check.joint(place, &raw, body(check, place, &inertial)?)
}

struct Inertial {
    mass: f64,
    com: [f64; 3],
    inertia: [f64; 6],
}

fn body(check: &Check<'_>, place: Place<'_>, raw: &Inertial) -> Result<Body, RobotError> {
    check.body(place, raw.mass, raw.com.into(), &tensor(raw.inertia))
}

/// The left and the right foot.
fn feet(check: &Check<'_>, table: &FootTable) -> Result<[Foot; 2], RobotError> {
    let corners = corners(check, table)?;
    let ankle_offset_m = Vector3::from(table.ankle_offset.0);
    let foot = |xyz, rpy_key: &str, rpy: Option<List<f64, 3>>| {
        let rpy = rpy.map_or([0.0; 3], |list| list.0);
        let sole = check.pose("foot.sole_offset", xyz, rpy_key, rpy)?;
        let foot = Foot {
            ankle_offset_m,
            sole,
            sole_corners_m: corners.clone(),
        };
        check.foot("foot.ankle_offset", &foot)?;
        Ok(foot)
    };
    let right_xyz = table.right_foot_xyz.unwrap_or(table.sole_offset).0;
    Ok([
        foot(
            table.sole_offset.0,
            "foot.left_foot_rpy",
            table.left_foot_rpy,
        )?,
        foot(right_xyz, "foot.right_foot_rpy", table.right_foot_rpy)?,
    ])
}

/// The sole's corners: those given, or those of the rectangle given.
fn corners(check: &Check<'_>, table: &FootTable) -> Result<Vec<[f64; 2]>, RobotError> {
    let rectangle = match (table.sole_x, table.sole_y) {
        (Some(List(x)), Some(List(y))) => {
            for (key, range) in [("foot.sole_x", x), ("foot.sole_y", y)] {
                check.finite(key, &range)?;
                if range[0] >= range[1] {
                    return Err(check.invalid(
                        key,
                        format!("{range:?}"),
                        "a range goes up",
                        "give the least and the largest coordinate of the sole",
                    ));
                }
            }
            vec![[x[0], y[1]], [x[0], y[0]], [x[1], y[0]], [x[1], y[1]]]
        }
        _ => Vec::new(),
    };
    let Some(corners) = &table.sole_corners else {
        return Ok(rectangle);
    };
    for (i, corner) in corners.iter().enumerate() {
        check.finite(&format!("foot.sole_corners[{i}]"), &corner.0)?;
    }
    Ok(corners.iter().map(|corner| corner.0).collect())
}

/// A parse error with its line and what to do.
fn syntax(path: &Path, error: &toml::de::Error) -> RobotError {
    let message = error.message();
    let shown = error.to_string();
    let place = shown.trim_end().strip_suffix(message).unwrap_or_default();
    let place = place.strip_prefix("TOML parse error at ").unwrap_or(place);
    let remedy = if message.starts_with("unknown field") {
        "remove it or take one of these"
    } else if message.starts_with("missing field") {
        "add it"
    } else if message.starts_with("invalid length") {
        "give exactly so many values"
    } else {
        "write it as in campaigns/robots/g1_12dof.toml"
    };
    let message = message
        .replace("unknown field", "unknown key")
        .replace("missing field", "missing key");
    RobotError::Syntax {
        path: path.to_path_buf(),
        message: format!("{place}{message}; {remedy}"),
    }
}

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotFile {
    name: String,
    licence: String,
    attribution: String,
    /// World frame, m/s^2.
    gravity: List<f64, 3>,
    /// m
    root_height_nominal: f64,
    /// rad
    q_nominal: List<f64, JOINTS>,
    base: BaseTable,
    foot: FootTable,
    joint: Vec<JointRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BaseTable {
    name: String,
    mass: f64,
    com: List<f64, 3>,
    /// ixx, ixy, ixz, iyy, iyz, izz about the centre of mass, kg m^2.
    inertia: List<f64, 6>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FootTable {
    /// Index of the left leg's last joint.
    left_joint: i64,
    /// Index of the right leg's last joint.
    right_joint: i64,
    ankle_offset: List<f64, 3>,
    /// Origin of the sole's frame in the last link's frame; the left one's if `right_foot_xyz` is given.
    sole_offset: List<f64, 3>,
    right_foot_xyz: Option<List<f64, 3>>,
    /// Angles of the sole's frame in the last link's frame (default: parallel to it).
    left_foot_rpy: Option<List<f64, 3>>,
    right_foot_rpy: Option<List<f64, 3>>,
    /// Bounds of the sole in its frame.
    sole_x: Option<List<f64, 2>>,
    sole_y: Option<List<f64, 2>>,
    /// Corners of the sole in its frame (default: those of the bounds).
    sole_corners: Option<Vec<List<f64, 2>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointRow {
    index: i64,
    name: String,
    /// What the source of the numbers calls it.
    #[serde(rename = "source_name")]
    _source_name: Option<String>,
    /// Index of the joint before it, -1 for the pelvis.
    parent: i64,
    xyz: List<f64, 3>,
    /// Roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll).
    rpy: List<f64, 3>,
    axis: List<f64, 3>,
    q_min: f64,
    q_max: f64,
    qd_max: f64,
    tau_max: f64,
    mass: f64,
    com: List<f64, 3>,
    inertia: List<f64, 6>,
    armature: f64,
    /// Another source's armature; not used.
    armature_alt: Option<f64>,
    damping: f64,
}
