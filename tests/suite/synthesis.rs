//! Controller synthesis against an independent implementation, against itself
//! in other coordinates, and against gains and designs that must be refused.
//!
//! The reference numbers and their tolerances, each with its reason, are in `tests/golden/synthesis.json`.

use nalgebra::{Complex, DMatrix};
use serde_json::Value;
use std::sync::LazyLock;
use urts_mc::synthesis::{
    ChannelDesign, ChannelRole, ChannelSynthesis, ControllerGains, LOOP_STATES, Preset, Smoothing,
    SmoothingRule, Step, SynthesisError, augmented_channel, feedback_riccati, geometric_q2,
    loop_gains, observer_riccati, pid_gains, pid_tuned_gains, poles, synthesize, verify,
};

static GOLDEN: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("../golden/synthesis.json")).unwrap());

/// The reference blocks, the preset channel each belongs to, and its synthesis (made once).
static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
    [
        ("uav_paper", Preset::UavPaper),
        ("robot_paper", Preset::BipedPaper),
        ("uav_position_physical", Preset::UavPhysical),
    ]
    .map(|(name, preset)| {
        let design = preset.designs()[0].1.clone();
        Case {
            name,
            golden: &GOLDEN[name],
            synthesis: synthesize(&design).unwrap(),
            design,
        }
    })
    .into()
});

struct Case {
    name: &'static str,
    golden: &'static Value,
    design: ChannelDesign,
    synthesis: ChannelSynthesis,
}

impl Case {
    fn matrix(&self, key: &str) -> DMatrix<f64> {
        matrix(&self.golden[key])
    }
}

fn uav() -> &'static Case {
    &CASES[0]
}

fn tolerance(key: &str) -> f64 {
    GOLDEN["tolerances"][key].as_f64().unwrap()
}

fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = serde_json::from_value(value.clone()).unwrap();
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

fn row(k: &[f64]) -> DMatrix<f64> {
    DMatrix::from_row_slice(1, k.len(), k)
}

fn column_of_rows(l: &[[f64; 3]]) -> DMatrix<f64> {
    DMatrix::from_fn(l.len(), 3, |i, j| l[i][j])
}

/// The largest difference relative to the largest entry of `expected`.
fn relative_difference(found: &DMatrix<f64>, expected: &DMatrix<f64>) -> f64 {
    assert_eq!(found.shape(), expected.shape());
    (found - expected).amax() / expected.amax()
}

#[track_caller]
fn assert_close(what: &str, found: f64, expected: f64, relative: f64) {
    let difference = (found / expected - 1.0).abs();
    assert!(
        difference <= relative,
        "{what}: {found} is not {expected}: relative difference {difference:e} above {relative:e}"
    );
}

// ---------------------------------------------------------------------------
// Against the reference

