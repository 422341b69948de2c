//! Probes of shaders/group.wgsl and episode.wgsl: agents and teams, and the buffers that they live in.

use super::harness::{Compared, Expected, Lab};
use super::loops::{answer_response, at_stage, nothing, rows, sized};
use super::numbers::Numbers;
use super::signals::{begin, next, switches};
use super::tracked::Tracked;
use super::world::{Flies, Scene, World};
use crate::backend::gpu::setting::{LegPlantWords, UavWords};
use crate::backend::gpu::words::NEVER;
use crate::model::controller::fault_estimates;
use crate::model::episode::PlantKind;
use crate::model::group::Agent;
use crate::model::lanes::Lane;
use crate::model::plant::{ReferenceRow, Response};

/// The rows of all agents' channels.
fn team_rows<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    world: &World<P, NC, NS, NX>,
    scene: &Scene<NC, NS, NX>,
) -> Vec<ReferenceRow<f32>> {
    (0..scene.asked.len())
        .flat_map(|a| rows(world, scene, a))
        .collect()
}

pub(super) fn slots<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        publish(stage, SHARED - 1u, number(0u));
        workgroupBarrier();
        answer_number(0u, seen(stage, SHARED - 1u, (own.channel + 1u) % NC));
        answer(1u, slot(stage, SHARED - 1u, own.channel, (own.agent + 1u) % TEAM));";
    let (shape, team) = (&world.shape, world.shape.team);
    world.check(lab, body, 2, sized([1.0]), |scene| {
        let lane = scene.index % shape.lanes;
        scene.each(|scene, a, c| {
            let other = scene.number(a, (c + 1) % NC, 0);
            scene.answer_number(a, c, other);
            let half = scene.stage % 2 * shape.shared() + shape.shared() - 1;
            let slot = half * shape.workgroup() + shape.place(c, (a + 1) % team, lane);
            scene.answer(a, c, Expected::Bits(slot as u32));
        });
    })
}

pub(super) fn team_sum<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        publish(stage, POSITION, reference(stage, asked_reference().row).x + stepped_at(stage, 1u));
        workgroupBarrier();
        answer_number(0u, team_sum(stage));";
    let world = World::<P, NC, NS, NX> {
        lost: true,
        ..World::new(world.shape.clone(), world.plant)
    };
    world.check(lab, body, 1, sized([1.0; 4]), |scene| {
        let rows = team_rows(&world, scene);
        let mut setting = world.setting(&rows);
        setting.coupled = true;
        let sum = at_stage!(
            scene.stage,
            STAGE,
            scene.group.team_sum::<P, STAGE>(&setting, &rows)
        );
        scene.each(|scene, a, c| scene.answer_number(a, c, sum[c]));
    })
}

pub(super) fn responses<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "load(); answer_response(agent_respond(stage, asked_reference()));";
    world.check(lab, body, 6, sized([1.0, 1.0, 1.0, 3.0]), |scene| {
        let rows = team_rows(world, scene);
        let setting = world.setting(&rows);
        let group = &scene.group;
        let team = at_stage!(
            scene.stage,
            STAGE,
            group.team_sum::<P, STAGE>(&setting, &rows)
        );
        for (a, rows) in rows.chunks_exact(NC * P::ROWS).enumerate() {
            let agent = &scene.group.agents[a];
            let response = at_stage!(
                scene.stage,
                STAGE,
                agent.respond::<P, STAGE>(&setting, rows, &team)
            );
            for c in 0..NC {
                answer_response(scene, (a, c), &response);
            }
        }
    })
}

pub(super) fn observed<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        let response = Response(number(0u), number(1u), number(2u), number(3u), vec2(0.0));
        agent_observe(response, step >= 500u, step);";
    let inputs = |n: &mut Numbers, c: usize| {
        let mut words = sized([5.0, 5.0, 5.0, 1.0])(n, c);
        words[3] = n.one_of(&[words[3], 0]);
        words
    };
    world.check(lab, body, 0, inputs, |scene| {
        let now = Tracked::number(f64::from(scene.step));
        for a in 0..world.shape.team {
            let input = |k: usize| std::array::from_fn(|c| scene.number(a, c, k));
            let response = Response {
                error_acceleration: input(0),
                told: input(1),
                command: input(2),
                excess: input(3),
                extra_rate: [Tracked::exact(0.0); NX],
            };
            let agent = &mut scene.group.agents[a];
            if scene.step >= 500 {
                agent.observe::<P, true>(&world.limits, &response, now);
            } else {
                agent.observe::<P, false>(&world.limits, &response, now);
            }
        }
    })
}

/// When a shader holds an agent's signals next.
fn next_change<const NC: usize, const NS: usize, const NX: usize>(
    agent: &Agent<Tracked, NC, NS, NX>,
    c: usize,
    step: u32,
) -> u32 {
    let onsets = switches(&agent.signals, c)
        .into_iter()
        .map(|switch| switch.onset);
    next(onsets.chain([agent.first_fault]), step)
}

pub(super) fn held<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    world.check(lab, "load(); group_hold(step);", 0, nothing, |scene| {
        scene.group.hold(world.seed);
        let step = scene.step;
        scene.each(|scene, a, c| {
            let next = next_change(&scene.group.agents[a], c, step);
            scene.next_change[a][c] = Expected::Bits(next);
        });
    })
}

