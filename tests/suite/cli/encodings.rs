//! Files as editors leave them: what is no UTF-8 is said with how to mend it, and a byte order mark is no error.

use super::{Place, smoke};
use crate::common::repository;
use std::fs;

/// A text in UTF-16, little endian with its mark.
fn utf_16(text: &str) -> Vec<u8> {
    let units = std::iter::once(0xfeff).chain(text.encode_utf16());
    units.flat_map(u16::to_le_bytes).collect()
}

#[test]
fn utf_16_and_latin_1_are_told_apart_and_a_byte_order_mark_is_no_error() {
    let place = Place::smoke(&[]);
    let text = smoke(&[]);
    place.write("c.toml", utf_16(&text));
    place.refuses(
        &["check", "c.toml"],
        2,
        &["c.toml", "it is UTF-16; save it as UTF-8"],
    );
    let mut latin_1 = b"# one\n# two\n# gr".to_vec();
    latin_1.extend([0xf6, 0xdf]);
    latin_1.extend(format!("e\n{text}").bytes());
    place.write("c.toml", latin_1);
    let words = "it is no UTF-8: the byte 0xF6 in line 3 looks like Latin-1; save it as UTF-8";
    place.refuses(&["check", "c.toml"], 2, &["c.toml", words]);
    place.write("c.toml", format!("\u{feff}{text}"));
    place.succeeds(&["check", "c.toml"]);
    // Gains and robots alike.
    let gains = fs::read_to_string(repository("tests/golden/gains-uav-paper.json")).unwrap();
    let own = "preset = \"uav-paper\"\ngains = \"own.json\"";
    let replaced = [
        ("preset = \"uav-paper\"", own),
        ("[\"ftc\", \"pid\", \"pid-tuned\"]", "[\"ftc\", \"pid\"]"),
    ];
    place.write("c.toml", smoke(&replaced));
    place.write("own.json", format!("\u{feff}{gains}"));
    place.succeeds(&["check", "c.toml"]);
    place.write("own.json", utf_16(&gains));
    place.refuses(
        &["check", "c.toml"],
        2,
        &["own.json", "it is UTF-16; save it as UTF-8"],
    );
    let walk = fs::read_to_string(repository("campaigns/biped-ground-reaction.toml")).unwrap();
    place.write(
        "w.toml",
        walk.replace("[agent]", "[agent]\nrobot = \"own.toml\""),
    );
    let robot = fs::read_to_string(repository("campaigns/robots/g1_12dof.toml")).unwrap();
    place.write("own.toml", format!("\u{feff}{robot}"));
    assert_eq!(place.program(&["check", "w.toml"]).code, 0);
    place.write("own.toml", utf_16(&robot));
    place.refuses(
        &["check", "w.toml"],
        2,
        &["own.toml", "it is UTF-16; save it as UTF-8"],
    );
}

#[test]
fn an_error_quotes_no_more_of_a_line_than_can_be_read() {
    let long = format!("name = \"smoke\"\nodd = [{}]\n", "1, ".repeat(5_000));
    let place = Place::smoke(&[("name = \"smoke\"\n", &long)]);
    let ended = place.program(&["check", "c.toml"]);
    assert_eq!(ended.code, 2);
    assert!(
        ended.stderr.contains("unknown key `odd`"),
        "{}",
        ended.stderr
    );
    let quoted = ended.stderr.lines().filter(|line| line.contains(" | "));
    let longest = quoted.map(|line| line.chars().count()).max();
    assert!(longest.unwrap() <= 210, "{}", ended.stderr);
}

#[test]
fn a_remedy_is_not_refused_again() {
    for (old, new, words) in [
        (
            "duration_s = 6.0",
            "duration_s = 1e308",
            "an episode has at most",
        ),
        (
            "step_s = 0.002",
            "step_s = 1e-300",
            "an episode has at most",
        ),
        ("step_s = 0.002", "step_s = 0.0007", "use "),
    ] {
        let place = Place::smoke(&[(old, new)]);
        let ended = place.program(&["check", "c.toml"]);
        assert_eq!(ended.code, 2);
        assert!(ended.stderr.contains(words), "{}", ended.stderr);
        assert!(!ended.stderr.contains("inf"), "{}", ended.stderr);
        let Some((_, remedy)) = ended.stderr.split_once("; use ") else {
            assert!(
                ended.stderr.contains("shorten it or take longer steps"),
                "{}",
                ended.stderr
            );
            continue;
        };
        let step = remedy.split(' ').next().unwrap();
        let place = Place::smoke(&[(old, &format!("step_s = {step}"))]);
        place.succeeds(&["check", "c.toml"]);
    }
}

#[test]
fn channels_have_names_and_adapters_numbers() {
    let place = Place::smoke(&[
        ("channels = \"one\"", "channels = [\"z\", \"yaw\"]"),
        ("probability = 0.25", "probability = 1.0"),
    ]);
    place.succeeds(&["run", "c.toml", "--out", "out", "--csv"]);
    let named = place.read("out/faults.csv");
    let named: Vec<&str> = named
        .lines()
        .filter(|line| line.contains(",actuator,"))
        .collect();
    assert!(
        !named.is_empty() && named.iter().all(|line| line.contains(",z yaw,")),
        "{named:?}"
    );
    let numbered = Place::smoke(&[
        ("channels = \"one\"", "channels = [3, 6]"),
        ("probability = 0.25", "probability = 1.0"),
    ]);
    numbered.succeeds(&["run", "c.toml", "--out", "out", "--csv"]);
    assert_eq!(
        place.read_bytes("out/episodes.csv"),
        numbered.read_bytes("out/episodes.csv")
    );
    let refused = ["run", "c.toml", "--backend", "gpu", "--adapter", ""];
    place.refuses(
        &refused,
        2,
        &["--adapter \"\": an empty name is part of every name"],
    );
    place.refuses(
        &["run", "c.toml", "--backend", "gpu", "--adapter", "99"],
        2,
        &["99"],
    );
}
