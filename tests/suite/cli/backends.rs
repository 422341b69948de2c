//! Choosing where to simulate: --backend, --adapter, --cross-check, and the command that explains the choice.

use super::Place;
use crate::common::{gpu_or_skip, without_hash};
use std::process::Command;
use urts_mc::backend::gpu::AdapterKind;

#[test]
fn auto_never_takes_a_software_adapter_and_says_what_it_takes() {
    let place = Place::smoke(&[]);
    let said = place.succeeds(&["devices"]);
    let listed = place.json(&["devices", "--json"]);
    let hardware = ["discrete", "integrated", "virtual"];
    let adapters = listed.as_array().unwrap();
    let first = adapters
        .iter()
        .position(|a| hardware.contains(&a["kind"].as_str().unwrap()));
    for (k, adapter) in adapters.iter().enumerate() {
        assert_eq!(adapter["auto"], Some(k) == first, "{adapter}");
        assert!(said.contains(adapter["name"].as_str().unwrap()), "{said}");
        assert!(said.contains(adapter["driver"].as_str().unwrap()), "{said}");
        assert!(said.contains(adapter["reason"].as_str().unwrap()), "{said}");
    }
    if first.is_none() {
        assert!(said.starts_with("--backend auto takes the CPU ("), "{said}");
        assert!(said.contains("there is no hardware GPU"), "{said}");
        let ran = place.succeeds(&["run", "c.toml", "--out", "auto", "--backend", "auto"]);
        assert!(ran.contains("on the CPU ("), "{ran}");
        let text = place.read("auto/manifest.json");
        let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(manifest["legs"][0]["backend"], "cpu");
        assert_eq!(manifest["cross_check"], serde_json::Value::Null);
        place.refuses(
            &["run", "c.toml", "--out", "no", "--backend", "gpu"],
            2,
            &["no hardware GPU found", "--backend cpu", "--adapter"],
        );
    }
}

#[test]
fn a_run_on_a_gpu_is_checked_recorded_and_replayed_there() {
    let Some(gpu) = gpu_or_skip() else { return };
    let name = gpu.adapter().name.as_str();
    let place = Place::smoke(&[("duration_s = 6.0", "duration_s = 4.5")]);
    let on_gpu = ["run", "c.toml", "--backend", "gpu", "--adapter", name];
    let said = place.succeeds(&[&on_gpu[..], &["--out", "out", "--csv"]].concat());
    assert!(said.contains(name), "{said}");
    assert!(said.contains("cross-check of 3 episodes"), "{said}");
    assert!(said.contains("0 of 9 verdicts differ"), "{said}");
    let manifest: serde_json::Value =
        serde_json::from_str(&place.read("out/manifest.json")).unwrap();
    let leg = &manifest["legs"][0];
    assert_eq!(leg["backend"], "gpu");
    assert_eq!((&leg["first"], &leg["episodes"]), (&0.into(), &3.into()));
    assert_eq!(leg["adapter"]["name"], name);
    assert_eq!(leg["adapter"]["driver"], gpu.adapter().driver.as_str());
    let check = &manifest["cross_check"];
    assert_eq!(check["episodes"].as_array().unwrap().len(), 3);
    let largest = check["largest_error_difference"].as_f64().unwrap();
    assert!(0.0 < largest && largest <= 2e-4, "{largest}");
    assert_eq!(check["verdicts_differ"], 0);

    // The same bytes again, with or without the check.
    place.succeeds(
        &[
            &on_gpu[..],
            &["--out", "again", "--csv", "--cross-check", "0"],
        ]
        .concat(),
    );
    for file in [
        "episodes.csv",
        "channels.csv",
        "summary.csv",
        "comparison.csv",
        "ranking.csv",
        "worst.csv",
    ] {
        assert!(
            place.read_bytes(&format!("out/{file}")) == place.read_bytes(&format!("again/{file}")),
            "{file}"
        );
    }

    let replayed = place.succeeds(&["replay", "out", "--episode", "2", "--controller", "pid"]);
    assert!(!replayed.contains("in f64 on the CPU"), "{replayed}");
    let row = place.rows("out/channels.csv").into_iter().find(|row| {
        row["episode"] == "2"
            && row["controller"] == "pid"
            && row["agent"] == "1"
            && row["channel"] == "yaw"
    });
    let rmse: f64 = row.unwrap()["rmse"].parse().unwrap();
    let agent = replayed.split("agent 1").nth(1).unwrap();
    let yaw = agent.lines().find(|line| line.trim().starts_with("yaw"));
    let shown: f64 = yaw
        .unwrap()
        .split_whitespace()
        .nth(2)
        .unwrap()
        .parse()
        .unwrap();
    // To the four digits that are shown.
    assert!((shown / rmse - 1.0).abs() < 6e-4, "{replayed}");
}

