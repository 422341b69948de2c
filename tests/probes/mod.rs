//! Probes: every function of `shaders/` on its own against its Rust twin, on the same random inputs.
//!
//! | module | holds |
//! |---|---|
//! | `layout` | without a device: the joined text is valid; structs, bindings and constants are those of Rust |
//! | `twins` | without a device: which function is whose twin, and that each has a probe |
//! | `pure`, `loops`, `signals`, `groups` | the probes |
//! | `controls` | one change of the shaders at a time, and the probe that must notice |
//! | `harness`, `tracked`, `numbers`, `shapes` | running a probe, its tolerances, inputs and shapes |
//! | `leg` | the dynamics of a robot's leg |
//! | `world`, `image` | teams in random states, and how their state travels |
//!
//! They are in the library because they see its internals. Without an adapter the probes print SKIPPED, unless
//! URTS_REQUIRE_GPU=1 asks for one.
#![expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
#![expect(clippy::float_cmp, reason = "what is exact is compared so")]
#![expect(clippy::print_stdout, reason = "measured figures, shown on demand")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "small counts, bit patterns and roundings that are meant"
)]

mod controls;
mod groups;
mod harness;
mod image;
mod layout;
mod leg;
mod loops;
mod numbers;
mod pure;
mod shapes;
mod signals;
mod tracked;
mod twins;
mod world;

use crate::model::episode::PlantKind;
use harness::{Compared, Lab};
use world::World;

/// A probe of one or a few functions.
struct Probe {
    name: &'static str,
    /// The functions that it calls.
    functions: &'static [&'static str],
    run: fn(&Lab) -> Compared,
}

/// A probe over all shapes.
macro_rules! over_shapes {
    ($probe:path) => {
        |lab| {
            let mut all = Compared::default();
            for shape in shapes::probed() {
                all.add(match (shape.plant, shape.ftc) {
                    (PlantKind::Axis, true) => {
                        $probe(lab, &World::<_, 1, 10, 0>::new(shape, shapes::axis()))
                    }
                    (PlantKind::Axis, false) => {
                        $probe(lab, &World::<_, 1, 6, 0>::new(shape, shapes::axis()))
                    }
                    (PlantKind::Attitude, true) => {
                        $probe(lab, &World::<_, 3, 10, 0>::new(shape, shapes::attitude()))
                    }
                    (PlantKind::Attitude, false) => {
                        $probe(lab, &World::<_, 3, 6, 0>::new(shape, shapes::attitude()))
                    }
                    (PlantKind::Thrust, true) => {
                        $probe(lab, &World::<_, 6, 10, 4>::new(shape, shapes::thrust()))
                    }
                    (PlantKind::Thrust, false) => {
                        $probe(lab, &World::<_, 6, 6, 4>::new(shape, shapes::thrust()))
                    }
                    (PlantKind::Leg, true) => $probe(
                        lab,
                        &World::<_, 6, 10, 0>::new(shape, shapes::leg::<true>()),
                    ),
                    (PlantKind::Leg, false) => $probe(
                        lab,
                        &World::<_, 6, 6, 0>::new(shape, shapes::leg::<false>()),
                    ),
                });
                // A changed shader need not be flown on.
                if !all.wrong.is_empty() {
                    break;
                }
            }
            all
        }
    };
}

/// A row of [`PROBES`].
macro_rules! probe {
    ($name:literal, [$($function:literal),+], $run:expr) => {
        Probe { name: $name, functions: &[$($function),+], run: $run }
    };
}

/// The rotation, of both plants that have one.
fn rotation(lab: &Lab) -> Compared {
    let [_, _, _, attitude, _, thrust, ..] = shapes::probed();
    let plant = shapes::attitude();
    let mut all = loops::rotation(lab, &World::<_, 3, 10, 0>::new(attitude, plant), plant);
    let world = World::<_, 6, 10, 4>::new(thrust, shapes::thrust());
    all.add(loops::rotation(lab, &world, shapes::thrust().attitude));
    all
}

