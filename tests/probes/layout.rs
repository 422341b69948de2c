//! Without a device: the joined text of every shape is valid WGSL, and its structs, bindings, workgroups and constants
//! are those of Rust.

use super::shapes;
use super::world::World;
use crate::agent::{FIRST_ATTITUDE, HEIGHT};
use crate::backend::gpu::layout::{self, OUTCOME_WORDS, SHOWN_WORDS, Span};
use crate::backend::gpu::pipeline::{BINDINGS, ENTRIES};
use crate::backend::gpu::shape::Shape;
use crate::backend::gpu::uniforms::{
    GainsUniforms, LegPlantUniforms, SettingHead, UavUniforms, setting,
};
use crate::campaign::Campaign;
use crate::draw::MEMBERS_PER_AGENT;
use crate::model::agent::Coupling;
use crate::model::controller::OBSERVER;
use crate::model::controller::kinds::{Controller, Family};
use crate::model::controller::observer_feedback::FTC_STATES;
use crate::model::episode::Model;
use crate::model::exogenous::lists::LISTS;
use crate::model::exogenous::vortex::{JET_PEAK, JET_SPREAD};
use crate::model::lanes::math;
use crate::model::metric::{Extremes, Sums};
use crate::model::plant::kinds::PlantKind;
use crate::model::plant::leg::LegUniforms;
use crate::model::team::{FAR_AWAY, FLUSH_STEPS};
use crate::random::philox::{self, Stream};
use naga::{AddressSpace, Expression, Handle, Literal, Module, StorageAccess, TypeInner};
use std::mem::offset_of;
use std::path::Path;

/// The joined text, parsed and validated.
pub(super) fn module(shape: &Shape) -> Module {
    let text = shape.text();
    let module = naga::front::wgsl::parse_str(&text)
        .unwrap_or_else(|error| panic!("{shape:?}: {}", error.emit_to_string(&text)));
    naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::empty(),
    )
    .validate(&module)
    .unwrap_or_else(|error| panic!("{shape:?}: {}", error.emit_to_string(&text)));
    module
}

/// The members of a struct with their offsets, and its span.
fn layout(module: &Module, name: &str) -> (Vec<(String, usize)>, usize) {
    let ty = module
        .types
        .iter()
        .find(|(_, ty)| ty.name.as_deref() == Some(name));
    let Some(TypeInner::Struct { members, span }) = ty.map(|(_, ty)| &ty.inner) else {
        panic!("no struct {name}");
    };
    let members = members
        .iter()
        .map(|member| (member.name.clone().unwrap(), member.offset as usize));
    (members.collect(), *span as usize)
}

/// Names of fields with their offsets.
macro_rules! offsets {
    ($type:ty: $($field:ident),+) => {
        vec![$((stringify!($field).to_string(), offset_of!($type, $field))),+]
    };
}

#[test]
fn val_every_shape_is_valid_wgsl() {
    let shapes = shapes::validated();
    // Each list alone, turbulence, jets, nothing and all; teams, and controllers.
    let counts = LISTS.len() + 4;
    assert_eq!(shapes.len(), counts * PlantKind::ALL.len() * 3 * 2);
    for shape in shapes.iter().chain(&shapes::probed()) {
        let module = module(shape);
        let entries: Vec<&str> = module
            .entry_points
            .iter()
            .map(|entry| entry.name.as_str())
            .collect();
        assert_eq!(entries, ENTRIES);
        for entry in &module.entry_points {
            assert_eq!(entry.stage, naga::ShaderStage::Compute);
            assert_eq!(entry.workgroup_size, [shape.workgroup() as u32, 1, 1]);
        }
    }
}

