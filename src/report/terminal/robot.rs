//! What was understood of a robot's file, for people and for programs.

use crate::agent::robot::inverse::reach_m;
use crate::agent::robot::kinematics::leg_pose;
use crate::agent::robot::{JOINTS, LEG_JOINTS, Leg, Robot};
use crate::reference::walk::{Gait, Walk};
use crate::report::page::document::{Block, Cell, Document, Grid, Section};
use crate::report::page::text::text;
use crate::util::format::number;
use nalgebra::Vector6;
use serde_json::{Value, json};

/// The sides, in the order of the legs.
const SIDES: [&str; 2] = ["left", "right"];

/// A robot, and whether it can walk along a line: with the walk, or why there is none and what to do.
#[must_use]
pub fn robot(robot: &Robot, walk: &Result<Walk, String>) -> String {
    let notes = robot.notes.iter().map(Block::text).collect();
    let legs = robot.legs.iter().zip(SIDES);
    let legs = legs.map(|(leg, side)| {
        let heading = format!("{side} leg");
        let note = format!(
            ": {} kg, reaches {} m from its hip",
            number(leg.mass_kg()),
            number(reach_m(leg))
        );
        Section::explained(heading, note, vec![Block::Grid(joints(leg))])
    });
    let mut sections = vec![Section::new("notes", notes)];
    sections.extend(legs);
    sections.push(Section::new("whole", vec![Block::Grid(whole(robot))]));
    sections.push(Section::new("walk", walked(robot, walk)));
    text(&Document {
        title: format!(
            "{}: {JOINTS} joints, {} kg",
            robot.name,
            number(robot.mass_kg())
        ),
        subtitle: match (&*robot.attribution, &*robot.licence) {
            ("", "") => String::new(),
            (whose, licence) => format!("{whose} {licence}").trim().to_string(),
        },
        sections,
        ..Document::default()
    })
}

/// The joints of a leg, in the order of the joint vector.
fn joints(leg: &Leg) -> Grid {
    let mut grid = Grid::new([
        "joint",
        "axis at 0",
        "range, rad",
        "rad/s",
        "N m",
        "armature",
        "damping",
        "link, kg",
    ]);
    let axes = leg_pose(leg, &Vector6::zeros()).axes;
    for (joint, axis) in leg.joints.iter().zip(axes) {
        let range = format!("{} .. {}", number(joint.q_min_rad), number(joint.q_max_rad));
        let mut row = vec![
            Cell::text(&joint.name),
            Cell::Text(direction(axis.into())),
            Cell::Number(range),
        ];
        let numbers = [
            joint.rate_max_rad_s,
            joint.torque_max_n_m,
            joint.armature_kg_m2,
            joint.damping_n_m_s,
            joint.body.mass_kg,
        ];
        row.extend(numbers.map(|value| Cell::Number(number(value))));
        grid.rows.push(row);
    }
    grid
}

/// An axis in words where it is one of the pelvis frame's, else its parts.
fn direction(axis: [f64; 3]) -> String {
    const NEAR: f64 = 1e-6;
    for (name, part) in ["x", "y", "z"].into_iter().zip(axis) {
        if (part.abs() - 1.0).abs() < NEAR {
            return format!("{}{name}", if part < 0.0 { "-" } else { "+" });
        }
    }
    let [x, y, z] = axis.map(|part| format!("{part:.3}"));
    format!("({x}, {y}, {z})")
}

fn whole(robot: &Robot) -> Grid {
    let list = |values: &[f64]| {
        let values: Vec<String> = values.iter().map(|value| number(*value)).collect();
        values.join(", ")
    };
    let com_m = robot.base.com_m;
    let (left, right) = robot.standing_rad.split_at(LEG_JOINTS);
    let rows = [
        (
            "pelvis and what is fixed to it, kg",
            number(robot.base.mass_kg),
        ),
        (
            "its centre of mass in the pelvis frame, m",
            list(com_m.as_slice()),
        ),
        ("standing pose of the left leg, rad", list(left)),
        ("of the right leg, rad", list(right)),
        (
            "pelvis frame above the soles then, m",
            number(robot.base_height_m),
        ),
    ];
    Grid {
        head: Vec::new(),
        rows: rows
            .into_iter()
            .map(|(what, value)| vec![Cell::text(what), Cell::Text(value)])
            .collect(),
    }
}

fn walked(robot: &Robot, walk: &Result<Walk, String>) -> Vec<Block> {
    let (verdict, gait) = match walk {
        Ok(walk) => (
            Cell::Verdict(
                true,
                format!(
                    "can be walked: {} steps over {} m in {} s",
                    walk.feet.swings().len(),
                    number(walk.course.length_m()),
                    number(walk.duration_s())
                ),
            ),
            Some(walk.gait),
        ),
        Err(why) => (
            Cell::Verdict(false, format!("cannot be walked: {why}")),
            None,
        ),
    };
    let of_robot = "the gait of a robot of this size, where [reference.gait] says nothing else";
    let said = match gait {
        Some(_) => "the gait",
        None => of_robot,
    };
    let numbers = gait.unwrap_or_else(|| Gait::of(robot));
    let rows = numbers.numbers().into_iter();
    let grid = |rows| Grid {
        head: Vec::new(),
        rows,
    };
    vec![
        Block::Grid(grid(vec![vec![verdict]])),
        Block::Folded(
            said.to_string(),
            vec![Block::Grid(grid(
                rows.map(|(name, value)| vec![Cell::text(name), Cell::Number(number(value))])
                    .collect(),
            ))],
        ),
    ]
}

/// [`robot`] for programs.
#[must_use]
pub fn robot_json(robot: &Robot, walk: &Result<Walk, String>) -> Value {
    let legs = robot.legs.iter().zip(SIDES);
    let legs = legs.map(|(leg, side)| {
        let axes = leg_pose(leg, &Vector6::zeros()).axes;
        let joints = leg.joints.iter().zip(axes).map(|(joint, axis)| {
            json!({
                "name": joint.name, "axis_at_zero": <[f64; 3]>::from(axis),
                "q_min_rad": joint.q_min_rad, "q_max_rad": joint.q_max_rad,
                "rate_max_rad_s": joint.rate_max_rad_s, "torque_max_n_m": joint.torque_max_n_m,
                "armature_kg_m2": joint.armature_kg_m2, "damping_n_m_s": joint.damping_n_m_s,
                "link_mass_kg": joint.body.mass_kg,
            })
        });
        json!({
            "side": side, "mass_kg": leg.mass_kg(), "reach_m": reach_m(leg),
            "joints": joints.collect::<Vec<_>>(),
        })
    });
    let gait = walk
        .as_ref()
        .map_or_else(|_| Gait::of(robot), |walk| walk.gait);
    let gait = gait.numbers().into_iter();
    let gait = gait.map(|(name, value)| (name.to_string(), json!(value)));
    json!({
        "name": robot.name, "licence": robot.licence, "attribution": robot.attribution,
        "mass_kg": robot.mass_kg(),
        "pelvis": { "mass_kg": robot.base.mass_kg, "com_m": <[f64; 3]>::from(robot.base.com_m) },
        "legs": legs.collect::<Vec<_>>(),
        "standing_rad": robot.standing_rad, "pelvis_above_soles_m": robot.base_height_m,
        "notes": robot.notes,
        "walk": {
            "can_be_walked": walk.is_ok(), "reason": walk.as_ref().err(),
            "duration_s": walk.as_ref().ok().map(Walk::duration_s),
            "gait": gait.collect::<serde_json::Map<_, _>>(),
        },
    })
}
