//! Friction: what slows a channel down, which the controller's model does not have.
//!
//! At the rate x' of its channel it is the force (or torque)
//!
//! F = - coulomb tanh(x' / smoothing_rate) - viscous x',
//!
//! Coulomb's friction smoothed over a small rate, since a law that jumps has no solution where a joint sticks: instead
//! of sticking it creeps, with `coulomb / smoothing_rate` as its damping. The rate is the true one, at every stage of a
//! step. The Coulomb part is the same under every load.

use crate::model::lanes::Lane;

/// What slows a channel down.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Friction<L> {
    /// The force at large rates, N or N m.
    pub(crate) coulomb: L,
    /// 1 / the rate within which it changes its sign, s/m or s/rad.
    pub(crate) inverse_smoothing: L,
    /// N s/m or N m s/rad.
    pub(crate) viscous: L,
}

/// The force of all frictions on channel number `c` at its rate.
#[inline(always)]
pub(crate) fn friction_force<L: Lane, const NC: usize>(
    frictions: &[[Friction<L>; NC]],
    c: usize,
    rate: L,
) -> L {
    let mut force = L::number(0.0);
    for friction in frictions {
        let slip = (rate * friction[c].inverse_smoothing).tanh();
        force = slip.mul_add(-friction[c].coulomb, force);
        force = rate.mul_add(-friction[c].viscous, force);
    }
    force
}
