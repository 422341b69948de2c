//! Random numbers by address, and what is drawn for an episode.

use crate::mission::scenarios::*;
use urts_mc::mission::parameters::{Endurance, Range, Targets, WholeRange};
use urts_mc::mission::plane::distance;
use urts_mc::mission::{MissionDraws, MissionError, Parameters, Scenario};
use urts_mc::random::philox::{Address, Stream};

#[test]
fn val_numbers_of_both_streams_are_those_of_the_golden_file() {
    let units = GOLDEN["rng"]["units"].as_object().unwrap();
    assert_eq!(units.len(), 4);
    for (place, golden) in units {
        let field = |name: &str| -> u32 {
            let fields = place.split(',').find_map(|field| field.strip_prefix(name));
            fields.unwrap().parse().unwrap()
        };
        let stream = match field("stream=") {
            12 => Stream::Mission,
            13 => Stream::Plan,
            other => panic!("stream {other}"),
        };
        for (index, golden) in numbers(golden).into_iter().enumerate() {
            let address = Address {
                episode: field("episode="),
                stream,
                entry: field("entry="),
                member: field("member="),
                index: u32::try_from(index).unwrap(),
            };
            // Both are multiples of 2^-52, exactly.
            assert!((address.unit(field("seed=").into()) - golden).abs() < 1e-15);
        }
    }
}

#[test]
fn val_targets_and_obstacles_are_those_of_the_golden_mission() {
    let draws = MissionDraws::of_episode(&PAPER, SEED, 0).unwrap();
    let targets = points_of(&GOLDEN["mission_full"]["targets"]);
    assert_eq!(draws.targets_m.len(), targets.len());
    for (&ours, golden) in draws.targets_m.iter().zip(targets) {
        // Sums and products of the same numbers: a few units in the last place of 120 m.
        assert!(distance(ours, golden) < 1e-12);
    }
    let obstacles = GOLDEN["mission_full"]["obstacles"].as_array().unwrap();
    assert_eq!(draws.obstacles.len(), obstacles.len());
    for (disc, golden) in draws.obstacles.iter().zip(obstacles) {
        let golden = numbers(golden);
        assert!(distance(disc.centre_m, [golden[0], golden[1]]) < 1e-12);
        assert!((disc.radius_m - golden[2]).abs() < 1e-14);
    }
}

#[test]
fn thresholds_are_exponentials_of_the_numbers_at_their_addresses() {
    let draws = MissionDraws::of_episode(&PAPER, SEED, 3).unwrap();
    for (agent, thresholds) in draws.thresholds.iter().enumerate() {
        for (target, threshold) in thresholds.iter().enumerate() {
            let address = Address {
                episode: 3,
                stream: Stream::Mission,
                entry: 3,
                member: u32::try_from(agent * 64 + target).unwrap(),
                index: 0,
            };
            let library = -address.unit(SEED).ln();
            // The standard library's logarithm is exact to one unit in the last place, ours to three of its larger
            // term, which is at most ln 2 larger than the result.
            assert!(
                (threshold - library).abs() <= 4e-16 * (1.0 + library),
                "{threshold} {library}"
            );
        }
    }
}

#[test]
fn what_is_drawn_keeps_its_distances_and_its_ranges() {
    let mut counts = std::collections::BTreeSet::new();
    for episode in 0..200 {
        let draws = MissionDraws::of_episode(&PAPER, SEED, episode).unwrap();
        assert_eq!(draws.targets_m.len(), 3);
        counts.insert(draws.obstacles.len());
        for &target in &draws.targets_m {
            assert!(PAPER.world().clear_m(target, &[]) >= 1.0);
        }
        for disc in &draws.obstacles {
            assert!((0.4..=1.0).contains(&disc.radius_m));
            assert!(PAPER.world().clear_m(disc.centre_m, &[]) >= 0.0);
            for &kept in PAPER.starts_m().iter().chain(&draws.targets_m) {
                assert!(distance(disc.centre_m, kept) >= disc.radius_m + 2.0);
            }
        }
        assert!(draws.endurance_s.iter().all(|end_s| end_s.is_infinite()));
    }
    // Both ends of the range occur.
    assert_eq!(counts.into_iter().collect::<Vec<_>>(), [6, 7, 8, 9, 10]);
}

#[test]
fn endurance_and_the_number_of_targets_are_drawn_within_their_ranges() {
    let parameters = Parameters {
        targets: Targets::Random {
            count: WholeRange { least: 1, most: 4 },
            clear_m: 1.0,
        },
        endurance: Endurance {
            uav_s: Some(Range {
                lower: 500.0,
                upper: 700.0,
            }),
            robot_s: None,
        },
        ..paper_parameters()
    };
    let scenario = Scenario::new(paper_world(), parameters).unwrap();
    let mut counts = std::collections::BTreeSet::new();
    for episode in 0..100 {
        let draws = MissionDraws::of_episode(&scenario, SEED, episode).unwrap();
        counts.insert(draws.targets_m.len());
        for (agent, end_s) in draws.endurance_s.iter().enumerate() {
            let expected = if scenario.is_uav(agent) {
                500.0..=700.0
            } else {
                f64::INFINITY..=f64::INFINITY
            };
            assert!(expected.contains(end_s));
        }
    }
    assert_eq!(counts.into_iter().collect::<Vec<_>>(), [1, 2, 3, 4]);
}

#[test]
fn targets_and_obstacles_that_do_not_fit_are_refused_by_what_does_not() {
    let refused = |parameters: Parameters| {
        let scenario = Scenario::new(paper_world(), parameters).unwrap();
        let error = MissionDraws::of_episode(&scenario, SEED, 7).unwrap_err();
        assert!(matches!(error, MissionError::NoPlace { episode: 7, .. }));
        error.to_string()
    };
    let far_from_obstacles = Parameters {
        targets: Targets::Random {
            count: WholeRange { least: 1, most: 1 },
            clear_m: 50.0,
        },
        ..paper_parameters()
    };
    let message = refused(far_from_obstacles);
    assert!(message.contains("target 1 of episode 7") && message.contains("targets.clear_m"));
    let mut far_from_starts = paper_parameters();
    far_from_starts.obstacles.keep_clear_m = 100.0;
    let message = refused(far_from_starts);
    assert!(
        message.contains("obstacle 1 of episode 7") && message.contains("obstacles.keep_clear_m")
    );
}
