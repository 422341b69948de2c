//! Waypoint reference: geometry, time law, limits and refusals.

use std::array::from_fn;
use std::f64::consts::TAU;

use urts_mc::reference::path::{PathError, PathLimits, PathPoint, WaypointPath};

type Vector = [f64; 3];

/// The example of the campaign format: a climb, then a left turn.
const CLIMB_AND_TURN: [Vector; 3] = [[0.0, 0.0, 2.0], [4.0, 0.0, 3.0], [4.0, 4.0, 3.0]];
const TAKE_OFF_AND_LAND: [Vector; 4] = [
    [0.0, 0.0, 0.0],
    [0.0, 0.0, 2.0],
    [4.0, 0.0, 2.0],
    [4.0, 0.0, 0.0],
];
/// Closed, with legs of very different lengths.
const UNEVEN: [Vector; 5] = [
    [0.0, 0.0, 2.0],
    [6.0, 0.0, 2.0],
    [6.0, 0.4, 2.5],
    [3.0, 3.0, 2.0],
    [0.0, 0.0, 2.0],
];
const SHAPES: [&[Vector]; 3] = [&CLIMB_AND_TURN, &TAKE_OFF_AND_LAND, &UNEVEN];

/// Limits of the same example.
const SLOW: PathLimits = limits(0.8, 1.0);

const fn limits(max_speed_m_s: f64, max_acceleration_m_s2: f64) -> PathLimits {
    PathLimits {
        max_speed_m_s,
        max_acceleration_m_s2,
    }
}

fn path(points: &[Vector], limits: PathLimits) -> WaypointPath {
    WaypointPath::new(points, limits).expect("these waypoints define a path")
}

fn norm(a: Vector) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn minus(a: Vector, b: Vector) -> Vector {
    from_fn(|i| a[i] - b[i])
}

fn distance(a: Vector, b: Vector) -> f64 {
    norm(minus(a, b))
}

/// Reference every `step_s` from 0 to just after the end.
fn samples(path: &WaypointPath, step_s: f64) -> impl Iterator<Item = (f64, PathPoint)> {
    let times = (0..).map(move |k| f64::from(k) * step_s);
    let inside = times.take_while(move |t| *t < path.duration_s() + step_s);
    inside.map(|t| (t, path.at(t)))
}

/// Largest speed and largest acceleration at samples `step_s` apart.
fn peaks(path: &WaypointPath, step_s: f64) -> (f64, f64) {
    samples(path, step_s).fold((0.0, 0.0), |(v, a), (_, point)| {
        (norm(point.velocity).max(v), norm(point.acceleration).max(a))
    })
}

#[test]
fn passes_through_every_waypoint_in_order() {
    for points in SHAPES {
        let path = path(points, SLOW);
        let mut earliest = 0.0;
        for &waypoint in &points[1..points.len() - 1] {
            let gap = |t: f64| distance(path.at(t).position, waypoint);
            let later = samples(&path, 0.02)
                .map(|(t, _)| t)
                .filter(|&t| t > earliest);
            let near = later.min_by(|&a, &b| gap(a).total_cmp(&gap(b)));
            let near = near.expect("samples");
            let [mut low, mut high] = [near - 0.02, near + 0.02];
            for _ in 0..80 {
                let third = (high - low) / 3.0;
                if gap(low + third) < gap(high - third) {
                    high -= third;
                } else {
                    low += third;
                }
            }
            // Time is resolved to 1e-14 s, arc length to 1e-13 m; the requirement is 1e-9 m.
            assert!(gap(low) < 1e-9, "{waypoint:?} missed by {} m", gap(low));
            earliest = low;
        }
    }
}

#[test]
fn starts_and_ends_at_rest_and_is_held_outside() {
    let path = path(&CLIMB_AND_TURN, SLOW);
    let end_s = path.duration_s();
    for (t, point) in [
        (-3.0, 0),
        (0.0, 0),
        (end_s, 2),
        (1e9, 2),
        (f64::INFINITY, 2),
    ] {
        let held = PathPoint {
            position: CLIMB_AND_TURN[point],
            velocity: [0.0; 3],
            acceleration: [0.0; 3],
        };
        assert_eq!(path.at(t), held, "at {t} s");
    }
    // Just inside, the law is S 10 τ³ with τ = 1e-6 / 24: 6e-21 m. What remains is rounding at 8 m.
    for (t, point) in [(1e-6, 0), (end_s - 1e-6, 2)] {
        let at = path.at(t);
        assert!(distance(at.position, CLIMB_AND_TURN[point]) < 1e-13);
        // 30 S τ² / T = 2e-14 m/s and 60 S τ / T² = 4e-8 m/s².
        assert!(norm(at.velocity) < 1e-13 && norm(at.acceleration) < 1e-7);
    }
}

