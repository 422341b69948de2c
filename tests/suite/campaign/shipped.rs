//! Every shipped campaign, and what the paper and the specification expect of the two big ones.

use crate::common::{altered, campaign, shipped_campaigns, simulate, tables};
use polars::prelude::DataType;
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::{Campaign, Distribution, FaultKind, FaultTarget};
use urts_mc::controllers::GainSet;
use urts_mc::draw::draw;
use urts_mc::results::scores::Status;
use urts_mc::results::{compare, summarise};

#[test]
fn every_shipped_campaign_is_valid_and_bears_its_file_name() {
    let mut count = 0;
    for path in shipped_campaigns() {
        let campaign = Campaign::load(&path).unwrap();
        assert_eq!(
            Some(campaign.name.as_str()),
            path.file_stem().and_then(|stem| stem.to_str())
        );
        GainSet::synthesize_or_load(campaign.first_group()).unwrap();
        count += 1;
    }
    assert!(count >= 13, "{count} campaigns");
}

/// Median ratio of RMS errors of each channel for a pair of controllers, averaged over the team in the logarithm, as
/// the independent run had it; what diverges has an infinite error.
fn channel_ratios(campaign: &Campaign, a: &str, b: &str) -> Vec<f64> {
    let tables = tables(campaign, Precision::F32);
    let [a, b] = [a, b].map(|name| {
        let mut names = campaign.controllers.iter();
        names.position(|own| own == name).unwrap()
    });
    let scores = &tables.scores.groups[0];
    let frame = tables.channels.to_frame().unwrap();
    let rmse = frame.column("rmse").unwrap().f64().unwrap();
    let controllers = campaign.controllers.len();
    let (team, width) = (
        campaign.first_group().team,
        campaign.first_group().channels().len(),
    );
    let log_ratio = |episode: usize, channel: usize| {
        if scores.status[b][episode] == Status::Diverged {
            return f64::INFINITY;
        }
        let of = |agent: usize| {
            let [of_b, of_a] = [b, a].map(|controller| {
                let agents = (episode * controllers + controller) * team + agent;
                rmse.get(agents * width + channel).unwrap_or(f64::INFINITY)
            });
            (of_b / of_a).ln()
        };
        (0..team).map(of).sum::<f64>() / team as f64
    };
    let of_channel = |channel| {
        let episodes = 0..tables.scores.episodes();
        median(episodes.map(|own| log_ratio(own, channel)).collect()).exp()
    };
    (0..width).map(of_channel).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let middle = values.len() / 2;
    f64::midpoint(values[middle], values[values.len() - 1 - middle])
}

#[test]
fn val_on_uav_paper_the_ftc_beats_the_pids_of_the_paper_by_7_to_20_and_never_fails() {
    // An independent run of these draws gave 19.0 and 7.6 as medians over channels.
    let controllers = "controllers=[\"ftc\", \"pid\", \"pid-robust-observer\"]";
    let campaign = altered("uav-paper", &["episodes=256", controllers]);
    let against_pid = channel_ratios(&campaign, "ftc", "pid");
    let against_robust = channel_ratios(&campaign, "ftc", "pid-robust-observer");
    println!("ftc/pid {against_pid:.2?}\nftc/pid-robust-observer {against_robust:.2?}");
    assert!(
        (15.0..20.0).contains(&median(against_pid.clone())),
        "{against_pid:?}"
    );
    assert!(
        (7.0..10.0).contains(&median(against_robust.clone())),
        "{against_robust:?}"
    );
    let status = &tables(&campaign, Precision::F32).scores.status;
    assert!(status[0].iter().all(|status| *status == Status::Ok));
    assert!(
        status[1].contains(&Status::Exceeded),
        "the plain PID exceeds in this campaign"
    );
}

#[test]
fn on_biped_paper_the_ftc_beats_pid_by_more_than_20_and_never_fails() {
    let campaign = campaign("biped-paper").with_episodes(64).unwrap();
    let against_pid = channel_ratios(&campaign, "ftc", "pid");
    println!("ftc/pid {against_pid:.2?}");
    assert!(median(against_pid.clone()) > 20.0, "{against_pid:?}");
    let status = &tables(&campaign, Precision::F32).scores.status;
    assert!(status[0].iter().all(|status| *status == Status::Ok));
}

