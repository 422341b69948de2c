//! Probes of what shaders/plant_biped.wgsl and leg.wgsl have of their own; and leg.wgsl against the Rust code in double
//! precision and against an independent implementation.

use super::harness::{BLANK, Compared, Lab};
use super::loops::{rows, sized};
use super::shapes;
use super::tracked::Tracked;
use super::world::World;
use crate::backend::gpu::shape::Shape;
use crate::model::lanes::Lane;
use crate::model::plant::biped::{LegPlant, matrix_row, plus_product};
use crate::model::plant::leg::{LEG_JOINTS, LegJoint, LegModel, LegUniforms, forward_dynamics};
use std::path::Path;

/// `found`: the accelerations of a leg of a `model` at `q`, `rate` and `torque`, put together as the joints do it.
const DYNAMICS: &str = "
    var given_q = q;
    var given_rate = rate;
    var given_torque = torque;
    var turns: array<Turn, 6>;
    for (var k = 0u; k < 6u; k++) { turns[k] = turn(model.joints[k].angle.x, given_q[k]); }
    var bias = leg_bias(model, turns, rate);
    var left: array<f32, 6>;
    for (var k = 0u; k < 6u; k++) {
        left[k] = damped(model.joints[k].lever.w, given_rate[k], given_torque[k]) - bias[k];
    }
    left[0] = left[0] - leg_weight(model, turns[0]);
    var found = leg_solve(leg_factors(model, turns), left);
";

const PROBE: &str = "
@group(0) @binding(0) var<uniform> leg: LegModel;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if i >= arrayLength(&output) / 6u { return; }
    var given: array<f32, 18>;
    for (var k = 0u; k < 18u; k++) { given[k] = bitcast<f32>(draws[18u * i + k]); }
    let q = array(given[0], given[1], given[2], given[3], given[4], given[5]);
    let rate = array(given[6], given[7], given[8], given[9], given[10], given[11]);
    let torque = array(given[12], given[13], given[14], given[15], given[16], given[17]);
    var model = leg;
    DYNAMICS
    output[6u * i] = bitcast<u32>(found[0]);
    output[6u * i + 1u] = bitcast<u32>(found[1]);
    output[6u * i + 2u] = bitcast<u32>(found[2]);
    output[6u * i + 3u] = bitcast<u32>(found[3]);
    output[6u * i + 4u] = bitcast<u32>(found[4]);
    output[6u * i + 5u] = bitcast<u32>(found[5]);
}
";

const ROBOTS: [&str; 2] = ["g1_12dof", "berkeley_humanoid"];

fn text(constants: &[(String, u32)]) -> String {
    let [.., shape] = shapes::probed();
    let shape = Shape {
        plant_constants: constants.to_vec(),
        ..shape
    };
    format!("{}{}", shape.text(), PROBE.replace("DYNAMICS", DYNAMICS))
}

/// A joint's row of a matrix, and its product with what the joints have published.
pub(super) fn matrix_rows<const CUT: bool, const NS: usize>(
    lab: &Lab,
    world: &World<LegPlant<f32, CUT>, 6, NS, 0>,
) -> Compared {
    let body = "
        load();
        publish(stage, DEMAND, number(4u));
        workgroupBarrier();
        let row = matrix_row(asked_reference(), 1u);
        let factors = leg_seen(stage, DEMAND);
        for (var k = 0u; k < 6u; k++) {
            var numbers = row;
            answer_number(k, numbers[k]);
            numbers = factors;
            answer_number(6u + k, numbers[k]);
        }
        answer_number(12u, plus_product(stage, number(5u), row, DEMAND));";
    world.check(lab, body, 13, sized([1.0; 6]), |scene| {
        scene.each(|scene, a, c| {
            let count = world.shape.rows;
            let rows = rows(world, scene, a);
            let row = matrix_row(&rows[count * c..count * (c + 1)], 1);
            let factors: [Tracked; LEG_JOINTS] = std::array::from_fn(|k| scene.number(a, k, 4));
            for number in row.map(Tracked::exact).into_iter().chain(factors) {
                scene.answer_number(a, c, number);
            }
            let from = scene.number(a, c, 5);
            scene.answer_number(a, c, plus_product(from, &row, &factors));
        });
    })
}

/// The forward dynamics: every invocation has a leg of its own here.
pub(super) fn dynamics<const CUT: bool, const NS: usize>(
    lab: &Lab,
    world: &World<LegPlant<f32, CUT>, 6, NS, 0>,
) -> Compared {
    let body = "
        load();
        var model = uniforms.plant.model;
        let q = array(number(0u), number(1u), number(2u), number(3u), number(4u), number(5u));
        let rate = array(number(6u), number(7u), number(8u), number(9u), number(10u), number(11u));
        let torque = array(number(12u), number(13u), number(14u), number(15u), number(16u), number(17u));
        DYNAMICS
        for (var k = 0u; k < 6u; k++) { answer_number(k, found[k]); }";
    let body = &body.replace("DYNAMICS", DYNAMICS);
    let sizes = std::array::from_fn(|k: usize| [1.5, 2.0, 10.0][k / LEG_JOINTS]);
    world.check(lab, body, 6, sized::<18>(sizes), |scene| {
        scene.each(|scene, a, c| {
            let six = |first| std::array::from_fn(|k| scene.number(a, c, first + k));
            let [q, rate, torque] = [0, 6, 12].map(six);
            for number in forward_dynamics(&world.plant.model, &q, &rate, &torque) {
                scene.answer_number(a, c, number);
            }
        });
    })
}

