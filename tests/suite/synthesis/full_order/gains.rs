//! Gains and norms.

use super::cases::{design, names, sensors};
use super::{CASES, GOLDEN, case, matrix, row_difference};
use nalgebra::DMatrix;
use urts_mc::synthesis::{
    ChannelDesign, Preset, SensorChanges, Sensors, Smoothing, SmoothingRule, Step, SynthesisError,
    feedback_riccati, geometric_q2, observer_riccati, synthesize_full_order,
};

#[test]
fn val_norms_match_the_reference() {
    for case in CASES.iter() {
        let (found, expected) = (case.found.certificate.hinf_norm, case.golden("norm"));
        // Two sweeps that refine their peaks to eight digits.
        assert!(
            (found / expected - 1.0).abs() < 1e-7,
            "{}: {found} {expected}",
            case.name()
        );
    }
    // The three that differ are told apart.
    let norm = |kind| case(kind, 2).found.certificate.hinf_norm;
    assert!(norm("kronecker") - norm("rotated") > 0.2 && norm("shared") - norm("kronecker") > 0.7);
}

#[test]
fn val_first_rows_of_l_match_the_reference() {
    let mut compared = 0;
    for case in CASES.iter().filter(|case| case.n == 2) {
        let Some(golden) = GOLDEN["gains"].get(case.kind) else {
            continue;
        };
        let rows: Vec<Vec<f64>> = serde_json::from_value(golden["L_first_rows"].clone()).unwrap();
        let found = matrix(&case.found.gains.l[..rows.len()]);
        let difference = row_difference(&found, &matrix(&rows));
        // The reference is rounded to six decimals, its smallest row has 0.17 as its largest entry.
        assert!(difference < 1e-5, "{}: {difference:e}", case.kind);
        compared += 1;
    }
    assert_eq!(compared, 4);
}

#[test]
fn comparison_of_l_notices_sensors_turned_by_another_angle() {
    let rows: Vec<Vec<f64>> =
        serde_json::from_value(GOLDEN["gains"]["rotated"]["L_first_rows"].clone()).unwrap();
    let aligned = matrix(&case("kronecker", 2).found.gains.l[..rows.len()]);
    assert!(row_difference(&aligned, &matrix(&rows)) > 0.1);
}

#[test]
fn val_sizes_poles_and_largest_gains_match_the_reference() {
    for case in CASES.iter() {
        let gains = &case.found.gains;
        let name = case.name();
        assert_eq!(gains.l.len() as f64, case.golden("N"), "{name}");
        assert_eq!(gains.l[0].len() as f64, case.golden("l"), "{name}");
        assert_eq!((gains.k.len(), gains.k[0].len()), (case.n, gains.l.len()));
        assert_eq!(case.found.sensors.faults().len() as f64, case.golden("o"));
        // A few roundings of exp(A t) at the first t, a ten thousandth of the pole's own time.
        let pole = case.found.slowest_pole_per_s / case.golden("poleL");
        assert!((pole - 1.0).abs() < 1e-9, "{name}: {pole}");
        // What the two Riccati solvers leave.
        let largest = matrix(&gains.l).amax() / case.golden("Lmax");
        assert!((largest - 1.0).abs() < 1e-8, "{name}: {largest}");
        // A thousand times the rounding errors of a product of the largest terms.
        assert!(case.found.residual < 1e-12, "{name}");
        assert!(case.found.checks.iter().all(|check| check.passed));
    }
}

#[test]
fn val_one_channel_has_the_gains_of_the_synthesis_of_a_channel() {
    for preset in Preset::ALL {
        let design = preset.designs()[0].1.clone();
        let sensors = Sensors::new(&names(1), &design, &SensorChanges::default()).unwrap();
        let found = synthesize_full_order(&design, &sensors).unwrap();
        let k = feedback_riccati(&design).unwrap().gain;
        let l = observer_riccati(&design, &k).unwrap().gain;
        assert_eq!(matrix(&found.gains.k), k);
        // Two solvers of the Riccati equation; row by row, as L spans ten decades.
        let difference = row_difference(&matrix(&found.gains.l), &l);
        assert!(difference < 1e-8, "{preset:?}: {difference:e}");
    }
}