#[test]
fn without_faults_and_from_a_zero_observer_the_ftc_loses_to_a_pid() {
    let campaign = campaign("no-fault").with_episodes(64).unwrap();
    for ratio in channel_ratios(&campaign, "ftc", "pid-robust-observer") {
        assert!(
            (0.5..0.8).contains(&ratio),
            "the FTC's error is {} times that of pid-robust-observer",
            1.0 / ratio
        );
    }
    // Its observer peaks: it spends several times the effort of the plain PID.
    let simulated = simulate(&campaign, Precision::F32);
    let effort = |controller: usize| {
        simulated
            .iter()
            .flat_map(|f| {
                f.outcomes[controller]
                    .iter()
                    .flat_map(|a| a.channels.iter().map(|c| c.u_max))
            })
            .collect()
    };
    assert!(median(effort(0)) > 3.0 * median(effort(1)));
}

#[test]
fn uav_physical_shows_failure_rates_with_intervals() {
    let campaign = campaign("uav-physical").with_episodes(128).unwrap();
    let tables = tables(&campaign, Precision::F32);
    let rows = summarise(&campaign, &tables.scores);
    for controller in ["ftc", "pid", "pid-tuned"] {
        let row = rows
            .iter()
            .find(|row| row.failures.controller == controller && &*row.failures.stratum == "all")
            .unwrap();
        let failures = &row.failures;
        println!(
            "{controller}: {} of {}, {:?}",
            failures.failed(),
            failures.n,
            failures.interval
        );
        assert_eq!(failures.n, 128);
        let wilson = failures.interval.unwrap();
        assert!(wilson.lower <= failures.rate() && failures.rate() <= wilson.upper);
        assert!(
            failures.rate() < 0.1,
            "{controller} fails in {} of {}",
            failures.failed(),
            failures.n
        );
    }
    // The thrust fault strikes some agents only, so there are strata with and without it, which make up the whole.
    let n = |stratum: &str| {
        rows.iter()
            .find(|row| row.failures.stratum.starts_with(stratum))
            .unwrap()
            .failures
            .n
    };
    assert_eq!(n("with fault0") + n("without fault0"), 128);
    assert!(n("with fault0") > 20);
}

#[test]
fn single_precision_stays_within_the_contract_over_all_episodes_that_do_not_fail() {
    // The contract of the model: largest |e| within 2e-4, RMS error within 1e-4 relative.
    for name in [
        "uav-paper",
        "uav-physical",
        "waypoints",
        "biped-paper",
        "biped-turn",
        "biped-ground-reaction",
        "biped-berkeley",
    ] {
        // Those for which the contract was made: the errors of tuned ones are so small that a thousandth of them is
        // the rounding of a position.
        let controllers = "controllers=[\"ftc\", \"pid\", \"pid-robust-observer\", \"pid-placed\"]";
        let campaign = altered(name, &["episodes=24", controllers]);
        let (double, single) = (
            simulate(&campaign, Precision::F64),
            simulate(&campaign, Precision::F32),
        );
        let (mut worst_max, mut worst_rmse, mut compared) = (0.0_f64, 0.0_f64, 0);
        for (double, single) in double.iter().zip(&single) {
            for (double, single) in double
                .outcomes
                .concat()
                .iter()
                .zip(single.outcomes.concat())
            {
                let saturates = double
                    .channels
                    .iter()
                    .any(|channel| channel.saturated_fraction > 0.0);
                if double.failed_step.is_some() || saturates && campaign.first_group().is_limited()
                {
                    continue;
                }
                compared += 1;
                for (double, single) in double.channels.iter().zip(&single.channels) {
                    worst_max = worst_max.max((double.max_abs - single.max_abs).abs());
                    worst_rmse = worst_rmse.max((double.rmse / single.rmse - 1.0).abs());
                }
            }
        }
        println!("{name}: {compared} flights, |e| {worst_max:.1e}, RMS {worst_rmse:.1e}");
        // Of the bipeds only the FTC's episodes do not fail.
        assert!(
            compared >= 24,
            "{name}: only {compared} flights neither fail nor saturate"
        );
        assert!(
            worst_max <= 2e-4 && worst_rmse <= 1e-4,
            "{name}: |e| {worst_max:e}, RMS {worst_rmse:e}"
        );
        assert!(
            worst_max > 0.0,
            "single precision cannot equal double precision"
        );
    }
}

