//! The search for the parameters of a controller: what it finds, what it keeps, what it leaves in its directory.

use crate::common::altered;
use polars::prelude::{DataFrame, ParquetReader, SerReader};
use std::fs::{self, File};
use std::path::Path;
use tempfile::TempDir;
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::Campaign;
use urts_mc::controllers::GainSet;
use urts_mc::run::tune::{Evaluation, Structure, Tuning, claim, tune, write};
use urts_mc::simulation::RunOptions;

/// A search that takes a second: few candidates, few episodes, short flights.
const SHORT: [&str; 5] = [
    "time.duration_s=4.5",
    "tune.minimise=[\"rmse position p50\", \"rmse attitude p50\"]",
    "tune.budget=45",
    "tune.episodes=8",
    "tune.confirmation=32",
];

fn short(changes: &[&str]) -> Campaign {
    altered("smoke", &[&SHORT, changes].concat())
}

fn searched(campaign: &Campaign, structure: &str, threads: usize) -> Tuning {
    let options = RunOptions {
        threads,
        ..RunOptions::cpu(Precision::F32)
    };
    let structure = Structure::named(structure).unwrap();
    tune(campaign, structure, &options, &|_, _| ()).unwrap()
}

/// What was measured of a candidate, by name.
fn measure(tuning: &Tuning, of: &Evaluation, name: &str) -> f64 {
    let mut names = tuning.measures.iter().map(ToString::to_string);
    of.measured[names.position(|own| own == name).unwrap()].value
}

fn written(tuning: &Tuning, place: &Path) -> Vec<(String, Vec<u8>)> {
    let dir = claim(place, &tuning.campaign, false).unwrap();
    write(tuning, &urts_mc::report::tuning(tuning), &dir).unwrap();
    drop(dir);
    let mut files: Vec<(String, Vec<u8>)> = fs::read_dir(place)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| {
            (
                path.file_name().unwrap().display().to_string(),
                fs::read(&path).unwrap(),
            )
        })
        .collect();
    files.sort();
    files
}

#[test]
fn a_search_finds_a_better_pid_on_fresh_episodes() {
    let tuning = searched(&short(&["tune.budget=180"]), "pid", 0);
    assert_eq!(tuning.tried(), 180);
    let ratio = tuning.confirmed.objective / tuning.start.objective;
    println!(
        "{} of {}",
        tuning.confirmed.objective, tuning.start.objective
    );
    assert!(ratio < 0.5, "{ratio}");
    assert!(tuning.confirmed.holds_all());
    // What was chosen is the best of the finalists, and what each search likes best is better than how it began.
    assert_eq!(tuning.confirmed.values, tuning.finalists[0].values);
    let least = |generation: &[Evaluation]| {
        let objectives = generation.iter().map(|own| own.objective);
        objectives.fold(f64::INFINITY, f64::min)
    };
    let [first, last] = [tuning.generations.first(), tuning.generations.last()];
    assert!(least(last.unwrap()) < least(first.unwrap()));
}

#[test]
fn a_limit_is_kept_and_costs_what_it_costs() {
    let found = |limits: &str| {
        let changes = [limits, "tune.budget=180"];
        let changes = if limits.is_empty() {
            &changes[1..]
        } else {
            &changes[..]
        };
        let tuning = searched(&short(changes), "pid", 0);
        let margin_ms = measure(&tuning, &tuning.confirmed, "delay_margin_ms position");
        (
            margin_ms,
            tuning.confirmed.objective,
            tuning.confirmed.holds_all(),
        )
    };
    let (free_ms, free, _) = found("");
    let (bound_ms, bound, holds) = found("tune.limits=\"delay_margin_ms >= 30\"");
    println!("{free_ms} ms {free}, {bound_ms} ms {bound}");
    assert!(holds && bound_ms >= 30.0, "{bound_ms}");
    assert!(
        free_ms < 25.0 && free < bound,
        "{free_ms}: the limit would have been no limit"
    );
    // What cannot be kept is not kept silently.
    let (_, _, holds) = found("tune.limits=\"delay_margin_ms >= 1e6\"");
    assert!(!holds);
}