#[test]
fn val_presets_are_the_reference_designs() {
    for case in CASES.iter() {
        let (design, params) = (&case.design, &case.golden["params"]);
        let number = |key: &str| params[key].as_f64().unwrap();
        let list = |key: &str| -> Vec<f64> { serde_json::from_value(params[key].clone()).unwrap() };
        // One rounding in each value that the presets compute.
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-15 * b.abs();
        assert!(same(design.rho, number("rho")), "{}", case.name);
        assert_eq!(
            [design.r, design.nu, design.eps2, design.pid_nu],
            ["R", "nu", "eps2", "pid_nu"].map(number),
            "{}",
            case.name
        );
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
        let tuned = pid_tuned_gains(design).unwrap();
        for (what, found, expected) in [
            ("K", feedback.gain, case.matrix("K")),
            ("P1", feedback.solution, case.matrix("P1_are")),
            ("L", observer.gain, case.matrix("L")),
            ("X", observer.solution, case.matrix("X_filter")),
            ("K of pid", row(&pid.k), case.matrix("K_pid")),
            ("L of pid", column_of_rows(&pid.l), case.matrix("L_pid")),
            ("K of pid-tuned", row(&tuned.k), case.matrix("K_pid")),
            (
                "L of pid-tuned",
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
        let certificate = &case.synthesis.certificate;
        let expected = case.golden["cert"]["rho"].as_f64().unwrap();
        assert_close(
            case.name,
            certificate.rho,
            expected,
            tolerance("certificate_relative"),
        );
        assert!(certificate.max_eigenvalue < 0.0);
        assert!(certificate.meets_design_rho);
    }
}

#[test]
fn val_hinf_norms_match_the_reference_and_bound_the_certificate_from_below() {
    for case in CASES.iter() {
        let certificate = &case.synthesis.certificate;
        let expected = case.golden["hinf_true_E_F_independent"].as_f64().unwrap();
        assert_close(
            case.name,
            certificate.hinf_norm,
            expected,
            tolerance("hinf_relative"),
        );
        assert!(certificate.hinf_norm <= certificate.rho);
        // What minimising rho alone would reach is the norm itself: the
        // strengthening and the bound on P may cost 0.1 %, no more.
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
        let analysis = &case.synthesis.analysis;
        let both = |a: &[[f64; 2]], b: &[[f64; 2]]| [a, b].concat();
        for (key, found) in [
            ("poles_ctrl", analysis.ftc.controller_poles.clone()),
            ("poles_obs", analysis.ftc.observer_poles.clone()),
            (
                "poles_pid",
                both(&analysis.pid.controller_poles, &analysis.pid.observer_poles),
            ),
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

// ---------------------------------------------------------------------------
// The certificate belongs to its gains

#[test]
fn certificate_read_back_holds_for_its_own_gains_only() {
    for case in CASES.iter() {
        let ChannelSynthesis {
            certificate,
            ftc,
            design,
            ..
        } = &case.synthesis;
        let own = certificate.max_eigenvalue_with(design, ftc).unwrap();
        assert_eq!(own, certificate.max_eigenvalue);

        let mut tampered = ftc.clone();
        tampered.l.iter_mut().for_each(|row| row[2] *= 0.5);
        let with_tampered_l = certificate.max_eigenvalue_with(design, &tampered).unwrap();
        assert!(with_tampered_l > 0.0, "{}: {with_tampered_l:e}", case.name);

        let mut tampered = ftc.clone();
        tampered.k[1] *= 1.5;
        let with_tampered_k = certificate.max_eigenvalue_with(design, &tampered).unwrap();
        assert!(with_tampered_k > 0.0, "{}: {with_tampered_k:e}", case.name);
    }
}

#[test]
fn certificate_does_not_hold_at_a_level_below_the_norm() {
    let case = uav();
    let mut certificate = case.synthesis.certificate.clone();
    certificate.rho = 0.99 * certificate.hinf_norm;
    let eigenvalue = certificate
        .max_eigenvalue_with(&case.design, &case.synthesis.ftc)
        .unwrap();
    assert!(eigenvalue > 0.0);
}

#[test]
fn verification_repeats_what_synthesis_found() {
    for case in CASES.iter() {
        let verified = verify(&case.design, &case.synthesis.ftc).unwrap();
        assert_eq!(
            verified.certificate.as_ref(),
            Some(&case.synthesis.certificate)
        );
        assert_eq!(verified.analysis, case.synthesis.analysis.ftc);
        let pid = verify(&case.design, &case.synthesis.pid).unwrap();
        assert_eq!(pid.certificate, None);
    }
}

#[test]
fn verification_of_the_reference_gains_gives_the_reference_certificate() {
    for case in CASES.iter() {
        let gains = ControllerGains {
            k: case.matrix("K").iter().copied().collect(),
            l: case
                .matrix("L")
                .row_iter()
                .map(|r| [r[0], r[1], r[2]])
                .collect(),
        };
        let certificate = verify(&case.design, &gains).unwrap().certificate.unwrap();
        let expected = case.golden["cert"]["rho"].as_f64().unwrap();
        assert_close(
            case.name,
            certificate.rho,
            expected,
            tolerance("certificate_relative"),
        );
    }
}

// ---------------------------------------------------------------------------
// What must be refused

#[test]
fn refuses_a_feedback_gain_that_does_not_stabilise() {
    let case = uav();
    for gains in [&case.synthesis.ftc, &case.synthesis.pid] {
        let mut unstable = gains.clone();
        unstable.k[2] = 0.1;
        let error = verify(&case.design, &unstable).unwrap_err();
        assert!(
            matches!(error, SynthesisError::CheckFailed { step: Step::Feedback, value, .. } if value > 0.0),
            "{error}"
        );
    }
}

#[test]
fn refuses_an_observer_gain_that_does_not_converge() {
    let case = uav();
    let mut unstable = case.synthesis.ftc.clone();
    unstable.l[2][2] = 50.0;
    let error = verify(&case.design, &unstable).unwrap_err();
    assert!(
        matches!(error, SynthesisError::CheckFailed { step: Step::Observer, value, .. } if value > 0.0),
        "{error}"
    );
}

#[test]
fn refuses_gains_of_the_wrong_shape_or_without_a_value() {
    let case = uav();
    let good = &case.synthesis.ftc;
    let mut short = good.clone();
    short.k.pop();
    let mut ragged = good.clone();
    ragged.l.pop();
    let mut hole = good.clone();
    hole.k[3] = f64::NAN;
    for (what, gains) in [("short", short), ("ragged", ragged), ("hole", hole)] {
        assert!(verify(&case.design, &gains).is_err(), "{what}");
    }
}

#[test]
fn refuses_unknown_keys_and_broken_rows_in_a_gains_file() {
    let read = serde_json::from_str::<ControllerGains>;
    assert!(read(r#"{"k": [1.0], "l": [[1.0, 2.0, 3.0]]}"#).is_ok());
    let unknown = read(r#"{"k": [1.0], "l": [[1.0, 2.0, 3.0]], "gain": 1}"#).unwrap_err();
    assert!(unknown.to_string().contains("unknown field `gain`"));
    assert!(read(r#"{"k": [1.0], "l": [[1.0, 2.0]]}"#).is_err());
    assert!(read(r#"{"k": [1.0]}"#).is_err());
}

#[test]
fn infeasible_feedback_step_names_the_smallest_feasible_rho() {
    assert_smallest_rho(Step::Feedback, &|rho| ChannelDesign {
        rho,
        ..uav().design.clone()
    });
}

#[test]
fn infeasible_observer_step_names_the_smallest_feasible_rho() {
    // Estimation weights ten thousand times higher: the observer limits rho now.
    assert_smallest_rho(Step::Observer, &|rho| ChannelDesign {
        rho,
        q2: uav().design.q2.iter().map(|q| q * 1e4).collect(),
        ..uav().design.clone()
    });
}

/// From 0.05 upwards: the error names a level, just above it the step is
/// feasible, just below it is not.
#[track_caller]
fn assert_smallest_rho(expected_step: Step, at: &dyn Fn(f64) -> ChannelDesign) {
    let mut rho = 0.05;
    // The feedback step is solved first and may stand in the way of the observer's.
    for _ in 0..2 {
        let error = synthesize(&at(rho)).unwrap_err();
        let SynthesisError::Infeasible {
            step,
            smallest_rho: Some(smallest),
            ..
        } = error
        else {
            panic!("{error}");
        };
        assert!(smallest > rho);
        if step == expected_step {
            let message = error.to_string();
            assert!(message.contains(&format!("{smallest:.6}")), "{message}");
            // The bisection ends at seven digits.
            for (level, feasible) in [(1.0 - 1e-6, false), (1.0 + 1e-6, true)] {
                let outcome = synthesize(&at(smallest * level));
                let infeasible =
                    matches!(outcome, Err(SynthesisError::Infeasible { step: s, .. }) if s == step);
                assert_eq!(!infeasible, feasible, "{smallest} * {level}");
            }
            return;
        }
        rho = smallest * (1.0 + 1e-6);
    }
    panic!("{expected_step} never was infeasible");
}

#[test]
fn refuses_every_parameter_outside_its_range() {
    type Change = fn(&mut ChannelDesign);
    let changes: [(&str, Change); 16] = [
        ("q1[0]", |d| d.q1[0] = 0.0),
        ("q1[1]", |d| d.q1[1] = -1.0),
        ("q1[2]", |d| d.q1[2] = f64::NAN),
        ("q2[4]", |d| d.q2[4] = -1e-9),
        ("q2", |d| d.q2.truncate(11)),
        ("r", |d| d.r = 0.0),
        ("rho", |d| d.rho = f64::INFINITY),
        ("nu", |d| d.nu = -1e-4),
        ("eps2", |d| d.eps2 = 0.0),
        ("pid_nu", |d| d.pid_nu = f64::NAN),
        ("sensor_fault_input[2]", |d| {
            d.sensor_fault_input[2] = f64::NAN
        }),
        ("smoothing.spacing_s", |d| d.smoothing.spacing_s = 0.0),
        ("smoothing.windows[1]", |d| d.smoothing.windows[1] = 11),
        ("smoothing.order", |d| {
            d.smoothing.rule = SmoothingRule::Leaky {
                order: 4,
                leak_per_s: 1.0,
            };
        }),
        ("smoothing.leak_per_s", |d| {
            d.smoothing.rule = SmoothingRule::Leaky {
                order: 1,
                leak_per_s: f64::NAN,
            };
        }),
        ("smoothing.weights[1]", |d| {
            d.smoothing.rule = SmoothingRule::Weights(vec![0.5, f64::INFINITY]);
        }),
    ];
    for (expected, change) in changes {
        let mut design = uav().design.clone();
        change(&mut design);
        match synthesize(&design).unwrap_err() {
            SynthesisError::InvalidDesign { key, .. } | SynthesisError::WrongLength { key, .. } => {
                assert_eq!(key, expected)
            }
            error => panic!("{expected}: {error}"),
        }
    }
}

#[test]
fn refuses_smoothing_models_that_do_not_decay() {
    let rules = [
        // No leak: every eigenvalue at 0.
        SmoothingRule::Leaky {
            order: 1,
            leak_per_s: 0.0,
        },
        // Linear extrapolation: a double eigenvalue at 0.
        SmoothingRule::Weights(vec![2.0, -1.0]),
        SmoothingRule::Weights(vec![1.2]),
    ];
    for rule in rules {
        let mut design = uav().design.clone();
        design.smoothing.rule = rule.clone();
        let error = synthesize(&design).unwrap_err();
        assert!(
            matches!(error, SynthesisError::UnstableSmoothing { eigenvalue } if eigenvalue.re > -1e-6),
            "{rule:?}: {error}"
        );
    }
}

// ---------------------------------------------------------------------------
// The form that episodes integrate

#[test]
fn reduced_controller_has_the_transfer_function_of_the_full_one() {
    for case in CASES.iter() {
        let ftc = &case.synthesis.ftc;
        let reduced = loop_gains(&case.design, ftc).unwrap();
        assert_eq!(reduced.states, LOOP_STATES);

        let channel = augmented_channel(&case.design);
        let (k, l) = (row(&ftc.k), column_of_rows(&ftc.l));
        let full = controller_matrix(&channel.a, &channel.b, &channel.c, &k, &l);
        // Rows and columns of the seven states inside the twelve.
        let kept = [0, 1, 2, 3, 4, 7, 8];
        let [a, b, rate] = reduced.smoothing;
        assert_eq!([channel.a[(3, 3)], channel.a[(3, 4)]], [a, b]);
        assert_eq!([channel.a[(8, 7)], -channel.a[(8, 8)]], [rate, rate]);
        let small = controller_matrix(
            &channel.a.select_rows(&kept).select_columns(&kept),
            &channel.b.select_rows(&kept),
            &channel.c.select_columns(&kept),
            &row(&reduced.k),
            &column_of_rows(&reduced.l),
        );
        for omega in [0.01, 0.1, 1.0, 3.0, 10.0, 100.0, 1000.0] {
            let twelve = response(&full, &k, &l, omega);
            let seven = response(&small, &row(&reduced.k), &column_of_rows(&reduced.l), omega);
            let scale = twelve.camax();
            // The condition of the resolvent at 0.01 rad/s times f64's resolution.
            assert!((twelve - seven).camax() < 1e-10 * scale, "{omega} rad/s");
        }
    }
}

fn controller_matrix(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    c: &DMatrix<f64>,
    k: &DMatrix<f64>,
    l: &DMatrix<f64>,
) -> DMatrix<f64> {
    a + b * k + l * c
}

/// K (j omega - A)^-1 L.
fn response(
    a: &DMatrix<f64>,
    k: &DMatrix<f64>,
    l: &DMatrix<f64>,
    omega: f64,
) -> DMatrix<Complex<f64>> {
    let n = a.nrows();
    let shifted =
        DMatrix::from_diagonal_element(n, n, Complex::new(0.0, omega)) - a.map(Complex::from);
    k.map(Complex::from) * shifted.lu().solve(&l.map(Complex::from)).unwrap()
}

#[test]
fn poles_of_the_integrated_loop_are_those_of_the_analysis() {
    for case in CASES.iter() {
        let analysis = &case.synthesis.analysis;
        for (gains, analysis) in [
            (&case.synthesis.ftc, &analysis.ftc),
            (&case.synthesis.pid, &analysis.pid),
            (&case.synthesis.pid_tuned, &analysis.pid_tuned),
        ] {
            let found = poles(&loop_gains(&case.design, gains).unwrap());
            assert_eq!(found.len(), 3 + gains.k.len().min(LOOP_STATES));
            for pole in found {
                let near = |other: &[f64; 2]| {
                    let distance = (pole.re - other[0]).hypot(pole.im - other[1]);
                    // The same matrix up to roundings; -1 is a double pole.
                    distance < 1e-6 * (1.0 + pole.norm())
                };
                let mut all = analysis
                    .controller_poles
                    .iter()
                    .chain(&analysis.observer_poles);
                assert!(all.any(near), "{}: {pole}", case.name);
            }
        }
    }
}

#[test]
fn val_fastest_robot_pole_is_near_minus_500() {
    let robot = &CASES[1];
    let all = poles(&loop_gains(&robot.design, &robot.synthesis.ftc).unwrap());
    let fastest = all.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    // -499.99, printed to the integer.
    assert!((fastest - 500.0).abs() < 0.5);
}

#[test]
fn loop_gains_of_a_pid_use_three_states() {
    let case = uav();
    let reduced = loop_gains(&case.design, &case.synthesis.pid).unwrap();
    assert_eq!(reduced.states, 3);
    assert_eq!(reduced.k[..3], case.synthesis.pid.k);
    assert_eq!(reduced.l[..3], case.synthesis.pid.l);
    assert_eq!(reduced.k[3..], [0.0; 4]);
}

#[test]
fn loop_gains_refuse_what_seven_states_cannot_hold() {
    let case = uav();
    let mut delayed = case.synthesis.ftc.clone();
    delayed.k[5] = 0.1;
    let error = loop_gains(&case.design, &delayed).unwrap_err().to_string();
    assert!(error.contains("k[5]"), "{error}");

    let mut design = case.design.clone();
    design.smoothing.rule = SmoothingRule::Leaky {
        order: 2,
        leak_per_s: 1.0,
    };
    let error = loop_gains(&design, &case.synthesis.ftc).unwrap_err();
    assert!(error.to_string().contains("3 taps"), "{error}");
}

// ---------------------------------------------------------------------------
// Other designs, determinism, speed

#[test]
fn other_smoothing_models_synthesize_and_certify() {
    let leaky = |order, leak_per_s| SmoothingRule::Leaky { order, leak_per_s };
    for (windows, rule) in [
        ([3, 4], leaky(0, 1.0)),
        ([3, 4], leaky(2, 1.0)),
        ([0, 0], leaky(0, 2.0)),
        ([2, 2], leaky(1, 0.5)),
        ([3, 4], SmoothingRule::Weights(vec![1.2, -0.1, -0.2])),
    ] {
        let smoothing = Smoothing {
            windows,
            rule,
            ..Smoothing::paper()
        };
        let design = ChannelDesign {
            q2: geometric_q2(&smoothing, [0.1, 10.0, 1.0], 1.0, 20.0),
            smoothing: smoothing.clone(),
            ..uav().design.clone()
        };
        let synthesis = synthesize(&design).unwrap_or_else(|e| panic!("{smoothing:?}: {e}"));
        assert_eq!(synthesis.ftc.k.len(), design.states());
        assert!(synthesis.certificate.max_eigenvalue < 0.0);
    }
}

#[test]
fn same_design_gives_the_same_bytes() {
    let case = uav();
    let again = synthesize(&case.design).unwrap();
    let text = |synthesis| serde_json::to_string(synthesis).unwrap();
    assert_eq!(text(&again), text(&case.synthesis));
}

#[test]
fn synthesis_survives_its_file_bit_for_bit() {
    for case in CASES.iter() {
        let text = serde_json::to_string_pretty(&case.synthesis).unwrap();
        let back: ChannelSynthesis = serde_json::from_str(&text).unwrap();
        assert_eq!(back.design, case.design);
        assert_eq!(back.ftc, case.synthesis.ftc);
        assert_eq!(back.certificate, case.synthesis.certificate);
        assert_eq!(serde_json::to_string_pretty(&back).unwrap(), text);
        assert!(!text.contains("time"), "no clock in a result");
    }
}

#[test]
fn presets_name_their_channels_by_role() {
    let roles =
        |preset: Preset| -> Vec<_> { preset.designs().into_iter().map(|(role, _)| role).collect() };
    use ChannelRole::{Attitude, Joint, Position};
    assert_eq!(roles(Preset::UavPaper), [Position, Attitude]);
    assert_eq!(roles(Preset::UavPhysical), [Position, Attitude]);
    assert_eq!(roles(Preset::BipedPaper), [Joint]);
    for preset in Preset::ALL {
        let quoted = serde_json::to_string(&preset).unwrap();
        assert_eq!(quoted, format!("\"{}\"", preset.name()));
    }
}

/// Optimised builds only: the limit is meant for what users run.
#[cfg(not(debug_assertions))]
#[test]
fn synthesis_of_a_channel_takes_less_than_two_seconds() {
    for case in CASES.iter() {
        let best = (0..3)
            .map(|_| {
                let start = std::time::Instant::now();
                synthesize(&case.design).unwrap();
                start.elapsed()
            })
            .min()
            .unwrap();
        // About 0.4 s on a quiet core; the best of three on a busy one.
        assert!(best.as_secs_f64() < 2.0, "{}: {best:?}", case.name);
    }
}
