//! Sampling designs in campaigns: draws balanced through `draw`, replicates, and the statistics that they leave out.

use crate::common::{altered, tables};
use crate::results::scores_of_channels;
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::Campaign;
use urts_mc::draw::{Episode, draw};
use urts_mc::results::scores::{Scores, Status};
use urts_mc::results::sensitivity::{rank, ranking_table};
use urts_mc::results::table::Table;
use urts_mc::results::{compare, comparison_table, summarise, summary_table, verdict};
use urts_mc::run::directory::OutputDir;
use urts_mc::run::replay::replay;
use urts_mc::run::{Extras, run};
use urts_mc::simulation::RunOptions;

fn sampled(design: &str, replicates: u32, episodes: u32) -> Campaign {
    altered(
        "smoke",
        &[
            &format!("sampling.design={design}"),
            &format!("sampling.replicates={replicates}"),
            &format!("episodes={episodes}"),
        ],
    )
}

/// The draws of each replicate.
fn replicates(campaign: &Campaign) -> Vec<Vec<Episode>> {
    let count = campaign.sampling.replicates().unwrap();
    let of_one = |replicate: u32| {
        let episodes = (0..campaign.episodes).filter(|episode| episode % count == replicate);
        episodes
            .map(|episode| draw(campaign.first_group(), episode))
            .collect()
    };
    (0..count).map(of_one).collect()
}

/// A quantity of an episode on a scale from 0 to 1.
type Unit = Box<dyn Fn(&Episode) -> f64>;

/// Quantities of every stream that are uniform on a known range, as numbers from 0 to 1.
fn uniform_quantities() -> Vec<Unit> {
    let mut all: Vec<Unit> = vec![
        Box::new(|e| (e.agents[0].mass_scale - 0.8) / 0.4),
        Box::new(|e| (e.agents[0].inertia_scale - 0.8) / 0.4),
    ];
    for agent in 0..3 {
        all.push(Box::new(move |e| {
            (e.agents[agent].faults[0].onset_s - 2.5) / 1.5
        }));
        for channel in [0, 5] {
            for (parameter, low, width) in [(0, 50.0, 100.0), (1, 1.0, 4.0)] {
                all.push(Box::new(move |e| {
                    (e.agents[agent].disturbances[0][parameter][channel] - low) / width
                }));
            }
            all.push(Box::new(move |e| {
                (e.agents[agent].faults[1].parameters[0][channel] - 0.1) / 0.9
            }));
        }
    }
    all
}

/// Whether each of the equal parts of a box holds one of the numbers.
fn one_each<const D: usize>(points: &[[f64; D]], parts: [usize; D]) -> bool {
    let mut hit = vec![0; parts.iter().product()];
    for point in points {
        let place = |place, k: usize| place * parts[k] + (point[k] * parts[k] as f64) as usize;
        hit[(0..D).fold(0, place)] += 1;
    }
    hit.iter().all(|&count| count == 1)
}

#[test]
fn every_quantity_meets_each_range_once_in_a_replicate_of_a_design() {
    for (design, rows) in [("latin-hypercube", 24), ("sobol", 16)] {
        let campaign = sampled(design, 4, 4 * rows as u32);
        let quantities = uniform_quantities();
        let mut columns: Vec<Vec<u64>> = Vec::new();
        for replicate in replicates(&campaign) {
            assert_eq!(replicate.len(), rows);
            for quantity in &quantities {
                let points: Vec<[f64; 1]> = replicate.iter().map(|e| [quantity(e)]).collect();
                assert!(one_each(&points, [rows]), "{design}");
                columns.push(points.iter().map(|[x]| (x * 1e9) as u64).collect());
            }
            // Half of the episodes are coupled, and a quarter of the agents of each number has the loss.
            let coupled = replicate
                .iter()
                .filter(|e| e.agents[0].kappa == 1.0)
                .count();
            assert_eq!(coupled, rows / 2);
            for agent in 0..3 {
                let struck = |e: &&Episode| e.agents[agent].faults[0].occurs();
                assert_eq!(replicate.iter().filter(struck).count(), rows / 4);
            }
        }
        // No two quantities, and no two replicates, have the same numbers.
        columns.sort();
        assert!(columns.windows(2).all(|pair| pair[0] != pair[1]));
    }
    // Negative control: independent numbers are not balanced.
    let plain = altered("smoke", &[]);
    let points: Vec<[f64; 1]> = (0..16)
        .map(|episode| [uniform_quantities()[0](&draw(plain.first_group(), episode))])
        .collect();
    assert!(!one_each(&points, [16]));
}

