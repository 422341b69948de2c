//! Everything that can be required, against bounds worked out by hand, and how often a bound is wrong.

use super::scores_of_channels;
use crate::common::altered;
use urts_mc::campaign::Campaign;
use urts_mc::controllers::GainSet;
use urts_mc::random::philox::{Address, Stream};
use urts_mc::results::scores::{ChannelGroupScores, Scores, Status};
use urts_mc::results::{RequirementResult, can_be_judged, requirements};

/// One UAV under "ftc" and "pid", with a requirement.
fn campaign(require: &str, episodes: usize) -> Campaign {
    altered(
        "smoke",
        &[
            &format!("require.+={{ controller = \"ftc\", {require} }}"),
            "agent.team=1",
            "controllers.2=",
            "reference.agents.2=",
            "reference.agents.1=",
            &format!("episodes={episodes}"),
        ],
    )
}

/// Scores with an RMS error and numbers of each channel group, by controller and episode.
fn scores(
    campaign: &Campaign,
    error: impl Fn(usize, usize) -> (Status, f64),
    group: impl Fn(usize, usize) -> ChannelGroupScores,
) -> Scores {
    let mut scores = scores_of_channels(campaign, |controller, episode, _| {
        error(controller, episode)
    });
    let groups = campaign.channel_groups().len();
    for (controller, own) in scores.groups[0].channel_groups.iter_mut().enumerate() {
        for (place, own) in own.iter_mut().enumerate() {
            *own = ChannelGroupScores {
                rmse: own.rmse,
                max_abs: own.max_abs,
                ..group(controller, place / groups)
            };
        }
    }
    scores
}

fn quiet(_: usize, _: usize) -> ChannelGroupScores {
    ChannelGroupScores {
        rmse: 0.0,
        max_abs: 0.0,
        peak: 1.0,
        effort: 1.0,
        saturated: 0.0,
        settling_s: 1.0,
        recovery_s: f64::NAN,
    }
}

fn judged(
    require: &str,
    episodes: usize,
    scores_of: impl Fn(&Campaign) -> Scores,
) -> RequirementResult {
    let campaign = campaign(require, episodes);
    let mut results = requirements(&campaign, &[], &scores_of(&campaign));
    results.remove(0)
}

#[test]
fn the_bound_of_a_quantile_is_an_order_statistic_of_the_side_that_is_asked_for() {
    // Errors 1 to 100 mm. Of 100 episodes the median is above the 59th smallest error with probability
    // P(X >= 59) = 0.0443, above the 58th with 0.0666 (X binomial, 1/2); 41 and 42 are their mirror images.
    let errors = |campaign: &Campaign| {
        let error = |_: usize, episode: usize| (Status::Ok, 1e-3 * (1 + 37 * episode % 100) as f64);
        scores(campaign, error, quiet)
    };
    let at_most = judged(
        "measure = \"rmse position p50\", at_most = 0.0591",
        100,
        errors,
    );
    assert_eq!(at_most.value, Some(0.05));
    assert!((at_most.bound_95.unwrap() - 0.059).abs() < 1e-12 && at_most.is_met());
    assert_eq!((at_most.n, at_most.failed), (100, 0));
    assert_eq!(at_most.quantity, "rmse position p50");
    let strict = judged(
        "measure = \"rmse position p50\", at_most = 0.0589",
        100,
        errors,
    );
    assert!(!strict.is_met() && strict.seems_met());
    let at_least = judged(
        "measure = \"rmse position p50\", at_least = 0.041",
        100,
        errors,
    );
    assert!((at_least.bound_95.unwrap() - 0.042).abs() < 1e-12 && at_least.is_met());
    // 0.99^100 = 0.366: no order statistic of 100 bounds a 99th percentile.
    let far = judged(
        "measure = \"rmse position p99\", at_most = 1.0",
        100,
        errors,
    );
    assert_eq!(
        (far.value, far.bound_95, far.is_met()),
        (Some(0.099), None, false)
    );
}

