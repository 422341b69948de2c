//! The parts of an episode that never act on each other, and the reference tables of their channels.

use super::lanes::Real;
use super::plant::ReferenceRow;
use super::plant::biped::{LegPlant, leg_rows};
use super::plant::kinds::AnyPlant;
use super::plant::uav::{Attitude, Axis, Thrust, Translation, inertia, non_inertial};
use crate::agent::robot::dynamics::{inverse_dynamics, mass_matrix};
use crate::agent::robot::{JOINTS, LEG_JOINTS, Robot};
use crate::agent::{ActuationKind, Agent, FIRST_ATTITUDE, Uav};
use crate::campaign::{AgentGroup, DisturbanceKind};
use crate::reference::ReferencePoint;
use nalgebra::{Cholesky, Matrix6, Vector6};
use rayon::prelude::*;
use std::ops::Range;

/// A group of channels and its reference table, `[half step][agent][channel][row]`.
pub(crate) struct Subsystem<R> {
    pub(crate) plant: AnyPlant<R>,
    pub(crate) channels: Range<usize>,
    /// Rows of each channel.
    pub(crate) rows: usize,
    pub(crate) table: Vec<ReferenceRow<R>>,
}

/// The parts of a campaign's episodes.
pub(crate) fn parts<R: Real>(group: &AgentGroup) -> Vec<Subsystem<R>> {
    let (plants, rows) = match &group.agent {
        Agent::Uav(uav) => (uav_plants(uav, group.has_vortices()), 1),
        Agent::Biped(biped) => {
            let cut = group.is_limited();
            let legs = [0..LEG_JOINTS, LEG_JOINTS..JOINTS].into_iter().enumerate();
            let legs = legs.map(|(side, joints)| (leg_plant(&biped.robot, side, cut), joints));
            (legs.collect(), leg_rows(cut))
        }
    };
    let half_steps = (0..=2 * group.time.steps).into_par_iter();
    let agents: Vec<Vec<ReferenceRow<R>>> = half_steps
        .flat_map_iter(|half_step| {
            let t_s = f64::from(half_step) * group.time.step_s / 2.0;
            (0..group.team).map(move |agent| agent_rows(group, agent, t_s))
        })
        .collect();
    let part = |(plant, channels): (AnyPlant<R>, Range<usize>)| {
        let own = rows * channels.start..rows * channels.end;
        Subsystem {
            plant,
            channels,
            rows,
            table: agents
                .iter()
                .flat_map(|agent| &agent[own.clone()])
                .copied()
                .collect(),
        }
    };
    plants.into_iter().map(part).collect()
}

fn uav_plants<R: Real>(uav: &Uav, vortices: bool) -> Vec<(AnyPlant<R>, Range<usize>)> {
    let attitude = (AnyPlant::Attitude(Attitude::new(uav)), FIRST_ATTITUDE..6);
    match uav.actuation {
        ActuationKind::Thrust => vec![(AnyPlant::Thrust(Thrust::new(uav)), 0..6)],
        ActuationKind::Full | ActuationKind::Limited if vortices => vec![
            (
                AnyPlant::Translation(Translation::new(uav)),
                0..FIRST_ATTITUDE,
            ),
            attitude,
        ],
        ActuationKind::Full | ActuationKind::Limited => {
            let axis = |axis| (AnyPlant::Axis(Axis::new(uav, axis)), axis..axis + 1);
            (0..FIRST_ATTITUDE).map(axis).chain([attitude]).collect()
        }
    }
}

fn leg_plant<R: Real>(robot: &Robot, side: usize, cut: bool) -> AnyPlant<R> {
    if cut {
        AnyPlant::CutLeg(LegPlant::new(robot, side))
    } else {
        AnyPlant::FreeLeg(LegPlant::new(robot, side))
    }
}

/// The rows of an agent's channels at one instant, `[channel][row]`.
fn agent_rows<R: Real>(group: &AgentGroup, agent: usize, t_s: f64) -> Vec<ReferenceRow<R>> {
    let points = group.reference.at(agent, t_s);
    let rows = match &group.agent {
        Agent::Uav(uav) => uav_rows(uav, &points),
        Agent::Biped(biped) => {
            let stands = |kind| kind == DisturbanceKind::GroundReaction;
            let ground = if group.disturbances.iter().any(|entry| stands(entry.kind)) {
                let reference = &group.reference;
                reference.ground_reaction(&biped.robot, agent, t_s)
            } else {
                [0.0; JOINTS]
            };
            biped_rows(&biped.robot, &points, &ground, group.is_limited())
        }
    };
    rows.into_iter().map(|row| row.map(R::from_f64)).collect()
}

/// Under thrust, roll and pitch have no reference: they follow from the force, and the feedforward of the attitude is
/// worked out in the loop.
fn uav_rows(uav: &Uav, points: &[ReferencePoint]) -> Vec<ReferenceRow<f64>> {
    let inertia = inertia(uav);
    let non_inertial = non_inertial(uav, std::array::from_fn(|c| points[c].rate));
    let of_channel = points.iter().zip(inertia).zip(non_inertial);
    of_channel
        .map(|((point, inertia), non_inertial)| {
            let feedforward = inertia * point.acceleration + non_inertial;
            [point.value, point.rate, point.acceleration, feedforward]
        })
        .collect()
}

/// The rows of both legs, as plant_biped lists them; `ground` is J'f, N m.
fn biped_rows(
    robot: &Robot,
    points: &[ReferencePoint],
    ground: &[f64; JOINTS],
    cut: bool,
) -> Vec<ReferenceRow<f64>> {
    let mut rows = Vec::with_capacity(leg_rows(cut) * JOINTS);
    let of_legs = points.chunks(LEG_JOINTS).zip(ground.chunks(LEG_JOINTS));
    for (leg, (points, ground)) in robot.legs.iter().zip(of_legs) {
        let all = |pick: fn(&ReferencePoint) -> f64| Vector6::from_fn(|c, _| pick(&points[c]));
        let (q, rate) = (all(|point| point.value), all(|point| point.rate));
        let acceleration = all(|point| point.acceleration);
        let mass = mass_matrix(leg, &q);
        let feedforward = inverse_dynamics(leg, &robot.gravity_m_s2, &q, &rate, &acceleration);
        let inverse = if cut { inverse(mass) } else { Matrix6::zeros() };
        for c in 0..LEG_JOINTS {
            rows.push([q[c], rate[c], acceleration[c], feedforward[c]]);
            rows.extend(matrix_rows(&mass, c, ground[c]));
            if cut {
                rows.extend(matrix_rows(&inverse, c, 0.0));
            }
        }
    }
    rows
}

/// A row of a matrix in two rows of a table, and what fits behind it.
fn matrix_rows(matrix: &Matrix6<f64>, row: usize, beside: f64) -> [ReferenceRow<f64>; 2] {
    let m = |column| matrix[(row, column)];
    [[m(0), m(1), m(2), m(3)], [m(4), m(5), beside, 0.0]]
}

/// Not a number where the matrix is not positive definite, so that an episode with it counts as diverged.
fn inverse(mass: Matrix6<f64>) -> Matrix6<f64> {
    Cholesky::new(mass).map_or(Matrix6::repeat(f64::NAN), |factor| factor.inverse())
}
