//! What became of a run as JUnit XML, for CI systems: a test case for the simulation, for the cross-check if there was
//! to be one, and for each `[[require]]`.

use super::problems::{differing, missing, unchecked};
use super::requirements::{demanded, limited, reason, title};
use crate::run::compare::RunComparison;
use crate::run::manifest::Manifest;
use quick_junit::{NonSuccessKind, Report, SerializeError, TestCase, TestCaseStatus, TestSuite};
use std::path::Path;
use std::time::Duration;

/// What became of a run that was written to `out`.
///
/// # Errors
/// If they cannot be encoded.
pub fn junit(manifest: &Manifest, out: &Path) -> Result<String, SerializeError> {
    let campaign = manifest.name.as_str();
    let mut suite = TestSuite::new(campaign);
    let episodes = manifest.episodes.to_string();
    for (name, value) in [
        ("version", &manifest.version),
        ("campaign_blake3", &manifest.campaign_blake3),
        ("seed", &manifest.seed.to_string()),
        ("episodes", &episodes),
    ] {
        suite.add_property((name, &**value));
    }
    let interrupted = missing(manifest, out)
        .map(|message| (NonSuccessKind::Error, "interrupted simulation", message));
    suite.add_test_case(case(
        campaign,
        "simulation",
        manifest.times.loop_s,
        interrupted,
    ));
    let error = unchecked(manifest).map(|message| (NonSuccessKind::Error, "cross-check", message));
    let failure =
        differing(manifest).map(|message| (NonSuccessKind::Failure, "cross-check", message));
    if manifest.cross_check.is_some() || error.is_some() {
        let found = error.or(failure);
        suite.add_test_case(case(
            campaign,
            "cross-check",
            manifest.times.cross_check_s,
            found,
        ));
    }
    for result in &manifest.requirements {
        let unmet = (!result.is_met()).then(|| {
            (
                NonSuccessKind::Failure,
                "requirement",
                reason(manifest, result),
            )
        });
        suite.add_test_case(case(campaign, &title(result), 0.0, unmet));
    }
    report(suite)
}

/// What became of a comparison of two runs: a test case for each pair and for each limit that was given.
///
/// # Errors
/// If they cannot be encoded.
pub fn junit_of_comparison(found: &RunComparison) -> Result<String, SerializeError> {
    let campaign = found.b.campaign.as_str();
    let mut suite = TestSuite::new(campaign);
    for (name, run) in [("a", &found.a), ("b", &found.b)] {
        suite.add_property((name, &*run.path.display().to_string()));
        let hash = format!("{name}_campaign_blake3");
        suite.add_property((&*hash, &*run.campaign_blake3));
    }
    for pair in &found.pairs {
        let worse = pair
            .is_regression()
            .then(|| (NonSuccessKind::Failure, "regression", pair.verdict.clone()));
        let name = format!("{} is not worse than {}", pair.b, pair.a);
        suite.add_test_case(case(campaign, &name, 0.0, worse));
    }
    for result in &found.requirements {
        let unmet =
            (!result.is_met()).then(|| (NonSuccessKind::Failure, "limit", demanded(result)));
        suite.add_test_case(case(campaign, &limited(result), 0.0, unmet));
    }
    report(suite)
}

/// A run of a campaign of this name that came to nothing.
///
/// # Errors
/// If it cannot be encoded.
pub fn junit_of_error(campaign: &str, message: String) -> Result<String, SerializeError> {
    let mut suite = TestSuite::new(campaign);
    let found = (NonSuccessKind::Error, "run", message);
    suite.add_test_case(case(campaign, "simulation", 0.0, Some(found)));
    report(suite)
}

fn report(mut suite: TestSuite) -> Result<String, SerializeError> {
    let time = suite.test_cases.iter().filter_map(|case| case.time).sum();
    suite.set_time(time);
    let mut report = Report::new("urts-mc");
    report.set_time(time);
    report.add_test_suite(suite);
    report.to_string()
}

/// A test case, with what went wrong and its type if something did.
fn case(
    campaign: &str,
    name: &str,
    time_s: f64,
    wrong: Option<(NonSuccessKind, &str, String)>,
) -> TestCase {
    let status = match wrong {
        None => TestCaseStatus::success(),
        Some((kind, of, message)) => {
            let mut status = TestCaseStatus::non_success(kind);
            status.set_type(of).set_message(message);
            status
        }
    };
    let mut case = TestCase::new(name, status);
    case.set_classname(format!("urts-mc.{campaign}"));
    case.set_time(Duration::try_from_secs_f64(time_s).unwrap_or_default());
    case
}