#[test]
fn ratios_and_differences_are_those_of_the_same_episodes() {
    // The FTC's error is twice the PID's in three of four episodes, half of it in the fourth; the medians of both are
    // alike all the same.
    let errors = |campaign: &Campaign| {
        let error = |controller: usize, episode: usize| {
            let size = 1e-3 * (1 + episode / 4) as f64;
            let of_ftc = if episode.is_multiple_of(4) { 0.5 } else { 2.0 };
            (
                Status::Ok,
                if controller == 0 { of_ftc * size } else { size },
            )
        };
        scores(campaign, error, quiet)
    };
    let ratio = judged(
        "measure = \"rmse position p50\", ratio_to = \"pid\", at_most = 1.9",
        400,
        errors,
    );
    assert!((ratio.value.unwrap() - 2.0).abs() < 1e-12 && !ratio.is_met());
    assert_eq!(ratio.quantity, "rmse position p50, ratio to pid");
    let lower = judged(
        "measure = \"rmse position p50\", ratio_to = \"pid\", at_least = 1.9",
        400,
        errors,
    );
    assert!(lower.is_met());
    let difference = judged(
        "measure = \"rmse attitude p10\", difference_to = \"pid\", at_most = -0.001",
        400,
        errors,
    );
    // One episode in four is better, by half of 1 to 100 mm: of the 100 that are better the 40th is -30.5 mm.
    assert!(
        (difference.value.unwrap() + 0.0305).abs() < 1e-12,
        "{difference:?}"
    );
    assert!(difference.is_met());
}

#[test]
fn shares_at_limits_settling_and_recovery_may_be_required_and_what_does_not_apply_is_left_out() {
    let numbers = |_: usize, episode: usize| ChannelGroupScores {
        saturated: if episode < 90 { 0.01 } else { 0.4 },
        settling_s: if episode < 98 { 2.0 } else { f64::INFINITY },
        recovery_s: match episode % 2 {
            0 => f64::NAN,
            _ => 1.0 + 1e-3 * episode as f64,
        },
        ..quiet(0, episode)
    };
    let of = |campaign: &Campaign| scores(campaign, |_, _| (Status::Ok, 0.01), numbers);
    let saturated = judged(
        "measure = \"saturated_share position p95\", at_most = 0.1",
        100,
        of,
    );
    assert_eq!((saturated.value, saturated.is_met()), (Some(0.4), false));
    assert!(
        judged(
            "measure = \"saturated_share position p50\", at_most = 0.1",
            100,
            of
        )
        .is_met()
    );
    assert!(
        judged(
            "measure = \"settling_s attitude p90\", at_most = 2.5",
            100,
            of
        )
        .is_met()
    );
    let never = judged(
        "measure = \"settling_s attitude p95\", at_most = 2.5",
        100,
        of,
    );
    // The bound of the 95th percentile is the 99th of 100 (P(X >= 99) = 0.037), which is infinite.
    assert_eq!((never.value, never.bound_95), (Some(2.0), None));
    let recovery = judged(
        "measure = \"recovery_s position p50\", at_most = 2.0",
        100,
        of,
    );
    assert_eq!(recovery.n, 50);
    assert!(
        (recovery.value.unwrap() - 1.049).abs() < 1e-12,
        "{recovery:?}"
    );
}

#[test]
fn survival_counts_those_that_have_failed_by_a_time_and_an_error_is_judged_at_the_end() {
    // Of 200 episodes of 5 s the first ten break a limit at 1 s, the next ten the limit of the RMS error.
    let of = |campaign: &Campaign| {
        let status = |_: usize, episode: usize| match episode < 20 {
            true => (Status::Exceeded, 0.1),
            false => (Status::Ok, 0.01),
        };
        let mut scores = scores(campaign, status, quiet);
        let step = campaign.time.onset_step(1.0);
        for own in &mut scores.failed_step {
            own[..10].fill(Some(step));
        }
        scores
    };
    let end_s = campaign("failure_rate_upper_95 = 0.5", 200);
    let end_s = end_s.time.shown_s(end_s.time.steps);
    let survival = |at_s: f64| {
        let require = format!("measure = \"survival_at_s {at_s}\", at_least = 0.9");
        judged(&require, 200, of)
    };
    assert_eq!(survival(0.5).value, Some(1.0));
    // 0.05^(1/200) = 0.98513.
    assert!((survival(0.5).bound_95.unwrap() - 0.98513).abs() < 1e-5);
    assert_eq!(survival(1.5).value, Some(0.95));
    assert!(survival(1.5).is_met());
    assert_eq!(survival(end_s).value, Some(0.9));
    assert!(!survival(end_s).is_met() && survival(end_s).seems_met());
}

