//! What is said of each stratum, against numbers worked out by hand.

use super::{scores_of_agents, scores_of_channels, with_error};
use crate::common::altered;
use urts_mc::campaign::{Campaign, Strata};
use urts_mc::random::philox::{Address, Stream};
use urts_mc::results::flights::Chatter;
use urts_mc::results::scores::{AgentScores, Scores, Status};
use urts_mc::results::sensitivity::worst;
use urts_mc::results::{
    RateMethod, compare, comparison_table, requirements, screen, summarise, summary_table, verdict,
};

/// One UAV under two controllers; episodes take turns: an actuator fault, a sensor fault, none.
fn campaign(episodes: u32) -> Campaign {
    altered(
        "smoke",
        &[
            "strata=[{ faults = \"each\" }, { faults = [] }]",
            "require.+={ controller = \"ftc\", stratum = \"none\", failure_rate_upper_95 = 0.4 }",
            "require.+={ controller = \"ftc\", failure_rate_upper_95 = 0.4 }",
            "agent.team=1",
            "controllers.2=",
            "reference.agents.2=",
            "reference.agents.1=",
            &format!("episodes={episodes}"),
        ],
    )
}

/// Scores without a simulation: whether a controller fails in an episode, and its RMS error on all channels of all
/// agents.
fn scores(campaign: &Campaign, outcome: impl Fn(usize, usize) -> (Status, f64)) -> Scores {
    scores_of_channels(campaign, |controller, episode, _| {
        outcome(controller, episode)
    })
}

/// In 30 episodes, ten of each stratum: the FTC fails twice with the actuator fault; the PID fails in seven others of
/// those, and five times with the sensor fault; its errors are 2, 3 and 5 times those of the FTC.
fn by_hand(campaign: &Campaign) -> Scores {
    scores(campaign, |controller, episode| {
        let (turn, stratum) = (episode / 3, episode % 3);
        let fails = match (controller, stratum) {
            (0, 0) => turn < 2,
            (1, 0) => turn > 2,
            (1, 1) => turn < 5,
            _ => false,
        };
        let status = if fails { Status::Exceeded } else { Status::Ok };
        let error = [1.0, [2.0, 3.0, 5.0][stratum]][controller];
        (status, 0.01 * error)
    })
}

#[test]
fn each_stratum_is_compared_by_its_own_episodes() {
    let campaign = campaign(30);
    let scores = by_hand(&campaign);
    let comparisons = compare(&campaign, &scores);
    let names = [
        "all",
        "actuator loss-of-effectiveness",
        "sensor smoothed-square",
        "none",
    ];
    // (both, only ftc, only pid, neither), McNemar's mid-p of the discordant ones, which is twice the sum of the
    // binomial probabilities below the smaller count and half of its own: 2 of 14, 2 of 9, 0 of 5, 0 of 0.
    let mid_p_of_2_in_14 = 2.0 * (1.0 + 14.0 + 91.0 / 2.0) / 16384.0;
    let mid_p_of_2_in_9 = 2.0 * (1.0 + 9.0 + 36.0 / 2.0) / 512.0;
    let expected = [
        ((0, 2, 12, 16), mid_p_of_2_in_14, 4.0 * mid_p_of_2_in_14),
        ((0, 2, 7, 1), mid_p_of_2_in_9, 2.0 * mid_p_of_2_in_9),
        ((0, 0, 5, 5), 1.0 / 32.0, 3.0 / 32.0),
        ((0, 0, 0, 10), 1.0, 1.0),
    ];
    assert_eq!(comparisons.len(), 4);
    for ((found, name), (counts, mid_p, p_holm)) in comparisons.iter().zip(names).zip(expected) {
        assert_eq!(
            (&*found.a, &*found.b, &*found.stratum),
            ("ftc", "pid", name)
        );
        let own = found.failures;
        assert_eq!((own.both, own.only_a, own.only_b, own.neither), counts);
        // Sums of a few exact fractions.
        assert!((found.mid_p.unwrap() - mid_p).abs() < 1e-12, "{found:?}");
        assert!((found.p_holm.unwrap() - p_holm).abs() < 1e-12, "{found:?}");
    }
    for (found, times) in comparisons.iter().zip([3.0, 2.0, 3.0, 5.0_f64]) {
        for ratio in &found.ratios {
            let log_ratio = ratio.log_ratio.unwrap();
            assert!((log_ratio.value - times.ln()).abs() < 1e-12);
            assert!(log_ratio.interval.is_some() && ratio.over_replicates.is_none());
            assert_eq!(ratio.win_rate.unwrap().value, 1.0);
        }
    }
    let frame = comparison_table(&campaign, &comparisons)
        .to_frame()
        .unwrap();
    for name in ["stratum", "mcnemar_mid_p", "mcnemar_mid_p_holm"] {
        assert!(frame.column(name).is_ok(), "{name}");
    }
}

