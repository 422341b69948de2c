//! Probes of shaders/episode.wgsl: who an invocation is, and the buffers that its state lives in.

use super::exogenous::begin;
use super::harness::{Compared, Expected, Lab};
use super::loops::{nothing, sized};
use super::team::held_next;
use super::tracked::Tracked;
use super::world::{Flies, World};
use crate::backend::gpu::uniforms::{LegPlantUniforms, UavUniforms};
use crate::model::exogenous::ExogenousInputs;
use crate::model::exogenous::actuator::Actuator;
use crate::model::plant::kinds::PlantKind;

/// Who an invocation is, and its words of the buffers.
pub(super) fn identified<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        let identity = array(own.local, own.lane, own.agent, own.channel, own.first_fault, drawn(EPISODE));
        for (var k = 0u; k < 6u; k++) { answer(k, identity[k]); }
        answer_number(6u, own.limits.x);
        answer_number(7u, own.limits.y);
        answer_number(8u, own.inverse_inertia);
        answer_number(9u, own.kappa);
        answer_number(10u, drawn_number(CONSTANT));
        answer(11u, stored(OUTSIDE));
        answer_number(12u, stored_number(LARGEST));
        answer_number(13u, drawn_number(INTEGRAL));
        answer_number(14u, drawn_number(ERROR));
        answer_number(15u, drawn_number(ERROR_RATE));
        store(TOTALS, asked(0u));
        store_number(TOTALS + 1u, number(1u));";
    let shape = &world.shape;
    world.check(lab, body, 16, sized([1.0, 1.0]), |scene| {
        let index = scene.index;
        let lane = index % shape.lanes;
        scene.each(|scene, a, c| {
            let agent = &mut scene.group.agents[a];
            let condition = world.condition::<Tracked>(index, a);
            let first_fault = Expected::First(agent.first_fault).word();
            let numbers = [
                Tracked::exact(world.limits[c].max_error),
                Tracked::exact(world.limits[c].settled_error),
                agent.signals.first_inverse_inertia[c],
                agent.kappa,
            ];
            let metrics = agent.metrics[c];
            let constant = agent.signals.constant[c];
            let [square, absolute] = scene.numbers(a, c);
            let total = &mut scene.group.agents[a].metrics[c].total;
            (total.square, total.absolute) = (square, absolute);
            let local = shape.place(c, a, lane);
            for word in [
                local,
                lane,
                a,
                c,
                first_fault as usize,
                super::world::episode(index) as usize,
            ] {
                scene.answer(a, c, Expected::Bits(word as u32));
            }
            for number in numbers.into_iter().chain([constant]) {
                scene.answer_number(a, c, number);
            }
            scene.answer(a, c, Expected::Last(metrics.outside));
            scene.answer_number(a, c, metrics.largest.error);
            for number in condition.initial[c] {
                scene.answer_number(a, c, number);
            }
        });
    })
}

/// What a channel takes of the constants of its plant.
pub(super) fn constants<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let bytes = world.plant.bytes();
    let taken: [(&str, [f32; NC]); 3] = if world.shape.plant == PlantKind::Leg {
        let leg: LegPlantUniforms = bytemuck::pod_read_unaligned(&bytes);
        let max_torque = std::array::from_fn(|c| leg.max_torque[c]);
        [("max_torque", max_torque); 3]
    } else {
        let uav: UavUniforms = bytemuck::pod_read_unaligned(&bytes);
        let attitude = |of: [f32; 4]| {
            let axis = |c| (world.first + c) % 3;
            std::array::from_fn(|c| if NC == 1 { 0.0 } else { of[axis(c)] })
        };
        [
            ("inertia", attitude(uav.inertia)),
            ("inverse_inertia", attitude(uav.inverse_inertia)),
            ("gyro", attitude(uav.gyro)),
        ]
    };
    let answers = (0..).zip(taken);
    let answers = answers.map(|(k, (name, _))| format!("answer_number({k}u, own.plant.{name});"));
    let body = format!("load(); {}", answers.collect::<String>());
    world.check(lab, &body, 3, nothing, |scene| {
        scene.each(|scene, a, c| {
            for (_, numbers) in taken {
                scene.answer_number(a, c, Tracked::exact(numbers[c]));
            }
        });
    })
}

/// What signals know of the step before the one that is held next.
fn forget<const NC: usize>(signals: &mut ExogenousInputs<Tracked, NC>) {
    let none = Tracked::exact(0.0);
    signals.actuator = Actuator::sound();
    for ring in &mut signals.lists.command_rings {
        ring.past = [[[none; 1]; 2]; NC];
    }
    for ring in &mut signals.lists.sensor_rings {
        ring.past = [[[none; 2]; 2]; NC];
    }
}

/// The state from where the last span left it.
pub(super) fn resumed<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    world.check(lab, "resume();", 0, nothing, |scene| {
        let first = world.span.first;
        scene.group.step = first;
        for agent in &mut scene.group.agents {
            begin(&mut agent.signals, first);
            // What is not stored begins at zero.
            let none = Tracked::exact(0.0);
            for channel in &mut agent.channels {
                (channel.point, channel.sum) = ([none; NS], [none; NS]);
            }
            (agent.extra.point, agent.extra.sum) = ([none; NX], [none; NX]);
            forget(&mut agent.signals);
            if !world.shape.lists.remembers {
                agent.held_feedback = [none; NC];
                agent.signals.last_sent = [none; NC];
                agent.signals.last_arrived = [none; NC];
                agent.signals.last_command = [none; NC];
                agent.signals.last_measured = [[none; 2]; NC];
            }
        }
        scene.group.hold(world.seed);
        scene.each(|scene, a, c| {
            let next = held_next(&scene.group.agents[a], c, first);
            scene.next_change[a][c] = Expected::Bits(next);
        });
    })
}

/// The state for the next span; it differs from what was stored, for it is held and stepped before.
pub(super) fn kept<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        for (var k = 0u; k < 6u; k++) { stepped_start[k] = number(k); }
        recent.effort = number(6u);
        largest.error = number(7u);
        outside = 77;
        outside_before_fault = 66;
        last_command = number(8u);
        last_measured = vec2(number(9u), number(10u));
        own.held_feedback = number(11u);
        last_sent = number(12u);
        last_arrived = number(13u);
        keep();";
    world.check(lab, body, 0, sized([1.0; 14]), |scene| {
        scene.kept = true;
        scene.each(|scene, a, c| {
            let inputs: [Tracked; 14] = scene.numbers(a, c);
            let agent = &mut scene.group.agents[a];
            agent.channels[c].start[..6].copy_from_slice(&inputs[..6]);
            let metrics = &mut agent.metrics[c];
            (metrics.recent.effort, metrics.largest.error) = (inputs[6], inputs[7]);
            metrics.outside = Tracked::exact(77.0);
            metrics.outside_before_fault = Tracked::exact(66.0);
            agent.signals.last_command[c] = inputs[8];
            agent.signals.last_measured[c] = [inputs[9], inputs[10]];
            agent.held_feedback[c] = inputs[11];
            agent.signals.last_sent[c] = inputs[12];
            agent.signals.last_arrived[c] = inputs[13];
        });
    })
}
