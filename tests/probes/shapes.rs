//! The shapes that are checked and probed.

use crate::backend::gpu::shader::PLANTS;
use crate::backend::gpu::shader::Shape;
use crate::backend::gpu::words::Counts;
use crate::campaign::{ActuationKind, Uav};
use crate::model::episode::PlantKind;
use crate::model::plant_biped::Leg;
use crate::model::plant_uav::{Attitude, Axis, Thrust};
use crate::robot::Robot;
use std::path::Path;

/// No signal.
const NONE: Counts = Counts {
    losses: 0,
    command_biases: 0,
    sensor_biases: 0,
    noises: 0,
    squares: 0,
    sines: 0,
};
/// Several of each kind, in numbers that no two kinds next to each other share.
const ALL: Counts = Counts {
    losses: 2,
    command_biases: 1,
    sensor_biases: 2,
    noises: 2,
    squares: 1,
    sines: 2,
};

fn shape(plant: PlantKind, team: usize, ftc: bool, coupled: bool, counts: Counts) -> Shape {
    let channels = match plant {
        PlantKind::Axis => 1,
        PlantKind::Attitude => 3,
        PlantKind::Thrust | PlantKind::Leg => 6,
    };
    // The commands of those legs are cut whose team is coupled.
    let cut = plant == PlantKind::Leg && coupled;
    let plant_constants = match plant {
        PlantKind::Leg => leg::<false>().model.shader_constants(),
        PlantKind::Axis | PlantKind::Attitude | PlantKind::Thrust => Vec::new(),
    };
    Shape {
        plant,
        plant_constants,
        cut,
        channels,
        rows: match (plant, cut) {
            (PlantKind::Leg, true) => 5,
            (PlantKind::Leg, false) => 3,
            _ => 1,
        },
        team,
        lanes: if channels * team > 9 { 4 } else { 8 },
        ftc,
        coupled,
        observer_measured: coupled,
        counts,
        noise_entries: [3, 7].into_iter().take(counts.noises).collect(),
    }
}

/// A shape for functions that depend on none.
pub(super) fn plain() -> Shape {
    Shape {
        lanes: 64,
        ..shape(PlantKind::Axis, 1, true, false, NONE)
    }
}

/// The shapes whose functions are probed: each plant for one agent and for a coupled team, each controller, without and with
/// signals.
pub(super) fn probed() -> [Shape; 8] {
    let noisy = Counts { noises: 1, ..NONE };
    [
        shape(PlantKind::Axis, 1, true, false, ALL),
        shape(PlantKind::Axis, 3, false, true, noisy),
        shape(PlantKind::Attitude, 1, false, false, NONE),
        shape(PlantKind::Attitude, 3, true, true, ALL),
        shape(PlantKind::Thrust, 1, false, false, ALL),
        shape(PlantKind::Thrust, 3, true, true, ALL),
        shape(PlantKind::Leg, 1, false, false, ALL),
        shape(PlantKind::Leg, 2, true, true, noisy),
    ]
}

/// The shapes whose text is validated: every plant, controller and team size, each kind of signal on its own, all and none.
pub(super) fn validated() -> Vec<Shape> {
    let single = |k: usize| {
        let one = |kind: usize| usize::from(k == kind);
        Counts {
            losses: one(0),
            command_biases: one(1),
            sensor_biases: one(2),
            noises: one(3),
            squares: one(4),
            sines: one(5),
        }
    };
    let counts = (0..6).map(single).chain([NONE, ALL]);
    let mut shapes = Vec::new();
    for counts in counts {
        for plant in PLANTS {
            for (team, coupled) in [(1, false), (3, false), (3, true)] {
                for ftc in [false, true] {
                    shapes.push(shape(plant, team, ftc, coupled, counts));
                }
            }
        }
    }
    shapes
}

/// A vehicle whose limits are met by some of the random states, and not by others.
fn uav() -> Uav {
    Uav {
        actuation: ActuationKind::Thrust,
        mass_kg: 1.3,
        inertia_kg_m2: [0.7, 0.9, 1.4],
        drag_n_s_m: 0.25,
        angular_drag_n_m_s: 0.15,
        gravity_m_s2: 9.81,
        command_filter_rad_s: 12.0,
        max_thrust_n: 5.0,
        max_torque_n_m: 100.0,
        max_tilt_rad: 0.6,
    }
}

pub(super) fn axis() -> Axis<f32> {
    Axis::new(&uav(), 2)
}

pub(super) fn attitude() -> Attitude<f32> {
    Attitude::new(&uav())
}

pub(super) fn thrust() -> Thrust<f32> {
    Thrust::new(&uav())
}

/// A right leg with damped joints, whose limits are met by some of the random states. Its rotors are heavy, so that no joint
/// moves far more than the others, in which rounding errors would drown it.
pub(super) fn leg<const CUT: bool>() -> Leg<f32, CUT> {
    let mut robot = robot("g1_12dof");
    for (j, joint) in (0_u8..).zip(&mut robot.legs[1].joints) {
        joint.damping_n_m_s = 0.3 + 0.1 * f64::from(j);
        joint.armature_kg_m2 = 2.0 - 0.2 * f64::from(j);
        joint.torque_max_n_m = 3.0 + f64::from(j);
    }
    Leg::new(&robot, 1)
}

/// A robot that is shipped.
pub(super) fn robot(name: &str) -> Robot {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("campaigns/robots/{name}.toml"));
    Robot::load(&path).unwrap()
}
