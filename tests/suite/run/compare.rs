//! Two runs of the same draws: what is equal, what has become worse, and what cannot be compared.

use crate::common::{altered, without_hash};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::Campaign;
use urts_mc::random::philox::{Address, Stream};
use urts_mc::report::{comparison, regressions};
use urts_mc::results::compare_pairs;
use urts_mc::results::scores::{Scores, Status};
use urts_mc::run::compare::{Asked, CompareError, RunComparison, claim, compare_runs, write};
use urts_mc::run::directory::OutputDir;
use urts_mc::run::manifest::{Manifest, campaign_hash};
use urts_mc::run::{Extras, run};
use urts_mc::simulation::RunOptions;

/// Short flights of one UAV under "ftc" and "pid-placed", whose poles are where `changes` say.
const SHORT: [&str; 7] = [
    "controllers=[\"ftc\", \"pid-placed\"]",
    "synthesis.pid-placed={ poles_rad_s = 15.0 }",
    "time.duration_s=4.5",
    "agent.team=1",
    "reference.agents.2=",
    "reference.agents.1=",
    "episodes=40",
];

struct Runs(TempDir);

impl Runs {
    fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    fn campaign(changes: &[&str]) -> Campaign {
        altered("smoke", &[&SHORT, changes].concat())
    }

    fn run(&self, name: &str, changes: &[&str]) -> PathBuf {
        let campaign = Self::campaign(changes);
        let path = self.0.path().join(name);
        let out = OutputDir::claim(&path, &campaign, false).unwrap();
        let options = RunOptions::cpu(Precision::F32);
        run(&campaign, &options, &out, Extras::default(), &|_| ()).unwrap();
        path
    }
}

fn compared(a: &Path, b: &Path) -> RunComparison {
    compare_runs(a, b, &Asked::default()).unwrap()
}

fn refused(a: &Path, b: &Path, asked: &Asked) -> String {
    compare_runs(a, b, asked).unwrap_err().to_string()
}

fn limits(ratios: &[&str], differences: &[&str]) -> Asked {
    let owned = |texts: &[&str]| texts.iter().map(ToString::to_string).collect();
    Asked {
        pairs: Vec::new(),
        ratios: owned(ratios),
        differences: owned(differences),
    }
}

#[test]
fn a_run_equals_itself_and_the_same_run_on_one_thread_or_in_double_precision_hardly_differs() {
    let runs = Runs::new();
    let a = runs.run("a", &[]);
    let found = compared(&a, &a);
    assert_eq!((found.pairs.len(), found.episodes), (2, 40));
    for pair in &found.pairs {
        assert_eq!((pair.same, pair.is_regression()), (40, false));
        assert!(pair.verdict.contains(" equals "), "{}", pair.verdict);
        assert_eq!(pair.unlike, None);
    }
    assert_eq!(regressions(&found), None);
    assert!(found.notes.is_empty(), "{:?}", found.notes);
    // Rounding is no regression, and nothing is equal to the last digit.
    let campaign = Runs::campaign(&[]);
    let b = runs.0.path().join("b");
    let out = OutputDir::claim(&b, &campaign, false).unwrap();
    let options = RunOptions::cpu(Precision::F64);
    run(&campaign, &options, &out, Extras::default(), &|_| ()).unwrap();
    let found = compared(&a, &b);
    assert!(
        found
            .pairs
            .iter()
            .all(|pair| pair.same < 40 && !pair.is_regression())
    );
    assert!(
        found
            .notes
            .iter()
            .any(|note| note.contains("precision: f32 in A, f64 in B"))
    );
}

#[test]
fn a_planted_regression_of_the_gains_is_found_in_the_controller_that_has_it() {
    let runs = Runs::new();
    let a = runs.run("a", &[]);
    // A PID half as fast.
    let b = runs.run("b", &["synthesis.pid-placed={ poles_rad_s = 7.5 }"]);
    let found = compared(&a, &b);
    let [ftc, pid] = found.pairs.as_slice() else {
        panic!("two controllers")
    };
    assert_eq!((ftc.same, ftc.is_regression()), (40, false));
    assert!(pid.is_regression());
    assert!(
        pid.verdict
            .starts_with("B:pid-placed does worse than A:pid-placed"),
        "{}",
        pid.verdict
    );
    let worse = regressions(&found).unwrap();
    assert!(
        worse.contains("B:pid-placed") && !worse.contains("B:ftc"),
        "{worse}"
    );
    // Its bandwidth is said to be another one.
    assert!(pid.unlike.as_ref().unwrap().contains("crossover"));
    // The other way round it is an improvement.
    assert_eq!(regressions(&compared(&b, &a)), None);
}

