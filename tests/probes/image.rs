//! The image of an agent's channel: its state as words, in the order in which probe.wgsl loads and leaves it, and as it
//! is kept between spans.

use super::harness::Expected;
use super::tracked::Tracked;
use crate::backend::gpu::layout::{N_EXTREMES, N_SUMS};
use crate::backend::gpu::signals::Lists;
use crate::model::agent::Agent;
use crate::model::controller::observer_feedback::FTC_STATES;
use crate::model::exogenous::delay_line::DelayLine;
use crate::model::exogenous::lists::Item;

/// Words of the image that every shape has, before its waves and rings.
const FIXED_IMAGE: usize = 62 + N_EXTREMES + N_SUMS;
/// Where in the image it is told when the channel failed.
pub(super) const FAILED: usize = 43;
/// Where it is told when the error was last outside, at all and before the first fault.
const OUTSIDE: usize = 41;
/// States that the shaders have room for.
const STATES: usize = FTC_STATES + 2;
/// Where the command filter's states are.
const EXTRA: usize = FTC_STATES;

/// Words of the image.
pub(super) fn image_words(lists: &Lists) -> usize {
    let [_, waves, rings] = lists.groups();
    FIXED_IMAGE + 2 * waves + 5 * rings
}

/// The image of an agent's channel.
pub(super) fn image<const NC: usize, const NS: usize, const NX: usize>(
    agent: &Agent<Tracked, NC, NS, NX>,
    c: usize,
    next_change: Expected,
) -> Vec<Expected> {
    use Expected::{Any, Bits, First, Last, Near};
    let mut words = Vec::new();
    let states = |of: &[Tracked; NS], extra: &[Tracked; NX]| {
        let mut states = [Near(Tracked::exact(0.0)); STATES];
        for (state, &value) in states.iter_mut().zip(of) {
            *state = Near(value);
        }
        match (NX, c) {
            // The command filter's angle and rate of roll and of pitch.
            (4, 3 | 4) => {
                (states[EXTRA], states[EXTRA + 1]) = (Near(extra[c - 3]), Near(extra[c - 1]));
            }
            // What the shader integrates of yaw, nobody reads.
            (4, 5) => (states[EXTRA], states[EXTRA + 1]) = (Any, Any),
            _ => {}
        }
        states
    };
    let (channel, extra) = (&agent.channels[c], &agent.extra);
    words.extend(states(&channel.start, &extra.start));
    words.extend(states(&channel.point, &extra.point));
    words.extend(states(&channel.sum, &extra.sum));
    let signals = &agent.signals;
    for held in [
        signals.disturbance,
        signals.sensor_fault,
        signals.command.gain,
        signals.command.bias,
        signals.held_sensor,
    ] {
        words.push(Near(held[c]));
    }
    let metrics = &agent.metrics[c];
    words.extend([metrics.outside, metrics.outside_before_fault].map(Last));
    words.extend([First(agent.failed), next_change]);
    for held in [
        signals.held_disturbance,
        signals.scale,
        signals.frozen,
        signals.inverse_inertia,
        signals.actuator.gain,
        signals.actuator.bias,
        signals.actuator.low,
        signals.actuator.high,
        signals.last_command,
        agent.held_feedback,
        signals.command.slew,
        signals.command.blocked,
        signals.last_sent,
        signals.last_arrived,
    ] {
        words.push(Near(held[c]));
    }
    words.extend(signals.last_measured[c].map(Near));
    let acting = signals.actuator.dead_zone;
    words.push(Near(acting.map_or(Tracked::exact(0.0), |zone| zone[c])));
    words.extend(metrics.largest.numbers().into_iter().map(Near));
    words.extend(metrics.recent.numbers().into_iter().map(Near));
    let none = Tracked::exact(0.0);
    for item in signals.lists.items() {
        match item {
            Item::Plain(_) | Item::Noise(_) | Item::Intermittent(_) => {}
            Item::Oscillation(wave) => words.extend([Bits(wave[c].phase), Near(wave[c].held)]),
            Item::CommandLine(line) => {
                let [[start], [end]] = line.past[c];
                words.extend([line.plays[c], start, none, end, none].map(Near));
            }
            Item::MeasurementLine(line) => {
                words.push(Near(line.plays[c]));
                words.extend(line.past[c].as_flattened().iter().copied().map(Near));
            }
        }
    }
    words
}

/// The words of an agent's channel in the state buffer, in the order of `Layout::named`, and of each whether it is
/// there all the time, and not only between two spans.
pub(super) fn stored<const NC: usize, const NS: usize, const NX: usize>(
    agent: &Agent<Tracked, NC, NS, NX>,
    c: usize,
    lists: &Lists,
) -> Vec<(Expected, bool)> {
    use Expected::Near;
    let image = image(agent, c, Expected::Any);
    let metrics = &agent.metrics[c];
    let signals = &agent.signals;
    // The verdict, the extremes and the recent sums; see `Layout::named`.
    let mut kept = vec![image[FAILED], image[OUTSIDE], image[OUTSIDE + 1]];
    kept.extend(metrics.largest.numbers().into_iter().map(Near));
    kept.extend(metrics.recent.numbers().into_iter().map(Near));
    let totals: Vec<_> = metrics.total.numbers().into_iter().map(Near).collect();
    let channel = &image[..if NX == 0 { FTC_STATES } else { STATES }];
    let mut there: Vec<Expected> = Vec::new();
    for noise in &signals.lists.noises {
        there.extend(noise.samples[c].map(Near));
    }
    for turbulence in &signals.turbulences {
        there.extend(turbulence.state[c].map(Near));
    }
    let [position, velocity] = signals.last_measured[c];
    let memory = [
        signals.last_command[c],
        position,
        velocity,
        agent.held_feedback[c],
        signals.last_sent[c],
        signals.last_arrived[c],
    ]
    .map(Near);
    let memory: &[Expected] = if lists.remembers { &memory } else { &[] };
    let mut samples = Vec::new();
    for ring in &signals.lists.command_rings {
        samples.extend(ring_samples(ring, c, lists.ring_steps));
    }
    for ring in &signals.lists.sensor_rings {
        samples.extend(ring_samples(ring, c, lists.ring_steps));
    }
    let between = |words: &[Expected]| words.iter().map(|&word| (word, false)).collect::<Vec<_>>();
    let always = |words: &[Expected]| words.iter().map(|&word| (word, true)).collect::<Vec<_>>();
    [
        between(&kept),
        always(&totals),
        between(channel),
        always(&there),
        between(memory),
        always(&samples),
    ]
    .concat()
}

/// The samples of a channel's ring, signal by signal; places beyond its length stay as they were, at zero.
fn ring_samples<const NC: usize, const NV: usize>(
    ring: &DelayLine<Tracked, NC, NV>,
    c: usize,
    places: usize,
) -> Vec<Expected> {
    let length = ring.length[c][0];
    let mut samples = vec![Expected::Bits(0); NV * places];
    for place in 0..length {
        // At this step it is the oldest.
        let sample = ring.read(c, length + place);
        for (v, &number) in sample.iter().enumerate() {
            samples[v * places + place as usize] = Expected::Near(number);
        }
    }
    samples
}