/// Clamped `scipy.interpolate.CubicSpline` through the waypoints and the middles of both legs, its
/// length by `scipy.integrate.quad`, its peak acceleration by a grid of 2000 phases with bounded
/// refinement (SciPy 1.17).
#[test]
fn val_climb_and_turn_matches_scipy() {
    let path = path(&CLIMB_AND_TURN, SLOW);
    // Both quadratures are asked for 1e-13.
    assert!((path.length_m() - 8.229127691947443).abs() < 1e-12);
    // The duration contains a margin of 1e-9 for rounding.
    assert!((path.duration_s() / 24.08136040450688 - 1.0).abs() < 2e-9);
    for (phase, position) in [
        (
            0.2,
            [0.4622407698270724, 0.011174680190471105, 2.1155601924567677],
        ),
        (
            0.5,
            [3.953426925873927, -0.04245776189413142, 2.9883567314684814],
        ),
        (
            0.8,
            [3.9892662919531983, 3.52352944906955, 2.9973165729882996],
        ),
    ] {
        let at = path.at(phase * path.duration_s()).position;
        // The root of SciPy's arc length is asked for 1e-13.
        assert!(distance(at, position) < 1e-12, "{at:?} at phase {phase}");
    }
}

#[test]
fn val_straight_line_follows_the_quintic_in_closed_form() {
    let (from, to) = ([1.0, -2.0, 0.5], [4.0, 2.0, 12.5]); // 13 m
    let path = path(&[from, to], limits(2.0, 3.0));
    assert!((path.length_m() - 13.0).abs() < 1e-13); // rounding
    // Limited by the speed, for sqrt(10 / sqrt(3) 13 / 3) = 5 s is less; margin for rounding 1e-9.
    let duration_s = path.duration_s();
    assert!((duration_s / (1.875 * 13.0 / 2.0) - 1.0).abs() < 2e-9);
    for (t, point) in samples(&path, 0.01).filter(|(t, _)| *t < duration_s) {
        let u = t / duration_s;
        let s = u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u);
        let s1 = 30.0 * (u * (1.0 - u)).powi(2) / duration_s;
        let s2 = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / duration_s.powi(2);
        let along = |s: f64| -> Vector { from_fn(|i| s * (to[i] - from[i])) };
        // Rounding of numbers up to 13.
        assert!(distance(minus(point.position, from), along(s)) < 1e-13);
        assert!(distance(point.velocity, along(s1)) < 1e-13);
        assert!(distance(point.acceleration, along(s2)) < 1e-13);
    }
}

#[test]
fn collinear_waypoints_give_the_straight_line() {
    let points = [0.0, 0.3, 2.0, 2.1, 5.0].map(|x| [x, 2.0 * x, -2.0 * x]);
    let divided = path(&points, SLOW);
    let straight = path(&[points[0], points[4]], SLOW);
    assert!((divided.length_m() - 15.0).abs() < 1e-13); // rounding
    for (t, point) in samples(&straight, 0.05) {
        // The phase differs by the rounding of the duration: 1e-15 of 15 m.
        let [x, y, z] = divided.at(t).position;
        assert!(distance([x, y, z], point.position) < 1e-13);
        assert!((y - 2.0 * x).abs() < 1e-14 && (z + y).abs() < 1e-14);
    }
}

