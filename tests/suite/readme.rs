//! What the README and the texts beside it tell their readers to type really works.

use crate::common::repository;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;
use urts_mc::campaign::{Campaign, FaultKind};

/// The texts that tell their readers what to type.
const TEXTS: [&str; 4] = [
    "README.md",
    ".github/CONTRIBUTING.md",
    "campaigns/README.md",
    "src/backend/README.md",
];

/// A text's blocks in a language.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let text = fs::read_to_string(repository(text)).unwrap();
    let opening = format!("\n```{language}\n");
    let begun = text.split(&opening).skip(1);
    begun
        .map(|rest| rest.split("\n```").next().unwrap().to_string())
        .collect()
}

/// The lines of the shell blocks of all texts, without their comments.
fn commands() -> Vec<String> {
    let lines = TEXTS.map(|text| blocks(text, "sh")).concat();
    let lines = lines.iter().flat_map(|block| block.lines());
    lines
        .map(|line| line.split(" #").next().unwrap().trim().to_string())
        .filter(|line| !line.is_empty())
        .collect()
}

/// A place that looks like the repository to a command.
fn place() -> TempDir {
    let place = TempDir::new().unwrap();
    let campaigns = place.path().join("campaigns");
    fs::create_dir(&campaigns).unwrap();
    fs::create_dir(campaigns.join("robots")).unwrap();
    for dir in ["campaigns", "campaigns/robots"] {
        for entry in fs::read_dir(repository(dir)).unwrap() {
            let entry = entry.unwrap();
            if entry.path().is_file() {
                fs::copy(entry.path(), place.path().join(dir).join(entry.file_name())).unwrap();
            }
        }
    }
    place
}

fn program(place: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_urts-mc"))
        .current_dir(place)
        .args(arguments.split_whitespace())
        .output()
        .unwrap()
}

#[test]
fn every_command_of_the_readme_works() {
    let place = place();
    let checks = fs::read_to_string(repository(".ci/run")).unwrap();
    let (mut simulated, mut checked) = (0, 0);
    for command in commands() {
        let own = command
            .strip_prefix("cargo run --release --locked -- ")
            .or_else(|| command.strip_prefix("urts-mc "));
        if let Some(arguments) = own {
            let output = program(place.path(), arguments);
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{command}: {said}");
            simulated += 1;
        } else if let Some(file) = command.strip_prefix("cat ") {
            assert!(place.path().join(file).is_file(), "{command}");
        } else if command.starts_with("apt-get install") {
            // What a machine with a GPU needs is installed by those who have one; the package is that of the tests'
            // Vulkan.
            let package = command.split_whitespace().last().unwrap();
            let tests = fs::read_to_string(repository("tests/run")).unwrap();
            assert!(tests.contains(package), "{command}");
        } else if let Some(option) = command.strip_prefix("tests/run ") {
            // It would run this test again: that the script knows the option has to be enough.
            let tests = fs::read_to_string(repository("tests/run")).unwrap();
            assert!(tests.contains(&format!("= {option} ]")), "{command}");
        } else {
            // Builds and checks are what every change passes.
            assert!(
                command == ".ci/run" || checks.contains(&command),
                "{command}"
            );
            checked += 1;
        }
    }
    assert!(simulated >= 8 && checked >= 4, "{simulated} {checked}");
    for name in ["report.html", "report.md", "episodes.parquet"] {
        assert!(place.path().join("reports/uav-paper").join(name).is_file());
    }
}

#[test]
fn the_campaign_of_the_readme_is_one() {
    let blocks = blocks("README.md", "toml");
    assert_eq!(blocks.len(), 1);
    let campaign = Campaign::parse(&blocks[0], Path::new("README.toml")).unwrap();
    assert_eq!(campaign.controllers.len(), 5);
    assert_eq!(campaign.first_group().faults.len(), 1);
    // It is the shipped one, shortened: every line that has a value is a line of that file.
    let shipped = fs::read_to_string(repository("campaigns/uav-paper.toml")).unwrap();
    for line in blocks[0].lines() {
        let line = line.split(" #").next().unwrap().trim();
        assert!(shipped.contains(line), "{line}");
    }
}

#[test]
fn every_part_of_a_campaign_in_the_campaigns_readme_is_one() {
    let shipped = fs::read_to_string(repository("campaigns/uav-paper.toml")).unwrap();
    let whole = shipped.split("[tune]").next().unwrap();
    let parts = blocks("campaigns/README.md", "toml");
    assert!(parts.len() >= 4, "{}", parts.len());
    let mixed = fs::read_to_string(repository("campaigns/mixed-teams.toml")).unwrap();
    for part in parts {
        let text = if part.starts_with("[[group]]") {
            // What is left out of the groups is in the shipped campaign, and nothing there is otherwise.
            let lines = part.lines().filter(|line| !line.starts_with('#'));
            assert!(lines.clone().all(|line| mixed.contains(line)), "{part}");
            mixed.clone()
        } else {
            format!("{whole}{part}")
        };
        let read = Campaign::parse(&text, Path::new("campaigns/README.toml"));
        assert!(read.is_ok(), "{part}\n{}", read.unwrap_err());
    }
}

