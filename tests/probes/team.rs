//! Probes of shaders/team.wgsl: agents and teams.

use super::exogenous::{begin, next_change};
use super::harness::{Compared, Expected, Lab};
use super::loops::{answer_response, at_stage, nothing, rows, sized};
use super::numbers::Numbers;
use super::tracked::Tracked;
use super::world::{Flies, Scene, World};
use crate::backend::gpu::layout::NEVER;
use crate::model::agent::{Agent, Coupling, Team};
use crate::model::controller::Law;
use crate::model::controller::observer_feedback::ChannelGains;
use crate::model::exogenous::actuator::Actuator;
use crate::model::plant::{ReferenceRow, Response};
use crate::model::team::finite;

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
        answer_number(1u, slot_get(slot(stage, SHARED - 1u), own.channel, (own.agent + 1u) % TEAM));
        answer(2u, slot(stage, SHARED - 1u));
        answer(3u, command_slot());";
    let (shape, team) = (&world.shape, world.shape.team);
    world.check(lab, body, 4, sized([1.0]), |scene| {
        scene.each(|scene, a, c| {
            for (a_other, c_other) in [(a, (c + 1) % NC), ((a + 1) % team, c)] {
                let other = scene.number(a_other, c_other, 0);
                scene.answer_number(a, c, other);
            }
            let slot = scene.stage % 2 * shape.shared() + shape.shared() - 1;
            // Commands lie behind both halves.
            for slot in [slot, 2 * shape.shared()] {
                scene.answer(a, c, Expected::Bits(slot as u32));
            }
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
        setting.coupling = Coupling::Absolute;
        let sum = at_stage!(
            scene.stage,
            STAGE,
            scene.group.team_sum::<P, _, STAGE>(&setting, &rows)
        );
        scene.each(|scene, a, c| scene.answer_number(a, c, sum[c]));
    })
}

pub(super) fn responses<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "load(); answer_response(agent_respond(stage, asked_reference(), step));";
    world.check(lab, body, 7, sized([1.0, 1.0, 1.0, 3.0]), |scene| {
        let rows = team_rows(world, scene);
        let setting = world.setting(&rows);
        let group = &mut scene.group;
        let sum = at_stage!(scene.stage, STAGE, {
            group.place_agents::<P, _, STAGE>(&setting, &rows);
            group.team_sum::<P, _, STAGE>(&setting, &rows)
        });
        let team = Team {
            sum,
            places: &group.places.clone(),
            size: world.shape.team,
        };
        for (a, rows) in rows.chunks_exact(NC * P::ROWS).enumerate() {
            let agent = &scene.group.agents[a];
            let response = at_stage!(
                scene.stage,
                STAGE,
                agent.respond::<P, _, STAGE>(&setting, rows, &team, a, scene.step)
            );
            for c in 0..NC {
                answer_response(scene, (a, c), &response);
            }
        }
    })
}

/// x, x' and u_fb of a channel, and by how much x and x' are measured too large.
pub(super) fn seen<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        let motion = agent_motion(stage, asked_reference());
        let off = agent_distortion(stage, asked_reference());
        answer_number(0u, motion.x);
        answer_number(1u, motion.y);
        answer_number(2u, off.x);
        answer_number(3u, off.y);
        answer_number(4u, agent_feedback(stage, step));";
    world.check(lab, body, 5, sized([1.0; 4]), |scene| {
        let all = team_rows(world, scene);
        let setting = world.setting(&all);
        for (a, rows) in all.chunks_exact(NC * P::ROWS).enumerate() {
            let agent = &scene.group.agents[a];
            let ([position, velocity], off, feedback) = at_stage!(
                scene.stage,
                STAGE,
                (
                    agent.motion::<P, STAGE>(&world.plant, rows),
                    agent.distortion::<P, STAGE>(&world.plant, rows),
                    agent.feedback::<P, _, STAGE>(&setting, scene.step)
                )
            );
            for c in 0..NC {
                let [off, off_rate] = off[c];
                for number in [position[c], velocity[c], off, off_rate, feedback[c]] {
                    scene.answer_number(a, c, number);
                }
            }
        }
    })
}

