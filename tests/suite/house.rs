//! The layout of the sources: rooms in the order of `lib.rs`, arrows downwards only, no circles, files and functions of
//! a size that can be read at once. What breaks a rule is named with its place.

mod graph;

use crate::common::repository;
use graph::{Graph, uses};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Rooms of the library and the program's own.
const MOST_ROOMS: usize = 17;
const MOST_LINES_OF_A_FILE: usize = 450;
const MOST_LINES_OF_A_FUNCTION: usize = 80;
/// Columns of a comment.
const WIDEST_COMMENT: usize = 120;
/// Arithmetic that is compared with its twin statement by statement says with these words, in the lines before it, why
/// it is not split.
const EXCUSE: &str = "in one piece";

/// A source file: its module path (`["model", "episode"]`) and its text.
#[derive(Clone)]
struct Source {
    module: Vec<String>,
    path: PathBuf,
    text: String,
}

#[test]
fn the_rooms_are_at_most_seventeen_and_use_only_those_before_them() {
    let rooms = rooms();
    assert!(
        rooms.len() <= MOST_ROOMS,
        "{} rooms: {rooms:?}",
        rooms.len()
    );
    // What is listed is what there is.
    let folders = fs::read_dir(repository("src")).unwrap();
    let folders = folders.map(|entry| entry.unwrap().path());
    let folders = folders.filter(|path| path.is_dir());
    let name = |path: PathBuf| path.file_name().unwrap().display().to_string();
    let there: BTreeSet<String> = folders.map(name).collect();
    assert_eq!(there, rooms.iter().cloned().collect());
    let sources = sources();
    let upward: Vec<String> = sources
        .iter()
        .flat_map(|source| upward(&rooms, source))
        .collect();
    assert!(
        upward.is_empty(),
        "arrows that lead upwards:\n{}",
        upward.join("\n")
    );
    // The text is really read: the higher rooms use the ground floor.
    let used = |room: &str| {
        let of_room = |path: &Vec<String>| path.first().is_some_and(|first| first == room);
        sources
            .iter()
            .any(|source| uses(source, &BTreeSet::new()).iter().any(of_room))
    };
    assert!(used("util") && used("campaign") && used("results"));
}

#[test]
fn an_arrow_that_leads_upwards_would_be_noticed() {
    let rooms: Vec<String> = ["agent", "campaign", "cli"].map(String::from).to_vec();
    let source = |text: &str| Source {
        module: vec!["agent".into(), "robot".into()],
        path: PathBuf::from("src/agent/robot.rs"),
        text: text.into(),
    };
    for text in [
        "use crate::campaign::Campaign;",
        "    let campaign = crate::campaign::load();",
        "use crate::{agent::Uav, campaign::Campaign};",
        "use crate::{\n    agent::Uav,\n    campaign::{Campaign},\n};",
    ] {
        assert_eq!(upward(&rooms, &source(text)).len(), 1, "{text}");
    }
    for text in [
        "use crate::agent::Uav;",
        "//! See [`crate::campaign`].",
        "use super::Uav;",
    ] {
        assert!(upward(&rooms, &source(text)).is_empty(), "{text}");
    }
}

#[test]
fn no_file_uses_another_that_uses_it_again() {
    let graph = Graph::new(&sources());
    assert!(graph.arrows() > 300, "{} arrows", graph.arrows());
    let circles = graph.circles();
    assert!(
        circles.is_empty(),
        "arrows of circles:\n{}",
        circles.join("\n")
    );
}

