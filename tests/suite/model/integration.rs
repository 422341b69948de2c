//! The pieces of the episode loop: order of the integration, limits, noise, draws.

use crate::common::{altered, campaign, gains, simulate};
use urts_mc::backend::cpu::{Cpu, Precision, Simd};
use urts_mc::campaign::Campaign;
use urts_mc::draw::draw;

/// The largest |e| difference at the end of a smooth episode between two steps.
fn end_difference(coarse: &Campaign, fine: &Campaign) -> f64 {
    let end = |campaign: &Campaign| {
        let gains = gains(campaign);
        let cpu = Cpu::new(campaign.first_group(), &gains.loops(), Precision::F64, None);
        let (_, snapshots) = cpu.trace(0, 0, campaign.time.steps);
        let last = snapshots.last().unwrap();
        assert_eq!(last.step, campaign.time.steps);
        last.agents
            .iter()
            .flatten()
            .map(|shown| shown.e)
            .collect::<Vec<_>>()
    };
    end(coarse)
        .iter()
        .zip(end(fine))
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[test]
fn the_integration_is_of_fourth_order_on_a_smooth_episode_and_faults_on_the_step_grid_keep_it() {
    for (name, changes) in [
        ("scenario-a", &["time.duration_s=4.0"][..]),
        (
            "scenario-b",
            &[
                "time.duration_s=4.0",
                "fault.0.onset_s=1.0",
                "fault.1.onset_s=2.0",
            ],
        ),
    ] {
        // Others have poles that such steps do not resolve.
        let ftc = "controllers=[\"ftc\"]";
        let with_step = |step: &str| altered(name, &[changes, &[step, ftc]].concat());
        let fine = with_step("time.step_s=0.0005");
        let errors = ["time.step_s=0.008", "time.step_s=0.004"]
            .map(|step| end_difference(&with_step(step), &fine));
        let order = (errors[0] / errors[1]).log2();
        println!(
            "{name}: errors {:.2e} {:.2e}, order {order:.2}",
            errors[0], errors[1]
        );
        // Between steps of 8 and 4 ms the fifth-order terms still show.
        assert!((3.7..4.8).contains(&order), "{name}: order {order}");
    }
}

#[test]
fn limits_cut_the_command_and_are_counted() {
    // A torque limit far below what the initial error demands, and a thrust limit below the weight of 19.6 N.
    let limited = altered(
        "scenario-b",
        &[
            "agent.max_torque_n_m=2.0",
            "agent.max_thrust_n=15.0",
            "time.duration_s=13.0",
        ],
    );
    let free = altered("scenario-b", &["time.duration_s=13.0"]);
    for precision in [Precision::F64, Precision::F32] {
        let channels = |campaign: &Campaign| {
            simulate(campaign, precision).remove(0).outcomes[0][0]
                .channels
                .clone()
        };
        let (limited, free) = (channels(&limited), channels(&free));
        for axis in 3..6 {
            // The bias fault of 0.3 N m adds to the limited pitch torque.
            let most = if axis == 4 { 2.0 + 0.3 } else { 2.0 };
            assert!(
                limited[axis].u_max <= most + 1e-6,
                "torque {} above its limit",
                limited[axis].u_max
            );
            assert!(limited[axis].saturated_fraction > 0.0);
            assert!(free[axis].u_max > 2.0 && free[axis].saturated_fraction == 0.0);
        }
        // Too little thrust to carry the weight: cut at nearly every step, and the UAV falls.
        assert!(
            limited[2].saturated_fraction > 0.9,
            "{}",
            limited[2].saturated_fraction
        );
        assert!(limited[2].max_abs > 10.0);
        assert!(free[2].saturated_fraction == 0.0 && free[2].max_abs < 0.5);
    }
}

#[test]
fn the_observer_is_told_of_the_limits() {
    // With nothing but an initial error, f1 = e'' - u_fb,eff stays small only if the told command is the limited one.
    let quiet = |limit: &str| {
        altered(
            "scenario-b",
            &[
                &format!("agent.max_torque_n_m={limit}"),
                "time.duration_s=14.0",
                "fault.0.magnitude=0.0",
                "fault.1.magnitude=0.0",
                "disturbance.0.amplitude=0.0",
                "disturbance.1.amplitude=0.0",
                "fault.2.amplitude=0.0",
                "coupling.kappa=0.0",
            ],
        )
    };
    let campaign = quiet("3.0");
    let gains = gains(&campaign);
    let cpu = Cpu::new(campaign.first_group(), &gains.loops(), Precision::F64, None);
    let (outcomes, snapshots) = cpu.trace(0, 0, 10);
    assert!(
        outcomes[0].channels[3].saturated_fraction > 0.0,
        "the limit must bite"
    );
    let largest = snapshots
        .iter()
        .flat_map(|s| s.agents[0][3..].iter().map(|c| c.f1.abs()))
        .fold(0.0, f64::max);
    // What is left of f1 is the gyroscopic and damping difference of (14), a few hundredths; a limit unknown to the
    // observer would show as several rad/s^2.
    assert!(largest < 0.5, "f1 reaches {largest}");
}

#[test]
fn noise_is_standard_normal_white_and_held_over_a_step() {
    let noise = "fault.0={ target = \"sensor\", kind = \"noise\", std = 1.0 }";
    let campaign = altered("scenario-a", &[noise, "time.duration_s=4.0"]);
    let gains = gains(&campaign);
    let trace = |precision, simd| {
        Cpu::new(campaign.first_group(), &gains.loops(), precision, simd)
            .trace(0, 1, 1)
            .1
    };
    let snapshots = trace(Precision::F64, None);
    let series: Vec<Vec<f64>> = (0..18)
        .map(|k| {
            snapshots[..4000]
                .iter()
                .map(|snapshot| snapshot.agents[k / 6][k % 6].f2)
                .collect()
        })
        .collect();
    let all: Vec<f64> = series.concat();
    let n = all.len() as f64;
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / n;
    // 72,000 samples: five standard errors of each moment.
    let moments = [1, 2, 3, 4].map(|power| mean(&mut all.iter().map(|x| x.powi(power))));
    for (moment, expected, spread) in [
        (moments[0], 0.0, 1.0),
        (moments[1], 1.0, 2.0),
        (moments[2], 0.0, 15.0),
        (moments[3], 3.0, 96.0_f64),
    ] {
        assert!(
            (moment - expected).abs() < 5.0 * (spread / n).sqrt(),
            "moments {moments:?}"
        );
    }
    let product =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() / a.len() as f64;
    let bound = 5.0 / 4000f64.sqrt();
    for (k, own) in series.iter().enumerate() {
        for lag in 1..9 {
            assert!(
                product(&own[lag..], &own[..4000 - lag]).abs() < bound,
                "channel {k} repeats after {lag} steps"
            );
        }
        for other in &series[k + 1..] {
            assert!(
                product(own, other).abs() < bound,
                "two channels share noise"
            );
        }
    }
    // The same words in single precision.
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        let single = trace(Precision::F32, Some(simd));
        for (double, single) in snapshots.iter().zip(&single) {
            for (double, single) in double
                .agents
                .iter()
                .flatten()
                .zip(single.agents.iter().flatten())
            {
                // 23-bit uniforms are exact in both; ln, sqrt and sin are good to a few ulp of at most 5.8.
                assert!(
                    (double.f2 - single.f2).abs() < 1e-5,
                    "{} against {}",
                    double.f2,
                    single.f2
                );
            }
        }
    }
}

