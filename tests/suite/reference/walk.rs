//! The walking reference.
//!
//! | module | holds |
//! |---|---|
//! | `straight` | a straight walk against an independent implementation |
//! | `turning` | walks along curves: balance, feet, joints; another robot |
//! | `refusals` | what is refused, and in which words |
//! | `gaits` | gaits of robots of other sizes, the nearest that can be walked |
//! | `properties` | splines; no input makes planning panic |

mod gaits;
mod properties;
mod refusals;
mod straight;
mod turning;

use urts_mc::agent::robot::Robot;
use urts_mc::reference::walk::{Gait, Walk, ground_reaction, zmp};

fn g1() -> Robot {
    Robot::g1().unwrap()
}

/// A walk of the G1 with its own gait.
fn walk(waypoints: &[[f64; 2]]) -> Walk {
    Walk::plan(&g1(), waypoints, &Gait::G1).unwrap()
}

/// `points` + 1 waypoints on an arc of 90 degrees to the left (or right: `side` -1), `length_m` long, from the origin
/// along x.
fn quarter_turn(length_m: f64, side: f64, points: u32) -> Vec<[f64; 2]> {
    let radius = length_m / std::f64::consts::FRAC_PI_2;
    let angles =
        (0..=points).map(|k| std::f64::consts::FRAC_PI_2 * f64::from(k) / f64::from(points));
    angles
        .map(|angle| [radius * angle.sin(), side * radius * (1.0 - angle.cos())])
        .collect()
}

/// Least distance of the zero moment point inside the support polygon over all samples, m: of the pendulum and of all
/// links.
fn margins(robot: &Robot, walk: &Walk) -> [f64; 2] {
    let soles = zmp::soles(robot);
    let samples = walk.times_s().zip(&walk.com.zmp_m);
    samples.fold([f64::INFINITY; 2], |[pendulum, links], (t_s, &point)| {
        let polygon = zmp::support_polygon(&walk.feet, &soles, t_s);
        let reaction = ground_reaction(walk, robot, t_s);
        [
            zmp::margin(&polygon, point).min(pendulum),
            zmp::margin(&polygon, reaction.zmp_m).min(links),
        ]
    })
}
