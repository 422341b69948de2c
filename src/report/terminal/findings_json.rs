//! What a run found, for programs.

use crate::results::{FailureRate, Measured, RateMethod, Replicated};
use crate::run::Findings;
use crate::statistics::{Estimate, Interval};
use serde_json::{Value, json};

/// The findings of a run for programs.
pub fn findings_json(findings: &Findings) -> Value {
    let interval = |interval: Interval| json!([finite(interval.lower), finite(interval.upper)]);
    let replicated = |found: Option<Replicated>| {
        found.map(|Replicated { estimate, p }| {
            json!({ "value": finite(estimate.value), "interval_95": interval(estimate.interval), "p": p })
        })
    };
    let estimate = |estimate: Option<Estimate>| {
        estimate.map(|estimate| json!({ "value": finite(estimate.value), "interval_95": interval(estimate.interval) }))
    };
    let measured = |measured: Option<Measured>| {
        measured.map(
            |own| json!({ "value": finite(own.value), "interval_95": own.interval.map(interval) }),
        )
    };
    let rate = |rate: &FailureRate| {
        json!({
            "controller": rate.controller, "stratum": *rate.stratum, "n": rate.n, "failed": rate.failed(),
            "exceeded": rate.exceeded, "diverged": rate.diverged, "failure_rate": rate.rate(),
            "wilson_95": rate.interval_by(RateMethod::Wilson).map(interval),
            "sequential_95": rate.interval_by(RateMethod::Sequential).map(interval),
            "replicates_95": rate.interval_by(RateMethod::Replicates).map(interval), "upper_95": rate.upper_95,
        })
    };
    let growth = |(group, growth): &(&'static str, Option<Estimate>)| json!({ "group": group, "log_growth": estimate(*growth) });
    json!({
        "verdict": findings.manifest.verdict,
        "manifest": findings.manifest,
        "failures": findings.results.summary.iter().map(|row| &row.failures).fold(Vec::new(), |mut rates, failures| {
            if rates.last() != Some(&failures) { rates.push(failures); }
            rates
        }).into_iter().map(rate).collect::<Vec<_>>(),
        "errors": findings.results.summary.iter().map(|row| json!({
            "controller": row.failures.controller, "stratum": *row.failures.stratum, "metric": row.metric, "group": row.group,
            "quantiles": row.quantiles.iter().map(|(share, value, interval_95)| json!({
                "share": share, "value": value.and_then(finite), "interval_95": interval_95.map(interval),
            })).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "comparisons": findings.results.comparisons.iter().map(|comparison| json!({
            "a": comparison.a, "b": comparison.b, "stratum": *comparison.stratum,
            "both_failed": comparison.failures.both, "only_a_failed": comparison.failures.only_a,
            "only_b_failed": comparison.failures.only_b, "neither_failed": comparison.failures.neither,
            "mcnemar_mid_p": comparison.mid_p, "mcnemar_mid_p_holm": comparison.p_holm,
            "failure_rate_difference": measured(comparison.difference),
            "failure_rate_difference_replicates": replicated(comparison.over_replicates),
            "log_ratios": comparison.ratios.iter().map(|ratio| json!({
                "scope": ratio.scope, "name": ratio.name, "log_ratio": measured(ratio.log_ratio),
                "log_ratio_replicates": replicated(ratio.over_replicates), "win_rate": measured(ratio.win_rate), "diverged_only_a_only_b_both": ratio.diverged,
            })).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "screening": findings.results.screenings.iter().map(|screening| json!({
            "controller": screening.controller, "reference": *screening.reference,
            "strata": screening.harms.iter().enumerate().map(|(index, harm)| json!({
                "stratum": *harm.stratum, "failure_rate_difference": estimate(harm.failures),
                "may_fail_most": screening.most_failures.contains(&index),
                "growth": harm.growth.iter().map(growth).collect::<Vec<_>>(),
                "may_grow_most": screening.most_growth.iter().map(|most| most.contains(&index)).collect::<Vec<_>>(),
            })).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "ranking": findings.results.ranking.iter().map(|ranked| json!({
            "target": ranked.target.kind, "controller": ranked.target.controller, "against": ranked.target.against,
            "group": ranked.target.group, "condition": ranked.condition, "episodes": ranked.effect.n,
            "trend": measured(Some(Measured { value: ranked.effect.trend.value, interval: ranked.interval })), "shape": ranked.effect.shape, "p_holm": ranked.p_holm,
        })).collect::<Vec<_>>(),
        "worst_episodes": findings.results.worst.iter().map(|worst| json!({
            "controller": worst.controller, "rank": worst.rank, "episode": worst.episode, "status": worst.status.word(),
            "largest_error_over_limit": finite(worst.excess), "failed_at_s": worst.failed_at_s,
            "agent": worst.agent, "channel": *worst.channel,
            "stratum": worst.stratum.as_deref(), "faults": worst.faults.iter().map(|name| &**name).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "requirements": findings.manifest.requirements.iter().map(|result| json!({
            "controller": result.controller, "stratum": result.stratum, "limit": result.limit, "upper_95": result.upper_95,
            "n": result.n, "failed": result.failed, "met": result.is_met(),
        })).collect::<Vec<_>>(),
    })
}

/// JSON has no infinity: it is written as null, as in the Parquet tables' readers.
pub(super) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
