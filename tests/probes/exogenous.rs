//! Probes of shaders/exogenous.wgsl and metric.wgsl: what acts on a channel, and what is kept of it.

use super::harness::{Compared, Expected, Lab};
use super::loops::{nothing, sized};
use super::numbers::Numbers;
use super::tracked::Tracked;
use super::windows::moment;
use super::world::{Flies, Scene, World, episode};
use crate::backend::gpu::layout::NEVER;
use crate::model::exogenous::ExogenousInputs;
use crate::model::exogenous::actuator::Actuator;
use crate::model::exogenous::lists::turned;
use crate::model::exogenous::lists::{Item, Oscillation};
use crate::model::lanes::{Lane, MAX_WIDTH};
use crate::model::metric::Sample;

/// The first step after `step` at which a switch of a channel turns.
pub(super) fn next_change<const NC: usize>(
    signals: &ExogenousInputs<Tracked, NC>,
    c: usize,
    step: u32,
) -> u32 {
    let windows = signals.lists.items().map(|item| item.window(c));
    windows
        .flat_map(|switch| [switch.onset, switch.end])
        .filter(|turn| turn.value.is_finite())
        .map(|turn| turn.value as u32)
        .filter(|&turn| turn > step)
        .min()
        .unwrap_or(NEVER)
}

/// All waves.
fn waves_mut<const NC: usize>(
    signals: &mut ExogenousInputs<Tracked, NC>,
) -> impl Iterator<Item = &mut [Oscillation<Tracked>; NC]> {
    signals.lists.waves_mut().into_iter().flatten()
}

/// Moves the phases of an agent's signals to the start of a step, half step by half step.
pub(super) fn begin<const NC: usize>(signals: &mut ExogenousInputs<Tracked, NC>, step: u32) {
    for wave in waves_mut(signals).flatten() {
        for _ in 0..2 * step {
            wave.phase = Tracked::turns_add(wave.phase, wave.advance);
        }
    }
}

pub(super) fn begun<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        exogenous_inputs_begin(step);
        answer_number(0u, constant);
        answer_number(1u, ground);
        answer(2u, select(0u, 1u, exogenous_inputs_ticks(step)));
        for (var k = 0u; k < N_WAVES; k++) {
            answer_number(3u + 2u * k, waves[k].inverse_smoothing);
            answer(4u + 2u * k, waves[k].advance);
        }";
    let [_, count, _] = world.shape.lists.groups();
    world.check(lab, body, 3 + 2 * count, nothing, |scene| {
        let step = scene.step;
        for agent in &mut scene.group.agents {
            begin(&mut agent.signals, step);
            agent.signals.actuator = Actuator::sound();
            for wave in waves_mut(&mut agent.signals).flatten() {
                wave.held = Tracked::exact(0.0);
            }
        }
        scene.each(|scene, a, c| {
            let signals = scene.group.agents[a].signals.clone();
            scene.answer_number(a, c, signals.constant[c]);
            scene.answer_number(a, c, signals.ground[c]);
            scene.answer(a, c, Expected::Bits(u32::from(signals.ticks(step))));
            for item in signals.lists.items() {
                if let Item::Oscillation(wave) = item {
                    scene.answer_number(a, c, wave[c].inverse_smoothing);
                    scene.answer(a, c, Expected::Bits(wave[c].advance));
                }
            }
        });
    })
}

/// The episode of a scene in every lane.
pub(super) fn episodes(scene: usize) -> [u32; MAX_WIDTH] {
    [episode(scene); MAX_WIDTH]
}

/// The sum of the team's last commands, which each channel is given as its first input.
fn team<const NC: usize, const NS: usize, const NX: usize>(
    scene: &Scene<NC, NS, NX>,
    agent: usize,
) -> [Tracked; NC] {
    std::array::from_fn(|c| scene.number(agent, c, 0))
}

pub(super) fn held<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "load(); exogenous_inputs_hold(step, number(0u));";
    world.check(lab, body, 0, sized([3.0]), |scene| {
        let (step, episodes) = (scene.step, episodes(scene.index));
        for a in 0..world.shape.team {
            let team = team(scene, a);
            let signals = &mut scene.group.agents[a].signals;
            signals.hold(step, &team, world.seed, &episodes);
        }
    })
}

/// What is held of the commands alone, then what is held of the measurements, in two probes.
pub(super) fn held_apart<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "load(); hold_command(step, number(0u));";
    let mut all = world.check(lab, body, 0, sized([3.0]), |scene| {
        let (step, episodes) = (scene.step, episodes(scene.index));
        scene.each(|scene, a, c| {
            let team = scene.number(a, c, 0);
            let signals = &mut scene.group.agents[a].signals;
            signals.hold_command(c, step, team, world.seed, &episodes);
        });
    });
    let body = "load(); hold_sensor(step);";
    all.add(world.check(lab, body, 0, nothing, |scene| {
        let (step, episodes) = (scene.step, episodes(scene.index));
        scene.each(|scene, a, c| {
            let signals = &mut scene.group.agents[a].signals;
            signals.hold_sensor(c, step, world.seed, &episodes);
        });
    }));
    all
}