#[test]
fn limits_have_to_be_proved_and_are_told_apart_from_what_only_seems_to_hold() {
    let runs = Runs::new();
    let a = runs.run("a", &[]);
    let asked = limits(
        &["rmse position p50 <= 1.05", "delay_margin_ms >= 0.95"],
        &["failure_rate <= 0.05", "failure_rate <= 0.1"],
    );
    let found = compare_runs(&a, &a, &asked).unwrap();
    // Of two pairs, each with one ratio of errors, two of margins and two differences.
    assert_eq!(found.requirements.len(), 10);
    let unmet: Vec<String> = found
        .requirements
        .iter()
        .filter(|own| !own.is_met())
        .map(|own| own.quantity.clone())
        .collect();
    // z^2 / (n + z^2) of 40 episodes without a difference is 0.063.
    assert_eq!(unmet.len(), 2, "{unmet:?}");
    assert!(
        unmet
            .iter()
            .all(|own| own.starts_with("failure_rate, difference to A:"))
    );
    assert!(
        regressions(&found)
            .unwrap()
            .contains("failure_rate, difference to A:ftc of B:ftc")
    );
    for (asked, words) in [
        (
            limits(&["rmse position <= 1.05"], &[]),
            "say which quantile",
        ),
        (
            limits(&["rmse position p50"], &[]),
            "a limit is a measure, <= or >=, and a number",
        ),
        (limits(&["failure_rate <= 1.0"], &[]), "or --difference"),
    ] {
        let said = refused(&a, &a, &asked);
        assert!(
            said.starts_with("--ratio \"") && said.contains(words),
            "{said}"
        );
    }
}

#[test]
fn runs_that_met_something_else_are_refused_and_what_differs_is_named() {
    let runs = Runs::new();
    let a = runs.run("a", &[]);
    for (name, changes, words) in [
        ("seed", vec!["seed=5"], "differ in seed: 2026 and 5;"),
        (
            "limits",
            vec!["verdict.max_error=1.0"],
            "differ in verdict.max_error: [1.5, ",
        ),
        (
            "drawn",
            vec!["fault.0.magnitude={ uniform = [0.1, 0.6] }"],
            "differ in fault[0];",
        ),
        (
            "fixed",
            vec!["initial.error_integral=0.1"],
            "differ in initial;",
        ),
        (
            "reference",
            vec!["reference.frequency_rad_s=0.3"],
            "differ in reference;",
        ),
    ] {
        let b = runs.run(name, &changes);
        let said = refused(&a, &b, &Asked::default());
        assert!(said.contains(words), "{said}");
    }
    // A version that draws other numbers of the same campaign is found out by its tables.
    let other = runs.run("other", &["seed=7"]);
    let manifest = fs::read_to_string(other.join("manifest.json")).unwrap();
    let forged = without_hash(&manifest)
        .replace("\"seed\": 7", "\"seed\": 2026")
        .replace("seed=7", "seed=2026");
    fs::write(other.join("manifest.json"), &forged).unwrap();
    let forged_campaign = Manifest::read(&other).unwrap().campaign().unwrap();
    let hash = Manifest::read(&other).unwrap().campaign_blake3;
    let forged = forged.replace(&hash, &campaign_hash(&forged_campaign));
    fs::write(other.join("manifest.json"), forged).unwrap();
    let error = compare_runs(&a, &other, &Asked::default()).unwrap_err();
    assert!(matches!(error, CompareError::Differ { .. }));
    let said = error.to_string();
    assert!(said.contains("of agent 0 in episode 0: "), "{said}");
    // No controller in common, and none of that name.
    let c = runs.run("c", &["controllers=[\"pid\"]"]);
    let said = refused(&a, &c, &Asked::default());
    assert!(
        said.contains(
            "no controller is in both runs: ftc, pid-placed in the first, pid in the second"
        ),
        "{said}"
    );
    let pairs = |b: &str, a: &str| Asked {
        pairs: vec![[b.to_string(), a.to_string()]],
        ..Asked::default()
    };
    assert!(refused(&a, &c, &pairs("ftc", "ftc")).contains("the second run's controllers are pid"));
    let found = compare_runs(&a, &c, &pairs("pid", "ftc")).unwrap();
    assert_eq!((&*found.pairs[0].b, &*found.pairs[0].a), ("B:pid", "A:ftc"));
}