/// Both limits hold at every millisecond, and one of them is reached within 1 %.
#[test]
fn limits_are_kept_and_reached() {
    let line = [[0.0; 3], [8.0, 0.0, 0.0]];
    for (points, v, a, which) in [
        (&line[..], 0.8, 1.0, "speed"),
        (&line, 3.0, 0.5, "acceleration"),
        (&CLIMB_AND_TURN, 0.8, 1.0, "acceleration"),
        (&CLIMB_AND_TURN, 0.8, 3.0, "speed"),
        (&TAKE_OFF_AND_LAND, 0.8, 1.0, "acceleration"),
        (&UNEVEN, 2.0, 2.0, "acceleration"),
    ] {
        let (speed, acceleration) = peaks(&path(points, limits(v, a)), 1e-3);
        assert!(speed <= v && acceleration <= a, "{points:?}");
        let [of_speed, of_acceleration] = [speed / v, acceleration / a];
        match which {
            "speed" => assert!(of_speed > 0.99, "{of_speed}: {points:?}"),
            _ => assert!(of_acceleration > 0.99, "{of_acceleration}: {points:?}"),
        }
        // Negative control: a path for limits 1 % larger would not pass.
        let (speed, acceleration) = peaks(&path(points, limits(1.01 * v, 1.01 * a)), 1e-3);
        assert!(speed > v || acceleration > a, "{points:?}");
    }
}

/// Random walks with 2 to 7 legs of 0.1 to 6 m, from a 64-bit linear congruential generator.
#[test]
fn limits_are_kept_on_random_walks() {
    let mut state = 2026_u64;
    let mut uniform = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        f64::from((state >> 32) as u32) / f64::from(u32::MAX)
    };
    let (mut refused, mut reached) = (0, 0);
    for walk in 0..60 {
        let mut points = vec![[0.0, 0.0, 2.0]];
        for leg in 0..2 + walk % 6 {
            let towards: Vector = from_fn(|_| uniform() - 0.5);
            let ratio = (0.1 + 5.9 * uniform()) / norm(towards);
            let from = points[leg];
            points.push(from_fn(|i| from[i] + ratio * towards[i]));
        }
        match WaypointPath::new(&points, SLOW) {
            Ok(path) => {
                let (speed, acceleration) = peaks(&path, path.duration_s() / 2000.0);
                assert!(speed <= 0.8 && acceleration <= 1.0, "{points:?}");
                reached += i32::from(speed > 0.99 * 0.8 || acceleration > 0.95);
            }
            Err(error) => {
                assert!(matches!(error, PathError::TooSharp { .. }), "{error}");
                refused += 1;
            }
        }
    }
    assert!(refused < 6, "{refused} of 60 refused");
    // The rest are bends so sharp that they fall between two samples.
    assert!(reached > 40, "only {reached} of 60 reach a limit");
}

/// The curve depends on the waypoints and the step only, so larger limits can never cost time.
#[test]
fn larger_limits_never_lengthen_the_flight() {
    let duration = |v: f64, a: f64| path(&UNEVEN, limits(v, a)).duration_s();
    for k in 1..20 {
        let [x, more] = [0.2 * f64::from(k), 0.2 * f64::from(k + 1)];
        assert!(duration(more, 1.0) <= duration(x, 1.0));
        assert!(duration(1.0, more) <= duration(1.0, x));
        // Time over x multiplies speeds by x and accelerations by x². Tolerance: rounding.
        let ratio = x * duration(0.8 * x, x * x) / duration(0.8, 1.0);
        assert!((ratio - 1.0).abs() < 1e-14);
    }
}

/// Velocity and acceleration are the derivatives of the position that is returned.
#[test]
fn val_derivatives_match_central_differences() {
    const STEP_S: f64 = 1e-4;
    for points in SHAPES {
        let path = path(points, SLOW);
        let (mut velocity_error, mut acceleration_error) = (0.0_f64, 0.0_f64);
        for (t, point) in samples(&path, 0.0037) {
            let (before, after) = (path.at(t - STEP_S), path.at(t + STEP_S));
            let rate = |a: Vector, b: Vector| minus(a, b).map(|x| x / (2.0 * STEP_S));
            let velocity = rate(after.position, before.position);
            let acceleration = rate(after.velocity, before.velocity);
            velocity_error = velocity_error.max(distance(velocity, point.velocity));
            acceleration_error = acceleration_error.max(distance(acceleration, point.acceleration));
        }
        // Truncation h² / 6 of a jerk below 2.6 m/s³, and rounding.
        assert!(velocity_error < 5e-9, "{velocity_error} m/s");
        // The jerk jumps at points of the spline: h / 4 of a jump below 5.2 m/s³.
        assert!(acceleration_error < 1.5e-4, "{acceleration_error} m/s²");
    }
}

