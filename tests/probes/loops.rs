//! Probes of shaders/integrator.wgsl, observer_feedback.wgsl and plant_uav.wgsl: what a stage of a step is made of.

use super::harness::{Compared, Expected, Lab};
use super::numbers::Numbers;
use super::tracked::Tracked;
use super::world::{Flies, Scene, World};
use crate::model::controller::observer_feedback::{ChannelGains, injected};
use crate::model::controller::{Law, Measured};
use crate::model::integrator::Step;
use crate::model::plant::uav::Attitude;
use crate::model::plant::{Inputs, ReferenceRow, Response};

/// Evaluates an expression with the constant `$name` for the stage, which the model takes as a type parameter.
macro_rules! at_stage {
    ($stage:expr, $name:ident, $value:expr) => {
        match $stage {
            0 => {
                const $name: usize = 0;
                $value
            }
            1 => {
                const $name: usize = 1;
                $value
            }
            2 => {
                const $name: usize = 2;
                $value
            }
            _ => {
                const $name: usize = 3;
                $value
            }
        }
    };
}
pub(super) use at_stage;

/// Inputs of a size each.
pub(super) fn sized<const N: usize>(sizes: [f64; N]) -> impl Fn(&mut Numbers, usize) -> Vec<u32> {
    move |numbers, _| sizes.map(|size| numbers.single(size)).to_vec()
}

/// What a function without further inputs is given.
pub(super) fn nothing(_: &mut Numbers, _: usize) -> Vec<u32> {
    Vec::new()
}

pub(super) fn stepped<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let h = Step::new(world.step_s);
    let body = "
        load();
        for (var k = 0u; k < 6u; k++) { answer_number(k, stepped_at(stage, k)); }
        for (var k = 0u; k < 6u; k++) { stepped_take(stage, k, number(k)); }
        if PLANT == THRUST && (own.channel == 3u || own.channel == 4u) {
            stepped_take(stage, EXTRA, number(6u));
            stepped_take(stage, EXTRA + 1u, number(7u));
        }";
    world.check(lab, body, 6, sized([20.0; 8]), |scene| {
        let stage = scene.stage;
        scene.each(|scene, a, c| {
            let slopes: [Tracked; 8] = scene.numbers(a, c);
            let agent = &mut scene.group.agents[a];
            let before = at_stage!(stage, STAGE, *agent.channels[c].at::<STAGE>());
            at_stage!(
                stage,
                STAGE,
                for (k, &slope) in slopes[..6].iter().enumerate() {
                    agent.channels[c].take::<STAGE>(k, slope, &h);
                }
            );
            if NX == 4 && (c == 3 || c == 4) {
                at_stage!(
                    stage,
                    STAGE,
                    for k in 0..2 {
                        agent.extra.take::<STAGE>(c - 3 + 2 * k, slopes[6 + k], &h);
                    }
                );
            }
            for &number in &before[..6] {
                scene.answer_number(a, c, number);
            }
        });
    })
}

pub(super) fn gains<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        for (var row = 0u; row < 7u; row++) {
            let gains = injection(row);
            answer_number(3u * row, gains.x);
            answer_number(3u * row + 1u, gains.y);
            answer_number(3u * row + 2u, gains.z);
        }
        for (var k = 0u; k < 7u; k++) { answer_number(21u + k, feedback_gains(k / 4u)[k % 4u]); }
        for (var k = 0u; k < 3u; k++) { answer_number(28u + k, smoothing()[k]); }
        for (var k = 0u; k < 2u; k++) { answer_number(31u + k, sensor_fault_input()[k]); }
        answer(33u, select(0u, 1u, is_attitude()));
        let measured = channel_gains_measured(number(0u), number(1u), number(2u), number(3u));
        for (var k = 0u; k < 3u; k++) { answer_number(34u + k, measured[k]); }";
    world.check(lab, body, 37, sized([1.0; 4]), |scene| {
        scene.each(|scene, a, c| {
            let gains = &world.gains[c];
            let numbers = gains.injection.as_flattened().iter().chain(&gains.feedback);
            let numbers = numbers
                .chain(&gains.smoothing)
                .chain(&gains.sensor_fault_input);
            for &number in numbers {
                scene.answer_number(a, c, Tracked::exact(number));
            }
            scene.answer(a, c, Expected::Bits(u32::from(c >= 3)));
            let [integral, error, rate, fault] = scene.numbers(a, c);
            for number in gains.measured(integral, error, rate, fault) {
                scene.answer_number(a, c, number);
            }
        });
    })
}