#[test]
fn a_circle_of_files_would_be_noticed() {
    let source = |module: &[&str], text: &str| Source {
        module: module.iter().map(ToString::to_string).collect(),
        path: PathBuf::new(),
        text: text.into(),
    };
    let parent = |text| source(&["agent"], text);
    let child = |text| source(&["agent", "robot"], text);
    let other = source(&["agent", "leg"], "pub struct Leg;");
    let circles = |parent, child| Graph::new(&[parent, child, other.clone()]).circles().len();
    // Each uses what the other defines.
    let uses = "mod robot;\nuse robot::Robot;\npub struct Uav(Robot);";
    assert_eq!(circles(parent(uses), child("use super::Uav;")), 2);
    assert_eq!(
        circles(
            parent("fn f() { robot::load() }"),
            child("fn g() { super::f() }")
        ),
        2
    );
    assert_eq!(
        circles(
            parent("pub use robot::Robot;\npub struct Uav(Robot);"),
            child("use crate::agent::{Uav};")
        ),
        2
    );
    assert_eq!(
        circles(
            parent("use robot::*;\npub struct Uav;"),
            child("use super::Uav;")
        ),
        2
    );
    // A name that is passed on leads past the parent.
    let passes_on = "mod leg;\nmod robot;\npub use leg::Leg;\npub use robot::Robot;";
    assert_eq!(
        circles(
            parent(passes_on),
            child("use super::Leg;\n/// [`super::Robot`]\npub struct Robot;")
        ),
        0
    );
}

#[test]
fn every_shader_names_the_source_that_it_is_the_twin_of() {
    let shaders = files(&repository("shaders"), "wgsl");
    assert!(shaders.len() > 10);
    for path in shaders {
        let text = fs::read_to_string(&path).unwrap();
        let head: String = text
            .lines()
            .take_while(|line| line.starts_with("//"))
            .collect();
        let named: Vec<&str> = head
            .split(|c: char| c.is_whitespace() || ":,;".contains(c))
            .filter(|word| word.starts_with("src/"))
            .collect();
        assert!(!named.is_empty(), "{}: names no source", path.display());
        for source in named {
            assert!(
                repository(source).is_file(),
                "{}: no file {source}",
                path.display()
            );
        }
    }
}

