//! The dynamics of a leg against Pinocchio's.

mod independent;

use crate::common::{golden, repository};
use nalgebra::Vector3;
use urts_mc::agent::robot::Robot;
#[cfg(target_arch = "x86_64")]
use urts_mc::backend::cpu::Simd;
#[cfg(target_arch = "x86_64")]
use urts_mc::model::lanes::simd::{F32x8, F32x16};
use urts_mc::model::lanes::{Kernel, Lane};
use urts_mc::model::plant::leg::{LegJoint, LegModel, forward_dynamics};

/// The joints of both legs of a shipped robot, and gravity.
fn robot(name: &str) -> ([[LegJoint; 6]; 2], Vector3<f64>) {
    let robot = Robot::load(&repository(&format!("campaigns/robots/{name}.toml"))).unwrap();
    let legs = [0, 1].map(|leg: usize| robot.legs[leg].joints.each_ref().map(LegJoint::from));
    (legs, robot.gravity_m_s2)
}

/// One state of one leg: q, q', torque, and the q'' that Pinocchio gives.
#[derive(Clone)]
struct Case {
    leg: usize,
    q: [f64; 6],
    rate: [f64; 6],
    torque: [f64; 6],
    acceleration: [f64; 6],
}

fn cases(name: &str) -> Vec<Case> {
    let value = golden("biped_dynamics.json");
    let mut cases = Vec::new();
    for state in value["robots"][name].as_array().unwrap() {
        for leg in 0..2 {
            let six = |key: &str| -> [f64; 6] {
                std::array::from_fn(|j| state[key][6 * leg + j].as_f64().unwrap())
            };
            cases.push(Case {
                leg,
                q: six("q"),
                rate: six("qd"),
                torque: six("tau_fd"),
                acceleration: six("qdd_fd"),
            });
        }
    }
    cases
}

/// Random states, about as wild as the reference's.
fn random_cases(leg: usize, count: usize) -> Vec<Case> {
    let mut seed = 7_u64;
    let mut random = |scale: f64| -> [f64; 6] {
        std::array::from_fn(|_| {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            #[expect(clippy::cast_precision_loss, reason = "31 bits")]
            let unit = (seed >> 33) as f64 / f64::from(1 << 30) - 1.0;
            // Exact in single precision, so that rounding the input is not counted.
            (scale * unit * 4096.0).round() / 4096.0
        })
    };
    (0..count)
        .map(|_| Case {
            leg,
            q: random(1.5),
            rate: random(6.0),
            torque: random(40.0),
            acceleration: [0.0; 6],
        })
        .collect()
}

struct Accelerations<'a, L: Lane> {
    model: &'a LegModel<L::Real>,
    cases: &'a [Case],
}

impl<L: Lane> Kernel for Accelerations<'_, L> {
    type Output = Vec<[f64; 6]>;
    #[inline(always)]
    fn run(self) -> Vec<[f64; 6]> {
        let mut all = Vec::new();
        for chunk in self.cases.chunks(L::WIDTH) {
            let load = |pick: &dyn Fn(&Case) -> [f64; 6]| -> [L; 6] {
                std::array::from_fn(|j| {
                    let values: Vec<f64> = (0..L::WIDTH)
                        .map(|lane| pick(&chunk[lane.min(chunk.len() - 1)])[j])
                        .collect();
                    L::load(&values)
                })
            };
            let (q, rate, torque) = (load(&|c| c.q), load(&|c| c.rate), load(&|c| c.torque));
            let found = forward_dynamics(self.model, &q, &rate, &torque);
            let mut out = vec![[0.0; 6]; L::WIDTH];
            for (j, value) in found.into_iter().enumerate() {
                let mut lanes = vec![0.0; L::WIDTH];
                value.store(&mut lanes);
                for (out, lane) in out.iter_mut().zip(lanes) {
                    out[j] = lane;
                }
            }
            all.extend(out.into_iter().take(chunk.len()));
        }
        all
    }
}

fn computed<L: Lane>(model: &LegModel<L::Real>, cases: &[Case]) -> Vec<[f64; 6]> {
    L::dispatch(Accelerations::<L> { model, cases })
}

/// Largest difference over the largest value.
fn relative_error(found: &[f64; 6], expected: &[f64; 6]) -> f64 {
    let size = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let difference = found.iter().zip(expected).fold(0.0, |m: f64, (a, b)| {
        let d = (a - b).abs();
        if d <= m { m } else { d }
    });
    difference / size
}

fn largest_error<L: Lane>(name: &str) -> f64 {
    let (legs, gravity) = robot(name);
    let mut worst: f64 = 0.0;
    for (leg, joints) in legs.iter().enumerate() {
        let model = LegModel::<L::Real>::new(joints, gravity);
        let cases: Vec<Case> = cases(name).into_iter().filter(|c| c.leg == leg).collect();
        assert_eq!(cases.len(), 20);
        for (found, case) in computed::<L>(&model, &cases).iter().zip(&cases) {
            let error = relative_error(found, &case.acceleration);
            worst = if error <= worst { worst } else { error };
        }
    }
    worst
}

#[test]
fn val_accelerations_equal_those_of_pinocchio() {
    for name in ["g1_12dof", "berkeley_humanoid"] {
        // Rounding of 1000 operations and of Pinocchio's own, times a condition number of M of about 1e3.
        let double = largest_error::<f64>(name);
        assert!(double < 1e-12, "{name}: {double:e}");
        let mut single = vec![largest_error::<f32>(name)];
        #[cfg(target_arch = "x86_64")]
        {
            if Simd::Avx2.is_available() {
                single.push(largest_error::<F32x8>(name));
            }
            if Simd::Avx512.is_available() {
                single.push(largest_error::<F32x16>(name));
            }
        }
        assert!(
            single.iter().all(|&error| error < 1e-5),
            "{name}: {single:?}"
        );
    }
}