/// Even scenes are at a change, odd ones are not; under noise, all are held.
pub(super) fn begun<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        own.next_change = select(NEVER, step, own.lane % 2u == 0u);
        group_begin_step(step);";
    world.check(lab, body, 0, nothing, |scene| {
        let (step, change) = (
            scene.step,
            (scene.index % world.shape.lanes).is_multiple_of(2),
        );
        scene.group.changes = if change { vec![step] } else { vec![step + 1] };
        scene.group.begin_step(world.seed);
        let held = change || world.shape.counts.noises > 0;
        scene.each(|scene, a, c| {
            let next = next_change(&scene.group.agents[a], c, step);
            scene.next_change[a][c] = Expected::Bits(if held { next } else { NEVER });
        });
    })
}

pub(super) fn stages<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "load(); group_stage(stage, asked_reference(), step >= 500u, step);";
    let h = crate::model::integrator::Step::new(world.step_s);
    world.check(lab, body, 0, sized([1.0, 1.0, 1.0, 3.0]), |scene| {
        let rows = team_rows(world, scene);
        let setting = world.setting(&rows);
        let settled = scene.step >= 500;
        let group = &mut scene.group;
        at_stage!(
            scene.stage,
            STAGE,
            if settled {
                group.stage::<P, STAGE, true>(&setting, &rows, &h);
            } else {
                group.stage::<P, STAGE, false>(&setting, &rows, &h);
            }
        );
    })
}

/// Several steps, with a flush, the settle step and onsets among them.
pub(super) fn advanced<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        signals_begin(span.first);
        group_hold(span.first);
        group_advance();";
    let stride = world.shape.table_rows();
    // The model's table begins with the run, the shaders' with a window.
    let before = (2 * world.span.first as usize) * stride;
    let window = &world.table[world.span.table_first as usize * stride..];
    let mut table = vec![[f32::NAN; 4]; before];
    table.extend(window);
    world.check(lab, body, 0, nothing, |scene| {
        let (first, until) = (world.span.first, world.span.until);
        let group = &mut scene.group;
        group.step = first;
        group.changes = (first..until).collect();
        for agent in &mut group.agents {
            begin(&mut agent.signals, first);
        }
        group.advance(&world.setting(&table), until);
        for agent in &mut group.agents {
            // Until the first fault, how the error stood before it is not final: who holds when tells what is remembered.
            if agent.first_fault.value >= until as f32 {
                for metrics in &mut agent.metrics {
                    metrics.outside_before_fault.error = f64::INFINITY;
                }
            }
        }
    })
}

pub(super) fn shown<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        group_hold(step);
        let shown = group_show();
        for (var k = 0u; k < SHOWN; k++) { answer_number(k, shown[k]); }";
    let stride = world.shape.table_rows();
    let row = &world.table[world.span.table_first as usize * stride..][..stride];
    world.check(lab, body, 10, nothing, |scene| {
        // The model's table is as long as the run until here.
        let mut table = vec![[f32::NAN; 4]; 2 * scene.step as usize * stride];
        table.extend(row);
        let setting = world.setting(&table);
        let shown = scene.group.show(&setting);
        let team = scene.group.team_sum::<P, 0>(&setting, row);
        for (a, rows) in row.chunks_exact(NC * P::ROWS).enumerate() {
            let agent = &scene.group.agents[a];
            let response = agent.respond::<P, 0>(&setting, rows, &team);
            let [position, _] = agent.motion::<P, 0>(&world.plant, rows);
            for c in 0..NC {
                // What is shown has no bounds on its error, so it is worked out once more.
                let agent = &scene.group.agents[a];
                let state = agent.channels[c].at::<0>();
                let [f1_hat, f2_hat] = fault_estimates(state);
                let again = [
                    position[c] - state[1],
                    position[c],
                    state[1],
                    state[2],
                    state[4],
                    response.error_acceleration[c] - response.told[c],
                    f1_hat,
                    agent.signals.sensor_fault[c],
                    f2_hat,
                    response.command[c],
                ];
                let shown = &shown[a][c];
                let shown = [
                    shown.r,
                    shown.x,
                    shown.e,
                    shown.e_rate,
                    shown.e_hat,
                    shown.f1,
                    shown.f1_hat,
                    shown.f2,
                    shown.f2_hat,
                    shown.u,
                ];
                for (number, shown) in again.into_iter().zip(shown) {
                    assert_eq!(f64::from(number.value), shown);
                    scene.answer_number(a, c, number);
                }
            }
        }
    })
}

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
                agent.inverse_inertia[c],
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
            scene.answer_number(a, c, metrics.largest);
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
        let leg: LegPlantWords = bytemuck::pod_read_unaligned(&bytes);
        let max_torque = std::array::from_fn(|c| leg.max_torque[c]);
        [("max_torque", max_torque); 3]
    } else {
        let uav: UavWords = bytemuck::pod_read_unaligned(&bytes);
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
        }
        scene.group.hold(world.seed);
        scene.each(|scene, a, c| {
            let next = next_change(&scene.group.agents[a], c, first);
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
        largest = number(7u);
        outside = 77;
        outside_before_fault = 66;
        keep();";
    world.check(lab, body, 0, sized([1.0; 8]), |scene| {
        scene.kept = true;
        scene.each(|scene, a, c| {
            let inputs: [Tracked; 8] = scene.numbers(a, c);
            let agent = &mut scene.group.agents[a];
            agent.channels[c].start[..6].copy_from_slice(&inputs[..6]);
            let metrics = &mut agent.metrics[c];
            (metrics.recent.effort, metrics.largest) = (inputs[6], inputs[7]);
            metrics.outside = Tracked::exact(77.0);
            metrics.outside_before_fault = Tracked::exact(66.0);
        });
    })
}
