//! Everything that the independent implementation computed too.

use super::*;

#[test]
fn val_presets_are_the_reference_designs() {
    for case in CASES.iter() {
        let (design, params) = (&case.design, &case.golden["params"]);
        let number = |key: &str| params[key].as_f64().unwrap();
        let list = |key: &str| -> Vec<f64> { serde_json::from_value(params[key].clone()).unwrap() };
        // One rounding in each value that the presets compute.
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-15 * b.abs();
        for (found, key) in [
            (design.r, "R"),
            (design.nu, "nu"),
            (design.eps2, "eps2"),
            (design.pid_nu, "pid_nu"),
            (design.rho, "rho"),
        ] {
            assert!(same(found, number(key)), "{} {key}", case.name);
        }
        assert_eq!(design.sensor_fault_input.to_vec(), list("B20"));
        assert_eq!(design.q1.to_vec(), list("Q1diag")[..3]);
        let q2 = list("Q2diag");
        assert_eq!(design.q2.len(), q2.len());
        assert!(design.q2.iter().zip(&q2).all(|(&a, &b)| same(a, b)));
    }
}

#[test]
fn val_channel_matrices_match_the_reference() {
    for case in CASES.iter() {
        let channel = augmented_channel(&case.design);
        // A few roundings in (a_k - 1) / h.
        for (found, key) in [(&channel.a, "A"), (&channel.b, "B"), (&channel.c, "C")] {
            let difference = relative_difference(found, &case.matrix(key));
            assert!(difference < 1e-15, "{} {key}: {difference:e}", case.name);
        }
    }
}

#[test]
fn val_riccati_solutions_and_gains_match_the_reference() {
    let limit = tolerance("riccati_relative");
    for case in CASES.iter() {
        let design = &case.design;
        let feedback = feedback_riccati(design).unwrap();
        let observer = observer_riccati(design, &feedback.gain).unwrap();
        let pid = pid_gains(design).unwrap();
        let tuned = pid_robust_observer_gains(design).unwrap();
        for (what, found, expected) in [
            ("K", feedback.gain, case.matrix("K")),
            ("P1", feedback.solution, case.matrix("P1_are")),
            ("L", observer.gain, case.matrix("L")),
            ("X", observer.solution, case.matrix("X_filter")),
            ("K of pid", row(&pid.k), case.matrix("K_pid")),
            ("L of pid", column_of_rows(&pid.l), case.matrix("L_pid")),
            (
                "K of pid-robust-observer",
                row(&tuned.k),
                case.matrix("K_pid"),
            ),
            (
                "L of pid-robust-observer",
                column_of_rows(&tuned.l),
                matrix(&GOLDEN["pid_tuned"]["L"]),
            ),
        ] {
            let difference = relative_difference(&found, &expected);
            assert!(
                difference <= limit,
                "{} {what}: relative difference {difference:e}",
                case.name
            );
        }
    }
}

#[test]
fn val_gains_of_the_inequalities_match_the_reference() {
    for case in CASES.iter() {
        let ftc = &case.synthesis.ftc;
        for (what, found, expected) in [
            ("K", row(&ftc.k), case.matrix("K")),
            ("L", column_of_rows(&ftc.l), case.matrix("L")),
        ] {
            let difference = relative_difference(&found, &expected);
            assert!(
                difference <= tolerance("lmi_relative"),
                "{} {what}: relative difference {difference:e}",
                case.name
            );
        }
    }
}

#[test]
fn gain_comparison_detects_a_gain_that_is_off_by_a_thousandth() {
    let expected = uav().matrix("L");
    let mut found = expected.clone();
    // The largest entry; a thousandth of it is five times the tolerance.
    found[(3, 2)] *= 1.001;
    assert!(relative_difference(&found, &expected) > tolerance("lmi_relative"));
}

