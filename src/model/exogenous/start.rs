//! What acts on one agent's channels at t = 0, from where its observers start.

use super::delay_line::Moment;
use super::inputs::ExogenousInputs;
use super::kernels::distortion;
use crate::model::lanes::{Lane, MAX_WIDTH};

impl<L: Lane, const NC: usize> ExogenousInputs<L, NC> {
    /// f2 at t = 0, and by how much x and x' are measured too large then: what the observers' first measurement
    /// includes.
    pub(crate) fn at_start(
        mut self,
        [reference, reference_rate]: [[L; NC]; 2],
        initial: &[[L; 3]; NC],
        seed: u64,
        episodes: &[u32; MAX_WIDTH],
    ) -> ([L; NC], [[L; 2]; NC]) {
        self.hold(0, &[L::number(0.0); NC], seed, episodes);
        self.evaluate(0, Moment::Start);
        let position = std::array::from_fn(|c| reference[c] + initial[c][1]);
        let velocity = std::array::from_fn(|c| reference_rate[c] + initial[c][2]);
        let off = distortion(&self, Moment::Start, &[position, velocity]);
        (self.sensor_fault, off)
    }
}
