//! Gains from a file.

use super::{Place, smoke};
use serde_json::{Value, json};

const PRESET: &str = "preset = \"uav-paper\"";

/// A folder with the smoke campaign, its gains in g.json, and d.toml, which takes them from there.
fn with_gains() -> (Place, Value) {
    let place = Place::smoke(&[]);
    let gains = place.succeeds(&["synthesize", "c.toml", "--json"]);
    place.write("g.json", &gains);
    place.write("d.toml", smoke(&[(PRESET, "gains = \"g.json\"")]));
    (place, serde_json::from_str(&gains).unwrap())
}

#[test]
fn synthesized_gains_fed_back_as_a_file_give_the_same_comparison() {
    let (place, gains) = with_gains();
    let run = |campaign: &str, out: &str| place.json(&["run", campaign, "--out", out, "--json"]);
    let synthesized = run("c.toml", "c");
    let read = run("d.toml", "d");
    assert!(synthesized["comparisons"].as_array().unwrap().len() > 1);
    for part in ["failures", "comparisons"] {
        assert_eq!(synthesized[part], read[part]);
    }
    // The numbers of gains.json are those of `synthesize --json`.
    let written: Value = serde_json::from_str(&place.read("c/gains.json")).unwrap();
    let k = |file: &Value| file["controllers"]["ftc"]["position"]["k"].clone();
    assert_eq!(k(&written), k(&gains));

    let mut weaker = gains;
    let first = &mut weaker["controllers"]["ftc"]["position"]["k"][0];
    *first = json!(0.9 * first.as_f64().unwrap());
    place.write("g.json", weaker.to_string());
    let other = run("d.toml", "e");
    assert_ne!(
        other["comparisons"], synthesized["comparisons"],
        "the file is not read"
    );
}

#[test]
fn a_named_controller_is_simulated_beside_the_built_in_ones() {
    let (place, _) = with_gains();
    place.write(
        "e.toml",
        smoke(&[
            (
                PRESET,
                "preset = \"uav-paper\"\nnamed.twin = { gains = \"g.json\", controller = \"pid\" }",
            ),
            ("\"pid-tuned\"]", "\"twin\"]"),
        ]),
    );
    let found = place.json(&["run", "e.toml", "--out", "out", "--json"]);
    let pair = |a: &str, b: &str| {
        let all = found["comparisons"].as_array().unwrap().iter();
        let of = |pair: &&Value| pair["a"] == a && pair["b"] == b;
        all.clone().find(of).unwrap()["log_ratios"].clone()
    };
    assert_eq!(pair("ftc", "twin"), pair("ftc", "pid"));
    assert_ne!(pair("ftc", "twin"), pair("pid", "twin"));
}

#[test]
fn gains_that_do_not_stabilise_exit_with_3_and_the_reason() {
    let (place, gains) = with_gains();
    for (controller, role, pointer, value, words) in [
        (
            "ftc",
            "position",
            "/k/1",
            500.0,
            ["A + B K", "does not stabilise"],
        ),
        (
            "pid",
            "attitude",
            "/k/1",
            500.0,
            ["A + B K", "does not stabilise"],
        ),
        (
            "ftc",
            "attitude",
            "/l/1/1",
            900.0,
            ["A + L C", "does not converge"],
        ),
    ] {
        let mut tampered = gains.clone();
        let channel = &mut tampered["controllers"][controller][role];
        *channel.pointer_mut(pointer).unwrap() = json!(value);
        place.write("g.json", tampered.to_string());
        let said = place.refuses(&["run", "d.toml", "--out", "out"], 3, &words);
        let place = format!("error: g.json: controllers.{controller}.{role}: ");
        assert!(said.starts_with(&place), "{said}");
    }
}

