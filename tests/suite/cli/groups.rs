//! `[[group]]`: several kinds of agents in one campaign, from the file to the pictures.

use super::Place;
use crate::common::repository;
use serde_json::Value;
use std::fs;
use urts_mc::results::files::RUN_TABLES;

/// Few and short episodes.
const SHORT: [&str; 10] = [
    "--set",
    "time.duration_s=0.8",
    "--set",
    "time.settle_s=0.1",
    "--set",
    "group.0.fault.0.onset_s=0.3",
    "--set",
    "group.1.fault.0.onset_s=0.3",
    "--episodes",
    "12",
];

fn mixed() -> Place {
    let text = fs::read_to_string(repository("campaigns/mixed-teams.toml")).unwrap();
    Place::with(&text)
}

/// Runs the program, which may say that a walk of eight seconds is not over.
fn succeeds(place: &Place, arguments: &[&str]) -> String {
    let ended = place.program(arguments);
    let said = ended
        .stderr
        .lines()
        .filter(|line| !line.ends_with("its end is not reached"));
    assert_eq!((ended.code, said.count()), (0, 0), "{}", ended.stderr);
    ended.stdout
}

fn with<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [arguments, &SHORT[..]].concat()
}

#[test]
fn a_campaign_of_uavs_and_robots_runs_and_reports_on_both() {
    let place = mixed();
    let ran = succeeds(&place, &with(&["run", "c.toml", "--out", "out", "--csv"]));
    for said in [
        "\n    robots    ",
        "12 episodes x 3 UAVs (uavs) and 4 robots (robots), seed 2026",
        "an episode fails with any of its agents",
        "uavs position, m",
        "robots joints, rad",
    ] {
        assert!(ran.contains(said), "{said:?} is not in\n{}", ran);
    }
    let episodes = place.read("out/episodes.csv");
    let rows: Vec<Vec<&str>> = episodes
        .lines()
        .map(|line| line.split(',').collect())
        .collect();
    let head = &rows[0];
    assert_eq!(head[..4], ["episode", "controller", "group", "agent"]);
    assert_eq!(rows.len(), 1 + 12 * 3 * 7);
    let column = |name: &str| head.iter().position(|own| *own == name).unwrap();
    // Under the FTC nothing diverges, which would leave metrics empty.
    for row in rows.iter().filter(|row| row[1] == "ftc") {
        let agent: usize = row[3].parse().unwrap();
        let robot = row[2] == "robots";
        assert_eq!(robot, agent >= 3, "{row:?}");
        assert_eq!(row[column("rmse_joints")].is_empty(), !robot);
        assert_eq!(row[column("rmse_position")].is_empty(), robot);
        assert_eq!(row[column("fault0_occurs")].is_empty(), robot);
        assert_eq!(row[column("fault3_occurs")].is_empty(), !robot);
        assert_eq!(row[column("inertia_scale")].is_empty(), robot);
        assert!(!row[column("mass_scale")].is_empty());
    }
    place.succeeds(&["report", "out", "--full"]);
    let report = place.read("out/report.md");
    for said in [
        "12 episodes of 3 UAVs (uavs) and 4 robots (robots) over 0.8 s",
        "any of its agents diverges",
        "| ftc, uavs alone |",
        "robots joints",
        "uavs attitude",
        "robots mass\\_scale",
        "uavs actuator loss-of-effectiveness",
    ] {
        assert!(report.contains(said), "{said:?} is not in\n{report}");
    }
    let manifest: Value = serde_json::from_str(&place.read("out/manifest.json")).unwrap();
    assert!(manifest["robot"].is_null());
    let robot = manifest["robots"]["robots"].as_str().unwrap();
    let table = fs::read_to_string(repository("campaigns/robots/g1_12dof.toml")).unwrap();
    assert_eq!(robot, table);

    // The directory is enough for the report and for a replay, with every agent of both groups in them.
    fs::remove_file(place.path("c.toml")).unwrap();
    let before = place.read("out/report.html");
    succeeds(&place, &["report", "out"]);
    assert!(before == place.read("out/report.html"));
    let replay = succeeds(
        &place,
        &[
            "replay",
            "out",
            "--episode",
            "3",
            "--controller",
            "ftc",
            "--json",
        ],
    );
    let replay: Value = serde_json::from_str(&replay).unwrap();
    let agents = replay["agents"].as_array().unwrap();
    assert_eq!(agents.len(), 7);
    for (agent, found) in agents.iter().enumerate() {
        let channels = found["channels"].as_array().unwrap();
        assert_eq!(channels.len(), if agent < 3 { 6 } else { 12 });
        let rmse: Vec<f64> = channels
            .iter()
            .map(|own| own["rmse"].as_f64().unwrap())
            .collect();
        // As in the run's row.
        let mut rows = rows[1..].iter();
        let of_agent =
            |row: &&Vec<&str>| row[0] == "3" && row[1] == "ftc" && row[3] == agent.to_string();
        let row = rows.find(of_agent).unwrap();
        let (name, of) = if agent < 3 {
            ("rmse_position", 0..3)
        } else {
            ("rmse_joints", 0..12)
        };
        let square = rmse[of.clone()].iter().map(|own| own * own).sum::<f64>() / of.len() as f64;
        let kept: f64 = row[column(name)].parse().unwrap();
        assert!((square.sqrt() - kept).abs() < 1e-12, "agent {agent}");
    }
    let page = place.read("out/replay-3-ftc.html");
    for said in ["Uavs paths", "Robots walk", "Agent 6"] {
        assert!(page.contains(said), "{said}");
    }
}

