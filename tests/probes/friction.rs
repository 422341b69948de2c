//! Probes of shaders/friction.wgsl: what slows a channel down.

use super::harness::{Compared, Expected, Lab};
use super::numbers::Numbers;
use super::tracked::Tracked;
use super::world::{Flies, World};
use crate::model::exogenous::friction::friction_force;

/// The force of all frictions at rates around those within which it changes its sign, and far beyond.
pub(super) fn forces<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        if N_FRICTIONS > 0u {
            answer_number(0u, friction_force(number(0u)));
            let friction = friction_drawn(N_FRICTIONS - 1u);
            answer_number(1u, friction.coulomb);
            answer_number(2u, friction.inverse_smoothing);
            answer_number(3u, friction.viscous);
        }";
    let inputs = |n: &mut Numbers, _: usize| {
        let (slow, fast) = (n.around(0.05) as f32, n.around(3.0) as f32);
        vec![n.one_of(&[slow, slow, fast, 0.0]).to_bits()]
    };
    world.check(lab, body, 4, inputs, |scene| {
        scene.each(|scene, a, c| {
            let rate: Tracked = scene.number(a, c, 0);
            let frictions = scene.group.agents[a].signals.frictions.clone();
            let Some(last) = frictions.last() else {
                return (0..4).for_each(|_| scene.answer(a, c, Expected::Any));
            };
            let last = last[c];
            let force = friction_force(&frictions, c, rate);
            for number in [force, last.coulomb, last.inverse_smoothing, last.viscous] {
                scene.answer_number(a, c, number);
            }
        });
    })
}