#[test]
fn the_parameters_of_a_channels_disturbance_share_a_net() {
    let campaign = sampled("sobol", 4, 64);
    for replicate in replicates(&campaign) {
        for (agent, channel) in [(0, 0), (1, 3), (2, 5)] {
            let pair = |e: &Episode| {
                let values = &e.agents[agent].disturbances[0];
                [
                    (values[0][channel] - 50.0) / 100.0,
                    (values[1][channel] - 1.0) / 4.0,
                ]
            };
            let points: Vec<[f64; 2]> = replicate.iter().map(pair).collect();
            for parts in [[16, 1], [8, 2], [4, 4], [2, 8], [1, 16]] {
                assert!(one_each(&points, parts), "{parts:?}");
            }
        }
    }
    // Negative control: a hypercube balances no pairs.
    let hypercube = sampled("latin-hypercube", 4, 64);
    let balanced = replicates(&hypercube).iter().all(|replicate| {
        let pair = |e: &Episode| {
            let values = &e.agents[0].disturbances[0];
            [(values[0][0] - 50.0) / 100.0, (values[1][0] - 1.0) / 4.0]
        };
        one_each(&replicate.iter().map(pair).collect::<Vec<_>>(), [4, 4])
    });
    assert!(!balanced);
}

#[test]
fn designs_leave_alone_what_they_do_not_concern() {
    let first = |campaign: &Campaign| {
        (0..32)
            .map(|k| draw(campaign.first_group(), k))
            .collect::<Vec<_>>()
    };
    let plain = altered("smoke", &[]);
    let named = altered("smoke", &["sampling.design=independent"]);
    assert_eq!(first(&plain), first(&named));
    // A longer run of nets begins as a shorter one; a hypercube belongs to its size.
    assert_eq!(
        first(&sampled("sobol", 4, 32)),
        first(&sampled("sobol", 4, 128))
    );
    assert_ne!(
        first(&sampled("latin-hypercube", 4, 32)),
        first(&sampled("latin-hypercube", 4, 128))
    );
    // Another fault changes nothing of the others.
    let more =
        "[[fault]]\ntarget = \"sensor\"\nkind = \"bias\"\nmagnitude = { uniform = [0.0, 0.1] }";
    let with_more = altered(
        "smoke",
        &[more, "sampling={ design = \"sobol\", replicates = 4 }"],
    );
    let mut longer = first(&with_more);
    for agent in longer.iter_mut().flat_map(|episode| &mut episode.agents) {
        agent.faults.truncate(2);
    }
    assert_eq!(longer, first(&sampled("sobol", 4, 32)));
}

/// Scores of eight replicates of eight episodes: in replicate r the first controller fails r times, and the errors of
/// the second are e^r times as large.
fn scores(campaign: &Campaign) -> Scores {
    let fared = |controller: usize, episode: usize, _: usize| {
        let (replicate, row) = (episode % 8, episode / 8);
        match controller {
            0 if row < replicate => (Status::Exceeded, 0.01),
            1 => (Status::Ok, 0.01 * (replicate as f64).exp()),
            _ => (Status::Ok, 0.01),
        }
    };
    let mut scores = scores_of_channels(campaign, fared);
    scores.fault_occurs = vec![vec![true; 64]; campaign.first_group().faults.len()];
    let sizes = (0..64).map(|k| f64::from(k * 37 % 64)).collect();
    scores.conditions = vec![("mass_scale".into(), sizes)];
    scores
}

/// Number of rows in which a column has a value.
fn filled(table: &Table, column: &str) -> usize {
    let frame = table.to_frame().unwrap();
    let column = frame.column(column).unwrap();
    column.len() - column.null_count()
}

