//! The summary, the comparisons and the screening as tables.

use super::fairness::Terms;
use super::paired::{Measured, PairedComparison};
use super::replicates::Replicated;
use super::screening::Screening;
use super::summary::{MetricQuantiles, RateMethod};
use super::table::{Row, Table};
use crate::campaign::Campaign;
use crate::statistics::{Estimate, Interval};
use crate::synthesis::Margins;

/// The summary as a table. Columns of confidence sequences and of replicates are there where the campaign has them.
#[must_use]
pub fn summary_table(rows: &[MetricQuantiles]) -> Table {
    let mut table = Table::default();
    for MetricQuantiles {
        failures,
        of_group,
        metric,
        group,
        quantiles,
    } in rows
    {
        let mut row = table.row();
        row.name(|| "controller".into(), failures.controller.as_str().into())
            .name(|| "stratum".into(), failures.stratum.clone())
            .word(|| "metric".into(), metric)
            .name(|| "group".into(), group.clone())
            .count(|| "n".into(), failures.n)
            .count(|| "failed".into(), failures.failed())
            .count(|| "exceeded".into(), failures.exceeded)
            .count(|| "diverged".into(), failures.diverged)
            .real_if("failure_rate", (failures.n > 0).then(|| failures.rate()));
        // Every table has Wilson's columns, and those of the method that holds.
        for method in RateMethod::ALL {
            if method == RateMethod::Wilson || method == failures.method {
                let name = format!("failure_rate_{}", method.name());
                interval(&mut row, &name, failures.interval_by(method));
            }
        }
        row.real_if("failure_rate_upper_95", failures.upper_95);
        if let Some(own) = of_group {
            row.count(|| "group_failed".into(), own.failed())
                .count(|| "group_exceeded".into(), own.exceeded)
                .count(|| "group_diverged".into(), own.diverged)
                .real_if("group_failure_rate", (own.n > 0).then(|| own.rate()));
            let name = format!("group_failure_rate_{}", own.method.name());
            interval(&mut row, &name, own.interval);
            row.real_if("group_failure_rate_upper_95", own.upper_95);
        }
        for quantile in quantiles {
            let name = format!("q{:02}", (quantile.share * 100.0).round());
            row.real_if(&name, quantile.value);
            interval(&mut row, &name, quantile.interval);
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

/// The terms of every controller as a table.
#[must_use]
pub fn fairness_table(terms: &[Terms]) -> Table {
    let mut table = Table::default();
    for own in terms {
        let margin = |pick: fn(&Margins) -> f64| own.margins.as_ref().map(pick);
        let mut row = table.row();
        row.name(|| "controller".into(), own.controller.as_str().into())
            .name(|| "group".into(), own.group.clone())
            .real_if("crossover_rad_s", margin(|own| own.crossover_rad_s))
            .real_if("phase_margin_deg", margin(|own| own.phase_margin_deg))
            .real_if("delay_margin_ms", margin(|own| own.delay_margin_ms))
            .real_if("sensitivity_peak", margin(|own| own.sensitivity_peak))
            .real_if("noise_peak", margin(|own| own.noise_peak))
            .real_if("noise_h2", margin(|own| own.noise_h2))
            .real_if("peak_command_p95", own.peak_command_p95)
            .real_if("effort_p50", own.effort_p50)
            .real_if("saturated_share", own.saturated_share)
            .real_if("nominal_settling_s", own.nominal_settling_s)
            .real_if("settling_p50_s", own.settling_p50_s)
            .real_if("reversals_per_s", own.reversals_per_s)
            .real_if("command_rate_per_s", own.command_rate_per_s);
    }
    table
}

/// What each stratum does to each controller, as a table.
#[must_use]
pub fn screening_table(screenings: &[Screening]) -> Table {
    let mut table = Table::default();
    for screening in screenings {
        for harm in &screening.harms {
            let mut row = table.row();
            row.name(|| "controller".into(), screening.controller.as_str().into())
                .name(|| "stratum".into(), harm.stratum.clone())
                .name(|| "reference".into(), screening.reference.clone());
            estimate(&mut row, "failure_rate_difference", harm.failures);
            row.flag(|| "may_fail_most".into(), harm.may_fail_most);
            for growth in &harm.growth {
                let group = growth.group.replace(' ', "_");
                estimate(&mut row, &format!("log_growth_{group}"), growth.log_growth);
                row.flag(|| format!("may_grow_most_{group}"), growth.may_grow_most);
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
