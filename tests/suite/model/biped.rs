//! Robots in the episode loop.
//!
//! | module | holds |
//! |---|---|
//! | `closed_loop` | a walk under disturbance and coupling against independent trajectories |
//! | `independent` | the whole loop against the paper's formulas, written down plainly in double precision |
//! | `limits` | torques at their limits: what is cut, counted and told |
//! | `lanes` | the lane types among each other; what one robot's divergence does to the others |

mod closed_loop;
mod independent;
mod lanes;
mod limits;

use crate::common::altered;
use urts_mc::campaign::Campaign;

/// Three robots that meet everything at once: coupling, the ground, friction, sines, faults of sensors and actuators, a
/// true mass of their own, and initial errors that torques at their limits must correct.
fn everything(actuation: &str) -> Campaign {
    let more = r#"[coupling]
kappa = { uniform = [0.5, 1.0] }

[[disturbance]]
kind = "sine"
amplitude = { uniform = [2.0, 5.0] }
frequency_rad_s = { uniform = [3.0, 20.0] }
phase_rad = { uniform = [0.0, 6.0] }

[[disturbance]]
kind = "ground-reaction"
scale = 0.25

[[disturbance]]
kind = "friction"
coulomb = [0.2, 0.4, 0.1, 0.3, 0.2, 0.1, 0.2, 0.4, 0.1, 0.3, 0.2, 0.1]
viscous = { uniform = [0.0, 0.2] }
smoothing_rate = 0.1

[[fault]]
target = "sensor"
kind = "smoothed-square"
amplitude = { uniform = [0.01, 0.1] }
period_s = { uniform = [0.2, 0.4] }
smoothing = 0.1
phase_rad = { uniform = [0.0, 6.0] }

[[fault]]
target = "actuator"
kind = "loss-of-effectiveness"
onset_s = { uniform = [0.05, 0.2] }
magnitude = { uniform = [0.1, 0.5] }

[[fault]]
target = "actuator"
kind = "bias"
channels = "one"
onset_s = { uniform = [0.05, 0.2] }
magnitude = 3.0
"#;
    altered(
        "biped-ground-reaction",
        &[
            more,
            "agent.team=3",
            &format!("agent.actuation={actuation}"),
            "reference.agents=[{ start_s = -2.0 }, { start_s = -2.7 }, { start_s = -3.1 }]",
            "initial.error.normal.std=0.1",
            "initial.error_rate={ normal = { mean = 0.0, std = 0.5 } }",
            "initial.error_integral={ normal = { mean = 0.0, std = 0.01 } }",
        ],
    )
}
