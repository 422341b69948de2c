//! The jets of rotors: the force against its formula, and what they leave alone.

use super::{DRAG_N_S_M, MASS_KG, near, parsed, trajectory};
use crate::common::{gains, repository};
use urts_mc::backend::cpu::{Cpu, Precision, Simd};
use urts_mc::campaign::{Campaign, CampaignError, DisturbanceKind};
use urts_mc::draw::draw;
use urts_mc::model::ChannelSample;
use urts_mc::simulation::attenuation::obstacle;

const Z: usize = 2;

/// A team of three whose paths cross each other in height and sideways, with some more of its file.
fn team(more: &str) -> Campaign {
    parsed_team(more, &[]).unwrap()
}

fn parsed_team(more: &str, changes: &[&str]) -> Result<Campaign, CampaignError> {
    let blocks = [(-0.1, 0.2, 0.0), (0.3, -0.1, 2.0), (0.2, 0.1, 4.0)].map(|(x_m, z_m, turned_rad)| {
        format!(
            "reference.agents.+={{ center = [{x_m:?}, 0.1, {z_m:?}, 0.0, 0.0, 0.0], phase_rad = [0.1, {turned_rad:?}, {turned_rad:?}, 0.0, 0.0, 0.0] }}"
        )
    });
    let [first, second, third] = &blocks;
    let own = [
        "agent.team=3",
        "reference.frequency_rad_s.2=6.0",
        first,
        second,
        third,
    ];
    parsed(more, &[&own[..], changes].concat())
}

/// Force, radius and length of each agent.
const JETS: [[f64; 3]; 3] = [[9.0, 0.4, 0.5], [6.0, 0.7, 0.3], [4.0, 1.1, 1.2]];
const SECOND: [f64; 3] = [2.0, 3.0, 0.2];

fn of_all() -> String {
    let blocks = JETS.map(|[force_n, radius_m, length_m]| {
        format!("[[disturbance.agents]]\nforce_n = {force_n:?}\nradius_m = {radius_m:?}\nlength_m = {length_m:?}\n")
    });
    let [force_n, radius_m, length_m] = SECOND;
    format!(
        "[[disturbance]]\nkind = \"rotor-vortex\"\n{}[[disturbance]]\nkind = \"rotor-vortex\"\nforce_n = {force_n:?}\nradius_m = {radius_m:?}\nlength_m = {length_m:?}\n",
        blocks.concat()
    )
}

/// The formula, with the profile of another power.
fn force_n(agents: &[Vec<ChannelSample>], own: usize, power: i32) -> f64 {
    let x = |agent: usize, channel: usize| agents[agent][channel].x;
    let mut sum = 0.0;
    for [force_n, radius_m, length_m] in [JETS[own], SECOND] {
        for other in (0..agents.len()).filter(|&other| other != own) {
            let below_m = (x(other, Z) - x(own, Z)).max(0.0);
            let beside_m = (x(other, 0) - x(own, 0)).hypot(x(other, 1) - x(own, 1));
            let profile =
                (1.0 + (2.0_f64.sqrt() - 1.0) * (beside_m / radius_m).powi(2)).powi(power);
            let x = 2.0 * below_m / length_m;
            sum -= force_n * profile.recip() * 27.0 / 4.0 * x * x / (1.0 + x).powi(3);
        }
    }
    sum
}

/// The force on a channel of translation whose command acts as it is wanted.
fn found_n(shown: &ChannelSample) -> f64 {
    MASS_KG * shown.f1 + DRAG_N_S_M * shown.e_rate
}

#[test]
fn val_the_force_of_jets_is_that_of_the_formula_at_every_step() {
    let simulated = trajectory(&team(&of_all()));
    let (mut most, mut none, mut other) = (0.0_f64, 0, 0.0_f64);
    for agents in &simulated {
        for own in 0..3 {
            let found = found_n(&agents[own][Z]);
            let expected = force_n(agents, own, 2);
            near(found, expected, "the force of jets");
            for channel in [0, 1] {
                near(found_n(&agents[own][channel]), 0.0, "jets blow downwards");
            }
            most = most.max(-expected);
            none += usize::from(expected == 0.0);
            other = other.max((found - force_n(agents, own, 1)).abs());
        }
    }
    // Each was hit hard and not at all, and a profile of another power would be noticed.
    assert!(
        most > 3.0 && none > 100 && other > 0.3,
        "{most} N, {none} steps, {other} N"
    );
}