#[test]
fn a_gains_file_of_another_form_is_refused() {
    let (place, gains) = with_gains();
    let refused = |content: &str, words: &[&str]| {
        place.write("g.json", content);
        let said = place.refuses(&["run", "d.toml", "--out", "out"], 2, words);
        assert!(said.starts_with("error: g.json: "), "{said}");
    };
    let changed = |change: fn(&mut Value)| {
        let mut gains = gains.clone();
        change(&mut gains);
        gains.to_string()
    };
    refused("", &["gains.json"]);
    refused("name = 1", &["line 1", "gains.json"]);
    refused("{ \"format\": 1 }", &["the file has no gains"]);
    refused(
        &changed(|gains| gains["extra"] = json!(1)),
        &["`extra`", "`controllers`"],
    );
    refused(
        &changed(|gains| gains["controllers"]["ftc"]["position"]["kk"] = json!(1)),
        &["`kk`", "`k` or `l`"],
    );
    refused(
        &changed(|gains| gains["format"] = json!(2)),
        &["format = 2", "format 1"],
    );
    refused(
        &changed(|gains| gains["controllers"]["pid"] = gains["controllers"]["ftc"].take()),
        &["line 1"],
    );
    refused(
        &changed(|gains| {
            gains["controllers"].as_object_mut().unwrap().remove("pid");
        }),
        &["controllers.pid", "absent", "ftc, pid-tuned"],
    );
    refused(
        &changed(|gains| {
            gains["controllers"]["ftc"]["attitude"] =
                gains["controllers"]["pid"]["attitude"].clone();
        }),
        &["controllers.ftc", "the channel groups differ in kind"],
    );
}

#[test]
fn a_directory_in_the_place_of_gains_is_called_one_and_named_as_it_is_written() {
    let (place, _) = with_gains();
    std::fs::create_dir_all(place.path("of/mine")).unwrap();
    place.write("d.toml", smoke(&[(PRESET, "gains = \"of/mine\"")]));
    let words =
        "synthesis.gains (line 35) = \"of/mine\": a directory, not a file; name a gains.json";
    place.refuses(&["check", "d.toml"], 2, &[words]);
    place.write("d.toml", smoke(&[(PRESET, "gains = \"of/none.json\"")]));
    let words = "synthesis.gains (line 35) = \"of/none.json\": no such file; name a gains.json";
    place.refuses(&["check", "d.toml"], 2, &[words]);
}

#[test]
fn a_replay_needs_nothing_but_the_directory_of_the_run() {
    let (place, _) = with_gains();
    place.succeeds(&["run", "d.toml", "--out", "out"]);
    for file in ["c.toml", "d.toml", "g.json"] {
        std::fs::remove_file(place.path(file)).unwrap();
    }
    let text = place.succeeds(&["replay", "out", "--episode", "1"]);
    assert!(text.contains("episode 1 under ftc"), "{text}");
}

#[test]
fn a_placed_pid_is_compared_where_it_is_named_with_the_margin_or_the_poles_that_it_is_given() {
    let place = Place::smoke(&[]);
    let controllers = ["--set", "controllers=[\"ftc\", \"pid-placed\"]"];
    let synthesized = |more: &[&str]| {
        let arguments = [
            &["synthesize", "c.toml", "--json"],
            &controllers as &[_],
            more,
        ]
        .concat();
        place.json(&arguments)["controllers"].clone()
    };
    let margin_ms = |controllers: &serde_json::Value, name: &str| {
        let margins = &controllers[name]["findings"]["position"]["analysis"]["margins"];
        margins["delay_margin_ms"].as_f64().unwrap()
    };
    let found = synthesized(&[]);
    let (ftc, placed) = (margin_ms(&found, "ftc"), margin_ms(&found, "pid-placed"));
    assert!(
        (placed / ftc - 1.0).abs() < 1e-6 && ftc > 5.0,
        "{ftc}, {placed}"
    );
    let found = synthesized(&[
        "--set",
        "synthesis.pid-placed.delay_margin_of=pid-robust-observer",
    ]);
    assert!(margin_ms(&found, "pid-placed") > 2.0 * ftc);
    let found = synthesized(&["--set", "synthesis.pid-placed={ poles_rad_s = 20 }"]);
    let k = &found["pid-placed"]["attitude"]["k"];
    assert_eq!(*k, serde_json::json!([-8000.0, -1200.0, -60.0]));

    let run = |more: &[&str]| {
        let arguments = [
            &["run", "c.toml", "--overwrite", "--json"],
            &controllers as &[_],
            more,
        ];
        place.json(&arguments.concat())
    };
    let found = run(&["--set", "synthesis.pid-placed={ poles_rad_s = 15 }"]);
    assert_eq!(found["comparisons"][0]["b"], "pid-placed");
    // A file that names no controllers compares the same as ever.
    let plain = place.json(&["check", "c.toml", "--set", "controllers=", "--json"]);
    assert_eq!(
        plain["controllers"],
        serde_json::json!(["ftc", "pid", "pid-tuned"])
    );

    for (setting, said) in [
        (
            "synthesis.pid-placed.poles_rad_s=0.0",
            "synthesis.pid-placed.poles_rad_s (--set synthesis.pid-placed.poles_rad_s=0.0) = 0.0: must lie within 0.01 and 1000 rad/s",
        ),
        (
            "synthesis.pid-placed.observer_rad_s=1e6",
            "must lie within 0.01 and 1000 rad/s",
        ),
        (
            "synthesis.pid-placed={ poles_rad_s = 20, delay_margin_of = \"ftc\" }",
            "poles_rad_s is given too, which decides where the poles are; remove either",
        ),
        (
            "synthesis.pid-placed.delay_margin_of=ftd",
            "the controllers that have one are ftc, pid, pid-robust-observer; did you mean \"ftc\"?",
        ),
        ("synthesis.pid-placed.pole=3", "unknown key `pole`"),
    ] {
        place.refuses(&["check", "c.toml", "--set", setting], 2, &[said]);
    }
}

