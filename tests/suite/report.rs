//! The report of a run: what it says, and what a browser makes of it.

mod brief;
mod browser;
mod paper;

use crate::common::{repository, settings, without_hash};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// The directory of a run, which is removed with it.
struct Run {
    _place: TempDir,
    dir: PathBuf,
}

impl Run {
    /// Simulates a shipped campaign with changes laid over it.
    fn of(name: &str, episodes: u32, changes: &[&str]) -> Self {
        let place = TempDir::new().unwrap();
        let campaign = place.path().join("c.toml");
        fs::copy(repository(&format!("campaigns/{name}.toml")), &campaign).unwrap();
        let dir = place.path().join("out");
        let episodes = episodes.to_string();
        let mut arguments = vec![
            "run",
            campaign.to_str().unwrap(),
            "--backend",
            "cpu",
            "--quiet",
            "--episodes",
            &episodes,
            "--out",
            dir.to_str().unwrap(),
        ];
        let overlay: Vec<String> = settings(changes).into_iter().map(String::from).collect();
        for setting in &overlay {
            arguments.extend(["--set", setting]);
        }
        let ended = program(&arguments);
        // A requirement may not hold.
        assert!([0, 4].contains(&ended.0), "{}", ended.1);
        Self { _place: place, dir }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.join(name)
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }
}

/// Exit code and what was said on standard error.
fn program(arguments: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_urts-mc"))
        .args(arguments)
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    (output.status.code().unwrap_or(-1), said)
}

/// A run without limits that any episode keeps to: every episode of every controller fails.
fn all_failed() -> Run {
    Run::of("smoke", 4, &["verdict.max_error=1e-6"])
}

/// The rows of a CSV file, by column.
fn rows(text: &str) -> Vec<std::collections::HashMap<String, String>> {
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|line| {
            let cells = line.split(',').map(String::from);
            head.iter().map(ToString::to_string).zip(cells).collect()
        })
        .collect()
}

/// A number of everyday size with four digits that count.
fn four_digits(value: f64) -> String {
    let decimals = (3.0 - value.log10().floor()) as usize;
    format!("{value:.decimals$}")
}

#[test]
fn a_report_says_what_the_tables_say() {
    let run = Run::of("smoke", 12, &[]);
    let brief = run.read("report.md");
    urts_mc::report::report(&run.dir, urts_mc::report::Length::Full).unwrap();
    let (html, markdown) = (run.read("report.html"), run.read("report.md"));
    // In brief it is what a comment on a pull request holds, and says so.
    assert!(brief.len() < 65_536 && brief.len() < markdown.len());
    assert!(brief.ends_with("In brief: the HTML report has the whole.\n"));
    for row in rows(&run.read("summary.csv")) {
        if row["metric"] != "rmse" || row["group"] != "position" || row["stratum"] != "all" {
            continue;
        }
        let counts = format!("{} of {}", row["failed"], row["n"]);
        assert!(html.contains(&counts), "{counts}");
        // A line of the table in Markdown holds the whole row.
        let line = markdown
            .lines()
            .find(|line| {
                line.starts_with(&format!("| {} | ", row["controller"])) && line.contains(" of ")
            })
            .unwrap();
        assert!(line.contains(&counts), "{line}");
        let rate: f64 = row["failure_rate"].parse().unwrap();
        assert!(line.contains(&format!("{:.1}", 100.0 * rate)), "{line}");
        let median: f64 = row["q50"].parse().unwrap();
        assert!(
            html.contains(&format!("{} [", four_digits(median))),
            "{median}"
        );
    }
    for row in rows(&run.read("comparison.csv")) {
        if row["scope"] == "group" && row["stratum"] == "all" {
            let ratio: f64 = row["ratio"].parse().unwrap();
            let shown = format!("{} [", four_digits(ratio));
            assert!(html.contains(&shown), "{shown}");
        }
    }
    for row in rows(&run.read("worst.csv")) {
        let (episode, controller) = (&row["episode"], &row["controller"]);
        let command = format!("--episode {episode} --controller {controller}");
        assert!(
            html.contains(&command) && markdown.contains(&command),
            "{command}"
        );
    }
    for word in [
        "seed",
        "BLAKE3",
        "certified attenuation",
        "survival",
        "controllers = ",
    ] {
        assert!(html.contains(word), "{word}");
    }
    assert!(!html.contains("<script") && !html.contains("NaN"));
}