#[test]
fn val_at_its_length_and_radius_a_jet_has_the_force_that_is_named() {
    // Errors of zero: at t = 0 agents are on their references.
    let at = |beside_m: f64, below_m: f64| {
        let more = format!(
            "[[reference.agents]]\namplitude = 0.0\ncenter = [0.0, 0.0, 5.0, 0.0, 0.0, 0.0]\n[[reference.agents]]\namplitude = 0.0\ncenter = [0.0, {beside_m:?}, {:?}, 0.0, 0.0, 0.0]\n[[disturbance]]\nkind = \"rotor-vortex\"\nforce_n = 7.0\nradius_m = 0.8\nlength_m = 1.5\n",
            5.0 - below_m
        );
        let simulated = trajectory(&parsed(&more, &["initial.error=0.0"]).unwrap());
        [0, 1].map(|agent: usize| found_n(&simulated[0][agent][Z]))
    };
    for (beside_m, below_m, expected) in [
        (0.0, 1.5, -7.0),
        (0.8, 1.5, -3.5),
        (-0.8, 1.5, -3.5),
        (0.0, 0.0, 0.0),
    ] {
        let [above, below] = at(beside_m, below_m);
        near(above, 0.0, "the force on the upper");
        near(below, expected, "the force on the lower");
    }
    // It falls like 1 / w: x = 2 w / length is large.
    let [_, far] = at(0.0, 1500.0);
    assert!(
        (far / (-7.0 * 27.0 / 4.0 / 2000.0) - 1.0).abs() < 2e-3,
        "{far}"
    );
}

#[test]
fn val_under_thrust_jets_add_the_same_force() {
    let thrust = ["agent.actuation=thrust", "synthesis.preset=uav-physical"];
    let [with, without] = [of_all(), String::new()].map(|more| {
        let campaign = parsed_team(&more, &thrust).unwrap();
        trajectory(&campaign).swap_remove(0)
    });
    let mut most = 0.0_f64;
    for own in 0..3 {
        for channel in 0..3 {
            // At the start they differ by nothing else.
            let found = MASS_KG * (with[own][channel].f1 - without[own][channel].f1);
            let expected = if channel == Z {
                force_n(&with, own, 2)
            } else {
                0.0
            };
            near(found, expected, "the force of jets under thrust");
            most = most.max(-expected);
        }
    }
    assert!(most > 1.0, "{most} N");
}

#[test]
fn axes_in_one_group_give_the_same_bits_as_each_on_its_own() {
    // The mixture of all faults, with jets of no force and without jets.
    let path = repository("tests/suite/backend/gpu/uav_faults.toml");
    let blowing = Campaign::load(&path).unwrap().with_episodes(5).unwrap();
    let is_jet = |kind| kind == DisturbanceKind::RotorVortex;
    let gains = gains(&blowing).loops();
    let simulated = |campaign: &Campaign, precision, simd| {
        let simulated =
            Cpu::new(campaign.first_group(), &gains, precision, simd).simulate(0..5, &|_| ());
        format!(
            "{:?}",
            simulated
                .iter()
                .map(|one| &one.outcomes)
                .collect::<Vec<_>>()
        )
    };
    // What was drawn for the others stays: the jets are the last of the disturbances.
    let apart = blowing.clone();
    let apart = apart.with(|own| own.disturbances.retain(|one| !is_jet(one.kind)));
    assert!(
        blowing.first_group().disturbances[..apart.first_group().disturbances.len()]
            == apart.first_group().disturbances[..]
    );
    let together = blowing.clone().with(|own| {
        for one in &mut own.disturbances {
            if is_jet(one.kind) {
                let none = urts_mc::campaign::Distribution::Constant(0.0);
                one.parameters[0].distributions.fill(none);
            }
        }
    });
    let all = Simd::ALL.into_iter().filter(|simd| simd.is_available());
    let widths = all.map(|simd| (Precision::F32, Some(simd)));
    for (precision, simd) in widths.chain([(Precision::F64, None)]) {
        let own = simulated(&together, precision, simd);
        assert!(
            own == simulated(&apart, precision, simd),
            "{precision:?} {simd:?}"
        );
        assert!(
            own != simulated(&blowing, precision, simd),
            "jets do something"
        );
    }
}