#[test]
fn each_stratum_has_its_own_failure_rates_and_may_be_required() {
    let campaign = campaign(30);
    let scores = by_hand(&campaign);
    let summary = summarise(&campaign, &scores);
    let failed = |controller: &str, stratum: &str| {
        let mut rows = summary.iter().map(|row| &row.failures);
        let row = rows.find(|row| row.controller == controller && &*row.stratum == stratum);
        let row = row.unwrap();
        assert!(row.method == RateMethod::Wilson && row.interval.is_some());
        (row.failed(), row.n)
    };
    assert_eq!(failed("ftc", "all"), (2, 30));
    assert_eq!(failed("ftc", "actuator loss-of-effectiveness"), (2, 10));
    assert_eq!(failed("pid", "sensor smoothed-square"), (5, 10));
    assert_eq!(failed("pid", "none"), (0, 10));
    // Two controllers, four parts, two groups, seven numbers of an episode: nothing else is a part.
    assert_eq!(summary_table(&summary).to_frame().unwrap().height(), 112);
    // Of 10 without failure the bound is 1 - 0.05^(1/10) = 0.26, of 2 in 30 it is 0.20.
    let results = requirements(&campaign, &[], &scores);
    assert_eq!(results.len(), 2);
    assert!(results.iter().all(|result| result.is_met()), "{results:?}");
    let strict = campaign.clone().with(|own| {
        for requirement in &mut own.requirements {
            requirement.limit = 0.25;
        }
    });
    let results = requirements(&strict, &[], &scores);
    let [none, all] = results.as_slice() else {
        panic!("{results:?}");
    };
    assert_eq!(
        (none.subject(), none.limit),
        ("ftc in \"none\"".into(), 0.25)
    );
    assert_eq!((all.subject(), all.limit), ("ftc".into(), 0.25));
    assert_eq!((none.is_met(), none.failed, none.n), (false, 0, 10));
    assert_eq!((all.is_met(), all.failed, all.n), (true, 2, 30));
    assert!((none.bound_95.unwrap() - (1.0 - 0.05_f64.powf(0.1))).abs() < 1e-9);
}

#[test]
fn the_fault_that_hurts_most_is_found_and_what_cannot_be_told_apart_is_named() {
    // 600 episodes: of the 200 with each fault the PID fails in 100 and in 40; the FTC never does. Errors of the FTC
    // double with the sensor fault, and scatter by a factor of 1.1 either way.
    let campaign = campaign(600);
    let scores = scores(&campaign, |controller, episode| {
        let (turn, stratum) = (episode / 3, episode % 3);
        let fails = controller == 1
            && match stratum {
                0 => turn % 2 == 0,
                1 => turn % 5 == 0,
                _ => false,
            };
        let scatter = 1.1_f64.powf((turn % 21) as f64 / 10.0 - 1.0);
        let growth = if stratum == 1 { 2.0 } else { 1.0 };
        let status = if fails { Status::Exceeded } else { Status::Ok };
        (status, 0.01 * scatter * growth)
    });
    let screenings = screen(&campaign, &scores);
    let [ftc, pid] = screenings.as_slice() else {
        panic!("two controllers")
    };
    assert_eq!((&*ftc.reference, &*pid.reference), ("none", "none"));
    // Indices of the strata: the actuator's fault, then the sensor's.
    assert_eq!(pid.most_failures, [0]);
    assert_eq!(ftc.most_failures, [0, 1]);
    assert_eq!(ftc.most_growth, [[1], [1]]);
    let more = pid.harms[0].failures.unwrap();
    assert_eq!(more.value, 0.5);
    // Newcombe's interval of 100 in 200 against 0 in 200, from Wilson's (0.4314, 0.5686) and (0, 0.0188).
    assert!(
        (more.interval.lower - 0.4288).abs() < 1e-4 && (more.interval.upper - 0.5686).abs() < 1e-4
    );
    let growth = &ftc.harms[1].growth[0];
    assert_eq!(&*growth.group, "position");
    assert!(growth.may_grow_most);
    let growth = growth.log_growth.unwrap();
    assert!((growth.value - 2f64.ln()).abs() < 1e-12);
    assert!(growth.interval.lower > 0.6 && growth.interval.upper < 0.8);
    let none = &ftc.harms[0].growth[0];
    assert!(!none.may_grow_most);
    let none = none.log_growth.unwrap().interval;
    assert!(none.lower < 0.0 && 0.0 < none.upper);
}