#[test]
fn a_report_is_made_again_from_the_directory_alone() {
    let run = Run::of("smoke", 3, &[]);
    let before = [run.read("report.html"), run.read("report.md")];
    for name in ["report.html", "report.md"] {
        fs::remove_file(run.path(name)).unwrap();
    }
    fs::remove_file(run.dir.parent().unwrap().join("c.toml")).unwrap();
    let dir = run.dir.to_str().unwrap();
    assert_eq!(program(&["report", dir]), (0, String::new()));
    assert_eq!([run.read("report.html"), run.read("report.md")], before);
}

#[test]
fn a_report_of_no_run_names_what_is_missing() {
    let run = Run::of("smoke", 2, &[]);
    let dir = run.dir.to_str().unwrap();
    fs::remove_file(run.path("channels.parquet")).unwrap();
    let (code, said) = program(&["report", dir]);
    assert_eq!(code, 2);
    assert!(
        said.contains("channels.parquet: is not the file that the run wrote (No such file"),
        "{said}"
    );
    fs::write(run.path("channels.parquet"), "no table").unwrap();
    let (code, said) = program(&["report", dir]);
    assert_eq!(code, 2);
    assert!(said.contains("channels.parquet: "), "{said}");
    fs::remove_file(run.path("manifest.json")).unwrap();
    let (code, said) = program(&["report", dir]);
    assert_eq!(code, 2);
    assert!(said.contains("manifest.json"), "{said}");
}

#[test]
fn a_report_of_a_run_in_which_all_fails_says_so() {
    let run = all_failed();
    let markdown = run.read("report.md");
    assert!(markdown.contains("4 of 4"), "{markdown}");
    assert!(!markdown.contains("| 0 of 4"), "{markdown}");
    assert!(!run.read("report.html").contains("NaN"));
}

#[test]
fn a_run_of_an_older_version_has_a_report_without_the_pictures_that_it_has_no_points_of() {
    let run = Run::of("smoke", 3, &[]);
    assert!(run.read("report.html").contains(">survival<"));
    let manifest = without_hash(&run.read("manifest.json"));
    let mut older: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    older.as_object_mut().unwrap().remove("files");
    fs::write(run.path("manifest.json"), older.to_string()).unwrap();
    fs::remove_file(run.path("curves.parquet")).unwrap();
    assert_eq!(program(&["report", run.dir.to_str().unwrap()]).0, 0);
    let html = run.read("report.html");
    // Without points, nobody would seem to fail.
    assert!(!html.contains(">survival<"));
    assert!(html.contains("A run of an older version has no curves to be drawn: run it again."));
}

#[test]
fn a_report_of_an_interrupted_run_begins_with_what_is_missing() {
    let run = Run::of("smoke", 3, &[]);
    assert!(!run.read("report.html").contains("role=\"alert\""));
    let manifest = without_hash(&run.read("manifest.json"));
    let cut = manifest
        .replace("\"episodes_asked\": 3", "\"episodes_asked\": 8")
        .replace(
            "\"interrupted\": null",
            "\"interrupted\": \"the GPU is <gone>\"",
        );
    assert_ne!(cut, manifest);
    fs::write(run.path("manifest.json"), cut).unwrap();
    assert_eq!(program(&["report", run.dir.to_str().unwrap()]).0, 0);
    let html = run.read("report.html");
    let alert = html.split("role=\"alert\"").nth(1).unwrap();
    let alert = alert.split("</p>").next().unwrap();
    // Whatever a message contains, it is text.
    assert!(
        alert.contains("the GPU is &lt;gone&gt;; the 3 of 8 episodes"),
        "{alert}"
    );
    assert!(run.read("report.md").contains("3 of 8 episodes"));
}

/// A file as an address.
fn address(path: &Path) -> String {
    format!("file://{}", path.display())
}
