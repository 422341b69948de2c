//! The lane types: elementary functions, phases, selections, random numbers in the unit interval.

use urts_mc::backend::cpu::Simd;
use urts_mc::model::lanes::{Kernel, Lane, MAX_WIDTH};

/// Work on lanes, with the instructions they need.
struct Apply<L, F>(F, std::marker::PhantomData<L>);

impl<L: Lane, F: FnOnce()> Kernel for Apply<L, F> {
    type Output = ();
    fn run(self) {
        (self.0)();
    }
}

/// Values of a function of one argument on lanes of type `L`.
fn on_lanes<L: Lane>(arguments: &[f64], function: impl Fn(L) -> L) -> Vec<f64> {
    let mut values = Vec::new();
    for chunk in arguments.chunks(MAX_WIDTH) {
        let mut padded = [chunk[0]; MAX_WIDTH];
        padded[..chunk.len()].copy_from_slice(chunk);
        for part in padded.chunks(L::WIDTH) {
            let mut stored = [0.0; MAX_WIDTH];
            function(L::load(part)).store(&mut stored);
            values.extend(&stored[..L::WIDTH]);
        }
        values.truncate(values.len() - MAX_WIDTH + chunk.len());
    }
    values
}

/// Does work with the instructions that lanes of type `L` need.
fn with_features<L: Lane>(work: impl FnOnce()) {
    L::dispatch(Apply::<L, _>(work, std::marker::PhantomData));
}

/// Runs a generic check on every lane type that this processor has.
macro_rules! on_every_lane {
    ($check:ident) => {
        $check::<f64>();
        $check::<f32>();
        #[cfg(target_arch = "x86_64")]
        {
            use urts_mc::model::lanes::{double, simd};
            if Simd::Avx2.is_available() {
                with_features::<simd::F32x8>($check::<simd::F32x8>);
                with_features::<double::F64x4>($check::<double::F64x4>);
            }
            if Simd::Avx512.is_available() {
                with_features::<simd::F32x16>($check::<simd::F32x16>);
                with_features::<double::F64x8>($check::<double::F64x8>);
            }
        }
    };
}

fn grid(low: f64, high: f64, count: usize) -> Vec<f64> {
    (0..count)
        .map(|k| f64::from((low + (high - low) * k as f64 / (count - 1) as f64) as f32))
        .collect()
}

fn close(
    name: &str,
    arguments: &[f64],
    ours: &[f64],
    expected: impl Fn(f64) -> f64,
    tolerance: f64,
) {
    assert_eq!(arguments.len(), ours.len());
    for (x, y) in arguments.iter().zip(ours) {
        let difference = (y - expected(*x)).abs();
        assert!(
            difference <= tolerance,
            "{name}({x}) = {y}, off by {difference:e} > {tolerance:e}"
        );
    }
}

/// Two units in the last place of a single near one.
const SINGLE_TOL: f64 = 2.5e-7;

fn elementary_functions<L: Lane>() {
    let angles = grid(-7.0, 7.0, 2001);
    // The reduction by two parts of pi is good to a few turns, 1 ulp of the angle.
    close(
        "sin",
        &angles,
        &on_lanes::<L>(&angles, |x| x.sin_cos().0),
        f64::sin,
        2.0 * SINGLE_TOL,
    );
    close(
        "cos",
        &angles,
        &on_lanes::<L>(&angles, |x| x.sin_cos().1),
        f64::cos,
        2.0 * SINGLE_TOL,
    );
    let wide = grid(-12.0, 12.0, 2001);
    // Beyond 7.9 the value is 1, from which tanh is still 2.7e-7 away.
    close(
        "tanh",
        &wide,
        &on_lanes::<L>(&wide, Lane::tanh),
        f64::tanh,
        2.8e-7,
    );
    // The angle itself reaches pi: 2 ulp of it.
    for x in [-2.0, -1.0, -1e-3, 0.0, 1e-3, 0.7, 3.0] {
        let ours = on_lanes::<L>(&wide, |y| y.atan2(L::number(x)));
        close(
            "atan2",
            &wide,
            &ours,
            |y| y.atan2(f64::from(x as f32)),
            3.0 * SINGLE_TOL,
        );
    }
    assert_eq!(on_lanes::<L>(&[0.0], |y| y.atan2(L::number(0.0))), [0.0]);
    let positive = grid(1e-7, 40.0, 2001);
    // ln reaches 16 in size; the error is relative to that.
    close(
        "ln",
        &positive,
        &on_lanes::<L>(&positive, Lane::ln),
        f64::ln,
        16.0 * SINGLE_TOL,
    );
    let near_one = grid(0.9, 1.1, 501);
    close(
        "ln",
        &near_one,
        &on_lanes::<L>(&near_one, Lane::ln),
        f64::ln,
        SINGLE_TOL,
    );
}

/// Four units in the last place of a double near one: some operations of half a unit each.
const DOUBLE_TOL: f64 = 9e-16;