#[test]
fn delays_beyond_a_margin_and_levels_that_are_not_reached_are_said_before_and_after_a_run() {
    let place = Place::smoke(&[]);
    let plain = place.json(&["check", "c.toml", "--json"]);
    assert_eq!(plain["notes"], serde_json::json!([]));
    // 6 ms of delay and half of 10 ms of hold: beyond the FTC's 7.6 ms, within the 27 ms of the tuned PID.
    let late = ["--set", "control={ delay_s = 0.006, rate_hz = 100 }"];
    let said = "delays add up to 11.0 ms (6.0 ms of control.delay_s, 5.0 ms of half of what control.rate_hz holds), beyond \
                the delay margin of ftc on position (7.6 ms), ftc on attitude (7.6 ms): unstable while they last";
    let checked = place.json(&[&["check", "c.toml", "--json"], &late as &[_]].concat());
    assert_eq!(checked["notes"][0], said);
    assert_eq!(checked["notes"].as_array().unwrap().len(), 1);
    let ran = place.json(&[&["run", "c.toml", "--overwrite", "--json"], &late as &[_]].concat());
    assert_eq!(ran["manifest"]["notes"][0], said);
    let text = place.succeeds(&[&["check", "c.toml"], &late as &[_]].concat());
    assert!(text.contains("note: delays add up to 11.0 ms"), "{text}");
    // A fault that delays counts with its longest delay, unless nobody has it.
    let fault = |probability: &str| {
        let fault = "fault.+={ target = \"network\", kind = \"delay\", delay_s = { uniform = [0.004, 0.008] }, probability = ";
        format!("{fault}{probability} }}")
    };
    let notes = |probability: &str| {
        let fault = fault(probability);
        let found = place.json(&["check", "c.toml", "--json", "--set", &fault]);
        found["notes"]
            .as_array()
            .unwrap()
            .iter()
            .map(|own| own.as_str().unwrap().to_string())
            .collect::<Vec<_>>()
    };
    assert!(
        notes("0.5")[0].contains("delays add up to 8.0 ms (8.0 ms of the longest delay fault)")
    );
    assert!(
        notes("0.0")
            .iter()
            .all(|own| own.contains("nobody ever has"))
    );

    // A level below what can be had is not reached, and is said not to be.
    let low = ["--set", "synthesis.position.rho=9.0"];
    let checked = place.json(&[&["check", "c.toml", "--json"], &low as &[_]].concat());
    let said = "ftc on position: the weights ask for an attenuation of rho = 9.000, the gains certify 10.135 only";
    assert_eq!(checked["notes"], serde_json::json!([said]));
}