/// The places of this repository that a text names in backticks or links to.
fn places(text: &str) -> Vec<String> {
    let folders = [
        "src/",
        "tests/",
        "shaders/",
        "campaigns/",
        ".ci/",
        ".cargo/",
        ".github/",
    ];
    let quoted = text.split('`').skip(1).step_by(2);
    let linked = text.split("](").skip(1);
    let linked = linked.map(|rest| rest.split(')').next().unwrap());
    let words = quoted.chain(linked).flat_map(str::split_whitespace);
    words
        .filter(|word| folders.iter().any(|folder| word.starts_with(folder)))
        .filter(|word| !word.contains(['<', '*']))
        .map(String::from)
        .collect()
}

#[test]
fn every_file_that_the_texts_name_is_there() {
    let others = [
        ".github/SECURITY.md",
        "CHANGELOG.md",
        "shaders/README.md",
        "src/statistics/README.md",
    ];
    let mut found = 0;
    for text in TEXTS.into_iter().chain(others) {
        for place in places(&fs::read_to_string(repository(text)).unwrap()) {
            assert!(repository(&place).exists(), "{text} names {place}");
            found += 1;
        }
    }
    assert!(found >= 30, "{found}");
}

#[test]
fn the_shaders_readme_has_a_line_for_every_shader() {
    let text = fs::read_to_string(repository("shaders/README.md")).unwrap();
    let rows = text.lines().filter_map(|line| line.strip_prefix("| "));
    let rows = rows.skip(1).take_while(|row| row.contains(" | "));
    let named = rows.flat_map(|row| row.split(" | ").next().unwrap().split(", "));
    let mut named: Vec<String> = named.map(|name| format!("{}.wgsl", name.trim())).collect();
    let entries = fs::read_dir(repository("shaders")).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut there: Vec<String> = names.filter(|name| name.ends_with(".wgsl")).collect();
    named.sort_unstable();
    there.sort_unstable();
    assert_eq!(named, there);
}

#[test]
fn the_campaigns_readme_names_every_kind_of_fault() {
    let text = fs::read_to_string(repository("campaigns/README.md")).unwrap();
    for &kind in FaultKind::ALL {
        let name = format!("`{}`", kind.name());
        assert!(text.contains(&name), "{name}");
    }
}

#[test]
fn the_readme_is_short() {
    let text = fs::read_to_string(repository("README.md")).unwrap();
    assert!(text.lines().count() <= 250, "{}", text.lines().count());
}

#[test]
fn the_python_of_the_readme_runs_and_its_tables_are_right() {
    let python = std::env::var("URTS_PYTHON").unwrap_or_else(|_| "python3".into());
    let imports = "import polars, pandas, pyarrow, duckdb";
    let at_hand = Command::new(&python).args(["-c", imports]).output();
    if !at_hand.is_ok_and(|output| output.status.success()) {
        let required = std::env::var_os("URTS_PYTHON").is_some();
        assert!(
            !required,
            "{python} lacks one of polars, pandas, pyarrow, duckdb"
        );
        println!("SKIPPED: no Python with polars, pandas, pyarrow and duckdb");
        return;
    }
    let place = place();
    let output = program(
        place.path(),
        "run campaigns/smoke.toml --quiet --backend cpu",
    );
    assert!(output.status.success());
    let blocks = blocks("README.md", "python");
    assert_eq!(blocks.len(), 3);
    let mut said = Vec::new();
    for block in blocks {
        let output = Command::new(&python)
            .current_dir(place.path())
            .env("PYTHONIOENCODING", "utf-8")
            .args(["-c", &block])
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{block}\n{errors}");
        said.push(String::from_utf8(output.stdout).unwrap());
    }
    // Failures by controller, as the summary has them.
    let summary = fs::read_to_string(place.path().join("reports/smoke/summary.csv")).unwrap();
    let pid = summary
        .lines()
        .find(|line| line.starts_with("pid,all,rmse,position"))
        .unwrap();
    let failed = pid.split(',').nth(5).unwrap();
    let line = said[0].lines().find(|line| line.contains("pid ")).unwrap();
    assert!(line.contains(failed), "{line}: {failed}");
    for channel in ["roll", "yaw"] {
        assert!(said[1].contains(channel), "{}", said[1]);
    }
    assert!(said[2].contains("times_smaller"), "{}", said[2]);
}
