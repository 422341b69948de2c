//! A table of more rows than one file holds.

use crate::common::repository;
use polars::prelude::{DataFrame, ParquetReader, SerReader};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::Campaign;
use urts_mc::report::{Length, report};
use urts_mc::run::compare::{Asked, compare_runs};
use urts_mc::run::directory::OutputDir;
use urts_mc::run::error::OutputError;
use urts_mc::run::manifest::Manifest;
use urts_mc::run::replay::replay;
use urts_mc::run::{Extras, run};
use urts_mc::simulation::RunOptions;

/// Rows of a file in these tests. An episode of smoke.toml has nine rows of `episodes`: the seventh's are in two files.
const FILE_ROWS: usize = 20;

/// Runs short flights whose tables have so many rows in a file.
fn flown(dir: &Path, episodes: u32, file_rows: usize) -> Result<PathBuf, String> {
    let path = repository("campaigns/smoke.toml");
    let campaign = Campaign::load_asked(&path, &[], Some(episodes)).unwrap();
    let out = OutputDir::claim(dir, &campaign, false).unwrap();
    let extras = Extras {
        csv: true,
        file_rows,
        ..Extras::default()
    };
    let options = RunOptions::cpu(Precision::F32);
    let run = run(&campaign, &options, &out, extras, &|_| ());
    run.map_err(|error| error.to_string())?;
    Ok(dir.to_path_buf())
}

fn frame(path: &Path) -> DataFrame {
    ParquetReader::new(File::open(path).unwrap())
        .finish()
        .unwrap()
}

fn names(dir: &Path) -> Vec<String> {
    let entries = fs::read_dir(dir).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

#[test]
fn a_table_of_more_rows_than_a_file_holds_is_a_folder_of_files_with_the_same_rows() {
    let dir = tempfile::tempdir().unwrap();
    let small = flown(&dir.path().join("small"), 30, usize::MAX).unwrap();
    let large = flown(&dir.path().join("large"), 30, FILE_ROWS).unwrap();
    assert_eq!(names(&small), names(&large));
    let manifest = Manifest::read_verified(&large).unwrap();
    let mut folders = 0;
    for name in ["episodes", "channels", "faults", "conditions"] {
        let name = format!("{name}.parquet");
        let whole = frame(&small.join(&name));
        let rows = manifest.files.iter();
        let rows =
            rows.filter(|(file, _)| **file == name || file.starts_with(&(name.clone() + "/")));
        let rows: usize = rows.filter_map(|(_, record)| record.rows).sum();
        assert_eq!(rows, whole.height(), "{name}");
        if whole.height() <= FILE_ROWS {
            assert_eq!(
                fs::read(small.join(&name)).unwrap(),
                fs::read(large.join(&name)).unwrap()
            );
            continue;
        }
        folders += 1;
        let pieces = names(&large.join(&name));
        assert_eq!(pieces.len(), whole.height().div_ceil(FILE_ROWS), "{name}");
        assert_eq!(pieces[1], "part-00001.parquet");
        let frames = pieces
            .iter()
            .map(|piece| frame(&large.join(&name).join(piece)));
        let joined = frames.reduce(|mut all, next| {
            all.vstack_mut_owned(next).unwrap();
            all
        });
        assert!(joined.unwrap().equals_missing(&whole), "{name}");
        // CSV is for programs that read one file.
        let csv = name.replace("parquet", "csv");
        if small.join(&csv).exists() {
            assert_eq!(
                fs::read(small.join(&csv)).unwrap(),
                fs::read(large.join(&csv)).unwrap()
            );
        }
    }
    assert!(folders >= 3, "{folders}");
    // Whatever reads a run reads it as it reads any other: here an episode whose rows are in two files.
    for dir in [&small, &large] {
        let replayed = replay(dir, 6, "ftc", None).unwrap();
        assert_eq!(replayed.differs, None);
    }
    report(&large, Length::Full).unwrap();
    let compared = compare_runs(&small, &large, &Asked::default()).unwrap();
    assert_eq!(compared.pairs.len(), 3);
}

#[test]
fn a_folder_of_a_table_is_verified_and_makes_room_for_a_longer_run_but_takes_nothing_of_others_along()
 {
    let dir = tempfile::tempdir().unwrap();
    let run = flown(&dir.path().join("run"), 30, FILE_ROWS).unwrap();
    let folder = run.join("episodes.parquet");
    let second = folder.join("part-00001.parquet");
    let bytes = fs::read(&second).unwrap();
    let damaged = |path: &Path| match Manifest::read_verified(&run) {
        Err(OutputError::Damaged { path: named, .. }) => assert_eq!(named, path),
        other => panic!("{other:?}"),
    };
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 1;
    fs::write(&second, flipped).unwrap();
    damaged(&second);
    fs::remove_file(&second).unwrap();
    damaged(&second);
    fs::write(&second, &bytes).unwrap();
    Manifest::read_verified(&run).unwrap();
    // A reader of the folder would read this, too.
    let other = folder.join("part-00077.parquet");
    fs::write(&other, &bytes).unwrap();
    damaged(&other);
    fs::remove_file(&other).unwrap();
    // What is no part of the table is not removed, and so nothing of the run is.
    let mine = folder.join("notes.txt");
    fs::write(&mine, "mine").unwrap();
    let before = names(&run);
    let refused = flown(&run, 33, usize::MAX).unwrap_err();
    assert!(
        refused.contains("episodes.parquet: cannot be written"),
        "{refused}"
    );
    assert_eq!(fs::read_to_string(&mine).unwrap(), "mine");
    assert!(before.iter().all(|name| names(&run).contains(name)));
    fs::remove_file(&mine).unwrap();
    Manifest::read_verified(&run).unwrap();
    flown(&run, 33, usize::MAX).unwrap();
    assert_eq!(frame(&folder).height(), 33 * 9);
    assert_eq!(Manifest::read_verified(&run).unwrap().episodes, 33);
    // And the other way round.
    flown(&run, 36, FILE_ROWS).unwrap();
    assert!(names(&folder).len() > 5);
    Manifest::read_verified(&run).unwrap();
}
