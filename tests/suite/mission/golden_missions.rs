//! Whole missions without errors, against the log of an independent implementation.

use crate::mission::scenarios::*;
use serde_json::Value;
use urts_mc::mission::{Event, Mission, MissionDraws, Outcome, Scenario, Subject, ideal};

/// A row of a log as the golden file names things.
#[derive(Debug, PartialEq, Clone)]
struct Row {
    time_s: f64,
    event: String,
    agent: Option<String>,
    subject: String,
    other: Option<String>,
    cost_s: Option<f64>,
}

fn row(scenario: &Scenario, event: &Event) -> Row {
    let task = |task: usize| {
        let kind = if scenario.is_uav(task) {
            "search-uav"
        } else {
            "search"
        };
        format!("{kind} {}", task + 1)
    };
    let subject = match event.subject {
        Some(Subject::Search(index)) => task(index),
        Some(Subject::Rescue(target)) => format!("rescue {}", target + 1),
        Some(Subject::Target(target)) => format!("target {}", target + 1),
        Some(Subject::Obstacle(obstacle)) => format!("obstacle {}", obstacle + 1),
        Some(Subject::Map) => "obstacle map".into(),
        None => String::new(),
    };
    let name = event.kind.name();
    Row {
        time_s: event.time_s,
        agent: event.agent.map(|agent| scenario.name(agent)),
        subject,
        other: event.other.map(|agent| scenario.name(agent)),
        cost_s: event.value.filter(|_| name == "assigned"),
        event: name.into(),
    }
}

fn golden_row(value: &Value) -> Row {
    let text = |key: &str| value[key].as_str().map(String::from);
    let event = text("event")
        .unwrap()
        .replace("mission ", "")
        .replace(' ', "-");
    let numbered = |key: &str| value.get(key).map(|number| format!("{key} {number}"));
    let subject = text("task").or(numbered("target")).or(numbered("obstacle"));
    Row {
        time_s: value["t"].as_f64().unwrap(),
        event,
        agent: text("agent"),
        subject: subject.unwrap_or_default().replace('"', ""),
        other: text("other").or(text("around")),
        cost_s: value["cost_s"].as_f64(),
    }
}

/// What differs between a log and the golden one of a mission.
fn differences(name: &str, scenario: &Scenario, outcome: &Outcome) -> Vec<String> {
    let rows = GOLDEN[name]["log"].as_array().unwrap();
    let golden: Vec<Row> = rows.iter().map(golden_row).collect();
    let ours = outcome.events.iter().map(|event| row(scenario, event));
    let ours: Vec<Row> = ours.collect();
    let mut differences = Vec::new();
    if ours.len() != golden.len() {
        differences.push(format!("{} rows and not {}", ours.len(), golden.len()));
    }
    for (ours, golden) in ours.into_iter().zip(golden) {
        // Finds are rounded to 1 ms and depend on where on a curve a robot is; all other times are whole epochs.
        let tolerance_s = if golden.event == "found" { 5e-3 } else { 0.0 };
        let in_time = (ours.time_s - golden.time_s).abs() <= tolerance_s;
        let costs = match (ours.cost_s, golden.cost_s) {
            // Rounded to 0.1 s, of a cost in whole ms.
            (Some(ours), Some(golden)) => (ours - golden).abs() < 0.0505,
            (ours, golden) => ours == golden,
        };
        // The golden log does not say of which task a goal is skipped.
        let said = !golden.subject.is_empty();
        let bare = |row: &Row| Row {
            time_s: 0.0,
            cost_s: None,
            subject: if said {
                row.subject.clone()
            } else {
                String::new()
            },
            ..row.clone()
        };
        if !in_time || !costs || bare(&ours) != bare(&golden) {
            differences.push(format!("{ours:?} and not {golden:?}"));
        }
    }
    differences
}

