//! Probes of the functions that see nothing but their arguments: shaders/lanes.wgsl, math.wgsl, philox.wgsl, and those
//! of this kind in plant_uav.wgsl.

use super::harness::{Case, Compared, Expected, Job, Lab};
use super::numbers::Numbers;
use super::shapes;
use super::tracked::Tracked;
use super::world::World;
use crate::backend::gpu::shape::Shape;
use crate::model::lanes::Lane;
use crate::model::lanes::math::{self, clamp};
use crate::model::plant::uav::{Axis, body_axis};
use crate::random::philox::{Address, Stream, key, philox4x32, wide_product};
use std::f32::consts::{FRAC_PI_2, PI};

/// Inputs of a probe, beside the edge cases.
const RANDOM: usize = 500;

type Words = Vec<u32>;

/// Probes one function: the edge cases and random inputs through `body`, and through `twin`.
pub(super) fn probe(
    lab: &Lab,
    body: &str,
    edges: Vec<Words>,
    random: impl Fn(&mut Numbers) -> Words,
    twin: impl Fn(&[u32]) -> Vec<Expected>,
) -> Compared {
    probe_in(shapes::plain(), lab, body, edges, random, twin)
}

/// The same of the shaders of a shape.
fn probe_in(
    shape: Shape,
    lab: &Lab,
    body: &str,
    edges: Vec<Words>,
    random: impl Fn(&mut Numbers) -> Words,
    twin: impl Fn(&[u32]) -> Vec<Expected>,
) -> Compared {
    let world = World::<Axis<f32>, 1, 10, 0>::new(shape.clone(), shapes::axis());
    let mut inputs = edges;
    let mut numbers = Numbers::new(5, 0, 0);
    inputs.extend((0..RANDOM).map(|_| random(&mut numbers)));
    // Whole workgroups.
    while !inputs.len().is_multiple_of(shape.workgroup()) {
        inputs.push(random(&mut numbers));
    }
    let cases: Vec<Case> = inputs
        .iter()
        .map(|words| Case {
            taken: words.clone(),
            ..Case::default()
        })
        .collect();
    let left = lab.run(&Job {
        shape: &shape,
        setting: &world.bytes(),
        span: world.span,
        table: &world.table,
        body,
        image: 0,
        cases: &cases,
        given: twin(&inputs[0]).len(),
    });
    let mut compared = Compared::default();
    for (words, left) in inputs.iter().zip(&left) {
        for (k, (expected, &got)) in twin(words).into_iter().zip(&left.given).enumerate() {
            let as_numbers: Vec<f32> = words.iter().map(|&word| f32::from_bits(word)).collect();
            compared.take(expected, got, || {
                format!("result {k} of {words:x?} {as_numbers:?}")
            });
        }
    }
    compared
}

pub(super) fn number(word: u32) -> Tracked {
    Tracked::exact(f32::from_bits(word))
}

pub(super) fn near(number: Tracked) -> Vec<Expected> {
    vec![Expected::Near(number)]
}

/// Every choice of some of these numbers, `N` at a time.
fn choices<const N: usize>(values: &[f32]) -> Vec<Words> {
    (0..values.len().pow(N as u32))
        .map(|index| {
            (0..N as u32)
                .map(|k| values[index / values.len().pow(k) % values.len()].to_bits())
                .collect()
        })
        .collect()
}

/// These numbers, one at a time.
fn each(values: &[f32]) -> Vec<Words> {
    choices::<1>(values)
}

pub(super) fn words(numbers: &mut Numbers, sizes: &[f64]) -> Words {
    sizes.iter().map(|&size| numbers.single(size)).collect()
}

/// Choices at their edges; two NaNs leave open which of them is returned, so one argument is one at a time.
fn ordered() -> Vec<Words> {
    let values = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f32::MAX,
        f32::INFINITY,
        -f32::INFINITY,
        f32::NAN,
    ];
    let mut pairs = choices::<2>(&values);
    pairs.retain(|pair| !f32::from_bits(pair[1]).is_nan());
    pairs
}