#[test]
fn who_diverged_blows_at_nobody() {
    // The first is hit by the jet of the second, whose position leaves the numbers, or is there from the start.
    let lost = |error: &str, beyond: bool| {
        let more = "[[disturbance]]\nkind = \"rotor-vortex\"\nforce_n = { choice = [0.0, 5.0] }\nradius_m = 1.0\nlength_m = 1.0\n";
        let starts = format!("initial.agents=[{{ error = 0.0 }}, {{ error = {error} }}]");
        let campaign = parsed(more, &[&starts]).unwrap();
        let forces =
            |index: u32| draw(campaign.first_group(), index).agents[0].disturbances[0][0][0];
        assert!((0..4).any(|k| forces(k) == 0.0) && (0..4).any(|k| forces(k) == 5.0));
        let gains = gains(&campaign);
        for precision in [Precision::F64, Precision::F32] {
            let cpu = Cpu::new(campaign.first_group(), &gains.loops(), precision, None);
            for (index, simulated) in (0..).zip(cpu.simulate(0..4, &|_| ())) {
                let agents = &simulated.outcomes[0];
                assert!(agents[1].failed_step.is_some() == beyond, "{error}");
                let own = agents[0].channels[Z].rmse;
                assert!(
                    agents[0].failed_step.is_none() && own < 0.1,
                    "{index}: {own}"
                );
            }
        }
    };
    // Far away; and beyond the numbers after a step at most, in single precision from the start.
    for error in [
        "[1e30, 1e30, 1e30, 0.0, 0.0, 0.0]",
        "[0.0, 0.0, -1e30, 0.0, 0.0, 0.0]",
    ] {
        lost(error, false);
    }
    for error in ["1e308", "[0.0, 0.0, -1e308, 0.0, 0.0, 0.0]"] {
        lost(error, true);
    }
}

#[test]
fn jets_are_refused_where_they_mean_nothing() {
    let jet = "[[disturbance]]\nkind = \"rotor-vortex\"\n";
    let whole = format!("{jet}force_n = 2.0\nradius_m = 0.5\nlength_m = 1.0\n");
    assert!(parsed_team(&whole, &[]).is_ok());
    let cases = [
        (
            "disturbance.0.radius_m=0.0",
            "disturbance[0].radius_m",
            "at least 1e-3",
        ),
        (
            "disturbance.0.length_m={ uniform = [-1.0, 1.0] }",
            "disturbance[0].length_m",
            "at least 1e-3",
        ),
        (
            "disturbance.0.force_n=-2.0",
            "disturbance[0].force_n",
            "must not be negative",
        ),
        (
            "disturbance.0.force_n=",
            "disturbance[0].force_n",
            "this kind needs it",
        ),
        (
            "disturbance.0.force_n=[1.0, 1.0, 1.0, 1.0, 1.0, 1.0]",
            "disturbance[0].force_n",
            "a quantity of the agent",
        ),
        (
            "disturbance.0.amplitude=1.0",
            "disturbance[0].amplitude",
            "force_n, radius_m, length_m",
        ),
    ];
    for (wrong, key, limit) in cases {
        let error = parsed_team(&whole, &[wrong]).unwrap_err().to_string();
        assert!(error.contains(key) && error.contains(limit), "{error}");
    }
    let alone = parsed(&whole, &["agent.team=1"]);
    let error = alone.unwrap_err().to_string();
    assert!(
        error.contains("no other UAV whose rotors") && error.contains("raise agent.team"),
        "{error}"
    );
    let path = repository("campaigns/biped-paper.toml");
    let biped = std::fs::read_to_string(&path).unwrap() + &whole;
    let error = Campaign::parse(&biped, &path).unwrap_err().to_string();
    assert!(
        error.contains("rotor-vortex") && error.contains("not on joints"),
        "{error}"
    );
}

#[test]
fn jets_are_no_obstacle_to_the_theorem() {
    let of = |more: &str| {
        let campaign = team(more);
        obstacle(
            campaign.first_group(),
            &draw(campaign.first_group(), 0).agents[0],
            Z,
        )
    };
    assert_eq!(of(&of_all()), None);
    let wind = "[[disturbance]]\nkind = \"dryden\"\nwind_m_s = 9.0\naltitude_m = 6.0\nairspeed_m_s = 20.0\ngain_n_s_m = 1.5\n";
    assert!(of(wind).is_some());
}
