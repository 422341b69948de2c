//! `[sensors]`: channels that share sensors, from the file to their gains, and no further.

use super::Place;
use serde_json::Value;

const PRESET: &str = "preset = \"uav-paper\"";

/// A rate sensor of x that is turned by 20 degrees, and one fault of both rates; the third channel is as it is.
const TURNED: &str = "
[sensors.position]
faults = [\"imu\"]
replace.\"x.rate\" = { of = { \"x.rate\" = 0.94, \"y.rate\" = -0.34 }, faults = { imu = 1 } }
replace.\"y.rate\" = { of = { \"y.rate\" = 1.0 }, faults = { imu = 0.5 }, noise = 2e-4 }
";

/// The smoke campaign with a text behind its preset, which begins a table.
fn with(sensors: &str) -> Place {
    Place::smoke(&[(PRESET, &format!("{PRESET}\n{sensors}"))])
}

#[test]
fn gains_of_channels_that_share_sensors_are_shown_with_their_certificate() {
    let place = with(TURNED);
    let said = place.program(&["synthesize", "c.toml"]);
    assert_eq!(said.code, 0, "{}", said.stderr);
    for words in [
        "position (x, y, z)",
        "9 sensors, sensor faults imu",
        "K  3 x 26",
        "L  26 x 9",
        "solver  riccati, confirmed: Solved in ",
        "certified attenuation rho ",
        "largest eigenvalue of (27) -",
    ] {
        assert!(said.stdout.contains(words), "{words:?}: {}", said.stdout);
    }
    let json = place.program(&["synthesize", "c.toml", "--json"]).stdout;
    let json: Value = serde_json::from_str(&json).unwrap();
    let found = &json["full_order"]["position"];
    assert_eq!(found["solver"], "riccati, confirmed");
    assert_eq!(found["gains"]["l"].as_array().unwrap().len(), 26);
    assert_eq!(found["sensors"]["rows"][7]["noise"], 2e-4);
    assert!(found["certificate"]["max_eigenvalue"].as_f64().unwrap() < 0.0);
    assert!(json.get("groups").is_none());
}

#[test]
fn episodes_are_not_simulated_with_them() {
    let place = with(TURNED);
    let words = [
        "c.toml: sensors (line ",
        " = given: the sensors of position are synthesized for, but episodes cannot be simulated with them yet; \
         remove it; `urts-mc synthesize` shows the gains",
    ];
    for command in ["run", "check"] {
        place.refuses(&[command, "c.toml"], 2, &words);
    }
}

#[test]
fn what_is_wrong_with_sensors_is_said_with_its_key() {
    for (sensors, words) in [
        (
            "[sensors.position]\nremove = [\"y.integral\"]",
            "sensors.position.remove (line 37) = [\"y.integral\"]: no sensor shows the integral of y, so no filter can \
             hold it; keep \"y.integral\" as it is, or add a sensor of it",
        ),
        (
            "[sensors.position]\nadd = [{ of = { roll = 1.0 } }]",
            "sensors.position.add[0].of.\"roll\" (line 37) = 1: the signals are x.integral, y.integral, z.integral",
        ),
        (
            "[sensors.left-leg]\nremove = []",
            "sensors.left-leg (line 36) = given: the kind \"UAVs\" does not have it",
        ),
        (
            "[sensors]",
            "sensors (line 36) = an empty table: no group of channels",
        ),
        (
            "[sensors.position]\nfault = [\"imu\"]",
            "unknown key `fault`",
        ),
    ] {
        with(sensors).refuses(&["synthesize", "c.toml"], 2, &[words]);
    }
}