#[test]
fn val_channels_with_sensors_of_their_own_have_the_gains_of_one_each() {
    let design = design();
    let n = 4;
    let found = synthesize_full_order(&design, &sensors("kronecker", n)).unwrap();
    let k = feedback_riccati(&design).unwrap().gain;
    let l = observer_riccati(&design, &k).unwrap().gain;
    let identity = DMatrix::<f64>::identity(n, n);
    assert_eq!(matrix(&found.gains.k), k.kronecker(&identity));
    let difference = row_difference(&matrix(&found.gains.l), &l.kronecker(&identity));
    assert!(difference < 1e-8, "{difference:e}");
}

#[test]
fn same_sensors_give_the_same_bytes() {
    let case = case("shared", 6);
    let again = synthesize_full_order(&design(), &sensors("shared", 6)).unwrap();
    let text = |found| serde_json::to_string(found).unwrap();
    assert_eq!(text(&again), text(&case.found));
    assert!(!text(&again).contains("time"), "no clock in a result");
}

#[test]
fn filter_without_a_solution_names_the_smallest_feasible_rho() {
    // Estimation weights ten thousand times as high: the filter limits rho, not the feedback, for which 1.42 is
    // enough.
    let at = |rho: f64| ChannelDesign {
        rho,
        q2: design().q2.iter().map(|q| q * 1e4).collect(),
        ..design()
    };
    let sensors = sensors("shared", 6);
    let error = synthesize_full_order(&at(2.0), &sensors).err().unwrap();
    let SynthesisError::Infeasible {
        step: Step::Observer,
        smallest_rho: Some(smallest),
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert!(smallest > 2.0);
    // Rounding decides within 1e-4 of the border.
    assert!(synthesize_full_order(&at(smallest * (1.0 - 1e-3)), &sensors).is_err());
    let found = synthesize_full_order(&at(smallest * (1.0 + 1e-3)), &sensors).unwrap();
    assert!(found.certificate.max_eigenvalue < 0.0);
}

#[test]
fn feedback_without_a_solution_is_refused_as_of_a_channel_alone() {
    let design = ChannelDesign {
        rho: 1.0,
        ..design()
    };
    let error = synthesize_full_order(&design, &sensors("rotated", 2))
        .err()
        .unwrap();
    let expected = "step 1 (feedback gain) has no solution at rho = 1: \
                    the smallest feasible rho is 1.415;";
    assert!(error.to_string().starts_with(expected), "{error}");
}

#[test]
fn noise_of_a_sensor_of_its_own_lowers_its_gains() {
    let mut changes = SensorChanges::default();
    let mut noisy = super::cases::sensor(&[("x0.rate", 1.0)], &[("x0", 1.0)]);
    noisy.noise = Some(1e-2);
    changes.replace.insert("x0.rate".into(), noisy);
    let sensors = Sensors::new(&names(4), &design(), &changes).unwrap();
    let l = synthesize_full_order(&design(), &sensors).unwrap().gains.l;
    // The columns of the rates of the first two channels, on their own newest taps F1.
    let (noisy, usual) = (l[12][8], l[13][9]);
    assert!(noisy.abs() < 0.1 * usual.abs(), "{noisy} {usual}");
}

#[test]
fn sensors_turned_far_are_certified_with_the_weights_of_every_preset() {
    for preset in Preset::ALL {
        let (_, design) = preset.designs().swap_remove(0);
        for degrees in [45.0, 80.0] {
            assert_certified(&design, degrees);
        }
    }
}

#[test]
fn other_smoothing_models_are_certified_too() {
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
            smoothing,
            ..design()
        };
        assert_certified(&design, 20.0);
    }
}

/// Six channels, more than Clarabel confirms, of which two have their rates measured by sensors turned by an angle.
#[track_caller]
fn assert_certified(design: &ChannelDesign, degrees: f64) {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let mut changes = SensorChanges::default();
    for (own, other, sine) in [("x0", "x1", -sine), ("x1", "x0", sine)] {
        let of = [
            (&*format!("{own}.rate"), cosine),
            (&*format!("{other}.rate"), sine),
        ];
        let turned = super::cases::sensor(&of, &[(own, 1.0)]);
        changes.replace.insert(format!("{own}.rate"), turned);
    }
    let sensors = Sensors::new(&names(6), design, &changes).unwrap();
    let found = synthesize_full_order(design, &sensors).unwrap();
    assert!(found.certificate.max_eigenvalue < 0.0 && found.slowest_pole_per_s < 0.0);
    assert!(found.certificate.hinf_norm < found.certificate.rho);
}