#[test]
fn margins_and_commands_of_a_controller_are_bounds_under_the_same_episodes() {
    let tuning = searched(
        &short(&[
            "tune.limits=",
            "tune.margins_of=ftc",
            "tune.commands_of=ftc",
            "tune.budget=90",
        ]),
        "pid",
        0,
    );
    let limits: Vec<String> = tuning
        .limits
        .iter()
        .map(|(_, limit)| limit.to_string())
        .collect();
    assert_eq!(limits.len(), 2 * 6);
    assert_eq!(limits[0], "delay_margin_ms position >= that of ftc");
    assert_eq!(limits[11], "peak_command attitude p95 <= that of ftc");
    // The FTC's delay margin of the independent study, and its largest commands in the fresh episodes.
    assert!((tuning.confirmed.bounds[0] - 7.59).abs() < 0.01);
    assert!((150.0..400.0).contains(&tuning.confirmed.bounds[11]));
    let place = tuning.limits[11].0;
    let commands = tuning.confirmed.measured[place].value;
    assert!(!tuning.confirmed.holds[11] || commands <= tuning.confirmed.bounds[11]);
    assert!(tuning.confirmed.holds[0]);
}

#[test]
fn a_search_is_the_same_for_any_number_of_threads_and_another_for_another_seed() {
    let place = TempDir::new().unwrap();
    let files = |name: &str, seed: u64, threads: usize| {
        let campaign = short(&[]).with_seed(seed);
        written(
            &searched(&campaign, "pid", threads),
            &place.path().join(name),
        )
    };
    let one = files("one", 2026, 1);
    assert_eq!(one.len(), 6);
    assert!(one == files("two", 2026, 2));
    assert!(one != files("other", 2027, 2));
}

#[test]
fn every_candidate_is_a_row_and_no_two_stages_share_their_episodes() {
    let place = TempDir::new().unwrap();
    let tuning = searched(&short(&[]), "pid", 0);
    written(&tuning, place.path());
    let file = File::open(place.path().join("tune.parquet")).unwrap();
    let table: DataFrame = ParquetReader::new(file).finish().unwrap();
    assert_eq!(table.height(), tuning.tried() + tuning.finalists.len() + 2);
    for column in [
        "position_real_pole_rad_s",
        "rmse_position_p50",
        "delay_margin_ms_attitude",
        "objective",
        "refused",
    ] {
        assert!(table.column(column).is_ok(), "{column}");
    }
    // The same candidate under other episodes has other errors.
    let error = |own: &Evaluation| measure(&tuning, own, "rmse position p50");
    let of_search = tuning.generations.iter().flatten();
    let mut twin = of_search.filter(|own| own.values == tuning.confirmed.values);
    let chosen = error(&tuning.finalists[0]);
    let confirmed = error(&tuning.confirmed);
    assert_ne!(chosen, confirmed);
    if let Some(twin) = twin.next() {
        assert!(error(twin) != chosen && error(twin) != confirmed);
    }
}

#[test]
fn gains_that_a_search_found_fly_in_a_campaign_as_they_did_in_the_search() {
    for structure in ["pid", "ftc"] {
        let place = TempDir::new().unwrap();
        let budget = format!("tune.budget={}", if structure == "pid" { 45 } else { 20 });
        let tuning = searched(&short(&[&budget]), structure, 0);
        written(&tuning, place.path());
        let file = place.path().join("gains.json").display().to_string();
        let name = tuning.structure.tuned;
        let named = format!("synthesis.named.mine={{ gains = {file:?}, controller = {name:?} }}");
        let campaign = short(&[&named, "controllers=[\"mine\"]"]);
        let read = &GainSet::of_groups(&campaign).unwrap()[0].controllers[0];
        for (read, searched) in read.groups.iter().zip(&tuning.controllers[0].groups) {
            assert_eq!(read.gains, searched.gains);
            assert_eq!(read.loop_gains, searched.loop_gains);
            // Fault models of its own belong to the gains of an FTC.
            assert_eq!(read.design, searched.design);
            assert_eq!(read.certificate().is_some(), structure == "ftc");
        }
        let own_design = read.groups[0].design != campaign.first_group().synthesis.designs[0];
        assert_eq!(own_design, structure == "ftc");
        let text = fs::read_to_string(place.path().join("gains.json")).unwrap();
        let file: serde_json::Value = serde_json::from_str(&text).unwrap();
        let provenance = &file["provenance"];
        assert_eq!(provenance["seed"], 2026);
        assert_eq!(provenance["minimise"][0], "rmse position p50");
        let command = provenance["command"].as_str().unwrap();
        assert!(
            command.starts_with("urts-mc tune ") && command.contains(&budget),
            "{command}"
        );
        assert_eq!(
            provenance["confirmed"]["rmse position p50"]
                .as_array()
                .unwrap()
                .len(),
            3
        );
    }
}

