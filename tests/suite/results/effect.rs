//! One size of an effect: what the verdict says of the errors, and what the tables show.

use super::scores_of_channels;
use crate::common::altered;
use proptest::prelude::*;
use urts_mc::campaign::Campaign;
use urts_mc::results::scores::{Scores, Status};
use urts_mc::results::{Ratio, compare, summarise, verdict};

/// One UAV under two controllers.
fn campaign(episodes: u32, settings: &[&str]) -> Campaign {
    let episodes = format!("episodes={episodes}");
    let own = [
        "agent.team=1",
        "controllers.2=",
        "reference.agents.2=",
        "reference.agents.1=",
        &episodes,
    ];
    altered("smoke", &[&own[..], settings].concat())
}

/// Scores without failures: the RMS error under a controller, in an episode, on a channel.
fn scores(campaign: &Campaign, rmse: impl Fn(usize, usize, usize) -> f64) -> Scores {
    scores_of_channels(campaign, |controller, episode, channel| {
        (Status::Ok, rmse(controller, episode, channel))
    })
}

/// The verdict on two controllers.
fn said(campaign: &Campaign, scores: &Scores) -> String {
    let sentences = verdict(
        campaign,
        &summarise(campaign, scores),
        &compare(campaign, scores),
        &[],
    );
    assert_eq!(sentences.len(), 1, "{sentences:?}");
    sentences[0].clone()
}

/// The median RMS errors of both controllers on a channel group.
fn medians(campaign: &Campaign, scores: &Scores, name: &str) -> [f64; 2] {
    let summary = summarise(campaign, scores);
    let rows = summary.iter().filter(|row| {
        row.metric == "rmse" && *row.group == *name && &*row.failures.stratum == "all"
    });
    let values: Vec<f64> = rows.map(|row| row.quantiles[0].value.unwrap()).collect();
    values.try_into().unwrap()
}

#[test]
fn the_ratio_of_a_group_is_that_of_the_tables_errors() {
    // Half the error on a channel that hardly counts, 1.5 times the error on the others: a geometric mean over channels
    // would say that the first is larger, (2 * 1 / 1.5 * 1 / 1.5 < 1), or nothing.
    let campaign = campaign(30, &[]);
    let of = [[0.001, 0.1, 0.1], [0.0005, 0.15, 0.15]];
    let scores = scores(&campaign, |controller, _, channel| {
        of[controller][channel % 3]
    });
    let by_hand = [0, 1].map(|controller: usize| {
        let squares: f64 = of[controller].iter().map(|own| own * own).sum();
        (squares / 3.0_f64).sqrt()
    });
    let comparisons = compare(&campaign, &scores);
    let groups = comparisons[0].ratios.iter();
    let groups: Vec<&Ratio> = groups.filter(|own| own.scope == "group").collect();
    assert_eq!(groups.len(), 2);
    for group in groups {
        let found = group.log_ratio.unwrap().value;
        // A root and a logarithm of the same sums.
        assert!((found - (by_hand[1] / by_hand[0]).ln()).abs() < 1e-14);
        let [first, second] = medians(&campaign, &scores, &group.name);
        assert!((found - (second / first).ln()).abs() < 1e-14);
    }
    assert!(said(&campaign, &scores).contains("1.50 times smaller"));
}

#[test]
fn a_difference_that_is_sure_but_too_small_to_count_makes_nobody_better() {
    let ratio =
        |ratio: f64| move |controller: usize, _: usize, _: usize| 0.1 * [1.0, ratio][controller];
    let as_shipped = campaign(30, &[]);
    let small = said(&as_shipped, &scores(&as_shipped, ratio(1.04)));
    assert_eq!(
        small,
        "ftc and pid follow equally well: neither fails; in the median its RMS error is 1.04 times smaller [1.04, 1.04] \
         in position, which is less than counts (1.05) and 1.04 times smaller [1.04, 1.04] in attitude, which is less \
         than counts (1.05)"
    );
    let large = said(&as_shipped, &scores(&as_shipped, ratio(1.06)));
    assert!(large.starts_with("ftc does better than pid: "), "{large}");
    // The file decides what counts.
    for (smallest, ratio_of, opening) in [
        (
            "verdict.smallest_ratio=1.0",
            1.04,
            "ftc does better than pid: ",
        ),
        (
            "verdict.smallest_ratio=1.5",
            1.45,
            "ftc and pid follow equally well: ",
        ),
        (
            "verdict.smallest_ratio=1.5",
            0.5,
            "ftc does worse than pid: ",
        ),
    ] {
        let campaign = campaign(30, &[smallest]);
        let said = said(&campaign, &scores(&campaign, ratio(ratio_of)));
        assert!(said.starts_with(opening), "{smallest}: {said}");
    }
}

