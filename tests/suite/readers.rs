//! The tables in the hands of those who read them: every reader opens, filters, subtracts, groups and joins.

use crate::common::repository;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// Environment variables that name a Python with readers, and whether tests may go on without.
const PYTHONS: [&str; 3] = [
    "URTS_PYTHON",
    "URTS_PYTHON_PYARROW_12",
    "URTS_PYTHON_PYARROW_16",
];

/// Runs the smoke campaign into a directory.
fn run(out: &Path, more: &[&str]) {
    let ended = Command::new(env!("CARGO_BIN_EXE_urts-mc"))
        .args([
            "run",
            "campaigns/smoke.toml",
            "--backend",
            "cpu",
            "--quiet",
            "--out",
        ])
        .arg(out)
        .args(more)
        .current_dir(repository(""))
        .output()
        .unwrap();
    assert!(
        ended.status.success(),
        "{}",
        String::from_utf8_lossy(&ended.stderr)
    );
}

#[test]
fn every_reader_does_with_every_table_what_its_users_do() {
    let place = TempDir::new().unwrap();
    let out = place.path().join("out");
    let strata = "strata=[{ faults = \"each\" }, { faults = [] }]";
    run(&out, &["--set", strata, "--episodes", "24"]);
    let required = std::env::var_os("URTS_PYTHON").is_some();
    for name in PYTHONS {
        let Some(python) = std::env::var_os(name) else {
            assert!(!required, "{name} is not set, though URTS_PYTHON is");
            println!("SKIPPED: {name} names no Python with readers");
            continue;
        };
        let ended = Command::new(python)
            .arg(repository("tests/readers.py"))
            .arg(&out)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&ended.stdout);
        let why = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.success(), "{name}: {said}{why}");
        assert!(said.lines().count() > 15, "{name}: {said}");
        println!("{said}");
    }
}

#[test]
fn the_notebook_that_reads_a_run_goes_through_and_draws() {
    let Some(python) = std::env::var_os(PYTHONS[0]) else {
        println!("SKIPPED: {} names no Python with readers", PYTHONS[0]);
        return;
    };
    let place = TempDir::new().unwrap();
    run(&place.path().join("reports/smoke"), &[]);
    let ended = Command::new(python)
        .arg(repository("tests/notebook.py"))
        .arg(repository(""))
        .current_dir(place.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&ended.stdout);
    assert!(
        ended.status.success(),
        "{said}{}",
        String::from_utf8_lossy(&ended.stderr)
    );
    println!("{said}");
}
