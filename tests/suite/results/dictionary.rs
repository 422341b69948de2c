//! The data dictionary against the files: every column of every table is in it, with the type that it has.

use crate::common::{altered, repository};
use polars::prelude::{DataType, ParquetReader, SerReader};
use std::collections::BTreeSet;
use std::fs::File;
use tempfile::TempDir;
use urts_mc::backend::cpu::Precision;
use urts_mc::report::columns_chapter;
use urts_mc::results::dictionary::{DICTIONARY, Kind, entry, unit};
use urts_mc::run::directory::OutputDir;
use urts_mc::run::{Extras, run};
use urts_mc::simulation::RunOptions;

/// Campaigns that have every table and every kind of column between them.
fn campaigns() -> [urts_mc::campaign::Campaign; 6] {
    let short = "time.duration_s=4.5";
    [
        altered(
            "smoke",
            &[
                "strata=[{ faults = \"each\" }, { faults = [] }]",
                "episodes=12",
                short,
            ],
        ),
        altered(
            "smoke",
            &["sampling.design=\"sobol\"", "episodes=16", short],
        ),
        altered(
            "smoke",
            &[
                "stop.controller=\"ftc\"",
                "stop.half_width=0.2",
                "episodes=80",
                short,
            ],
        ),
        altered("mixed-teams", &["episodes=4"]),
        altered("uav-digital", &["episodes=16"]),
        altered("biped-ground-reaction", &["episodes=2"]),
    ]
}

#[test]
fn every_column_of_every_table_is_in_the_dictionary_with_its_type_and_its_empty_cells() {
    let mut used: BTreeSet<(String, &str)> = BTreeSet::new();
    for campaign in campaigns() {
        let place = TempDir::new().unwrap();
        let out = OutputDir::claim(place.path(), &campaign, true).unwrap();
        let options = RunOptions::cpu(Precision::F32);
        run(&campaign, &options, &out, Extras::default(), &|_| ()).unwrap();
        for file in std::fs::read_dir(place.path()).unwrap() {
            let path = file.unwrap().path();
            if path
                .extension()
                .is_none_or(|extension| extension != "parquet")
            {
                continue;
            }
            let table = path.file_stem().unwrap().to_str().unwrap().to_string();
            let frame = ParquetReader::new(File::open(&path).unwrap())
                .finish()
                .unwrap();
            for column in frame.columns() {
                let name = column.name().as_str();
                let own = entry(&table, name);
                let own = own.unwrap_or_else(|| panic!("{}: {table}.{name}", campaign.name));
                let kind = match column.dtype() {
                    DataType::String => Kind::Text,
                    DataType::Int64 => Kind::Whole,
                    DataType::Float64 => Kind::Real,
                    DataType::Boolean => Kind::Flag,
                    other => panic!("{table}.{name}: {other}"),
                };
                assert_eq!(own.kind, kind, "{table}.{name}");
                assert!(
                    !own.empty.is_empty() || column.null_count() == 0,
                    "{}: {table}.{name} has {} empty cells",
                    campaign.name,
                    column.null_count()
                );
                used.insert((table.clone(), own.name));
            }
        }
    }
    // Nothing in it is of former times; the table of a replay is none of a run.
    for own in DICTIONARY.iter().filter(|own| own.tables != "replay") {
        for table in own.tables.split(' ') {
            let of_groups = own.name == "group" && ["faults", "conditions"].contains(&table);
            assert!(
                used.contains(&(table.to_string(), own.name)) || of_groups,
                "{table}.{} is in no file",
                own.name
            );
        }
    }
}

#[test]
fn the_most_exact_entry_counts_and_names_say_their_units() {
    assert_eq!(entry("episodes", "fault3_occurs").unwrap().kind, Kind::Flag);
    assert_eq!(
        entry("episodes", "fault3_onset_s").unwrap().name,
        "fault<n>_<parameter>"
    );
    assert_eq!(
        entry("summary", "q95_lower").unwrap().name,
        "q<percent>_<end>"
    );
    assert_eq!(entry("episodes", "q95"), None);
    assert_eq!(unit("episodes", "fault3_onset_s"), Some("s"));
    assert_eq!(
        unit("episodes", "disturbance0_frequency_rad_s_roll"),
        Some("rad/s")
    );
    assert_eq!(unit("episodes", "disturbance0_amplitude_x"), None);
    assert_eq!(unit("channels", "rmse"), Some("m or rad"));
    assert_eq!(unit("channels", "controller"), None);
}

#[test]
fn the_chapter_on_the_columns_is_what_the_command_writes() {
    let chapter = std::fs::read_to_string(repository("src/results/README.md")).unwrap();
    assert_eq!(
        chapter,
        columns_chapter(),
        "urts-mc columns --markdown > src/results/README.md writes it anew"
    );
}
