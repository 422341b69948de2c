//! The file of `--junit`.

use super::Place;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use urts_mc::report::junit::junit;
use urts_mc::run::manifest::Manifest;

/// An element of an XML text: its name, attributes and how deep it lies.
#[derive(Debug)]
struct Element {
    name: String,
    attributes: BTreeMap<String, String>,
    depth: usize,
}

/// Text with its references replaced; any other use of `&` or `<` is malformed.
fn unescaped(text: &str) -> String {
    let mut plain = text.to_string();
    assert!(!plain.contains('<'), "{text}");
    for (reference, character) in [
        ("&quot;", "\""),
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&apos;", "'"),
    ] {
        plain = plain.replace(reference, character);
    }
    for part in plain.split('&').skip(1) {
        assert!(part.starts_with("amp;"), "a bare & in {text}");
    }
    plain.replace("&amp;", "&")
}

/// The elements of a well-formed XML text, in order. It knows what JUnit files need: a declaration, elements and
/// attributes.
fn elements(text: &str) -> Vec<Element> {
    let declaration = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>";
    let mut rest = text
        .strip_prefix(declaration)
        .expect("a declaration")
        .trim();
    let (mut open, mut found): (Vec<String>, Vec<Element>) = (Vec::new(), Vec::new());
    while let Some(start) = rest.find('<') {
        unescaped(&rest[..start]);
        let end = rest.find('>').expect("an end of the tag");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "closed in another order");
            continue;
        }
        let (tag, whole) = tag
            .strip_suffix('/')
            .map_or((tag, false), |tag| (tag, true));
        let (name, mut list) = tag.split_once(' ').unwrap_or((tag, ""));
        let mut attributes = BTreeMap::new();
        while let Some((key, after)) = list.split_once("=\"") {
            let (value, after) = after.split_once('"').expect("a closing quote");
            let old = attributes.insert(key.trim().to_string(), unescaped(value));
            assert!(old.is_none(), "{key} comes twice in {tag}");
            list = after;
        }
        assert_eq!(list.trim(), "", "{tag}");
        let depth = open.len();
        assert!(depth > 0 || found.is_empty(), "two roots");
        found.push(Element {
            name: name.into(),
            attributes,
            depth,
        });
        if !whole {
            open.push(name.into());
        }
    }
    assert!(open.is_empty() && rest.trim().is_empty(), "{open:?} {rest}");
    found
}

/// (tests, failures, errors), as the root and its suite count them and as they are.
fn counts(elements: &[Element]) -> [usize; 3] {
    let count = |name: &str| elements.iter().filter(|own| own.name == name).count();
    let counted = ["testcase", "failure", "error"].map(count);
    for name in ["testsuites", "testsuite"] {
        let own = elements.iter().find(|own| own.name == name).unwrap();
        let said = ["tests", "failures", "errors"]
            .map(|key| own.attributes[key].parse::<usize>().unwrap());
        assert_eq!(said, counted, "{name}");
    }
    counted
}

fn with(requirements: &[(&str, &str)]) -> Place {
    let tables = requirements.iter().map(|(controller, limit)| {
        format!("[[require]]\ncontroller = \"{controller}\"\nfailure_rate_upper_95 = {limit}\n")
    });
    let tables: String = tables.collect();
    Place::smoke(&[("[verdict]", &format!("{tables}[verdict]"))])
}

const RUN: [&str; 6] = ["run", "c.toml", "--out", "out", "--junit", "ci/urts.xml"];

#[test]
fn each_requirement_is_a_test_case_that_passes_or_fails_with_its_numbers() {
    let place = with(&[("ftc", "0.64"), ("pid", "0.5")]);
    let ended = place.program(&RUN);
    assert_eq!(ended.code, 4, "{}", ended.stderr);
    let found = elements(&place.read("ci/urts.xml"));
    assert_eq!(counts(&found), [3, 1, 0]);
    let names: Vec<&str> = found
        .iter()
        .filter(|own| own.name == "testcase")
        .map(|own| &*own.attributes["name"])
        .collect();
    assert_eq!(
        names,
        [
            "simulation",
            "require[0]: failure rate of ftc below 0.64",
            "require[1]: failure rate of pid below 0.5",
        ]
    );
    // The failure is within the last test case, and says what standard error says.
    let failure = found.last().unwrap();
    assert_eq!((&*failure.name, failure.depth), ("failure", 3));
    let message = &failure.attributes["message"];
    for word in [
        "\"pid\" failed in 3 of 3 episodes",
        "below 1.0000",
        "change the controller or the limit",
    ] {
        assert!(
            message.contains(word),
            "{word:?} is missing from: {message}"
        );
    }
    assert!(ended.stderr.contains(message.as_str()), "{}", ended.stderr);
    // Nothing is left beside it.
    assert_eq!(fs::read_dir(place.path("ci")).unwrap().count(), 1);

    let place = with(&[("ftc", "0.64")]);
    place.succeeds(&RUN);
    assert_eq!(counts(&elements(&place.read("ci/urts.xml"))), [2, 0, 0]);
    // The cross-check is a test case where there is one.
    place.succeeds(&[&RUN as &[_], &["--cross-check", "1"]].concat());
    let found = elements(&place.read("ci/urts.xml"));
    assert_eq!(counts(&found), [3, 0, 0]);
    assert!(found.iter().any(|own| {
        own.attributes
            .get("name")
            .is_some_and(|name| name == "cross-check")
    }));
}

