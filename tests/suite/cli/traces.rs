//! The figures of a replay: what is in them, and that the curves are the numbers simulated.

use super::Place;
use crate::common::repository;
use std::fs;
use urts_mc::run::replay::{Replay, replay};

/// A short episode of three UAVs whose y is struck from 1 s to 1.5 s, and nothing else.
fn struck() -> Place {
    let place = Place::smoke(&[]);
    let mut run = vec!["run", "c.toml", "--out", "out", "--episodes", "2"];
    for setting in [
        "time.duration_s=2.0",
        "time.settle_s=0.5",
        "fault=[{ target = \"actuator\", kind = \"bias\", channels = [2], onset_s = 1.0, duration_s = 0.5, magnitude = 40.0 }]",
    ] {
        run.extend(["--set", setting]);
    }
    place.succeeds(&run);
    place
}

/// What stands between two marks, as often as it does.
fn between<'a>(text: &'a str, from: &'a str, to: &'a str) -> impl Iterator<Item = &'a str> {
    text.split(from)
        .skip(1)
        .map(move |rest| rest.split_once(to).unwrap().0)
}

/// An attribute of a tag as a number.
fn number(tag: &str, name: &str) -> f64 {
    let value = between(tag, &format!(" {name}=\""), "\"")
        .next()
        .map(str::to_string);
    value.unwrap().parse().unwrap()
}

/// The drawings of panels in a page or picture, each with its name.
fn panels(text: &str) -> Vec<&str> {
    let found = text.split("<svg ").skip(1);
    found.filter(|svg| svg.contains("role=\"img\"")).collect()
}

/// Refuses what a browser would stumble over or fetch.
fn check_markup(text: &str) {
    let mut open: Vec<&str> = Vec::new();
    for tag in text.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').unwrap();
        let name = tag.split([' ', '\n', '/']).next().unwrap();
        match tag {
            tag if tag.starts_with('!') || tag.ends_with('/') => {}
            tag if tag.starts_with('/') => assert_eq!(open.pop(), Some(&tag[1..])),
            _ if ["meta", "link"].contains(&name) => {}
            _ => open.push(name),
        }
    }
    assert_eq!(open, [""; 0], "left open");
    let values = text.split('"').skip(1).step_by(2);
    for value in values {
        let words = value.split([' ', ',']);
        for word in words {
            assert!(!["NaN", "inf", "-inf"].contains(&word), "{value}");
        }
    }
    for address in text.split("http").skip(1) {
        assert!(
            address.starts_with("://www.w3.org/2000/svg\""),
            "{address:.40}"
        );
    }
    assert!(!text.contains("<script") && !text.contains("@import"));
}

/// The values of an axis from its labels: (value at 0 px, value per px).
fn axis(panel: &str, anchor: &str, coordinate: &str) -> (f64, f64) {
    let labels: Vec<(f64, f64)> = between(panel, "<text", "</text>")
        .filter(|text| text.contains(&format!("text-anchor=\"{anchor}\"")))
        .filter_map(|text| {
            let value = text.rsplit_once('>')?.1.parse().ok()?;
            Some((number(text, coordinate), value))
        })
        .collect();
    let (first, last) = (labels[0], labels[labels.len() - 1]);
    let slope = (last.1 - first.1) / (last.0 - first.0);
    (first.1 - slope * first.0, slope)
}

/// The points of a panel's lines in a colour, px.
fn lines(panel: &str, colour: &str) -> Vec<Vec<(f64, f64)>> {
    let paths = between(panel, "<path ", ">");
    let own = paths.filter(|path| path.contains(&format!("stroke=\"{colour}\"")));
    own.map(|path| {
        let points = between(path, "d=\"", "\"").next().unwrap().to_string();
        let numbers: Vec<f64> = points
            .split([' ', ',', 'M', 'L'])
            .filter_map(|part| part.parse().ok())
            .collect();
        numbers.chunks(2).map(|pair| (pair[0], pair[1])).collect()
    })
    .collect()
}