#[test]
fn without_a_stratum_free_of_faults_the_mildest_is_the_reference() {
    let campaign = altered("smoke", &["strata.+={ faults = \"each\" }"]);
    let scores = scores(&campaign, |_, episode| {
        let fails = episode % 2 == 0;
        (if fails { Status::Diverged } else { Status::Ok }, 0.01)
    });
    for screening in screen(&campaign, &scores) {
        assert_eq!(&*screening.reference, "sensor smoothed-square");
        assert_eq!(screening.harms.len(), 1);
        // A controller that always diverges has errors that are larger by infinitely much.
        let growth = screening.harms[0].growth[0].log_growth.unwrap();
        assert_eq!(growth.interval.lower, f64::INFINITY);
    }
    // A campaign that is not divided, or has one such stratum, has nothing to compare.
    let plain = altered("smoke", &[]);
    assert!(screen(&plain, &scores_of(&plain)).is_empty());
}

fn scores_of(campaign: &Campaign) -> Scores {
    scores(campaign, |_, _| (Status::Ok, 0.01))
}

#[test]
fn the_stratum_that_is_truly_the_worst_is_rarely_ruled_out() {
    // Failure rates 0.2 in both strata with faults: either is the worst, and is ruled out where the other is found
    // worse, which is to happen in 5 % of the campaigns at most. With 0.2 and 0.5 the milder one is ruled out almost
    // always.
    let campaign = campaign(240);
    let ruled_out = |rates: [f64; 2], stratum: usize| {
        let experiments = 2000;
        let happens = |experiment: u32| {
            let scores = scores(&campaign, |controller, episode| {
                let address = Address {
                    episode: u32::try_from(episode).unwrap(),
                    stream: Stream::Initial,
                    entry: 99,
                    member: experiment,
                    index: controller as u32,
                };
                let rate = *rates.get(episode % 3).unwrap_or(&0.0);
                let fails = address.unit(7) < rate;
                (if fails { Status::Exceeded } else { Status::Ok }, 0.01)
            });
            !screen(&campaign, &scores)[0]
                .most_failures
                .contains(&stratum)
        };
        let count = (0..experiments).filter(|&k| happens(k)).count();
        count as f64 / f64::from(experiments)
    };
    let wrongly = ruled_out([0.2, 0.2], 0);
    println!("ruled out wrongly: {wrongly}");
    // Three standard errors of 5 % are 1.5 points; Wilson's intervals err a little more than they say at such rates.
    assert!(wrongly <= 0.05 + 0.015 + 0.005, "{wrongly}");
    assert!(ruled_out([0.2, 0.5], 0) > 0.95);
}

/// What is said of 30 episodes in which the controllers fail so often, and in which their errors have this ratio (PID
/// to FTC).
fn said(failures: [usize; 2], ratio: f64) -> String {
    let campaign = campaign(30);
    let scores = scores(&campaign, |controller, episode| {
        let status = match episode < failures[controller] {
            true => Status::Exceeded,
            false => Status::Ok,
        };
        (status, 0.01 * [1.0, ratio][controller])
    });
    let sentences = verdict(
        &campaign,
        &summarise(&campaign, &scores),
        &compare(&campaign, &scores),
        &[],
    );
    assert_eq!(sentences.len(), 1, "{sentences:?}");
    sentences[0].clone()
}

