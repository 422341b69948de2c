//! Groups of agents in one episode: each as it would be alone, the episode as bad as the worst of them.

use crate::common::{adapter_or_skip, repository, simulate_group, tables};
use std::fs;
use toml::{Table, Value};
use urts_mc::backend::EpisodeResult;
use urts_mc::backend::cpu::Precision;
use urts_mc::backend::gpu::{Gpu, Wanted};
use urts_mc::campaign::{Campaign, StratumFaults};
use urts_mc::controllers::GainSet;
use urts_mc::draw::draw;
use urts_mc::draw::quantities::title;
use urts_mc::results::scores::{GroupScores, Status};
use urts_mc::results::tables::Tables;
use urts_mc::results::{MetricQuantiles, PairedComparison, compare, failure_rates, summarise};
use urts_mc::simulation::cross_check::cross_check;
use urts_mc::simulation::{Backend, RunOptions, Simulation, simulate};

/// The shipped campaign of UAVs and robots as TOML, short: faults come early.
fn file(episodes: i64, duration_s: f64) -> Table {
    let text = fs::read_to_string(repository("campaigns/mixed-teams.toml")).unwrap();
    let mut file: Table = text.parse().unwrap();
    file["episodes"] = episodes.into();
    file["time"]["duration_s"] = duration_s.into();
    file["time"]["settle_s"] = 0.1.into();
    // So tight that each of the groups breaks it in some episodes in which the other does not.
    for (group, max_error) in groups(&mut file).iter_mut().zip([0.16, 0.18]) {
        group["fault"][0]["onset_s"] = 0.3.into();
        group["fault"][0]["probability"] = 0.5.into();
        group["verdict"]["max_error"] = max_error.into();
    }
    file
}

fn groups(file: &mut Table) -> &mut Vec<Value> {
    file["group"].as_array_mut().unwrap()
}

fn parsed(file: &Table) -> Campaign {
    let path = repository("campaigns/mixed-teams.toml");
    Campaign::parse(&file.to_string(), &path).unwrap_or_else(|error| panic!("{error}"))
}

/// A group alone: its tables at the top of a file without `[[group]]`.
fn alone(file: &Table, index: usize) -> Campaign {
    let mut file = file.clone();
    let Value::Table(mut group) = groups(&mut file).remove(index) else {
        panic!("a group is a table");
    };
    file.remove("group");
    group.remove("name");
    file.extend(group);
    parsed(&file)
}

/// The same with the addresses of the draws that the group has beside the others.
fn addressed(file: &Table, index: usize) -> Campaign {
    let first_agent = parsed(file).groups()[index].first_agent;
    alone(file, index).with(|group| group.first_agent = first_agent)
}

/// The numbers of each column that a group's rows fill, by the column's name in a campaign of the group alone.
fn rows_of(tables: &Tables, campaign: &Campaign, index: usize) -> Vec<(String, Vec<String>)> {
    let frame = tables.episodes.to_frame().unwrap();
    let group = &campaign.groups()[index];
    let names = frame.column("group").unwrap().str().unwrap();
    let own: Vec<usize> = (0..frame.height())
        .filter(|&row| names.get(row) == Some(&*group.name))
        .collect();
    let columns = frame.columns().iter();
    let filled = columns.map(|column| {
        let cells = own.iter().map(|&row| column.get(row).unwrap().to_string());
        // Disturbances and faults are numbered through.
        let mut name = column.name().to_string();
        for kind in ["disturbance", "fault"] {
            let first = match kind {
                "fault" => group.first_fault,
                _ => group.first_disturbance,
            };
            if let Some((number, rest)) = name
                .strip_prefix(kind)
                .and_then(|rest| rest.split_once('_'))
                && let Ok(number) = number.parse::<usize>()
                && number >= first
            {
                name = format!("{kind}{}_{rest}", number - first);
            }
        }
        (name, cells.collect())
    });
    let filled =
        filled.filter(|(_, cells): &(String, Vec<String>)| cells.iter().any(|cell| cell != "null"));
    filled.collect()
}

