//! What a good campaign gives: plans, gains, findings, verdicts and replays.

use super::{Place, smoke};
use crate::common::shipped_campaigns;
use serde_json::Value;
use std::fs;

#[test]
fn check_shows_what_would_be_drawn_and_simulates_and_writes_nothing() {
    let place = Place::smoke(&[]);
    let before = place.everything();
    // So many episodes would take an hour.
    let many = ["--episodes", "2000000"];
    let text = place.succeeds(&[&["check", "c.toml"], &many as &[&str]].concat());
    for word in [
        "2000000 episodes of 3 UAVs",
        "large tables: about ",
        " of one core in detail \"episodes\", ",
        "memory for the statistics:",
        "ftc, pid, pid-tuned",
        "certified rho",
        "mass_scale",
        "fault[0] actuator loss-of-effectiveness, in ",
        " minutes on one core",
    ] {
        assert!(text.contains(word), "{word:?} is missing from: {text}");
    }
    let plan = place.json(&[&["check", "c.toml", "--json"], &many as &[&str]].concat());
    assert_eq!(plan["episodes"], 2_000_000);
    let sizes = &plan["large_tables_bytes"];
    assert_eq!(
        (&plan["detail"], &sizes["summary"]),
        (&"all".into(), &0.into())
    );
    assert!(sizes["episodes"].as_u64() < sizes["all"].as_u64());
    let times = &plan["large_tables_s"];
    assert_eq!(times["summary"], 0.0);
    assert!(times["episodes"].as_f64() < times["all"].as_f64());
    // More than any machine holds is refused, before anything else.
    let refused = place.program(&["check", "c.toml", "--episodes", "4000000000"]);
    assert_eq!(refused.code, 2);
    assert!(
        refused.stderr.contains("--episodes = 4000000000: "),
        "{}",
        refused.stderr
    );
    let range = |name: &str| {
        let drawn = plan["drawn"].as_array().unwrap().iter();
        let found = drawn.clone().find(|row| row["name"] == name).unwrap();
        (
            found["lowest"].as_f64().unwrap(),
            found["highest"].as_f64().unwrap(),
        )
    };
    let (low, high) = range("fault[0] actuator loss-of-effectiveness magnitude");
    // Uniform on [0.1, 0.5], some 150 draws: both ends are within 0.05 but for odds of 1e-8.
    assert!((0.1..0.15).contains(&low) && (0.45..0.5).contains(&high));
    assert_eq!(range("kappa"), (0.0, 1.0));
    assert!(place.everything() == before);
}

#[test]
fn synthesize_shows_gains_poles_margins_and_certificate() {
    let place = Place::smoke(&[]);
    let before = place.everything();
    let text = place.succeeds(&["synthesize", "c.toml"]);
    for word in [
        "c.toml: preset uav-paper",
        "K  -",
        "poles of A + B K",
        "poles of A + L C",
        "margins  Ms",
        "certified attenuation rho",
        "check  ok",
    ] {
        assert!(text.contains(word), "{word:?} is missing from: {text}");
    }
    assert!(!text.contains("FAILED"), "{text}");
    let gains = place.json(&["synthesize", "c.toml", "--json"]);
    let ftc = &gains["controllers"]["ftc"];
    let rho = &ftc["findings"]["position"]["certificate"]["rho"];
    assert!((1.0..30.0).contains(&rho.as_f64().unwrap()));
    let k: Vec<f64> = serde_json::from_value(ftc["position"]["k"].clone()).unwrap();
    assert!(
        text.contains(&format!("K  {:.5}  {:.5}", k[0], k[1])),
        "{text}"
    );
    assert!(place.everything() == before);
}

