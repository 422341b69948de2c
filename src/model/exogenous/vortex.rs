//! The jets that rotors blow downwards, in which a UAV is pushed down that flies below another.
//!
//! Agent i, which is below agent j by w = max(z_j - z_i, 0) and beside it by rho, feels along z the force
//!
//! F_i = - force_n sum over the others j of p(rho / radius_m) v(2 w / length_m), where
//!
//! p(s) = 1 / (1 + (sqrt(2) - 1) s^2)^2 and v(x) = 27/4 x^2 / (1 + x)^3.
//!
//! p is the profile of a round jet (Schlichting, Boundary-Layer Theory), which has fallen to one half at `radius_m`. v
//! is what becomes of the jet on its way: it is 1 at its largest, w = `length_m`, and falls like 1 / w further down, as
//! the speed on the axis of a jet does; above, it rises from zero at equal height with a rate of zero, so the force is
//! continuously differentiable when agents climb past each other. Jets of several agents add up. This is how strong the
//! effect is and how far it reaches, not the flow: the jet neither leans, nor follows the thrust, nor tilts whom it
//! hits, and a jet that is still on its way when its rotors have flown on is not remembered.

use crate::model::lanes::Lane;
use std::f64::consts::SQRT_2;

/// How fast the profile of a jet falls.
pub(crate) const JET_SPREAD: f64 = SQRT_2 - 1.0;
/// What makes the largest value of v one.
pub(crate) const JET_PEAK: f64 = 27.0 / 4.0;

/// What an agent feels of the others' jets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vortex<L> {
    /// The largest force of one jet, N.
    pub(crate) force: L,
    /// 1 / radius, 1/m.
    pub(crate) inverse_radius: L,
    /// 2 / length, 1/m.
    pub(crate) inverse_length: L,
}

/// p of the square of s.
#[inline(always)]
pub(crate) fn jet_profile<L: Lane>(s2: L) -> L {
    let one = L::number(1.0);
    let share = one / s2.mul_add(L::number(JET_SPREAD), one);
    share * share
}

/// v. The cube of a distance would leave the singles, so each of its factors is divided.
#[inline(always)]
pub(crate) fn jet_growth<L: Lane>(x: L) -> L {
    let one = L::number(1.0);
    let share = one / (one + x);
    let near = x * share;
    near * near * (share * L::number(JET_PEAK))
}

/// What reaches the place `own` of the jet of an agent at the place `other`, as a share of the largest force.
#[inline(always)]
pub(crate) fn jet_share<L: Lane>(vortex: &Vortex<L>, own: &[L; 3], other: &[L; 3]) -> L {
    let ahead = (other[0] - own[0]) * vortex.inverse_radius;
    let aside = (other[1] - own[1]) * vortex.inverse_radius;
    let above = (other[2] - own[2]).max(L::number(0.0));
    jet_profile(ahead.mul_add(ahead, aside * aside)) * jet_growth(above * vortex.inverse_length)
}

/// The force along z on agent number `own` of those at `places`, N.
#[inline(always)]
pub(crate) fn vortex_force<L: Lane>(vortices: &[Vortex<L>], own: usize, places: &[[L; 3]]) -> L {
    let mut force = L::number(0.0);
    for vortex in vortices {
        let mut sum = L::number(0.0);
        // An agent does not act on itself: its vertical distance is 0.
        for other in places {
            sum = sum + jet_share(vortex, &places[own], other);
        }
        force = sum.mul_add(-vortex.force, force);
    }
    force
}