pub(super) fn evaluated<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "load(); exogenous_inputs_evaluate(step, (stage + 1u) / 2u);";
    world.check(lab, body, 0, nothing, |scene| {
        let (step, moment) = (scene.step, moment(scene.stage));
        for agent in &mut scene.group.agents {
            agent.signals.evaluate(step, moment);
        }
    })
}

pub(super) fn turns<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        for (var k = 0u; k < N_WAVES; k++) { answer_number(k, oscillation_turned(k, stage % 2u == 1u)); }";
    let [_, count, _] = world.shape.lists.groups();
    world.check(lab, body, count, nothing, |scene| {
        let advance = scene.stage % 2 == 1;
        scene.each(|scene, a, c| {
            let signals = &mut scene.group.agents[a].signals;
            let sines = waves_mut(signals).map(|wave| turned(&mut wave[c], advance));
            for sine in sines.collect::<Vec<_>>() {
                scene.answer_number(a, c, sine);
            }
        });
    })
}

/// What becomes of a command on its way, beside its gain and bias.
pub(super) fn commands<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        carry_command(step, (stage + 1u) / 2u);
        limit_rate(step, (stage + 1u) / 2u);";
    world.check(lab, body, 0, nothing, |scene| {
        let (step, moment) = (scene.step, moment(scene.stage));
        for agent in &mut scene.group.agents {
            agent.signals.carry_command(step, moment);
            agent.signals.limit_rate(step, moment);
        }
    })
}

pub(super) fn measured<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        let seen = measure((stage + 1u) / 2u, vec2(number(0u), number(1u)));
        answer_number(0u, seen.x);
        answer_number(1u, seen.y);";
    world.check(lab, body, 2, sized([1.0, 2.0]), |scene| {
        let moment = moment(scene.stage);
        scene.each(|scene, a, c| {
            let motion = scene.numbers(a, c);
            for number in scene.group.agents[a].signals.measure(c, moment, motion) {
                scene.answer_number(a, c, number);
            }
        });
    })
}

pub(super) fn remembered<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        exogenous_inputs_remember(step, number(0u), vec2(number(1u), number(2u)));";
    world.check(lab, body, 0, sized([3.0, 1.0, 2.0]), |scene| {
        let step = scene.step;
        scene.each(|scene, a, c| {
            let [sent, position, velocity] = scene.numbers(a, c);
            let signals = &mut scene.group.agents[a].signals;
            signals.remember(c, step, sent, [position, velocity]);
        });
    })
}

pub(super) fn metrics<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        let sample = Sample(number(0u), number(5u), number(1u), number(2u), number(3u), number(4u));
        metrics_take(sample, step >= 500u, own.limits.y, i32(step));";
    let inputs = |n: &mut Numbers, c: usize| {
        let mut words = sized([1.0, 2.0, 1.0, 1.0, 1.0, 3.0])(n, c);
        // At the limit and just beyond it, and what is not cut or not a number.
        let settled = world.limits[c].settled_error;
        let error = f32::from_bits(words[0]);
        let far = f32::INFINITY;
        words[0] = n
            .one_of(&[error, error, settled, -settled, settled.next_up(), far])
            .to_bits();
        words[2] = n.one_of(&[words[2], 0, 0x8000_0000]);
        words
    };
    world.check(lab, body, 0, inputs, |scene| {
        let step = scene.step;
        let now = Tracked::number(f64::from(step));
        scene.each(|scene, a, c| {
            let [
                error,
                command,
                excess,
                actuator_fault_error,
                sensor_fault_error,
                error_rate,
            ] = scene.numbers(a, c);
            let sample = Sample {
                error,
                error_rate,
                command,
                excess,
                actuator_fault_error,
                sensor_fault_error,
            };
            let metrics = &mut scene.group.agents[a].metrics[c];
            let settled = world.limits[c].settled_error;
            match (step >= 500, P::LIMITED) {
                (false, false) => metrics.take::<false, false>(&sample, settled, now),
                (false, true) => metrics.take::<false, true>(&sample, settled, now),
                (true, false) => metrics.take::<true, false>(&sample, settled, now),
                (true, true) => metrics.take::<true, true>(&sample, settled, now),
            }
        });
    })
}

pub(super) fn flushed<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    world.check(lab, "load(); metrics_flush();", 0, nothing, |scene| {
        scene.group.flush();
    })
}

pub(super) fn added<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "load(); add_to_total(2u, number(0u));";
    world.check(lab, body, 0, sized([3.0]), |scene| {
        scene.each(|scene, a, c| {
            let more = scene.number(a, c, 0);
            let effort = &mut scene.group.agents[a].metrics[c].total.effort;
            *effort = *effort + more;
        });
    })
}

pub(super) fn before_fault<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "load(); metrics_before_fault(own.first_fault, step);";
    world.check(lab, body, 0, nothing, |scene| {
        let step = Tracked::number(f64::from(scene.step));
        for agent in &mut scene.group.agents {
            for metrics in &mut agent.metrics {
                metrics.before_fault(agent.first_fault, step);
            }
        }
    })
}