/// The sum of the team's last commands, of agents some of which are far away, and what is made of such a sum.
pub(super) fn team_commands<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        answer_number(0u, team_commands());
        answer_number(1u, finite(number(0u)));";
    let world = World::<P, NC, NS, NX> {
        lost: true,
        ..World::new(world.shape.clone(), world.plant)
    };
    let inputs = |n: &mut Numbers, _: usize| {
        let far = [
            1e15,
            1.001e15,
            f32::INFINITY,
            f32::NAN,
            n.around(2e15) as f32,
        ];
        vec![(n.one_of(&far) * n.one_of(&[1.0, -1.0])).to_bits()]
    };
    world.check(lab, body, 2, inputs, |scene| {
        let sum = scene.group.team_commands();
        scene.each(|scene, a, c| {
            scene.answer_number(a, c, sum[c]);
            let mut number = [scene.number(a, c, 0)];
            finite(&mut number);
            scene.answer_number(a, c, number[0]);
        });
    })
}

/// A response of which everything is given but the rates of the plant's own states.
fn given<const NC: usize, const NS: usize, const NX: usize>(
    scene: &Scene<NC, NS, NX>,
    agent: usize,
) -> Response<Tracked, NC, NX> {
    let input = |k: usize| std::array::from_fn(|c| scene.number(agent, c, k));
    Response {
        error_acceleration: input(4),
        applied_feedback: input(5),
        sent: input(6),
        command: input(7),
        excess: input(8),
        extra_rate: [Tracked::exact(0.0); NX],
    }
}

/// The same in the shaders.
const GIVEN: &str = "
        load();
        let response = Response(number(4u), number(5u), number(6u), number(7u), number(8u), vec2(0.0));";

/// Inputs of these two.
fn to_give(n: &mut Numbers, c: usize) -> Vec<u32> {
    let mut words = sized([1.0, 1.0, 1.0, 1.0, 5.0, 5.0, 5.0, 5.0, 1.0, 1.0, 1.0])(n, c);
    words[8] = n.one_of(&[words[8], 0]);
    words
}

pub(super) fn observed<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = format!(
        "{GIVEN}
        agent_observe(response, vec2(number(9u), number(10u)), step >= 500u, step);"
    );
    world.check(lab, &body, 0, to_give, |scene| {
        let step = scene.step;
        for a in 0..world.shape.team {
            let response = given(scene, a);
            let off = std::array::from_fn(|c| [9, 10].map(|k| scene.number(a, c, k)));
            let agent = &mut scene.group.agents[a];
            if step >= 500 {
                agent.observe::<P, ChannelGains<f32>, true>(&world.limits, &response, &off, step);
            } else {
                agent.observe::<P, ChannelGains<f32>, false>(&world.limits, &response, &off, step);
            }
        }
    })
}

/// What an agent keeps of the start of a step, and what of it the others see.
pub(super) fn remembered<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = format!(
        "{GIVEN}
        agent_remember(response, asked_reference(), step);
        if N_LEAKS > 0u {{
            workgroupBarrier();
            answer_number(0u, slot_get(command_slot(), own.channel, (own.agent + 1u) % TEAM));
        }}"
    );
    let (leaks, team) = (world.shape.leaks(), world.shape.team);
    world.check(lab, &body, 1, to_give, |scene| {
        let all = team_rows(world, scene);
        let setting = world.setting(&all);
        for (a, rows) in all.chunks_exact(NC * P::ROWS).enumerate() {
            let response = given(scene, a);
            let step = scene.step;
            scene.group.agents[a].remember(&setting, rows, &response, step);
        }
        scene.each(|scene, a, c| {
            let command = scene.group.agents[(a + 1) % team].signals.last_command[c];
            let shown = if leaks {
                Expected::Near(command)
            } else {
                Expected::Any
            };
            scene.answer(a, c, shown);
        });
    })
}

pub(super) fn ended<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    world.check(
        lab,
        "load(); team_state_end_step(step);",
        0,
        nothing,
        |scene| {
            scene.group.end_step(world.seed);
        },
    )
}

/// When a shader holds an agent's signals next.
pub(super) fn held_next<const NC: usize, const NS: usize, const NX: usize>(
    agent: &Agent<Tracked, NC, NS, NX>,
    c: usize,
    step: u32,
) -> u32 {
    let first_fault = Expected::First(agent.first_fault).word();
    let first_fault = Some(first_fault).filter(|&first| first > step);
    next_change(&agent.signals, c, step).min(first_fault.unwrap_or(NEVER))
}