pub(super) fn lane_max(lab: &Lab) -> Compared {
    let body = "answer_number(0u, lane_max(number(0u), number(1u)));";
    probe(
        lab,
        body,
        ordered(),
        |n| words(n, &[2.0, 2.0]),
        |x| near(number(x[0]).max(number(x[1]))),
    )
}

pub(super) fn lane_min(lab: &Lab) -> Compared {
    let body = "answer_number(0u, lane_min(number(0u), number(1u)));";
    probe(
        lab,
        body,
        ordered(),
        |n| words(n, &[2.0, 2.0]),
        |x| near(number(x[0]).min(number(x[1]))),
    )
}

pub(super) fn lane_select_le(lab: &Lab) -> Compared {
    let body = "answer_number(0u, lane_select_le(number(0u), number(1u), number(2u), number(3u)));";
    let values = [0.0, -0.0, 1.0, f32::INFINITY, f32::NAN];
    let edges = choices::<2>(&values)
        .into_iter()
        .map(|pair| [pair, vec![3_f32.to_bits(), 4_f32.to_bits()]].concat());
    probe(
        lab,
        body,
        edges.collect(),
        |n| words(n, &[1.0; 4]),
        |x| {
            near(Tracked::select_le(
                number(x[0]),
                number(x[1]),
                number(x[2]),
                number(x[3]),
            ))
        },
    )
}

pub(super) fn lane_within(lab: &Lab) -> Compared {
    let body = "answer(0u, select(0u, 1u, lane_within(number(0u), number(1u))));";
    let values = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f32::MAX,
        f32::INFINITY,
        -f32::INFINITY,
        f32::NAN,
    ];
    let mut edges = choices::<2>(&values);
    // A limit is finite and not negative.
    edges.retain(|pair| {
        (0.0..f32::INFINITY).contains(&f32::from_bits(pair[1])) && pair[1] >> 31 == 0
    });
    let random = |n: &mut Numbers| vec![n.single(1.0), n.single(1.0) & !math::SIGN_BIT];
    probe(lab, body, edges, random, |x| {
        let [value, limit] = [x[0], x[1]].map(f32::from_bits);
        vec![Expected::Bits(
            f32::select_le(value.abs(), limit, 1.0, 0.0) as u32
        )]
    })
}

pub(super) fn lane_turns_sin(lab: &Lab) -> Compared {
    let edges = (0..8_u32).flat_map(|eighth| {
        [u32::MAX, 0, 1].map(|beside| vec![(eighth << 29).wrapping_add(beside)])
    });
    let body = "answer_number(0u, lane_turns_sin(asked(0u)));";
    probe(
        lab,
        body,
        edges.collect(),
        |n| vec![n.word()],
        |x| near(Tracked::turns_sin(x[0])),
    )
}

pub(super) fn lane_unit_from_words(lab: &Lab) -> Compared {
    let edges = [0, 1, 511, 512, u32::MAX - 511, u32::MAX].map(|word| vec![word]);
    let body = "answer_number(0u, lane_unit_from_words(asked(0u)));";
    probe(
        lab,
        body,
        edges.to_vec(),
        |n| vec![n.word()],
        |x| near(Tracked::unit_from_words(x)),
    )
}

pub(super) fn lane_ln(lab: &Lab) -> Compared {
    let half = f32::from_bits(math::SQRT_HALF_BITS);
    let edges = each(&[
        f32::MIN_POSITIVE,
        1e-7,
        half,
        half.next_down(),
        1.0,
        2.0 * half,
        f32::MAX,
    ]);
    let random = |n: &mut Numbers| vec![f32::unit_from_words(&[n.word()]).to_bits()];
    probe(
        lab,
        "answer_number(0u, lane_ln(number(0u)));",
        edges,
        random,
        |x| near(number(x[0]).ln()),
    )
}

