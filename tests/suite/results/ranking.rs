//! Which condition breaks it, and the worst episodes.

use crate::common::{altered, campaign, tables};
use urts_mc::backend::EpisodeResult;
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::Campaign;
use urts_mc::draw::draw;
use urts_mc::model::episode::AgentOutcome;
use urts_mc::model::metric::ChannelOutcome;
use urts_mc::results::scores::{Scores, Status};
use urts_mc::results::sensitivity::{SensitivityResult, rank, worst};
use urts_mc::results::tables::Tables;

/// A campaign whose controllers have reasons to fail, and its scores.
fn simulated(name: &str, episodes: u32) -> (Campaign, Scores) {
    // The controllers of which is known what drives them.
    let controllers = "controllers=[\"ftc\", \"pid\", \"pid-robust-observer\"]";
    let campaign = altered(name, &[&format!("episodes={episodes}"), controllers]);
    let scores = tables(&campaign, Precision::F32).scores;
    (campaign, scores)
}

fn sure<'a>(
    ranking: &'a [SensitivityResult],
    kind: &'a str,
    controller: &'a str,
) -> impl Iterator<Item = &'a SensitivityResult> {
    ranking.iter().filter(move |ranked| {
        let target = &ranked.target;
        target.kind == kind && target.controller == controller && ranked.p_holm.unwrap() <= 0.05
    })
}

#[test]
fn what_drives_the_error_is_found_and_what_does_not_is_not() {
    let (campaign, scores) = simulated("uav-paper", 192);
    let ranking = rank(&campaign, &scores);
    // The sensor fault's amplitude drives the FTC and the plain PID, the disturbance the PID that distrusts that
    // sensor.
    for (controller, condition) in [
        ("ftc", "fault1_amplitude"),
        ("pid", "fault1_amplitude"),
        ("pid-robust-observer", "disturbance0_amplitude"),
    ] {
        let mut found = sure(&ranking, "rmse", controller);
        let found = found.find(|ranked| ranked.condition == condition).unwrap();
        let lower = found.trend.interval.unwrap().lower;
        assert!(lower > 0.1 && found.trend.value > lower);
    }
    let strongest = sure(&ranking, "rmse", "ftc").next().unwrap();
    assert_eq!(strongest.condition, "fault1_amplitude");
    // Phases do nothing. Of 24 targets one may find something in them by chance, at 5 %.
    let phases = ranking
        .iter()
        .filter(|ranked| ranked.condition.contains("phase"));
    assert!(
        phases
            .filter(|ranked| ranked.p_holm.unwrap() <= 0.05)
            .count()
            <= 1
    );
    // What is the same in all episodes is not ranked.
    assert!(
        ranking
            .iter()
            .all(|ranked| ranked.condition != "initial_error_integral")
    );
    assert!(
        ranking
            .iter()
            .all(|ranked| ranked.episodes <= 192 && ranked.p_holm.unwrap() <= 1.0)
    );
}

#[test]
fn what_drives_the_error_is_found_among_many_conditions_too() {
    // A screening with well over a hundred conditions: the largest number of permutations grows with them.
    let (campaign, scores) = simulated("uav-faults", 180);
    let ranking = rank(&campaign, &scores);
    let mut found = sure(&ranking, "rmse", "pid");
    assert!(found.any(|ranked| ranked.condition == "kappa"));
    let of_target = ranking.iter().filter(|own| {
        own.target.kind == "rmse"
            && own.target.controller == "pid"
            && own.target.group.as_deref() == Some("position")
    });
    assert!(of_target.count() > 100);
}

#[test]
fn outcomes_of_other_episodes_have_no_cause_in_these() {
    let (campaign, mut scores) = simulated("uav-paper", 192);
    // Outcomes in another order belong to no condition: what is sure then is chance, 24 targets at 5 %.
    let groups = campaign.channel_groups().len();
    for controller in 0..campaign.controllers.len() {
        scores.groups[0].channel_groups[controller].rotate_left(71 * groups);
        scores.status[controller].rotate_left(71);
        scores.groups[0].status[controller].rotate_left(71);
    }
    let ranking = rank(&campaign, &scores);
    assert!(ranking.len() > 100);
    assert!(
        ranking
            .iter()
            .filter(|ranked| ranked.p_holm.unwrap() <= 0.05)
            .count()
            <= 3
    );
}

