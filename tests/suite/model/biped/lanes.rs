//! The lane types among each other, and a robot that diverges among others.

use super::everything;
use crate::common::{altered, gains};
use std::ops::Range;
use urts_mc::backend::EpisodeResult;
use urts_mc::backend::cpu::{Cpu, Precision, Simd};
use urts_mc::campaign::Campaign;
use urts_mc::draw::{Episode, draw};
use urts_mc::model::controller::kinds::Controller;
use urts_mc::model::episode::{AgentOutcome, Model};
use urts_mc::model::lanes::Lane;
#[cfg(target_arch = "x86_64")]
use urts_mc::model::lanes::simd::{F32x8, F32x16};
use urts_mc::model::metric::ChannelOutcome;

fn simulated(
    campaign: &Campaign,
    precision: Precision,
    simd: Option<Simd>,
    episodes: Range<u32>,
) -> Vec<EpisodeResult> {
    let gains = gains(campaign);
    Cpu::new(campaign.first_group(), &gains.loops(), precision, simd).simulate(episodes, &|_| ())
}

fn available() -> impl Iterator<Item = Simd> {
    Simd::ALL.into_iter().filter(|simd| simd.is_available())
}

#[test]
fn eight_and_sixteen_robots_side_by_side_give_the_same_bits() {
    if !Simd::Avx512.is_available() {
        println!("SKIPPED: no AVX-512");
        return;
    }
    for actuation in ["full", "limited"] {
        let campaign = everything(actuation).with(|own| own.time.steps = 1000);
        // One block in full, and one with lanes to spare.
        let [eight, sixteen] = [Simd::Avx2, Simd::Avx512]
            .map(|simd| simulated(&campaign, Precision::F32, Some(simd), 0..21));
        assert_eq!(eight.len(), 21);
        for (eight, sixteen) in eight.iter().zip(&sixteen) {
            // As text, in which a diverged robot's not-a-number equals itself.
            let [eight, sixteen] =
                [eight, sixteen].map(|simulated| format!("{:?}", simulated.outcomes));
            assert!(eight == sixteen);
        }
    }
}

/// The outcomes of all channels.
fn channels_of(simulated: &mut [EpisodeResult]) -> impl Iterator<Item = &mut ChannelOutcome> {
    let agents = simulated
        .iter_mut()
        .flat_map(|own| own.outcomes.iter_mut().flatten());
    agents.flat_map(|agent| agent.channels.iter_mut())
}

#[test]
fn the_reference_has_the_same_bits_in_every_layout() {
    let robots = ["full", "limited"].map(everything);
    let drones = ["uav-faults", "uav-physical"].map(|name| altered(name, &[]));
    for campaign in robots.into_iter().chain(drones) {
        let campaign = campaign.with(|own| own.controllers.truncate(1));
        let [scalar, others @ ..] = Simd::ALL;
        let results = |simd| -> Vec<String> {
            let mut simulated = simulated(&campaign, Precision::F64, Some(simd), 0..9);
            for channel in channels_of(&mut simulated) {
                // Of an agent without a fault this means nothing, and no table has it.
                channel.last_outside_before_fault = None;
            }
            let outcomes = simulated.iter().map(|own| format!("{:?}", own.outcomes));
            outcomes.collect()
        };
        // A block in full, and one with lanes to spare.
        let expected = results(scalar);
        assert!(expected[0] != expected[1]);
        for simd in others.into_iter().filter(|simd| simd.is_available()) {
            for (episode, (found, expected)) in results(simd).iter().zip(&expected).enumerate() {
                assert_eq!(
                    found, expected,
                    "{}, {simd:?}, episode {episode}",
                    campaign.name
                );
            }
        }
    }
}

