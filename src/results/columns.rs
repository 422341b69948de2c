//! The summary, the comparisons and the screening as tables.

use super::paired::{Measured, PairedComparison};
use super::replicates::Replicated;
use super::screening::Screening;
use super::summary::{MetricQuantiles, RateMethod};
use super::table::{Row, Table};
use crate::campaign::Campaign;
use crate::statistics::{Estimate, Interval};

/// The summary as a table. Columns of confidence sequences and of replicates are there where the campaign has them.
#[must_use]
pub fn summary_table(rows: &[MetricQuantiles]) -> Table {
    let mut table = Table::default();
    for MetricQuantiles {
        failures,
        metric,
        group,
        quantiles,
    } in rows
    {
        let mut row = table.row();
        row.name(|| "controller".into(), failures.controller.as_str().into())
            .name(|| "stratum".into(), failures.stratum.clone())
            .word(|| "metric".into(), metric)
            .word(|| "group".into(), group)
            .count(|| "n".into(), failures.n)
            .count(|| "failed".into(), failures.failed())
            .count(|| "exceeded".into(), failures.exceeded)
            .count(|| "diverged".into(), failures.diverged)
            .real_if("failure_rate", (failures.n > 0).then(|| failures.rate()));
        // Every table has Wilson's columns, and those of the method that holds.
        for method in [
            RateMethod::Wilson,
            RateMethod::Sequential,
            RateMethod::Replicates,
        ] {
            if method == RateMethod::Wilson || method == failures.method {
                let name = format!("failure_rate_{}", method.name());
                interval(&mut row, &name, failures.interval_by(method));
            }
        }
        row.real_if("failure_rate_upper_95", failures.upper_95);
        for (q, value, of_quantile) in quantiles {
            let name = format!("q{:02}", (q * 100.0).round());
            row.real_if(&name, *value);
            interval(&mut row, &name, *of_quantile);
        }
    }
    table
}

/// The comparisons as a table.
#[must_use]
pub fn comparison_table(campaign: &Campaign, comparisons: &[PairedComparison]) -> Table {
    let mut table = Table::default();
    for comparison in comparisons {
        for ratio in &comparison.ratios {
            let failures = &comparison.failures;
            let [only_a, only_b, both] = ratio.diverged;
            let mut row = table.row();
            row.name(|| "a".into(), comparison.a.as_str().into())
                .name(|| "b".into(), comparison.b.as_str().into())
                .name(|| "stratum".into(), comparison.stratum.clone())
                .word(|| "scope".into(), ratio.scope)
                .name(|| "name".into(), ratio.name.clone())
                .count(|| "both_failed".into(), failures.both)
                .count(|| "only_a_failed".into(), failures.only_a)
                .count(|| "only_b_failed".into(), failures.only_b)
                .count(|| "neither_failed".into(), failures.neither)
                .real_if("mcnemar_mid_p", comparison.mid_p)
                .real_if("mcnemar_mid_p_holm", comparison.p_holm);
            let plain = |value: f64| value;
            measured(
                &mut row,
                "failure_rate_difference",
                comparison.difference,
                plain,
            );
            let over_replicates = |row: &mut _, name, found: Option<Replicated>| {
                if campaign.sampling.replicates().is_some() {
                    estimate(row, name, found.map(|found| found.estimate));
                }
            };
            over_replicates(
                &mut row,
                "failure_rate_difference_replicates",
                comparison.over_replicates,
            );
            measured(&mut row, "log_ratio", ratio.log_ratio, plain);
            measured(&mut row, "ratio", ratio.log_ratio, f64::exp);
            over_replicates(&mut row, "log_ratio_replicates", ratio.over_replicates);
            measured(&mut row, "win_rate", ratio.win_rate, plain);
            row.count(|| "only_a_diverged".into(), only_a)
                .count(|| "only_b_diverged".into(), only_b)
                .count(|| "both_diverged".into(), both);
        }
    }
    table
}

/// What each stratum does to each controller, as a table.
#[must_use]
pub fn screening_table(screenings: &[Screening]) -> Table {
    let mut table = Table::default();
    for screening in screenings {
        for (index, harm) in screening.harms.iter().enumerate() {
            let mut row = table.row();
            row.name(|| "controller".into(), screening.controller.as_str().into())
                .name(|| "stratum".into(), harm.stratum.clone())
                .name(|| "reference".into(), screening.reference.clone());
            estimate(&mut row, "failure_rate_difference", harm.failures);
            row.flag(
                || "may_fail_most".into(),
                screening.most_failures.contains(&index),
            );
            for ((group, growth), most) in harm.growth.iter().zip(&screening.most_growth) {
                estimate(&mut row, &format!("log_growth_{group}"), *growth);
                row.flag(|| format!("may_grow_most_{group}"), most.contains(&index));
            }
        }
    }
    table
}

fn interval(row: &mut Row<'_>, name: &str, interval: Option<Interval>) {
    row.real_if(
        &format!("{name}_lower"),
        interval.map(|interval| interval.lower),
    )
    .real_if(
        &format!("{name}_upper"),
        interval.map(|interval| interval.upper),
    );
}

fn estimate(row: &mut Row<'_>, name: &str, estimate: Option<Estimate>) {
    row.real_if(name, estimate.map(|estimate| estimate.value));
    interval(row, name, estimate.map(|estimate| estimate.interval));
}

fn measured(row: &mut Row<'_>, name: &str, measured: Option<Measured>, scale: fn(f64) -> f64) {
    row.real_if(name, measured.map(|measured| scale(measured.value)));
    let scaled = |Interval { lower, upper }| Interval {
        lower: scale(lower),
        upper: scale(upper),
    };
    interval(
        row,
        name,
        measured.and_then(|measured| measured.interval).map(scaled),
    );
}