/// Compares a mission's log and counts with the golden ones.
fn compare(name: &str, scenario: &Scenario, outcome: &Outcome) {
    let differences = differences(name, scenario, outcome);
    assert!(differences.is_empty(), "{}", differences.join("\n"));
    let golden = &GOLDEN[name];
    let tally = &outcome.tally;
    for (key, ours) in [
        ("plans", tally.plans),
        ("replans", tally.replans),
        ("waits", tally.waits),
        ("allocations", tally.allocations),
        ("collisions", tally.collisions.total()),
    ] {
        assert_eq!(golden[key].as_u64(), Some(ours.into()), "{key}");
    }
    assert_eq!(
        golden["plan_iterations"].as_u64(),
        Some(tally.plan_iterations)
    );
    assert_eq!(golden["accomplished_s"].as_f64(), outcome.accomplished_s);
    for (index, found_s) in outcome.found_s.iter().enumerate() {
        let golden_s = golden["found_s"][index].as_f64().unwrap();
        assert!((found_s.unwrap() - golden_s).abs() < 5e-3);
        assert_eq!(
            golden["rescued_s"][index].as_f64(),
            outcome.rescued_s[index]
        );
    }
    // Three digits. The golden missions do not look at their last epoch, in which nobody comes nearer than before.
    let apart_m = golden["min_separation_m"].as_f64().unwrap();
    assert!(
        (tally.min_separation_m - apart_m).abs() < 1e-3,
        "{}",
        tally.min_separation_m
    );
    for (index, golden) in golden["coverage"].as_array().unwrap().iter().enumerate() {
        // Every minute; a robot whose place differs by rounding sees the same centres of cells.
        let ours = tally.coverage_after(60 * index).unwrap();
        assert!(
            (ours - golden.as_f64().unwrap()).abs() < 5.1e-5,
            "minute {index}: {ours}"
        );
    }
}

#[test]
fn val_the_small_mission_has_the_golden_log() {
    let (scenario, draws) = small();
    let outcome = ideal(&scenario, &draws, &[]);
    compare("mission_small", &scenario, &outcome);
    // By hand: 42 s to the end of the third lane, a ramp of 3 s to 1.875 m/s that ends at y = 5.3125 m, on to 8.5 m
    // where the target comes into range, and 2 s of exposure at 0.5 per s.
    let by_hand_s = 42.0 + 3.0 + (8.5 - 5.3125) / 1.875 + 2.0;
    assert!((outcome.found_s[0].unwrap() - by_hand_s).abs() < 1e-9);
}

#[test]
fn val_the_papers_example_has_the_golden_log() {
    let (scenario, draws) = paper_example();
    let outcome = ideal(&scenario, &draws, &[]);
    compare("mission_paper", &scenario, &outcome);
    // As in the paper: the task between two areas goes to one robot of each.
    let rescuers = outcome
        .events
        .iter()
        .filter(|event| event.subject == Some(Subject::Rescue(0)));
    let rescuers: Vec<String> = rescuers
        .map(|event| scenario.name(event.agent.unwrap()))
        .collect();
    assert_eq!(rescuers, ["a1,5", "a2,2"]);
}

#[test]
fn val_the_full_mission_with_losses_has_the_golden_log() {
    let draws = MissionDraws::of_episode(&PAPER, SEED, 0).unwrap();
    let losses = [(5, 60.0), (3, 100.0)];
    let outcome = ideal(&PAPER, &draws, &losses);
    compare("mission_full", &PAPER, &outcome);
    // The UAV of the first team takes over the area of the lost one when its own is done.
    let takes_over =
        |event: &&Event| event.subject == Some(Subject::Search(5)) && event.agent == Some(0);
    let taken = outcome.events.iter().find(takes_over).unwrap();
    assert_eq!(taken.time_s, 223.0);
    // Without the second loss the log is another one.
    let other = ideal(&PAPER, &draws, &losses[..1]);
    assert!(!differences("mission_full", &PAPER, &other).is_empty());
}