#[test]
fn traces_side_by_side_are_those_of_single_episodes() {
    let campaign = everything("limited").with(|own| own.time.steps = 60);
    let gains = gains(&campaign);
    for precision in [Precision::F32, Precision::F64] {
        let cpu = Cpu::new(campaign.first_group(), &gains.loops(), precision, None);
        let episodes: Vec<u32> = (3..22).collect();
        let together = cpu.traces(&episodes, 0, 7);
        assert_eq!(together.len(), episodes.len());
        for (&episode, together) in episodes.iter().zip(&together) {
            let alone = cpu.trace(episode, 0, 7);
            assert_eq!(alone.1.len(), 10);
            assert!(format!("{alone:?}") == format!("{together:?}"), "{episode}");
        }
    }
}

#[test]
fn single_precision_stays_within_the_contract_on_walks() {
    // The paper's robots, without an initial error that no torque of theirs could correct.
    let slightly = [
        "initial.error.normal.std=0.005",
        "initial.error_rate.normal.std=0.005",
    ];
    let campaign = altered("biped-paper", &slightly).with(|own| own.controllers.truncate(1));
    let episodes = 0..4;
    let double = simulated(&campaign, Precision::F64, None, episodes.clone());
    let outcomes = |simulated: &[EpisodeResult]| -> Vec<AgentOutcome> {
        let all = simulated
            .iter()
            .flat_map(|simulated| simulated.outcomes[0].clone());
        all.collect()
    };
    let double = outcomes(&double);
    for simd in available() {
        let single = simulated(&campaign, Precision::F32, Some(simd), episodes.clone());
        let mut worst: f64 = 0.0;
        for (double, single) in double.iter().zip(outcomes(&single)) {
            assert!(!double.diverged && double.failed_step.is_none());
            for (double, single) in double.channels.iter().zip(&single.channels) {
                let relative = (single.rmse / double.rmse - 1.0).abs();
                worst = worst.max(relative);
                // The contract of the model between precisions: |e| within 2e-4, RMSE within 1e-4 relative.
                assert!((single.max_abs - double.max_abs).abs() <= 2e-4);
                assert!(relative <= 1e-4, "{simd:?}: RMSE differs by {relative:e}");
            }
        }
        println!("{simd:?}: RMSE within {worst:.1e}");
        assert!(
            worst > 0.0,
            "single precision cannot equal double precision"
        );
    }
}

/// Outcomes with the first robot of the episode `wild` thrown out of its course, and without that; in that episode the
/// others do not feel it.
fn with_and_without<L: Lane>(campaign: &Campaign, wild: usize) -> [Vec<Vec<AgentOutcome>>; 2] {
    let gains = gains(campaign);
    let controller = Controller::new(&gains.loops()[0]);
    let model = Model::new(campaign.first_group());
    let mut episodes: Vec<Episode> = (0..L::WIDTH as u32)
        .map(|k| draw(campaign.first_group(), k))
        .collect();
    for agent in &mut episodes[wild].agents[1..] {
        agent.kappa = 0.0;
    }
    let calm = model.simulate::<L>(&controller, &episodes);
    episodes[wild].agents[0].error_rate[3] = 1e25;
    [model.simulate::<L>(&controller, &episodes), calm]
}

fn diverges_alone<L: Lane>(wild: usize) {
    let campaign = everything("limited").with(|own| own.time.steps = 1000);
    let [wild_run, calm_run] = with_and_without::<L>(&campaign, wild);
    assert!(wild_run[wild][0].diverged && !calm_run[wild][0].diverged);
    for (episode, (with, without)) in wild_run.iter().zip(&calm_run).enumerate() {
        for agent in 0..3 {
            assert!(!without[agent].diverged);
            if (episode, agent) != (wild, 0) {
                assert_eq!(with[agent], without[agent]);
            }
        }
    }
}

#[test]
fn a_diverging_robot_leaves_those_alone_that_are_not_coupled_to_it() {
    diverges_alone::<f64>(0);
    diverges_alone::<f32>(0);
    #[cfg(target_arch = "x86_64")]
    {
        if Simd::Avx2.is_available() {
            diverges_alone::<F32x8>(5);
        }
        if Simd::Avx512.is_available() {
            diverges_alone::<F32x16>(11);
        }
    }
}