#[test]
fn the_worst_episodes_are_those_that_failed_then_those_nearest_to_it() {
    let (campaign, scores) = simulated("uav-paper", 96);
    let worst = worst(&campaign, &scores);
    assert_eq!(worst.len(), 10 * campaign.controllers.len());
    let groups = campaign.channel_groups();
    for (controller, listed) in worst.chunks(10).enumerate() {
        assert!(
            listed
                .iter()
                .all(|own| own.controller == campaign.controllers[controller])
        );
        for pair in listed.windows(2) {
            let key = |own: &urts_mc::results::sensitivity::WorstEpisode| (own.status, own.excess);
            assert!(key(&pair[0]) >= key(&pair[1]) && pair[0].rank + 1 == pair[1].rank);
        }
        // Nothing that is not listed is worse.
        let last = &listed[9];
        for (episode, status) in (0u32..).zip(&scores.status[controller]) {
            if listed.iter().any(|own| own.episode == episode) {
                continue;
            }
            let of_groups = &scores.groups[0].channel_groups[controller];
            let errors = &of_groups[episode as usize * groups.len()..][..groups.len()];
            let largest = errors.iter().map(|own| own.max_abs).fold(0.0, f64::max)
                / campaign.first_group().verdict.max_error[0];
            assert!(
                (*status, largest) <= (last.status, last.excess),
                "{episode}"
            );
        }
        let first = &listed[0];
        let mut channels = campaign.first_group().channels().iter();
        let channel = channels.position(|name| *name == first.channel).unwrap();
        let mut of_groups = groups.iter();
        let place = of_groups.position(|own| own.channels.contains(&channel));
        let place = first.episode as usize * groups.len() + place.unwrap();
        let error = scores.groups[0].channel_groups[controller][place].max_abs;
        assert_eq!(
            error / campaign.first_group().verdict.max_error[0],
            first.excess
        );
        let (name, amplitude) = &first
            .conditions
            .iter()
            .find(|(name, _)| name == "fault1_amplitude")
            .unwrap();
        assert!(
            amplitude.is_some_and(|amplitude| (0.1..1.0).contains(&amplitude)),
            "{name}"
        );
    }
    // The plain PID fails here, the FTC does not.
    assert_eq!(worst[0].status, Status::Ok);
    assert_eq!(worst[10].status, Status::Exceeded);
}

/// The tables of a campaign's first episodes as if they had been simulated without an error: what was drawn is all
/// there.
fn drawn_tables(campaign: &Campaign, episodes: u32) -> Tables {
    let agent = AgentOutcome {
        failed_step: None,
        diverged: false,
        channels: vec![ChannelOutcome::default(); campaign.first_group().channels().len()],
    };
    let mut tables = Tables::new(campaign);
    for episode in 0..episodes {
        let simulated = EpisodeResult {
            episode: draw(campaign.first_group(), episode),
            outcomes: vec![
                vec![agent.clone(); campaign.first_group().team];
                campaign.controllers.len()
            ],
        };
        tables.add(campaign, &[&simulated]);
    }
    tables
}

/// Root mean square in another way than the program's.
fn size(values: &[f64]) -> Option<f64> {
    let largest = values.iter().copied().map(f64::abs).reduce(f64::max)?;
    let shares = values.iter().map(|value| (value / largest).powi(2));
    let mean = shares.sum::<f64>() / values.len() as f64;
    Some(if largest > 0.0 {
        largest * mean.sqrt()
    } else {
        0.0
    })
}