#[test]
fn a_name_with_signs_of_xml_stays_well_formed() {
    let place = Place::smoke(&[(
        "[verdict]",
        "[[strata]]\nname = \"a<b & \\\"c\\\"\"\nfaults = \"all\"\n[[require]]\ncontroller = \"ftc\"\nstratum = \"a<b & \\\"c\\\"\"\nfailure_rate_upper_95 = 0.01\n[verdict]",
    )]);
    assert_eq!(place.program(&RUN).code, 4);
    let found = elements(&place.read("ci/urts.xml"));
    assert_eq!(counts(&found), [2, 1, 0]);
    let names: Vec<&String> = found
        .iter()
        .filter_map(|own| own.attributes.get("name"))
        .collect();
    assert!(
        names.iter().any(|name| name.contains("a<b & ")),
        "{names:?}"
    );
}

#[test]
fn a_run_that_comes_to_nothing_is_an_error_and_leaves_no_earlier_success() {
    let place = with(&[("ftc", "0.64")]);
    place.succeeds(&RUN);
    // A folder stands where a table has to go.
    fs::remove_file(place.path("out/summary.csv")).unwrap();
    fs::create_dir(place.path("out/summary.csv")).unwrap();
    assert_eq!(place.program(&RUN).code, 2);
    let found = elements(&place.read("ci/urts.xml"));
    assert_eq!(counts(&found), [1, 0, 1]);
    let message = &found.last().unwrap().attributes["message"];
    assert!(
        message.contains("out/summary.csv: cannot be written"),
        "{message}"
    );
    // Nor where the simulation is killed: nothing is left that looks like a success.
    fs::remove_dir(place.path("out/summary.csv")).unwrap();
    assert_eq!(place.program(&RUN).code, 0);
    let mut flying = place
        .command(&[&RUN as &[_], &["--episodes", "1000000", "--quiet"]].concat())
        .spawn()
        .unwrap();
    // Synthesis takes a fraction of a second, a million episodes minutes: it is simulating.
    std::thread::sleep(std::time::Duration::from_secs(1));
    assert!(
        flying.try_wait().unwrap().is_none(),
        "ended before the kill"
    );
    flying.kill().unwrap();
    flying.wait().unwrap();
    assert!(!place.path("ci/urts.xml").exists());
}

#[test]
fn a_file_that_cannot_be_written_or_is_something_else_is_refused_before_simulating() {
    let place = with(&[("ftc", "0.64")]);
    fs::create_dir(place.path("folder")).unwrap();
    place.write("notes.txt", "mine");
    for (file, words) in [
        (
            "folder",
            ["--junit folder: cannot be written (", "give another file"],
        ),
        (
            "c.toml/x.xml",
            [
                "--junit c.toml/x.xml: cannot be written (",
                "give another file",
            ],
        ),
        (
            "/proc/x.xml",
            [
                "--junit /proc/x.xml: cannot be written (",
                "give another file",
            ],
        ),
        (
            "c.toml",
            [
                "--junit c.toml: exists already and is no JUnit file",
                "--overwrite",
            ],
        ),
        (
            "notes.txt",
            [
                "--junit notes.txt: exists already and is no JUnit file",
                "--overwrite",
            ],
        ),
    ] {
        // So many episodes would take days.
        let run = [
            "run",
            "c.toml",
            "--out",
            "out",
            "--episodes",
            "4000000000",
            "--junit",
            file,
        ];
        place.refuses(&run, 2, &words);
    }
    place.succeeds(&[
        "run",
        "c.toml",
        "--out",
        "out",
        "--overwrite",
        "--junit",
        "notes.txt",
    ]);
    assert_eq!(counts(&elements(&place.read("notes.txt"))), [2, 0, 0]);
}