/// What a joint reads and hears of the others.
fn leg_rows(lab: &Lab) -> Compared {
    let [.., leg] = shapes::probed();
    leg::matrix_rows(lab, &World::<_, 6, 10, 0>::new(leg, shapes::leg::<true>()))
}

/// The forward dynamics of a leg.
fn leg_dynamics(lab: &Lab) -> Compared {
    let [.., leg, _] = shapes::probed();
    leg::dynamics(lab, &World::<_, 6, 6, 0>::new(leg, shapes::leg::<false>()))
}

/// Pairs of noise, of a shape that has any.
fn pairs(lab: &Lab) -> Compared {
    let [shape, ..] = shapes::probed();
    signals::pairs(lab, &World::<_, 1, 10, 0>::new(shape, shapes::axis()))
}

/// Functions of their arguments alone.
const PURE: &[Probe] = &[
    probe!("lane_max", ["lane_max"], pure::lane_max),
    probe!("lane_min", ["lane_min"], pure::lane_min),
    probe!("lane_select_le", ["lane_select_le"], pure::lane_select_le),
    probe!("lane_within", ["lane_within"], pure::lane_within),
    probe!("lane_turns_sin", ["lane_turns_sin"], pure::lane_turns_sin),
    probe!(
        "lane_unit_from_words",
        ["lane_unit_from_words"],
        pure::lane_unit_from_words
    ),
    probe!("lane_ln", ["lane_ln"], pure::lane_ln),
    probe!(
        "polynomials",
        [
            "polynomial_4",
            "polynomial_5",
            "polynomial_7",
            "polynomial_9"
        ],
        pure::polynomials
    ),
    probe!("sin_folded", ["sin_folded"], pure::sin_folded),
    probe!("sin_cos", ["sin_cos"], pure::sin_cos),
    probe!("tanh", ["tanh"], pure::tanh),
    probe!("atan2", ["atan2"], pure::atan2),
    probe!("ln_split", ["ln_split"], pure::ln_split),
    probe!("wide_product", ["wide_product"], pure::wide_products),
    probe!("philox4x32", ["philox4x32"], pure::philox),
    probe!("address_words", ["address_words"], pure::address_words),
    probe!("body_axis", ["body_axis"], pure::body_axes),
    probe!("clamp", ["clamp"], pure::clamps),
];

/// What a stage of a step is made of.
const LOOPS: &[Probe] = &[
    probe!(
        "stepped",
        ["stepped_at", "stepped_take"],
        over_shapes!(loops::stepped)
    ),
    probe!(
        "gains",
        [
            "injection",
            "feedback_gains",
            "smoothing",
            "sensor_fault_input",
            "is_attitude",
            "channel_gains_measured"
        ],
        over_shapes!(loops::gains)
    ),
    probe!(
        "controller",
        ["feedback", "fault_estimates", "injected"],
        over_shapes!(loops::controller)
    ),
    probe!(
        "step_channel",
        ["step_channel"],
        over_shapes!(loops::step_channels)
    ),
    probe!(
        "reference",
        ["reference", "reference_at"],
        over_shapes!(loops::references)
    ),
    probe!(
        "plant",
        [
            "publish_channel",
            "respond",
            "axis_respond",
            "attitude_respond",
            "thrust_respond",
            "leg_accelerate"
        ],
        over_shapes!(loops::plant)
    ),
    probe!(
        "matrix_row",
        ["matrix_row", "plus_product", "leg_seen"],
        leg_rows
    ),
    probe!(
        "forward_dynamics",
        [
            "forward_dynamics",
            "turn",
            "damped",
            "first_motion",
            "first_moment",
            "second_motion",
            "next_motion",
            "at_lever",
            "wrench",
            "turned",
            "turned_back",
            "twisted",
            "untwisted",
            "carried",
            "joined",
            "levered",
            "tip",
            "composite",
            "turned_second",
            "twisted_second",
            "momentum"
        ],
        leg_dynamics
    ),
    probe!("attitude_acceleration", ["attitude_acceleration"], rotation),
];

