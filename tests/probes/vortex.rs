//! Probes of shaders/vortex.wgsl: a jet, and what an agent feels of all of them.

use super::harness::{Compared, Expected, Lab};
use super::numbers::Numbers;
use super::pure::{near, number, probe, words};
use super::tracked::Tracked;
use super::world::{Flies, World};
use crate::model::exogenous::vortex::{Vortex, jet_growth, jet_profile, jet_share, vortex_force};
use crate::model::lanes::Lane;
use crate::model::team::finite;

pub(super) fn jets(lab: &Lab) -> Compared {
    let body = "
        answer_number(0u, jet_profile(abs(number(0u))));
        answer_number(1u, jet_growth(abs(number(1u))));
        let jet = Vortex(1.0, abs(number(2u)), abs(number(3u)));
        let here = vec3(number(4u), number(5u), number(6u));
        answer_number(2u, jet_share(jet, here, vec3(number(7u), number(8u), number(9u))));";
    // On the axis and level, below and above one another, and as far away as agents are seen in the thinnest jet.
    let edges = [
        [0.0, 0.0, 1.0, 1.0, 0.3, 0.4, 0.5, 0.3, 0.4, 0.5],
        [1.0, 2.0, 1.0, 1.0, 0.3, 0.4, 0.5, 0.3, 0.4, 2.5],
        [9.0, 9.0, 1.0, 1.0, 0.3, 0.4, 2.5, 0.3, 0.4, 0.5],
        [4e36, 4e18, 1e3, 2e3, -1e15, -1e15, -1e15, 1e15, 1e15, 1e15],
    ];
    let edges = edges.map(|edge| edge.map(f32::to_bits).to_vec()).to_vec();
    let sizes = [4.0, 6.0, 2.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
    let random = |n: &mut Numbers| words(n, &sizes);
    probe(lab, body, edges, random, |x| {
        let jet = Vortex {
            force: Tracked::exact(1.0),
            inverse_radius: number(x[2]).abs(),
            inverse_length: number(x[3]).abs(),
        };
        let place = |first: usize| std::array::from_fn(|k| number(x[first + k]));
        [
            near(jet_profile(number(x[0]).abs())),
            near(jet_growth(number(x[1]).abs())),
            near(jet_share(&jet, &place(4), &place(7))),
        ]
        .concat()
    })
}

/// The force of all jets, between agents some of which are far away or not finite.
pub(super) fn forces<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let body = "
        load();
        publish(stage, POSITION, number(0u));
        workgroupBarrier();
        if N_VORTICES > 0u {
            answer_number(0u, vortex_force(stage));
            let place = agent_place(stage, (own.agent + 1u) % TEAM);
            for (var k = 0u; k < 3u; k++) { answer_number(1u + k, place[k]); }
            let vortex = vortex_drawn(N_VORTICES - 1u);
            answer_number(4u, vortex.force);
            answer_number(5u, vortex.inverse_radius);
            answer_number(6u, vortex.inverse_length);
        }";
    let inputs = |n: &mut Numbers, _: usize| {
        let near = n.around(1.0) as f32;
        let lost = n.one_of(&[3e15, -3e15, 1e15, f32::INFINITY, f32::NAN]);
        vec![n.one_of(&[near, near, near, near, near, lost]).to_bits()]
    };
    let team = world.shape.team;
    world.check(lab, body, 7, inputs, |scene| {
        let places: Vec<[Tracked; 3]> = (0..team)
            .map(|a| {
                let mut place = std::array::from_fn(|c| scene.number(a, c % NC, 0));
                finite(&mut place);
                place
            })
            .collect();
        scene.each(|scene, a, c| {
            let vortices = &scene.group.agents[a].vortices;
            let Some(&last) = vortices.last() else {
                return (0..7).for_each(|_| scene.answer(a, c, Expected::Any));
            };
            let mut numbers = vec![vortex_force(vortices, a, &places)];
            numbers.extend(places[(a + 1) % team]);
            numbers.extend([last.force, last.inverse_radius, last.inverse_length]);
            for number in numbers {
                scene.answer_number(a, c, number);
            }
        });
    })
}