#[test]
fn val_structs_lie_in_memory_as_their_twins_do() {
    for shape in shapes::probed() {
        let module = module(&shape);
        assert_eq!(
            layout(&module, "Span"),
            (
                offsets!(Span: first, until, table_first, output_first),
                size_of::<Span>()
            )
        );
        let plant_span = if shape.plant == PlantKind::Leg {
            assert_eq!(
                layout(&module, "Leg"),
                (
                    offsets!(LegPlantUniforms: model, max_torque),
                    size_of::<LegPlantUniforms>()
                )
            );
            assert_eq!(layout(&module, "LegModel").1, size_of::<LegUniforms>());
            size_of::<LegPlantUniforms>()
        } else {
            let mut expected = offsets!(UavUniforms: mass, inverse_mass, drag, gravity, inertia, inverse_inertia, gyro, angular_drag, filter_rad_s, max_thrust, max_torque, max_tilt);
            let unused = offset_of!(UavUniforms, unused);
            expected.extend((0..3).map(|k| (format!("unused_{k}"), unused + 4 * k)));
            assert_eq!(layout(&module, "Uav"), (expected, size_of::<UavUniforms>()));
            size_of::<UavUniforms>()
        };
        assert_eq!(
            layout(&module, "ChannelGains"),
            (
                offsets!(GainsUniforms: feedback, injection, smoothing, sensor_fault_input),
                size_of::<GainsUniforms>()
            )
        );
        // Words of the setting's step, in this order.
        let step = ["sixth", "third", "half", "whole"];
        let step = step
            .iter()
            .enumerate()
            .map(|(k, name)| (name.to_string(), 4 * k));
        assert_eq!(layout(&module, "Step"), (step.collect(), 16));

        let plant = size_of::<SettingHead>();
        let head = plant + plant_span;
        let limits = 16 * shape.channels;
        let mut expected = offsets!(SettingHead: seed, settle_step, first_channel, h);
        expected.push(("plant".to_string(), plant));
        expected.push(("limits".to_string(), head));
        expected.push(("gains".to_string(), head + limits));
        let span = head + limits + shape.kinds() * size_of::<GainsUniforms>();
        assert_eq!(layout(&module, "Uniforms"), (expected, span));
        // Arrays of the setting: an element follows the other without a gap.
        for (ty, stride) in module.types.iter().filter_map(|(_, ty)| match ty.inner {
            TypeInner::Array { base, stride, .. } => Some((base, stride as usize)),
            _ => None,
        }) {
            if module.types[ty].name.as_deref() == Some("ChannelGains") {
                assert_eq!(stride, size_of::<GainsUniforms>());
            }
        }
    }
}

#[test]
fn val_kept_metrics_have_the_names_and_the_order_of_their_twins() {
    let module = module(&shapes::plain());
    for (name, twins) in [
        ("Sums", Sums::<f32>::NAMES),
        ("Extremes", Extremes::<f32>::NAMES),
    ] {
        let (members, _) = layout(&module, name);
        let members: Vec<&str> = members.iter().map(|(member, _)| member.as_str()).collect();
        assert_eq!(members, twins, "{name}");
    }
}

#[test]
fn val_the_setting_that_is_sent_fills_its_struct() {
    let world = World::<_, 6, 10, 4>::new(shapes::probed()[5].clone(), shapes::thrust());
    let controller = Controller {
        family: Family::FaultTolerant(vec![world.gains[0], world.gains[5]]),
    };
    let mut plants = 0;
    for name in [
        "uav-paper",
        "uav-faults",
        "uav-physical",
        "biped-ground-reaction",
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("campaigns/{name}.toml"));
        let campaign = Campaign::load(&path).unwrap();
        let model: Model<f32> = Model::new(campaign.first_group());
        for part in &model.parts {
            let mut shapes = shapes::validated().into_iter();
            let shape = shapes
                .find(|shape| shape.plant == part.plant.kind())
                .unwrap();
            let (_, span) = layout(&module(&shape), "Uniforms");
            assert_eq!(
                setting(campaign.first_group(), part, &controller).len(),
                span
            );
            plants += 1;
        }
    }
    assert_eq!(
        plants, 9,
        "three axes and the attitude; the same where rotors blow; all channels under thrust; two legs"
    );
    assert_eq!(
        world.bytes().len(),
        layout(&module(&world.shape), "Uniforms").1
    );
}

