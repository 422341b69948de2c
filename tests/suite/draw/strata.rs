//! Names of faults, and strata: which episodes meet what.

use crate::common::{altered, tables};
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::{Campaign, StratumFaults};
use urts_mc::draw::{Episode, draw};
use urts_mc::results::sensitivity::rank;

const SCREENING: &str = r#"[[strata]]
faults = "each"
[[strata]]
faults = []
[[strata]]
faults = "all"
share = 3
[[strata]]
name = "both"
faults = ["lost thrust", "sensor smoothed-square"]
share = 2
"#;

/// The smoke campaign, one stratum per fault, without any, with both, and mixed.
fn screening(episodes: u32) -> Campaign {
    altered(
        "smoke",
        &[
            SCREENING,
            "fault.0.name=\"lost thrust\"",
            &format!("episodes={episodes}"),
        ],
    )
}

#[test]
fn the_episodes_of_a_stratum_can_be_counted_without_simulating_them() {
    let campaign = screening(64);
    let strata = &campaign.strata;
    let turn = u32::try_from(strata.turn()).unwrap();
    for stratum in 0..strata.all().len() {
        let mut count = 0;
        for episode in 0..3 * turn + 2 {
            assert_eq!(strata.count(stratum, episode), count);
            if strata.index(episode) == Some(stratum) {
                count += 1;
                // Episodes are numbered from 0.
                assert_eq!(strata.episodes_for(stratum, count), u64::from(episode) + 1);
            }
        }
    }
    assert_eq!((strata.count(99, 64), strata.episodes_for(99, 1)), (0, 0));
}

/// An episode's draw with the faults out of it.
fn without_occurrence(mut episode: Episode) -> Episode {
    for fault in episode
        .agents
        .iter_mut()
        .flat_map(|agent| &mut agent.faults)
    {
        fault.strikes.clear();
    }
    episode
}

#[test]
fn faults_without_a_name_have_that_of_target_and_kind_with_a_number_where_it_is_taken() {
    let fault = |name: &str| {
        format!("[[fault]]\n{name}\ntarget = \"sensor\"\nkind = \"bias\"\nmagnitude = 0.1\n")
    };
    let all = [
        fault(""),
        fault(""),
        fault("name = \"sensor bias 2\""),
        fault(""),
        fault("name = \"öl im Getriebe\""),
    ];
    let campaign = altered("smoke", &[&all.concat()]);
    let names: Vec<&str> = campaign
        .first_group()
        .faults
        .iter()
        .map(|fault| &*fault.name)
        .collect();
    assert_eq!(
        names,
        [
            "actuator loss-of-effectiveness",
            "sensor smoothed-square",
            "sensor bias",
            "sensor bias 3",
            "sensor bias 2",
            "sensor bias 4",
            "öl im Getriebe",
        ]
    );
}

#[test]
fn episodes_go_round_the_strata_by_their_shares_whatever_the_length() {
    let campaign = screening(24);
    let strata = &campaign.strata;
    let names: Vec<&str> = strata.all().iter().map(|stratum| &*stratum.name).collect();
    assert_eq!(
        names,
        [
            "lost thrust",
            "sensor smoothed-square",
            "none",
            "mixed",
            "both"
        ]
    );
    // One to each, a second to those with a share of 2 or more, a third to those of 3.
    let turn = [0, 1, 2, 3, 4, 3, 4, 3];
    assert_eq!(strata.turn(), turn.len());
    for episode in 0..1000 {
        let index = strata.index(episode).unwrap();
        assert_eq!(index, turn[episode as usize % turn.len()]);
        assert_eq!(screening(9).strata.index(episode), Some(index));
    }
}

#[test]
fn a_stratum_decides_which_faults_occur_and_nothing_else() {
    let campaign = screening(24);
    let plain = altered("smoke", &[]);
    let mut mixed = [0, 0];
    for index in 0..800 {
        let (episode, undivided) = (
            draw(campaign.first_group(), index),
            draw(plain.first_group(), index),
        );
        let stratum = campaign.strata.of(index).unwrap();
        for (agent, drawn) in episode.agents.iter().zip(&undivided.agents) {
            for (fault, own) in agent.faults.iter().enumerate() {
                match &stratum.faults {
                    StratumFaults::Certain(certain) => {
                        assert_eq!(own.occurs(), certain.contains(&fault));
                    }
                    // With its own probability: as where the campaign is not divided.
                    StratumFaults::ByProbability => {
                        assert_eq!(own, &drawn.faults[fault]);
                        mixed[0] += u32::from(fault == 0 && own.occurs());
                        mixed[1] += u32::from(fault == 0);
                    }
                }
            }
        }
        // All else is what the same episode meets without strata.
        assert_eq!(without_occurrence(episode), without_occurrence(undivided));
    }
    // Both happen to the fault with a probability of 0.25.
    assert!(
        mixed[1] == 900 && (150..300).contains(&mixed[0]),
        "{mixed:?}"
    );
}

#[test]
fn the_stratum_is_a_column_of_the_episodes_and_of_no_undivided_campaign() {
    let campaign = screening(24);
    let frame = tables(&campaign, Precision::F32)
        .episodes
        .to_frame()
        .unwrap();
    let column = |name: &str| {
        let column = frame.column(name).unwrap();
        (0..frame.height())
            .map(|row| column.get(row).unwrap().to_string())
            .collect::<Vec<String>>()
    };
    for (episode, stratum) in column("episode").iter().zip(column("stratum")) {
        let own = campaign.strata.of(episode.parse().unwrap()).unwrap();
        assert_eq!(stratum.trim_matches('"'), &*own.name);
    }
    let plain = altered("smoke", &["episodes=2"]);
    let undivided = tables(&plain, Precision::F32).episodes.to_frame().unwrap();
    assert!(undivided.column("stratum").is_err());
}

