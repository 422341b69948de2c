//! The classical fourth-order Runge-Kutta method (Hairer, Norsett, Wanner, Solving ODEs I, section II.1), with the
//! weighted sum of the slopes kept instead of the slopes themselves.

use super::lanes::{Lane, Real};

/// A state of `N` numbers while a step is taken.
#[derive(Clone, Copy)]
pub(crate) struct Stepped<L, const N: usize> {
    /// The state at the start of the step.
    pub(crate) start: [L; N],
    /// The state at which the current stage's slope is taken.
    pub(crate) point: [L; N],
    /// start + h/6 (k1 + 2 k2 + ..), as far as the stages went.
    pub(crate) sum: [L; N],
}

/// h/6, h/3, h/2 and h of a step h.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step<R> {
    pub(crate) sixth: R,
    pub(crate) third: R,
    pub(crate) half: R,
    pub(crate) whole: R,
}

impl<R: Real> Step<R> {
    pub(crate) fn new(step_s: f64) -> Self {
        Self {
            sixth: R::from_f64(step_s / 6.0),
            third: R::from_f64(step_s / 3.0),
            half: R::from_f64(step_s / 2.0),
            whole: R::from_f64(step_s),
        }
    }
}

impl<L: Lane, const N: usize> Stepped<L, N> {
    pub(crate) fn new(start: [L; N]) -> Self {
        Self {
            start,
            point: start,
            sum: start,
        }
    }

    /// The state whose slope stage `STAGE` (0 to 3) takes.
    #[inline(always)]
    pub(crate) fn at<const STAGE: usize>(&self) -> &[L; N] {
        if STAGE == 0 { &self.start } else { &self.point }
    }

    /// Takes in the slope of state `k` at stage `STAGE`; the last stage ends the step.
    #[inline(always)]
    pub(crate) fn take<const STAGE: usize>(&mut self, k: usize, slope: L, h: &Step<L::Real>) {
        let (sixth, third) = (L::splat(h.sixth), L::splat(h.third));
        let ahead = L::splat(if STAGE < 2 { h.half } else { h.whole });
        match STAGE {
            0 => {
                self.sum[k] = slope.mul_add(sixth, self.start[k]);
                self.point[k] = slope.mul_add(ahead, self.start[k]);
            }
            1 | 2 => {
                self.sum[k] = slope.mul_add(third, self.sum[k]);
                self.point[k] = slope.mul_add(ahead, self.start[k]);
            }
            _ => self.start[k] = slope.mul_add(sixth, self.sum[k]),
        }
    }
}