pub(super) fn controller<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        answer_number(0u, feedback(stage));
        answer_number(1u, fault_estimates().x);
        answer_number(2u, fault_estimates().y);
        for (var row = 0u; row < 7u; row++) {
            answer_number(3u + row, injected(row, vec3(number(0u), number(1u), number(2u)), number(3u)));
        }";
    world.check(lab, body, 10, sized([1.0; 4]), |scene| {
        let stage = scene.stage;
        scene.each(|scene, a, c| {
            let gains = &world.gains[c];
            let channel = scene.group.agents[a].channels[c];
            let sent = at_stage!(stage, STAGE, gains.feedback(channel.at::<STAGE>()));
            scene.answer_number(a, c, sent);
            for estimate in ChannelGains::<f32>::fault_estimates(channel.at::<0>()) {
                scene.answer_number(a, c, estimate);
            }
            let [x, y, z, base] = scene.numbers(a, c);
            for row in &gains.injection {
                scene.answer_number(a, c, injected(row, &[x, y, z], base));
            }
        });
    })
}

pub(super) fn step_channels<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let h = Step::new(world.step_s);
    let body = "
        load();
        step_channel(stage, number(0u), number(1u), vec2(number(3u), number(4u)), number(2u));";
    world.check(lab, body, 0, sized([20.0, 1.0, 5.0, 1.0, 1.0]), |scene| {
        let stage = scene.stage;
        scene.each(|scene, a, c| {
            let [acceleration, sensor_fault, applied_feedback, off, off_rate] = scene.numbers(a, c);
            let measured = Measured {
                sensor_fault,
                off: [off, off_rate],
                integral: world.shape.measured_integral,
            };
            let channel = &mut scene.group.agents[a].channels[c];
            at_stage!(stage, STAGE, {
                world.gains[c].step::<STAGE>(
                    channel,
                    acceleration,
                    &measured,
                    applied_feedback,
                    &h,
                );
            });
        });
    })
}

pub(super) fn references<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        let r = reference(stage, numbers(0u));
        answer_number(0u, r.x);
        answer_number(1u, r.y);
        let at = reference_at(stage);
        for (var k = 0u; k < 4u; k++) { answer_number(2u + k, at.row[k]); }
        answer(6u, at.place);";
    world.check(lab, body, 7, sized([1.0; 4]), |scene| {
        let (stage, team) = (scene.stage, world.shape.team);
        scene.each(|scene, a, c| {
            let rows = rows(world, scene, a);
            let extra = at_stage!(stage, STAGE, *scene.group.agents[a].extra.at::<STAGE>());
            let [position, velocity] = world.plant.reference(&rows, &extra);
            scene.answer_number(a, c, position[c]);
            scene.answer_number(a, c, velocity[c]);
            let half = world.span.table_first as usize + stage;
            let place = ((half * team + a) * NC + c) * P::ROWS;
            for number in world.table[place] {
                scene.answer_number(a, c, Tracked::exact(number));
            }
            scene.answer(a, c, Expected::Bits(place as u32));
        });
    })
}