#[test]
fn val_bindings_are_those_of_the_layout() {
    use wgpu::BufferBindingType::{Storage, Uniform};
    for shape in shapes::probed() {
        let module = module(&shape);
        let mut bound = Vec::new();
        for (_, variable) in module.global_variables.iter() {
            let Some(binding) = &variable.binding else {
                continue;
            };
            assert_eq!(binding.group, 0);
            let kind = match variable.space {
                AddressSpace::Uniform => Uniform,
                AddressSpace::Storage { access } => Storage {
                    read_only: !access.contains(StorageAccess::STORE),
                },
                other => panic!("{other:?} is bound"),
            };
            bound.push((binding.binding, kind));
        }
        bound.sort_by_key(|&(binding, _)| binding);
        assert_eq!(bound, (0..).zip(BINDINGS).collect::<Vec<_>>());
    }
}

/// The words of a constant: bits of numbers, 0 and 1 of flags.
fn constant(module: &Module, name: &str) -> Vec<u32> {
    let found = module
        .constants
        .iter()
        .find(|(_, constant)| constant.name.as_deref() == Some(name));
    let Some((_, found)) = found else {
        panic!("no constant {name}")
    };
    let mut words = Vec::new();
    evaluate(module, found.init, &mut words);
    words
}

fn evaluate(module: &Module, expression: Handle<Expression>, words: &mut Vec<u32>) {
    match &module.global_expressions[expression] {
        Expression::Literal(Literal::U32(word)) => words.push(*word),
        Expression::Literal(Literal::F32(number)) => words.push(number.to_bits()),
        Expression::Literal(Literal::Bool(flag)) => words.push(u32::from(*flag)),
        Expression::Compose { components, .. } => {
            for &component in components {
                evaluate(module, component, words);
            }
        }
        Expression::Constant(other) => evaluate(module, module.constants[*other].init, words),
        other => panic!("{other:?} is no constant"),
    }
}

#[test]
fn val_workgroup_memory_is_what_adapters_are_asked_for() {
    for shape in shapes::probed() {
        let module = module(&shape);
        let shared = module.global_variables.iter();
        let shared = shared.filter(|(_, variable)| variable.space == AddressSpace::WorkGroup);
        let bytes = shared.map(|(_, variable)| {
            let inner = &module.types[variable.ty].inner;
            inner.size(module.to_ctx()) as usize
        });
        assert_eq!(bytes.sum::<usize>(), shape.shared_bytes(), "{shape:?}");
        // The last of what a channel shows lies within: numbers of both halves, then a command that leaks.
        let leaks = usize::from(shape.leaks());
        assert_eq!(shape.published(), 2 * shape.shared() + leaks);
    }
}

