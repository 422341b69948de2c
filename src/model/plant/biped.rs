//! The biped of (4), one leg at a time: on a pelvis that stands still the legs never act on each other, and the
//! coupling (11) works channel by channel.
//!
//! The table holds three rows of each joint, five where limits cut:
//!
//! | row | |
//! |---|---|
//! | 0 | r, r', r'', M(r) r'' + H(r, r') |
//! | 1, 2 | the joint's row of M(r); J'f of the ground |
//! | 3, 4 | the joint's row of M(r)^-1 |

use super::leg::{LEG_JOINTS, LegJoint, LegModel, forward_dynamics};
use super::{Inputs, Plant, ReferenceRow, Response, tabulated};
use crate::agent::robot::Robot;
use crate::model::lanes::math::clamp;
use crate::model::lanes::{Lane, Real};

/// Rows of a joint in the table.
pub(crate) const fn leg_rows(cut: bool) -> usize {
    if cut { 5 } else { 3 }
}

/// A leg; where `CUT`, its torques stay within the limits of the joints.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LegPlant<R, const CUT: bool> {
    pub(crate) model: LegModel<R>,
    pub(crate) max_torque: [R; LEG_JOINTS],
}

impl<R: Real, const CUT: bool> LegPlant<R, CUT> {
    /// The left or right leg (0, 1) of a robot.
    pub(crate) fn new(robot: &Robot, side: usize) -> Self {
        let joints = &robot.legs[side].joints;
        Self {
            model: LegModel::new(&joints.each_ref().map(LegJoint::from), robot.gravity_m_s2),
            max_torque: joints
                .each_ref()
                .map(|joint| R::from_f64(joint.torque_max_n_m)),
        }
    }
}

/// A joint's row of a matrix, from the first of its two rows of the table on.
#[inline(always)]
pub(crate) fn matrix_row<R: Real>(rows: &[ReferenceRow<R>], first: usize) -> [R; LEG_JOINTS] {
    let [a, b, c, d] = rows[first];
    let [e, f, ..] = rows[first + 1];
    [a, b, c, d, e, f]
}

/// base + row factors.
#[inline(always)]
pub(crate) fn plus_product<L: Lane>(
    base: L,
    row: &[L::Real; LEG_JOINTS],
    factors: &[L; LEG_JOINTS],
) -> L {
    let mut sum = base;
    for k in 0..LEG_JOINTS {
        sum = factors[k].mul_add(L::splat(row[k]), sum);
    }
    sum
}

impl<L: Lane, const CUT: bool> Plant<L, LEG_JOINTS, 0> for LegPlant<L::Real, CUT> {
    const LIMITED: bool = true;
    const ROWS: usize = leg_rows(CUT);

    #[inline(always)]
    fn reference(&self, rows: &[ReferenceRow<L::Real>], _extra: &[L; 0]) -> [[L; LEG_JOINTS]; 2] {
        tabulated(rows, leg_rows(CUT))
    }

    #[inline(always)]
    fn respond(
        &self,
        inputs: &Inputs<'_, L, LEG_JOINTS>,
        _extra: &[L; 0],
    ) -> Response<L, LEG_JOINTS, 0> {
        let zero = [L::number(0.0); LEG_JOINTS];
        let (mut sent, mut command) = (zero, zero);
        let (mut excess, mut torque) = (zero, zero);
        let rows_of = |c: usize| &inputs.reference[leg_rows(CUT) * c..leg_rows(CUT) * (c + 1)];
        for c in 0..LEG_JOINTS {
            // (9): M(r) (r'' + u_fb) + H(r, r').
            let rows = rows_of(c);
            let feedforward = L::splat(rows[0][3]);
            let demanded = plus_product(feedforward, &matrix_row(rows, 1), &inputs.feedback);
            let limit = L::splat(self.max_torque[c]);
            let limited = clamp(demanded, -limit, limit);
            excess[c] = demanded - limited;
            sent[c] = if CUT { limited } else { demanded };
            command[c] = inputs.actuator.command(c, sent[c]);
            // The true robot is the modelled one times a number, so a torque divided by that does the same to the
            // model.
            let force = inputs.ground[c].mul_add(L::splat(rows[2][2]), inputs.force[c]);
            torque[c] = (command[c] + force) * inputs.inverse_inertia[c];
        }
        let acceleration =
            forward_dynamics(&self.model, &inputs.position, &inputs.velocity, &torque);
        let (mut applied_feedback, mut error_acceleration) = (zero, zero);
        for c in 0..LEG_JOINTS {
            let rows = rows_of(c);
            applied_feedback[c] = inputs.feedback[c];
            if CUT {
                // The feedback that would have demanded what the limits left.
                applied_feedback[c] =
                    applied_feedback[c] - plus_product(zero[c], &matrix_row(rows, 3), &excess);
            }
            error_acceleration[c] = acceleration[c] - L::splat(rows[0][2]);
        }
        Response {
            error_acceleration,
            applied_feedback,
            sent,
            command,
            excess,
            extra_rate: [],
        }
    }
}