fn elementary_functions_in_double<L: Lane>() {
    let angles = grid(-7.0, 7.0, 20_001);
    let sine = on_lanes::<L>(&angles, |x| x.sin_cos().0);
    close("sin", &angles, &sine, f64::sin, DOUBLE_TOL);
    let cosine = on_lanes::<L>(&angles, |x| x.sin_cos().1);
    close("cos", &angles, &cosine, f64::cos, DOUBLE_TOL);
    // Relative to a small value too.
    let small = grid(1e-9, 0.1, 5001);
    for (name, ours, expected) in [
        (
            "tanh",
            on_lanes::<L>(&small, Lane::tanh),
            f64::tanh as fn(f64) -> f64,
        ),
        ("sin", on_lanes::<L>(&small, |x| x.sin_cos().0), f64::sin),
        (
            "atan2",
            on_lanes::<L>(&small, |y| y.atan2(L::number(1.0))),
            f64::atan,
        ),
    ] {
        let relative: Vec<f64> = small
            .iter()
            .zip(&ours)
            .map(|(x, y)| y / expected(*x))
            .collect();
        close(name, &small, &relative, |_| 1.0, 2.0 * DOUBLE_TOL);
    }
    let wide = grid(-25.0, 25.0, 20_001);
    let tangent = on_lanes::<L>(&wide, Lane::tanh);
    close("tanh", &wide, &tangent, f64::tanh, DOUBLE_TOL);
    for x in [-2.0, -1.0, -1e-3, 0.0, 1e-3, 0.7, 3.0] {
        let angle = on_lanes::<L>(&wide, |y| y.atan2(L::number(x)));
        close("atan2", &wide, &angle, |y| y.atan2(x), DOUBLE_TOL);
    }
    // ln reaches 16 in size.
    let positive = grid(1e-7, 40.0, 20_001);
    let logarithm = on_lanes::<L>(&positive, Lane::ln);
    close("ln", &positive, &logarithm, f64::ln, 4.0 * DOUBLE_TOL);
    let near_one = grid(0.9, 1.1, 501);
    let logarithm = on_lanes::<L>(&near_one, Lane::ln);
    close("ln", &near_one, &logarithm, f64::ln, 0.1 * DOUBLE_TOL);
    // A phase of 64 bits: the sine of an exact fraction of a turn.
    let turns: Vec<f64> = (0..4096).map(|k| f64::from(k) / 4096.0).collect();
    for part in turns.chunks(L::WIDTH) {
        let mut stored = [0.0; MAX_WIDTH];
        L::turns_sin(L::turns(part)).store(&mut stored);
        let sine = |turns: f64| (std::f64::consts::TAU * turns).sin();
        close("turns_sin", part, &stored[..part.len()], sine, DOUBLE_TOL);
    }
}

#[test]
fn val_double_precision_is_good_to_some_units_in_the_last_place() {
    elementary_functions_in_double::<f64>();
    #[cfg(target_arch = "x86_64")]
    {
        use urts_mc::model::lanes::double::{F64x4, F64x8};
        if Simd::Avx2.is_available() {
            with_features::<F64x4>(elementary_functions_in_double::<F64x4>);
        }
        if Simd::Avx512.is_available() {
            with_features::<F64x8>(elementary_functions_in_double::<F64x8>);
        }
    }
}

#[test]
fn val_elementary_functions_agree_with_the_standard_library_on_every_lane_type() {
    on_every_lane!(elementary_functions);
}

fn phases<L: Lane>() {
    let turns = [
        0.0,
        0.1,
        0.25,
        0.3,
        0.49,
        0.5,
        0.51,
        0.75,
        0.99,
        7.3,
        -0.2,
        1.0 - 1e-17,
        123_456.75,
        -3.0,
        0.125,
        0.875,
    ];
    let steps = [0.001_234_5; MAX_WIDTH];
    for part in 0..MAX_WIDTH / L::WIDTH {
        let lanes = &turns[part * L::WIDTH..];
        let mut phase = L::turns(lanes);
        for _ in 0..1000 {
            phase = L::turns_add(phase, L::turns(&steps));
        }
        let mut stored = [0.0; MAX_WIDTH];
        L::turns_sin(phase).store(&mut stored);
        for (start, sine) in lanes.iter().zip(&stored[..L::WIDTH]) {
            let exact = ((start + 1.2345) * std::f64::consts::TAU).sin();
            // A thousand steps, each rounded to half of 2^-32 turns, are off by at most 7.3e-7 rad.
            assert!(
                (sine - exact).abs() < 7.3e-7 + SINGLE_TOL,
                "{start}: {sine} against {exact}"
            );
        }
    }
}

#[test]
fn val_phases_count_exactly_and_give_the_sine() {
    on_every_lane!(phases);
}

fn selections<L: Lane>() {
    let select = |left: f64, right: f64| {
        on_lanes::<L>(&[left], |left| {
            L::select_le(left, L::number(right), L::number(1.0), L::number(2.0))
        })[0]
    };
    assert_eq!(
        [
            select(1.0, 2.0),
            select(2.0, 2.0),
            select(3.0, 2.0),
            select(f64::NAN, 2.0)
        ],
        [1.0, 1.0, 2.0, 2.0]
    );
    let words = [
        0,
        u32::MAX,
        0x8000_0000,
        255,
        256,
        1,
        2,
        3,
        4,
        5,
        6,
        7,
        8,
        9,
        10,
        11,
    ];
    for part in words.chunks(L::WIDTH) {
        let mut stored = [0.0; MAX_WIDTH];
        L::unit_from_words(part).store(&mut stored);
        for (word, unit) in part.iter().zip(stored) {
            assert_eq!(unit, (f64::from(word >> 9) + 0.5) / 8_388_608.0);
        }
    }
}

#[test]
fn a_comparison_with_nan_selects_the_failure_and_words_map_into_the_open_unit_interval() {
    on_every_lane!(selections);
}