#[test]
fn files_functions_and_comments_have_a_size_that_can_be_read_at_once() {
    let (mut wrong, mut seen) = (Vec::new(), 0);
    for source in sources() {
        let place = source.path.display().to_string();
        seen += functions(&source.text.lines().collect::<Vec<_>>()).len();
        wrong.extend(too_long(&place, &source.text));
        wrong.extend(too_wide(&place, &source.text, "//"));
    }
    assert!(seen > 500, "{seen} functions");
    let tests = ["tests", "shaders"].map(repository);
    let others = tests.iter().flat_map(|folder| {
        let wgsl = files(folder, "wgsl");
        files(folder, "rs").into_iter().chain(wgsl)
    });
    let others = others.map(|path| (path, "//"));
    let scripts = [".ci/run", "tests/run", "Cargo.toml", ".cargo/deny.toml"];
    let scripts = scripts.map(|path| (repository(path), "#"));
    for (path, mark) in others.chain(scripts) {
        let text = fs::read_to_string(&path).unwrap();
        wrong.extend(too_wide(&path.display().to_string(), &text, mark));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_cannot_be_read_at_once_would_be_noticed() {
    let function = |lines: usize| {
        format!(
            "fn f(\n    a: f64,\n) {{\n{}}}\n",
            "    g();\n".repeat(lines - 4)
        )
    };
    assert!(too_long("f", &function(80)).is_empty());
    assert_eq!(too_long("f", &function(81)).len(), 1);
    let within_where = function(81).replace(") {", ")\nwhere\n    f64: Copy,\n{");
    assert_eq!(too_long("f", &within_where).len(), 1);
    let excused = format!("// In one piece: as its twin.\n{}", function(81));
    assert!(too_long("f", &excused).is_empty());
    assert_eq!(too_long("f", &"\n".repeat(451)).len(), 1);
    let comment = |columns: usize| format!("    // {}\n", "a".repeat(columns - 7));
    assert!(too_wide("f", &comment(120), "//").is_empty());
    assert_eq!(too_wide("f", &comment(121), "//").len(), 1);
}

/// What of a file is longer than can be read at once.
fn too_long(place: &str, text: &str) -> Vec<String> {
    let lines: Vec<&str> = text.lines().collect();
    let mut wrong = Vec::new();
    if lines.len() > MOST_LINES_OF_A_FILE {
        wrong.push(format!("{place}: {} lines", lines.len()));
    }
    for (first, length) in functions(&lines) {
        let before = lines[first.saturating_sub(12)..first].iter();
        let excused = before
            .rev()
            .take_while(|line| !line.starts_with('}'))
            .any(|line| line.to_lowercase().contains(EXCUSE));
        if length > MOST_LINES_OF_A_FUNCTION && !excused {
            let line = first + 1;
            wrong.push(format!("{place}:{line}: a function of {length} lines"));
        }
    }
    wrong
}

/// The comments of a file that are wider than [`WIDEST_COMMENT`]. What has no place to break is an address or a table's
/// row.
fn too_wide(place: &str, text: &str, mark: &str) -> Vec<String> {
    let comments = text.lines().enumerate().filter(|(_, line)| {
        let line = line.trim_start();
        line.starts_with(mark) && !line.contains("http") && !line.starts_with("//! |")
    });
    let wide = comments.map(|(number, line)| (number + 1, line.chars().count()));
    wide.filter(|(_, columns)| *columns > WIDEST_COMMENT)
        .map(|(number, columns)| format!("{place}:{number}: a comment of {columns} columns"))
        .collect()
}

/// The rooms in their order: the modules of `lib.rs`, then the program's.
fn rooms() -> Vec<String> {
    let text = fs::read_to_string(repository("src/lib.rs")).unwrap();
    let listed = text
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    listed.chain(["cli"]).map(String::from).collect()
}

/// All sources in the rooms.
fn sources() -> Vec<Source> {
    let root = repository("src");
    let paths = files(&root, "rs").into_iter();
    let inside = paths.filter(|path| path.parent() != Some(&root));
    inside
        .map(|path| {
            let within = path.strip_prefix(&root).unwrap().with_extension("");
            let mut module: Vec<String> = within
                .iter()
                .map(|part| part.display().to_string())
                .collect();
            module.retain(|part| part != "mod");
            Source {
                module,
                text: fs::read_to_string(&path).unwrap(),
                path,
            }
        })
        .collect()
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.extension().is_some_and(|own| own == ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The arrows of a file that lead to a room after its own.
fn upward(rooms: &[String], source: &Source) -> Vec<String> {
    let place = |name: &str| rooms.iter().position(|room| room == name);
    let own = place(&source.module[0]);
    uses(source, &BTreeSet::new())
        .into_iter()
        .filter(|path| path.first().is_some_and(|room| place(room) > own))
        .map(|path| format!("{}: {}", source.path.display(), path.join("::")))
        .collect()
}

/// First lines (from 0) and lengths of the functions of a file: from the line with `fn` to the brace in its column.
fn functions(lines: &[&str]) -> Vec<(usize, usize)> {
    let begins = |line: &str| {
        let line = line.trim_start();
        let words: Vec<&str> = line.split_whitespace().collect();
        let known = |word: &&str| {
            word.starts_with("pub")
                || ["const", "unsafe", "extern", "\"C\"", "async"].contains(word)
        };
        words
            .iter()
            .find(|word| !known(word))
            .is_some_and(|word| *word == "fn")
    };
    let mut found = Vec::new();
    for (first, line) in lines.iter().enumerate().filter(|(_, line)| begins(line)) {
        let indent = &line[..line.len() - line.trim_start().len()];
        let in_column = |line: &&str| {
            let rest = line.strip_prefix(indent).unwrap_or(" ");
            !rest.starts_with([' ', ')', '>', '{']) && rest != "where"
        };
        // A function without a body, or with one on its own line, ends there.
        let after = lines[first + 1..]
            .iter()
            .position(|line| in_column(line) && !line.is_empty());
        if !line.ends_with([';', '}'])
            && after.is_some_and(|after| lines[first + 1 + after].trim() == "}")
        {
            found.push((first, after.unwrap_or_default() + 2));
        }
    }
    found
}
