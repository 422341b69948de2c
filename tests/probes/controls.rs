//! Negative controls: a probe that cannot fail shows nothing. One change of the shaders at a time, and the probe that
//! must notice it.

use super::changes::OF_SIGNALS;
use super::harness::Lab;
use super::shapes;
use super::table::probes;
use std::collections::BTreeSet;

/// A change and who must notice.
pub(super) struct Control {
    /// The file of the old text; constants are generated.
    file: &'static str,
    old: &'static str,
    new: &'static str,
    probe: &'static str,
}

pub(super) const fn control(
    file: &'static str,
    old: &'static str,
    new: &'static str,
    probe: &'static str,
) -> Control {
    Control {
        file,
        old,
        new,
        probe,
    }
}

const CONTROLS: &[Control] = &[
    control(
        "constants",
        "array(1.5707964f, -0.6459638f",
        "array(1.5707964f, -0.6459618f",
        "sin_folded",
    ),
    control(
        "constants",
        "const ROUNDS = 0xau;",
        "const ROUNDS = 0x9u;",
        "philox4x32",
    ),
    control(
        "constants",
        "const FAR_AWAY = 1000000000000000.0f;",
        "const FAR_AWAY = 1001000000000000.0f;",
        "team_sum",
    ),
    control(
        "constants",
        "const PI_LOW = -8.742278e-8f;",
        "const PI_LOW = 8.742278e-6f;",
        "sin_cos",
    ),
    control(
        "lanes",
        "select(other, value, value > other)",
        "select(value, other, value < other)",
        "lane_max",
    ),
    control(
        "lanes",
        "(phase + QUARTER_TURN) & SIGN_BIT",
        "phase & SIGN_BIT",
        "lane_turns_sin",
    ),
    control(
        "lanes",
        ") <= bitcast<u32>(limit)",
        ") < bitcast<u32>(limit)",
        "lane_within",
    ),
    control(
        "math",
        "let parity = fma(n, half, -floor(n * half));",
        "let parity = fma(n, half, -floor(n * half + 0.5));",
        "sin_cos",
    ),
    control(
        "math",
        "fma(f2, -0.5, tail)",
        "fma(f2, -0.50001, tail)",
        "ln_split",
    ),
    control(
        "math",
        "lane_select_le(0.0, x, angle, PI - angle)",
        "lane_select_le(0.0, x, angle, PI + angle)",
        "atan2",
    ),
    control(
        "philox",
        "product0.x ^ x.w ^ k.y",
        "product0.x ^ x.w ^ k.x",
        "philox4x32",
    ),
    control(
        "wide_product",
        "(second >> 16u)",
        "(second >> 17u)",
        "wide_product",
    ),
    control(
        "wide_product_int64",
        "u32(product >> 32u)",
        "u32(product >> 31u)",
        "wide_product_int64",
    ),
    control(
        "integrator",
        "stepped_sum[k] = fma(slope, h.third, stepped_sum[k]);",
        "stepped_sum[k] = fma(slope, h.sixth, stepped_sum[k]);",
        "stepped",
    ),
    control(
        "integrator",
        "select(h.whole, h.half, stage < 2u)",
        "select(h.whole, h.half, stage < 3u)",
        "stepped",
    ),
    control(
        "observer_feedback",
        "injected(4u, innovation, (f1 - f1_before) * s.z)",
        "injected(4u, innovation, (f1_before - f1) * s.z)",
        "step_channel",
    ),
    control(
        "observer_feedback",
        "fma(unexplained, b.y, seen_rate - rate_hat)",
        "fma(unexplained, b.x, seen_rate - rate_hat)",
        "step_channel",
    ),
    control(
        "observer_feedback",
        "uniforms.gains[KINDS - 1u].smoothing, is_attitude()",
        "uniforms.gains[0].smoothing, is_attitude()",
        "gains",
    ),
    control(
        "math",
        "lane_min(lane_max(value, low), high)",
        "lane_max(lane_min(value, high), low)",
        "clamp",
    ),
    control(
        "plant_uav",
        "-(cos_yaw * roll_sin_cos.x)",
        "cos_yaw * roll_sin_cos.x",
        "body_axis",
    ),
    control(
        "plant_uav",
        "first + (i + 2u) % 3u",
        "first + (i + 1u) % 3u",
        "attitude_acceleration",
    ),
    control(
        "plant_uav",
        "clamp(thrust_demanded, 0.0, uniforms.plant.max_thrust)",
        "clamp(thrust_demanded, 0.0, uniforms.plant.max_thrust * 0.999)",
        "plant",
    ),
    control(
        "plant_uav",
        "fma(limited - non_inertial, own.plant.inverse_inertia",
        "fma(limited + non_inertial, own.plant.inverse_inertia",
        "plant",
    ),
    control("plant_biped", "row[5], sum)", "row[4], sum)", "matrix_row"),
    control("plant_biped", "limited, CUT)", "limited, true)", "plant"),
    control(
        "plant_biped",
        "table[at.place + 2u].z",
        "table[at.place + 2u].w",
        "plant",
    ),
    control(
        "plant_biped",
        "inputs.feedback - plus_product",
        "inputs.feedback + plus_product",
        "plant",
    ),
    control(
        "plant_biped",
        "leg_turns(stage), leg_seen(stage, VELOCITY)",
        "leg_turns(stage), leg_seen(stage, POSITION)",
        "plant",
    ),
    control(
        "leg",
        "fma(rate, -damping, torque)",
        "fma(rate, damping, torque)",
        "forward_dynamics",
    ),
    control(
        "leg",
        "vec3(t.cosine * across, -(t.sine * across), along)",
        "vec3(t.cosine * across, t.sine * across, along)",
        "forward_dynamics",
    ),
    control(
        "leg",
        "-(joint.moments.y * motion.origin.x)",
        "joint.moments.y * motion.origin.x",
        "forward_dynamics",
    ),
    control(
        "leg",
        "let dx = w.y * w.z;",
        "let dx = -w.y * w.z;",
        "forward_dynamics",
    ),
    control(
        "leg",
        "d.y = fma(w.x, -rate, d.y);",
        "d.y = fma(w.x, rate, d.y);",
        "forward_dynamics",
    ),
    control(
        "leg",
        "a = fma(vec3(before.spin_x.z, before.spin_y.z, before.spin_z.z), vec3(joint.lever.z), a);",
        "",
        "forward_dynamics",
    ),
    control(
        "leg",
        "y = fma(uz.y, -xy, y);",
        "y = fma(uz.y, xy, y);",
        "forward_dynamics",
    ),
    control(
        "leg",
        "fma(t.sine, v.x, t.cosine * v.y), v.z",
        "fma(t.sine, v.x, -(t.cosine * v.y)), v.z",
        "forward_dynamics",
    ),
    control(
        "leg",
        "fma(t.cosine, v.y, -(t.sine * v.x)), v.z",
        "fma(t.cosine, v.y, t.sine * v.x), v.z",
        "forward_dynamics",
    ),
    control(
        "leg",
        "return vec3(v.x, -v.z, v.y);",
        "return vec3(v.x, v.z, v.y);",
        "forward_dynamics",
    ),
    control(
        "leg",
        "return vec3(v.x, v.z, -v.y);",
        "return vec3(v.x, v.z, v.y);",
        "forward_dynamics",
    ),
    control(
        "leg",
        "beyond.force + own.force",
        "beyond.force",
        "forward_dynamics",
    ),
    control(
        "leg",
        "m.y = fma(joint.lever.x, -f.z, m.y);",
        "m.y = fma(joint.lever.x, f.z, m.y);",
        "forward_dynamics",
    ),
    control(
        "leg",
        "Second(vec3(joint.moments.zw, 0.0), joint.products.xyz)",
        "Second(vec3(joint.moments.wz, 0.0), joint.products.xyz)",
        "forward_dynamics",
    ),
    control(
        "leg",
        "square.x = fma(h.x, joint.lever_twice.x, square.x);",
        "square.x = fma(h.x, joint.lever.x, square.x);",
        "forward_dynamics",
    ),
    control(
        "leg",
        "fma(t.sine, u, t.cosine * v),",
        "fma(t.sine, v, t.cosine * u),",
        "forward_dynamics",
    ),
    control(
        "leg",
        "Second(s.square.xzy,",
        "Second(s.square,",
        "forward_dynamics",
    ),
    control(
        "leg",
        "vec3(-product.y, -product.z, square.x + square.y)",
        "vec3(-product.y, product.z, square.x + square.y)",
        "forward_dynamics",
    ),
    control(
        "leg",
        "let l1 = m1.x * d1;",
        "let l1 = m1.x * d2;",
        "forward_dynamics",
    ),
    control(
        "leg",
        "b10 = fma(factors.l2, vec2(-b2), b210.xy)",
        "b10 = fma(factors.l2, vec2(b2), b210.xy)",
        "forward_dynamics",
    ),
    control(
        "leg",
        "first_moment(model.joints[0], first_motion(",
        "first_moment(model.joints[1], first_motion(",
        "forward_dynamics",
    ),
    control(
        "plant_uav",
        "select(0.0, uniforms.plant.gravity, own.channel == HEIGHT)",
        "uniforms.plant.gravity",
        "plant",
    ),
    control(
        "metric",
        "recent.absolute = recent.absolute + size;",
        "recent.absolute = recent.absolute + size * 1.0001;",
        "metrics_take",
    ),
    control(
        "metric",
        "step <= first_fault",
        "step < first_fault",
        "metrics_before_fault",
    ),
    control(
        "team",
        "let others = team - position;",
        "let others = team;",
        "agent_respond",
    ),
    control(
        "team",
        "estimates.y - (sensor_fault + off.y),",
        "estimates.y - sensor_fault,",
        "agent_observe",
    ),
    control(
        "team",
        "let middle = reference_at(half + 1u);",
        "let middle = reference_at(half);",
        "team_state_advance",
    ),
    control(
        "team",
        "(step + 1u) % FLUSH_STEPS == 0u",
        "step % FLUSH_STEPS == 1u",
        "team_state_advance",
    ),
    control(
        "team",
        "return published[slot][channel][agent][own.lane]",
        "return published[slot][channel][own.agent][own.lane]",
        "slot",
    ),
    control(
        "observer_feedback",
        "integrand = fma(sensor_fault, b.x, seen_error);",
        "integrand = seen_error;",
        "step_channel",
    ),
    control(
        "observer_feedback",
        "seen_rate - rate_hat",
        "rate - rate_hat",
        "step_channel",
    ),
    control(
        "team",
        "fma(team, -TEAM_SHARE, position)",
        "fma(team, TEAM_SHARE, position)",
        "agent_respond",
    ),
    control(
        "team",
        "from_centroid * -own.kappa",
        "from_centroid * own.kappa",
        "agent_respond",
    ),
    control(
        "team",
        "stage > 0u || !exogenous_inputs_ticks(step)",
        "!exogenous_inputs_ticks(step)",
        "agent_seen",
    ),
    control(
        "team",
        "measure((stage + 1u) / 2u, motion) - motion",
        "measure(stage / 2u, motion) - motion",
        "agent_seen",
    ),
    control(
        "team",
        "slot_get(command_slot(), own.channel, agent)",
        "slot_get(command_slot(), own.channel, own.agent)",
        "team_commands",
    ),
    control("team", "return 2u * SHARED;", "return SHARED;", "slot"),
    control(
        "team",
        "exogenous_inputs_remember(step, response.sent, agent_motion",
        "exogenous_inputs_remember(step, response.command, agent_motion",
        "agent_remember",
    ),
    control(
        "team",
        "own.held_feedback = agent_feedback(0u, step);",
        "own.held_feedback = feedback(0u);",
        "agent_remember",
    ),
    control(
        "team",
        "turbulence_advance(k, step);",
        "turbulence_advance(k, step + 1u);",
        "team_state_end_step",
    ),
    control(
        "episode",
        "own.held_feedback = stored_number(MEMORY + 3u);",
        "own.held_feedback = stored_number(MEMORY);",
        "resume",
    ),
    control(
        "episode",
        "last_arrived = stored_number(MEMORY + 5u);",
        "last_arrived = stored_number(MEMORY + 4u);",
        "resume",
    ),
    control(
        "episode",
        "store_number(MEMORY + 4u, last_sent);",
        "store_number(MEMORY + 4u, last_arrived);",
        "keep",
    ),
    control(
        "episode",
        "store_number(MEMORY + 2u, last_measured.y);",
        "store_number(MEMORY + 2u, last_measured.x);",
        "keep",
    ),
    control(
        "metric",
        "stored_number(RECENT + 3u),",
        "stored_number(RECENT + 4u),",
        "resume",
    ),
    control(
        "metric",
        "store_number(LARGEST, largest.error);",
        "store_number(LARGEST, largest.command);",
        "keep",
    ),
];