#[test]
fn what_is_ranked_is_what_the_tables_show() {
    let mut moved = 0;
    for name in ["uav-faults", "uav-digital", "uav-attack", "biped-faults"] {
        let (campaign, episodes) = (campaign(name), 40);
        let tables = drawn_tables(&campaign, episodes);
        let frame = tables.episodes.to_frame().unwrap();
        let stride = campaign.controllers.len() * campaign.first_group().team;
        // The cells of a quantity in an episode, of all agents and channels, where it applies.
        let cells = |quantity: &str, episode: usize| -> Vec<f64> {
            let of_channel = |channel: &_| frame.column(&format!("{quantity}_{channel}"));
            let columns = campaign.first_group().channels().iter().map(of_channel);
            let columns = columns.chain([frame.column(quantity)]).flatten();
            let rows = columns.flat_map(|column| {
                let numbers = column.cast(&polars::prelude::DataType::Float64).unwrap();
                let first = episode * stride;
                let rows = first..first + campaign.first_group().team;
                rows.filter_map(|row| numbers.f64().unwrap().get(row))
                    .collect::<Vec<_>>()
            });
            rows.collect()
        };
        for (condition, values) in &tables.scores.conditions {
            for (episode, &ranked) in values.iter().enumerate() {
                let ranked = (!ranked.is_nan()).then_some(ranked);
                let at = format!("{name}, episode {episode}: {condition}");
                if let Some(fault) = condition.strip_suffix("_agents") {
                    let struck = cells(&format!("{fault}_occurs"), episode);
                    assert_eq!(ranked, Some(struck.iter().sum()), "{at}");
                    continue;
                }
                let shown = cells(condition, episode);
                if condition.starts_with("fault") && condition.ends_with("_onset_s") {
                    assert_eq!(ranked, shown.iter().copied().reduce(f64::min), "{at}");
                    continue;
                }
                match (ranked, size(&shown)) {
                    // The order of a dozen roundings.
                    (Some(ranked), Some(size)) => {
                        assert!((ranked - size).abs() <= 1e-14 * size, "{at}: {ranked}");
                    }
                    (ranked, size) => assert_eq!(ranked, size, "{at}"),
                }
            }
        }
        // Negative control: times as they were drawn are others than those that are ranked.
        for (index, _) in campaign.first_group().faults.iter().enumerate() {
            let onset = format!("fault{index}_onset_s");
            let ranked = tables.scores.conditions.iter();
            let (_, ranked) = ranked.clone().find(|(name, _)| *name == onset).unwrap();
            for (episode, &ranked) in (0..).zip(ranked) {
                let agents = draw(campaign.first_group(), episode).agents;
                let faults = agents.iter().map(|agent| &agent.faults[index]);
                let onsets = faults
                    .filter(|fault| fault.occurs())
                    .map(|fault| fault.onset_s);
                let drawn = onsets.reduce(f64::min);
                moved += u32::from(drawn != (!ranked.is_nan()).then_some(ranked));
            }
        }
    }
    assert!(moved > 100, "{moved}");
}

/// The sizes of a condition where it applies.
fn applying(values: &[f64]) -> Vec<f64> {
    let values = values.iter().copied();
    values.filter(|value| !value.is_nan()).collect()
}

#[test]
fn a_constant_is_no_condition_however_many_it_strikes() {
    let struck = [
        "fault.0.channels=all",
        "fault.0.magnitude=0.1",
        "fault.0.onset_s=2.7001",
    ];
    let campaign = altered("smoke", &struck);
    let scores = tables(&campaign, Precision::F32).scores;
    let of = |name: &str| {
        let mut all = scores.conditions.iter();
        let (_, values) = all.find(|(own, _)| own == name).unwrap();
        applying(values)
    };
    // One agent of the team has the fault in some episodes, two in others: 6 and 12 values.
    let agents = of("fault0_agents");
    assert!(agents.contains(&1.0) && agents.contains(&2.0), "{agents:?}");
    let magnitudes = of("fault0_magnitude");
    assert!(magnitudes.len() > 9 && magnitudes.iter().all(|&magnitude| magnitude == 0.1));
    // An onset between two steps is the later one's in all episodes.
    let onset_s = f64::from(campaign.time.onset_step(2.7001)) * campaign.time.step_s;
    assert!(onset_s > 2.7001 && of("fault0_onset_s").iter().all(|&onset| onset == onset_s));
    let ranked = |name: &str| {
        rank(&campaign, &scores)
            .iter()
            .any(|own| own.condition == name)
    };
    assert!(!ranked("fault0_magnitude") && !ranked("fault0_onset_s"));
    assert!(ranked("fault0_agents"));
    // A list that is the same in every episode is a constant too, however many agents it strikes.
    let list = "fault.0.magnitude=[0.2, 0.2, 0.2, 0.5, 0.5, 0.5]";
    let listed = altered("smoke", &["fault.0.channels=all", list]);
    let scores = tables(&listed, Precision::F32).scores;
    let mut sizes = scores.conditions.iter();
    let (_, sizes) = sizes.find(|(own, _)| own == "fault0_magnitude").unwrap();
    let sizes = applying(sizes);
    assert!(
        sizes.len() > 9 && sizes.iter().all(|size| *size == sizes[0]),
        "{sizes:?}"
    );
    let ranked = rank(&listed, &scores);
    assert!(ranked.iter().all(|own| own.condition != "fault0_magnitude"));
    // Negative control: the mean of 12 squares alone is another number.
    let squares: f64 = [0.1_f64; 12].iter().map(|own| own * own).sum();
    assert_ne!((squares / 12.0).sqrt(), 0.1);
}
