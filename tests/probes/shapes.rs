//! The shapes that are checked and probed.

use crate::agent::robot::Robot;
use crate::agent::{ActuationKind, Uav};
use crate::backend::gpu::shape::Shape;
use crate::backend::gpu::signals::Lists;
use crate::model::agent::Coupling;
use crate::model::exogenous::lists::{LISTS, ListShape, SignalLists};
use crate::model::plant::biped::LegPlant;
use crate::model::plant::kinds::PlantKind;
use crate::model::plant::uav::{Attitude, Axis, Thrust, Translation};
use std::path::Path;

/// How many items each list has, in the order of [`LISTS`], how many turbulences there are (and as many frictions), and
/// vortices where channels are those of a place.
type Counts = ([usize; LISTS.len()], usize, usize);

/// No signal.
const NONE: Counts = ([0; LISTS.len()], 0, 0);
/// Several of each kind, in numbers that no two lists next to each other share.
const ALL: Counts = (alternating(2), 2, 2);
/// The same with fewer, which the larger plants have: their texts take long to compile.
const EACH: Counts = (alternating(1), 1, 1);
/// Only what needs no look at every step: it changes when switches turn, at once.
const QUIET: Counts = (
    without(
        alternating(1),
        &[
            "leaks",
            "rate_limits",
            "noises",
            "intermittents",
            "command_holds",
            "sensor_holds",
            "outliers",
            "command_rings",
            "sensor_rings",
        ],
    ),
    0,
    0,
);
/// The same among jets.
const BLOWN: Counts = (QUIET.0, 0, 2);
/// One noise.
const NOISY: Counts = single(place("noises"));
/// Samples that rings have room for; some are shorter than this.
pub(super) const RING_STEPS: usize = 11;

/// One item of one list.
const fn single(list: usize) -> Counts {
    let mut counts = [0; LISTS.len()];
    counts[list] = 1;
    (counts, 0, 0)
}

/// By turns so many items, and one more.
const fn alternating(fewer: usize) -> [usize; LISTS.len()] {
    let mut counts = [fewer; LISTS.len()];
    let mut list = 1;
    while list < counts.len() {
        counts[list] += 1;
        list += 2;
    }
    counts
}

/// The same without the items of some lists.
const fn without(mut counts: [usize; LISTS.len()], names: &[&str]) -> [usize; LISTS.len()] {
    let mut k = 0;
    while k < names.len() {
        counts[place(names[k])] = 0;
        k += 1;
    }
    counts
}

/// The place of a list.
const fn place(name: &str) -> usize {
    let mut list = 0;
    while !same(LISTS[list], name) {
        list += 1;
    }
    list
}

const fn same(one: &str, other: &str) -> bool {
    let (one, other) = (one.as_bytes(), other.as_bytes());
    if one.len() != other.len() {
        return false;
    }
    let mut k = 0;
    while k < one.len() {
        if one[k] != other[k] {
            return false;
        }
        k += 1;
    }
    true
}

#[test]
fn lists_of_one_shape_stand_together() {
    let mut met: Vec<ListShape> = SignalLists::<f32, 1>::SHAPES.to_vec();
    met.dedup();
    let distinct = |shape: &ListShape| met.iter().filter(|other| *other == shape).count() == 1;
    assert!(met.len() == 5 && met.iter().all(distinct), "{met:?}");
}

/// The lists of these counts, with the flags that they imply.
fn lists((counts, turbulences, vortices): Counts) -> Lists {
    let count = |name: &str| counts[place(name)];
    let any = |names: &[&str]| names.iter().any(|name| count(name) > 0);
    let carries = any(&["command_holds", "command_rings"]);
    let remembers = carries || any(&["leaks", "rate_limits", "sensor_holds", "sensor_rings"]);
    let bursts = ["intermittents", "command_holds", "sensor_holds", "outliers"];
    let bursts = bursts.map(count).iter().sum();
    let rings = count("command_rings") + count("sensor_rings");
    let entries = |first: u32, count: usize| (first..).step_by(4).take(count).collect();
    let entry = |k: usize| 2 + 3 * k as u32;
    Lists {
        counts,
        noise_entries: entries(3, count("noises")),
        turbulence_entries: entries(1, turbulences),
        frictions: turbulences,
        vortices,
        bursts: (0..bursts).map(|k| (entry(k), k % 2 == 1)).collect(),
        rings: (0..rings).map(|k| k % 2 == 0).collect(),
        ring_steps: RING_STEPS,
        hold_steps: 1,
        restless: remembers || turbulences > 0 || any(&["noises", "intermittents", "outliers"]),
        remembers,
        carries,
        distorts: any(&["scales", "sensor_holds", "sensor_rings"]),
    }
}