#[test]
fn val_certified_levels_match_the_reference() {
    for case in CASES.iter() {
        let expected = case.golden["cert"]["rho"].as_f64().unwrap();
        let of_reference_gains = case.reference.certificate.as_ref().unwrap();
        for certificate in [&case.synthesis.certificate, of_reference_gains] {
            let limit = tolerance("certificate_relative");
            assert_close(case.name, certificate.rho, expected, limit);
            assert!(certificate.max_eigenvalue < 0.0);
            assert!(certificate.meets_design_rho);
        }
    }
}

#[test]
fn val_hinf_norms_match_the_reference() {
    for case in CASES.iter() {
        let certificate = case.reference.certificate.as_ref().unwrap();
        let expected = case.golden["hinf_true_E_F_independent"].as_f64().unwrap();
        let limit = tolerance("hinf_relative");
        assert_close(case.name, certificate.hinf_norm, expected, limit);
    }
}

#[test]
fn certified_level_is_just_above_the_true_norm() {
    for case in CASES.iter() {
        let certificate = &case.synthesis.certificate;
        assert!(certificate.hinf_norm <= certificate.rho);
        // Minimising rho alone would approach the norm; the strict margin of (27)
        // and the bound on P may cost 0.1 %.
        assert_close(case.name, certificate.rho, certificate.hinf_norm, 1e-3);
    }
}

#[test]
fn solver_ends_solved_on_every_inequality_of_the_presets() {
    for case in CASES.iter() {
        let statuses: Vec<_> = case.synthesis.solver.iter().map(|r| &r.status).collect();
        assert_eq!(statuses, ["Solved"; 3], "{}", case.name);
        assert!(case.synthesis.checks.iter().all(|check| check.passed));
        // Two agreements, two stabilities, (27) and the norm.
        assert_eq!(case.synthesis.checks.len(), 6);
    }
}

#[test]
fn val_margins_match_the_reference() {
    for case in CASES.iter() {
        let analysis = &case.synthesis.analysis;
        for (key, margins) in [
            ("margins_ftc", analysis.ftc.margins),
            ("margins_pid", analysis.pid.margins),
        ] {
            let expected = |name: &str| case.golden[key][name].as_f64().unwrap();
            let coarse = tolerance("margin_relative");
            assert_close(
                "Ms",
                margins.sensitivity_peak,
                expected("Ms"),
                tolerance("sensitivity_relative"),
            );
            assert_close("PM", margins.phase_margin_deg, expected("PM_deg"), coarse);
            assert_close("DM", margins.delay_margin_ms, expected("DM_ms"), coarse);
            assert_close("wc", margins.crossover_rad_s, expected("wc"), coarse);
        }
    }
}

#[test]
fn val_poles_match_the_reference() {
    for case in CASES.iter() {
        let ftc = &case.reference.analysis;
        let pid = &case.synthesis.analysis.pid;
        let pid_poles = [&pid.controller_poles[..], &pid.observer_poles[..]].concat();
        for (key, found) in [
            ("poles_ctrl", ftc.controller_poles.clone()),
            ("poles_obs", ftc.observer_poles.clone()),
            ("poles_pid", pid_poles),
        ] {
            let expected: Vec<[f64; 2]> = serde_json::from_value(case.golden[key].clone()).unwrap();
            assert_same_poles(case.name, &found, &expected);
        }
    }
}

/// Every expected pole has its own found one nearby.
#[track_caller]
fn assert_same_poles(what: &str, found: &[[f64; 2]], expected: &[[f64; 2]]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let mut left = found.to_vec();
    for pole in expected {
        let distance = |other: &[f64; 2]| (pole[0] - other[0]).hypot(pole[1] - other[1]);
        let (nearest, _) = left
            .iter()
            .enumerate()
            .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))
            .unwrap();
        let error = distance(&left[nearest]);
        assert!(
            error <= tolerance("pole_per_s"),
            "{what}: pole {pole:?} is {error:e} away from the nearest"
        );
        left.swap_remove(nearest);
    }
}
