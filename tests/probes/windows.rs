//! Probes of shaders/window.wgsl, delay_line.wgsl and noise.wgsl: when faults are there, what is remembered, and what
//! is random in every step.

use super::exogenous::{episodes, next_change};
use super::harness::{Compared, Expected, Lab};
use super::loops::{nothing, sized};
use super::numbers::Numbers;
use super::tracked::Tracked;
use super::world::{Flies, World};
use crate::draw::member;
use crate::model::exogenous::delay_line::Moment;
use crate::model::exogenous::lists::Item;
use crate::model::exogenous::noise::normal_pair;
use crate::model::lanes::{Lane, MAX_WIDTH};

/// The moment of a stage.
pub(super) fn moment(stage: usize) -> Moment {
    [Moment::Start, Moment::Middle, Moment::Middle, Moment::End][stage]
}

pub(super) fn switched<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        for (var k = 0u; k < N_SWITCHES; k++) {
            answer_number(3u * k, window_weight(k, step));
            answer_number(3u * k + 1u, window_value(k));
            answer_number(3u * k + 2u, window_at(k, step));
        }
        answer(3u * N_SWITCHES, next_change(step));";
    let count = 3 * world.shape.lists.switches() + 1;
    world.check(lab, body, count, nothing, |scene| {
        let (step, now) = (scene.step, Tracked::number(f64::from(scene.step)));
        scene.each(|scene, a, c| {
            let signals = &scene.group.agents[a].signals;
            let next = next_change(signals, c, step);
            let windows = signals.lists.items().map(|item| item.window(c));
            let numbers = windows.map(|window| [window.weight(now), window.value, window.at(now)]);
            for number in numbers.collect::<Vec<_>>().into_iter().flatten() {
                scene.answer_number(a, c, number);
            }
            scene.answer(a, c, Expected::Bits(next));
        });
    })
}

pub(super) fn burst<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        for (var k = INTERMITTENTS; k < SINES; k++) {
            let burst = intermittent_window_at(k, step);
            answer_number(2u * (k - INTERMITTENTS), burst.x);
            answer_number(2u * (k - INTERMITTENTS) + 1u, burst.y);
        }
        answer(2u * (SINES - INTERMITTENTS), own_member());";
    let [count, ..] = world.shape.lists.groups();
    world.check(lab, body, 2 * count + 1, nothing, |scene| {
        let (step, episodes) = (scene.step, episodes(scene.index));
        scene.each(|scene, a, c| {
            let all = scene.group.agents[a].signals.lists.items();
            let all = all.filter_map(|item| match item {
                Item::Intermittent(item) => Some(item.at(c, step, world.seed, &episodes)),
                _ => None,
            });
            for number in all.collect::<Vec<_>>().into_iter().flatten() {
                scene.answer_number(a, c, number);
            }
            let agent = world.shape.first_agent + a;
            scene.answer(a, c, Expected::Bits(member(agent, world.first + c)));
        });
    })
}

pub(super) fn actuators<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "load(); answer_number(0u, actuator_command(number(0u)));";
    world.check(lab, body, 1, sized([2.0]), |scene| {
        scene.each(|scene, a, c| {
            let actuator = &scene.group.agents[a].signals.actuator;
            let command = actuator.command(c, scene.number(a, c, 0));
            scene.answer_number(a, c, command);
        });
    })
}

pub(super) fn rings_held<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        for (var k = 0u; k < N_COMMAND_RINGS + N_SENSOR_RINGS; k++) { delay_line_hold(k, step); }";
    world.check(lab, body, 0, nothing, |scene| {
        let step = scene.step;
        scene.each(|scene, a, c| {
            let signals = &mut scene.group.agents[a].signals;
            for ring in &mut signals.lists.command_rings {
                ring.hold(c, step);
            }
            for ring in &mut signals.lists.sensor_rings {
                ring.hold(c, step);
            }
        });
    })
}

/// What is played of each ring; a command has one number, so that its second is zero.
pub(super) fn rings_played<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        for (var k = 0u; k < N_COMMAND_RINGS + N_SENSOR_RINGS; k++) {
            let second = select(0.0, 1.0, k >= N_COMMAND_RINGS);
            let now = vec2(number(0u), number(1u) * second);
            let recalled = delay_line_recall(k, (stage + 1u) / 2u, now);
            let either = delay_line_or_past(k, now, vec2(number(2u), number(3u) * second));
            answer_number(4u * k, recalled.x);
            answer_number(4u * k + 1u, recalled.y);
            answer_number(4u * k + 2u, either.x);
            answer_number(4u * k + 3u, either.y);
        }";
    let [.., count] = world.shape.lists.groups();
    world.check(lab, body, 4 * count, sized([1.0; 4]), |scene| {
        let moment = moment(scene.stage);
        scene.each(|scene, a, c| {
            let [now, now_rate, past, past_rate] = scene.numbers(a, c);
            let (mut answers, none) = (Vec::new(), Tracked::exact(0.0));
            let signals = &scene.group.agents[a].signals;
            for ring in &signals.lists.command_rings {
                let [recalled] = ring.recall(c, moment, [now]);
                let [either] = ring.or_past(c, [now], [past]);
                answers.extend([recalled, none, either, none]);
            }
            for ring in &signals.lists.sensor_rings {
                answers.extend(ring.recall(c, moment, [now, now_rate]));
                answers.extend(ring.or_past(c, [now, now_rate], [past, past_rate]));
            }
            for number in answers {
                scene.answer_number(a, c, number);
            }
        });
    })
}

