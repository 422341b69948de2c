//! What is said about a campaign before it is simulated.

use super::{Place, smoke};
use crate::common::{altered, campaign};
use urts_mc::campaign::Campaign;
use urts_mc::campaign::lints::cautions;
use urts_mc::reference::Reference;

/// The smoke campaign with so many episodes and a requirement on the FTC, and tables before it.
fn required(episodes: u32, limit: &str, more: &str) -> String {
    let table = format!(
        "[[require]]\ncontroller = \"ftc\"\nfailure_rate_upper_95 = {limit}\n{more}\n[verdict]"
    );
    smoke(&[
        ("episodes = 3", &format!("episodes = {episodes}")),
        ("[verdict]", &table),
    ])
}

fn said_of(text: &str) -> Vec<String> {
    cautions(&Campaign::parse(text, "c.toml".as_ref()).unwrap())
}

#[test]
fn a_requirement_that_so_few_episodes_cannot_prove_is_told_with_the_number_that_can() {
    let note = "require[0].failure_rate_upper_95 = 0.05: 40 episodes cannot prove it, even if \"ftc\" fails in none; simulate at least 59";
    let place = Place::with(&required(40, "0.05", ""));
    let said = place.succeeds(&["check", "c.toml"]);
    // Broken into lines of moderate length.
    let (_, last) = said.rsplit_once("\n\n").unwrap();
    let words: Vec<&str> = last.split_whitespace().collect();
    assert_eq!(words.join(" "), format!("note: {note}"));
    assert_eq!(place.json(&["check", "c.toml", "--json"])["notes"][0], note);
    // The run says it first, and is simulated all the same.
    let run = ["run", "c.toml", "--out", "out", "--episodes", "3"];
    let ended = place.program(&run);
    let note = format!("note: {}\n", note.replace("40", "3"));
    assert!(ended.stderr.starts_with(&note), "{}", ended.stderr);
    assert!(ended.stderr[note.len()..].starts_with("error: c.toml: require[0]"));
    assert_eq!(ended.code, 4);
    let quiet = place.program(&[&run as &[_], &["--quiet"]].concat());
    assert!(quiet.stderr.starts_with("error: "), "{}", quiet.stderr);
    place.succeeds(&["check", "c.toml", "--quiet", "--json"]);

    // 0.95^59 < 0.05 < 0.95^58.
    assert_eq!(said_of(&required(58, "0.05", "")).len(), 1);
    for (episodes, limit) in [(59, "0.05"), (3, "0.64"), (2, "0.78"), (3, "1.0")] {
        let said = said_of(&required(episodes, limit, ""));
        assert!(said.is_empty(), "{said:?}");
    }
    let said = said_of(&required(1, "0.78", ""));
    assert!(
        said[0].contains(" = 0.78: 1 episode cannot prove it"),
        "{said:?}"
    );
    let said = said_of(&required(4_000_000_000, "0.0", ""));
    assert!(
        said[0].ends_with("; no number of episodes does"),
        "{said:?}"
    );
}

#[test]
fn a_requirement_on_a_stratum_or_beside_a_stop_takes_more_episodes() {
    let stratum = "stratum = \"none\"\n[[strata]]\nfaults = \"each\"\n[[strata]]\nfaults = []";
    // Two faults and none, in turns: the 59th without is the 177th of all.
    let said = said_of(&required(176, "0.05", stratum));
    assert!(
        said[0].contains(": 58 episodes of the stratum \"none\" cannot prove it")
            && said[0].ends_with("; simulate at least 177 episodes, 59 of them there"),
        "{said:?}"
    );
    assert!(said_of(&required(177, "0.05", stratum)).is_empty());
    // Whoever looks again and again needs 449 instead of 299 (src/statistics/sequential.rs).
    let stop = "[stop]\ncontroller = \"ftc\"\nfailure_rate_below = 0.01";
    let said = said_of(&required(448, "0.01", stop));
    assert!(said[0].ends_with("; simulate at least 449"), "{said:?}");
    assert!(said_of(&required(449, "0.01", stop)).is_empty());
    assert!(said_of(&required(299, "0.01", "")).is_empty());
}

#[test]
fn a_walk_or_path_that_outlasts_the_episode_is_told_with_both_times() {
    let name = "biped-ground-reaction";
    let Reference::Walk(walks) = campaign(name).first_group().reference.clone() else {
        panic!("no walk");
    };
    let takes_s = walks[0].walk.duration_s();
    let lasting = |duration: &str, start: &str| {
        let duration = format!("time.duration_s={duration}");
        let start = format!("reference.start_s={start}");
        cautions(&altered(name, &[&duration, &start]))
    };
    let said = lasting("4.0", "0");
    let shown = (100.0 * takes_s).ceil() / 100.0;
    assert_eq!(
        said,
        [format!(
            "reference: the walk takes {shown} s, the episode 4 s; its end is not reached"
        )]
    );
    let enough = takes_s.ceil();
    assert!(lasting(&format!("{enough:?}"), "0").is_empty());
    // Standing after the last step is no way to go.
    assert!(takes_s > 8.0 && lasting("8.0", "0").is_empty());
    // It begins later, or has begun already.
    let late = lasting(&format!("{enough:?}"), "3.0");
    assert!(
        late[0].contains("the walk begins at 3 s and takes "),
        "{late:?}"
    );
    assert!(lasting("4.0", &format!("{:?}", 4.0 - enough)).is_empty());

    assert!(cautions(&campaign("waypoints")).is_empty());
    let said = cautions(&altered("waypoints", &["time.duration_s=10.0"]));
    assert!(
        said[0].starts_with("reference: the path of agent ")
            && said[0].ends_with(" s, the episode 10 s; its end is not reached"),
        "{said:?}"
    );
}