#[test]
fn val_a_hundred_missions_are_those_of_the_golden_file() {
    let golden = &GOLDEN["mission_statistics"]["ideal"];
    let episodes = golden["episodes"].as_array().unwrap();
    assert_eq!(episodes.len(), 100);
    let mut done_s = Vec::new();
    let mut found_s = Vec::new();
    for (episode, golden) in (0..).zip(episodes) {
        let draws = MissionDraws::of_episode(&PAPER, SEED, episode).unwrap();
        let outcome = ideal(&PAPER, &draws, &[]);
        let tally = &outcome.tally;
        assert_eq!(
            golden["done_s"].as_f64(),
            outcome.accomplished_s,
            "episode {episode}"
        );
        for (key, ours) in [
            ("plans", tally.plans),
            ("replans", tally.replans),
            ("waits", tally.waits),
            ("plan_fail", tally.plan_failures),
            ("collisions", tally.collisions.total()),
            ("allocations", tally.allocations),
        ] {
            assert_eq!(
                golden[key].as_u64(),
                Some(ours.into()),
                "episode {episode}: {key}"
            );
        }
        for (target, golden_s) in golden["found_s"].as_array().unwrap().iter().enumerate() {
            let (ours, golden) = (outcome.found_s[target], golden_s.as_f64());
            // The same arithmetic in another order: 3e-13 s in the worst of them.
            let near = |ours: f64| golden.is_some_and(|golden| (ours - golden).abs() < 1e-9);
            assert!(
                ours.map_or(golden.is_none(), near),
                "episode {episode}: {ours:?} {golden:?}"
            );
        }
        assert_eq!(tally.collisions.total(), 0);
        done_s.extend(outcome.accomplished_s);
        found_s.extend(outcome.found_s);
    }
    assert!(done_s.len() >= 95, "{} accomplished", done_s.len());
    done_s.sort_by(f64::total_cmp);
    let median_s = done_s[done_s.len() / 2];
    assert!((265.0..=305.0).contains(&median_s), "{median_s} s");
    let found_by = |limit_s: f64| {
        let found = found_s
            .iter()
            .flatten()
            .filter(|&&time_s| time_s <= limit_s)
            .count();
        found as f64 / found_s.len() as f64
    };
    assert!(
        (0.54..=0.73).contains(&found_by(120.0)),
        "{}",
        found_by(120.0)
    );
    assert!(
        (0.90..=0.98).contains(&found_by(240.0)),
        "{}",
        found_by(240.0)
    );
}

#[test]
fn before_its_first_decision_a_mission_stands_at_its_starts() {
    let (scenario, draws) = small();
    let mission = Mission::start(&scenario, &draws);
    let places = mission
        .motions()
        .iter()
        .map(urts_mc::mission::Motion::end_m);
    assert_eq!(places.collect::<Vec<_>>(), scenario.starts_m());
    assert!(mission.events().is_empty() && !mission.is_over());
}

/// What decisions cost, shown on demand.
#[test]
fn decisions_of_a_mission_are_cheap() {
    let draws: Vec<MissionDraws> = (0..30)
        .map(|episode| MissionDraws::of_episode(&PAPER, SEED, episode).unwrap())
        .collect();
    let begin = std::time::Instant::now();
    let (mut plans, mut epochs) = (0, 0);
    for draws in &draws {
        let outcome = ideal(&PAPER, draws, &[]);
        plans += outcome.tally.plans;
        epochs += outcome.tally.coverage.len();
    }
    let mission_ms = begin.elapsed().as_secs_f64() * 1e3 / draws.len() as f64;
    println!(
        "{mission_ms:.1} ms per mission of {} epochs and {} plans",
        epochs / 30,
        plans / 30
    );
    // Ten times what a slow machine takes with the optimizations of a release.
    assert!(cfg!(debug_assertions) || mission_ms < 500.0);
}