#[test]
fn a_run_of_groups_is_the_same_for_any_number_of_threads_and_begins_as_a_shorter_one() {
    let place = mixed();
    for (out, more) in [("one", ["--threads", "1"]), ("two", ["--threads", "2"])] {
        succeeds(
            &place,
            &[&with(&["run", "c.toml", "--out", out])[..], &more].concat(),
        );
    }
    for table in RUN_TABLES.iter().filter(|table| table.name != "screening") {
        let table = table.name;
        let bytes = |run: &str| place.read_bytes(&format!("{run}/{table}.parquet"));
        assert!(bytes("one") == bytes("two"), "{table}");
    }
    let mut shorter = with(&["run", "c.toml", "--out", "short", "--csv"]);
    shorter.pop();
    shorter.push("5");
    succeeds(&place, &shorter);
    succeeds(&place, &with(&["run", "c.toml", "--out", "long", "--csv"]));
    let (short, long) = (
        place.read("short/episodes.csv"),
        place.read("long/episodes.csv"),
    );
    assert!(long.starts_with(&short) && long.len() > short.len());
}

#[test]
fn check_and_synthesize_tell_of_every_group() {
    let place = mixed();
    let plan = succeeds(&place, &with(&["check", "c.toml"]));
    for said in [
        "12 episodes of 3 UAVs (uavs) and 4 robots (robots) over 0.8 s",
        "gains of ftc on uavs position: synthesized, certified rho",
        "gains of pid on robots joints: synthesized",
        "group[0].disturbance[0] sine",
        "group[1].fault[1] sensor smoothed-square",
    ] {
        assert!(plan.contains(said), "{said:?} is not in\n{plan}");
    }
    let json = succeeds(&place, &with(&["check", "c.toml", "--json"]));
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["team"], 7);
    assert_eq!(json["groups"][1]["name"], "robots");
    let gains = succeeds(&place, &["synthesize", "c.toml"]);
    assert!(gains.contains("uavs preset uav-paper") && gains.contains("robots preset biped-paper"));
    // What a run writes is read again, each group its own gains.
    let written = succeeds(&place, &["synthesize", "c.toml", "--json"]);
    place.write("gains.json", &written);
    let named = [
        "--set",
        "group.0.synthesis.gains=gains.json",
        "--set",
        "group.1.synthesis.gains=gains.json",
    ];
    succeeds(&place, &with(&["run", "c.toml", "--out", "own", "--csv"]));
    succeeds(
        &place,
        &[
            &with(&["run", "c.toml", "--out", "named", "--csv"])[..],
            &named,
        ]
        .concat(),
    );
    assert!(place.read_bytes("own/channels.csv") == place.read_bytes("named/channels.csv"));
}

#[test]
fn a_wrong_group_is_refused_by_its_key() {
    let place = mixed();
    let cases = [
        (
            "group.1.name=uavs",
            "group[1].name (--set group.1.name=uavs) = \"uavs\": another group has this name; rename one of them",
        ),
        ("group.1.name=", "missing key or table `name`; add it"),
        ("group.0.name=a b", "a b"),
        (
            "agent.kind=uav",
            "agent (--set agent.kind=uav) = given: in a file with [[group]] each group has this of its own; move it into the [[group]] that it is about",
        ),
        (
            "verdict.max_error=1.0",
            "verdict (--set verdict.max_error=1.0) = given",
        ),
        ("group.1.agent=", "missing key or table `agent`; add it"),
        (
            "group.0.fault.0.magnitude=2.0",
            "group[0].fault[0].magnitude (--set group.0.fault.0.magnitude=2.0) = 2.0: must lie within [0, 1]",
        ),
        (
            "group.1.disturbance.0.kind=dryden",
            "group[1].disturbance[0].kind",
        ),
        (
            "group.1.synthesis.gains=none.json",
            "group[1].synthesis.gains (--set group.1.synthesis.gains=none.json) = \"none.json\": no such file",
        ),
        ("group=", "missing key or table `agent`; add it"),
        (
            "controllers=[\"ftc\", \"mine\"]",
            "controllers[1] (--set controllers=[\"ftc\", \"mine\"]) = \"mine\": the controllers are ftc, ftc-tuned, pid, pid-placed, pid-tuned, pid-robust-observer",
        ),
        (
            "group.0.agnet.kind=uav",
            "unknown key `agnet`, expected one of",
        ),
        ("group.0.episodes=3", "unknown key `episodes`"),
    ];
    for (setting, said) in cases {
        let ended = place.program(&["check", "c.toml", "--set", setting]);
        assert_eq!(ended.code, 2, "{setting}: {}", ended.stderr);
        assert!(ended.stderr.contains(said), "{setting}: {}", ended.stderr);
        assert!(ended.stdout.is_empty(), "{setting}");
    }
    // A controller of one group alone is none of the campaign.
    let ended = place.program(&[
        "check",
        "c.toml",
        "--set",
        "group.0.synthesis.named.mine.gains=gains.json",
        "--set",
        "controllers=[\"mine\"]",
    ]);
    let said = "give every group a [group.synthesis.named.mine]";
    assert!(ended.stderr.contains(said), "{}", ended.stderr);
    // More agents than there are addresses for.
    let ended = place.program(&[
        "check",
        "c.toml",
        "--set",
        "group.0.agent.team=61",
        "--set",
        "group.0.reference.agents=",
    ]);
    let said = "group (line 14) = 65 agents: all groups together have at most 64 agents; make the teams smaller";
    assert!(ended.stderr.contains(said), "{}", ended.stderr);
}
