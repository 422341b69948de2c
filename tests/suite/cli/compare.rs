//! `urts-mc compare` as a nightly job meets it.

use super::Place;
use serde_json::Value;

#[test]
fn a_regression_ends_with_exit_code_4_and_a_failed_test_case() {
    let place = Place::smoke(&[
        ("episodes = 3", "episodes = 16"),
        (
            "[\"ftc\", \"pid\", \"pid-tuned\"]",
            "[\"ftc\", \"pid-placed\"]",
        ),
        ("duration_s = 6.0", "duration_s = 4.5"),
    ]);
    let run = |out: &str, set: &[&str]| {
        let set = set.iter().flat_map(|setting| ["--set", setting]);
        let arguments = ["run", "c.toml", "--quiet", "--out", out];
        let arguments: Vec<&str> = arguments.into_iter().chain(set).collect();
        let ended = place.program(&arguments);
        assert_eq!(ended.code, 0, "{}", ended.stderr);
    };
    run("before", &["synthesis.pid-placed={ poles_rad_s = 15.0 }"]);
    run("after", &["synthesis.pid-placed={ poles_rad_s = 6.0 }"]);
    let same = place.program(&["compare", "before", "before", "--out", "same"]);
    assert_eq!(same.code, 0, "{}", same.stderr);
    assert!(
        same.stdout
            .contains("B:ftc equals A:ftc: all 16 episodes end alike, to the last digit")
    );
    let ended = place.program(&["compare", "before", "after", "--junit", "c.xml"]);
    assert_eq!(ended.code, 4);
    assert!(
        ended
            .stderr
            .starts_with("error: B:pid-placed does worse than A:pid-placed: ")
    );
    // What it comes to stands at the end.
    let last: Vec<&str> = ended.stdout.lines().rev().take(8).collect();
    assert!(
        last.iter()
            .any(|line| line.contains("B:pid-placed does worse")),
        "{last:?}"
    );
    let dir = "reports/after-against-before";
    for name in [
        "comparison.parquet",
        "comparison.csv",
        "fairness.csv",
        "compare.html",
        "compare.md",
    ] {
        assert!(place.path(&format!("{dir}/{name}")).is_file(), "{name}");
    }
    let found: Value = serde_json::from_str(&place.read(&format!("{dir}/compare.json"))).unwrap();
    assert_eq!(found["pairs"][1]["favour"], "against");
    assert_eq!(found["pairs"][0]["same"], 16);
    let junit = place.read("c.xml");
    assert!(junit.contains("failures=\"1\""), "{junit}");
    assert!(
        junit.contains("name=\"B:pid-placed is not worse than A:pid-placed\""),
        "{junit}"
    );
    // A file of a run is never replaced, other files only on demand; what is refused does not look as if it had passed.
    for (file, words) in [
        (
            "before/manifest.json",
            "the run writes a file of this name itself",
        ),
        ("c.toml", "exists already and is no JUnit file"),
    ] {
        let before = place.read(file);
        let refused = place.program(&["compare", "before", "after", "--junit", file]);
        assert_eq!(refused.code, 2);
        assert!(refused.stderr.contains(words), "{}", refused.stderr);
        assert_eq!(place.read(file), before);
    }
    let nothing = [
        "compare",
        "before",
        "nowhere",
        "--junit",
        "c.xml",
        "--out",
        "same",
        "--overwrite",
    ];
    assert_eq!(place.program(&nothing).code, 2);
    assert!(place.read("c.xml").contains("errors=\"1\""));
    let page = place.read(&format!("{dir}/compare.md"));
    assert!(
        page.contains("B is after, A is before: 16 episodes"),
        "{page}"
    );
    // Other draws are bad usage.
    run("other", &["seed=1"]);
    let refused = place.program(&["compare", "before", "other"]);
    assert_eq!(refused.code, 2);
    assert!(
        refused
            .stderr
            .contains("before and other differ in seed: 2026 and 1; episodes can be compared")
    );
    assert!(!place.path("reports/other-against-before").exists());
    let nothing = place.program(&["compare", "before", "nowhere"]);
    assert_eq!(nothing.code, 2);
    assert!(
        nothing.stderr.contains("nowhere: holds no readable run"),
        "{}",
        nothing.stderr
    );
}