#[test]
fn a_group_is_simulated_as_it_would_be_alone_apart_from_the_addresses_of_its_draws() {
    let file = file(21, 1.0);
    let mixed = parsed(&file);
    assert_eq!(mixed.agents(), 7);
    for precision in [Precision::F64, Precision::F32] {
        for index in 0..2 {
            let together = simulate_group(&mixed, index, precision);
            let apart = simulate_group(&addressed(&file, index), 0, precision);
            assert_eq!(together.len(), 21);
            // As text, in which errors of an episode that left the numbers are equal too.
            let text = |simulated: &[EpisodeResult]| format!("{simulated:?}");
            assert!(
                text(&together) == text(&apart),
                "{precision:?}, group {index}"
            );
            // The first group has the addresses of a campaign of its own; the second has others, without which its
            // draws would repeat those of the first.
            let plain = simulate_group(&alone(&file, index), 0, precision);
            assert_eq!(
                text(&together) == text(&plain),
                index == 0,
                "{precision:?}, group {index}"
            );
        }
    }
}

#[test]
fn draws_that_agents_of_a_group_share_are_not_shared_with_another_group() {
    let mixed = parsed(&file(64, 1.0));
    let draws = |index: usize| -> Vec<f64> {
        let group = &mixed.groups()[index];
        (0..64)
            .map(|episode| draw(group, episode).agents[0].kappa)
            .collect()
    };
    let (uavs, robots) = (draws(0), draws(1));
    assert!(uavs != robots);
    // Coupling is on or off by chance, independently: both 16 of 64 in the mean.
    let both = uavs
        .iter()
        .zip(&robots)
        .filter(|(a, b)| **a > 0.0 && **b > 0.0);
    let both = both.count();
    assert!((6..=26).contains(&both), "{both}");
    for (index, kappa) in [(0, uavs), (1, robots)] {
        let group = &mixed.groups()[index];
        let shared = |episode: u32| {
            let agents = draw(group, episode).agents;
            agents
                .iter()
                .all(|agent| agent.kappa == kappa[episode as usize])
        };
        assert!((0..64).all(shared));
    }
}

#[test]
fn the_tables_of_groups_are_those_of_each_alone_and_the_worst_status_is_the_episodes() {
    let file = file(21, 1.0);
    let mixed = parsed(&file);
    let together = tables(&mixed, Precision::F32);
    let apart = [0, 1].map(|index| tables(&addressed(&file, index), Precision::F32));
    let (mut differ, mut failed) = (0, 0);
    for controller in 0..mixed.controllers.len() {
        for episode in 0..21 {
            let status = apart
                .each_ref()
                .map(|own| own.scores.status[controller][episode]);
            for (own, status) in together.scores.groups.iter().zip(status) {
                assert_eq!(own.status[controller][episode], status);
            }
            let worst = together.scores.status[controller][episode];
            assert_eq!(worst, status[0].max(status[1]));
            differ += usize::from(status[0] != status[1]);
            failed += usize::from(worst != Status::Ok);
        }
    }
    assert!(
        differ > 5 && failed > 45 && failed < 63,
        "{differ}, {failed}"
    );
    for (index, apart) in apart.iter().enumerate() {
        let group = &together.scores.groups[index];
        let text = |scores: &GroupScores| format!("{scores:?}");
        assert!(text(group) == text(&apart.scores.groups[0]));
        let frame = apart.episodes.to_frame().unwrap();
        let rows = rows_of(&together, &mixed, index);
        let mut compared = 0;
        for column in frame.columns() {
            let name = column.name().as_str();
            let cells = (0..frame.height()).map(|row| column.get(row).unwrap().to_string());
            let cells: Vec<String> = cells.collect();
            if cells.iter().all(|cell| cell == "null") {
                continue;
            }
            let own = rows.iter().find(|(own, _)| own == name);
            let (_, own) = own.unwrap_or_else(|| panic!("no column {name}"));
            // How the episode ended is what the groups decide together.
            if name != "episode_status" {
                assert!(*own == cells, "{name}");
                compared += 1;
            }
        }
        // No columns beside these and the group's name; what only the other group has is empty.
        assert_eq!(rows.len(), compared + 2, "{rows:?}");
    }
}

