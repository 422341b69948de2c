//! What an agent's channels remember of their commands and measurements: whatever freezes, lags, replays or limits the
//! rate.
//!
//! One sample per step, taken at its start, is enough: within a step a delayed signal goes on a straight line from
//! sample to sample, and a command that is limited in its rate may leave the last sample by so much per time. At step 0
//! there is no past, so nothing is recalled or frozen yet, and an actuator begins at what is demanded.

#![expect(
    clippy::needless_range_loop,
    reason = "a channel is one index of several arrays, as in the shaders"
)]

use super::window::Window;
use crate::model::lanes::{Lane, MAX_WIDTH};

/// The last samples of `NV` signals of each channel. A delay reads the oldest and puts the newest in its place; a
/// replay stops recording at its onset, and reads the same samples again and again.
#[derive(Clone)]
pub(crate) struct DelayLine<L, const NC: usize, const NV: usize> {
    /// Whether recording goes on while the past is played.
    pub(crate) records: bool,
    /// When the past is played.
    pub(crate) switch: [Window<L>; NC],
    /// Samples that are kept, at least one, of each lane.
    pub(crate) length: [[u32; MAX_WIDTH]; NC],
    /// The samples, `[channel][place][signal][lane]`.
    samples: Vec<f64>,
    /// Places of each channel.
    places: usize,
    /// Whether the past is played in this step (1 or 0).
    pub(crate) plays: [L; NC],
    /// The past at the start of this step and at its end.
    pub(crate) past: [[[L; NV]; 2]; NC],
}

/// A moment of a step.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Moment {
    Start,
    Middle,
    End,
}

impl<L: Lane, const NC: usize, const NV: usize> DelayLine<L, NC, NV> {
    /// A ring with nothing in it.
    pub(crate) fn new(
        records: bool,
        switch: [Window<L>; NC],
        length: [[u32; MAX_WIDTH]; NC],
    ) -> Self {
        let places = length.as_flattened().iter().copied().max().unwrap_or(1) as usize;
        Self {
            records,
            switch,
            length,
            samples: vec![0.0; NC * places * NV * MAX_WIDTH],
            places,
            plays: [L::number(0.0); NC],
            past: [[[L::number(0.0); NV]; 2]; NC],
        }
    }

    /// Finds out whether the past is played in a step, and what it is at the step's start.
    #[inline(always)]
    pub(crate) fn hold(&mut self, c: usize, step: u32) {
        if step > 0 {
            self.plays[c] = self.switch[c].weight(L::number(f64::from(step)));
            self.past[c][0] = self.read(c, step);
        }
    }

    /// The past at a moment of the step where it is played, else `now`.
    #[inline(always)]
    pub(crate) fn recall(&self, c: usize, moment: Moment, now: [L; NV]) -> [L; NV] {
        let [mut past, end] = self.past[c];
        for v in 0..NV {
            past[v] = match moment {
                Moment::Start => past[v],
                Moment::Middle => (past[v] + end[v]) * L::number(0.5),
                Moment::End => end[v],
            };
        }
        self.or_past(c, now, past)
    }

    /// `past` where the past is played, else `now`.
    #[inline(always)]
    pub(crate) fn or_past(&self, c: usize, mut now: [L; NV], past: [L; NV]) -> [L; NV] {
        for v in 0..NV {
            now[v] = L::select_le(L::number(0.5), self.plays[c], past[v], now[v]);
        }
        now
    }

    /// Records what was seen at the start of a step, after which the past at its end is known.
    #[inline(always)]
    pub(crate) fn record(&mut self, c: usize, step: u32, now: [L; NV]) {
        let (mut plays, mut seen) = ([0.0; MAX_WIDTH], [[0.0; MAX_WIDTH]; NV]);
        self.plays[c].store(&mut plays);
        for v in 0..NV {
            now[v].store(&mut seen[v]);
        }
        for lane in 0..L::WIDTH {
            if self.records || plays[lane] < 0.5 {
                let place = self.place(c, step, lane);
                for v in 0..NV {
                    self.samples[place + v * MAX_WIDTH] = seen[v][lane];
                }
            }
        }
        self.past[c][1] = self.read(c, step + 1);
    }

    /// The sample that is as old as the ring is long; before there is one, the first.
    #[inline(always)]
    pub(crate) fn read(&self, c: usize, step: u32) -> [L; NV] {
        let mut read = [[0.0; MAX_WIDTH]; NV];
        for lane in 0..L::WIDTH {
            let oldest = if step < self.length[c][lane] { 0 } else { step };
            let place = self.place(c, oldest, lane);
            for v in 0..NV {
                read[v][lane] = self.samples[place + v * MAX_WIDTH];
            }
        }
        let mut loaded = [L::number(0.0); NV];
        for v in 0..NV {
            loaded[v] = L::load(&read[v]);
        }
        loaded
    }

    fn place(&self, c: usize, step: u32, lane: usize) -> usize {
        let place = (step % self.length[c][lane]) as usize;
        (c * self.places + place) * NV * MAX_WIDTH + lane
    }
}
