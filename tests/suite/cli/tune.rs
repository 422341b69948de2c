//! `urts-mc tune` and the `[tune]` of a campaign.

use super::Place;
use super::campaign_files::all_refused_of;

const TUNE: &str = "[tune]\nminimise = \"rmse position p50\"\nlimits = \"failure_rate <= 0.1\"\nbudget = 18\nepisodes = 4\nconfirmation = 8\n";

/// The smoke campaign with a short search.
fn smoke(changes: &[(&str, &str)]) -> String {
    let mut text = super::smoke(&[("duration_s = 6.0", "duration_s = 4.5")]);
    let start = text.find("[tune]").unwrap();
    text.truncate(start);
    text += TUNE;
    for (old, new) in changes {
        assert!(text.contains(old), "{old:?} is missing");
        text = text.replace(old, new);
    }
    text
}

#[test]
fn a_search_says_what_it_found_and_writes_it() {
    let place = Place::with(&smoke(&[]));
    let said = place.succeeds(&["tune", "c.toml", "--controller", "pid", "--out", "found"]);
    for words in [
        "smoke: pid-tuned: 18 candidates in 4 episodes each, confirmed in 8 fresh episodes; seed 2026",
        "pid-tuned has rmse position p50 = ",
        "in fresh episodes [95 %]",
        "≤ 0.1000",
        "written to found",
    ] {
        assert!(said.contains(words), "{words:?} is missing from: {said}");
    }
    for file in [
        "tune.json",
        "tune.parquet",
        "tune.csv",
        "tune.html",
        "tune.md",
        "gains.json",
    ] {
        assert!(place.path("found").join(file).is_file(), "{file}");
    }
    // Figures are in the page alone.
    for (page, headings) in [
        ("found/tune.md", &["What it reaches", "Parameters"][..]),
        (
            "found/tune.html",
            &["How the search went", "What a smaller error is paid with"],
        ),
    ] {
        let page = place.read(page);
        for heading in headings {
            assert!(page.contains(heading), "{heading}");
        }
    }
    let found = place.json(&[
        "tune",
        "c.toml",
        "--controller",
        "pid",
        "--out",
        "found",
        "--json",
    ]);
    assert_eq!(found["candidates"], 18);
    assert_eq!(found["measures"][0], "rmse position p50");
    assert_eq!(
        found["confirmed_evaluation"]["holds"],
        serde_json::json!([true])
    );
    // The gains fly in a campaign that names them.
    let named = "synthesis.named.mine={ gains = \"found/gains.json\", controller = \"pid-tuned\" }";
    let checked = place.json(&[
        "check",
        "c.toml",
        "--set",
        named,
        "--set",
        "controllers=[\"mine\"]",
        "--json",
    ]);
    assert_eq!(checked["controllers"], serde_json::json!(["mine"]));
}

#[test]
fn what_a_search_cannot_do_is_said_before_it_begins() {
    let place = Place::with(&smoke(&[]));
    place.refuses(
        &["tune", "c.toml", "--controller", "pid", "--set", "tune="],
        2,
        &["tune = absent", "add [tune] with minimise = \"rmse p50\""],
    );
    place.refuses(
        &["tune", "c.toml", "--controller", "lqr"],
        2,
        &["lqr", "pid", "ftc"],
    );
    place.refuses(
        &[
            "tune",
            "c.toml",
            "--controller",
            "pid",
            "--precision",
            "f64",
            "--backend",
            "gpu",
        ],
        2,
        &["--precision f64: the shaders are in single precision"],
    );
    std::fs::create_dir(place.path("taken")).unwrap();
    place.write("taken/thesis.tex", "");
    place.refuses(
        &["tune", "c.toml", "--controller", "pid", "--out", "taken"],
        2,
        &["taken: holds files, but no finished run", "--overwrite"],
    );
}

#[test]
fn a_tune_that_cannot_be_searched_is_named_with_key_value_limit_and_remedy() {
    all_refused_of(
        smoke,
        r#"
"rmse position p50" => "rmsd position p50" :: tune.minimise ~ "rmsd position p50" ~ did you mean "rmse"?
"rmse position p50" => "rmse position"   :: tune.minimise ~ differs from episode to episode ~ p50
"rmse position p50" => "rmse joints p50" :: tune.minimise ~ the channels are position, attitude
"rmse position p50" => "rmse position p500" :: tune.minimise ~ differs from episode to episode
"rmse position p50" => "failure_rate p50" :: tune.minimise ~ has no quantiles
"rmse position p50" => "-1 * rmse position p50" :: tune.minimise ~ a weight above 0
minimise = "rmse position p50" => minimise = [] :: tune.minimise ~ something is to be small
minimise = "rmse position p50" => minimise = ["effort position p50", "rmse p50"] :: tune.minimise[0] ~ this one has none
minimise = "rmse position p50" => minimise = 3 :: a text such as "rmse position p50"
max_rmse = 1.0 => settled_error = 0.1 && "rmse position p50" => "rmse p50" :: tune.minimise ~ verdict.max_rmse gives none
"failure_rate <= 0.1" => "failure_rate < 0.1" :: tune.limits ~ a limit is a measure, <= or >=, and a number
"failure_rate <= 0.1" => ["failure_rate <= 0.1", "delay_margin >= 7"] :: tune.limits[1] ~ did you mean "delay_margin_ms"?
budget = 18 => budget = 0 :: tune.budget ~ must lie between 1 and
episodes = 4 => episodes = 1 :: tune.episodes ~ must lie between 2 and
budget = 18 => margins_of = "fct" :: tune.margins_of ~ "fct" ~ did you mean "ftc"?
budget = 18 => commands_of = "lqr" :: tune.commands_of ~ the controllers are ftc
budget = 18 => budgets = 9 :: unknown key `budgets` ~ did you mean `budget`?
"#,
    );
}
