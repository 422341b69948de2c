//! What must be refused, and with which message.

use super::*;

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
fn val_smallest_rho_of_the_feedback_step_has_a_closed_form() {
    // At rest the model error v gives f = v / (sigma^2 h) = 10 v, and cancelling it
    // costs R f^2, however small the error is weighted: rho^2 >= 100 R.
    let design = ChannelDesign {
        rho: 1.0,
        ..uav().design.clone()
    };
    let error = synthesize(&design).unwrap_err();
    let SynthesisError::Infeasible {
        smallest_rho: Some(smallest),
        ..
    } = error
    else {
        panic!("{error}");
    };
    // The bisection's resolution, and rounding at the border.
    assert_close("smallest rho", smallest, 10.0 * 0.02_f64.sqrt(), 1e-4);
    let message = error.to_string();
    let expected = "step 1 (feedback gain) has no solution at rho = 1: \
                    the smallest feasible rho is 1.415;";
    assert!(message.starts_with(expected), "{message}");
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
            // Rounding decides within 1e-4 of the border.
            for (level, feasible) in [(1.0 - 1e-3, false), (1.0 + 1e-3, true)] {
                let outcome = synthesize(&at(smallest * level));
                let infeasible =
                    matches!(outcome, Err(SynthesisError::Infeasible { step: s, .. }) if s == step);
                assert_eq!(!infeasible, feasible, "{smallest} * {level}");
            }
            return;
        }
        rho = smallest * (1.0 + 1e-3);
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
