//! The way of a command from the controller to the plant.
//!
//! 1. The controller computes its demand. A sampled one does so at its ticks, and sends the same from one to the
//!    next.
//! 2. The link carries what is sent: it delays and replays it, and where it is blocked, what arrived last stays.
//! 3. The actuator makes of what arrives what acts, anew at every stage: losses, what is added, hard-over, dead zone;
//!    at last, the acting command changes from step to step by no more than its rate, and by nothing where it is stuck.
//!
//! So only the limits of rate remember what acted; all else that is held lies before the actuator.

#![expect(
    clippy::needless_range_loop,
    reason = "a channel is one index of several arrays, as in the shaders"
)]

use super::delay_line::Moment;
use super::inputs::ExogenousInputs;
use super::lists::turned;
use crate::model::lanes::{Lane, MAX_WIDTH, Real};

impl<L: Lane, const NC: usize> ExogenousInputs<L, NC> {
    /// Sets what a channel's faults do to its command in step number `step`; `team` is the sum of the team's last
    /// commands.
    #[inline(always)]
    pub(crate) fn hold_command(
        &mut self,
        c: usize,
        step: u32,
        team: L,
        seed: u64,
        episodes: &[u32; MAX_WIDTH],
    ) {
        let (zero, one) = (L::number(0.0), L::number(1.0));
        let now = L::number(f64::from(step));
        let mut gain = one;
        for loss in &self.lists.losses {
            gain = gain * (one - loss[c].at(now));
        }
        for loss in &self.lists.intermittents {
            let [lost, _] = loss.at(c, step, seed, episodes);
            gain = gain * (one - lost);
        }
        let mut bias = zero;
        for added in &self.lists.command_biases {
            bias = bias + added[c].at(now);
        }
        for leak in &self.lists.leaks {
            let others = team - self.last_command[c];
            bias = others.mul_add(leak[c].at(now), bias);
        }
        for over in &self.lists.hard_overs {
            let weight = over[c].weight(now);
            let left = one - weight;
            gain = gain * left;
            bias = over[c].value.mul_add(weight, bias * left);
        }
        self.command.gain[c] = gain;
        self.command.bias[c] = bias;
        let mut slew = L::splat(L::Real::MAX);
        for limit in &self.lists.rate_limits {
            slew = L::select_le(
                L::number(0.5),
                limit[c].weight(now),
                limit[c].value.min(slew),
                slew,
            );
        }
        self.command.slew[c] = slew;
        if !self.lists.dead_zones.is_empty() {
            // Two zones, one after the other, are one as wide as both.
            let mut wide = zero;
            for zone in &self.lists.dead_zones {
                wide = wide + zone[c].at(now);
            }
            self.actuator.dead_zone.get_or_insert([zero; NC])[c] = wide;
        }
        let mut blocked = zero;
        for hold in &self.lists.command_holds {
            let [holds, _] = hold.at(c, step, seed, episodes);
            blocked = blocked.max(holds);
        }
        self.command.blocked[c] = blocked;
        for ring in &mut self.lists.command_rings {
            ring.hold(c, step);
        }
    }

    /// Evaluates the actuators at a moment of step number `step`; the phases of what oscillates have been turned.
    #[inline(always)]
    pub(crate) fn evaluate_command(&mut self, step: u32, moment: Moment) {
        if moment == Moment::Start || !self.lists.command_waves.is_empty() || self.carries() {
            self.actuator.gain = self.command.gain;
            self.actuator.bias = self.command.bias;
        }
        for waves in &mut self.lists.command_waves {
            for c in 0..NC {
                let sine = turned(&mut waves[c], moment != Moment::Start);
                self.actuator.bias[c] = sine.mul_add(waves[c].held, self.actuator.bias[c]);
            }
        }
        if self.carries() {
            self.carry_command(step, moment);
        }
        if !self.lists.rate_limits.is_empty() {
            self.limit_rate(step, moment);
        }
    }

    /// Replaces the demanded command by the one that arrives at the actuator. What a sampled controller sends is
    /// constant within a step, and stays so however late it arrives: delays are whole steps.
    #[inline(always)]
    pub(crate) fn carry_command(&mut self, step: u32, moment: Moment) {
        let (zero, one, half) = (L::number(0.0), L::number(1.0), L::number(0.5));
        let sampled = self.hold_steps > 1;
        let held = sampled && (moment != Moment::Start || !self.ticks(step));
        let recalled = if sampled { Moment::Start } else { moment };
        // What is sent at first arrives, blocked or not: before it there is nothing.
        let first = step == 0 && moment == Moment::Start;
        for c in 0..NC {
            let (mut sent, mut other) = (one, [zero]);
            if held {
                (sent, other) = (zero, [self.last_sent[c]]);
            }
            for ring in &self.lists.command_rings {
                other = ring.recall(c, recalled, other);
                [sent] = ring.or_past(c, [sent], [zero]);
            }
            if !self.lists.command_holds.is_empty() && !first {
                let blocked = self.command.blocked[c];
                other = [L::select_le(half, blocked, self.last_arrived[c], other[0])];
                sent = L::select_le(half, blocked, zero, sent);
            }
            let gain = self.actuator.gain[c];
            self.actuator.bias[c] = other[0].mul_add(gain, self.actuator.bias[c]);
            self.actuator.gain[c] = gain * sent;
        }
    }

    /// Keeps the acting command near the one at the start of the last step; at first, there is none.
    #[inline(always)]
    pub(crate) fn limit_rate(&mut self, step: u32, moment: Moment) {
        for c in 0..NC {
            let slew = match moment {
                Moment::Start if step == 0 => L::splat(L::Real::MAX),
                Moment::Middle => self.command.slew[c] * L::number(0.5),
                Moment::Start | Moment::End => self.command.slew[c],
            };
            self.actuator.low[c] = self.last_command[c] - slew;
            self.actuator.high[c] = self.last_command[c] + slew;
        }
    }

    /// Takes in what was demanded at the start of step number `step`: what of it was sent, and what arrived.
    #[inline(always)]
    pub(crate) fn remember_command(&mut self, c: usize, step: u32, sent: L) {
        if self.ticks(step) {
            self.last_sent[c] = sent;
        }
        let mut carried = [self.last_sent[c]];
        for ring in &mut self.lists.command_rings {
            let recalled = ring.recall(c, Moment::Start, carried);
            ring.record(c, step, carried);
            carried = recalled;
        }
        let (half, last) = (L::number(0.5), self.last_arrived[c]);
        self.last_arrived[c] = if step == 0 {
            carried[0]
        } else {
            L::select_le(half, self.command.blocked[c], last, carried[0])
        };
    }
}
