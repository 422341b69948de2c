//! Which function is whose twin. Without a device: every function of the shaders has a probe, and every function of the
//! model files that they mirror has a twin or a reason to have none.

use super::table::probes;
use super::{layout, shapes};
use crate::backend::gpu::pipeline::ENTRIES;
use std::collections::BTreeSet;

/// Names of twins, `(in Rust, in WGSL)`.
type Pairs = &'static [(&'static str, &'static str)];

/// The Rust files, their text, and the functions of the shaders' file that come from them.
const TWINS: &[(&str, &str, Pairs)] = &[
    (
        "lanes",
        include_str!("../../src/model/lanes/scalar.rs"),
        &[
            ("max", "lane_max"),
            ("min", "lane_min"),
            ("select_le", "lane_select_le"),
            ("turns_sin", "lane_turns_sin"),
            ("unit_from_words", "lane_unit_from_words"),
            ("ln", "lane_ln"),
        ],
    ),
    (
        "math",
        include_str!("../../src/model/lanes/math.rs"),
        &[
            ("polynomial", "polynomial_4"),
            ("polynomial", "polynomial_5"),
            ("polynomial", "polynomial_7"),
            ("polynomial", "polynomial_9"),
            ("sin_folded", "sin_folded"),
            ("sin_cos", "sin_cos"),
            ("tanh", "tanh"),
            ("atan2", "atan2"),
            ("ln_split", "ln_split"),
            ("clamp", "clamp"),
        ],
    ),
    (
        "philox",
        include_str!("../../src/random/philox.rs"),
        &[
            ("wide_product", "wide_product"),
            ("philox4x32", "philox4x32"),
            ("words", "address_words"),
        ],
    ),
    (
        "integrator",
        include_str!("../../src/model/integrator.rs"),
        &[("at", "stepped_at"), ("take", "stepped_take")],
    ),
    (
        "observer_feedback",
        include_str!("../../src/model/controller/observer_feedback.rs"),
        &[
            ("measured", "channel_gains_measured"),
            ("feedback", "feedback"),
            ("step", "step_channel"),
            ("injected", "injected"),
            ("fault_estimates", "fault_estimates"),
        ],
    ),
    (
        "plant",
        include_str!("../../src/model/plant/mod.rs"),
        &[("reference", "reference"), ("respond", "respond")],
    ),
    (
        "plant_uav",
        include_str!("../../src/model/plant/uav.rs"),
        &[
            ("reference", "reference"),
            ("answer", "axis_respond"),
            ("respond", "attitude_respond"),
            ("respond", "thrust_respond"),
            ("acceleration", "attitude_acceleration"),
            ("body_axis", "body_axis"),
        ],
    ),
    (
        "plant_biped",
        include_str!("../../src/model/plant/biped.rs"),
        &[
            ("reference", "reference"),
            ("respond", "respond"),
            ("matrix_row", "matrix_row"),
            ("plus_product", "plus_product"),
        ],
    ),
    (
        "leg",
        include_str!("../../src/model/plant/leg/dynamics.rs"),
        &[
            ("bias", "leg_bias"),
            ("weight", "leg_weight"),
            ("factors", "leg_factors"),
            ("solve", "leg_solve"),
        ],
    ),
    (
        "link",
        include_str!("../../src/model/plant/leg/link.rs"),
        &[
            ("turn", "turn"),
            ("damped", "damped"),
            ("first_motion", "first_motion"),
            ("first_moment", "first_moment"),
            ("second_motion", "second_motion"),
            ("next_motion", "next_motion"),
            ("at_lever", "at_lever"),
            ("wrench", "wrench"),
            ("turned", "turned"),
            ("turned_back", "turned_back"),
            ("twisted", "twisted"),
            ("untwisted", "untwisted"),
            ("carried", "carried"),
            ("joined", "joined"),
            ("levered", "levered"),
            ("tip", "tip"),
            ("composite", "composite"),
            ("turned_second", "turned_second"),
            ("twisted_second", "twisted_second"),
            ("momentum", "momentum"),
        ],
    ),
    (
        "window",
        include_str!("../../src/model/exogenous/window.rs"),
        &[
            ("weight", "window_weight"),
            ("at", "window_at"),
            ("at", "intermittent_window_at"),
        ],
    ),
    (
        "delay_line",
        include_str!("../../src/model/exogenous/delay_line.rs"),
        &[
            ("hold", "delay_line_hold"),
            ("recall", "delay_line_recall"),
            ("or_past", "delay_line_or_past"),
            ("record", "delay_line_record"),
            ("read", "delay_line_read"),
            ("place", "delay_line_place"),
        ],
    ),
    (
        "noise",
        include_str!("../../src/model/exogenous/noise.rs"),
        &[
            ("normal_pair", "normal_pair"),
            ("draw", "noise_draw"),
            ("force", "turbulence_force"),
            ("advance", "turbulence_advance"),
        ],
    ),
    (
        "exogenous",
        include_str!("../../src/model/exogenous/evaluation.rs"),
        &[
            ("hold", "exogenous_inputs_hold"),
            ("hold_sensor", "hold_sensor"),
            ("evaluate", "exogenous_inputs_evaluate"),
            ("measure", "measure"),
            ("remember", "exogenous_inputs_remember"),
        ],
    ),
    (
        "exogenous inputs",
        include_str!("../../src/model/exogenous/inputs.rs"),
        &[("ticks", "exogenous_inputs_ticks")],
    ),
    (
        "actuator",
        include_str!("../../src/model/exogenous/actuator.rs"),
        &[
            ("command", "actuator_command"),
            ("beyond_dead_zone", "beyond_dead_zone"),
        ],
    ),
    (
        "lists",
        include_str!("../../src/model/exogenous/lists.rs"),
        &[("turned", "oscillation_turned")],
    ),
    (
        "command_path",
        include_str!("../../src/model/exogenous/command_path.rs"),
        &[
            ("hold_command", "hold_command"),
            ("evaluate_command", "evaluate_command"),
            ("carry_command", "carry_command"),
            ("limit_rate", "limit_rate"),
            ("remember_command", "remember_command"),
        ],
    ),
    (
        "metric",
        include_str!("../../src/model/metric.rs"),
        &[
            ("take", "metrics_take"),
            ("flush", "metrics_flush"),
            ("before_fault", "metrics_before_fault"),
        ],
    ),
    (
        "friction",
        include_str!("../../src/model/exogenous/friction.rs"),
        &[("friction_force", "friction_force")],
    ),
    (
        "vortex",
        include_str!("../../src/model/exogenous/vortex.rs"),
        &[
            ("jet_profile", "jet_profile"),
            ("jet_growth", "jet_growth"),
            ("jet_share", "jet_share"),
            ("vortex_force", "vortex_force"),
        ],
    ),
    (
        "agent",
        include_str!("../../src/model/agent.rs"),
        &[
            ("motion", "agent_motion"),
            ("feedback", "agent_feedback"),
            ("respond", "agent_respond"),
            ("distortion", "agent_distortion"),
            ("remember", "agent_remember"),
            ("observe", "agent_observe"),
        ],
    ),
    (
        "team",
        include_str!("../../src/model/team.rs"),
        &[
            ("team_commands", "team_commands"),
            ("finite", "finite"),
            ("end_step", "team_state_end_step"),
            ("begin_step", "team_state_begin_step"),
            ("hold", "team_state_hold"),
            ("team_sum", "team_sum"),
            ("stage", "team_state_stage"),
            ("advance", "team_state_advance"),
            ("show", "team_state_show"),
            ("flush", "metrics_flush"),
        ],
    ),
];