#[test]
fn a_campaign_that_is_refused_is_an_error_too_and_leaves_no_earlier_success() {
    let place = with(&[("ftc", "0.64")]);
    place.succeeds(&RUN);
    let text = place.read("c.toml");
    let refused = |more: &[&str], word: &str| {
        assert_eq!(place.program(&[&RUN as &[_], more].concat()).code, 2);
        let found = elements(&place.read("ci/urts.xml"));
        assert_eq!(counts(&found), [1, 0, 1]);
        let suite = found.iter().find(|own| own.name == "testsuite").unwrap();
        let message = &found.last().unwrap().attributes["message"];
        assert!(
            message.contains(word),
            "{word:?} is missing from: {message}"
        );
        suite.attributes["name"].clone()
    };
    // A file that is not read has no name but that of the file.
    place.write("c.toml", text.replace("step_s", "stp_s"));
    assert_eq!(refused(&[], "unknown key `stp_s`"), "c");
    place.write("c.toml", text);
    assert_eq!(
        refused(&["--seed", "7"], "holds a run of 3 episodes"),
        "smoke"
    );
    assert_eq!(refused(&["--adapter", "x"], "--backend gpu"), "smoke");
    place.succeeds(&RUN);
    assert_eq!(counts(&elements(&place.read("ci/urts.xml"))), [2, 0, 0]);
    // Where there is no directory for it, none is made.
    fs::remove_dir_all(place.path("ci")).unwrap();
    place.refuses(
        &[&RUN as &[_], &["--seed", "7"]].concat(),
        2,
        &["--overwrite"],
    );
}

#[test]
fn a_file_that_the_run_writes_itself_is_refused() {
    let place = with(&[("ftc", "0.64")]);
    let refused = |out: &[&str], file: &str| {
        let words =
            format!("--junit {file}: the run writes a file of this name itself; give another file");
        let run = [&["run", "c.toml", "--overwrite", "--junit", file], out].concat();
        place.refuses(&run, 2, &[&words]);
    };
    for file in [
        "out/report.html",
        "./out/manifest.json",
        "out/../out/summary.csv",
    ] {
        refused(&["--out", "out"], file);
    }
    refused(&[], "reports/smoke/report.md");
    place.succeeds(&["run", "c.toml", "--out", "out"]);
    refused(&["--out", "./out/"], "out/../out/gains.json");
    let page = place.read("out/report.html");
    assert!(page.starts_with("<!DOCTYPE html>"), "{page:.80}");
    // Another name there, and one of these elsewhere, may be.
    place.succeeds(&["run", "c.toml", "--out", "out", "--junit", "out/ci.xml"]);
    place.succeeds(&["run", "c.toml", "--out", "out", "--junit", "report.html"]);
    assert_eq!(counts(&elements(&place.read("report.html"))), [2, 0, 0]);
}

#[test]
fn an_interrupted_simulation_and_a_missing_cross_check_are_errors_and_a_failed_one_a_failure() {
    let place = with(&[("ftc", "0.64")]);
    place.succeeds(&[&RUN as &[_], &["--cross-check", "1"]].concat());
    let manifest = Manifest::read(&place.path("out")).unwrap();
    let written = |change: &dyn Fn(&mut Manifest)| {
        let mut manifest = manifest.clone();
        change(&mut manifest);
        elements(&junit(&manifest, Path::new("out")).unwrap())
    };
    let message = |found: &[Element], name: &str| {
        let own = found.iter().find(|own| own.name == name);
        own.unwrap().attributes["message"].clone()
    };
    assert_eq!(counts(&written(&|_| ())), [3, 0, 0]);
    // A GPU that is lost is not checked either, which is one error and not two.
    let found = written(&|manifest| {
        manifest.interrupted = Some("card: the device was lost".into());
        manifest.episodes_asked = 9;
        manifest.cross_check = None;
        manifest.cross_check_missing = Some("card: the device was lost".into());
    });
    assert_eq!(counts(&found), [2, 0, 1]);
    let said = message(&found, "error");
    assert!(
        said.contains("the device was lost; the 3 of 9 episodes"),
        "{said}"
    );
    let found = written(&|manifest| {
        manifest.cross_check = None;
        manifest.cross_check_missing = Some("card: out of memory".into());
    });
    assert_eq!(counts(&found), [3, 0, 1]);
    assert!(message(&found, "error").contains("card: out of memory"));
    let found = written(&|manifest| manifest.cross_check.as_mut().unwrap().not_repeated = 2);
    assert_eq!(counts(&found), [3, 1, 0]);
    assert!(message(&found, "failure").contains("2 episodes give other numbers"));
}