#[test]
fn acceleration_is_continuous() {
    for points in SHAPES {
        let path = path(points, SLOW);
        let mut before = [0.0; 3];
        let mut largest = 0.0_f64;
        for (_, point) in samples(&path, 1e-3) {
            largest = largest.max(distance(point.acceleration, before));
            before = point.acceleration;
        }
        // A jerk below 2.6 m/s³ for 1 ms; a step of the curvature would give 0.1 m/s² and more.
        assert!(0.0 < largest && largest < 3e-3, "step of {largest} m/s²");
    }
}

#[test]
fn val_length_is_the_sum_of_short_chords() {
    for points in SHAPES {
        let path = path(points, SLOW);
        let (mut chords, mut before) = (0.0, points[0]);
        for (_, point) in samples(&path, 2e-3) {
            chords += distance(point.position, before);
            before = point.position;
        }
        // A chord c of an arc of radius R is short by c² / 24 R² of it: c < 1.4 mm, R > 0.33 m.
        let missing = 1.0 - chords / path.length_m();
        assert!(0.0 < missing && missing < 8e-7, "{missing}");
    }
}

#[test]
fn val_closely_spaced_points_of_a_circle_give_its_length() {
    let circle = |count: u32| {
        let angles = (0..=count).map(|k| TAU * f64::from(k % count) / f64::from(count));
        let points: Vec<Vector> = angles
            .map(|angle| [2.0 * angle.cos(), 2.0 * angle.sin(), 1.0])
            .collect();
        path(&points, SLOW)
    };
    // Interior pieces err by the fourth power of the spacing; at both ends the clamp along the chord
    // is off by half a spacing of angle, within a few pieces: third order, eight times less each.
    let error = |count| (circle(count).length_m() - 2.0 * TAU).abs();
    let (coarse, fine) = (error(32), error(64));
    assert!(coarse < 7e-3 && coarse > 7.0 * fine, "{coarse}, {fine} m");
    for (_, point) in samples(&circle(64), 0.05) {
        let [x, y, _] = point.position;
        // The sagitta of a chord, R (π / 64)² / 2 = 2.4e-3 m: the end pieces start along it.
        assert!((x.hypot(y) - 2.0).abs() < 2.4e-3);
    }
}

/// The documented shape of a corner: radius 0.20 h, at most 0.085 h off the legs.
#[test]
fn val_right_angle_between_long_legs_has_the_documented_bend() {
    let corner = [[-20.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 20.0, 0.0]];
    for step_m in [0.5, 1.0, 2.0] {
        let path = WaypointPath::with_step(&corner, step_m, SLOW).expect("a path");
        let (mut off_m, mut radius_m) = (0.0_f64, f64::INFINITY);
        for (_, point) in samples(&path, 5e-3) {
            let ([x, y, _], [vx, vy, _]) = (point.position, point.velocity);
            let [ax, ay, _] = point.acceleration;
            let to_first = y.hypot(x.max(0.0));
            let to_second = x.hypot(y.min(0.0));
            off_m = off_m.max(to_first.min(to_second));
            if x.abs() + y.abs() < step_m {
                radius_m = radius_m.min(vx.hypot(vy).powi(3) / (vx * ay - vy * ax).abs());
            }
        }
        // Infinite legs: M₋ + 4 M + M₊ = 6 √2 / h decays by √3 - 2 per step, so M = √6 / h across
        // a tangent of size 1 / √2: curvature √24 / h. 1 %: samples at both sides of the peak.
        let radius_ratio = radius_m * 24.0_f64.sqrt() / step_m;
        assert!((radius_ratio - 1.0).abs() < 1e-2, "{radius_ratio}");
        // 1 %: the last digit of 0.085.
        assert!((off_m / (0.085 * step_m) - 1.0).abs() < 1e-2, "{off_m} m");
    }
}

#[test]
fn translated_waypoints_give_the_translated_path() {
    let offset = [-1.1, 0.3, 0.7];
    let moved: [Vector; 3] = CLIMB_AND_TURN.map(|point| from_fn(|i| point[i] + offset[i]));
    let (here, there) = (path(&CLIMB_AND_TURN, SLOW), path(&moved, SLOW));
    for (t, point) in samples(&here, 0.05) {
        let back = minus(there.at(t).position, offset);
        assert!(distance(back, point.position) < 1e-13); // rounding
    }
    // Legs of exactly 1.5 and 2.5 steps must not be divided differently by rounding.
    for length in [3.0, 5.0] {
        let bend = |x: f64| {
            let points = [
                [x, 0.0, 0.0],
                [x + length, 0.0, 0.0],
                [x + length, 4.0, 0.0],
            ];
            path(&points, SLOW).length_m()
        };
        assert!((1..30).all(|k| (bend(0.1 * f64::from(k)) - bend(0.0)).abs() < 1e-12));
    }
}

