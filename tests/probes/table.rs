//! The probes: their names and the functions that they call. `twins` sees to it that none is missing.

use super::harness::{Compared, Lab};
use super::world::World;
use super::{buffers, exogenous, friction, leg, loops, pure, shapes, team, vortex, windows};
use crate::model::plant::kinds::PlantKind;

/// A probe of one or a few functions.
pub(super) struct Probe {
    pub(super) name: &'static str,
    /// The functions that it calls.
    pub(super) functions: &'static [&'static str],
    pub(super) run: fn(&Lab) -> Compared,
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
                    (PlantKind::Translation, _) => $probe(
                        lab,
                        &World::<_, 3, 10, 0>::new(shape, shapes::translation()),
                    ),
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
                // A changed shader is simulated no further.
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

/// Pairs of normal numbers.
fn pairs(lab: &Lab) -> Compared {
    let [shape, ..] = shapes::probed();
    windows::pairs(lab, &World::<_, 1, 10, 0>::new(shape, shapes::axis()))
}

/// Functions of their arguments alone.
pub(super) const PURE: &[Probe] = &[
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
    probe!(
        "wide_product_int64",
        ["wide_product"],
        pure::wide_products_int64
    ),
    probe!("philox4x32", ["philox4x32"], pure::philox),
    probe!("address_words", ["address_words"], pure::address_words),
    probe!("body_axis", ["body_axis"], pure::body_axes),
    probe!("clamp", ["clamp"], pure::clamps),
    probe!(
        "jets",
        ["jet_profile", "jet_growth", "jet_share"],
        vortex::jets
    ),
];

/// What a stage of a step is made of.
pub(super) const LOOPS: &[Probe] = &[
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
            "leg_left",
            "leg_turns",
            "leg_publish"
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
            "leg_bias",
            "leg_weight",
            "leg_factors",
            "leg_solve",
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

/// When faults are there, what is remembered, and what is random in every step.
pub(super) const MEMORY: &[Probe] = &[
    probe!(
        "switches",
        ["window_weight", "window_value", "window_at", "next_change"],
        over_shapes!(windows::switched)
    ),
    probe!(
        "bursts",
        ["intermittent_window_at", "own_member"],
        over_shapes!(windows::burst)
    ),
    probe!(
        "actuator_command",
        ["actuator_command", "beyond_dead_zone"],
        over_shapes!(windows::actuators)
    ),
    probe!(
        "delay_line_hold",
        ["delay_line_hold"],
        over_shapes!(windows::rings_held)
    ),
    probe!(
        "delay_line_recall",
        ["delay_line_recall", "delay_line_or_past"],
        over_shapes!(windows::rings_played)
    ),
    probe!(
        "delay_line_record",
        ["delay_line_record"],
        over_shapes!(windows::rings_recorded)
    ),
    probe!(
        "delay_line_read",
        ["delay_line_read", "delay_line_place"],
        over_shapes!(windows::rings_read)
    ),
    probe!("normal_pair", ["normal_pair"], pairs),
    probe!("noise_draw", ["noise_draw"], over_shapes!(windows::noise)),
    probe!(
        "turbulence",
        [
            "turbulence_filter",
            "turbulence_force",
            "turbulence_advance"
        ],
        over_shapes!(windows::turbulence)
    ),
];

/// What acts on a channel, and what is kept of it.
pub(super) const SIGNALS: &[Probe] = &[
    probe!(
        "exogenous_inputs_begin",
        ["exogenous_inputs_begin", "exogenous_inputs_ticks"],
        over_shapes!(exogenous::begun)
    ),
    probe!(
        "exogenous_inputs_hold",
        ["exogenous_inputs_hold"],
        over_shapes!(exogenous::held)
    ),
    probe!(
        "held_apart",
        ["hold_command", "hold_sensor"],
        over_shapes!(exogenous::held_apart)
    ),
    probe!(
        "exogenous_inputs_evaluate",
        ["exogenous_inputs_evaluate", "evaluate_command"],
        over_shapes!(exogenous::evaluated)
    ),
    probe!(
        "oscillation_turned",
        ["oscillation_turned"],
        over_shapes!(exogenous::turns)
    ),
    probe!(
        "commands",
        ["carry_command", "limit_rate"],
        over_shapes!(exogenous::commands)
    ),
    probe!("measure", ["measure"], over_shapes!(exogenous::measured)),
    probe!(
        "exogenous_inputs_remember",
        ["exogenous_inputs_remember", "remember_command"],
        over_shapes!(exogenous::remembered)
    ),
    probe!(
        "metrics_take",
        ["metrics_take"],
        over_shapes!(exogenous::metrics)
    ),
    probe!(
        "metrics_flush",
        ["metrics_flush"],
        over_shapes!(exogenous::flushed)
    ),
    probe!(
        "add_to_total",
        ["add_to_total"],
        over_shapes!(exogenous::added)
    ),
    probe!(
        "metrics_before_fault",
        ["metrics_before_fault"],
        over_shapes!(exogenous::before_fault)
    ),
];

/// Agents and teams, and the buffers that they live in.
pub(super) const GROUPS: &[Probe] = &[
    probe!(
        "slot",
        [
            "slot",
            "slot_get",
            "slot_set",
            "seen",
            "publish",
            "command_slot"
        ],
        over_shapes!(team::slots)
    ),
    probe!("team_sum", ["team_sum"], over_shapes!(team::team_sum)),
    probe!(
        "friction_force",
        ["friction_force", "friction_drawn"],
        over_shapes!(friction::forces)
    ),
    probe!(
        "vortex_force",
        ["vortex_force", "vortex_drawn", "agent_place"],
        over_shapes!(vortex::forces)
    ),
    probe!(
        "agent_respond",
        ["agent_respond"],
        over_shapes!(team::responses)
    ),
    probe!(
        "team_commands",
        ["team_commands", "finite"],
        over_shapes!(team::team_commands)
    ),
    probe!(
        "agent_seen",
        ["agent_motion", "agent_distortion", "agent_feedback"],
        over_shapes!(team::seen)
    ),
    probe!(
        "agent_remember",
        ["agent_remember"],
        over_shapes!(team::remembered)
    ),
    probe!(
        "team_state_end_step",
        ["team_state_end_step"],
        over_shapes!(team::ended)
    ),
    probe!(
        "agent_observe",
        ["agent_observe"],
        over_shapes!(team::observed)
    ),
    probe!(
        "team_state_hold",
        ["team_state_hold"],
        over_shapes!(team::held)
    ),
    probe!(
        "team_state_begin_step",
        ["team_state_begin_step"],
        over_shapes!(team::begun)
    ),
    probe!(
        "team_state_stage",
        ["team_state_stage"],
        over_shapes!(team::stages)
    ),
    probe!(
        "team_state_advance",
        ["team_state_advance"],
        over_shapes!(team::advanced)
    ),
    probe!(
        "team_state_show",
        ["team_state_show"],
        over_shapes!(team::shown)
    ),
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
        over_shapes!(buffers::identified)
    ),
    probe!(
        "channel_plant",
        ["channel_plant"],
        over_shapes!(buffers::constants)
    ),
    probe!(
        "resume",
        ["resume", "metrics_resume"],
        over_shapes!(buffers::resumed)
    ),
    probe!(
        "keep",
        ["keep", "metrics_keep"],
        over_shapes!(buffers::kept)
    ),
];

/// All probes.
pub(super) fn probes() -> impl Iterator<Item = &'static Probe> {
    [PURE, LOOPS, MEMORY, SIGNALS, GROUPS].into_iter().flatten()
}
