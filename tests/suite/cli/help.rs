//! Help and completions.

use super::Place;
use crate::common::repository;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// The commands that the help lists.
fn commands(place: &Place) -> Vec<String> {
    let help = place.succeeds(&["--help"]);
    let listed = help.split("Commands:\n").nth(1).unwrap();
    let names = listed.lines().take_while(|line| !line.is_empty());
    let names = names.map(|line| line.split_whitespace().next().unwrap().to_string());
    let names: Vec<String> = names.filter(|name| name != "help").collect();
    assert!(names.len() >= 8, "{help}");
    names
}

fn examples(help: &str) -> Vec<&str> {
    let listed = help.split("Examples:\n").nth(1).unwrap_or_default();
    let lines = listed.lines().take_while(|line| line.starts_with("  "));
    lines.map(str::trim).collect()
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

#[test]
fn every_example_of_the_help_works_where_the_campaigns_are() {
    let place = Place::smoke(&[]);
    copy(&repository("campaigns"), &place.path("campaigns"));
    let mut helps = vec![place.succeeds(&["--help"])];
    for command in commands(&place) {
        helps.push(place.succeeds(&[&command, "--help"]));
    }
    // In the order of the commands: a run is there before it is replayed.
    for help in &helps {
        let examples = examples(help);
        assert!((1..=3).contains(&examples.len()), "{help}");
        for example in examples {
            let line = example.split(" > ").next().unwrap();
            let mut words = line.split_whitespace();
            assert_eq!(words.next(), Some("urts-mc"), "{example}");
            let ended = place.program(&words.collect::<Vec<_>>());
            assert_eq!((ended.code, &*ended.stderr), (0, ""), "{example}");
        }
    }
}

#[test]
fn completions_of_every_shell_know_every_command_and_bash_accepts_its_own() {
    let place = Place::smoke(&[]);
    let commands = commands(&place);
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = place.succeeds(&["completions", shell]);
        for word in commands.iter().map(String::as_str).chain(["episodes"]) {
            assert!(script.contains(word), "{word} is missing for {shell}");
        }
        if shell == "bash" {
            let checked = Command::new("bash").arg("-n").stdin(Stdio::piped()).spawn();
            let Ok(mut bash) = checked else {
                println!("SKIPPED: no bash");
                continue;
            };
            let mut input = bash.stdin.take().unwrap();
            std::io::Write::write_all(&mut input, script.as_bytes()).unwrap();
            drop(input);
            assert!(bash.wait().unwrap().success());
            // What a user who presses the tabulator is offered.
            for (words, offered) in [
                ("run c.toml --ba", "--backend"),
                ("run c.toml --backend g", "gpu"),
                ("replay out --contr", "--controller"),
            ] {
                let count = words.split(' ').count();
                let press = format!(
                    "{script}\nCOMP_WORDS=(urts-mc {words}); COMP_CWORD={count}\n\
                     _urts__mc urts-mc \"${{COMP_WORDS[$COMP_CWORD]}}\" \"${{COMP_WORDS[$((COMP_CWORD-1))]}}\"\n\
                     echo \"${{COMPREPLY[@]}}\"\n"
                );
                let told = Command::new("bash").args(["-c", &press]).output().unwrap();
                let told = String::from_utf8_lossy(&told.stdout).into_owned();
                assert_eq!(told.trim(), offered, "{words}");
            }
        }
    }
    place.refuses(&["completions", "tcsh"], 2, &["'tcsh'", "bash", "fish"]);
}