#[test]
fn the_verdict_says_who_is_better_and_only_where_an_interval_leaves_no_doubt() {
    for (failures, ratio, words) in [
        (
            [0, 15],
            3.0,
            &[
                "ftc does better than pid: it fails in 0.0 % of the episodes, the other in 50.0 % (-50.0 points [",
                "in the median its RMS error is 3.00 times smaller [3.00, 3.00] in position and 3.00",
            ] as &[_],
        ),
        (
            [15, 0],
            0.25,
            &[
                "ftc does worse than pid: ",
                "4.00 times larger [4.00, 4.00] in attitude",
            ],
        ),
        (
            [15, 0],
            12.0,
            &[
                "ftc follows more closely than pid, but fails more often: ",
                "12.0 times smaller",
            ],
        ),
        (
            [0, 15],
            0.5,
            &[
                "ftc fails less often than pid, but follows less closely: ",
                "2.00 times larger",
            ],
        ),
        // One failure more in 30 is nothing, and equal errors are not different.
        (
            [1, 2],
            1.0,
            &[
                "30 episodes do not tell ftc and pid apart: ",
                "the other in 6.7 % (-3.3 points [",
                "), no clear difference; ",
                "in the median its RMS error is not clearly different",
            ],
        ),
        ([0, 0], 2.0, &["ftc does better than pid: neither fails; "]),
        (
            [30, 30],
            1.0,
            &[
                "apart: both fail in every episode; in the median its RMS error is not clearly different",
            ],
        ),
    ] {
        let said = said(failures, ratio);
        for word in words {
            assert!(said.contains(word), "{word:?} is missing from: {said}");
        }
    }
}

#[test]
fn the_verdict_on_one_episode_claims_nothing_of_others() {
    let campaign = campaign(3).with(|own| (own.episodes, own.strata) = (1, Strata::default()));
    let scores = scores(&campaign, |controller, _| {
        (
            [Status::Ok, Status::Exceeded][controller],
            [0.01, 0.03][controller],
        )
    });
    let said = verdict(
        &campaign,
        &summarise(&campaign, &scores),
        &compare(&campaign, &scores),
        &[],
    );
    assert_eq!(
        said,
        [
            "ftc against pid in this one episode, which tells nothing of others: pid fails; the RMS error of ftc is 3.00 times \
             smaller in position and 3.00 times smaller in attitude"
        ]
    );
}

#[test]
fn a_single_controller_has_a_verdict_of_its_own() {
    let campaign = campaign(30).with(|own| own.controllers.truncate(1));
    let scores = scores(&campaign, |_, _| (Status::Ok, 0.01));
    let said = verdict(&campaign, &summarise(&campaign, &scores), &[], &[]);
    // 1 - 0.05^(1/30) = 0.09503, and a bound is never rounded down.
    assert_eq!(
        said,
        ["ftc fails in 0 of 30 episodes: with 95 % confidence its failure rate is below 9.51 %"]
    );
    let scores = self::scores(&campaign, |_, _| (Status::Exceeded, 0.01));
    let said = verdict(&campaign, &summarise(&campaign, &scores), &[], &[]);
    // Wilson's interval of 30 of 30 begins at 30 / (30 + 1.96^2) = 0.8865.
    assert_eq!(
        said,
        [
            "ftc fails in 30 of 30 episodes: with 95 % confidence its failure rate is between 88.65 and 100.00 %"
        ]
    );
}

#[test]
fn of_episodes_that_diverge_the_earlier_is_the_worse_and_blames_whom_it_struck_first() {
    let campaign = campaign(30);
    let (team, channels) = (
        campaign.first_group().team,
        campaign.first_group().channels().len(),
    );
    // The first agent is pulled along; in episode 20 the last agent goes first, and earlier than anyone in the others.
    let step = |episode: usize, agent: usize| {
        let first = match episode {
            4 => 700,
            9 => 900,
            20 => 300,
            _ => return None,
        };
        Some(first + 5 * (team - agent) as u32)
    };
    let scores = scores_of_agents(&campaign, |_, episode, agent| {
        let failed_step = step(episode, agent);
        let of_channel = |channel: usize| match failed_step {
            Some(_) if channel > 0 => with_error(f64::NAN),
            _ => with_error(0.01 * (episode + 1) as f64),
        };
        AgentScores {
            status: match (failed_step, episode) {
                (Some(_), _) => Status::Diverged,
                (None, 2) => Status::Exceeded,
                (None, _) => Status::Ok,
            },
            failed_step,
            channels: (0..channels).map(of_channel).collect(),
        }
    });
    let found = worst(&campaign, &scores);
    let of_first: Vec<_> = found.iter().filter(|own| own.controller == "ftc").collect();
    let episodes: Vec<u32> = of_first.iter().map(|own| own.episode).collect();
    // Diverged by time, then what exceeded its limits, then by the size of the error.
    assert_eq!(episodes, [20, 4, 9, 2, 29, 28, 27, 26, 25, 24]);
    let first = of_first[0];
    assert_eq!((first.agent, &*first.channel), (team - 1, "y"));
    assert_eq!(first.failed_at_s, Some(305.0 * campaign.time.step_s));
    assert!(first.excess.is_infinite() && of_first[3].failed_at_s.is_none());
}