fn shape(plant: PlantKind, team: usize, ftc: bool, coupled: bool, counts: Counts) -> Shape {
    let channels = plant.spec().channels;
    let vortices = match plant {
        PlantKind::Translation | PlantKind::Thrust => counts.2,
        PlantKind::Axis | PlantKind::Attitude | PlantKind::Leg => 0,
    };
    let counts = (counts.0, counts.1, vortices);
    // The commands of those legs are cut whose team is coupled.
    let cut = plant == PlantKind::Leg && coupled;
    let plant_constants = match plant {
        PlantKind::Leg => leg::<false>().model.shader_constants(),
        PlantKind::Axis | PlantKind::Translation | PlantKind::Attitude | PlantKind::Thrust => {
            Vec::new()
        }
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
        first_agent: team - 1,
        lanes: if channels * team > 9 { 4 } else { 8 },
        ftc,
        coupling: if coupled {
            Coupling::Absolute
        } else {
            Coupling::None
        },
        measured_integral: false,
        observer_measured: coupled,
        int64: false,
        lists: lists(counts),
    }
}

/// A shape for functions that depend on none.
pub(super) fn plain() -> Shape {
    Shape {
        lanes: 64,
        ..shape(PlantKind::Axis, 1, true, false, NONE)
    }
}

/// The same on a device with 64-bit integers.
pub(super) fn plain_int64() -> Shape {
    Shape {
        int64: true,
        ..plain()
    }
}

/// The shapes whose functions are probed: each plant for one agent and for a coupled team, each controller, without and
/// with signals.
pub(super) fn probed() -> [Shape; 9] {
    [
        shape(PlantKind::Axis, 1, true, false, ALL),
        shape(PlantKind::Axis, 3, false, true, QUIET),
        shape(PlantKind::Attitude, 1, false, false, NONE),
        shape(PlantKind::Attitude, 3, true, true, ALL),
        shape(PlantKind::Thrust, 1, false, false, EACH),
        sampled(shape(PlantKind::Thrust, 3, true, true, EACH)),
        shape(PlantKind::Translation, 3, true, true, BLOWN),
        shape(PlantKind::Leg, 1, false, false, EACH),
        shape(PlantKind::Leg, 2, true, true, NOISY),
    ]
}

/// The same with what a campaign may choose differently: a sampled controller, integrals of what is measured, and a
/// coupling around the centroid.
fn sampled(shape: Shape) -> Shape {
    Shape {
        coupling: Coupling::Centroid,
        measured_integral: true,
        lists: Lists {
            hold_steps: 3,
            ..shape.lists
        },
        ..shape
    }
}

/// The shapes whose text is validated: every plant, controller and team size, each kind of signal on its own, all and
/// none.
pub(super) fn validated() -> Vec<Shape> {
    let (turbulent, blown) = ((NONE.0, 1, 0), (NONE.0, 0, 1));
    let counts = (0..LISTS.len())
        .map(single)
        .chain([turbulent, blown, NONE, ALL]);
    let mut shapes = Vec::new();
    for counts in counts {
        for plant in PlantKind::ALL {
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

pub(super) fn translation() -> Translation<f32> {
    Translation::new(&uav())
}

pub(super) fn attitude() -> Attitude<f32> {
    Attitude::new(&uav())
}

pub(super) fn thrust() -> Thrust<f32> {
    Thrust::new(&uav())
}

/// A right leg with damped joints, whose limits are met by some of the random states. Its rotors are heavy, so that no
/// joint moves far more than the others, in which rounding errors would drown it.
pub(super) fn leg<const CUT: bool>() -> LegPlant<f32, CUT> {
    let mut robot = robot("g1_12dof");
    for (j, joint) in (0_u8..).zip(&mut robot.legs[1].joints) {
        joint.damping_n_m_s = 0.3 + 0.1 * f64::from(j);
        joint.armature_kg_m2 = 2.0 - 0.2 * f64::from(j);
        joint.torque_max_n_m = 3.0 + f64::from(j);
    }
    LegPlant::new(&robot, 1)
}

/// A robot that is shipped.
pub(super) fn robot(name: &str) -> Robot {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("campaigns/robots/{name}.toml"));
    Robot::load(&path).unwrap()
}
