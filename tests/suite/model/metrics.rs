//! The metrics of an episode against plain sums over what its trajectory shows.

use crate::common::{altered, gains};
use urts_mc::backend::cpu::{Cpu, Precision};
use urts_mc::model::ChannelSample;
use urts_mc::model::metric::{ERROR_METRICS, OTHER_METRICS};

/// A metric of the trajectory of a channel, from the first step of the metrics on, and from the first of all.
fn expected(
    name: &str,
    settled: &[ChannelSample],
    all: &[ChannelSample],
    step_s: f64,
) -> Option<f64> {
    let sum = |of: fn(&ChannelSample) -> f64| settled.iter().map(of).sum::<f64>();
    let largest = |shown: &[ChannelSample], of: fn(&ChannelSample) -> f64| {
        shown.iter().map(of).fold(0.0, f64::max)
    };
    let mean = |sum: f64| (sum / settled.len() as f64).sqrt();
    Some(match name {
        "rmse" => mean(sum(|shown| shown.e.powi(2))),
        "max_abs" => largest(settled, |shown| shown.e.abs()),
        "ise" => sum(|shown| shown.e.powi(2)) * step_s,
        "iae" => sum(|shown| shown.e.abs()) * step_s,
        "peak_rate" => largest(settled, |shown| shown.e_rate.abs()),
        "effort" => all.iter().map(|shown| shown.u.powi(2)).sum::<f64>() * step_s,
        "u_max" => largest(all, |shown| shown.u.abs()),
        "f1_rms_error" => mean(sum(|shown| (shown.f1_hat - shown.f1).powi(2))),
        "f2_rms_error" => mean(sum(|shown| (shown.f2_hat - shown.f2).powi(2))),
        // What is cut is not shown.
        "saturated_fraction" => return None,
        other => panic!("{other} has no definition here"),
    })
}

#[test]
fn val_every_metric_is_the_plain_sum_or_maximum_over_the_trajectory() {
    // A settling time that is no multiple of anything, and one at once.
    for (settle, controller) in [("time.settle_s=1.354", 0), ("time.settle_s=0.0", 1)] {
        let campaign = altered(
            "smoke",
            &[settle, "time.duration_s=4.5", "initial.error_rate=2.0"],
        );
        let cpu = Cpu::new(
            campaign.first_group(),
            &gains(&campaign).loops(),
            Precision::F64,
            None,
        );
        let (outcomes, snapshots) = cpu.trace(controller, 1, 1);
        let time = campaign.time;
        // Each step counts at its start; the end of the last is no step.
        let shown = &snapshots[..time.steps as usize];
        let (mut compared, mut early) = (0, 0);
        for (agent, outcome) in outcomes.iter().enumerate() {
            for (channel, outcome) in outcome.channels.iter().enumerate() {
                let all: Vec<ChannelSample> = shown
                    .iter()
                    .map(|shown| shown.agents[agent][channel])
                    .collect();
                let settled = &all[time.settle_step as usize..];
                for metric in ERROR_METRICS.iter().chain(OTHER_METRICS) {
                    let found = (metric.of)(outcome);
                    let Some(expected) = expected(metric.name, settled, &all, time.step_s) else {
                        assert_eq!(found, 0.0);
                        continue;
                    };
                    // Sums of some thousand doubles in another order.
                    let apart = (found - expected).abs() / expected;
                    assert!(apart < 1e-11, "{}: {found} and not {expected}", metric.name);
                    compared += 1;
                }
                let whole = all.iter().map(|shown| shown.e_rate.abs());
                early += usize::from(whole.fold(0.0, f64::max) > outcome.peak_rate);
            }
        }
        assert_eq!(compared, 3 * 6 * 9);
        // Some peaks lie before settle_s, and do not count.
        assert_eq!(early > 0, time.settle_step > 0, "{early}");
    }
}
