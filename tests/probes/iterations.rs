//! Iterations of loops: the bound that a shape states, against the limits of adapters.

use super::shapes;
use crate::backend::gpu::AdapterKind;
use crate::backend::gpu::shape::Shape;

#[test]
fn as_many_steps_as_fit_a_limit_fit_and_one_more_does_not() {
    for shape in shapes::validated() {
        let bound = shape.iterations();
        for kind in [AdapterKind::Software, AdapterKind::Discrete] {
            let limit = kind.most_iterations();
            let steps = bound.steps_within(limit).unwrap();
            assert!(bound.of(steps) <= limit && limit < bound.of(steps + 1));
        }
        assert_eq!(bound.steps_within(bound.of(1) - 1), None);
        assert_eq!(bound.steps_within(bound.of(1)), Some(1));
    }
}

#[test]
fn the_loop_over_a_coupled_team_counts_in_each_of_four_stages() {
    let of_team = |team: usize, coupled: bool| {
        let [_, coupled_shape, alone, ..] = shapes::probed();
        let shape = if coupled { coupled_shape } else { alone };
        Shape { team, ..shape }.iterations().per_step
    };
    assert_eq!(of_team(64, true) - of_team(33, true), 4 * (64 - 33));
    assert_eq!(of_team(64, false), of_team(33, false));
    // Mesa's limit in full, over the loops of 33 agents: a span of 510 steps was seen to be wrong, one of 460 right.
    let steps = AdapterKind::Software.most_iterations() / of_team(33, true);
    assert!((250..460).contains(&steps), "{steps}");
}
