//! A campaign from the program alone, in an empty folder.

use super::Place;
use crate::common::shipped_campaigns;
use std::collections::BTreeSet;
use std::fs;
use urts_mc::campaign::Campaign;
use urts_mc::campaign::gallery::GALLERY;

/// An empty folder.
fn empty() -> Place {
    let place = Place::smoke(&[]);
    fs::remove_file(place.path("c.toml")).unwrap();
    place
}

#[test]
fn the_gallery_has_every_shipped_campaign() {
    let shipped = shipped_campaigns();
    let shipped: BTreeSet<&str> = shipped
        .iter()
        .map(|path| path.file_stem().unwrap().to_str().unwrap())
        .collect();
    let gallery: BTreeSet<&str> = GALLERY.iter().map(|(name, _)| *name).collect();
    assert_eq!(gallery, shipped);
    for name in gallery {
        // With its robot, wherever the program runs.
        let campaign = Campaign::load(format!("gallery:{name}").as_ref()).unwrap();
        assert_eq!(campaign.name, name);
        assert!(!campaign.description.is_empty(), "{name}");
    }
}

#[test]
fn a_campaign_of_the_gallery_runs_in_an_empty_folder_and_is_replayed_there() {
    let place = empty();
    place.succeeds(&["run", "gallery:smoke", "--episodes", "2", "--out", "out"]);
    place.succeeds(&["replay", "out", "--episode", "1"]);
    let listed = place.succeeds(&["new", "--list"]);
    for word in [
        "gallery:smoke",
        "gallery:biped-paper",
        "does everything work?",
    ] {
        assert!(listed.contains(word), "{listed}");
    }
    place.refuses(
        &["run", "gallery:smokey"],
        2,
        &["the gallery has no campaign \"smokey\"; did you mean \"smoke\"?"],
    );
}

#[test]
fn a_new_campaign_is_one_that_runs_and_replaces_nothing() {
    let place = empty();
    let said = place.succeeds(&["new", "mine"]);
    assert!(said.contains("urts-mc run mine.toml"), "{said}");
    let text = place.read("mine.toml");
    assert!(text.starts_with("# Made from gallery:smoke.") && text.contains("name = \"mine\""));
    let run = place.program(&["run", "mine.toml", "--episodes", "2"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(place.path("reports/mine/report.html").is_file());
    place.refuses(
        &["new", "mine"],
        2,
        &["mine.toml: exists already; give another name"],
    );
    assert_eq!(place.read("mine.toml"), text);
    place.succeeds(&["new", "walk", "--kind", "biped"]);
    assert_eq!(place.program(&["check", "walk.toml"]).code, 0);
    // Its robot comes with it.
    place.succeeds(&["new", "short-steps", "--from", "biped-berkeley"]);
    assert!(place.path("robots/berkeley_humanoid.toml").is_file());
    assert_eq!(place.program(&["check", "short-steps.toml"]).code, 0);
    place.refuses(&["new", "not a name"], 2, &["a name consists of letters"]);
    place.refuses(
        &["new", "other", "--from", "smok"],
        2,
        &["did you mean \"smoke\"?"],
    );
    assert!(!place.path("other.toml").exists());
}
