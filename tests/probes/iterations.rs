//! Iterations of loops: shaders that count them on the device, against the bound that their shape states.

use super::harness::{Case, Compared, Expected, Job, Lab};
use super::shapes;
use super::world::{Flies, World};
use crate::backend::gpu::AdapterKind;
use crate::backend::gpu::layout::Span;
use crate::backend::gpu::shape::Shape;

/// A look at the condition of a loop, which is what an iteration is for a driver that counts them.
const COUNTER: &str = "
var<private> iterations: u32;

fn look(more: bool) -> bool {
    iterations += 1u;
    return more;
}
";

/// The text with every loop counted.
pub(super) fn counting(text: &str) -> String {
    let lines = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    let lines = lines.map(|line| {
        let other = line.contains("while ") || line.contains("loop {");
        assert!(!other, "a loop that is not counted: {line}");
        let Some((head, rest)) = line.split_once("for (") else {
            return line.to_string();
        };
        let parts: Vec<&str> = rest.splitn(3, "; ").collect();
        let [first, condition, next] = parts[..] else {
            panic!("a loop on one line: {line}");
        };
        format!("{head}for ({first}; look({condition}); {next}")
    });
    lines.collect::<Vec<_>>().join("\n") + COUNTER
}

/// What every invocation of a dispatch counts, for spans of several lengths, and when it shows itself. What is drawn is
/// zero: no loop asks for it.
pub(super) fn counted<P: Flies<NC, NX>, const NC: usize, const NS: usize, const NX: usize>(
    lab: &Lab,
    world: &World<P, NC, NS, NX>,
) -> Compared {
    let (shape, words, bound) = (&world.shape, world.shape.words(), world.shape.iterations());
    let case = Case {
        drawn: vec![0; words.drawn()],
        stored: vec![0; words.stored()],
        taken: vec![0],
    };
    let cases = vec![case; shape.workgroup() * 40_usize.div_ceil(shape.workgroup())];
    let setting = world.bytes();
    let advance = "resume(); group_advance(); keep(); give(0u, iterations);";
    let show = "resume(); give(1u, bitcast<u32>(group_show()[0])); give(0u, iterations);";
    let mut compared = Compared::default();
    for (body, steps) in [(advance, 1), (advance, 5), (show, 0)] {
        let first = world.span.first;
        let left = lab.counting().run(&Job {
            shape,
            setting: &setting,
            span: Span {
                until: first + steps,
                ..world.span
            },
            table: &world.table,
            body,
            image: 0,
            cases: &cases,
            given: 2,
        });
        for left in left {
            let (count, most) = (u64::from(left.given[0]), bound.of(steps));
            // Where signals are held at every step, the bound is not far off. Of noise, it counts four times as much.
            let least = if shape.lists.restless { most / 3 } else { 1 };
            let held = if (least..=most).contains(&count) {
                left.given[0]
            } else {
                most as u32
            };
            compared.take(Expected::Bits(held), left.given[0], || {
                format!(
                    "{:?}, {steps} steps: {least} to {most} iterations",
                    shape.plant
                )
            });
        }
    }
    compared
}

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