#[test]
fn a_search_on_groups_finds_gains_for_each_which_their_campaign_takes() {
    let place = TempDir::new().unwrap();
    let changes = [
        "time.duration_s=4.5",
        "time.settle_s=2.0",
        "tune={ minimise = \"rmse p50\", budget = 12, episodes = 4, confirmation = 8 }",
    ];
    let tuning = searched(&altered("mixed-teams", &changes), "pid", 0);
    written(&tuning, place.path());
    let file = place.path().join("gains.json").display().to_string();
    let named = |group: usize| {
        let name = tuning.structure.tuned;
        format!("group.{group}.synthesis.named.mine={{ gains = {file:?}, controller = {name:?} }}")
    };
    let (uavs, robots) = (named(0), named(1));
    let mine = [&changes[..], &[&uavs, &robots, "controllers=[\"mine\"]"]].concat();
    let read = GainSet::of_groups(&altered("mixed-teams", &mine)).unwrap();
    // Position and attitude of the UAVs, joints of the robots: each has gains of its own.
    assert_eq!((read.len(), tuning.controllers.len()), (2, 2));
    let gains = |sets: &[urts_mc::controllers::SimulatedController]| -> Vec<Vec<f64>> {
        let groups = sets.iter().flat_map(|set| &set.groups);
        groups.map(|own| own.loop_gains.k.to_vec()).collect()
    };
    let own: Vec<_> = read.iter().map(|set| set.controllers[0].clone()).collect();
    let (found, read) = (gains(&tuning.controllers), gains(&own));
    assert_eq!((found.len(), &found), (3, &read));
    assert!(found[0] != found[1] && found[1] != found[2]);
}

#[test]
fn a_directory_with_another_search_is_not_replaced_unless_asked() {
    let place = TempDir::new().unwrap();
    let tuning = searched(&short(&["tune.budget=9"]), "pid", 0);
    written(&tuning, place.path());
    assert!(claim(place.path(), &tuning.campaign, false).is_ok());
    let other = tuning.campaign.clone().with_seed(1);
    let refused = claim(place.path(), &other, false).unwrap_err().to_string();
    assert!(
        refused.contains("holds a search on another campaign, or with another seed"),
        "{refused}"
    );
    assert!(claim(place.path(), &other, true).is_ok());
    fs::write(place.path().join("thesis.tex"), "").unwrap();
    let refused = claim(place.path(), &tuning.campaign, false)
        .unwrap_err()
        .to_string();
    assert!(refused.contains("files, but no finished run"), "{refused}");
}

#[test]
fn shipped_gains_are_the_results_of_the_campaigns_that_they_name() {
    for (name, controllers) in [
        ("uav-paper", ["pid-tuned", "ftc-tuned"]),
        ("uav-physical", ["pid-tuned", "ftc-tuned"]),
        ("biped-paper", ["pid-tuned", "ftc-tuned"]),
    ] {
        let campaign = altered(name, &[]);
        let asked = campaign.tune().unwrap();
        for controller in controllers {
            let path =
                crate::common::repository(&format!("campaigns/gains/{name}-{controller}.json"));
            let text = fs::read_to_string(path).unwrap();
            let file: serde_json::Value = serde_json::from_str(&text).unwrap();
            let provenance = &file["provenance"];
            assert_eq!(provenance["campaign"], name);
            assert_eq!(provenance["seed"], campaign.seed);
            let minimise: Vec<String> = asked
                .objective
                .iter()
                .map(|term| term.measure.to_string())
                .collect();
            assert_eq!(provenance["minimise"], serde_json::json!(minimise));
            let limits: Vec<String> = asked.limits.iter().map(ToString::to_string).collect();
            assert_eq!(provenance["limits"], serde_json::json!(limits));
            assert_eq!(
                provenance["broken"],
                serde_json::json!([]),
                "{name} {controller}"
            );
            let candidates = provenance["candidates"].as_u64().unwrap();
            // A generation more would be beyond the budget.
            let budget = u64::from(asked.budget);
            assert!(candidates <= budget && candidates + 20 > budget);
        }
    }
}