/// Functions of these Rust files without a twin, and why.
const IN_RUST_ALONE: &[(&[&str], &str)] = &[
    (
        &[
            "new",
            "none",
            "zero",
            "kept",
            "key",
            "from_fn",
            "map",
            "numbers",
            "of_numbers",
        ],
        "made or read by the host",
    ),
    (
        &[
            "mul_add", "abs", "sqrt", "floor", "from_f64", "to_f64", "splat",
        ],
        "built into WGSL",
    ),
    (
        &[
            "load",
            "store",
            "dispatch",
            "run",
            "turns",
            "turns_from_words",
            "of_lane",
        ],
        "lanes alone",
    ),
    (
        &["window", "item", "items", "counts", "waves_mut"],
        "lists are constants in the shaders",
    ),
    (&["turns_add"], "the addition of u32"),
    (
        &["sin_cos", "tanh", "atan2"],
        "in lanes/scalar.rs, those of math.rs",
    ),
    (
        &[
            "fixed_turns",
            "fixed_turns_32",
            "unit",
            "inertia",
            "non_inertial",
        ],
        "draws and tables are the host's",
    ),
    (
        &["tabulated", "splat_row"],
        "a row of the table is one value",
    ),
    (
        &["start", "error_estimate"],
        "the loop asks a family of controllers; the shaders have one",
    ),
    (
        &["outcomes", "is_finite", "step_number", "finite_step"],
        "the start's and the host's",
    ),
    (
        &["always", "sound", "onset_step", "words_of"],
        "how draws become words and constants",
    ),
    (&["signals"], "an invocation has the signals of one agent"),
    (
        &["carries", "distorts", "remembers", "is_restless", "of"],
        "constants of the shader",
    ),
    (
        &["forward_dynamics", "accelerations", "leg_rows"],
        "the host's choice of the shader's constants, and its order of the parts that two joints share",
    ),
    (
        &["scaled", "less", "remainder", "plus"],
        "operators of vectors",
    ),
    (&["evaluate"], "an invocation has one agent"),
    (&["place_agents"], "every channel publishes its own x"),
];