#[test]
fn what_a_stratum_makes_certain_is_not_ranked_as_if_it_were_drawn() {
    let campaign = screening(96);
    let ranking = rank(&campaign, &tables(&campaign, Precision::F32).scores);
    let n = |condition: &str| {
        let found = ranking.iter().find(|own| own.condition == condition);
        found.map(|own| own.episodes)
    };
    // The mixed stratum has three of eight episodes.
    assert_eq!(n("fault0_agents"), Some(36));
    assert!(n("fault0_magnitude").is_some_and(|n| (12..36).contains(&n)));
    assert_eq!(n("mass_scale"), Some(96));
    // Without a stratum that draws, the number of struck agents is never left to chance.
    let certain = altered("smoke", &["strata.+={ faults = \"each\" }"]);
    let ranking = rank(&certain, &tables(&certain, Precision::F32).scores);
    assert!(ranking.iter().all(|own| own.condition != "fault0_agents"));
    assert!(
        ranking
            .iter()
            .any(|own| own.condition == "fault0_magnitude")
    );
}

/// The smoke campaign, whose loss of effectiveness differs from agent to agent.
fn one_by_one(more: &str) -> Campaign {
    let blocks = r#"fault.0.agents=[
    { probability = 1.0, channels = [2, 3], onset_s = 1.0, duration_s = 0.5, magnitude = 0.25 },
    { probability = 0.0 },
    { channels = "one", ramp_s = { uniform = [0.2, 0.4] } },
]"#;
    altered(
        "smoke",
        &["fault.0.channels=", "fault.0.duration_s=2.0", blocks, more],
    )
}

#[test]
fn a_block_says_whether_where_when_and_how_its_agent_has_a_fault() {
    let campaign = one_by_one("");
    let plain = altered("smoke", &[]);
    let mut third = 0;
    for episode in 0..64 {
        let (own, common) = (
            draw(campaign.first_group(), episode),
            draw(plain.first_group(), episode),
        );
        let [first, second, last] = [0, 1, 2].map(|agent| &own.agents[agent].faults[0]);
        assert_eq!(first.strikes, [false, true, true, false, false, false]);
        assert_eq!(
            (first.onset_s, first.duration_s, first.ramp_s),
            (1.0, 0.5, 0.0)
        );
        assert_eq!(first.parameters[0], [0.25; 6]);
        assert!(!second.occurs());
        // The third has the table's, where its block is silent: the draws of the shipped campaign.
        let shipped = &common.agents[2].faults[0];
        assert_eq!(last.strikes, shipped.strikes);
        assert_eq!(last.onset_s, shipped.onset_s);
        assert_eq!(last.parameters, shipped.parameters);
        assert_eq!(last.duration_s, 2.0);
        assert!((0.2..0.4).contains(&last.ramp_s));
        third += u32::from(last.occurs());
    }
    // A quarter of them.
    assert!((6..=28).contains(&third), "{third}");
}

#[test]
fn a_stratum_spares_whom_a_fault_never_strikes() {
    let campaign = one_by_one("[[strata]]\nfaults = \"each\"\n[[strata]]\nfaults = []");
    for episode in 0..9 {
        let index = campaign.strata.index(episode).unwrap();
        let agents = draw(campaign.first_group(), episode).agents;
        let occurs: Vec<bool> = agents.iter().map(|own| own.faults[0].occurs()).collect();
        let certain = index == 0;
        assert_eq!(occurs, [certain, false, certain], "episode {episode}");
    }
}

#[test]
fn a_background_is_in_all_strata_and_none_of_its_own() {
    let more = "[[fault]]\nname = \"noise\"\ntarget = \"sensor\"\nkind = \"noise\"\nstd = 0.001\nprobability = 0.5\nbackground = true\n";
    let with = |strata: &str| altered("smoke", &[&format!("{more}{strata}")]);
    let strata = "[[strata]]\nfaults = \"each\"\n[[strata]]\nfaults = []\n";
    let (divided, whole) = (with(strata), with(""));
    let names = divided.strata.all().iter().map(|own| own.name.to_string());
    let names: Vec<String> = names.collect();
    assert_eq!(
        names,
        [
            "actuator loss-of-effectiveness",
            "sensor smoothed-square",
            "none"
        ]
    );
    let mut had = [0; 3];
    for episode in 0..96 {
        // As it is drawn without strata, and whatever the stratum.
        let occurs = |campaign: &Campaign| {
            let agents = draw(campaign.first_group(), episode).agents;
            agents
                .iter()
                .map(|own| own.faults[2].occurs())
                .collect::<Vec<bool>>()
        };
        assert_eq!(occurs(&divided), occurs(&whole));
        let stratum = divided.strata.index(episode).unwrap();
        had[stratum] += occurs(&divided).iter().filter(|own| **own).count();
    }
    // Half of 96 agents each; beyond four standard deviations of 4.9 by chance once in 16,000.
    assert!(had.iter().all(|own| (29..=67).contains(own)), "{had:?}");
    // It is left to chance, and may be ranked, in all of them.
    let short = with(strata).with_episodes(48).unwrap();
    let ranking = rank(&short, &tables(&short, Precision::F32).scores);
    let of_noise = ranking
        .iter()
        .filter(|own| own.condition == "fault2_agents");
    assert!(of_noise.clone().count() > 0 && of_noise.clone().all(|own| own.episodes == 48));
}
