//! The dynamics of a leg against the recursive Newton-Euler method in the pelvis frame, written down plainly.

use super::{Case, computed, random_cases, relative_error, robot};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
#[cfg(target_arch = "x86_64")]
use urts_mc::backend::cpu::Simd;
#[cfg(target_arch = "x86_64")]
use urts_mc::model::lanes::simd::{F32x8, F32x16};
use urts_mc::model::plant::leg::{LegJoint, LegModel};

/// The torques of a motion.
fn inverse_dynamics(
    leg: &[LegJoint; 6],
    gravity: Vector3<f64>,
    q: &[f64; 6],
    rate: &[f64; 6],
    acceleration: &[f64; 6],
) -> [f64; 6] {
    let (mut pose, mut origin) = (Rotation3::identity(), Vector3::zeros());
    let (mut w, mut dw, mut a) = (Vector3::zeros(), Vector3::zeros(), -gravity);
    let (mut forces, mut points, mut axes, mut moments) = (vec![], vec![], vec![], vec![]);
    let mut origins = vec![];
    for (j, joint) in leg.iter().enumerate() {
        let lever = pose * joint.translation_m;
        origin += lever;
        a += dw.cross(&lever) + w.cross(&w.cross(&lever));
        pose *= joint.rotation * Rotation3::from_axis_angle(&Unit::new_normalize(joint.axis), q[j]);
        let axis = pose * joint.axis.normalize();
        dw += axis * acceleration[j] + w.cross(&axis) * rate[j];
        w += axis * rate[j];
        let com = pose * joint.com_m;
        let inertia: Matrix3<f64> = pose * joint.inertia_kg_m2 * pose.inverse();
        forces.push(joint.mass_kg * (a + dw.cross(&com) + w.cross(&w.cross(&com))));
        moments.push(inertia * dw + w.cross(&(inertia * w)));
        points.push(origin + com);
        origins.push(origin);
        axes.push(axis);
    }
    std::array::from_fn(|j| {
        let total: Vector3<f64> = (j..6)
            .map(|k| moments[k] + (points[k] - origins[j]).cross(&forces[k]))
            .sum();
        axes[j].dot(&total)
            + leg[j].armature_kg_m2 * acceleration[j]
            + leg[j].damping_n_m_s * rate[j]
    })
}

/// The leg with damped joints, each turned a little more (rad) about axes that differ.
fn skewed(leg: &[LegJoint; 6], angle: f64) -> [LegJoint; 6] {
    let mut skewed = leg.clone();
    for (j, joint) in (0_u8..).zip(&mut skewed) {
        let j = f64::from(j);
        let about = Unit::new_normalize(Vector3::new(1.0 + j, 2.0 - j, 0.5 * j * j - 2.0));
        joint.rotation *= Rotation3::from_axis_angle(&about, angle * (1.0 + 0.2 * j));
        joint.axis *= 1.0 + j;
        joint.damping_n_m_s = 0.3 + 0.1 * j;
    }
    skewed
}

#[test]
fn val_torques_of_the_computed_accelerations_are_the_given_ones_on_any_robot() {
    let gravity = Vector3::new(1.0, -2.0, -9.0);
    for name in ["g1_12dof", "berkeley_humanoid"] {
        let (legs, _) = robot(name);
        // From aligned over almost aligned, where axes nearly coincide, to axes that point anywhere.
        for angle in [0.0, 1e-12, 1e-7, 1e-3, 0.3, 1.2, 3.0] {
            let leg = skewed(&legs[1], angle);
            let model = LegModel::<f64>::new(&leg, gravity);
            let cases = random_cases(1, 50);
            let mut worst: f64 = 0.0;
            for (case, found) in cases.iter().zip(computed::<f64>(&model, &cases)) {
                let torque = inverse_dynamics(&leg, gravity, &case.q, &case.rate, &found);
                let error = relative_error(&torque, &case.torque);
                worst = if error <= worst { worst } else { error };
            }
            // Rounding of 1000 operations on torques of which the largest are a few hundred times the given ones.
            assert!(worst < 1e-10, "{name} {angle}: {worst:e}");

            let single = LegModel::<f32>::new(&leg, gravity);
            let exact = computed::<f64>(&model, &cases);
            let worst = |found: Vec<[f64; 6]>| {
                let errors = found.iter().zip(&exact).map(|(a, b)| relative_error(a, b));
                errors.fold(0.0, f64::max)
            };
            let scalar = worst(computed::<f32>(&single, &cases));
            assert!(scalar < 1e-5, "{name} {angle}: {scalar:e}");
            #[cfg(target_arch = "x86_64")]
            if Simd::Avx2.is_available() {
                let wide = worst(computed::<F32x8>(&single, &cases));
                assert!(wide < 1e-5, "{name} {angle}: {wide:e}");
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[test]
fn a_lane_does_not_see_the_others() {
    if !Simd::Avx512.is_available() {
        println!("SKIPPED: no AVX-512");
        return;
    }
    let (legs, gravity) = robot("g1_12dof");
    let model = LegModel::<f32>::new(&legs[0], gravity);
    let cases = random_cases(0, 16);
    let together = [
        computed::<F32x8>(&model, &cases),
        computed::<F32x16>(&model, &cases),
    ];
    // Both fuse every multiply-add, so they give the same bits.
    assert_eq!(together[0], together[1]);
    for (i, case) in cases.iter().enumerate() {
        assert_eq!(
            computed::<F32x16>(&model, std::slice::from_ref(case))[0],
            together[1][i]
        );
        assert!(cases[..i].iter().all(|other: &Case| other.q != case.q));
    }
}
