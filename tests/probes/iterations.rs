//! Iterations of loops: the bound that a shape states, against the limits of adapters.

use super::layout::module;
use super::shapes;
use crate::backend::gpu::AdapterKind;
use crate::backend::gpu::shape::Shape;
use std::collections::BTreeMap;

#[test]
fn as_many_steps_as_fit_a_limit_fit_and_one_more_does_not() {
    for shape in shapes::validated() {
        let bound = shape.iterations();
        for kind in [AdapterKind::Software, AdapterKind::Discrete] {
            let limit = kind.most_iterations();
            let steps = bound.steps_within(limit).unwrap();
            assert!(bound.in_steps(steps) <= limit && limit < bound.in_steps(steps + 1));
        }
        assert_eq!(bound.steps_within(bound.in_steps(1) - 1), None);
        assert_eq!(bound.steps_within(bound.in_steps(1)), Some(1));
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
    // With 33 agents Mesa gave wrong numbers in a span of 510 steps and right ones in 460. The bound counts loops that
    // the driver unrolls, too, so it allows fewer; below half of what is right it would waste dispatches.
    let steps = AdapterKind::Software.most_iterations() / of_team(33, true);
    assert!((250..460).contains(&steps), "{steps}");
}

/// The loops of every function, as they were when the formula of [`Shape::iterations`] was written: each has its term
/// there. Where shapes differ, the most.
const LOOPS: &[(&str, usize)] = &[
    ("carry_command", 1),
    ("evaluate_command", 1),
    ("exogenous_inputs_begin", 1),
    ("exogenous_inputs_evaluate", 4),
    ("exogenous_inputs_hold", 4),
    ("exogenous_inputs_remember", 1),
    ("finish", 3),
    ("hold_command", 9),
    ("hold_sensor", 6),
    ("friction_force", 1),
    ("measure", 1),
    ("next_change", 1),
    ("philox4x32", 1),
    ("remember_command", 1),
    ("show", 1),
    ("start", 2),
    ("team_commands", 1),
    ("team_state_advance", 1),
    ("team_state_end_step", 1),
    ("team_sum", 1),
    ("vortex_force", 2),
];

/// The loops in a block of statements.
fn loops(block: &naga::Block) -> usize {
    let inside = |statement: &naga::Statement| match statement {
        naga::Statement::Loop {
            body, continuing, ..
        } => 1 + loops(body) + loops(continuing),
        naga::Statement::Block(body) => loops(body),
        naga::Statement::If { accept, reject, .. } => loops(accept) + loops(reject),
        naga::Statement::Switch { cases, .. } => cases.iter().map(|case| loops(&case.body)).sum(),
        _ => 0,
    };
    block.iter().map(inside).sum()
}

#[test]
fn a_loop_that_the_bound_does_not_count_is_noticed() {
    let mut found: BTreeMap<String, usize> = BTreeMap::new();
    for shape in shapes::validated() {
        let module = module(&shape);
        let named = module.functions.iter().map(|(_, function)| function);
        let entries = module.entry_points.iter().map(|entry| &entry.function);
        for function in named.chain(entries) {
            let count = loops(&function.body);
            if count > 0 {
                let name = function.name.clone().unwrap_or_default();
                let most = found.entry(name).or_default();
                *most = count.max(*most);
            }
        }
    }
    let listed: BTreeMap<String, usize> = LOOPS
        .iter()
        .map(|(name, count)| (name.to_string(), *count))
        .collect();
    assert_eq!(found, listed);
}
