//! The legs of a robot, drawn from the side and from the front.

use super::page::document::LegendEntry;
use super::page::plot::{Axis, Color, Mark, Plot, Stroke};
use super::page::plot_grid::plot_grid;
use crate::agent::robot::inverse::level_below_hip;
use crate::agent::robot::kinematics::{by_leg, leg_pose};
use crate::agent::robot::{Leg, Robot};
use crate::util::format::number;
use nalgebra::{Point3, Vector3, Vector6};

/// Colours of the left and of the right leg, as in the figures of a walk.
const LEGS: [Color; 2] = [Color::Series(4), Color::Series(3)];
/// Half the length of a sole whose corners are not known, m.
const HALF_SOLE_M: f64 = 0.08;

/// Both legs in the standing pose, and with bent knees where such a pose is found, as a picture.
#[must_use]
pub fn robot_picture(robot: &Robot) -> String {
    let standing = by_leg(&robot.standing_rad);
    let bent: Vec<Option<Vector6<f64>>> = robot.legs.iter().map(level_below_hip).collect();
    let panel = |title: &str, label: &str, across: usize, poses: [Option<Vector6<f64>>; 2]| {
        let mut marks = Vec::new();
        for ((leg, pose), color) in robot.legs.iter().zip(poses).zip(LEGS) {
            let Some(q_rad) = pose else { continue };
            let flat = |points: Vec<Vector3<f64>>| -> Vec<(f64, f64)> {
                points
                    .iter()
                    .map(|point| (point[across], point.z))
                    .collect()
            };
            let (bones, sole) = drawn(leg, &q_rad);
            marks.push(Mark::Line(flat(sole), color, Stroke::Dashed));
            marks.push(Mark::Line(flat(bones.clone()), color, Stroke::Solid));
            marks.push(Mark::Dots(flat(bones), color));
        }
        Plot {
            title: title.to_string(),
            x: Axis::new(label),
            y: Axis::new("z, m"),
            marks,
            equal: true,
            ..Plot::default()
        }
    };
    let stands = standing.map(Some);
    let bends = [bent[0], bent[1]];
    let panels = [
        panel("standing, from the side", "x, m", 0, stands),
        panel("standing, from the front", "y, m", 1, stands),
        panel("knees bent, from the side", "x, m", 0, bends),
        panel("knees bent, from the front", "y, m", 1, bends),
    ];
    let subtitle = format!(
        "in the pelvis frame; {} kg, of which the legs {} kg",
        number(robot.mass_kg()),
        number(robot.legs.iter().map(Leg::mass_kg).sum())
    );
    let legend = [
        LegendEntry::line(LEGS[0], "left leg, its joints as dots"),
        LegendEntry::line(LEGS[1], "right leg"),
        LegendEntry::dashes(Color::Truth, "soles"),
    ];
    plot_grid(&robot.name, &subtitle, &panels, 2, &legend)
}

/// The line over the joints of a leg from the pelvis to its ankle, and its sole, in the pelvis frame, m.
fn drawn(leg: &Leg, q_rad: &Vector6<f64>) -> (Vec<Vector3<f64>>, Vec<Vector3<f64>>) {
    let pose = leg_pose(leg, q_rad);
    let mut bones = vec![Vector3::zeros()];
    bones.extend(pose.origins_m);
    bones.push(pose.ankle_m());
    let corners = match &*leg.foot.sole_corners_m {
        [] => vec![[-HALF_SOLE_M, 0.0], [HALF_SOLE_M, 0.0]],
        corners => corners.iter().chain(corners.first()).copied().collect(),
    };
    let sole = pose.sole();
    let corners = corners.into_iter();
    let sole = corners.map(|[x, y]| (sole * Point3::new(x, y, 0.0)).coords);
    (bones, sole.collect())
}