/// All changes.
fn controls() -> impl Iterator<Item = &'static Control> {
    CONTROLS.iter().chain(OF_SIGNALS)
}

#[test]
fn val_every_change_is_of_a_text_that_there_is() {
    let files: BTreeSet<&str> = controls().map(|control| control.file).collect();
    assert_eq!(
        files.len(),
        21,
        "each file of shaders/ that has functions, and the constants: {files:?}"
    );
    let shapes = shapes::probed().into_iter().chain([shapes::plain_int64()]);
    let texts: Vec<String> = shapes.map(|shape| shape.text()).collect();
    for Control { old, .. } in controls() {
        let most = texts.iter().map(|text| text.matches(old).count()).max();
        assert_eq!(most, Some(1), "{old:?}");
    }
}

#[test]
fn regress_probes_notice_a_changed_shader() {
    let Some(lab) = Lab::open() else { return };
    let mut unnoticed = Vec::new();
    for control in controls() {
        let probe = probes().find(|probe| probe.name == control.probe).unwrap();
        let compared = (probe.run)(&lab.changed(control.old, control.new));
        let share = 100.0 * compared.wrong.len() as f64 / compared.words as f64;
        println!(
            "{:10} {:24} {share:.2} % of the results differ",
            control.file, control.probe
        );
        if compared.wrong.is_empty() {
            unnoticed.push((control.probe, control.old, control.new));
        }
    }
    assert!(unnoticed.is_empty(), "{unnoticed:#?}");
}