#[test]
fn refuses_what_does_not_define_a_path() {
    let corner = CLIMB_AND_TURN;
    let refusal = |points: &[Vector]| WaypointPath::new(points, SLOW).expect_err("no path");
    assert_eq!(refusal(&[]), PathError::TooFewPoints { count: 0 });
    assert_eq!(refusal(&corner[..1]), PathError::TooFewPoints { count: 1 });
    let twice = [corner[0], corner[1], corner[1], corner[2]];
    assert_eq!(refusal(&twice), PathError::Coincident { index: 2 });
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e7, -1e300] {
        let error = refusal(&[corner[0], corner[1], [0.0, bad, 1.0]]).to_string();
        assert!(error.starts_with("points_m[2] = [0.0, "), "{error}");
    }
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e-300, 1e300] {
        for (name, step_m, limits) in [
            ("step_m", bad, SLOW),
            ("max_speed_m_s", 1.0, limits(bad, 1.0)),
            ("max_acceleration_m_s2", 1.0, limits(1.0, bad)),
        ] {
            let result = WaypointPath::with_step(&corner, step_m, limits);
            let error = result.expect_err("no path").to_string();
            assert!(error.starts_with(&format!("{name} = {bad}")), "{error}");
        }
    }
}

#[test]
fn refuses_more_pieces_than_memory_should_hold() {
    let many: Vec<Vector> = (0..1000).map(|k| [f64::from(k), 0.0, 1.0]).collect();
    let with = |step_m: f64| WaypointPath::with_step(&many, step_m, SLOW);
    // A leg has at most a thousand pieces.
    let refused = PathError::TooLong {
        pieces: 999_000.0,
        limit: 100_000,
    };
    assert_eq!(with(1e-6).err(), Some(refused));
    assert!(with(0.1).is_ok());
}

#[test]
fn refuses_reversals_and_needle_bends() {
    let turned = |degrees: f64, step_m: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let end = [4.0 + 4.0 * cos, 4.0 * sin, 0.0];
        let points = [[0.0; 3], [4.0, 0.0, 0.0], end, [9.0, 9.0, 9.0]];
        WaypointPath::with_step(&points, step_m, SLOW).err()
    };
    let refused = Some(PathError::TooSharp { index: 1 });
    for degrees in [180.0, 179.999_999, 179.0, 175.1] {
        assert_eq!(turned(degrees, 2.0), refused, "{degrees} degrees");
    }
    assert_eq!(turned(150.0, 2.0), None);
    // A bend of 0.2 mm slows the path more than 20-fold; with longer steps the turn can be flown.
    assert_eq!(turned(172.0, 0.2), refused);
    assert_eq!(turned(172.0, 4.0), None);
}

/// Whatever the numbers: an error, or a path that is finite everywhere.
#[test]
fn poisoned_input_gives_errors_or_finite_paths() {
    let values = [f64::NAN, f64::INFINITY, 30.0, 5e-324, 1e-6, 0.5];
    let (mut paths, mut errors) = (0, 0);
    for (a, b, c) in (0..216).map(|k| (values[k % 6], values[k / 6 % 6], values[k / 36])) {
        let points = [[0.0, 0.0, 1.0], [a, 1.0, b], [c, b, 2.0], [1.0, c, a]];
        for limits in [SLOW, limits(1e6, 1e-6), limits(a, c)] {
            let Ok(path) = WaypointPath::new(&points, limits) else {
                errors += 1;
                continue;
            };
            paths += 1;
            assert!(path.duration_s().is_finite() && path.length_m().is_finite());
            for k in 0..=20 {
                let at = path.at(path.duration_s() * f64::from(k) / 20.0);
                let all = [at.position, at.velocity, at.acceleration];
                assert!(all.as_flattened().iter().all(|x| x.is_finite()));
            }
        }
    }
    assert!(paths > 20 && errors > 20, "{paths} paths, {errors} errors");
    let far = path(&[[-1e6; 3], [1e6, -1e6, 1e6], [1e6; 3]], limits(1e-6, 1e6));
    assert!(norm(far.at(0.3 * far.duration_s()).velocity) > 0.0);
}
