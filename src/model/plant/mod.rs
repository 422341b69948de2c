//! What the plants share: the loop asks a group of channels for its reference and for its answer to the feedforward law
//! (9) and whatever acts on it.

pub(crate) mod biped;
pub(crate) mod kinds;
pub mod leg;
pub mod uav;

use super::exogenous::actuator::Actuator;
use super::lanes::Lane;

/// Four numbers of a reference table. A channel's first row at an instant is r, r', r'' and the feedforward
/// M(r) r'' + H(r, r') of (9); what more a plant needs follows.
pub type ReferenceRow<R> = [R; 4];

/// What acts on the channels of one agent at one instant.
pub(crate) struct Inputs<'a, L: Lane, const NC: usize> {
    /// Reference rows, `[channel][row]`.
    pub(crate) reference: &'a [ReferenceRow<L::Real>],
    /// u_fb of (21).
    pub(crate) feedback: [L; NC],
    /// x.
    pub(crate) position: [L; NC],
    /// x'.
    pub(crate) velocity: [L; NC],
    /// c + d1 of (12).
    pub(crate) force: [L; NC],
    /// Scale of the ground's reaction, where the table has one.
    pub(crate) ground: &'a [L; NC],
    /// What becomes of the commands on their way.
    pub(crate) actuator: &'a Actuator<L, NC>,
    /// 1 / true inertia.
    pub(crate) inverse_inertia: &'a [L; NC],
}

/// How an agent's channels answer.
pub(crate) struct Response<L, const NC: usize, const NX: usize> {
    /// x'' - r''.
    pub(crate) error_acceleration: [L; NC],
    /// The feedback that was really commanded, after filter and limits, before any fault: the applied feedback of which
    /// the observer knows.
    pub(crate) applied_feedback: [L; NC],
    /// The command u of (9) after limits, as it sets out.
    pub(crate) sent: [L; NC],
    /// The command that acts, after faults; under thrust, x, y and z show the force demanded.
    pub(crate) command: [L; NC],
    /// By how much the limits cut the command; zero where there are none.
    pub(crate) excess: [L; NC],
    /// Derivative of the plant's own `NX` states.
    pub(crate) extra_rate: [L; NX],
}

/// A group of `NC` channels of each agent that act on each other, with `NX` states of its own.
pub(crate) trait Plant<L: Lane, const NC: usize, const NX: usize>:
    Copy + Send + Sync
{
    /// Whether commands have limits, whose excess is counted.
    const LIMITED: bool;
    /// Rows of each channel in the reference table.
    const ROWS: usize;

    /// The reference of one agent and its rate: `[r, r']`.
    fn reference(&self, rows: &[ReferenceRow<L::Real>], extra: &[L; NX]) -> [[L; NC]; 2];

    /// The answer of one agent.
    fn respond(&self, inputs: &Inputs<'_, L, NC>, extra: &[L; NX]) -> Response<L, NC, NX>;
}

/// The reference of channels that the table holds: the first of each channel's `stride` rows.
#[inline(always)]
pub(crate) fn tabulated<L: Lane, const NC: usize>(
    rows: &[ReferenceRow<L::Real>],
    stride: usize,
) -> [[L; NC]; 2] {
    let mut reference = [[L::number(0.0); NC]; 2];
    for c in 0..NC {
        reference[0][c] = L::splat(rows[stride * c][0]);
        reference[1][c] = L::splat(rows[stride * c][1]);
    }
    reference
}

/// A row of the reference table in every lane.
#[inline(always)]
pub(crate) fn splat_row<L: Lane>(row: &ReferenceRow<L::Real>) -> [L; 4] {
    [
        L::splat(row[0]),
        L::splat(row[1]),
        L::splat(row[2]),
        L::splat(row[3]),
    ]
}
