//! What a GPU's compiler makes of the shaders, without a GPU: `tests/gpu-static` says how it is called.
//!
//! Every text of `advance` that the shipped campaigns need is translated as wgpu does it and compiled by ACO, the
//! compiler of AMD's cards in Mesa, which works without a card ("null hardware"). It says how many registers a shader
//! takes, how many of them are spilled to memory, how many waves run at once on a part of the card, and how many
//! instructions there are. With `--check` these are compared with the table of the repository, which holds for one
//! version of Mesa.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    missing_docs,
    reason = "a tool of those who write the shaders"
)]

#[path = "gpu_static/compiler.rs"]
mod compiler;
#[path = "gpu_static/texts.rs"]
mod texts;

use compiler::{FAMILIES, Figures, compile, compiled};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

/// The figures of every text, by text and family.
type Table = BTreeMap<(String, String), Figures>;

/// By how much a figure may grow.
const GROWTH: f64 = 1.1;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|own| own != "--bench")
        .collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["compile", file, bindings] => compile(Path::new(file), bindings),
        ["--texts", folder] => {
            fs::create_dir_all(folder).unwrap();
            for (name, text) in texts::texts() {
                fs::write(Path::new(folder).join(format!("{name}.wgsl")), text).unwrap();
            }
            ExitCode::SUCCESS
        }
        ["--check", table] => judged(&measured(), Path::new(table)),
        ["--write", table] => {
            fs::write(table, written(&measured())).unwrap();
            ExitCode::SUCCESS
        }
        _ => {
            print!("{}", written(&measured()));
            ExitCode::SUCCESS
        }
    }
}

/// Compiles every text for every family.
fn measured() -> (String, Table) {
    let dir = tempfile::tempdir().unwrap();
    let (mut driver, mut table) = (String::new(), Table::new());
    for (name, text) in texts::texts() {
        let file = dir.path().join("shader.spv");
        fs::write(&file, texts::spirv(&text)).unwrap();
        for family in FAMILIES {
            let (by, figures) = compiled(&file, family);
            eprintln!("{name} {family}: {figures:?}");
            driver = by;
            table.insert((name.clone(), family.to_string()), figures);
        }
    }
    (driver, table)
}

/// The table as a text, with the driver in its first line.
fn written((driver, table): &(String, Table)) -> String {
    let names = Figures::NAMES.join("\t");
    let mut text = format!(
        "# {driver}\n# What ACO makes of `advance`: tests/gpu-static --write. A tenth more of a figure is a failure.\n\
         text\tfamily\t{names}\n"
    );
    for ((name, family), figures) in table {
        let numbers: Vec<String> = figures.numbers().iter().map(u64::to_string).collect();
        text += &format!("{name}\t{family}\t{}\n", numbers.join("\t"));
    }
    text
}

/// Compares with the table of the repository.
fn judged(found: &(String, Table), path: &Path) -> ExitCode {
    let (driver, table) = found;
    let known = fs::read_to_string(path).unwrap();
    let mut bad = Vec::new();
    for ((name, family), figures) in table {
        if figures.spilled() > 0 {
            bad.push(format!(
                "{name} on {family} spills {} registers",
                figures.spilled()
            ));
        }
    }
    let mut lines = known.lines();
    if lines.next() != Some(&format!("# {driver}")) {
        println!("SKIPPED: the table is not of {driver}; only spills are judged");
    } else {
        let rows: BTreeMap<(String, String), Figures> = lines.filter_map(row).collect();
        if rows.keys().ne(table.keys()) {
            bad.push(
                "the table has other texts; renew it with tests/gpu-static --write".to_string(),
            );
        }
        for (key, known) in &rows {
            let Some(now) = table.get(key) else { continue };
            for what in now.grown(known, GROWTH) {
                bad.push(format!("{} on {}: {what}", key.0, key.1));
            }
        }
    }
    bad.iter().for_each(|what| println!("{what}"));
    match bad.is_empty() {
        true => {
            println!(
                "{} texts and families as in {}",
                table.len(),
                path.display()
            );
            ExitCode::SUCCESS
        }
        false => ExitCode::FAILURE,
    }
}

/// A line of the table.
fn row(line: &str) -> Option<((String, String), Figures)> {
    let mut cells = line.split('\t');
    let key = (cells.next()?.to_string(), cells.next()?.to_string());
    let numbers: Option<Vec<u64>> = cells.map(|own| own.parse().ok()).collect();
    Some((key, Figures::of(&numbers?)?))
}
