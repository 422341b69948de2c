//! The same bits, whatever the batch, the span of steps, the order and the company.

use super::{
    ALIKE, BRIEF, Gains, gpu_campaign, linked, mixed, mixed_biped, simulate, simulate_all,
};
use crate::common::{gains, gpu_or_skip};
use urts_mc::backend::EpisodeResult;
use urts_mc::backend::gpu::{GpuSimulator, Tuning};
use urts_mc::campaign::Campaign;

/// Everything at once, short: 600 steps are two flushes of the metrics and 150 blocks of noise, and something is left
/// over.
fn short(episodes: u32, controllers: &str) -> (Campaign, Gains) {
    let episodes = format!("episodes={episodes}");
    let controllers = format!("controllers=[{controllers}]");
    let own = [
        &*episodes,
        &*controllers,
        // Strong enough for some to leave the numbers.
        "coupling.kappa.choice=[0.0, 1.0, 400.0]",
    ];
    let campaign = mixed(&[&BRIEF[..], &ALIKE, &own].concat());
    let gains = gains(&campaign).loops();
    (campaign, gains)
}

/// Episodes in digits that no other number has, also where they left the numbers.
pub(super) fn digits(simulated: &[EpisodeResult]) -> Vec<String> {
    simulated
        .iter()
        .map(|simulated| format!("{simulated:?}"))
        .collect()
}

#[test]
fn neither_batches_nor_spans_of_steps_change_a_bit() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (campaign, gains) = short(70, "\"ftc\"");
    let all = digits(&simulate(&gpu, &campaign, &gains, Tuning::default()));
    assert_eq!(all.len(), 70);
    assert!(
        all.iter()
            .any(|simulated| simulated.contains("diverged: true"))
    );
    // Spans that cut blocks of noise (4 steps) and flushes (256 steps), end with them, and are as long as the adapter
    // allows.
    for (batch, steps) in [
        (None, None),
        (Some(64), Some(600)),
        (Some(23), Some(100)),
        (None, Some(13)),
    ] {
        let again = digits(&simulate(&gpu, &campaign, &gains, Tuning { batch, steps }));
        assert!(again == all, "batches of {batch:?}, spans of {steps:?}");
    }
    // A shorter run, in single episodes or in single steps, is the beginning of the longer one.
    let (campaign, gains) = short(5, "\"ftc\"");
    for (batch, steps) in [(Some(1), Some(100)), (None, Some(1)), (Some(3), Some(7))] {
        let again = digits(&simulate(&gpu, &campaign, &gains, Tuning { batch, steps }));
        assert!(
            again == all[..5],
            "batches of {batch:?}, spans of {steps:?}"
        );
    }
    // The comparison can fail.
    let other = campaign.clone().with_seed(campaign.seed + 1);
    let other = digits(&simulate(&gpu, &other, &gains, Tuning::default()));
    assert!(other.iter().zip(&all).all(|(other, own)| other != own));
}

#[test]
fn neither_batches_nor_spans_of_steps_change_a_bit_of_bipeds() {
    let Some(gpu) = gpu_or_skip() else { return };
    let campaign = mixed_biped(&["controllers=[\"pid\"]"]);
    let gains = gains(&campaign).loops();
    let all = digits(&simulate(&gpu, &campaign, &gains, Tuning::default()));
    assert_eq!(all.len(), 16);
    assert!(
        all.iter()
            .any(|simulated| simulated.contains("diverged: true"))
    );
    for (batch, steps) in [(Some(5), Some(100)), (None, Some(13))] {
        let again = digits(&simulate(&gpu, &campaign, &gains, Tuning { batch, steps }));
        assert!(again == all, "batches of {batch:?}, spans of {steps:?}");
    }
}

#[test]
fn neither_batches_nor_spans_of_steps_change_a_bit_of_what_a_link_holds() {
    let Some(gpu) = gpu_or_skip() else { return };
    let campaign = linked(&["controllers=[\"pid\"]"]);
    let gains = gains(&campaign).loops();
    let all = digits(&simulate(&gpu, &campaign, &gains, Tuning::default()));
    // Spans that end between the ticks of the controller, and while a link is blocked.
    for (batch, steps) in [(Some(3), Some(101)), (None, Some(7))] {
        let again = digits(&simulate(&gpu, &campaign, &gains, Tuning { batch, steps }));
        assert!(again == all, "batches of {batch:?}, spans of {steps:?}");
    }
}

#[test]
fn a_trace_does_not_depend_on_the_order_and_company_of_its_episodes() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (campaign, gains) = short(70, "\"ftc\", \"pid\"");
    let mut simulator =
        GpuSimulator::new(&gpu, campaign.first_group(), &gains, Tuning::default()).unwrap();
    let all = digits(&simulate_all(&mut simulator, &campaign).unwrap());
    // 43 steps: samples fall inside blocks of noise, and the last is shorter; more samples than one read-back holds.
    let mut trace = |episodes: &[u32], every: u32| {
        let mut shown = vec![String::new(); episodes.len()];
        let simulated = simulator
            .trace(episodes, every, &mut |instant| {
                for (k, shown) in shown.iter_mut().enumerate() {
                    let controllers = [0, 1].map(|controller| instant.agents(k, controller));
                    *shown += &format!("{} {controllers:?}\n", instant.step);
                }
            })
            .unwrap();
        for (&episode, simulated) in episodes.iter().zip(&digits(&simulated)) {
            assert_eq!(*simulated, all[episode as usize]);
        }
        shown
    };
    let forward = trace(&[3, 69, 20], 43);
    let backward = trace(&[20, 0, 69, 5, 3, 3], 43);
    assert_eq!(forward, [4, 2, 0].map(|k| backward[k].clone()));
    assert_eq!(backward[4], backward[5]);
    assert!(
        backward[..5]
            .iter()
            .enumerate()
            .all(|(k, own)| !backward[..k].contains(own))
    );
    assert_eq!(trace(&[69], 43)[0], forward[1]);
    assert_eq!(forward[0].lines().count(), 600 / 43 + 2);
    // Finer samples show the same at the same steps.
    let fine = trace(&[3], 1);
    assert_eq!(fine[0].lines().count(), 601);
    for line in forward[0].lines() {
        assert!(fine[0].lines().any(|own| own == line));
    }
}

#[test]
fn what_faults_remember_outlives_every_span_and_batch() {
    let Some(gpu) = gpu_or_skip() else { return };
    for name in ["uav_faults", "thrust_faults"] {
        let faults = gpu_campaign(name, &[]).first_group().faults.len();
        let early = |fault| format!("fault.{fault}.onset_s.uniform=[0.1, 0.4]");
        let mut brief: Vec<String> = (0..faults).map(early).collect();
        brief.push("time.duration_s=0.9".into());
        brief.push("controllers=[\"pid\"]".into());
        brief.push("episodes=5".into());
        let brief: Vec<&str> = brief.iter().map(String::as_str).collect();
        let campaign = gpu_campaign(name, &brief);
        let gains = gains(&campaign).loops();
        let all = digits(&simulate(&gpu, &campaign, &gains, Tuning::default()));
        for (batch, steps) in [(None, Some(7)), (Some(2), Some(1))] {
            let again = digits(&simulate(&gpu, &campaign, &gains, Tuning { batch, steps }));
            assert!(
                again == all,
                "{name}: batches of {batch:?}, spans of {steps:?}"
            );
        }
    }
}