#[test]
fn regress_the_smoke_campaign_keeps_its_medians() {
    // Ourselves at the first release; 2 % leaves room for rounding on other machines, not for another model.
    let tables = tables(&campaign("smoke"), Precision::F64);
    let rows = summarise(&campaign("smoke"), &tables.scores);
    for (controller, expected) in [("ftc", 0.0390), ("pid", 0.6730), ("pid-tuned", 0.0240)] {
        let row = rows
            .iter()
            .find(|row| {
                row.failures.controller == controller
                    && row.metric == "rmse"
                    && *row.group == *"position"
            })
            .unwrap();
        let median = row.quantiles[0].value.unwrap();
        assert!(
            (median / expected - 1.0).abs() < 0.02,
            "{controller}: {median} against {expected}"
        );
    }
}

#[test]
fn a_fault_that_begins_later_splits_settling_from_recovery() {
    let campaign = altered(
        "scenario-a",
        &[
            "fault.0.amplitude=0.0",
            "disturbance.0.amplitude=1.0",
            "coupling.kappa=0.0",
            "[[fault]]\ntarget = \"actuator\"\nkind = \"bias\"\nchannels = [1]\nonset_s = 8.0\nmagnitude = 400.0",
            "verdict.settled_error=0.01",
        ],
    );
    let tables = tables(&campaign, Precision::F64);
    let frame = tables.channels.to_frame().unwrap();
    let value = |column: &str, row: usize| frame.column(column).unwrap().f64().unwrap().get(row);
    // Row 0 is channel x of the first agent under the FTC: it settles, is hit, and recovers.
    let (settling, recovery) = (
        value("settling_s", 0).unwrap(),
        value("recovery_s", 0).unwrap(),
    );
    assert!(settling > 0.0 && settling < 3.0, "{settling}");
    assert!(recovery > 0.0 && recovery < 5.0, "{recovery}");
    // Channel y is not hit: nothing to recover from.
    assert_eq!(value("recovery_s", 1), Some(0.0));
}

#[test]
fn an_agent_that_diverges_leaves_those_alone_that_are_not_coupled_to_it() {
    // A loss of all effectiveness makes the struck agents drift away without end; kappa is zero in every other episode.
    let campaign = altered(
        "smoke",
        &[
            "coupling.kappa={ choice = [0.0, 1e-9] }",
            "fault.0.probability=0.5",
            "fault.0.channels=all",
            "disturbance.+={ kind = \"constant\", amplitude = 1e37 }",
        ],
    );
    let struck = campaign.clone().with(|own| {
        own.disturbances[1].parameters[0].distributions[6..].fill(Distribution::Constant(0.0));
    });
    let (mut diverged, mut spared) = (0, 0);
    for simulated in simulate(&struck, Precision::F32) {
        let kappa = simulated.episode.agents[0].kappa;
        for outcomes in simulated.outcomes {
            diverged += usize::from(outcomes[0].diverged);
            if kappa == 0.0 {
                assert!(!outcomes[1].diverged && !outcomes[2].diverged);
                spared += 1;
            }
        }
    }
    assert!(
        diverged > 0 && spared > 0,
        "{diverged} diverged, {spared} spared"
    );
}

#[test]
fn a_perfect_pair_of_channels_is_a_tie_and_no_nan() {
    let campaign = campaign("smoke");
    let mut tables = tables(&campaign, Precision::F64);
    // The first controller is perfect in one channel, the second in another.
    tables.scores.groups[0].rmse[0][0] = 0.0;
    tables.scores.groups[0].rmse[1][1] = 0.0;
    for pair in compare(&campaign, &tables.scores) {
        for ratio in pair.ratios {
            let log_ratio = ratio.log_ratio.unwrap();
            assert!(!log_ratio.value.is_nan() && !ratio.win_rate.unwrap().value.is_nan());
        }
    }
}