#[test]
fn findings_as_json_are_those_of_the_text_and_of_the_tables() {
    let place = Place::smoke(&[]);
    let found = place.json(&["run", "c.toml", "--out", "a", "--json", "--csv"]);
    let text = place.succeeds(&["run", "c.toml", "--out", "b"]);
    assert_eq!(found["manifest"]["episodes"], 3);
    assert_eq!(found["requirements"].as_array().unwrap().len(), 0);
    let rates = found["failures"].as_array().unwrap();
    for controller in ["ftc", "pid", "pid-tuned"] {
        let all = |rate: &&Value| rate["controller"] == controller && rate["stratum"] == "all";
        let rate = rates.iter().find(all).unwrap();
        let line = text.lines().find(|line| {
            line.split_whitespace().next() == Some(controller) && line.contains(" of 3 ")
        });
        let shown = format!(" {} of 3 ", rate["failed"]);
        assert!(
            line.unwrap().contains(&shown),
            "{shown:?} is missing from: {text}"
        );
        let rows = place.rows("a/episodes.csv");
        let failed = |row: &&std::collections::BTreeMap<String, String>| {
            row["controller"] == controller && row["agent"] == "0" && row["episode_status"] != "ok"
        };
        assert_eq!(rate["failed"], rows.iter().filter(failed).count());
    }
    assert!(
        rates.iter().any(|rate| rate["failed"] != 0),
        "nothing fails here"
    );
}

#[test]
fn a_screening_says_which_fault_hurts_which_controller_most() {
    let place = Place::smoke(&[
        ("episodes = 3", "episodes = 4"),
        (
            "[verdict]",
            "[[strata]]\nfaults = \"each\"\n[[strata]]\nfaults = []\n[[strata]]\nfaults = \"all\"\n[verdict]",
        ),
    ]);
    let arguments = [
        "run",
        "c.toml",
        "--episodes",
        "64",
        "--overwrite",
        "--verbose",
        "--out",
        "out",
    ];
    let text = place.succeeds(&arguments);
    for word in [
        "failure rates by stratum",
        "\n  none ",
        "\n  mixed ",
        "which stratum hurts most, change [95 %]",
        "  ftc fails with none of the faults (at least 16 episodes each)",
        "  pid fails most often with \"sensor smoothed-square\": ",
        "  pid: RMS error, position, grows most with \"sensor smoothed-square\": ",
    ] {
        assert!(text.contains(word), "{word:?} is missing from: {text}");
    }
    let found = place.json(&[&arguments as &[&str], &["--json"]].concat());
    let pid = &found["screening"][1];
    assert_eq!(
        (&pid["controller"], &pid["reference"]),
        (&"pid".into(), &"none".into())
    );
    let square = &pid["strata"][1];
    assert_eq!(square["may_fail_most"], true);
    // The words show the numbers of the statistics.
    let more = &square["failure_rate_difference"];
    let percent = |value: &Value| format!("{:+.1}", 100.0 * value.as_f64().unwrap());
    let (value, ends) = (percent(&more["value"]), &more["interval_95"]);
    let shown = format!(
        "{value} points [{}, {}]",
        percent(&ends[0]),
        percent(&ends[1])
    );
    assert!(text.contains(&shown), "{shown:?} is missing from: {text}");
    let row = &place.rows("out/screening.csv")[3];
    assert_eq!(
        (&*row["controller"], &*row["stratum"]),
        ("pid", "sensor smoothed-square")
    );
    assert_eq!(place.rows("out/comparison.csv").len(), 3 * 5 * 8);
}

#[test]
fn a_design_and_an_early_stop_are_told_in_a_sentence() {
    let place = Place::smoke(&[
        ("[verdict]", "[sampling]\ndesign = \"sobol\"\n[verdict]"),
        ("episodes = 3", "episodes = 16"),
    ]);
    let text = place.succeeds(&["run", "c.toml", "--out", "out", "--verbose"]);
    for word in [
        "design: 8 scrambled Sobol nets of 2 episodes, which are not independent",
        "the intervals here are Student's t over the 8 replicates",
        "median [t over replicates 95 %]",
    ] {
        assert!(text.contains(word), "{word:?} is missing from: {text}");
    }
    assert!(
        !text.contains("McNemar") && !text.contains("Wilson") && !text.contains("what matters"),
        "{text}"
    );
    let stop = "[stop]\ncontroller = \"pid\"\nevery = 4\nfailure_rate_above = 0.1\n[verdict]";
    let place = Place::smoke(&[("[verdict]", stop), ("episodes = 3", "episodes = 100")]);
    assert!(
        place
            .succeeds(&["check", "c.toml"])
            .contains("stops early once it is 95 % sure that the failure rate of pid is above 0.1")
    );
    let text = place.succeeds(&["run", "c.toml", "--out", "out"]);
    for word in [
        "of 100 episodes, as failure_rate_above = 0.1 is reached",
        "the failure rate of pid is above ",
        "sequential 95 %",
    ] {
        assert!(text.contains(word), "{word:?} is missing from: {text}");
    }
}

