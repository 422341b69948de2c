//! The bytes of every shipped campaign's tables, against those that an earlier version wrote.

use crate::common::{golden, repository, shipped_campaigns};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;
use urts_mc::backend::cpu::Simd;
use urts_mc::campaign::Campaign;

/// BLAKE3 of the tables and gains of a directory, by file name.
fn digests(dir: &Path) -> BTreeMap<String, String> {
    let entries = fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let named = entries.map(|path| (path.file_name().unwrap().display().to_string(), path));
    let kept = named.filter(|(name, _)| name.ends_with(".parquet") || name == "gains.json");
    kept.map(|(name, path)| (name, blake3::hash(&fs::read(path).unwrap()).to_string()))
        .collect()
}

fn urts_mc(arguments: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_urts-mc"));
    command
        .current_dir(repository(""))
        .args(arguments)
        .arg("--quiet");
    let output = command.output().unwrap();
    // A requirement that so few episodes cannot prove is not what this is about.
    assert!(
        matches!(output.status.code(), Some(0 | 4)),
        "urts-mc {}: {}",
        arguments.join(" "),
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn regress_every_shipped_campaign_gives_the_bytes_of_the_version_before_the_rooms() {
    if !Simd::Avx2.is_available() && !Simd::Avx512.is_available() {
        println!("SKIPPED: scalars round otherwise than lanes with a fused multiply-add");
        return;
    }
    let expected = golden("digests.json");
    let listed = expected["campaigns"].as_object().unwrap().len();
    assert_eq!(
        listed,
        shipped_campaigns().len(),
        "a campaign has no digests"
    );
    let mut wrong = Vec::new();
    for (name, expected) in expected["campaigns"].as_object().unwrap() {
        let file = format!("campaigns/{name}.toml");
        let campaign = Campaign::load(&repository(&file)).unwrap();
        let temporary = TempDir::new().unwrap();
        let out = temporary.path().join("run");
        let (dir, episodes) = (out.display().to_string(), expected["episodes"].to_string());
        urts_mc(&[
            "run",
            &file,
            "--backend",
            "cpu",
            "--episodes",
            &episodes,
            "--out",
            &dir,
        ]);
        urts_mc(&[
            "replay",
            &dir,
            "--episode",
            "1",
            "--controller",
            &campaign.controllers[0],
        ]);
        let found = digests(&out);
        for (file, digest) in expected["files"].as_object().unwrap() {
            if found.get(file).map(String::as_str) != digest.as_str() {
                wrong.push(format!("{name}: {file}"));
            }
        }
        assert_eq!(
            found.len(),
            expected["files"].as_object().unwrap().len(),
            "{name}: {found:?}"
        );
    }
    assert!(
        wrong.is_empty(),
        "other bytes than before:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn a_changed_digit_of_a_table_changes_its_digest() {
    let temporary = TempDir::new().unwrap();
    fs::write(temporary.path().join("gains.json"), "0.25").unwrap();
    let before = digests(temporary.path());
    fs::write(temporary.path().join("gains.json"), "0.26").unwrap();
    assert_eq!(before.len(), 1);
    assert_ne!(before, digests(temporary.path()));
}