#[test]
fn errors_that_are_rounding_decide_nothing() {
    let tiny = |controller: usize, _: usize, _: usize| [1e-12, 3e-12][controller];
    let as_shipped = campaign(30, &[]);
    let verdict = said(&as_shipped, &scores(&as_shipped, tiny));
    assert!(
        verdict.starts_with("30 episodes do not tell ftc and pid apart: "),
        "{verdict}"
    );
    // No error at all is no better than such a one, and not a number that is none.
    let none = |controller: usize, _: usize, _: usize| [0.0, 3e-12][controller];
    let verdict = said(&as_shipped, &scores(&as_shipped, none));
    assert!(
        verdict.contains("its RMS error is not clearly different"),
        "{verdict}"
    );
    // Whoever counts in picometres says so.
    let fine = campaign(30, &["verdict.smallest_error=1e-13"]);
    let verdict = said(&fine, &scores(&fine, tiny));
    assert!(verdict.contains("3.00 times smaller"), "{verdict}");
}

#[test]
fn a_median_of_ratios_against_the_medians_of_the_table_is_said_and_makes_nobody_better() {
    // The first is 1.1 times closer in 60 % of the episodes; in the others, 50 times farther off. Its own median is
    // 0.9, the other's 0.2.
    let campaign = campaign(200, &[]);
    let scores = scores(&campaign, |controller, episode, _| {
        let pair = match episode % 10 {
            0..3 => [0.9, 1.0],
            3..6 => [0.09, 0.1],
            _ => [10.0, 0.2],
        };
        pair[controller]
    });
    let [first, second] = medians(&campaign, &scores, "position");
    assert!(first > second);
    let said = said(&campaign, &scores);
    assert!(
        said.starts_with("200 episodes do not tell ftc and pid apart: "),
        "{said}"
    );
    assert!(
        said.contains("in position, although its own median is larger than the other's"),
        "{said}"
    );
}

/// What a verdict says of the errors on a channel group, without a "but".
fn claim(said: &str, name: &str) -> Option<&'static str> {
    let (_, errors) = said.split_once("its RMS error is ")?;
    let of_group = errors
        .split(" and ")
        .find(|own| own.contains(&format!("] in {name}")))?;
    let hedged = of_group.contains("although") || of_group.contains("less than counts");
    let word = ["smaller", "larger"]
        .into_iter()
        .find(|word| of_group.contains(&format!("times {word}")));
    word.filter(|_| !hedged)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// Errors of any shape: each episode of one of four kinds, each kind with errors of its own on every channel.
    #[test]
    fn the_verdict_and_the_table_agree_in_sign(
        kinds in prop::collection::vec(prop::array::uniform2(prop::array::uniform3(-4.0..1.0_f64)), 4),
        shares in prop::collection::vec(0_usize..4, 16..64),
    ) {
        let campaign = campaign(u32::try_from(shares.len()).unwrap(), &[]);
        let scores = scores(&campaign, |controller, episode, channel| {
            10.0_f64.powf(kinds[shares[episode]][controller][channel % 3])
        });
        let said = said(&campaign, &scores);
        let claims = ["position", "attitude"].map(|name| (claim(&said, name), medians(&campaign, &scores, name)));
        for (claim, [first, second]) in claims {
            match claim {
                Some("smaller") => prop_assert!(first <= second, "{said}: {first} {second}"),
                Some(_) => prop_assert!(first >= second, "{said}: {first} {second}"),
                None => {}
            }
        }
        if claims.iter().all(|(claim, _)| claim.is_none()) {
            let decided = said.contains("does better") || said.contains("does worse");
            prop_assert!(!decided, "{said}");
        }
    }
}