#[test]
fn a_longer_run_is_compared_as_far_as_the_shorter_one_goes_and_files_are_the_same_each_time() {
    let runs = Runs::new();
    let a = runs.run("a", &[]);
    let b = runs.run("b", &["episodes=64"]);
    let found = compared(&a, &b);
    assert_eq!(found.episodes, 40);
    assert!(found.pairs.iter().all(|pair| pair.same == 40));
    assert!(found.notes[0].contains("the first 40 are compared, and the other 24 are left out"));
    let files = |name: &str| {
        let place = runs.0.path().join(name);
        let out = claim(&place, [&a, &b], false).unwrap();
        write(&found, &comparison(&found), &out).unwrap();
        drop(out);
        let names = fs::read_dir(&place).unwrap();
        let mut names: Vec<PathBuf> = names.map(|entry| entry.unwrap().path()).collect();
        names.sort();
        names
            .iter()
            .map(|path| fs::read(path).unwrap())
            .collect::<Vec<_>>()
    };
    let first = files("first");
    assert_eq!(first.len(), 7);
    assert_eq!(first, files("second"));
    // Neither a run's directory nor a comparison of other runs is replaced, an earlier comparison of the same is.
    assert!(claim(&a, [&a, &b], false).is_err());
    let first = runs.0.path().join("first");
    assert!(claim(&first, [&a, &b], false).is_ok());
    let other = claim(&first, [&b, &a], false).unwrap_err().to_string();
    assert!(other.contains("holds a comparison of"), "{other}");
    assert!(claim(&first, [&b, &a], true).is_ok());
}

/// Scores of two runs of one controller: in each episode whether it fails, and the logarithm of its error.
fn pair_of_runs(campaign: &Campaign, outcome: impl Fn(usize, usize) -> (bool, f64)) -> Scores {
    crate::results::scores_of_channels(campaign, |run, episode, _| {
        let (fails, log_error) = outcome(run, episode);
        let status = if fails { Status::Exceeded } else { Status::Ok };
        (status, log_error.exp())
    })
}

#[test]
fn intervals_of_two_runs_cover_the_truth_in_95_of_100_comparisons() {
    // B fails in 12 % of the episodes and A in 8 %, half of the failures in common; the median log-ratio of the errors
    // is 0.1, skewed. Of 2000 comparisons the standard error is 0.5 points; BCa and Tango are asymptotic.
    let campaign = Runs::campaign(&["controllers=[\"ftc\", \"pid\"]", "episodes=100"]);
    let rounds = 2000;
    let (mut rates, mut ratios) = (0, 0);
    for round in 0..rounds {
        let unit = |episode: usize, index: u32| {
            let address = Address {
                episode: u32::try_from(episode).unwrap(),
                stream: Stream::Initial,
                entry: 3,
                member: 0,
                index,
            };
            address.unit(round)
        };
        let scores = pair_of_runs(&campaign, |run, episode| {
            let chance = unit(episode, 0);
            let fails = match run {
                0 => chance < 0.12,
                _ => (0.06..0.14).contains(&chance),
            };
            // The median of an exponential is ln 2.
            let skewed = -unit(episode, 1).ln() - std::f64::consts::LN_2;
            (fails, if run == 0 { 0.0 } else { 0.1 + 0.2 * skewed })
        });
        let found = &compare_pairs(&campaign, &scores, [[0, 1]])[0];
        let rate = found.difference.unwrap().interval.unwrap();
        rates += u32::from(rate.lower <= 0.04 && 0.04 <= rate.upper);
        let ratio = found.ratios[0].log_ratio.unwrap().interval.unwrap();
        ratios += u32::from(ratio.lower <= 0.1 && 0.1 <= ratio.upper);
    }
    let [rates, ratios] = [rates, ratios].map(|count| f64::from(count) / rounds as f64);
    println!("covered: {rates} and {ratios}");
    assert!((rates - 0.95).abs() < 0.02, "{rates}");
    assert!((ratios - 0.95).abs() < 0.02, "{ratios}");
}