#[test]
fn a_fault_that_ends_before_it_has_come_is_told() {
    let with = |times: &str| {
        let magnitude = "magnitude = { uniform = [0.1, 0.5] }";
        said_of(&smoke(&[(magnitude, &format!("{magnitude}\n{times}"))]))
    };
    assert_eq!(
        with("ramp_s = 1.5\nduration_s = { uniform = [0.5, 1.0] }"),
        [
            "fault[0].ramp_s: actuator loss-of-effectiveness takes at least 1.5 s to come and stays at most 1 s; it never comes as a whole"
        ]
    );
    // Some of these come as a whole, and the others are meant.
    assert!(with("ramp_s = { uniform = [0.0, 1.0] }\nduration_s = 0.5").is_empty());
    assert!(with("ramp_s = 1.5").is_empty());
}

#[test]
fn a_fault_that_nobody_has_is_told() {
    let with = |probability: &str| said_of(&smoke(&[("probability = 0.25", probability)]));
    assert_eq!(
        with("probability = 0.0"),
        ["fault[0].probability = 0: nobody ever has actuator loss-of-effectiveness"]
    );
    let one = "probability = 0.0\nagents = [{}, { probability = 0.1 }, {}]";
    assert!(with(one).is_empty());
}

#[test]
fn check_sums_up_strata_and_tells_each_fault_with_its_target_in_one_place() {
    let place = Place::with(
        &std::fs::read_to_string(crate::common::repository("campaigns/uav-faults.toml")).unwrap(),
    );
    let said = place.succeeds(&["check", "c.toml"]);
    assert_eq!(said.matches("of every 40 episodes").count(), 3, "{said}");
    let one_line = said.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        "34 strata of 1 of every 40 episodes, in each one fault in every agent: actuator loss-of-effectiveness, actuator bias, ",
        "stratum \"none\": 2 of every 40 episodes, no fault",
        "stratum \"mixed\": 4 of every 40 episodes, all faults, each with its own probability",
    ] {
        assert!(
            one_line.contains(words),
            "{words:?} is missing from: {said}"
        );
    }
    let lines: Vec<&str> = said.lines().collect();
    let title = |start: &str| {
        lines
            .iter()
            .position(|line| line.starts_with(start))
            .unwrap()
    };
    let of = |title: usize| -> Vec<&str> {
        let own = lines[title + 1..]
            .iter()
            .take_while(|line| line.starts_with("    "));
        own.map(|line| line.split_whitespace().next().unwrap())
            .collect()
    };
    let stuck = title("  fault[3] actuator stuck, in ");
    assert!(lines[stuck].contains(" of 600 agents (") && lines[stuck].ends_with(" %)"));
    assert_eq!(of(stuck), ["onset_s", "duration_s"]);
    assert_eq!(
        of(title("  fault[10] sensor bias, in ")),
        ["onset_s", "magnitude"]
    );
    assert_eq!(
        of(title("  disturbance[0] sine")),
        ["amplitude", "frequency_rad_s", "phase_rad"]
    );
    assert!(
        lines.iter().all(|line| line.chars().count() <= 130),
        "{said}"
    );
    // The share of the agents that have it.
    let drawn = place.json(&["check", "c.toml", "--json"])["drawn"].clone();
    let rows = drawn.as_array().unwrap().iter();
    let occurs = rows
        .clone()
        .find(|row| row["name"] == "fault[3] actuator stuck occurs");
    let share = occurs.unwrap()["share"].as_f64().unwrap();
    assert!(lines[stuck].contains(&format!("({:.1} %)", 100.0 * share)));
}

#[test]
fn the_time_that_check_tells_is_right_within_a_factor_of_two() {
    // Measured on one core with 16 lanes.
    for (name, episodes, measured_s) in [
        ("uav-faults", 1000, 21.0),
        ("uav-paper", 1024, 4.1),
        ("biped-paper", 1024, 18.0),
        ("biped-faults", 1000, 24.6),
    ] {
        let text =
            std::fs::read_to_string(crate::common::repository(&format!("campaigns/{name}.toml")))
                .unwrap();
        let place = Place::with(&text);
        let arguments = [
            "check",
            "c.toml",
            "--episodes",
            &episodes.to_string(),
            "--set",
            "controllers=[\"ftc\", \"pid\", \"pid-robust-observer\", \"pid-placed\"]",
            "--json",
        ];
        let said = place.json(&arguments)["roughly_s"].as_f64().unwrap();
        assert!(
            (measured_s / 2.0..2.0 * measured_s).contains(&said),
            "{name}: {said}"
        );
    }
    // Long times in units that people know.
    let place = Place::smoke(&[]);
    for (episodes, duration_s, unit) in [
        ("3", "6.0", "s"),
        ("200000", "6.0", "minutes"),
        ("1000000", "60.0", "hours"),
        ("1000000", "1000.0", "days"),
    ] {
        let duration = format!("time.duration_s={duration_s}");
        let said = place.succeeds(&[
            "check",
            "c.toml",
            "--episodes",
            episodes,
            "--set",
            &duration,
        ]);
        let (before, _) = said.split_once(" on one core").unwrap();
        assert!(before.ends_with(&format!(" {unit}")), "{said}");
        let number = before.rsplit(' ').nth(1).unwrap();
        assert!((1..=120).contains(&number.parse().unwrap()), "{before}");
    }
}