pub(super) fn held<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    world.check(lab, "load(); team_state_hold(step);", 0, nothing, |scene| {
        scene.group.hold(world.seed);
        let step = scene.step;
        scene.each(|scene, a, c| {
            let next = held_next(&scene.group.agents[a], c, step);
            scene.next_change[a][c] = Expected::Bits(next);
        });
    })
}

/// Even scenes are at a change, odd ones are not; what is restless is held in all.
pub(super) fn begun<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        own.next_change = select(NEVER, step, own.lane % 2u == 0u);
        team_state_begin_step(step);";
    world.check(lab, body, 0, nothing, |scene| {
        let (step, change) = (
            scene.step,
            (scene.index % world.shape.lanes).is_multiple_of(2),
        );
        scene.group.changes = if change { vec![step] } else { vec![step + 1] };
        scene.group.begin_step(world.seed);
        let held = change || world.shape.lists.restless;
        scene.each(|scene, a, c| {
            let next = held_next(&scene.group.agents[a], c, step);
            scene.next_change[a][c] = Expected::Bits(if held { next } else { NEVER });
        });
    })
}

pub(super) fn stages<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "load(); team_state_stage(stage, asked_reference(), step >= 500u, step);";
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
                group.stage::<P, _, STAGE, true>(&setting, &rows, &h);
            } else {
                group.stage::<P, _, STAGE, false>(&setting, &rows, &h);
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
        exogenous_inputs_begin(span.first);
        team_state_hold(span.first);
        team_state_advance();";
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
            agent.signals.actuator = Actuator::sound();
        }
        group.advance(&world.setting(&table), until);
        for agent in &mut group.agents {
            // Until the first fault, how the error stood before it is not final: who holds when tells what is
            // remembered.
            if agent.first_fault.value >= until as f32 {
                for metrics in &mut agent.metrics {
                    metrics.outside_before_fault.error = f64::INFINITY;
                }
            }
        }
    })
}

/// What is shown at the span's first step.
pub(super) fn shown<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        team_state_hold(span.first);
        let shown = team_state_show();
        for (var k = 0u; k < SHOWN; k++) { answer_number(k, shown[k]); }";
    let stride = world.shape.table_rows();
    let row = &world.table[world.span.table_first as usize * stride..][..stride];
    let step = world.span.first;
    // The model's table is as long as the run until here.
    let mut table = vec![[f32::NAN; 4]; 2 * step as usize * stride];
    table.extend(row);
    world.check(lab, body, 10, nothing, |scene| {
        let setting = world.setting(&table);
        scene.group.step = step;
        let shown = scene.group.show(&setting);
        scene.each(|scene, a, c| {
            let next = held_next(&scene.group.agents[a], c, step);
            scene.next_change[a][c] = Expected::Bits(next);
        });
        let group = &mut scene.group;
        group.place_agents::<P, _, 0>(&setting, row);
        let team = Team {
            sum: group.team_sum::<P, _, 0>(&setting, row),
            places: &group.places.clone(),
            size: world.shape.team,
        };
        for (a, rows) in row.chunks_exact(NC * P::ROWS).enumerate() {
            let agent = &scene.group.agents[a];
            let response = agent.respond::<P, _, 0>(&setting, rows, &team, a, step);
            let off = agent.distortion::<P, 0>(&world.plant, rows);
            let [position, _] = agent.motion::<P, 0>(&world.plant, rows);
            for c in 0..NC {
                // What is shown has no bounds on its error, so it is worked out once more.
                let agent = &scene.group.agents[a];
                let state = agent.channels[c].at::<0>();
                let [f1_hat, f2_hat] = ChannelGains::<f32>::fault_estimates(state);
                let again = [
                    position[c] - state[1],
                    position[c],
                    state[1],
                    state[2],
                    state[4],
                    response.error_acceleration[c] - response.applied_feedback[c],
                    f1_hat,
                    agent.signals.sensor_fault[c] + off[c][1],
                    f2_hat,
                    response.command[c],
                ];
                let (shown, _) = &shown[a][c];
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
                    assert_eq!(number.value, shown.value);
                    scene.answer_number(a, c, number);
                }
            }
        }
    })
}
