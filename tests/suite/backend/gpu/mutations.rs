//! Changed shaders and gains, each of which the comparison of the parity tests must notice: a comparison that cannot
//! fail shows nothing.

use super::agreement::{CONTRACT, Expected, Summary, TWIN};
use super::{ALIKE, BRIEF, Gains, jets, linked, mixed, mixed_biped, mixed_thrust, simulate_all};
use crate::common::{gains, gpu_or_skip};
use urts_mc::backend::gpu::{Gpu, GpuSimulator, Tuning};
use urts_mc::campaign::Campaign;

/// What is wrong, the text that is right, and the wrong one.
type Mutation = (&'static str, &'static str, &'static str);

/// What is changed of the gains, and how.
type Change = (&'static str, fn(&mut Gains));

/// Noticed under full actuation.
const FULL: [Mutation; 20] = [
    (
        "faults begin a step late",
        "select(0.0, risen, onset <= step)",
        "select(0.0, risen, onset < step)",
    ),
    (
        "a workgroup reads draws of the one before",
        "workgroup * (DRAWN_WORDS * WORKGROUP) + local",
        "workgroup * ((DRAWN_WORDS - 1u) * WORKGROUP) + local",
    ),
    (
        "agents and episodes change places",
        "own.agent = local / LANES % TEAM;",
        "own.agent = local % TEAM;",
    ),
    (
        "agents push where they should pull",
        "fma(others * own.kappa, position, disturbance)",
        "fma(others * -own.kappa, position, disturbance)",
    ),
    (
        "the last agent pulls at nobody",
        "agent < TEAM; agent++",
        "agent < TEAM - 1u; agent++",
    ),
    (
        "the last stage looks half a step ahead",
        "select(h.whole, h.half, stage < 2u)",
        "select(h.whole, h.half, stage < 3u)",
    ),
    ("the sine is off by 1e-5", "-0.6459638f", "-0.6459738f"),
    (
        "tanh is off by 1e-4 of itself",
        "0.0022684347f",
        "0.0022686347f",
    ),
    (
        "a step takes the noise of the next",
        "stored_number(SAMPLES + 4u * k + step % 4u)",
        "stored_number(SAMPLES + 4u * k + (step + 1u) % 4u)",
    ),
    (
        "a square wave begins with the run",
        "waves[k].held = window_at(SINES + k, step);",
        "waves[k].held = window_value(SINES + k);",
    ),
    (
        "a sine turns twice as fast",
        "waves[k].phase + waves[k].advance",
        "waves[k].phase + 2u * waves[k].advance",
    ),
    (
        "a sine starts anew with every dispatch",
        "drawn(word + 1u) + 2u * step * advance, advance, 0.0);",
        "drawn(word + 1u), advance, 0.0);",
    ),
    (
        "the observer does not know of its estimate of f2",
        "unexplained = sensor_fault - stepped_at(stage, OBSERVER + 5u);",
        "unexplained = sensor_fault;",
    ),
    (
        "the observer starts without the sensor fault",
        "vec3(integral, fma(fault, b.x, error), fma(fault, b.y, rate))",
        "vec3(integral, error, rate)",
    ),
    (
        "a state does not outlive a dispatch",
        "store_number(CHANNEL + 9u, stepped_start[9]);",
        "",
    ),
    (
        "the gyroscopic torque turns the wrong way",
        "fma(gyroscopic, -own.plant.gyro, net * inverse_inertia)",
        "fma(gyroscopic, own.plant.gyro, net * inverse_inertia)",
    ),
    (
        "drag pushes",
        "fma(inputs.velocity, -uniforms.plant.drag, command + inputs.force)",
        "fma(inputs.velocity, uniforms.plant.drag, command + inputs.force)",
    ),
    (
        "metrics begin a step late",
        "step >= uniforms.settle_step",
        "step > uniforms.settle_step",
    ),
    (
        "a settled error is smaller",
        "lane_within(size, settled_error)",
        "lane_within(size, settled_error - 0.001)",
    ),
    (
        "what was before a fault ends a step early",
        "step <= first_fault",
        "step < first_fault",
    ),
];

/// Noticed under thrust.
const THRUST: [Mutation; 8] = [
    (
        "sums are counted twice",
        "recent = Sums(0.0, 0.0, 0.0, 0.0, 0.0, 0.0);",
        "",
    ),
    (
        "the command filter is half as damped",
        "(w * (roll_command - roll) - (roll_rate + roll_rate)) * w",
        "(w * (roll_command - roll) - roll_rate) * w",
    ),
    (
        "torques may be a little larger",
        "let limit = uniforms.plant.max_torque;",
        "let limit = uniforms.plant.max_torque * 1.001;",
    ),
    (
        "the observer is told of torques beyond the limit",
        "fma(limited - non_inertial,",
        "fma(demanded - non_inertial,",
    ),
    (
        "gravity pulls along y",
        "uniforms.plant.gravity, own.channel == 2u);",
        "uniforms.plant.gravity, own.channel == 1u);",
    ),
    (
        "thrust loses what another actuator lost",
        "seen(stage, COMMAND_GAIN, 2u)",
        "seen(stage, COMMAND_GAIN, 0u)",
    ),
    (
        "thrust acts along the commanded axis",
        "fma(applied, true_axis[own.channel], inputs.force)",
        "fma(applied, commanded_axis[own.channel], inputs.force)",
    ),
    (
        "the arc tangent is off by 1e-5",
        "-0.33333093f",
        "-0.33334093f",
    ),
];

/// Noticed of bipeds within their limits.
const BIPED: [Mutation; 19] = [
    (
        "a joint has the limit of the next",
        "max_torque[own.channel / 4u][own.channel % 4u]",
        "max_torque[own.channel / 4u][(own.channel + 1u) % 4u]",
    ),
    (
        "a joint shows a little more than it demands",
        "publish(stage, DEMAND, inputs.feedback);",
        "publish(stage, DEMAND, inputs.feedback * 1.001);",
    ),
    (
        "two columns of a matrix change places",
        "near.w, far.x, far.y)",
        "near.w, far.y, far.x)",
    ),
    (
        "a joint hears another instead of its neighbour",
        "fma(seen(stage, factors, 4u), row[4], sum)",
        "fma(seen(stage, factors, 3u), row[4], sum)",
    ),
    (
        "the matrix stays as it was when the dispatch began",
        "matrix_row(at, 1u), DEMAND)",
        "matrix_row(reference_at(0u), 1u), DEMAND)",
    ),
    (
        "torques may be a little larger",
        "let limit = own.plant.max_torque;",
        "let limit = own.plant.max_torque * 1.001;",
    ),
    (
        "torques may be as large as they like",
        "select(demanded, limited, CUT)",
        "demanded",
    ),
    (
        "what limits take counts as given",
        "let excess = demanded - limited;",
        "let excess = limited - demanded;",
    ),
    (
        "no torque is lost",
        "let command = actuator_command(sent);",
        "let command = sent + actuator.bias;",
    ),
    (
        "the ground pulls where it pushes",
        "fma(ground, table[at.place + 2u].z, inputs.force)",
        "fma(-ground, table[at.place + 2u].z, inputs.force)",
    ),
    (
        "every robot is as heavy as its model",
        "(command + force) * inverse_inertia",
        "command + force",
    ),
    (
        "the last episode of a workgroup does not move",
        "if own.channel == BIASING_JOINT {",
        "if own.channel == BIASING_JOINT && own.lane < LANES - 1u {",
    ),
    (
        "the observer is not told of torques beyond the limit",
        "applied_feedback = inputs.feedback - plus_product(",
        "applied_feedback = inputs.feedback - 0.0 * plus_product(",
    ),
    (
        "the error accelerates as the joint does",
        "acceleration - at.row.z, applied_feedback",
        "acceleration, applied_feedback",
    ),
    (
        "two joints change accelerations",
        "3u, own.agent, values[3]",
        "3u, own.agent, values[2]",
    ),
    (
        "joints are not damped",
        "fma(rate, -damping, torque)",
        "torque",
    ),
    (
        "gravity is off by a thousandth",
        "let across = model.pelvis.x;",
        "let across = model.pelvis.x * 1.001;",
    ),
    (
        "a rotor weighs nothing",
        "p22.moment.z + j2.angle.y",
        "p22.moment.z",
    ),
    (
        "the torque of an ankle does not reach the knee",
        "b3210 = fma(factors.l5, vec4(-b5), b3210);",
        "",
    ),
];

/// Noticed of UAVs in each other's jets.
const JETS: [Mutation; 9] = [
    (
        "jets blow upwards",
        "fma(sum, -vortex.force, force)",
        "fma(sum, vortex.force, force)",
    ),
    (
        "jets blow along all axes",
        "N_VORTICES > 0u && own.channel == HEIGHT",
        "N_VORTICES > 0u",
    ),
    (
        "jets reach up as far as down",
        "lane_max(other.z - here.z, 0.0)",
        "abs(other.z - here.z)",
    ),
    (
        "a jet is a little wider",
        "1.0 / fma(s2, JET_SPREAD, 1.0)",
        "1.0 / fma(s2, JET_SPREAD * 0.999, 1.0)",
    ),
    (
        "a jet is a little longer",
        "let near = x * share;",
        "let near = x * share * 1.001;",
    ),
    (
        "only the first jet is felt",
        "k < N_VORTICES; k++",
        "k < 1u; k++",
    ),
    (
        "the last agent has no rotors",
        "agent < TEAM; agent++",
        "agent < TEAM - 1u; agent++",
    ),
    (
        "y counts as x",
        "finite(slot_get(slot(stage, POSITION), 1u, agent))",
        "finite(slot_get(slot(stage, POSITION), 0u, agent))",
    ),
    (
        "gravity pulls along x",
        "own.channel == HEIGHT));",
        "own.channel == 0u));",
    ),
];

/// Noticed where links and actuators fail together.
const LINK: [Mutation; 4] = [
    (
        "a blocked link holds what acted",
        "lane_select_le(0.5, blocked, last_arrived, other.x)",
        "lane_select_le(0.5, blocked, last_command, other.x)",
    ),
    (
        "late steps of a command become slopes",
        "select(moment, START, sampled)",
        "moment",
    ),
    (
        "an actuator is a little slower",
        "slew = limit;",
        "slew = limit * 0.99;",
    ),
    (
        "what arrived does not outlive a dispatch",
        "last_arrived = stored_number(MEMORY + 5u);",
        "",
    ),
];

/// A campaign on which mutations must show, simulated by the fault-tolerant controller.
struct Ground {
    campaign: Campaign,
    gains: Gains,
    expected: [Expected; 2],
}

impl Ground {
    fn new(campaign: Campaign) -> Self {
        let gains = gains(&campaign).loops();
        let expected = [&TWIN, &CONTRACT].map(|against| Expected::new(&campaign, &gains, against));
        Self {
            campaign,
            gains,
            expected,
        }
    }

    /// Simulates with changed gains or shaders, and compares as the parity tests do.
    fn compare(
        &self,
        gpu: &Gpu,
        gains: &Gains,
        rewrite: &dyn Fn(String) -> String,
    ) -> Result<[Summary; 2], String> {
        let tuning = Tuning {
            batch: None,
            steps: Some(300),
        };
        let mut simulator =
            GpuSimulator::rewritten(gpu, self.campaign.first_group(), gains, tuning, rewrite)
                .unwrap();
        // A batch that is out of order is noticed before its numbers are.
        let simulated =
            simulate_all(&mut simulator, &self.campaign).map_err(|error| error.to_string())?;
        let [single, double] = &self.expected;
        Ok([single.compare(&simulated)?, double.compare(&simulated)?])
    }

    /// Demands that every mutation is noticed, and that nothing is without one.
    fn notices(&self, gpu: &Gpu, mutations: &[Mutation]) {
        let [single, double] = self.compare(gpu, &self.gains, &|text| text).unwrap();
        assert!(single.compared > 4, "{single}");
        println!("{single}\n{double}");
        let mut unnoticed = Vec::new();
        for (what, right, wrong) in mutations {
            let rewrite = |text: String| {
                assert!(text.contains(right), "{what}: no {right:?} in the shaders");
                text.replace(right, wrong)
            };
            match self.compare(gpu, &self.gains, &rewrite) {
                Ok(_) => unnoticed.push(what),
                Err(difference) => println!("{what}: {difference}"),
            }
        }
        assert!(unnoticed.is_empty(), "{unnoticed:#?}");
    }
}

/// One controller, and errors that seldom fail.
const GENTLE: [&str; 3] = [
    "controllers=[\"ftc\"]",
    "verdict.max_error=1.0",
    "verdict.max_rmse=1.0",
];

fn full() -> Campaign {
    // The attitude has 16 episodes per workgroup.
    let own = ["episodes=20", "coupling.kappa={ choice = [0.0, 1.0] }"];
    mixed(&[&BRIEF[..], &ALIKE, &GENTLE, &own].concat())
}

#[test]
fn mutations_under_full_actuation_are_noticed() {
    let Some(gpu) = gpu_or_skip() else { return };
    Ground::new(full()).notices(&gpu, &FULL);
}

#[test]
fn mutations_under_thrust_are_noticed() {
    let Some(gpu) = gpu_or_skip() else { return };
    // A workgroup has 8 episodes.
    let own = ["episodes=12", "coupling.kappa={ choice = [0.0, 0.05] }"];
    Ground::new(mixed_thrust(&[&BRIEF[..], &GENTLE, &own].concat())).notices(&gpu, &THRUST);
}

#[test]
fn mutations_of_bipeds_are_noticed() {
    let Some(gpu) = gpu_or_skip() else { return };
    let own = [
        "controllers=[\"ftc\"]",
        "coupling.kappa={ choice = [0.0, 10.0] }",
    ];
    Ground::new(mixed_biped(&own)).notices(&gpu, &BIPED);
}

#[test]
fn mutations_of_jets_are_noticed() {
    let Some(gpu) = gpu_or_skip() else { return };
    // A workgroup of three axes has 16 episodes.
    let own = [
        "episodes=20",
        "time.duration_s=1.2",
        "controllers=[\"ftc\"]",
    ];
    Ground::new(jets(&own)).notices(&gpu, &JETS);
}

#[test]
fn mutations_of_links_are_noticed() {
    let Some(gpu) = gpu_or_skip() else { return };
    Ground::new(linked(&["controllers=[\"pid\"]"])).notices(&gpu, &LINK);
}

#[test]
fn changed_gains_are_noticed() {
    let Some(gpu) = gpu_or_skip() else { return };
    let ground = Ground::new(full());
    let right = ground.gains.clone();
    let unchanged = |text| text;
    let changes: [Change; 2] = [
        ("feedback of position", |gains| gains[0][0].k[1] *= 1.0001),
        ("injection of attitude", |gains| {
            gains[0][1].l[2][2] *= 1.0001
        }),
    ];
    for (what, change) in changes {
        let mut wrong = right.clone();
        change(&mut wrong);
        let difference = ground.compare(&gpu, &wrong, &unchanged);
        println!("{what}: {}", difference.err().unwrap());
    }
}
