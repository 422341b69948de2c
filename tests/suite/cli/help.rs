//! Help and completions.

use super::Place;
use crate::common::repository;
use std::fs;
use std::path::Path;
use std::process::Command;

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

/// What bash makes of a line with the script in urts-mc.bash.
fn bash_completes(place: &Place, line: &str) -> Vec<String> {
    let script = r#"
        source urts-mc.bash || exit
        COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
        function=$(complete -p urts-mc) && function=${function##*-F } && function=${function%% *}
        "$function" urts-mc "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}" || exit
        printf '%s\n' "${COMPREPLY[@]}"
    "#;
    let ended = Command::new("bash")
        .current_dir(place.0.path())
        .args(["--norc", "-c", script, "bash"])
        .args(line.split(' '))
        .output()
        .unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert!(ended.status.success() && said.is_empty(), "{line}: {said}");
    let completed = String::from_utf8(ended.stdout).unwrap();
    completed.lines().map(String::from).collect()
}

#[test]
fn no_line_of_the_help_is_wider_than_a_terminal() {
    let place = Place::smoke(&[]);
    let mut helps = vec![place.succeeds(&["--help"])];
    for command in commands(&place) {
        helps.push(place.succeeds(&[&command, "--help"]));
    }
    for line in helps.iter().flat_map(|help| help.lines()) {
        assert!(line.chars().count() <= 100, "{line}");
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
        assert!((1..=4).contains(&examples.len()), "{help}");
        for example in examples {
            let line = example.split(" > ").next().unwrap();
            // Every second part is in single quotes: one word, whatever is in it.
            let parts = line.split('\'').enumerate();
            let words = parts.flat_map(|(place, part)| match place % 2 {
                0 => part.split_whitespace().collect::<Vec<_>>(),
                _ => vec![part],
            });
            let mut words = words.into_iter();
            assert_eq!(words.next(), Some("urts-mc"), "{example}");
            let ended = place.program(&words.collect::<Vec<_>>());
            assert_eq!((ended.code, &*ended.stderr), (0, ""), "{example}");
        }
    }
}

#[test]
fn completions_of_every_shell_know_every_command_and_bash_completes_with_its_own() {
    let place = Place::smoke(&[]);
    let commands = commands(&place);
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = place.succeeds(&["completions", shell]);
        for word in commands.iter().map(String::as_str).chain(["episodes"]) {
            assert!(script.contains(word), "{word} is missing for {shell}");
        }
        if shell == "bash" {
            place.write("urts-mc.bash", script);
        }
    }
    if Command::new("bash").arg("--version").output().is_err() {
        println!("SKIPPED: no bash");
        return;
    }
    for (line, completed) in [
        ("urts-mc pap", &["paper"] as &[_]),
        ("urts-mc run --ba", &["--backend"]),
        ("urts-mc run --backend ", &["auto", "gpu", "cpu"]),
        ("urts-mc run c.toml --simd avx", &["avx2", "avx512"]),
        ("urts-mc replay out --epi", &["--episode"]),
        ("urts-mc synthesize --preset b", &["biped-paper"]),
    ] {
        assert_eq!(bash_completes(&place, line), completed, "{line}");
    }
    place.refuses(&["completions", "tcsh"], 2, &["'tcsh'", "bash", "fish"]);
}
