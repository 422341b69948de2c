//! Probes of shaders/signal.wgsl and metric.wgsl: what acts on a channel, and what is kept of it.

use super::harness::{Compared, Expected, Lab};
use super::loops::{nothing, sized};
use super::numbers::Numbers;
use super::tracked::Tracked;
use super::world::{Flies, World, episode};
use crate::backend::gpu::words::NEVER;
use crate::model::lanes::{Lane, MAX_WIDTH};
use crate::model::metric::Sample;
use crate::model::signal::{Signals, Switch};

/// All switches of a channel, in the order of their words.
pub(super) fn switches<const NC: usize>(
    signals: &Signals<Tracked, NC>,
    c: usize,
) -> Vec<Switch<Tracked>> {
    let plain = [
        &signals.losses,
        &signals.command_biases,
        &signals.sensor_biases,
    ];
    let plain = plain.into_iter().flatten().map(|switch| switch[c]);
    let noises = signals.noises.iter().map(|noise| noise.switch[c]);
    let squares = signals.squares.iter().map(|square| square[c].switch);
    plain.chain(noises).chain(squares).collect()
}

/// The first of some steps that comes after a step.
pub(super) fn next(steps: impl Iterator<Item = Tracked>, step: u32) -> u32 {
    steps
        .filter(|onset| onset.value.is_finite())
        .map(|onset| onset.value as u32)
        .filter(|&onset| onset > step)
        .min()
        .unwrap_or(NEVER)
}

pub(super) fn switched<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        for (var k = 0u; k < N_SWITCHES; k++) { answer_number(k, switch_at(k, step)); }
        answer(N_SWITCHES, next_onset(step));";
    let count = world.shape.words().named();
    let count = count
        .iter()
        .find(|(name, _)| *name == "N_SWITCHES")
        .unwrap()
        .1;
    world.check(lab, body, count + 1, nothing, |scene| {
        let step = scene.step;
        scene.each(|scene, a, c| {
            let switches = switches(&scene.group.agents[a].signals, c);
            for switch in &switches {
                let value = switch.at(Tracked::number(f64::from(step)), Tracked::exact(0.0));
                scene.answer_number(a, c, value);
            }
            let next = next(switches.iter().map(|switch| switch.onset), step);
            scene.answer(a, c, Expected::Bits(next));
        });
    })
}

/// Moves the phases of an agent's signals to the start of a step, half step by half step.
pub(super) fn begin<const NC: usize>(signals: &mut Signals<Tracked, NC>, step: u32) {
    for _ in 0..2 * step {
        for sine in signals.sines.as_flattened_mut() {
            sine.phase = Tracked::turns_add(sine.phase, sine.advance);
        }
        for square in signals.squares.as_flattened_mut() {
            square.phase = Tracked::turns_add(square.phase, square.advance);
        }
    }
}

pub(super) fn begun<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        signals_begin(step);
        answer_number(0u, constant);
        answer_number(1u, ground);
        var at = 2u;
        for (var k = 0u; k < N_SINES; k++) {
            answer_number(at, sines[k].amplitude);
            answer(at + 1u, sines[k].advance);
            at += 2u;
        }
        for (var k = 0u; k < N_SQUARES; k++) {
            answer_number(at, squares[k].inverse_smoothing);
            answer(at + 1u, squares[k].advance);
            at += 2u;
        }";
    let counts = world.shape.counts;
    let answers = 2 + 2 * (counts.sines + counts.squares);
    world.check(lab, body, answers, nothing, |scene| {
        let step = scene.step;
        for agent in &mut scene.group.agents {
            begin(&mut agent.signals, step);
            for square in agent.signals.squares.as_flattened_mut() {
                square.held = Tracked::exact(0.0);
            }
        }
        scene.each(|scene, a, c| {
            let signals = scene.group.agents[a].signals.clone();
            scene.answer_number(a, c, signals.constant[c]);
            scene.answer_number(a, c, signals.ground[c]);
            for sine in &signals.sines {
                scene.answer_number(a, c, sine[c].amplitude);
                scene.answer(a, c, Expected::Bits(sine[c].advance));
            }
            for square in &signals.squares {
                scene.answer_number(a, c, square[c].inverse_smoothing);
                scene.answer(a, c, Expected::Bits(square[c].advance));
            }
        });
    })
}

pub(super) fn held<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    world.check(lab, "load(); signals_hold(step);", 0, nothing, |scene| {
        let (step, episodes) = (scene.step, episodes(scene.index));
        for agent in &mut scene.group.agents {
            agent.signals.hold(step, world.seed, &episodes);
        }
    })
}

/// The episode of a scene in every lane.
fn episodes(scene: usize) -> [u32; MAX_WIDTH] {
    [episode(scene); MAX_WIDTH]
}

pub(super) fn evaluated<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    // The first stage of a step does not move on.
    let body = "load(); signals_evaluate(stage != 0u);";
    world.check(lab, body, 0, nothing, |scene| {
        for agent in &mut scene.group.agents {
            if scene.stage == 0 {
                agent.signals.evaluate::<false>();
            } else {
                agent.signals.evaluate::<true>();
            }
        }
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
            for (index, noise) in (step..).zip(&mut agent.signals.noises) {
                for c in 0..NC {
                    noise.draw(c, index, world.seed, &episodes);
                }
            }
        }
    })
}

pub(super) fn pairs<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        noise_pair(SAMPLES + 2u, asked(0u), asked(1u));";
    let inputs = |n: &mut Numbers, _: usize| {
        vec![
            n.one_of(&[0, u32::MAX, 0x8000_0000, 0x1234_5678]) ^ (n.word() >> 12),
            n.word(),
        ]
    };
    world.check(lab, body, 0, inputs, |scene| {
        scene.each(|scene, a, c| {
            let (word, turn) = (scene.word(a, c, 0), scene.word(a, c, 1));
            let radius = (Tracked::unit_from_words(&[word]).ln() * Tracked::exact(-2.0)).sqrt();
            let quarter = Tracked::turns(&[0.25]);
            let samples = &mut scene.group.agents[a].signals.noises[0].samples[c];
            samples[2] = radius * Tracked::turns_sin(turn);
            samples[3] = radius * Tracked::turns_sin(Tracked::turns_add(turn, quarter));
        });
    })
}

pub(super) fn metrics<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        let sample = Sample(number(0u), number(1u), number(2u), number(3u), number(4u));
        metrics_take(sample, step >= 500u, own.limits.y, i32(step));";
    let inputs = |n: &mut Numbers, c: usize| {
        let mut words = sized([1.0, 2.0, 1.0, 1.0, 1.0])(n, c);
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
            ] = scene.numbers(a, c);
            let sample = Sample {
                error,
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