#[test]
fn draws_follow_their_distributions_and_who_shares_them() {
    let campaign = altered(
        "uav-paper",
        &[
            "initial.error_integral={ log_uniform = [0.01, 1.0], per = \"agent\" }",
            "agent.inertia_scale={ truncated_normal = { mean = 1.0, std = 0.2, low = 0.9, high = 1.3 }, per = \"agent\" }",
        ],
    );
    let episodes: Vec<_> = (0..2000)
        .map(|episode| draw(campaign.first_group(), episode))
        .collect();
    let n = episodes.len() as f64;
    let mean =
        |pick: &dyn Fn(&urts_mc::draw::Episode) -> f64| episodes.iter().map(pick).sum::<f64>() / n;
    let near = |found: f64, expected: f64, std: f64| {
        assert!(
            (found - expected).abs() < 5.0 * std / n.sqrt(),
            "{found} against {expected}"
        )
    };
    // Uniform [0.8, 1.2]: mean 1, standard deviation 0.4 / sqrt 12; once per episode.
    near(mean(&|e| e.agents[0].mass_scale), 1.0, 0.4 / 12f64.sqrt());
    assert!(episodes.iter().all(|e| {
        e.agents
            .iter()
            .all(|a| a.mass_scale == e.agents[0].mass_scale)
    }));
    near(mean(&|e| e.agents[0].kappa), 0.5, 0.5);
    near(mean(&|e| e.agents[2].error[4]), 0.0, 0.1);
    near(
        mean(&|e| e.agents[2].error[4].powi(2)),
        0.01,
        0.01 * 2f64.sqrt(),
    );
    // ln of a log-uniform number is uniform.
    near(
        mean(&|e| e.agents[1].error_integral[3].ln()),
        0.1f64.ln(),
        100f64.ln() / 12f64.sqrt(),
    );
    assert!(episodes.iter().all(|e| {
        e.agents[1]
            .error_integral
            .iter()
            .all(|v| *v == e.agents[1].error_integral[0])
    }));
    assert!(episodes[0].agents[0].error_integral != episodes[0].agents[1].error_integral);
    assert!(episodes.iter().all(|e| {
        e.agents
            .iter()
            .all(|a| (0.9..=1.3).contains(&a.inertia_scale))
    }));
    // The loss strikes a quarter of the agents, one channel of six.
    near(
        mean(&|e| f64::from(u8::from(e.agents[0].faults[0].occurs()))),
        0.25,
        0.25f64.sqrt() * 0.75f64.sqrt(),
    );
    for channel in 0..6 {
        near(
            mean(&|e| f64::from(u8::from(e.agents[0].faults[0].strikes[channel]))),
            0.25 / 6.0,
            (0.25f64 / 6.0).sqrt(),
        );
    }
    assert!(
        episodes
            .iter()
            .all(|e| e.agents[0].faults[0].strikes.iter().filter(|s| **s).count() <= 1)
    );
}