#[test]
fn a_run_whose_driver_has_changed_is_replayed_on_the_reference_and_says_so() {
    let Some(gpu) = gpu_or_skip() else { return };
    let adapter = gpu.adapter();
    let place = Place::smoke(&[("duration_s = 6.0", "duration_s = 4.5")]);
    place.succeeds(&[
        "run",
        "c.toml",
        "--out",
        "out",
        "--backend",
        "gpu",
        "--adapter",
        &adapter.name,
        "--cross-check",
        "0",
    ]);
    let manifest = without_hash(&place.read("out/manifest.json"));
    assert!(manifest.contains(&adapter.driver));
    place.write(
        "out/manifest.json",
        manifest.replace(&adapter.driver, "another 1.0"),
    );
    let said = place.succeeds(&["replay", "out", "--episode", "0"]);
    assert!(said.contains("Simulated in f64 on the CPU"), "{said}");
    assert!(
        said.contains("with the driver another 1.0 is not here"),
        "{said}"
    );
}

#[test]
fn contradictory_choices_are_refused() {
    let place = Place::smoke(&[]);
    for (arguments, words) in [
        (
            &["--backend", "gpu", "--adapter", "no-such-card"][..],
            &["--adapter no-such-card", "urts-mc devices"][..],
        ),
        (
            &["--backend", "cpu", "--adapter", "llvmpipe"],
            &["--adapter llvmpipe", "add --backend gpu"],
        ),
        (
            &["--backend", "gpu", "--precision", "f64"],
            &["--precision f64", "--backend cpu"],
        ),
        (
            &["--backend", "gpu", "--simd", "scalar"],
            &["--simd", "--backend cpu"],
        ),
        (
            &["--precision", "f64", "--cross-check", "3"],
            &["--cross-check", "leave it out"],
        ),
    ] {
        let run = [&["run", "c.toml", "--out", "no"][..], arguments].concat();
        place.refuses(&run, 2, words);
    }
}

#[test]
fn a_cross_check_of_the_cpu_is_done_when_it_is_asked_for() {
    let place = Place::smoke(&[]);
    let found = place.json(&[
        "run",
        "c.toml",
        "--out",
        "out",
        "--json",
        "--cross-check",
        "2",
    ]);
    let check = &found["manifest"]["cross_check"];
    assert_eq!(check["episodes"].as_array().unwrap().len(), 2);
    assert!(check["largest_error_difference"].as_f64().unwrap() > 0.0);
    assert!(check["compared"].as_u64().unwrap() > 0);
}

#[test]
fn the_programs_standard_error_stays_empty_without_a_display() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_urts-mc"));
    command.arg("devices").env_remove("NODEVICE_SELECT");
    for variable in ["DISPLAY", "WAYLAND_DISPLAY", "XDG_RUNTIME_DIR"] {
        command.env_remove(variable);
    }
    let output = command.output().unwrap();
    assert!(output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    // A software adapter says of itself that it is one.
    assert!(!AdapterKind::Software.is_hardware() && !AdapterKind::Other.is_hardware());
}
