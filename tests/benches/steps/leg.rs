//! The cost of a leg's forward dynamics alone.

use crate::rates::processor_time;
use std::hint::black_box;
use urts_mc::agent::robot::Robot;
#[cfg(target_arch = "x86_64")]
use urts_mc::backend::cpu::Simd;
#[cfg(target_arch = "x86_64")]
use urts_mc::model::lanes::simd::{F32x8, F32x16};
use urts_mc::model::lanes::{Kernel, Lane};
use urts_mc::model::plant::leg::{LegJoint, LegModel, forward_dynamics};

/// Calls of one measurement: some tens of milliseconds, since processor time is counted in steps of a few.
const CALLS: u32 = 400_000;

/// Nanoseconds per leg in every layout.
pub(crate) fn measure() {
    println!("\nforward dynamics of a leg, best of all samples, one core");
    println!("{:<11} {:>8}", "", "ns");
    show::<f64>("f64");
    show::<f32>("f32 scalar");
    #[cfg(target_arch = "x86_64")]
    {
        if Simd::Avx2.is_available() {
            show::<F32x8>("f32 x 8");
        }
        if Simd::Avx512.is_available() {
            show::<F32x16>("f32 x 16");
        }
    }
}

fn show<L: Lane>(name: &str) {
    let robot = Robot::g1().expect("the robot is part of the program");
    let joints = robot.legs[0].joints.each_ref().map(LegJoint::from);
    let model = LegModel::<L::Real>::new(&joints, robot.gravity_m_s2);
    let once = || {
        let start = processor_time();
        black_box(L::dispatch(Falls::<L> { model: &model }));
        (processor_time() - start).as_secs_f64()
    };
    let best = (0..20).map(|_| once()).fold(f64::INFINITY, f64::min);
    let per_leg = best / (f64::from(CALLS) * L::WIDTH as f64);
    println!("{name:<11} {:>8.1}", 1e9 * per_leg);
}

/// A leg that falls very slowly: each call needs the result of the one before.
struct Falls<'a, L: Lane> {
    model: &'a LegModel<L::Real>,
}

impl<L: Lane> Kernel for Falls<'_, L> {
    type Output = f64;
    #[inline(always)]
    fn run(self) -> f64 {
        let (mut q, mut rate) = ([L::number(0.3); 6], [L::number(0.5); 6]);
        let (torque, slowly) = ([L::number(1.0); 6], L::number(1e-7));
        for _ in 0..CALLS {
            let acceleration = forward_dynamics(self.model, &q, &rate, &torque);
            for j in 0..6 {
                q[j] = rate[j].mul_add(slowly, q[j]);
                rate[j] = acceleration[j].mul_add(slowly, rate[j]);
            }
        }
        let mut stored = [0.0; 16];
        q[0].store(&mut stored);
        stored[0]
    }
}