#[test]
fn a_requirement_that_does_not_hold_exits_with_4_after_writing_everything() {
    let with = |controller: &str, limit: &str| {
        let text = format!(
            "[[require]]\ncontroller = \"{controller}\"\nfailure_rate_upper_95 = {limit}\n[verdict]"
        );
        smoke(&[("[verdict]", &text)])
    };
    let place = Place::with(&with("ftc", "0.02"));
    for json in [false, true] {
        let more: &[&str] = if json { &["--json"] } else { &[] };
        let ended = place.program(&[&["run", "c.toml", "--out", "out"], more].concat());
        assert_eq!(ended.code, 4);
        let said = ended.stderr;
        // 0.98^149 < 0.05 < 0.98^148: so many episodes without failure show a rate below 0.02.
        for word in [
            "error: c.toml: require[0].failure_rate_upper_95 = 0.02: ",
            "\"ftc\" failed in 0 of 3 episodes",
            "below 0.6316",
            "simulate at least 149 episodes",
        ] {
            assert!(said.contains(word), "{word:?} is missing from: {said}");
        }
        if json {
            let found: Value = serde_json::from_str(&ended.stdout).unwrap();
            let result = &found["requirements"][0];
            assert_eq!(
                (&result["limit"], &result["met"]),
                (&0.02.into(), &false.into())
            );
        } else {
            assert!(ended.stdout.contains("written to out"));
        }
        assert_eq!(place.rows("out/summary.csv")[0]["controller"], "ftc");
        assert!(place.path("out/manifest.json").is_file());
    }
    // More episodes do not help where the controller fails; a limit that holds does.
    let place = Place::with(&with("pid", "0.5"));
    let ended = place.program(&["run", "c.toml", "--out", "out"]);
    assert_eq!(ended.code, 4);
    assert!(
        ended.stderr.contains("\"pid\" failed in 3 of 3 episodes"),
        "{}",
        ended.stderr
    );
    assert!(
        ended.stderr.contains("change the controller or the limit"),
        "{}",
        ended.stderr
    );
    Place::with(&with("ftc", "0.64")).succeeds(&["run", "c.toml", "--out", "out"]);
}

#[test]
fn a_diverging_episode_is_a_row_with_a_verdict_and_no_nan() {
    let absurd_coupling = [("{ choice = [0.0, 1.0] }", "{ choice = [0.0, 1e6] }")];
    let no_actuators = [
        ("probability = 0.25", "probability = 1.0"),
        ("channels = \"one\"", "channels = \"all\""),
        ("magnitude = { uniform = [0.1, 0.5] }", "magnitude = 1.0"),
    ];
    for changes in [&absurd_coupling as &[_], &no_actuators] {
        for precision in ["f32", "f64"] {
            let place = Place::smoke(changes);
            let text = place.succeeds(&[
                "run",
                "c.toml",
                "--out",
                "out",
                "--csv",
                "--episodes",
                "8",
                "--precision",
                precision,
            ]);
            assert!(text.contains(" diverged)"), "{text}");
            let files = ["summary", "comparison", "episodes", "channels"];
            let tables = files.map(|name| place.read(&format!("out/{name}.csv")));
            for all in tables.iter().chain([&text]) {
                assert!(!all.to_lowercase().contains("nan"), "a NaN in: {all}");
            }
            let rows = place.rows("out/episodes.csv");
            assert_eq!(rows.len(), 8 * 3 * 3, "a row is missing");
            let (diverged, finite): (Vec<_>, Vec<_>) =
                rows.iter().partition(|row| row["status"] == "diverged");
            // Both kinds occur, so that a campaign of which nothing is left is not all that is tested.
            assert!(
                !diverged.is_empty() && !finite.is_empty(),
                "{}",
                diverged.len()
            );
            for row in diverged {
                let failed_at_s: f64 = row["failed_at_s"].parse().unwrap();
                assert!((0.0..=6.0).contains(&failed_at_s));
                assert_eq!(row["rmse_position"], "");
                assert_eq!(row["episode_status"], "diverged");
            }
            for row in finite {
                assert!(row["rmse_position"].parse::<f64>().unwrap().is_finite());
            }
            // A diverged episode counts as infinitely bad: no statistic is left out for it.
            for (table, statistics) in [
                ("summary", ["failure_rate", "q50", "q95"]),
                ("comparison", ["log_ratio", "win_rate", "mcnemar_mid_p"]),
            ] {
                for row in place.rows(&format!("out/{table}.csv")) {
                    for name in statistics {
                        let value = row[name].parse::<f64>();
                        assert!(
                            value.is_ok() || row.get("n") == Some(&"0.0".into()),
                            "{name}: {row:?}"
                        );
                    }
                }
            }
            let counted: f64 = place.rows("out/summary.csv")[0]["diverged"]
                .parse()
                .unwrap();
            let first = rows.iter().filter(|row| {
                row["controller"] == "ftc"
                    && row["agent"] == "0"
                    && row["episode_status"] == "diverged"
            });
            assert_eq!(counted as usize, first.count());
        }
    }
}

