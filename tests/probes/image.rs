//! The image of an agent's channel: its state as words, in the order in which probe.wgsl loads and leaves it, and as it is
//! kept between spans.

use super::harness::Expected;
use super::tracked::Tracked;
use crate::model::controller::FTC_STATES;
use crate::model::group::Agent;
use crate::model::metric::Sums;

/// Words of the image that every shape has, before the phases of its signals.
pub(super) const FIXED_IMAGE: usize = 53;
/// Where in the image it is told when the channel failed.
pub(super) const FAILED: usize = 51;
/// States that the shaders have room for.
const STATES: usize = FTC_STATES + 2;
/// Where the command filter's states are.
const EXTRA: usize = FTC_STATES;

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
        signals.command_gain,
        signals.command_bias,
        signals.held_sensor,
    ] {
        words.push(Near(held[c]));
    }
    let metrics = &agent.metrics[c];
    words.extend(sums(&metrics.recent).map(Near));
    words.extend([metrics.largest, metrics.largest_command].map(Near));
    words.extend([metrics.outside, metrics.outside_before_fault].map(Last));
    words.extend([First(agent.failed), next_change]);
    words.extend(signals.sines.iter().map(|sine| Bits(sine[c].phase)));
    for square in &signals.squares {
        words.extend([Bits(square[c].phase), Near(square[c].held)]);
    }
    words
}

/// The words of an agent's channel between two spans, in the order of `Words::named`.
pub(super) fn stored<const NC: usize, const NS: usize, const NX: usize>(
    agent: &Agent<Tracked, NC, NS, NX>,
    c: usize,
) -> Vec<Expected> {
    use Expected::Near;
    let image = image(agent, c, Expected::Any);
    // Of the verdict and the extremes; see `Words::named`.
    let mut stored = vec![image[51], image[49], image[50], image[47], image[48]];
    stored.extend(&image[41..47]);
    stored.extend(sums(&agent.metrics[c].total).map(Near));
    stored.extend(&image[..if NX == 0 { FTC_STATES } else { STATES }]);
    for noise in &agent.signals.noises {
        stored.extend(noise.samples[c].map(Near));
    }
    stored
}

fn sums(sums: &Sums<Tracked>) -> [Tracked; 6] {
    [
        sums.square,
        sums.absolute,
        sums.effort,
        sums.actuator_fault,
        sums.sensor_fault,
        sums.limited,
    ]
}
