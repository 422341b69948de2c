//! Six steps along one metre against tests/golden/walking_straight6.json and ground_reaction_straight6.txt.

use super::{g1, margins};
use crate::common::{golden, repository};
use serde_json::Value;
use urts_mc::reference::walk::{Foot, Gait, Spline, Walk, ground_reaction};

const LINE: [[f64; 2]; 2] = [[0.0, 0.0], [1.0, 0.0]];

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn rows<'a>(file: &'a Value, key: &str) -> &'a [Value] {
    let rows = file[key].as_array().unwrap();
    assert!(rows.len() >= 6, "{key} has too few rows to compare");
    rows
}

/// Time of a row, s.
fn time(row: &Value) -> f64 {
    0.01 * number(&row["k"])
}

fn sample(row: &Value) -> usize {
    usize::try_from(row["k"].as_u64().unwrap()).unwrap()
}

/// Largest difference of the entries of `ours` from those of a list.
fn difference(ours: &[f64], theirs: &Value) -> f64 {
    let theirs = theirs.as_array().unwrap();
    assert_eq!(ours.len(), theirs.len());
    let differences = ours.iter().zip(theirs).map(|(a, b)| (a - number(b)).abs());
    // f64::max would pass over not-a-number.
    differences.fold(0.0, |a, b| if b <= a { a } else { b })
}

/// The walk with the reference's own offset and height of the centre of mass.
fn walk(file: &Value) -> Walk {
    let gait = Gait::G1;
    let height = number(&file["z_c_m"]) - gait.pelvis_height_m;
    let offset = [0, 1].map(|i| number(&file["com_offset_m"][i]));
    Walk::plan_with_com_offset(&g1(), &LINE, &gait, [offset[0], offset[1], height]).unwrap()
}

fn holds(name: &str, difference: f64, tolerance: f64) {
    println!("{name}: {difference:.1e} (tolerance {tolerance:.0e})");
    assert!(
        difference <= tolerance,
        "{name}: {difference:e} above {tolerance:e}"
    );
}

#[test]
fn val_footholds_and_their_times_match() {
    let file = golden("walking_straight6.json");
    let walk = walk(&file);
    let expected = rows(&file, "footholds");
    let footholds = walk.feet.footholds();
    assert_eq!(footholds.len(), expected.len());
    for (ours, theirs) in footholds.iter().zip(expected) {
        let left = theirs["foot"] == "L";
        assert_eq!(ours.foot, if left { Foot::Left } else { Foot::Right });
        let [x, y] = ours.placement.position_m;
        assert!(difference(&[x, y, 0.0], &theirs["x"]) <= 1e-12);
        assert!((ours.touch_s - number(&theirs["t"])).abs() <= 1e-12);
    }
    for (ours, theirs) in walk.feet.swings().iter().zip(rows(&file, "steps")) {
        assert!((ours.lift_s - number(&theirs["t_lift"])).abs() <= 1e-12);
    }
}

#[test]
fn val_pendulum_matches() {
    // The file gives 1e-12 m; the largest state is an acceleration of some m/s^2 that the gains of 1400 have rounded.
    const TOL: f64 = 1e-9;
    let file = golden("walking_straight6.json");
    let walk = walk(&file);
    let mut worst = [0.0_f64; 3];
    for row in rows(&file, "rows") {
        let [x, y] = &walk.com.states[sample(row)];
        let reference = walk.zmp_reference.at(time(row));
        let differences = [
            difference(&reference, &row["zmp_ref"]),
            difference(&walk.com.zmp_m[sample(row)], &row["zmp"]),
            f64::max(difference(x, &row["com_x"]), difference(y, &row["com_y"])),
        ];
        worst = std::array::from_fn(|i| worst[i].max(differences[i]));
    }
    for (name, worst) in ["ZMP reference", "ZMP", "centre of mass"].iter().zip(worst) {
        holds(name, worst, TOL);
    }
    let gain = walk.com.first_gain;
    // Relative: the recursion is contracting, so that rounding does not grow.
    let relative = difference(&gain, &file["lqt_gain_first"]) / gain[0];
    holds("first gain, relative", relative, 1e-12);
}

#[test]
fn val_ankles_match() {
    let file = golden("walking_straight6.json");
    let walk = walk(&file);
    for row in rows(&file, "samples") {
        let ankles = walk.feet.ankles_at(time(row));
        for (ankle, name) in ankles.iter().zip(["left_ankle", "right_ankle"]) {
            let [x, y] = ankle.placement.position_m;
            let ours = [x, y, ankle.height_m, ankle.placement.heading_rad];
            // The digits of the file.
            assert!(
                difference(&ours, &row[name]) <= 1e-12,
                "{name} at {}",
                row["k"]
            );
        }
    }
}

#[test]
fn val_joint_angles_rates_and_accelerations_match() {
    let file = golden("walking_straight6.json");
    let walk = walk(&file);
    let angles = rows(&file, "rows").iter().map(|row| {
        let ours = walk.at(time(row)).map(|joint| joint.value);
        difference(&ours, &row["q"])
    });
    holds("q", angles.fold(0.0, f64::max), 1e-8);
    let mut worst = [0.0_f64; 2];
    for row in rows(&file, "samples") {
        let joints = walk.at(time(row));
        let rates = difference(&joints.map(|joint| joint.rate), &row["qd"]);
        let accelerations = difference(&joints.map(|joint| joint.acceleration), &row["qdd"]);
        worst = [worst[0].max(rates), worst[1].max(accelerations)];
    }
    // Both sides solve for the angles to 1e-12 rad; differences over 10 ms multiply that by 1e2 and twice by 1e4, the
    // spline by a few.
    holds("q'", worst[0], 1e-9);
    holds("q''", worst[1], 1e-7);
}

