//! Torques at their limits.

use crate::common::{altered, simulate};
use urts_mc::agent::Agent;
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::Campaign;

/// A robot that starts so far off that correcting it takes more torque than its joints have.
fn hurried(actuation: &str) -> Campaign {
    altered(
        "biped-ground-reaction",
        &[
            &format!("agent.actuation={actuation}"),
            "episodes=4",
            "time.duration_s=2.0",
            "initial.error.normal.std=0.1",
            "controllers.2=",
        ],
    )
}

/// Largest torque, the share of steps above its limit, and that limit, of every joint of every episode and controller.
fn torques(campaign: &Campaign, precision: Precision) -> Vec<[f64; 3]> {
    let Agent::Biped(biped) = &campaign.first_group().agent else {
        panic!("a campaign of robots");
    };
    let limits = biped.robot.joints().map(|joint| joint.torque_max_n_m);
    let limits: Vec<f64> = limits.collect();
    let simulated = simulate(campaign, precision);
    let agents = simulated
        .iter()
        .flat_map(|simulated| simulated.outcomes.iter().flatten());
    agents
        .flat_map(|agent| agent.channels.iter().zip(&limits))
        .map(|(joint, &limit)| [joint.u_max, joint.saturated_fraction, limit])
        .collect()
}

#[test]
fn torques_above_their_limits_are_counted_in_both_actuations_and_cut_in_one() {
    for precision in [Precision::F64, Precision::F32] {
        for (actuation, cut) in [("full", false), ("limited", true)] {
            let torques = torques(&hurried(actuation), precision);
            assert_eq!(torques.len(), 4 * 2 * 12);
            let above = torques.iter().filter(|[_, share, _]| *share > 0.0);
            // Neither all nor none, or the equivalences below would say nothing.
            let above = above.count();
            assert!((5..90).contains(&above), "{above} of 96");
            for [largest, share, limit] in torques {
                // Limits such as 88 and 139 N m are exact in both precisions, and no actuator fault adds to the
                // command.
                if cut {
                    assert!(largest <= limit);
                    assert_eq!(largest == limit, share > 0.0, "{largest} {share} {limit}");
                } else {
                    assert_eq!(largest > limit, share > 0.0, "{largest} {share} {limit}");
                }
                assert!(share < 0.5, "{share}");
            }
        }
    }
}
