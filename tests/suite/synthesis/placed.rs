//! PIDs by the placement of their poles.

use std::f64::consts::PI;
use urts_mc::synthesis::{PLACED_RAD_S, Preset, placed_gains, poles_for_delay_margin, verify};

/// Poles of the observer of "pid-placed" where a campaign says nothing, rad/s.
const OBSERVER_RAD_S: f64 = 800.0;

fn delay_margin_ms(poles_rad_s: f64, observer_rad_s: f64) -> f64 {
    let (_, design) = Preset::UavPaper.designs().remove(0);
    let verified = verify(&design, &placed_gains(poles_rad_s, observer_rad_s)).unwrap();
    verified.analysis.margins.delay_margin_ms
}

#[test]
fn a_placed_pid_has_the_triple_pole_and_the_observer_that_it_was_asked_for() {
    let (_, design) = Preset::UavPaper.designs().remove(0);
    let gains = placed_gains(20.0, OBSERVER_RAD_S);
    assert_eq!(gains.k, [-8000.0, -1200.0, -60.0]);
    assert_eq!(
        gains.l,
        [[-800.0, -1.0, 0.0], [0.0, -800.0, -1.0], [0.0, 0.0, -800.0]]
    );
    let verified = verify(&design, &gains).unwrap();
    // Rounding of 1e-16 moves a triple pole by its cube root.
    for [re, im] in &verified.analysis.controller_poles {
        assert!((re + 20.0).abs() < 1e-3 && im.abs() < 1e-3, "{re} {im}");
    }
    for [re, im] in &verified.analysis.observer_poles {
        assert!((re + 800.0).abs() < 1e-1 && im.abs() < 1e-1, "{re} {im}");
    }
    assert!(verified.certificate.is_none());
}

/// The delay margin of a triple pole at -N whose state is measured, ms: of the loop gain
/// (3 N s^2 + 3 N^2 s + N^3) / s^3, whose crossover is found by bisection in w / N.
fn of_measured_state_ms(poles_rad_s: f64) -> f64 {
    // |1 + 3 j x - 3 x^2| = x^3 at the crossover w = N x.
    let size = |x: f64| f64::hypot(1.0 - 3.0 * x * x, 3.0 * x) / x.powi(3);
    let (mut low, mut high) = (1.0, 10.0);
    for _ in 0..100 {
        let middle = f64::midpoint(low, high);
        if size(middle) > 1.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    // 1 / (j x)^3 = j / x^3 turns by 90 degrees.
    let phase = f64::atan2(3.0 * low, 1.0 - 3.0 * low * low) + PI / 2.0 - PI;
    1e3 * phase / (low * poles_rad_s)
}

#[test]
fn val_the_delay_margin_is_that_of_the_measured_state_less_what_the_observer_costs() {
    // The independent study has 27 ms for N = 15, 20.0 ms for N = 20 and 9.9 ms for N = 40, with this observer.
    for (poles_rad_s, found_ms, half_a_digit) in
        [(15.0, 27.0, 0.5), (20.0, 20.0, 0.05), (40.0, 9.9, 0.05)]
    {
        let margin_ms = delay_margin_ms(poles_rad_s, OBSERVER_RAD_S);
        assert!(
            (margin_ms - found_ms).abs() <= half_a_digit,
            "{poles_rad_s}: {margin_ms}"
        );
        // The observer is slower than the loop by far, so it costs little; and less, the faster it is.
        let ideal_ms = of_measured_state_ms(poles_rad_s);
        let costs = [OBSERVER_RAD_S, 10.0 * OBSERVER_RAD_S]
            .map(|observer| ideal_ms - delay_margin_ms(poles_rad_s, observer));
        assert!(0.0 < costs[1] && costs[1] < 0.2 * costs[0], "{costs:?}");
        assert!(costs[0] < 0.2 * ideal_ms, "{costs:?} of {ideal_ms}");
    }
}

#[test]
fn poles_are_placed_for_a_delay_margin_where_there_is_such_a_pid() {
    for margin_ms in [7.59, 27.0, 300.0] {
        let poles_rad_s = poles_for_delay_margin(margin_ms, OBSERVER_RAD_S).unwrap();
        let found_ms = delay_margin_ms(poles_rad_s, OBSERVER_RAD_S);
        assert!(
            found_ms >= margin_ms && found_ms < margin_ms * (1.0 + 1e-9),
            "{found_ms}"
        );
        assert!(delay_margin_ms(1.001 * poles_rad_s, OBSERVER_RAD_S) < margin_ms);
    }
    let [slowest, _] = PLACED_RAD_S;
    let longest_ms = delay_margin_ms(slowest, OBSERVER_RAD_S);
    assert!(poles_for_delay_margin(2.0 * longest_ms, OBSERVER_RAD_S).is_none());
    assert!(poles_for_delay_margin(1e-6, OBSERVER_RAD_S).is_none());
}