#[test]
fn a_replay_draws_every_channel_and_every_controller_and_shades_the_faults_it_met() {
    let place = struck();
    let said = place.succeeds(&["replay", "out", "--episode", "1", "--controller", "pid"]);
    for name in ["out/replay-1-pid.html", "out/replay-1-pid.svg"] {
        assert!(said.contains(name), "{name} is missing from: {said}");
    }
    let page = place.read("out/replay-1-pid.html");
    let picture = place.read("out/replay-1-pid.svg");
    check_markup(&page);
    check_markup(&picture);
    for name in ["x", "y", "z", "roll", "pitch", "yaw", "ftc", "pid-tuned"] {
        assert!(page.contains(&format!(">{name}<")), "{name}");
    }
    for unit in ["e, m<", "f1, m/s²<", "f2, rad/s<", "u, N<", "u, N m<"] {
        assert!(page.contains(unit), "{unit}");
    }
    assert!(picture.contains("--series-0: #") && picture.contains("prefers-color-scheme: dark"));

    // Five quantities of three agents; of y alone, from 1 s to 1.5 s of 2 s.
    let drawn = panels(&page);
    let of_channel = |name: &str| -> Vec<&str> {
        let own = drawn.iter().filter(|panel| {
            panel.contains(&format!("aria-label=\"{name}: ")) && panel.contains(" over time, s")
        });
        own.copied().collect()
    };
    for name in ["x", "y", "z", "roll", "pitch", "yaw"] {
        let own = of_channel(name);
        assert_eq!(own.len(), 5 * 3, "{name}");
        for panel in own {
            let shades: Vec<&str> = between(panel, "<rect", ">")
                .filter(|rect| rect.contains("fill=\"var(--fault)\""))
                .collect();
            assert_eq!(shades.len(), usize::from(name == "y"), "{name}");
            for shade in shades {
                let frame = between(panel, "<clipPath", "</clipPath>").next().unwrap();
                let (left, width) = (number(frame, "x"), number(frame, "width"));
                // Coordinates are written to a hundredth.
                assert!((number(shade, "x") - (left + width / 2.0)).abs() < 0.02);
                assert!((number(shade, "width") - width / 4.0).abs() < 0.02);
            }
        }
    }
    assert_eq!(page.matches("bias").count(), 3, "one line for each agent");
}

/// How far the baseline of a label is below its tick, px.
const LABELS_BELOW: f64 = 4.01;

/// What is drawn of an episode against what it showed.
fn agrees(panel: &str, colour: &str, simulated: &Replay, pick: impl Fn(usize) -> f64) {
    let drawn = lines(panel, colour);
    assert_eq!(drawn.len(), 1, "{colour}");
    let ((t0, per_px), (v0, of_px)) = (axis(panel, "middle", "x"), axis(panel, "end", "y"));
    let points: Vec<(f64, f64)> = drawn[0]
        .iter()
        .map(|&(x, y)| (t0 + per_px * x, v0 + of_px * (y + LABELS_BELOW)))
        .collect();
    assert!(points.len() > 5);
    for k in 0..=200_u32 {
        let t_s = 0.01 * f64::from(k);
        let right = points.partition_point(|point| point.0 < t_s);
        let right = right.clamp(1, points.len() - 1);
        let ((t1, v1), (t2, v2)) = (points[right - 1], points[right]);
        let value = v1 + (v2 - v1) * (t_s - t1) / (t2 - t1);
        let expected = pick(k as usize);
        // A line stands for points within a tenth of a pixel; points and labels are written to hundredths of one, in
        // time too.
        let steep = ((v2 - v1) / (t2 - t1) * per_px).abs() * 0.02;
        let within = 0.15 * of_px.abs() + steep;
        assert!(
            (value - expected).abs() < within,
            "{t_s}: {value} {expected}"
        );
    }
    assert_eq!(simulated.snapshots.len(), 201);
}

#[test]
fn the_curves_are_the_numbers_simulated() {
    let place = struck();
    place.succeeds(&["replay", "out", "--episode", "0"]);
    let simulated = replay(&place.path("out"), 0, "ftc", None).unwrap();
    let page = place.read("out/replay-0-ftc.html");
    // The first agent that is drawn is the one that fared worst.
    let (_, heading) = page.split_once("<h2>Agent ").unwrap();
    let agent: usize = heading[..1].parse().unwrap();
    let errors = panels(heading);
    let z = errors[2];
    assert!(
        z.contains("aria-label=\"z: e, m over time, s\""),
        "{z:.200}"
    );
    let of_asked = |k: usize| simulated.snapshots[k].agents[agent][2].e;
    agrees(z, "var(--series-0)", &simulated, of_asked);
    for (other, colour) in simulated
        .others
        .iter()
        .zip(["var(--series-1)", "var(--series-2)"])
    {
        agrees(z, colour, &simulated, |k| {
            other.snapshots[k].agents[agent][2].e
        });
    }
    agrees(z, "var(--series-3)", &simulated, |k| {
        simulated.snapshots[k].agents[agent][2].e_hat
    });
}