#[test]
fn four_episodes_do_not_make_a_verdict() {
    // Four failures against none in four pairs: the interval excludes 0, McNemar's mid-p of 0.0625 does not.
    let campaign = campaign(6).with(|own| (own.episodes, own.strata) = (4, Strata::default()));
    let scores = scores(&campaign, |controller, episode| {
        let fails = controller == 1 && episode < 4;
        (if fails { Status::Exceeded } else { Status::Ok }, 0.01)
    });
    let said = verdict(
        &campaign,
        &summarise(&campaign, &scores),
        &compare(&campaign, &scores),
        &[],
    )
    .join("");
    assert!(
        said.starts_with("4 episodes do not tell ftc and pid apart: "),
        "{said}"
    );
    assert!(said.contains("no clear difference"), "{said}");
}

#[test]
fn two_episodes_that_diverge_have_no_errors_to_compare() {
    let campaign = campaign(3).with(|own| (own.episodes, own.strata) = (1, Strata::default()));
    let scores = scores(&campaign, |_, _| (Status::Diverged, f64::NAN));
    let said = verdict(
        &campaign,
        &summarise(&campaign, &scores),
        &compare(&campaign, &scores),
        &[],
    )
    .join("");
    assert!(
        said.ends_with("both fail; both diverge, so there are no errors to compare"),
        "{said}"
    );
}

#[test]
fn a_diverged_half_makes_an_error_infinitely_smaller() {
    let campaign = campaign(30);
    let scores = scores(&campaign, |controller, episode| {
        match controller == 1 && episode % 10 < 7 {
            true => (Status::Diverged, f64::NAN),
            false => (Status::Ok, 0.01),
        }
    });
    let said = verdict(
        &campaign,
        &summarise(&campaign, &scores),
        &compare(&campaign, &scores),
        &[],
    )
    .join("");
    assert!(
        said.contains("infinitely smaller [")
            && said.contains(", inf] (diverged episodes count as infinite), in position"),
        "{said}"
    );
    assert!(!said.to_lowercase().contains("nan"), "{said}");
}

#[test]
fn a_controller_that_chatters_does_not_do_better_however_closely_it_follows() {
    let campaign = campaign(60);
    let scores = scores(&campaign, |controller, episode| {
        let scatter = 1.0 + 0.01 * (episode % 7) as f64;
        (Status::Ok, 0.01 * [1.0, 3.0][controller] * scatter)
    });
    let (summary, comparisons) = (summarise(&campaign, &scores), compare(&campaign, &scores));
    let chatters = |controller: &str| Chatter {
        controller: controller.to_string(),
        sentence: format!("{controller} chatters"),
    };
    let said = |chattering: &[Chatter]| verdict(&campaign, &summary, &comparisons, chattering);
    assert!(said(&[])[0].starts_with("ftc does better than pid: "));
    let found = said(&[chatters("ftc")]);
    assert_eq!(found[0], "ftc chatters");
    assert!(
        found[1].starts_with("ftc follows more closely than pid, but chatters: "),
        "{found:?}"
    );
    // Where both do, it is no difference; where the other does, it is no merit lost.
    for chattering in [
        vec![chatters("ftc"), chatters("pid")],
        vec![chatters("pid")],
    ] {
        let found = said(&chattering);
        assert!(
            found
                .last()
                .unwrap()
                .starts_with("ftc does better than pid: "),
            "{found:?}"
        );
    }
}
