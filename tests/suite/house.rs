//! The layout of the sources: rooms in the order of `lib.rs`, arrows downwards only, no circles, files and functions of
//! a size that can be read at once. What breaks a rule is named with its place.

mod graph;

use crate::common::repository;
use graph::Graph;
use std::fs;
use std::path::{Path, PathBuf};

/// Rooms of the library and the program's own.
const MOST_ROOMS: usize = 16;
const MOST_LINES_OF_A_FILE: usize = 450;
const MOST_LINES_OF_A_FUNCTION: usize = 80;
/// Columns of a comment.
const WIDEST_COMMENT: usize = 120;
/// Unrolled arithmetic says with these words, in the lines before it, why it is in one piece.
const EXCUSE: &str = "in one piece";

/// A source file: its module path (`["model", "episode"]`) and its text.
#[derive(Clone)]
struct Source {
    module: Vec<String>,
    path: PathBuf,
    text: String,
}

#[test]
fn the_rooms_are_at_most_sixteen_and_use_only_those_before_them() {
    let rooms = rooms();
    assert!(
        rooms.len() <= MOST_ROOMS,
        "{} rooms: {rooms:?}",
        rooms.len()
    );
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
    let uses = |room: &str| {
        sources
            .iter()
            .any(|source| imports(source).any(|path| path[0] == room))
    };
    assert!(uses("util") && uses("campaign") && uses("results"));
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
    let mut wrong = Vec::new();
    for source in sources() {
        let place = source.path.display();
        let lines: Vec<&str> = source.text.lines().collect();
        if lines.len() > MOST_LINES_OF_A_FILE {
            wrong.push(format!("{place}: {} lines", lines.len()));
        }
        for (number, line) in lines.iter().enumerate() {
            let is_comment = line.trim_start().starts_with("//");
            // What has no place to break is an address or a table's row.
            let breaks = !line.contains("http") && !line.trim_start().starts_with("//! |");
            if is_comment && breaks && line.chars().count() > WIDEST_COMMENT {
                wrong.push(format!(
                    "{place}:{}: a comment of {} columns",
                    number + 1,
                    line.chars().count()
                ));
            }
        }
        for (first, length) in functions(&lines) {
            let before = lines[first.saturating_sub(12)..first].iter();
            let excused = before
                .rev()
                .take_while(|line| !line.starts_with('}'))
                .any(|line| line.to_lowercase().contains(EXCUSE));
            if length > MOST_LINES_OF_A_FUNCTION && !excused {
                wrong.push(format!(
                    "{place}:{}: a function of {length} lines",
                    first + 1
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
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

/// What of the crate a file names outside of comments: paths from the root, at least the room.
fn imports(source: &Source) -> impl Iterator<Item = Vec<String>> + '_ {
    let lines = source
        .text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    lines.flat_map(|line| {
        ["crate::", "urts_mc::"].into_iter().flat_map(move |root| {
            line.match_indices(root).flat_map(move |(at, _)| {
                let rest = &line[at + root.len()..];
                let names: Vec<&str> = match rest.strip_prefix('{') {
                    // One level of braces at the root: the first name of each of its parts.
                    Some(list) => list.split(',').collect(),
                    None => vec![rest],
                };
                names
                    .into_iter()
                    .filter_map(first_names)
                    .collect::<Vec<_>>()
            })
        })
    })
}

/// The names of a path that begins a text.
fn first_names(text: &str) -> Option<Vec<String>> {
    let end = text
        .trim_start()
        .find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
    let path = &text.trim_start()[..end.unwrap_or(text.trim_start().len())];
    let names: Vec<String> = path
        .split("::")
        .filter(|name| !name.is_empty())
        .map(String::from)
        .collect();
    (!names.is_empty()).then_some(names)
}

/// The arrows of a file that lead to a room after its own.
fn upward(rooms: &[String], source: &Source) -> Vec<String> {
    let place = |name: &str| rooms.iter().position(|room| room == name);
    let own = place(&source.module[0]);
    imports(source)
        .filter(|path| place(&path[0]) > own)
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
            line.strip_prefix(indent)
                .is_some_and(|rest| !rest.starts_with([' ', ')']))
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