#[test]
fn val_constants_are_those_of_rust() {
    for shape in shapes::probed() {
        let module = module(&shape);
        let flag = |flag: bool| vec![u32::from(flag)];
        let count = |count: usize| vec![count as u32];
        let number = |number: f64| vec![(number as f32).to_bits()];
        let numbers = |numbers: &[f64]| numbers.iter().map(|&k| (k as f32).to_bits()).collect();
        let mut expected: Vec<(&str, Vec<u32>)> = vec![
            ("PLANT", count(shape.plant as usize)),
            ("AXIS", count(PlantKind::Axis as usize)),
            ("TRANSLATION", count(PlantKind::Translation as usize)),
            ("ATTITUDE", count(PlantKind::Attitude as usize)),
            ("THRUST", count(PlantKind::Thrust as usize)),
            ("LEG", count(PlantKind::Leg as usize)),
            ("NC", count(shape.channels)),
            ("ROWS", count(shape.rows)),
            ("TEAM", count(shape.team)),
            ("LANES", count(shape.lanes)),
            ("WORKGROUP", count(shape.workgroup())),
            ("KINDS", count(shape.kinds())),
            ("SHARED", count(shape.shared())),
            ("HEIGHT", count(HEIGHT)),
            ("FIRST_ATTITUDE", count(FIRST_ATTITUDE)),
            ("COUPLED", flag(shape.coupling != Coupling::None)),
            ("CENTROID", flag(shape.coupling == Coupling::Centroid)),
            ("TEAM_SHARE", number(1.0 / shape.team as f64)),
            ("MEASURED_INTEGRAL", flag(shape.measured_integral)),
            ("RESTLESS", flag(shape.lists.restless)),
            ("REMEMBERS", flag(shape.lists.remembers)),
            ("CARRIES", flag(shape.lists.carries)),
            ("DISTORTS", flag(shape.lists.distorts)),
            ("PUBLISHED", count(shape.published())),
            ("FTC", flag(shape.ftc)),
            ("CUT", flag(shape.cut)),
            ("LIMITED", flag(shape.limited())),
            ("OBSERVER_MEASURED", flag(shape.observer_measured)),
            ("OBSERVER", count(OBSERVER)),
            ("EXTRA", count(FTC_STATES)),
            ("EXTRA_STATES", count(shape.extra_states())),
            ("FLUSH_STEPS", vec![FLUSH_STEPS]),
            ("JET_SPREAD", number(JET_SPREAD)),
            ("JET_PEAK", number(JET_PEAK)),
            ("FAR_AWAY", number(FAR_AWAY)),
            ("MAX", number(f64::from(f32::MAX))),
            ("NEVER", vec![layout::NEVER]),
            ("SHOWN", count(SHOWN_WORDS)),
            ("OUTCOME_WORDS", count(OUTCOME_WORDS)),
            ("ROUNDS", vec![philox::ROUNDS]),
            ("MULTIPLIERS", philox::MULTIPLIERS.to_vec()),
            ("WEYL", philox::WEYL.to_vec()),
            ("STREAM_NOISE", count(Stream::Noise as usize)),
            ("STREAM_INTERMITTENT", count(Stream::Intermittent as usize)),
            ("STREAM_TURBULENCE", count(Stream::Turbulence as usize)),
            ("MEMBERS_PER_AGENT", count(MEMBERS_PER_AGENT)),
            ("UNIT_SPACING", number(math::UNIT_SPACING)),
            ("QUARTER_TURN", vec![math::QUARTER_TURN]),
            ("SIGN_BIT", vec![math::SIGN_BIT]),
            ("MANTISSA_BITS", vec![math::MANTISSA_BITS]),
            ("SQRT_HALF_BITS", vec![math::SQRT_HALF_BITS]),
            ("FOLD_SCALE", number(f64::from(math::FOLD_SCALE))),
            ("MIN_POSITIVE", number(f64::from(f32::MIN_POSITIVE))),
            ("PI", number(std::f64::consts::PI)),
            ("FRAC_PI_2", number(std::f64::consts::FRAC_PI_2)),
            ("FRAC_1_PI", number(std::f64::consts::FRAC_1_PI)),
            ("LN_2", number(std::f64::consts::LN_2)),
            ("PI_HIGH", number(math::PI_HIGH)),
            ("PI_LOW", number(math::PI_LOW)),
            ("TANH_LIMIT", number(math::TANH_LIMIT)),
            ("SIN_FOLDED", numbers(&math::SIN_FOLDED)),
            ("SIN", numbers(&math::SIN)),
            ("COS", numbers(&math::COS)),
            ("ATAN", numbers(&math::ATAN)),
            ("LN", numbers(&math::LN)),
            ("TANH_NUMERATOR", numbers(&math::TANH_NUMERATOR)),
            ("TANH_DENOMINATOR", numbers(&math::TANH_DENOMINATOR)),
        ];
        let named = shape.words().named();
        expected.extend(
            named
                .iter()
                .map(|(name, word)| (name.as_str(), count(*word))),
        );
        let of_the_plant = shape.plant_constants.iter();
        expected.extend(of_the_plant.map(|(name, value)| (name.as_str(), vec![*value])));
        // An array must not be empty.
        let list = |mut words: Vec<u32>| {
            words.resize(words.len().max(1), 0);
            words
        };
        let lists = &shape.lists;
        let (entries, together): (Vec<u32>, Vec<bool>) = lists.bursts.iter().copied().unzip();
        let flags = |flags: &[bool]| list(flags.iter().map(|&flag| u32::from(flag)).collect());
        expected.extend([
            ("NOISE_ENTRIES", list(lists.noise_entries.clone())),
            ("TURBULENCE_ENTRIES", list(lists.turbulence_entries.clone())),
            ("BURST_ENTRIES", list(entries)),
            ("BURST_TOGETHER", flags(&together)),
            ("RING_RECORDS", flags(&lists.rings)),
        ]);
        for (name, words) in expected {
            assert_eq!(constant(&module, name), words, "{name} of {shape:?}");
        }
    }
}