/// The rows of an agent's channels: the first of each is its first four inputs, what follows is in the table.
pub(super) fn rows<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    world: &World<P, NC, NS, NX>,
    scene: &Scene<NC, NS, NX>,
    agent: usize,
) -> Vec<ReferenceRow<f32>> {
    let first = world.span.table_first as usize * world.shape.team + agent;
    let mut rows = world.table[first * NC * P::ROWS..][..NC * P::ROWS].to_vec();
    for c in 0..NC {
        rows[c * P::ROWS] = std::array::from_fn(|k| f32::from_bits(scene.word(agent, c, k)));
    }
    rows
}

/// The answer of a channel as the shaders give it.
pub(super) fn answer_response<const NC: usize, const NS: usize, const NX: usize>(
    scene: &mut Scene<NC, NS, NX>,
    (a, c): (usize, usize),
    response: &Response<Tracked, NC, NX>,
) {
    scene.answer_number(a, c, response.error_acceleration[c]);
    scene.answer_number(a, c, response.applied_feedback[c]);
    scene.answer_number(a, c, response.sent[c]);
    scene.answer_number(a, c, response.command[c]);
    // What no limit cuts is not cut by a rounding error either: saturation is told by an exact zero.
    let excess = response.excess[c];
    let excess = if excess.value == 0.0 {
        Tracked::exact(0.0)
    } else {
        excess
    };
    scene.answer_number(a, c, excess);
    let none = Expected::Near(Tracked::exact(0.0));
    let extra = match (NX, c) {
        (4, 3 | 4) => [0, 2].map(|k| Expected::Near(response.extra_rate[c - 3 + k])),
        (4, 5) => [Expected::Any; 2],
        _ => [none; 2],
    };
    for expected in extra {
        scene.answer(a, c, expected);
    }
}

/// The plant itself: what other channels have published, then the answer to inputs that the probe gives.
pub(super) fn plant<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        let inputs = Inputs(asked_reference(), number(4u), number(5u), number(6u), number(7u));
        publish_channel(stage, inputs);
        workgroupBarrier();
        answer_response(respond(stage, inputs));";
    let sizes = [1.0, 1.0, 2.0, 3.0, 4.0, 2.0, 1.0, 1.0];
    world.check(lab, body, 7, sized(sizes), |scene| {
        let stage = scene.stage;
        scene.each(|scene, a, c| {
            let rows = rows(world, scene, a);
            let input = |k: usize| std::array::from_fn(|c| scene.number(a, c, k));
            let agent = &scene.group.agents[a];
            let inputs = Inputs {
                reference: &rows,
                feedback: input(4),
                position: input(5),
                velocity: input(6),
                force: input(7),
                ground: &agent.signals.ground,
                actuator: &agent.signals.actuator,
                inverse_inertia: &agent.signals.inverse_inertia,
            };
            let extra = at_stage!(stage, STAGE, *agent.extra.at::<STAGE>());
            let response = world.plant.respond(&inputs, &extra);
            answer_response(scene, (a, c), &response);
        });
    })
}

/// The rotation alone, of plants that have one.
pub(super) fn rotation<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
    attitude: Attitude<f32>,
) -> Compared {
    let first = NC - 3;
    let body = format!(
        "load();
        if NC == 3u || own.channel >= 3u {{ publish(stage, VELOCITY, number(1u)); }}
        workgroupBarrier();
        if own.channel >= {first}u {{
            answer_number(0u, attitude_acceleration(stage, {first}u, number(0u), number(1u)));
        }}"
    );
    world.check(lab, &body, 1, sized([3.0, 2.0]), |scene| {
        scene.each(|scene, a, c| {
            if c < first {
                return scene.answer(a, c, Expected::Any);
            }
            let input = |k: usize| std::array::from_fn(|i| scene.number(a, first + i, k));
            let inverse = &scene.group.agents[a].signals.inverse_inertia;
            let inverse = std::array::from_fn(|i| inverse[first + i]);
            let acceleration = attitude.acceleration::<Tracked>(input(0), input(1), inverse);
            scene.answer_number(a, c, acceleration[c - first]);
        });
    })
}
