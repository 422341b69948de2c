//! The biped: its files, kinematics and dynamics.
//!
//! | module | holds |
//! |---|---|
//! | `humanoids` | published robots, whole |
//! | `reference` | kinematics, dynamics and ground reaction against independent numbers |
//! | `physics` | energy, symmetry and inverses, which hold whatever the numbers |
//! | `table` | the joint table: what it holds, what it refuses |
//! | `urdf` | the same of the URDF reader, and that both agree |

mod humanoids;
mod physics;
mod reference;
mod table;
mod urdf;

use crate::common::repository;
use nalgebra::Vector6;
use urts_mc::agent::robot::Robot;

/// The two shipped robots.
fn shipped() -> [Robot; 2] {
    ["g1_12dof", "berkeley_humanoid"].map(load)
}

fn load(name: &str) -> Robot {
    Robot::load(&repository(&format!("campaigns/robots/{name}.toml"))).unwrap()
}

/// Evenly distributed numbers from -1 to 1 that are the same in every run.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        // SplitMix64 (Steele, Lea, Flood 2014); the upper 32 bits.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let upper = u32::try_from((z ^ (z >> 31)) >> 32).unwrap();
        f64::from(upper) / f64::from(u32::MAX) * 2.0 - 1.0
    }
}

/// A state of one leg: angles within 1.5 rad, rates within 5 rad/s, accelerations within 30 rad/s^2.
struct LegState {
    q: Vector6<f64>,
    rate: Vector6<f64>,
    acceleration: Vector6<f64>,
}

/// States of one leg, the same in every run.
fn leg_states(seed: u64, count: usize) -> Vec<LegState> {
    let mut next = numbers(seed);
    let mut vector = |size: f64| Vector6::from_fn(|_, _| size * next());
    (0..count)
        .map(|_| LegState {
            q: vector(1.5),
            rate: vector(5.0),
            acceleration: vector(30.0),
        })
        .collect()
}
