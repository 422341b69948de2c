//! PIDs by their shape, and what loops make of noise.

use nalgebra::{Complex, DMatrix, DVector};
use urts_mc::synthesis::{ControllerGains, PidShape, Preset, error_channel, placed_gains, verify};

fn shape(observer_rad_s: [f64; 3]) -> PidShape {
    PidShape {
        real_rad_s: 7.0,
        pair_rad_s: 20.0,
        damping: 0.6,
        observer_rad_s,
    }
}

/// A + L C of the three-state observer.
fn observer(gains: &ControllerGains) -> DMatrix<f64> {
    error_channel().a + DMatrix::from_fn(3, 3, |row, column| gains.l[row][column])
}

/// Size of a polynomial with these coefficients, the highest power's first, at one of its supposed roots, relative to
/// its largest term.
fn misses(coefficients: &[f64], root: Complex<f64>) -> f64 {
    let terms = coefficients.iter().rev().zip(0..);
    let terms: Vec<Complex<f64>> = terms.map(|(own, k)| root.powi(k) * *own).collect();
    let largest = terms.iter().map(|own| own.norm()).fold(0.0, f64::max);
    terms.iter().sum::<Complex<f64>>().norm() / largest
}

#[test]
fn the_error_of_a_shaped_pid_has_the_poles_that_were_asked_for() {
    let gains = shape([300.0; 3]).gains().unwrap();
    let polynomial = [1.0, -gains.k[2], -gains.k[1], -gains.k[0]];
    let pair = Complex::new(-0.6 * 20.0, 20.0 * (1.0_f64 - 0.36).sqrt());
    for root in [Complex::new(-7.0, 0.0), pair, pair.conj()] {
        assert!(misses(&polynomial, root) < 1e-12, "{root}");
    }
    assert!(misses(&polynomial, Complex::new(-8.0, 0.0)) > 1e-3);
}

#[test]
fn val_an_observer_that_hears_one_measurement_has_the_poles_of_the_filter_of_that() {
    // The Kalman filter of a chain of n integrators that noise drives and whose end is measured: its poles are the
    // stable ones of 1 + (-1)^n (s / w)^(2 n), those of Butterworth (Kwakernaak and Sivan 1972, section 4.4.4).
    let deaf = 1e-3;
    for (heard, w, integrators) in [
        ([1.0, 0.0, 0.0], 50.0, 3),
        ([0.0, 1.0, 0.0], 80.0, 2),
        ([0.0, 0.0, 1.0], 120.0, 1),
    ] {
        let speeds = heard.map(|own| if own > 0.0 { w } else { deaf });
        let gains = shape(speeds).gains().unwrap();
        let poles = observer(&gains).complex_eigenvalues();
        let n = integrators;
        for pole in poles.iter().filter(|pole| pole.norm() > 0.1 * w) {
            let power = (pole / w).powi(2 * n);
            let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
            assert!((power * sign + 1.0).norm() < 1e-3, "{pole} of {w}, {n}");
        }
        let fast = poles.iter().filter(|pole| pole.norm() > 0.1 * w).count();
        assert_eq!(fast, n as usize, "{poles}");
    }
}

#[test]
fn the_unit_of_time_does_not_matter_to_a_shaped_pid() {
    // Ten times as fast: poles ten times as large, L scaled as its units say.
    let slow = shape([100.0, 30.0, 200.0]).gains().unwrap();
    let fast = shape([1000.0, 300.0, 2000.0]).gains().unwrap();
    for (row, (own, other)) in (0_i32..).zip(slow.l.iter().zip(&fast.l)) {
        for (column, (own, other)) in (0_i32..).zip(own.iter().zip(other)) {
            let power = 1 + row - column;
            let scaled = own * 10.0_f64.powi(power);
            assert!(
                (scaled - other).abs() <= 1e-8 * other.abs().max(1e-6),
                "{row} {column}: {scaled} {other}"
            );
        }
    }
}

/// The loop of a PID with noise on x and x': its matrix, what the noise drives, and the command it ends in.
fn with_noise(gains: &ControllerGains) -> (DMatrix<f64>, DMatrix<f64>, DMatrix<f64>) {
    let plant = error_channel();
    let k = DMatrix::from_row_slice(1, 3, &gains.k);
    let l = DMatrix::from_fn(3, 3, |row, column| gains.l[row][column]);
    let mut a = DMatrix::zeros(6, 6);
    a.view_mut((0, 0), (3, 3)).copy_from(&plant.a);
    a.view_mut((0, 3), (3, 3)).copy_from(&(&plant.b * &k));
    a.view_mut((3, 0), (3, 3)).copy_from(&-&l);
    a.view_mut((3, 3), (3, 3))
        .copy_from(&(&plant.a + &plant.b * &k + &l));
    let mut b = DMatrix::zeros(6, 2);
    b.view_mut((3, 0), (3, 2)).copy_from(&-l.columns(1, 2));
    let mut c = DMatrix::zeros(1, 6);
    c.view_mut((0, 3), (1, 3)).copy_from(&k);
    (a, b, c)
}

/// The H2 norm by the Lyapunov equation A X + X A' + B B' = 0, as linear equations of its 36 entries.
fn h2(a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>) -> f64 {
    let one = DMatrix::<f64>::identity(6, 6);
    let left = one.kronecker(a) + a.kronecker(&one);
    let right = -(b * b.transpose());
    let x = left
        .lu()
        .solve(&DVector::from_column_slice(right.as_slice()))
        .unwrap();
    let x = DMatrix::from_column_slice(6, 6, x.as_slice());
    (c * x * c.transpose())[(0, 0)].sqrt()
}

/// The largest gain over frequencies that lie 1.0001 apart.
fn largest_gain(a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>) -> f64 {
    let [a, b, c] = [a, b, c].map(|own| own.map(Complex::from));
    let gain = |omega: f64| {
        let s = DMatrix::from_diagonal_element(6, 6, Complex::new(0.0, omega));
        (&c * (s - &a).lu().solve(&b).unwrap()).norm()
    };
    let mut omega = 0.1;
    let mut largest = 0.0_f64;
    while omega < 1e4 {
        largest = largest.max(gain(omega));
        omega *= 1.001;
    }
    largest
}

#[test]
fn val_noise_gains_are_those_of_the_closed_loop_in_state_space() {
    let (_, design) = Preset::UavPaper.designs().remove(0);
    let shaped = shape([60.0, 25.0, 150.0]).gains().unwrap();
    for gains in [placed_gains(20.0, 800.0), shaped] {
        let margins = verify(&design, &gains).unwrap().analysis.margins;
        let (a, b, c) = with_noise(&gains);
        let [h2, peak] = [h2(&a, &b, &c), largest_gain(&a, &b, &c)];
        println!("{h2} {}, {peak} {}", margins.noise_h2, margins.noise_peak);
        // The sum over 60 frequencies a decade, and a grid a thousandth apart around a smooth peak.
        assert!((margins.noise_h2 / h2 - 1.0).abs() < 1e-3);
        assert!((margins.noise_peak / peak - 1.0).abs() < 1e-5);
    }
}