#[test]
fn statistics_name_the_group_of_channels_conditions_and_faults() {
    let mixed = parsed(&file(21, 1.0));
    let names: Vec<String> = mixed
        .channel_groups()
        .iter()
        .map(|of| of.name.to_string())
        .collect();
    assert_eq!(names, ["uavs position", "uavs attitude", "robots joints"]);
    let tables = tables(&mixed, Precision::F32);
    let conditions: Vec<&str> = tables
        .scores
        .conditions
        .iter()
        .map(|(name, _)| &**name)
        .collect();
    for name in [
        "uavs_kappa",
        "robots_kappa",
        "disturbance1_amplitude",
        "fault3_amplitude",
    ] {
        assert!(conditions.contains(&name), "{conditions:?}");
    }
    let mut distinct = conditions.clone();
    distinct.sort_unstable();
    distinct.dedup();
    assert_eq!(distinct.len(), conditions.len());
    assert_eq!(title(&mixed, "uavs_kappa"), "uavs kappa");
    assert_eq!(
        title(&mixed, "disturbance1_amplitude"),
        "robots sine amplitude"
    );
    assert_eq!(
        title(&mixed, "fault2_magnitude"),
        "robots actuator loss-of-effectiveness magnitude"
    );
    assert_eq!(tables.scores.fault_occurs.len(), 4);
    // By chance half of the agents have it: of four robots, hardly ever none.
    let having = tables.scores.fault_occurs[2]
        .iter()
        .filter(|has| **has)
        .count();
    assert!((14..=21).contains(&having), "{having}");
}

#[test]
fn what_leaves_the_numbers_in_one_group_leaves_the_errors_of_another_as_they_are() {
    let mixed = parsed(&file(21, 1.0));
    let mut scores = tables(&mixed, Precision::F32).scores;
    let before = summarise(&mixed, &scores);
    let ratios = compare(&mixed, &scores);
    // The robots diverge under the first controller in most of the episodes.
    for episode in 0..15 {
        scores.status[0][episode] = Status::Diverged;
        let robots = &mut scores.groups[1];
        robots.status[0][episode] = Status::Diverged;
        let channels = robots.rmse[0].len() / 21;
        robots.rmse[0][episode * channels..][..channels].fill(f64::INFINITY);
        let of_groups = robots.channel_groups[0].len() / 21;
        for own in &mut robots.channel_groups[0][episode * of_groups..][..of_groups] {
            (own.rmse, own.max_abs) = (f64::INFINITY, f64::INFINITY);
        }
    }
    let after = summarise(&mixed, &scores);
    let median = |rows: &[MetricQuantiles], group: &str| {
        let of_first = |row: &&MetricQuantiles| row.failures.controller == "ftc";
        let mut rows = rows
            .iter()
            .filter(of_first)
            .filter(|row| *row.group == *group);
        let row = rows.find(|row| row.metric == "rmse" && &*row.failures.stratum == "all");
        let row = row.unwrap();
        let own = row.of_group.as_ref().unwrap();
        assert_eq!(own.agents.as_deref(), group.split(' ').next());
        (
            row.quantiles[0].value.unwrap(),
            row.failures.diverged,
            own.diverged,
        )
    };
    assert_eq!(
        median(&after, "uavs position").0,
        median(&before, "uavs position").0
    );
    assert_eq!(median(&after, "uavs position").1, 15);
    assert_eq!(median(&after, "uavs position").2, 0);
    assert_eq!(median(&after, "robots joints"), (f64::INFINITY, 15, 15));
    let log_ratio = |rows: &[PairedComparison], name: &str| {
        let ratio = rows[0]
            .ratios
            .iter()
            .find(|ratio| *ratio.name == *name)
            .unwrap();
        (ratio.log_ratio.unwrap().value, ratio.diverged)
    };
    let compared = compare(&mixed, &scores);
    assert_eq!(log_ratio(&compared, "uavs x"), log_ratio(&ratios, "uavs x"));
    assert_eq!(log_ratio(&compared, "robots joints").0, f64::NEG_INFINITY);
    // Where the robots diverge under both, the pair is a tie.
    let [only_first, _, both] = log_ratio(&compared, "robots joints").1;
    assert!(
        only_first > 10 && only_first + both == 15,
        "{only_first}, {both}"
    );
    let rates = failure_rates(&mixed, &scores);
    let names: Vec<Option<&str>> = rates[..3].iter().map(|own| own.agents.as_deref()).collect();
    assert_eq!(names, [None, Some("uavs"), Some("robots")]);
    assert_eq!(rates[2].diverged, 15);
}

