//! The program as its user meets it: exit codes, what is said and where, what is written and what is not.

mod backends;
mod bipeds;
mod campaign_files;
mod campaign_plans;
mod chatter;
mod compare;
mod encodings;
mod gains;
mod groups;
mod help;
mod integrity;
mod junit;
mod kept;
mod new;
mod notes;
mod output;
mod parts;
mod results;
mod robot;
mod sensors;
mod settings;
mod shards;
mod slurm;
mod terminal;
mod traces;
mod tune;
mod usage;

use crate::common::repository;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// A folder with the campaign c.toml in it, where the program runs.
struct Place(TempDir);

/// How the program ended.
struct Ended {
    code: i32,
    stdout: String,
    stderr: String,
}

/// The smoke campaign with three episodes and parts of its text replaced; each part must be there.
fn smoke(changes: &[(&str, &str)]) -> String {
    let mut text = fs::read_to_string(repository("campaigns/smoke.toml")).unwrap();
    for (old, new) in [("episodes = 32", "episodes = 3")].iter().chain(changes) {
        assert!(text.contains(old), "smoke.toml does not contain {old:?}");
        text = text.replace(old, new);
    }
    text
}

impl Place {
    fn with(text: &str) -> Self {
        let place = Self(TempDir::new().unwrap());
        place.write("c.toml", text);
        place
    }

    fn smoke(changes: &[(&str, &str)]) -> Self {
        Self::with(&smoke(changes))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn read_bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_urts-mc"));
        command.current_dir(self.0.path()).args(arguments);
        // What these tests hold is the same on a machine with a GPU; those of the GPU name it.
        let simulates = ["run", "tune"].contains(arguments.first().unwrap_or(&""));
        if simulates && !arguments.contains(&"--backend") {
            command.args(["--backend", "cpu"]);
        }
        command
    }

    fn program(&self, arguments: &[&str]) -> Ended {
        let output = self.command(arguments).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Ended {
            code: output.status.code().unwrap_or(-1),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }

    /// What the program printed; it must have succeeded and found nothing to say on standard error.
    fn succeeds(&self, arguments: &[&str]) -> String {
        let Ended {
            code,
            stdout,
            stderr,
        } = self.program(arguments);
        assert_eq!((code, stderr.as_str()), (0, ""), "{arguments:?}");
        assert!(!stdout.is_empty(), "{arguments:?}");
        stdout
    }

    /// As [`Place::succeeds`], as JSON.
    fn json(&self, arguments: &[&str]) -> serde_json::Value {
        serde_json::from_str(&self.succeeds(arguments)).unwrap()
    }

    /// What the program said; it must have refused with this code and these words, printed nothing and changed nothing.
    fn refuses(&self, arguments: &[&str], code: i32, words: &[&str]) -> String {
        let before = self.everything();
        let ended = self.program(arguments);
        let said = ended.stderr;
        assert_eq!(ended.code, code, "{arguments:?} said: {said}");
        assert_eq!(ended.stdout, "", "{arguments:?}");
        assert!(said.starts_with("error: "), "{said}");
        let parts: Vec<&str> = said.split([':', ';']).map(str::trim).collect();
        for (k, part) in parts.iter().enumerate().filter(|(_, part)| part.len() > 12) {
            let again = |(other, text): (usize, &&str)| other != k && text.contains(part);
            assert!(!parts.iter().enumerate().any(again), "said twice: {said}");
        }
        assert_eq!(said.matches("error: ").count(), 1, "said twice: {said}");
        for word in words {
            assert!(
                said.contains(word),
                "{arguments:?}: {word:?} is missing from: {said}"
            );
        }
        assert_eq!(
            self.everything().keys().collect::<Vec<_>>(),
            before.keys().collect::<Vec<_>>()
        );
        assert!(self.everything() == before, "{arguments:?} changed a file");
        said
    }

    /// Every file and folder with its content, hidden ones too.
    fn everything(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        fn add(dir: &Path, all: &mut BTreeMap<PathBuf, Vec<u8>>) {
            for entry in fs::read_dir(dir).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    add(&path, all);
                    all.insert(path, Vec::new());
                } else {
                    let content = fs::read(&path).unwrap();
                    all.insert(path, content);
                }
            }
        }
        let mut all = BTreeMap::new();
        add(self.0.path(), &mut all);
        all
    }

    /// The rows of a CSV file, by column.
    fn rows(&self, name: &str) -> Vec<BTreeMap<String, String>> {
        let text = self.read(name);
        let mut lines = text.lines();
        let header: Vec<&str> = lines.next().unwrap().split(',').collect();
        lines
            .map(|line| {
                let cells: Vec<&str> = line.split(',').collect();
                assert_eq!(cells.len(), header.len(), "{line}");
                let own = |text: &&str| (*text).to_string();
                header.iter().map(own).zip(cells.iter().map(own)).collect()
            })
            .collect()
    }
}