#[test]
fn the_other_controllers_of_a_replay_are_those_of_their_own_replays() {
    let place = struck();
    let out = place.path("out");
    let simulated = replay(&out, 1, "pid", None).unwrap();
    let names = simulated.others.iter().map(|other| other.controller);
    assert_eq!(names.collect::<Vec<_>>(), [0, 2]);
    for other in &simulated.others {
        let own = replay(
            &out,
            1,
            &simulated.campaign.controllers[other.controller],
            None,
        )
        .unwrap();
        assert_eq!(own.outcomes, other.outcomes);
        let last =
            |replay: &[urts_mc::model::episode::Snapshot]| replay[200].agents[2][5].x.to_bits();
        assert_eq!(last(&own.snapshots), last(&other.snapshots));
    }
}

#[test]
fn the_figures_stand_beside_the_file_that_was_asked_for_and_replace_none() {
    let place = struck();
    place.write("mine.svg", "a drawing");
    let replay = ["replay", "out", "--episode", "0", "--out", "mine.parquet"];
    place.refuses(
        &replay,
        2,
        &["--out mine.svg: exists already", "--overwrite"],
    );
    let found = place.json(&[&replay as &[_], &["--overwrite", "--json"]].concat());
    assert_eq!(found["figures"][0], "mine.html");
    assert_eq!(found["figures"][1], "mine.svg");
    assert!(place.read("mine.html").starts_with("<!DOCTYPE html>"));
    assert!(place.read("mine.svg").starts_with("<svg "));
    place.refuses(
        &["replay", "out", "--episode", "0", "--out", "t.html"],
        2,
        &["--out t.html", ".parquet"],
    );
}

#[test]
fn the_figures_of_an_earlier_run_are_removed_by_a_new_one() {
    let place = struck();
    place.succeeds(&["replay", "out", "--episode", "0"]);
    for (name, here) in [("replay-0-ftc.html", true), ("replay-0-ftc.svg", true)] {
        assert_eq!(place.path("out").join(name).exists(), here, "{name}");
    }
    place.write("out/replay-notes.txt", "mine");
    place.succeeds(&["run", "c.toml", "--out", "out", "--overwrite"]);
    for (name, here) in [
        ("replay-0-ftc.html", false),
        ("replay-0-ftc.svg", false),
        ("replay-0-ftc.parquet", false),
        ("replay-notes.txt", true),
    ] {
        assert_eq!(place.path("out").join(name).exists(), here, "{name}");
    }
}

#[test]
fn a_robot_shows_its_walk_and_itself() {
    let path = repository("campaigns/biped-ground-reaction.toml");
    let place = Place::with(&fs::read_to_string(path).unwrap());
    let short = ["--episodes", "1", "--set", "time.duration_s=4.0"];
    let run = [&["run", "c.toml", "--out", "out"], &short[..]].concat();
    // The walk takes longer than that, which is noted.
    assert_eq!(place.program(&run).code, 0);
    let simulated = replay(&place.path("out"), 0, "ftc", None).unwrap();
    place.succeeds(&["replay", "out", "--episode", "0"]);
    let page = place.read("out/replay-0-ftc.html");
    check_markup(&page);
    check_markup(&place.read("out/replay-0-ftc.svg"));
    let drawn = panels(&page);
    let named = |name: &str| -> &str {
        let own = drawn.iter().find(|panel| panel.contains(name));
        own.unwrap_or_else(|| panic!("no {name}"))
    };
    // A metre in steps of 0.2 m: two first footholds, five steps and one to close up; a dot and a sole of each.
    let above = named("aria-label=\"from above: y, m over x, m\"");
    let feet = above.matches("<circle").count();
    assert_eq!(feet, 2 + 5 + 1);
    let soles = ["var(--series-3)", "var(--series-4)"].map(|ink| lines(above, ink).len());
    assert_eq!(soles, [4, 4]);
    // Seven poses of two legs under each controller.
    let sticks = named("aria-label=\"ftc: height, m over ahead, m; each pose 0.35 m further\"");
    for ink in ["var(--series-3)", "var(--series-4)"] {
        assert_eq!(lines(sticks, ink).len(), 7, "{ink}");
    }
    for name in simulated.campaign.first_group().channels() {
        assert!(page.contains(&format!(">{name}<")), "{name}");
    }
}
