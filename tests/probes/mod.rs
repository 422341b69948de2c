//! Probes: every function of `shaders/` on its own against its Rust twin, on the same random inputs.
//!
//! | module | holds |
//! |---|---|
//! | `layout` | without a device: the joined text is valid; structs, bindings and constants are those of Rust |
//! | `twins` | without a device: which function is whose twin, and that each has a probe |
//! | `table` | the probes: their names and the functions that they call |
//! | `pure`, `loops`, `windows`, `exogenous`, `team`, `buffers` | what they do |
//! | `controls`, `changes` | one change of the shaders at a time, and the probe that must notice |
//! | `harness`, `tracked`, `numbers`, `shapes` | running a probe, its tolerances, inputs and shapes |
//! | `leg` | the dynamics of a robot's leg |
//! | `iterations` | the bound on the iterations of loops, and the loops that it counts |
//! | `friction`, `vortex` | what slows a channel down; the jets of rotors |
//! | `world`, `states`, `image` | teams in random states, and how their state travels |
//!
//! They are in the library because they see its internals. Without an adapter the probes print SKIPPED, unless
//! URTS_REQUIRE_GPU=1 asks for one.
#![expect(clippy::unwrap_used, reason = "a test may stop where it stands")]
#![expect(clippy::float_cmp, reason = "what is exact is compared so")]
#![expect(clippy::print_stdout, reason = "measured figures, shown on demand")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "small counts, bit patterns and roundings that are meant"
)]

mod buffers;
mod changes;
mod controls;
mod exogenous;
mod friction;
mod harness;
mod image;
mod iterations;
mod layout;
mod leg;
mod loops;
mod numbers;
mod pure;
mod shapes;
mod states;
mod table;
mod team;
mod tracked;
mod twins;
mod vortex;
mod windows;
mod world;

use harness::Lab;
use table::{GROUPS, LOOPS, MEMORY, PURE, Probe, SIGNALS};

/// Runs probes, which must agree with the twins.
fn agree(probes: &[Probe]) {
    let Some(lab) = Lab::open() else { return };
    for Probe { name, run, .. } in probes {
        let compared = run(&lab);
        println!(
            "{name:22} {:6} words, {:6} of them rounded: off by at most {:.1e}, {:.2} of the bound; {} loose bounds",
            compared.words, compared.rounded, compared.difference, compared.share, compared.loose
        );
        assert!(
            compared.wrong.is_empty(),
            "{name}: {} of {} results differ, first\n{}",
            compared.wrong.len(),
            compared.words,
            compared.wrong[..compared.wrong.len().min(5)].join("\n")
        );
        assert!(compared.words >= 500, "{name} compares hundreds");
        assert!(20 * compared.loose <= compared.rounded, "{name} is blind");
    }
}

#[test]
fn regress_functions_of_their_arguments_agree_with_their_twins() {
    agree(PURE);
}

#[test]
fn regress_parts_of_a_stage_agree_with_their_twins() {
    agree(LOOPS);
}

#[test]
fn regress_switches_and_memories_agree_with_their_twins() {
    agree(MEMORY);
}

#[test]
fn regress_signals_and_metrics_agree_with_their_twins() {
    agree(SIGNALS);
}

#[test]
fn regress_agents_and_teams_agree_with_their_twins() {
    agree(GROUPS);
}
