//! Every kind of fault and disturbance at once, on the GPU as on the CPU.

use super::agreement::{CONTRACT, Expected};
use super::altered;
use super::parity::agreement;
use super::{LONGEST, gpu_campaign, jets, linked, simulate};
use crate::common::{gains, gpu_or_skip};
use urts_mc::campaign::{Campaign, DisturbanceKind, FaultKind, FaultTarget, Link};

/// Whether a campaign has every kind on every target and link that it can strike, but for `missing`.
fn has_all(campaign: &Campaign, missing: &[FaultKind]) {
    for &kind in FaultKind::ALL {
        let there = campaign
            .first_group()
            .faults
            .iter()
            .any(|fault| fault.kind == kind);
        assert_eq!(there, !missing.contains(&kind), "{}", kind.name());
    }
    for link in [Link::Command, Link::Measurement] {
        let attacks = campaign
            .first_group()
            .faults
            .iter()
            .filter(|fault| fault.target == FaultTarget::Network);
        assert!(attacks.filter(|fault| fault.link == link).count() > 2);
    }
}

#[test]
fn val_all_faults_of_a_uav_agree() {
    let campaign = gpu_campaign("uav_faults", &[]);
    has_all(&campaign, &[]);
    for kind in [
        DisturbanceKind::Gust1Cosine,
        DisturbanceKind::Dryden,
        DisturbanceKind::RotorVortex,
    ] {
        assert!(
            campaign
                .first_group()
                .disturbances
                .iter()
                .any(|one| one.kind == kind)
        );
    }
    // Without jets, each axis is simulated on its own; they are the last of the disturbances, so what was drawn for the
    // others stays.
    let is_jet = |kind| kind == DisturbanceKind::RotorVortex;
    let apart = campaign.clone();
    let apart = apart.with(|own| own.disturbances.retain(|one| !is_jet(one.kind)));
    for campaign in [campaign, apart] {
        let Some([double, single]) = agreement(&campaign) else {
            return;
        };
        assert!(double.compared > 20 && single.compared > 40);
    }
}

#[test]
fn val_friction_of_a_uav_agrees() {
    let friction = "disturbance.+={ kind = \"friction\", coulomb = { uniform = [0.0, 2.0] }, viscous = { uniform = [0.0, 0.3] } }";
    let Some([double, single]) = agreement(&altered("smoke", &["episodes=16", friction])) else {
        return;
    };
    assert!(double.compared > 20 && single.compared > 20);
}

#[test]
fn val_faults_that_differ_from_agent_to_agent_agree() {
    let blocks = r#"fault.0.agents=[
    { probability = 1.0, channels = [2, 3], onset_s = 1.0, duration_s = 0.5, magnitude = 0.25 },
    { probability = 0.0 },
    { probability = 1.0, channels = "all", ramp_s = 0.3 },
]"#;
    let campaign = altered("smoke", &["fault.0.duration_s=2.0", blocks]);
    assert!(campaign.first_group().faults[0].spares_some());
    let Some([double, single]) = agreement(&campaign) else {
        return;
    };
    assert!(double.compared > 40 && single.compared > 40);
}

#[test]
fn val_jets_alone_agree() {
    let campaign = jets(&[]);
    let Some([double, single]) = agreement(&campaign) else {
        return;
    };
    assert!(double.compared == 24 && single.compared == 24);
}

#[test]
fn val_all_faults_under_thrust_agree_with_a_sampled_controller_and_late_commands() {
    let campaign = gpu_campaign("thrust_faults", &[]);
    has_all(&campaign, &[]);
    // The contract alone: some of these episodes are shaken so much that rounding grows beyond what calm ones show.
    let Some(gpu) = gpu_or_skip() else { return };
    let gains = gains(&campaign).loops();
    let simulated = simulate(&gpu, &campaign, &gains, LONGEST);
    let compared = Expected::new(&campaign, &gains, &CONTRACT).compare(&simulated);
    let summary = compared.unwrap_or_else(|difference| panic!("{difference}"));
    println!("{}: {summary}", campaign.name);
    assert!(summary.compared > 4);
}

#[test]
fn val_links_and_actuators_that_fail_together_under_a_sampled_controller_agree() {
    let Some([double, single]) = agreement(&linked(&[])) else {
        return;
    };
    assert!(double.compared == 24 && single.compared == 24);
}

#[test]
fn val_all_faults_of_a_robot_agree() {
    let campaign = gpu_campaign("biped_faults", &[]);
    let airborne = [
        FaultKind::Inertia,
        FaultKind::CenterOfMass,
        FaultKind::Payload,
    ];
    has_all(&campaign, &airborne);
    let Some([double, single]) = agreement(&campaign) else {
        return;
    };
    assert!(double.compared > 4 && single.compared > 10);
}