#[test]
fn what_a_design_does_not_allow_is_null_and_students_t_over_replicates_takes_its_place() {
    for design in ["latin-hypercube", "sobol"] {
        let campaign = sampled(design, 8, 64);
        let scores = scores(&campaign);
        let (summary, comparisons) = (summarise(&campaign, &scores), compare(&campaign, &scores));
        // Rates 0/8 to 7/8: mean 3.5/8, standard error sqrt(6/8)/8; Student's t of 7 degrees of freedom at 95 % is
        // 2.364624.
        let rate = &summary[0].failures;
        let t = rate.interval.unwrap();
        let half_width = 2.364_624 * 0.75_f64.sqrt() / 8.0;
        assert!((t.lower - (0.4375 - half_width)).abs() < 1e-6, "{t:?}");
        assert!((t.upper - (0.4375 + half_width)).abs() < 1e-6, "{t:?}");
        // Log-ratios 0 to 7.
        let ratio = &comparisons[0].ratios[0];
        let found = ratio.over_replicates.unwrap();
        let (t, half_width) = (found.estimate, 2.364_624 * 0.75_f64.sqrt());
        assert!(
            (t.value - 3.5).abs() < 1e-9 && (t.interval.lower - (3.5 - half_width)).abs() < 1e-5
        );
        // t = 3.5 / sqrt(0.75) = 4.0415 of 7 degrees of freedom.
        assert!((found.p - 0.004_926).abs() < 5e-6, "{}", found.p);
        // The other never fails: the difference is the rate.
        let found = comparisons[0].over_replicates.unwrap();
        assert_eq!(
            comparisons[0].known().unwrap().interval,
            Some(found.estimate.interval)
        );
        assert!((found.estimate.interval.lower - rate.interval.unwrap().lower).abs() < 1e-12);
        assert!((found.p - 0.004_926).abs() < 5e-6, "{}", found.p);
        // A controller that never fails shows no scatter, which proves nothing.
        let of_all = || {
            summary
                .iter()
                .map(|row| &row.failures)
                .filter(|rate| &*rate.stratum == "all")
        };
        assert!(of_all().all(|rate| rate.interval.is_some() == (rate.controller == "ftc")));

        // Student's t decides, at 5 % over the three things that are looked at: 0.005 is enough.
        let said = verdict(&campaign, &summary, &comparisons, &[]);
        // What speaks against the first controller comes first.
        assert!(
            said[0].starts_with("ftc does worse than pid-tuned: "),
            "{said:?}"
        );
        let words = "ftc fails less often";
        assert!(!said[1].contains(words), "{said:?}");
        assert!(
            said[1].starts_with("ftc follows more closely than pid, but fails more often: "),
            "{said:?}"
        );
        assert!(
            said[1].contains("(+43.8 points [+18.2, +69.3])"),
            "{said:?}"
        );
        // What no interval tells is not called unclear.
        let few = sampled(design, 4, 64);
        let said = verdict(
            &few,
            &summarise(&few, &scores),
            &compare(&few, &scores),
            &[],
        )
        .join("");
        assert!(said.contains(" points, no interval)"), "{said}");
        assert!(
            said.starts_with("nothing here says how sure a difference between ftc and pid is: "),
            "{said}"
        );
        assert!(!said.contains("no clear difference"), "{said}");

        let summary = summary_table(&summary);
        let comparison = comparison_table(&campaign, &comparisons);
        let ranking = ranking_table(&rank(&campaign, &scores));
        for (table, names) in [
            (&summary, &["failure_rate", "q50"] as &[_]),
            (
                &comparison,
                &[
                    "failure_rate_difference",
                    "log_ratio",
                    "win_rate",
                    "failure_rate_difference_replicates_lower",
                    "log_ratio_replicates_lower",
                ],
            ),
            (&ranking, &["trend", "shape"]),
        ] {
            for name in names {
                assert!(filled(table, name) > 0, "{name}");
            }
        }
        for (table, names) in [
            (
                &summary,
                &[
                    "failure_rate_wilson_lower",
                    "failure_rate_upper_95",
                    "q50_lower",
                ] as &[_],
            ),
            (
                &comparison,
                &[
                    "mcnemar_mid_p",
                    "mcnemar_mid_p_holm",
                    "failure_rate_difference_upper",
                    "log_ratio_lower",
                    "win_rate_lower",
                ],
            ),
            (&ranking, &["trend_lower", "trend_p", "shape_p", "p_holm"]),
        ] {
            for name in names {
                assert_eq!(filled(table, name), 0, "{name}");
            }
        }
    }
    // Permutations are a test within one hypercube, and four replicates are too few for an interval.
    let scores_of = |design, replicates| scores(&sampled(design, replicates, 64));
    let tested = |design, replicates| {
        let campaign = sampled(design, replicates, 64);
        let ranking = rank(&campaign, &scores_of(design, replicates));
        assert!(ranking.iter().all(|own| own.trend.interval.is_none()));
        ranking.iter().all(|own| own.p_holm.is_some())
    };
    assert!(tested("latin-hypercube", 1) && !tested("latin-hypercube", 8) && !tested("sobol", 1));
    let few = sampled("sobol", 4, 64);
    let rates = summarise(&few, &scores_of("sobol", 4));
    assert!(rates.iter().all(|row| row.failures.interval.is_none()));
}

#[test]
fn the_replicate_is_a_column_and_an_episode_of_a_design_is_replayed() {
    let campaign = sampled("latin-hypercube", 8, 16).with(|own| own.time.steps = 1500);
    let frame = tables(&campaign, Precision::F32)
        .episodes
        .to_frame()
        .unwrap();
    for row in 0..frame.height() {
        let value = |name| -> u64 {
            let value = frame.column(name).unwrap().get(row).unwrap();
            value.to_string().parse().unwrap()
        };
        assert_eq!(value("replicate"), value("episode") % 8);
    }
    let campaign = sampled("latin-hypercube", 8, 16);
    let dir = tempfile::tempdir().unwrap();
    let out = OutputDir::claim(&dir.path().join("run"), &campaign, false).unwrap();
    let options = RunOptions::cpu(Precision::F32);
    run(&campaign, &options, &out, Extras::default(), &|_| ()).unwrap();
    let again = replay(out.path(), 11, "pid", None).unwrap();
    let scores = tables(&campaign, Precision::F32).scores;
    assert!(scores.groups[0].holds(campaign.first_group(), 1, 11, &again.outcomes));
}