#[test]
fn val_zmp_error_and_support_margins_match() {
    let file = golden("walking_straight6.json");
    let walk = walk(&file);
    let mut errors = [0.0_f64; 2];
    for (t_s, zmp) in walk.times_s().zip(&walk.com.zmp_m) {
        let reference = walk.zmp_reference.at(t_s);
        errors = std::array::from_fn(|i| errors[i].max((zmp[i] - reference[i]).abs()));
    }
    holds(
        "largest ZMP error",
        difference(&errors, &file["max_zmp_error_m"]),
        1e-9,
    );
    assert!(errors[0] <= 0.3e-3 && errors[1] <= 1.61e-3);
    let margins = margins(&g1(), &walk);
    println!("margins {margins:?} m");
    // Those of points that agree within 1e-9 m (pendulum) and, by the accelerations' 1e-7, 1e-8 m (all links).
    for (margin, key) in margins.iter().zip([
        "min_support_margin_lipm_m",
        "min_support_margin_multibody_m",
    ]) {
        holds(key, (margin - number(&file[key])).abs(), 1e-8);
    }
}

/// Our pelvis follows the tracker's motion exactly, ends included. The reference's second derivative comes from a
/// spline with not-a-knot ends through the same samples, which differs in the first and the last ten of them.
fn with_the_reference_pelvis(walk: &Walk) -> Walk {
    let points: Vec<(f64, [f64; 3])> = walk
        .times_s()
        .map(|t_s| (t_s, walk.pelvis.value(t_s)))
        .collect();
    let last = points.len() - 1;
    // Jump of the third derivative at the last but one knots, linear in the end slopes and far from each other.
    let jumps = |slopes: [[f64; 3]; 2]| -> [[f64; 3]; 2] {
        let spline = Spline::clamped(points.clone(), slopes);
        let second = |k: usize| spline.at(points[k].0).map(|point| point.acceleration);
        [[0, 1, 2], [last, last - 1, last - 2]].map(|[a, b, c]| {
            let [a, b, c] = [second(a), second(b), second(c)];
            std::array::from_fn(|i| a[i] - 2.0 * b[i] + c[i])
        })
    };
    let (zero, one) = (jumps([[0.0; 3]; 2]), jumps([[1.0; 3]; 2]));
    let slope = |end: usize, i: usize| zero[end][i] / (zero[end][i] - one[end][i]);
    let slopes = [0, 1].map(|end| std::array::from_fn(|i| slope(end, i)));
    let mut other = walk.clone();
    other.pelvis = Spline::clamped(points, slopes);
    other
}

#[test]
fn val_ground_reaction_matches() {
    // 12 digits of 100 N m; accelerations that agree within 1e-8 rad/s^2 (above) and legs of 7 kg.
    const TOL_N_M: f64 = 1e-8;
    let file = golden("walking_straight6.json");
    let path = repository("tests/golden/ground_reaction_straight6.txt");
    let text = std::fs::read_to_string(path).unwrap();
    let robot = g1();
    let own = walk(&file);
    let theirs = with_the_reference_pelvis(&own);
    let (mut rows, mut worst, mut worst_at_ends) = (0, 0.0_f64, 0.0_f64);
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        let [k, torques @ ..] = &numbers[..] else {
            panic!("an empty line")
        };
        let off = |walk: &Walk| {
            let ours = ground_reaction(walk, &robot, 0.01 * k).torque_n_m;
            let differences = ours.iter().zip(torques).map(|(a, b)| (a - b).abs());
            differences.fold(0.0, f64::max)
        };
        rows += 1;
        worst = worst.max(off(&theirs));
        if (15.0..=805.0).contains(k) {
            worst = worst.max(off(&own));
        } else {
            worst_at_ends = worst_at_ends.max(off(&own));
        }
    }
    assert!(rows > 100);
    holds("J'f, N m", worst, TOL_N_M);
    // What a spline that does not know that the pelvis starts at rest makes of its first acceleration: it must differ.
    println!("J'f at the ends with our own pelvis: {worst_at_ends:.2e} N m");
    assert!((1e-3..0.2).contains(&worst_at_ends));
    for row in self::rows(&file, "samples") {
        let zmp_m = ground_reaction(&theirs, &robot, time(row)).zmp_m;
        assert!(
            difference(&zmp_m, &row["zmp_multibody"]) <= 1e-8,
            "ZMP at {}",
            row["k"]
        );
    }
}

#[test]
fn val_own_center_of_mass_matches_an_early_iterate() {
    let file = golden("walking_straight6.json");
    let walk = Walk::plan(&g1(), &LINE, &Gait::G1).unwrap();
    let [x, y, z] = walk.com_offset_m;
    // The reference stopped its iteration 4e-8 m away.
    let off = [
        x - number(&file["com_offset_m"][0]),
        Gait::G1.pelvis_height_m + z - number(&file["z_c_m"]),
    ];
    println!("offset differs by {off:?} m");
    assert!(off.iter().all(|off| off.abs() <= 1e-7));
    assert_eq!(y, 0.0);
    // Converged: the standing pose planned with it has its centre of mass there.
    let pose = walk.at(0.0).map(|joint| joint.value);
    let com = urts_mc::agent::robot::kinematics::com_m(&g1(), &pose);
    assert!((com.x - x).abs() <= 1e-11 && (com.z - z).abs() <= 1e-11);
}