#[test]
fn a_replay_writes_its_trajectories_and_shows_the_numbers_of_the_run() {
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--out", "out", "--csv"]);
    let text = place.succeeds(&["replay", "out", "--episode", "2", "--controller", "pid"]);
    let rows = place.rows("out/channels.csv");
    let row = rows
        .iter()
        .find(|row| row["episode"] == "2" && row["controller"] == "pid" && row["channel"] == "x");
    let rmse: f64 = row.unwrap()["rmse"].parse().unwrap();
    let shown = text
        .lines()
        .find(|line| line.starts_with("  x, m "))
        .unwrap();
    assert!(
        (0.1..1.0).contains(&rmse) && shown.contains(&format!("{rmse:.4}")),
        "{rmse} is missing from: {shown}"
    );
    let written = fs::read(place.path("out/replay-2-pid.parquet")).unwrap();
    assert!(written.starts_with(b"PAR1") && written.ends_with(b"PAR1"));
}

#[test]
fn a_replay_shows_the_attenuation_of_each_channel_or_says_why_there_is_none() {
    let place = Place::smoke(&[("probability = 0.25", "probability = 1.0")]);
    place.succeeds(&["run", "c.toml", "--out", "out"]);
    let replay = |controller| {
        place.succeeds(&[
            "replay",
            "out",
            "--episode",
            "1",
            "--controller",
            controller,
        ])
    };
    let ftc = replay("ftc");
    assert!(
        ftc.contains("attenuation  certified  (24) with V(0)"),
        "{ftc}"
    );
    // One channel of each of the three UAVs loses effectiveness on the way.
    assert_eq!(ftc.matches("  holds\n").count(), 15, "{ftc}");
    assert_eq!(ftc.matches("  not applicable\n").count(), 3, "{ftc}");
    let why = "(24) is not applicable to 3 of 18 channels: fault 0 (loss-of-effectiveness)";
    assert!(ftc.contains(why), "{ftc}");
    let pid = replay("pid");
    assert!(
        pid.contains("(24) is not applicable to 18 of 18 channels"),
        "{pid}"
    );
    assert!(pid.contains("does not estimate the faults"), "{pid}");

    // A run of an older version, which knew nothing of its files.
    let mut older: serde_json::Value =
        serde_json::from_str(&place.read("out/manifest.json")).unwrap();
    older.as_object_mut().unwrap().remove("files");
    older.as_object_mut().unwrap().remove("blake3");
    place.write("out/manifest.json", older.to_string());
    // One that kept no findings is replayed all the same; a certificate that was changed is none.
    let gains = place.read("out/gains.json");
    let mut file: serde_json::Value = serde_json::from_str(&gains).unwrap();
    let findings = &mut file["controllers"]["ftc"]["findings"];
    let certificate = &mut findings["position"]["certificate"];
    certificate["rho"] = serde_json::json!(certificate["rho"].as_f64().unwrap() / 2.0);
    place.write("out/gains.json", file.to_string());
    let said = replay("ftc");
    assert!(said.contains("does not belong to these gains"), "{said}");
    assert!(said.contains("  holds\n"), "{said}");
    file["controllers"]["ftc"]
        .as_object_mut()
        .unwrap()
        .remove("findings");
    place.write("out/gains.json", file.to_string());
    let said = replay("ftc");
    assert!(
        said.contains("18 of 18 channels: gains.json holds no certificate"),
        "{said}"
    );
}