#[test]
fn an_unused_coupling_and_absent_faults_change_nothing() {
    // A loss of nothing, a disturbance of nothing and a coupling of nothing must not change a bit.
    let base = altered("smoke", &["coupling.kappa=0.0", "fault.0.magnitude=0.0"]);
    let bare = base.clone().with(|own| {
        own.faults.remove(0);
    });
    let outcomes = |campaign: &Campaign| {
        simulate(campaign, Precision::F32)
            .into_iter()
            .map(|simulated| simulated.outcomes)
            .collect::<Vec<_>>()
    };
    let metrics = |campaign: &Campaign| {
        outcomes(campaign)
            .concat()
            .concat()
            .into_iter()
            .flat_map(|agent| agent.channels)
            .map(|c| (c.rmse, c.max_abs, c.effort))
            .collect::<Vec<_>>()
    };
    // The sensor fault is fault 1 in one campaign and fault 0 in the other, so it would be drawn anew: silence it.
    let silent = |campaign: Campaign| {
        campaign.with(|own| {
            own.faults
                .retain(|fault| fault.kind != urts_mc::campaign::FaultKind::SmoothedSquare);
        })
    };
    assert_eq!(metrics(&silent(base)), metrics(&silent(bare)));
    assert_eq!(campaign("smoke").first_group().faults.len(), 2);
}