#[test]
fn a_stratum_names_the_faults_of_all_groups_that_are_called_so() {
    let mut file = file(16, 1.0);
    let strata = "[[strata]]\nfaults = []\n[[strata]]\nfaults = \"each\"\n";
    file.extend(strata.parse::<Table>().unwrap());
    let campaign = parsed(&file);
    let strata: Vec<(String, Vec<usize>)> = campaign
        .strata
        .all()
        .iter()
        .map(|stratum| match &stratum.faults {
            StratumFaults::Certain(faults) => (stratum.name.to_string(), faults.clone()),
            StratumFaults::ByProbability => panic!("{}", stratum.name),
        })
        .collect();
    let expected = [
        ("none", vec![]),
        ("actuator loss-of-effectiveness", vec![0, 2]),
        ("sensor noise", vec![1]),
        ("sensor smoothed-square", vec![3]),
    ];
    assert_eq!(
        strata,
        expected.map(|(name, faults)| (name.to_string(), faults))
    );
    // Faults of the UAVs and of the robots in each of the four strata.
    let has = [
        [[false, false], [false, false]],
        [[true, false], [true, false]],
        [[false, true], [false, false]],
        [[false, false], [false, true]],
    ];
    for episode in 0..16 {
        for (index, group) in campaign.groups().iter().enumerate() {
            for agent in draw(group, episode).agents {
                let occurs: Vec<bool> = agent.faults.iter().map(|own| own.occurs()).collect();
                assert_eq!(
                    occurs,
                    has[episode as usize % 4][index],
                    "episode {episode}"
                );
            }
        }
    }
}

#[test]
fn val_groups_on_a_gpu_are_each_as_it_would_be_alone_and_agree_with_the_cpu() {
    let Some(adapter) = adapter_or_skip() else {
        return;
    };
    let gpu = Gpu::open(Wanted::Named(&adapter)).unwrap();
    let options = RunOptions {
        backend: Backend::Gpu {
            adapter: Some(adapter),
        },
        ..RunOptions::cpu(Precision::F32)
    };
    let mut file = file(5, 0.6);
    file["controllers"] = vec![Value::from("ftc"), Value::from("pid")].into();
    let on_gpu = |campaign: &Campaign| {
        let gains = GainSet::of_groups(campaign).unwrap();
        let simulation = simulate(campaign, &gains, &options, Some(&gpu), &|_| ()).unwrap();
        assert_eq!(simulation.episodes(), 5);
        assert!(simulation.interrupted.is_none());
        (simulation, gains)
    };
    let mixed = parsed(&file);
    let (together, gains) = on_gpu(&mixed);
    for index in 0..2 {
        let (apart, _) = on_gpu(&addressed(&file, index));
        let text = |simulation: &Simulation, index: usize| {
            format!("{:?}", simulation.tables.scores.groups[index])
        };
        assert!(text(&together, index) == text(&apart, 0), "group {index}");
        // At the addresses of a campaign of its own, the robots would draw other numbers.
        let (plain, _) = on_gpu(&alone(&file, index));
        assert_eq!(text(&together, index) == text(&plain, 0), index == 0);
    }
    let scores = &together.tables.scores;
    let segment = &together.segments[0];
    let check = cross_check(&mixed, &gains, &options, segment, scores, Some(&gpu), 5).unwrap();
    assert!(check.holds() && check.compared > 0, "{check:?}");
    assert_eq!(check.attenuation.len(), 3);
    // A row of the tables that is not what the device gives is noticed.
    let mut changed = scores.clone();
    changed.groups[1].fingerprint[0][2] ^= 1;
    let check = cross_check(&mixed, &gains, &options, segment, &changed, Some(&gpu), 5).unwrap();
    assert_eq!(check.not_repeated, 1);
}