pub(super) fn rings_recorded<
    P: Flies<NC, NX>,
    const NC: usize,
    const NS: usize,
    const NX: usize,
>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        for (var k = 0u; k < N_COMMAND_RINGS + N_SENSOR_RINGS; k++) {
            delay_line_record(k, step, vec2(number(0u), number(1u)));
        }";
    world.check(lab, body, 0, sized([1.0; 2]), |scene| {
        let step = scene.step;
        scene.each(|scene, a, c| {
            let [now, rate] = scene.numbers(a, c);
            let signals = &mut scene.group.agents[a].signals;
            for ring in &mut signals.lists.command_rings {
                ring.record(c, step, [now]);
            }
            for ring in &mut signals.lists.sensor_rings {
                ring.record(c, step, [now, rate]);
            }
        });
    })
}

/// Where samples are, at steps before and after a ring is full.
pub(super) fn rings_read<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        for (var k = 0u; k < N_COMMAND_RINGS + N_SENSOR_RINGS; k++) {
            let read = delay_line_read(k, asked(0u));
            answer(3u * k, delay_line_place(k, asked(0u)));
            answer_number(3u * k + 1u, read.x);
            answer_number(3u * k + 2u, read.y);
        }";
    let lists = &world.shape.lists;
    let [.., count] = lists.groups();
    let words = world.shape.words().named();
    let (_, samples) = words
        .iter()
        .find(|(name, _)| name == "RINGS_STORED")
        .unwrap();
    let inputs = |n: &mut Numbers, _: usize| vec![n.word() % 30];
    world.check(lab, body, 3 * count, inputs, |scene| {
        scene.each(|scene, a, c| {
            let step = scene.word(a, c, 0);
            let (mut answers, mut first) = (Vec::new(), *samples);
            let signals = &scene.group.agents[a].signals;
            let mut place = |length: u32, signals: usize| {
                let place = first + (step % length) as usize;
                first += signals * lists.ring_steps;
                Expected::Bits(place as u32)
            };
            for ring in &signals.lists.command_rings {
                let [command] = ring.read(c, step);
                let numbers = [command, Tracked::exact(0.0)].map(Expected::Near);
                answers.push(place(ring.length[c][0], 1));
                answers.extend(numbers);
            }
            for ring in &signals.lists.sensor_rings {
                answers.push(place(ring.length[c][0], 2));
                answers.extend(ring.read(c, step).map(Expected::Near));
            }
            for expected in answers {
                scene.answer(a, c, expected);
            }
        });
    })
}

pub(super) fn pairs<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        let pair = normal_pair(asked(0u), asked(1u));
        answer_number(0u, pair.x);
        answer_number(1u, pair.y);";
    let inputs = |n: &mut Numbers, _: usize| {
        vec![
            n.one_of(&[0, u32::MAX, 0x8000_0000, 0x1234_5678]) ^ (n.word() >> 12),
            n.word(),
        ]
    };
    world.check(lab, body, 2, inputs, |scene| {
        scene.each(|scene, a, c| {
            let [word, turn] = [0, 1].map(|k| [scene.word(a, c, k); MAX_WIDTH]);
            for number in normal_pair::<Tracked>(&word, &turn) {
                scene.answer_number(a, c, number);
            }
        });
    })
}

pub(super) fn noise<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "load(); for (var k = 0u; k < N_NOISES; k++) { noise_draw(k, step + k); }";
    world.check(lab, body, 0, nothing, |scene| {
        let (step, episodes) = (scene.step, episodes(scene.index));
        for agent in &mut scene.group.agents {
            for (index, noise) in (step..).zip(&mut agent.signals.lists.noises) {
                for c in 0..NC {
                    noise.draw(c, index, world.seed, &episodes);
                }
            }
        }
    })
}

/// The filters, the force and its step, and the states with which they begin.
pub(super) fn turbulence<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        for (var k = 0u; k < N_TURBULENCES; k++) {
            for (var number = 0u; number < 9u; number++) {
                answer_number(10u * k + number, turbulence_filter(k, number));
            }
            answer_number(10u * k + 9u, turbulence_force(k));
            turbulence_advance(k, step + k);
        }";
    let count = world.shape.lists.turbulence_entries.len();
    world.check(lab, body, 10 * count, nothing, |scene| {
        let (step, episodes) = (scene.step, episodes(scene.index));
        for a in 0..world.shape.team {
            let at_start = world
                .condition::<Tracked>(scene.index, a)
                .signals
                .turbulences;
            for (k, at_start) in (0..).zip(at_start) {
                for c in 0..NC {
                    let turbulence = &mut scene.group.agents[a].signals.turbulences[k as usize];
                    let (filter, force) = (turbulence.filter[c], turbulence.force(c));
                    turbulence.advance(c, step + k, world.seed, &episodes);
                    let fixed = [filter.keep, filter.cross].into_iter().chain(filter.noise);
                    let numbers = fixed.chain(filter.output).chain(at_start.state[c]);
                    for number in numbers.chain([force]) {
                        scene.answer_number(a, c, number);
                    }
                }
            }
        }
    })
}
