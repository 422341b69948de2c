//! `--set`: the campaign that is simulated, what its run remembers, and what is said of settings that cannot be.

use super::Place;
use serde_json::Value;
use urts_mc::results::files::RUN_TABLES;

const SET: [&str; 6] = [
    "--set",
    "fault.0.probability=1.0",
    "--set",
    "fault.0.onset_s=",
    "--set",
    "name=struck",
];

fn with(arguments: &[&'static str]) -> Vec<&'static str> {
    [arguments, &SET[..]].concat()
}

/// The campaign as an editor would make it.
fn edited() -> String {
    super::smoke(&[
        ("probability = 0.25", "probability = 1.0"),
        ("onset_s = { uniform = [2.5, 4.0] }\n", ""),
        ("name = \"smoke\"", "name = \"struck\""),
    ])
}

#[test]
fn a_run_with_settings_is_that_of_the_edited_file_and_remembers_them() {
    let place = Place::smoke(&[]);
    place.succeeds(&with(&["run", "c.toml", "--out", "set", "--csv"]));
    place.write("edited.toml", edited());
    place.succeeds(&["run", "edited.toml", "--out", "edited", "--csv"]);
    place.succeeds(&["run", "c.toml", "--out", "plain", "--csv"]);
    // A Parquet file says from which campaign it is, and they are two.
    let bytes = |run: &str, table: &str| place.read_bytes(&format!("{run}/{table}.csv"));
    // Without strata nothing is screened.
    for table in RUN_TABLES.iter().filter(|table| table.name != "screening") {
        let name = table.name;
        assert!(bytes("set", name) == bytes("edited", name), "{name}");
    }
    assert!(bytes("set", "episodes") != bytes("plain", "episodes"));

    let manifest = |run: &str| -> Value {
        serde_json::from_str(&place.read(&format!("{run}/manifest.json"))).unwrap()
    };
    let (set, plain) = (manifest("set"), manifest("plain"));
    assert_eq!(set["name"], "struck");
    assert_eq!(set["overlay"], serde_json::json!([SET[1], SET[3], SET[5]]));
    assert_eq!(set["campaign"], plain["campaign"]);
    // Without settings there is nothing to tell, and the hash is that of the text.
    assert!(plain.as_object().unwrap().get("overlay").is_none());
    let hash = blake3::hash(place.read("c.toml").as_bytes()).to_hex();
    assert_eq!(plain["campaign_blake3"], hash.as_str());
    assert!(set["campaign_blake3"] != plain["campaign_blake3"]);
    assert!(set["campaign_blake3"] != manifest("edited")["campaign_blake3"]);

    // The settings are shown as they were typed.
    place.succeeds(&["report", "set", "--full"]);
    let report = place.read("set/report.md");
    for setting in [SET[1], SET[3], SET[5]] {
        assert!(report.contains(&format!("--set {setting}")), "{setting}");
    }
    assert!(report.contains("BLAKE3 of its text and settings"));
    assert!(!place.read("plain/report.md").contains("--set"));
}

#[test]
fn the_report_and_the_replay_of_a_run_with_settings_need_its_directory_alone() {
    let place = Place::smoke(&[]);
    place.succeeds(&with(&["run", "c.toml", "--out", "out", "--seed", "5"]));
    let before = [place.read("out/report.html"), place.read("out/report.md")];
    std::fs::remove_file(place.path("c.toml")).unwrap();
    place.succeeds(&["report", "out"]);
    let again = [place.read("out/report.html"), place.read("out/report.md")];
    assert!(before == again);
    // The replay is that of the edited file.
    place.write("edited.toml", edited());
    place.succeeds(&["run", "edited.toml", "--out", "edited", "--seed", "5"]);
    let agents = |run: &'static str| {
        place.json(&["replay", run, "--episode", "2", "--json"])["agents"].clone()
    };
    assert!(!agents("out").is_null() && agents("out") == agents("edited"));
    place.write("out/manifest.json", {
        let manifest = place.read("out/manifest.json");
        assert!(manifest.contains(SET[1]));
        manifest.replace(SET[1], "fault.0.probability=2.0")
    });
    place.refuses(
        &["report", "out"],
        2,
        &["out/manifest.json: is not the file that the run wrote (the campaign in it was changed)"],
    );
}

#[test]
fn a_directory_belongs_to_a_campaign_with_its_settings() {
    let place = Place::smoke(&[]);
    let run = ["run", "c.toml", "--out", "out"];
    place.succeeds(&with(&run));
    place.succeeds(&with(&run));
    for other in [&[][..], &SET[..4], &["--set", "seed=2026"]] {
        place.refuses(
            &[&run[..], other].concat(),
            2,
            &[
                "error: out: ",
                "a run of this campaign with other settings (\"struck\")",
            ],
        );
    }
}

#[test]
fn episodes_and_seed_have_the_last_word() {
    let place = Place::smoke(&[]);
    let set = ["--set", "episodes=2", "--set", "seed=9"];
    let plan = |more: &[&str]| {
        let plan = place.json(&[&["check", "c.toml", "--json"], &set[..], more].concat());
        (plan["episodes"].clone(), plan["seed"].clone())
    };
    assert_eq!(plan(&[]), (2.into(), 9.into()));
    assert_eq!(
        plan(&["--episodes", "4", "--seed", "8"]),
        (4.into(), 8.into())
    );
}

#[test]
fn gains_are_those_of_the_settings() {
    let place = Place::smoke(&[]);
    let gains =
        |more: &[&str]| place.succeeds(&[&["synthesize", "c.toml", "--json"], more].concat());
    let other = gains(&["--set", "synthesis.position.rho=40.0"]);
    assert!(other != gains(&[]));
    assert!(other == gains(&["--set", "synthesis.position={ rho = 40.0 }"]));
    place.refuses(
        &["synthesize", "--preset", "uav-paper", "--set", "seed=3"],
        2,
        &["--set"],
    );
}

#[test]
fn settings_that_cannot_be_are_refused_before_anything_is_written() {
    let place = Place::smoke(&[]);
    for command in [
        &["run", "c.toml", "--out", "out"][..],
        &["check", "c.toml"],
        &["synthesize", "c.toml"],
    ] {
        for (setting, words) in [
            (
                "agent.team",
                &["'agent.team'", "'--set <KEY=VALUE>'", "write key=value"][..],
            ),
            (
                "agent.mass_kg=2 kg",
                &[
                    "'agent.mass_kg=2 kg'",
                    "is not a TOML value",
                    "write a number",
                ],
            ),
            (
                "agent.teem=3",
                &[
                    "error: c.toml: --set agent.teem=3: ",
                    "did you mean `team`?",
                ],
            ),
            (
                "fault.7.onset_s=0",
                &[
                    "error: c.toml: --set fault.7.onset_s=0: ",
                    "fault.0 to fault.1",
                ],
            ),
            (
                "fault.0.magnitude=4",
                &[
                    "fault[0].magnitude (--set fault.0.magnitude=4) = 4.0",
                    "[0, 1]",
                ],
            ),
        ] {
            place.refuses(&[command, &["--set", setting]].concat(), 2, words);
        }
    }
}