fn models(name: &str, leg: usize) -> (LegModel<f64>, LegModel<f32>) {
    let robot = shapes::robot(name);
    let joints = robot.legs[leg].joints.each_ref().map(LegJoint::from);
    let gravity = robot.gravity_m_s2;
    (
        LegModel::new(&joints, gravity),
        LegModel::new(&joints, gravity),
    )
}

/// q, q' and torque of the reference states of a leg and the accelerations there, then of random states.
fn cases(name: &str, leg: usize) -> (Vec<[[f64; 6]; 3]>, Vec<[f64; 6]>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/biped_dynamics.json");
    let text = std::fs::read_to_string(path).unwrap();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let states = value["robots"][name].as_array().unwrap();
    let six = |state: &serde_json::Value, key: &str| -> [f64; 6] {
        std::array::from_fn(|j| state[key][6 * leg + j].as_f64().unwrap())
    };
    let mut cases: Vec<_> = states
        .iter()
        .map(|state| ["q", "qd", "tau_fd"].map(|key| six(state, key)))
        .collect();
    let accelerations = states.iter().map(|state| six(state, "qdd_fd")).collect();
    let mut seed = 7_u64;
    let mut random = |scale: f64| -> [f64; 6] {
        std::array::from_fn(|_| {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let unit = (seed >> 33) as f64 / f64::from(1 << 30) - 1.0;
            // Exact in single precision, so that rounding the input is not counted.
            (scale * unit * 4096.0).round() / 4096.0
        })
    };
    cases.extend((0..400).map(|_| [random(1.5), random(6.0), random(40.0)]));
    (cases, accelerations)
}

/// Largest difference over the largest value.
fn relative_error(found: &[f64], expected: &[f64; 6]) -> f64 {
    let size = expected.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let pairs = found.iter().zip(expected);
    let differences = pairs.map(|(a, b)| (a - b).abs());
    // What is no number is as wrong as can be.
    differences.fold(0.0, |most: f64, d| if d <= most { most } else { d }) / size
}

/// Largest error of the shader over reference and random states of a leg; `any` compiles it for axes that point
/// anywhere.
fn largest_error(lab: &Lab, name: &str, leg: usize, any: bool, edit: fn(String) -> String) -> f64 {
    let (exact, single) = models(name, leg);
    let mut constants = single.shader_constants();
    let twists = constants
        .iter_mut()
        .filter(|(name, _)| any && name.starts_with("TWIST"));
    for (_, value) in twists {
        *value = 2;
    }
    let (cases, accelerations) = cases(name, leg);
    let given: Vec<f32> = cases
        .iter()
        .flatten()
        .flatten()
        .map(|&x| x as f32)
        .collect();
    let blank = vec![BLANK; 6 * cases.len()];
    let words = LegUniforms::from(&single);
    let contents = [
        bytemuck::bytes_of(&words),
        &[0; 16],
        bytemuck::cast_slice(&given),
        &[0; 16],
        &[0; 16],
        bytemuck::cast_slice(&blank),
    ];
    let text = edit(text(&constants));
    let [_, found] = lab.dispatch(&text, contents, cases.len().div_ceil(64));
    let found: Vec<f64> = found
        .iter()
        .map(|&bits| f64::from(f32::from_bits(bits)))
        .collect();
    let mut worst: f64 = 0.0;
    for (i, (found, [q, rate, torque])) in found.chunks(6).zip(&cases).enumerate() {
        let expected = accelerations
            .get(i)
            .copied()
            .unwrap_or_else(|| forward_dynamics::<f64>(&exact, q, rate, torque));
        let error = relative_error(found, &expected);
        worst = if error <= worst { worst } else { error };
    }
    worst
}

#[test]
fn val_the_leg_accelerates_as_pinocchio_and_double_precision() {
    assert_eq!(<f64 as Lane>::WIDTH, 1);
    let Some(lab) = Lab::open() else { return };
    for name in ROBOTS {
        for leg in [0, 1] {
            for any in [false, true] {
                let worst = largest_error(&lab, name, leg, any, |text| text);
                println!("{name} leg {leg} any {any}: {worst:.1e}");
                // Single precision times a condition number of M of up to a few hundred.
                assert!(worst < 1e-5, "{name} {leg}: {worst:e}");
            }
        }
    }
}

#[test]
fn a_changed_sign_in_the_leg_is_noticed() {
    let Some(lab) = Lab::open() else { return };
    let worst = largest_error(&lab, ROBOTS[0], 0, false, |text| {
        let (old, new) = (
            "m.z = fma(joint.lever.x, f.y, m.z)",
            "m.z = fma(joint.lever.x, -f.y, m.z)",
        );
        assert!(text.contains(old));
        text.replace(old, new)
    });
    assert!(worst > 1e-2, "{worst:e}");
}

#[test]
fn val_the_leg_is_valid_and_lies_in_memory_as_its_twin_does() {
    for name in ROBOTS {
        let (_, single) = models(name, 0);
        let module = naga::front::wgsl::parse_str(&text(&single.shader_constants())).unwrap();
        naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            naga::valid::Capabilities::empty(),
        )
        .validate(&module)
        .unwrap();
        let span = module
            .types
            .iter()
            .find(|(_, own)| own.name.as_deref() == Some("LegModel"))
            .map(|(_, own)| own.inner.size(module.to_ctx()));
        assert_eq!(
            span.map(|span| span as usize),
            Some(size_of::<LegUniforms>())
        );
    }
}