/// Functions of the shaders without a twin in these files: the probe says what they must do.
const IN_WGSL_ALONE: &[(&[&str], &str)] = &[
    (
        &["lane_within"],
        "select_le of an absolute value, by its bits",
    ),
    (
        &[
            "injection",
            "feedback_gains",
            "smoothing",
            "sensor_fault_input",
            "is_attitude",
        ],
        "fields of ChannelGains",
    ),
    (&["next_change"], "the model's list of changes"),
    (
        &[
            "window_value",
            "turbulence_filter",
            "friction_drawn",
            "vortex_drawn",
        ],
        "fields",
    ),
    (&["own_member"], "the address that the host gives a channel"),
    (
        &["exogenous_inputs_begin"],
        "as many turns_add as half steps",
    ),
    (&["add_to_total"], "a line of flush"),
    (
        &[
            "slot",
            "slot_get",
            "slot_set",
            "command_slot",
            "seen",
            "publish",
            "agent_place",
            "reference_at",
        ],
        "indexing",
    ),
    (
        &["channel_plant", "publish_channel", "leg_seen"],
        "an invocation has one channel",
    ),
    (
        &[
            "drawn",
            "drawn_number",
            "stored",
            "stored_number",
            "store",
            "store_number",
        ],
        "indexing of buffers",
    ),
    (
        &["leg_left", "leg_turns", "leg_publish"],
        "what the joints of a leg pass to each other",
    ),
    (
        &[
            "identify",
            "resume",
            "keep",
            "metrics_resume",
            "metrics_keep",
        ],
        "the state between spans",
    ),
];

fn flat(listed: &[(&[&'static str], &str)]) -> BTreeSet<&'static str> {
    listed
        .iter()
        .flat_map(|(names, _)| names.iter().copied())
        .collect()
}

/// Names of the functions that a Rust file defines ahead of its tests.
fn defined(text: &str) -> BTreeSet<&str> {
    let text = text.split("#[cfg(test)]\nmod ").next().unwrap();
    let words = text
        .lines()
        .filter_map(|line| line.trim().split_once("fn "));
    words
        .filter(|(before, _)| {
            ["", "pub", "pub(crate)", "pub(super)", "pub(crate) const"].contains(&before.trim())
        })
        .filter_map(|(_, after)| after.split(['(', '<']).next())
        .collect()
}

#[test]
fn val_every_rust_function_has_a_twin_or_a_reason() {
    let alone = flat(IN_RUST_ALONE);
    let everywhere: BTreeSet<&str> = TWINS
        .iter()
        .flat_map(|(_, text, _)| defined(text))
        .collect();
    for name in &alone {
        assert!(everywhere.contains(name), "no file has a function {name}");
    }
    for (file, text, twins) in TWINS {
        let defined = defined(text);
        assert!(!defined.is_empty(), "{file}");
        let listed: BTreeSet<&str> = twins.iter().map(|&(rust, _)| rust).collect();
        for name in &listed {
            assert!(defined.contains(name), "{file}.rs has no function {name}");
        }
        for name in defined.difference(&listed) {
            assert!(
                alone.contains(name),
                "{file}.rs: {name} has neither a twin nor a reason"
            );
        }
    }
}

#[test]
fn val_every_shader_function_has_a_twin_and_a_probe() {
    let twins = TWINS
        .iter()
        .flat_map(|(_, _, twins)| twins.iter().map(|&(_, wgsl)| wgsl));
    let known: BTreeSet<&str> = twins.chain(flat(IN_WGSL_ALONE)).collect();
    let probed: BTreeSet<&str> = probes()
        .flat_map(|probe| probe.functions.iter().copied())
        .collect();
    let modules = shapes::probed().map(|shape| layout::module(&shape));
    let functions = modules.iter().flat_map(|module| {
        let functions = module.functions.iter();
        functions.map(|(_, function)| function.name.as_deref().unwrap())
    });
    let functions: BTreeSet<&str> = functions.collect();
    assert_eq!(functions, known, "shaders (left) and the tables of twins");
    // Entry points cannot be called; whole episodes run them.
    assert_eq!(functions, probed, "shaders (left) and the table of probes");
    assert!(ENTRIES.iter().all(|entry| !functions.contains(entry)));
}