#[test]
fn everything_may_be_required_of_a_run_and_what_cannot_be_is_refused() {
    let require = |table: &str| {
        let text = format!("[[require]]\ncontroller = \"ftc\"\n{table}\n[verdict]");
        Place::smoke(&[
            ("[verdict]", &text),
            ("episodes = 3", "episodes = 64"),
            ("duration_s = 6.0", "duration_s = 4.5"),
        ])
    };
    let place = require(
        "measure = \"rmse position p50\"\nratio_to = \"pid\"\nat_most = 0.5\n\
         [[require]]\ncontroller = \"ftc\"\nmeasure = \"settling_s p50\"\nat_most = 0.001\n\
         [[require]]\ncontroller = \"ftc\"\nmeasure = \"delay_margin_ms position\"\nat_least = 5\n",
    );
    let ended = place.program(&["run", "c.toml", "--out", "out", "--junit", "c.xml"]);
    assert_eq!(ended.code, 4, "{}", ended.stderr);
    assert!(
        ended
            .stdout
            .contains("requirements: what is proved with 95 % confidence")
    );
    // The second is of position and of attitude.
    let places: Vec<&str> = ended
        .stderr
        .lines()
        .filter_map(|line| line.split("require[").nth(1))
        .collect();
    assert_eq!(places.len(), 2, "{}", ended.stderr);
    assert!(
        places
            .iter()
            .all(|line| line.starts_with("1]: settling_s ")),
        "{places:?}"
    );
    let junit = place.read("c.xml");
    for name in [
        "require[0]: rmse position p50, ratio to pid of ftc at most 0.5",
        "require[1]: settling_s attitude p50 of ftc at most 0.001",
        "require[2]: delay_margin_ms position of ftc at least 5",
    ] {
        assert!(junit.contains(name), "{name} is missing from {junit}");
    }
    for (table, words) in [
        (
            "measure = \"rmse p50\"",
            "require[0] (line 68) = without a limit: a measure has a limit; give at_most or at_least",
        ),
        ("at_most = 0.1", "without a measure"),
        (
            "measure = \"rmse p50\"\nat_most = 0.1\nat_least = 0.1",
            "the table has a limit already: require[0].at_most",
        ),
        (
            "measure = \"rmse p50\"\nat_most = 0.1\nfailure_rate_upper_95 = 0.1",
            "it is short for measure = \"failure_rate\"",
        ),
        (
            "measure = \"failure_rate\"\nat_most = 1.5",
            "require[0].at_most (line 71) = 1.5",
        ),
        (
            "measure = \"failure_rate\"\nratio_to = \"pid\"\nat_most = 1.5",
            "compare them by their difference: difference_to",
        ),
        (
            "measure = \"rmse p50\"\nratio_to = \"ftc\"\nat_most = 1.5",
            "this is the controller itself",
        ),
        (
            "measure = \"rmse p50\"\nratio_to = \"lqr\"\nat_most = 1.5",
            "the campaign's controllers are ftc, pid, pid-tuned",
        ),
        (
            "measure = \"rmsee p50\"\nat_most = 1.5",
            "did you mean \"rmse\"?",
        ),
        (
            "measure = \"survival_at_s\"\nat_least = 0.5",
            "write it as \"survival_at_s 10\"",
        ),
        (
            "measure = \"survival_at_s 9\"\nat_least = 0.5",
            "an episode ends at 4.5 s",
        ),
        (
            "measure = \"certified_rho\"\nratio_to = \"pid\"\nat_most = 1",
            "this is not known of \"pid\"",
        ),
        (
            "measure = \"rmse p50\"\nat_most = 1\n[stop]\ncontroller = \"ftc\"\nhalf_width = 0.1",
            "the campaign has a [stop]",
        ),
    ] {
        let place = require(table);
        let ended = place.program(&["run", "c.toml", "--out", "out"]);
        assert_eq!(ended.code, 2, "{table}: {}", ended.stderr);
        assert!(
            ended.stderr.contains(words),
            "{words:?} is missing from: {}",
            ended.stderr
        );
        assert!(!place.path("out").exists());
    }
    // What so few episodes cannot prove is said before they fly.
    let place = require("measure = \"rmse position p99\"\nat_most = 1.0");
    let ended = place.program(&["run", "c.toml", "--out", "out"]);
    assert_eq!(ended.code, 4);
    assert!(
        ended.stderr.contains("note: require[0]: 64 episodes cannot prove rmse position p99 at most 1, whatever they show; simulate at least 299"),
        "{}",
        ended.stderr
    );
}