#[test]
fn the_difference_of_failure_rates_has_tangos_bound() {
    // Of 100 episodes both fail in 5, only the FTC in 3, only the PID in 8.
    let of = |campaign: &Campaign| {
        let status = |controller: usize, episode: usize| {
            let fails = match episode {
                0..5 => true,
                5..8 => controller == 0,
                8..16 => controller == 1,
                _ => false,
            };
            (if fails { Status::Exceeded } else { Status::Ok }, 0.01)
        };
        scores(campaign, status, quiet)
    };
    let within = judged(
        "measure = \"failure_rate\", difference_to = \"pid\", at_most = 0.02",
        100,
        of,
    );
    assert!((within.value.unwrap() + 0.05).abs() < 1e-12);
    // The score (b - c - n d) / sqrt(n (2 q + d (1 - d))) with q maximising the likelihood is -1.6449 at d = 0.0050953;
    // worked out by bisection on that equation.
    assert!(
        (within.bound_95.unwrap() - 0.005_095_3).abs() < 1e-6,
        "{within:?}"
    );
    assert!(within.is_met() && within.failed == 8);
}

#[test]
fn numbers_of_the_loop_are_their_own_bounds_and_unknown_ones_are_refused_before_the_flight() {
    let known = campaign("measure = \"delay_margin_ms position\", at_least = 7.0", 4);
    let gains = GainSet::of_groups(&known).unwrap();
    let of = |campaign: &Campaign| scores(campaign, |_, _| (Status::Ok, 0.01), quiet);
    let results = requirements(&known, &gains, &of(&known));
    let margin = gains[0].controllers[0].groups[0]
        .findings
        .as_ref()
        .unwrap()
        .analysis
        .margins;
    assert_eq!(results[0].bound_95, Some(margin.delay_margin_ms));
    assert!(results[0].is_met(), "{results:?}");
    let ratio = campaign(
        "measure = \"delay_margin_ms\", ratio_to = \"pid\", at_least = 0.9",
        4,
    );
    let results = requirements(&ratio, &gains, &of(&ratio));
    // Position and attitude; the paper's PID has a larger delay margin than the FTC.
    assert_eq!(results.len(), 2);
    assert!(
        results
            .iter()
            .all(|own| !own.is_met() && own.place == results[0].place)
    );
    let rho = campaign("measure = \"certified_rho\", at_most = 10.2", 4);
    assert!(can_be_judged(&rho, &gains).is_ok());
    let results = requirements(&rho, &gains, &of(&rho));
    assert!(results.iter().all(RequirementResult::is_met), "{results:?}");
    let unknown = campaign(
        "measure = \"certified_rho\", ratio_to = \"pid\", at_most = 1.0",
        4,
    );
    let refused = can_be_judged(&unknown, &gains).unwrap_err().to_string();
    assert!(refused.contains("is not known of \"pid\""), "{refused}");
}

#[test]
fn a_bound_holds_in_95_of_100_campaigns() {
    // Ratios whose median is exp(0.1) in 4000 campaigns of 60 episodes: the upper bound is below it in at most 5 % of
    // them, and not in far fewer (of 60 the 37th: P(X >= 37) = 0.0462). Three standard deviations of 4000 are 1 %.
    let campaign = campaign(
        "measure = \"rmse position p50\", ratio_to = \"pid\", at_most = 1.0",
        60,
    );
    let wrong = (0..4000).filter(|&round| {
        // The logistic distribution, whose median is 0.
        let drawn = |episode: usize| {
            let address = Address {
                episode: u32::try_from(episode).unwrap(),
                stream: Stream::Initial,
                entry: 0,
                member: 0,
                index: 0,
            };
            let unit = address.unit(round);
            (unit / (1.0 - unit)).ln()
        };
        let error = |controller: usize, episode: usize| match controller {
            0 => (Status::Ok, (0.1 + 0.3 * drawn(episode)).exp()),
            _ => (Status::Ok, 1.0),
        };
        let result = requirements(&campaign, &[], &scores(&campaign, error, quiet));
        result[0].bound_95.unwrap() < 0.1_f64.exp()
    });
    let share = wrong.count() as f64 / 4000.0;
    assert!((share - 0.0462).abs() < 0.01, "{share}");
}