#[test]
fn every_kind_of_fault_and_disturbance_has_a_line_in_a_shipped_campaign() {
    let all: Vec<Campaign> = shipped_campaigns()
        .iter()
        .map(|path| Campaign::load(path).unwrap())
        .collect();
    for &kind in FaultKind::ALL {
        for target in [
            FaultTarget::Actuator,
            FaultTarget::Sensor,
            FaultTarget::Network,
            FaultTarget::Plant,
        ] {
            let mut faults = all
                .iter()
                .flat_map(|campaign| &campaign.first_group().faults);
            assert!(
                !kind.strikes(target)
                    || faults.any(|fault| fault.kind == kind && fault.target == target),
                "{} {}",
                target.name(),
                kind.name()
            );
        }
    }
    // The schema knows every kind, whoever adds one.
    let schema = Campaign::schema();
    let of_schema = |name: &str| -> Vec<String> {
        let kinds = schema["$defs"][name]["oneOf"].as_array().unwrap();
        kinds
            .iter()
            .map(|kind| kind["const"].as_str().unwrap().to_string())
            .collect()
    };
    assert_eq!(of_schema("FaultKind").len(), FaultKind::ALL.len());
    let kinds = of_schema("DisturbanceKind");
    assert!(kinds.len() >= 6, "{kinds:?}");
    for kind in kinds {
        let mut disturbances = all
            .iter()
            .flat_map(|campaign| &campaign.first_group().disturbances);
        assert!(disturbances.any(|one| one.kind.name() == kind), "{kind}");
    }
}

#[test]
fn the_tables_hold_what_was_simulated_the_channel_that_jammed_and_delays_in_whole_steps() {
    let fault = |kind: &str, rest: &str| {
        format!(
            "[[fault]]\ntarget = \"actuator\"\nkind = \"{kind}\"\nchannels = \"one\"\nonset_s = 1.0\n{rest}\n"
        )
    };
    let faults = fault("stuck", "") + &fault("delay", "delay_s = { uniform = [0.002, 0.012] }");
    let campaign = altered("smoke", &[&faults]);
    let step_s = campaign.time.step_s;
    let frame = tables(&campaign, Precision::F32)
        .episodes
        .to_frame()
        .unwrap();
    let stuck = campaign.first_group().faults.len() - 2;
    let jammed = frame.column(&format!("fault{stuck}_channel")).unwrap();
    let jammed = jammed.cast(&DataType::String).unwrap();
    let (controllers, team) = (campaign.controllers.len(), campaign.first_group().team);
    let mut met = Vec::new();
    for row in 0..frame.height() {
        let (episode, agent) = (row / (controllers * team), row % team);
        let drawn = &draw(campaign.first_group(), u32::try_from(episode).unwrap()).agents[agent];
        let channel = drawn.faults[stuck]
            .strikes
            .iter()
            .position(|own| *own)
            .unwrap();
        let name = jammed.str().unwrap().get(row).unwrap();
        assert_eq!(name, &*campaign.first_group().channels()[channel]);
        met.push(name.to_string());

        let late = drawn.faults[stuck + 1]
            .strikes
            .iter()
            .position(|own| *own)
            .unwrap();
        let column = format!(
            "fault{}_delay_s_{}",
            stuck + 1,
            campaign.first_group().channels()[late]
        );
        let flown_s = frame
            .column(&column)
            .unwrap()
            .f64()
            .unwrap()
            .get(row)
            .unwrap();
        let asked_s = drawn.faults[stuck + 1].parameters[0][late];
        // The nearest whole step, which is what acts, and not what was drawn.
        let steps = flown_s / step_s;
        assert!((steps - steps.round()).abs() < 1e-9, "{flown_s}");
        assert!((flown_s - asked_s).abs() <= step_s / 2.0 + 1e-12 && flown_s != asked_s);
    }
    met.sort();
    met.dedup();
    assert!(met.len() > 3, "{met:?}");
}