/// The polynomials of all lengths, with coefficients of the caller's.
pub(super) fn polynomials(lab: &Lab) -> Compared {
    let body = "
        let c = array(number(1u), number(2u), number(3u), number(4u), number(5u), number(6u), number(7u), number(8u), number(9u));
        answer_number(0u, polynomial_4(number(0u), array(c[0], c[1], c[2], c[3])));
        answer_number(1u, polynomial_5(number(0u), array(c[0], c[1], c[2], c[3], c[4])));
        answer_number(2u, polynomial_7(number(0u), array(c[0], c[1], c[2], c[3], c[4], c[5], c[6])));
        answer_number(3u, polynomial_9(number(0u), c));";
    fn of<const N: usize>(x: &[u32]) -> Expected {
        let coefficients: [f64; N] = std::array::from_fn(|k| f64::from(f32::from_bits(x[k + 1])));
        Expected::Near(math::polynomial(number(x[0]), &coefficients))
    }
    probe(
        lab,
        body,
        Vec::new(),
        |n| words(n, &[1.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
        |x| vec![of::<4>(x), of::<5>(x), of::<7>(x), of::<9>(x)],
    )
}

pub(super) fn sin_folded(lab: &Lab) -> Compared {
    let body = "answer_number(0u, sin_folded(number(0u)));";
    probe(
        lab,
        body,
        each(&[0.0, -0.0, 1.0, -1.0, 0.5]),
        |n| words(n, &[1.0]),
        |x| near(math::sin_folded(number(x[0]))),
    )
}

pub(super) fn sin_cos(lab: &Lab) -> Compared {
    let body =
        "let both = sin_cos(number(0u)); answer_number(0u, both.x); answer_number(1u, both.y);";
    let quadrants: Vec<f32> = (-8..=8)
        .map(|quadrant| quadrant as f32 * FRAC_PI_2)
        .flat_map(|x| [x.next_down(), x, x.next_up()])
        .collect();
    probe(
        lab,
        body,
        each(&quadrants),
        |n| words(n, &[12.0]),
        |x| {
            let (sine, cosine) = Tracked::sin_cos(number(x[0]));
            vec![Expected::Near(sine), Expected::Near(cosine)]
        },
    )
}

pub(super) fn tanh(lab: &Lab) -> Compared {
    let limit = math::TANH_LIMIT as f32;
    let edges = each(&[0.0, limit, -limit, 1e4, -1e4, 1e-6]);
    let body = "answer_number(0u, tanh(number(0u)));";
    probe(
        lab,
        body,
        edges,
        |n| words(n, &[9.0]),
        |x| near(math::tanh(number(x[0]))),
    )
}

pub(super) fn atan2(lab: &Lab) -> Compared {
    let edges = choices::<2>(&[0.0, 1.0, -1.0, 3.0, -3.0, 1e-6, -1e6, 1e6]);
    let body = "answer_number(0u, atan2(number(0u), number(1u)));";
    probe(
        lab,
        body,
        edges,
        |n| words(n, &[5.0, 5.0]),
        |x| near(math::atan2(number(x[0]), number(x[1]))),
    )
}

pub(super) fn ln_split(lab: &Lab) -> Compared {
    let half = f32::from_bits(math::SQRT_HALF_BITS);
    let body = "answer_number(0u, ln_split(number(0u), number(1u)));";
    let edges = choices::<2>(&[half, 1.0, 2.0 * half.next_down()]);
    let random = |n: &mut Numbers| {
        let mantissa = n.between(f64::from(half), 2.0 * f64::from(half)) as f32;
        vec![
            mantissa.to_bits(),
            (n.around(24.0) as f32).floor().to_bits(),
        ]
    };
    probe(lab, body, edges, random, |x| {
        near(math::ln_split(number(x[0]), number(x[1])))
    })
}

pub(super) fn wide_products(lab: &Lab) -> Compared {
    wide_products_in(shapes::plain(), lab)
}

pub(super) fn wide_products_int64(lab: &Lab) -> Compared {
    if !lab.has_int64() {
        println!("SKIPPED: the device has no 64-bit integers");
        return Compared::default();
    }
    wide_products_in(shapes::plain_int64(), lab)
}

fn wide_products_in(shape: Shape, lab: &Lab) -> Compared {
    let body =
        "let both = wide_product(asked(0u), asked(1u)); answer(0u, both.x); answer(1u, both.y);";
    let values = [0, 1, 0xffff, 0x1_0000, u32::MAX];
    let edges = values
        .iter()
        .flat_map(|&a| values.map(|b| vec![a, b]))
        .collect();
    probe_in(
        shape,
        lab,
        body,
        edges,
        |n| vec![n.word(), n.word()],
        |x| {
            let (high, low) = wide_product(x[0], x[1]);
            vec![Expected::Bits(high), Expected::Bits(low)]
        },
    )
}

const FOUR_WORDS: &str = "answer(0u, x.x); answer(1u, x.y); answer(2u, x.z); answer(3u, x.w);";

pub(super) fn philox(lab: &Lab) -> Compared {
    let call = "let x = philox4x32(vec4(asked(0u), asked(1u), asked(2u), asked(3u)), vec2(asked(4u), asked(5u)));";
    let edges = vec![vec![0; 6], vec![u32::MAX; 6]];
    probe(
        lab,
        &[call, FOUR_WORDS].concat(),
        edges,
        |n| (0..6).map(|_| n.word()).collect(),
        |x| {
            philox4x32([x[0], x[1], x[2], x[3]], [x[4], x[5]])
                .map(Expected::Bits)
                .to_vec()
        },
    )
}

pub(super) fn address_words(lab: &Lab) -> Compared {
    let call = "let x = address_words(Address(asked(0u), asked(1u), asked(2u), asked(3u), asked(4u)), vec2(asked(5u), asked(6u)));";
    let streams = [
        Stream::Initial,
        Stream::Disturbance,
        Stream::Fault,
        Stream::Noise,
    ];
    let random = |n: &mut Numbers| {
        let stream = n.one_of(&streams) as u32;
        vec![
            n.word(),
            stream,
            n.word() >> 8,
            n.word(),
            n.word(),
            n.word(),
            n.word(),
        ]
    };
    probe(lab, &[call, FOUR_WORDS].concat(), Vec::new(), random, |x| {
        let address = Address {
            episode: x[0],
            stream: streams[x[1] as usize - 1],
            entry: x[2],
            member: x[3],
            index: x[4],
        };
        let seed = u64::from(x[6]) << 32 | u64::from(x[5]);
        assert_eq!(key(seed), [x[5], x[6]]);
        address.words(seed).map(Expected::Bits).to_vec()
    })
}

pub(super) fn body_axes(lab: &Lab) -> Compared {
    let body = "let axis = body_axis(number(0u), number(1u), vec2(number(2u), number(3u)));
        answer_number(0u, axis.x); answer_number(1u, axis.y); answer_number(2u, axis.z);";
    let edges = choices::<4>(&[0.0, FRAC_PI_2, -PI, 1.0]);
    probe(
        lab,
        body,
        edges,
        |n| words(n, &[3.0, 3.0, 1.0, 1.0]),
        |x| {
            let yaw = (number(x[2]), number(x[3]));
            body_axis(number(x[0]), number(x[1]), yaw)
                .map(Expected::Near)
                .to_vec()
        },
    )
}

pub(super) fn clamps(lab: &Lab) -> Compared {
    let body = "answer_number(0u, clamp(number(0u), -abs(number(1u)), abs(number(1u))));";
    let edges = vec![
        vec![f32::NAN.to_bits(), 1_f32.to_bits()],
        vec![f32::INFINITY.to_bits(), 1_f32.to_bits()],
        vec![f32::NEG_INFINITY.to_bits(), 1_f32.to_bits()],
        vec![1_f32.to_bits(), 1_f32.to_bits()],
    ];
    probe(
        lab,
        body,
        edges,
        |n| words(n, &[2.0, 2.0]),
        |x| {
            let limit = number(x[1]).abs();
            near(clamp(number(x[0]), -limit, limit))
        },
    )
}