#[test]
fn a_cross_check_records_the_largest_attenuation_of_each_channel_group() {
    let place = Place::smoke(&[]);
    let run = ["run", "c.toml", "--out", "out", "--cross-check", "2"];
    let said = place.succeeds(&run);
    let manifest: serde_json::Value =
        serde_json::from_str(&place.read("out/manifest.json")).unwrap();
    let rows = manifest["cross_check"]["attenuation"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for (row, group) in rows.iter().zip(["position", "attitude"]) {
        assert_eq!(
            (&row["controller"], &row["group"]),
            (&"ftc".into(), &group.into())
        );
        assert_eq!((&row["flown"], &row["violated"]), (&18.into(), &0.into()));
        assert!((1..=18).contains(&row["applicable"].as_u64().unwrap()));
        let [largest, certified] = ["largest", "certified"].map(|key| row[key].as_f64().unwrap());
        assert!(0.0 < largest && largest < certified, "{row}");
        let line = format!("attenuation of {group} under ftc: at most {largest:.4}");
        assert!(said.contains(&line), "{line} is missing from: {said}");
    }
    // The manifest of a run that knew nothing of it.
    let mut older = manifest;
    older.as_object_mut().unwrap().remove("blake3");
    older["cross_check"]
        .as_object_mut()
        .unwrap()
        .remove("attenuation");
    place.write("out/manifest.json", older.to_string());
    place.succeeds(&["replay", "out", "--episode", "0"]);
}

#[test]
fn the_schema_knows_every_key_of_every_shipped_campaign() {
    fn all_keys(value: &toml::Value, keys: &mut Vec<String>) {
        match value {
            toml::Value::Table(table) => {
                for (key, value) in table {
                    keys.push(key.clone());
                    all_keys(value, keys);
                }
            }
            toml::Value::Array(list) => list.iter().for_each(|value| all_keys(value, keys)),
            _ => {}
        }
    }
    let place = Place::smoke(&[]);
    let schema = place.json(&["schema"]);
    assert_eq!(schema["additionalProperties"], false);
    for key in [
        "name", "seed", "episodes", "time", "agent", "fault", "require",
    ] {
        assert!(
            schema["properties"][key]["description"].is_string(),
            "{key}"
        );
    }
    let text = schema.to_string();
    let mut keys = Vec::new();
    for path in shipped_campaigns() {
        let campaign = fs::read_to_string(path).unwrap();
        all_keys(&toml::from_str(&campaign).unwrap(), &mut keys);
    }
    assert!(keys.len() > 100);
    for key in keys {
        assert!(
            text.contains(&format!("\"{key}\":{{")),
            "{key} is not in the schema"
        );
    }
}

#[test]
fn a_report_of_two_hundred_controllers_can_be_opened() {
    let place = super::parts::place();
    place.succeeds(&["run", "c.toml", "--out", "out"]);
    let names: Vec<String> = (0..199).map(|number| format!("p{number}")).collect();
    let listed: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    let named = names.iter().map(|name| {
        format!("named.{name} = {{ gains = \"out/gains.json\", controller = \"pid\" }}\n")
    });
    let controllers = format!("controllers = [\"ftc\", {}]", listed.join(", "));
    let preset = "preset = \"uav-paper\"\n";
    let text = place.read("c.toml");
    let text = text.replace("controllers = [\"ftc\", \"pid\"]", &controllers);
    let text = text.replace(preset, &format!("{preset}{}", named.collect::<String>()));
    place.write("c.toml", text);
    place.succeeds(&["run", "c.toml", "--out", "many", "--episodes", "40"]);
    let report = place.read("many/report.html");
    assert!(report.len() <= 3_000_000, "{} bytes", report.len());
    assert!(report.contains("Drawn are the first 12 controllers"));
    assert!(report.contains("ftc against p198") && !report.contains("p197 against p198"));
    // Of few, nothing is left out.
    let report = place.read("out/report.html");
    assert!(!report.contains("Drawn are the first"));
}