/// What acts on a channel, and what is kept of it.
const SIGNALS: &[Probe] = &[
    probe!(
        "switches",
        ["switch_at", "next_onset"],
        over_shapes!(signals::switched)
    ),
    probe!(
        "signals_begin",
        ["signals_begin"],
        over_shapes!(signals::begun)
    ),
    probe!(
        "signals_hold",
        ["signals_hold"],
        over_shapes!(signals::held)
    ),
    probe!(
        "signals_evaluate",
        ["signals_evaluate"],
        over_shapes!(signals::evaluated)
    ),
    probe!("noise_draw", ["noise_draw"], over_shapes!(signals::noise)),
    probe!("noise_pair", ["noise_pair"], pairs),
    probe!(
        "metrics_take",
        ["metrics_take"],
        over_shapes!(signals::metrics)
    ),
    probe!(
        "metrics_flush",
        ["metrics_flush"],
        over_shapes!(signals::flushed)
    ),
    probe!(
        "add_to_total",
        ["add_to_total"],
        over_shapes!(signals::added)
    ),
    probe!(
        "metrics_before_fault",
        ["metrics_before_fault"],
        over_shapes!(signals::before_fault)
    ),
];

/// Agents and teams, and the buffers that they live in.
const GROUPS: &[Probe] = &[
    probe!(
        "slot",
        ["slot", "seen", "publish"],
        over_shapes!(groups::slots)
    ),
    probe!("team_sum", ["team_sum"], over_shapes!(groups::team_sum)),
    probe!(
        "agent_respond",
        ["agent_respond"],
        over_shapes!(groups::responses)
    ),
    probe!(
        "agent_observe",
        ["agent_observe"],
        over_shapes!(groups::observed)
    ),
    probe!("group_hold", ["group_hold"], over_shapes!(groups::held)),
    probe!(
        "group_begin_step",
        ["group_begin_step"],
        over_shapes!(groups::begun)
    ),
    probe!("group_stage", ["group_stage"], over_shapes!(groups::stages)),
    probe!(
        "group_advance",
        ["group_advance"],
        over_shapes!(groups::advanced)
    ),
    probe!("group_show", ["group_show"], over_shapes!(groups::shown)),
    probe!(
        "identify",
        [
            "identify",
            "drawn",
            "drawn_number",
            "stored",
            "stored_number",
            "store",
            "store_number"
        ],
        over_shapes!(groups::identified)
    ),
    probe!(
        "channel_plant",
        ["channel_plant"],
        over_shapes!(groups::constants)
    ),
    probe!("resume", ["resume"], over_shapes!(groups::resumed)),
    probe!("keep", ["keep"], over_shapes!(groups::kept)),
];

/// All probes.
fn probes() -> impl Iterator<Item = &'static Probe> {
    [PURE, LOOPS, SIGNALS, GROUPS].into_iter().flatten()
}

/// Runs probes, which must agree with the twins.
fn agree(probes: &[Probe]) {
    let Some(lab) = Lab::open() else { return };
    for Probe { name, run, .. } in probes {
        let compared = run(&lab);
        println!(
            "{name:22} {:6} words, {:6} of them rounded: off by at most {:.1e}, {:.2} of the bound; {} loose bounds",
            compared.words, compared.rounded, compared.difference, compared.share, compared.loose
        );
        assert!(
            compared.wrong.is_empty(),
            "{name}: {} of {} results differ, first\n{}",
            compared.wrong.len(),
            compared.words,
            compared.wrong[..compared.wrong.len().min(5)].join("\n")
        );
        assert!(compared.words >= 500, "{name} compares hundreds");
        assert!(20 * compared.loose <= compared.rounded, "{name} is blind");
    }
}

#[test]
fn regress_functions_of_their_arguments_agree_with_their_twins() {
    agree(PURE);
}

#[test]
fn regress_parts_of_a_stage_agree_with_their_twins() {
    agree(LOOPS);
}

#[test]
fn regress_signals_and_metrics_agree_with_their_twins() {
    agree(SIGNALS);
}

#[test]
fn regress_agents_and_teams_agree_with_their_twins() {
    agree(GROUPS);
}
