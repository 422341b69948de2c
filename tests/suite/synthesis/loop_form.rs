//! The reduced form that episodes integrate.

use super::*;

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
        // One rounding: (x - 1) / h against (x - 1) (1 / h).
        for (found, expected) in [
            (a, channel.a[(3, 3)]),
            (b, channel.a[(3, 4)]),
            (rate, channel.a[(8, 7)]),
            (-rate, channel.a[(8, 8)]),
        ] {
            assert_close("smoothing", found, expected, 1e-15);
        }
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
            (
                &case.synthesis.pid_robust_observer,
                &analysis.pid_robust_observer,
            ),
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
