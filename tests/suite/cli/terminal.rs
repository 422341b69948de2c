//! Colours, quiet commands, and JSON.

use super::{Ended, Place};
use urts_mc::campaign::Campaign;
use urts_mc::results::how_sure;
use urts_mc::run::replay::command;

const ESCAPE: char = '\x1b';
/// A campaign with a requirement that holds, one that does not, and the other half of an unequal comparison.
const REQUIRE: &str = "[[require]]\ncontroller = \"ftc\"\nfailure_rate_upper_95 = 0.64\n[[require]]\ncontroller = \"pid\"\nfailure_rate_upper_95 = 0.5\n[verdict]";

fn ended(place: &Place, arguments: &[&str], variables: &[(&str, &str)]) -> Ended {
    let mut command = place.command(arguments);
    for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
        command.env_remove(name);
    }
    let output = command.envs(variables.iter().copied()).output().unwrap();
    Ended {
        code: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

#[test]
fn a_pipe_and_no_color_get_plain_text_and_who_asks_for_colours_gets_them() {
    let place = Place::smoke(&[("[verdict]", REQUIRE)]);
    let run = ["run", "c.toml", "--out", "out"];
    let plain = ended(&place, &run, &[]);
    assert_eq!(plain.code, 4);
    for text in [&plain.stdout, &plain.stderr] {
        assert!(!text.contains(ESCAPE), "{text:?}");
    }
    let forced = [("CLICOLOR_FORCE", "1")];
    let coloured = ended(&place, &run, &forced);
    // Headings are bold, what holds green, what does not red.
    for word in [
        "\x1b[1mfailures\x1b[0m (an episode",
        "\x1b[32mmet  \x1b[0m  require[0]",
        "\x1b[1m\x1b[31mUNMET\x1b[0m  require[1]",
    ] {
        assert!(coloured.stdout.contains(word), "{word:?}");
    }
    let red = "\x1b[1m\x1b[31merror:\x1b[0m c.toml: require[1]";
    assert!(coloured.stderr.contains(red), "{:?}", coloured.stderr);
    let both = [("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")];
    let neither = ended(&place, &run, &both);
    assert!(!neither.stdout.contains(ESCAPE) && !neither.stderr.contains(ESCAPE));
    assert_eq!(neither.stderr, plain.stderr);
    // Columns line up, coloured or not: the text is the same but for the times.
    let untimed = |text: &str| {
        let lines = text
            .lines()
            .filter(|line| !line.contains(" s of simulation"));
        let lines = lines.filter(|line| !line.starts_with("written to"));
        lines.map(String::from).collect::<Vec<_>>()
    };
    assert_eq!(untimed(&neither.stdout), untimed(&plain.stdout));
    // JSON has none, whatever is asked for.
    for arguments in [
        &["replay", "out", "--episode", "0", "--json"] as &[_],
        &["check", "c.toml", "--json"],
    ] {
        let json = ended(&place, arguments, &forced);
        assert!(!json.stdout.contains(ESCAPE), "{:?}", json.stdout);
        assert!(serde_json::from_str::<serde_json::Value>(&json.stdout).is_ok());
    }
}

#[test]
fn what_a_foreign_file_says_commands_no_terminal() {
    let place = Place::smoke(&[]);
    // A title of the window, and a mark that turns the direction of what follows.
    place.write("c.toml", "\"\\u001b]0;owned\\u0007\\u202ekey\" = 1\n");
    let said = ended(&place, &["check", "c.toml"], &[("CLICOLOR_FORCE", "1")]).stderr;
    assert!(
        said.contains("unknown key `\\u{1b}]0;owned\\u{7}\\u{202e}key`"),
        "{said:?}"
    );
    assert!(
        !said.contains("\u{1b}]") && !said.contains('\u{202e}'),
        "{said:?}"
    );
}

#[test]
fn a_quiet_command_prints_nothing_but_errors_and_what_json_asks_for() {
    let place = Place::smoke(&[]);
    for arguments in [
        &["check", "c.toml", "--quiet"] as &[_],
        &["run", "c.toml", "--out", "out", "-q"],
        &["replay", "out", "--episode", "1", "--quiet"],
    ] {
        let said = place.program(arguments);
        let silence = (0, "", "");
        assert_eq!(
            (said.code, &*said.stdout, &*said.stderr),
            silence,
            "{arguments:?}"
        );
        assert!(place.json(&[arguments, &["--json"]].concat()).is_object());
    }
    assert!(place.path("out/manifest.json").is_file());
    assert!(place.path("out/replay-1-ftc.parquet").is_file());
    place.refuses(&["run", "absent.toml", "--quiet"], 2, &["absent.toml"]);
    let unmet = Place::smoke(&[("[verdict]", REQUIRE)]);
    let said = unmet.program(&["run", "c.toml", "--quiet"]);
    assert_eq!((said.code, said.stdout.as_str()), (4, ""));
    assert!(said.stderr.contains("require[1]"), "{}", said.stderr);
}

#[test]
fn a_run_ends_with_a_plain_sentence_and_every_requirement() {
    let place = Place::smoke(&[
        ("[verdict]", REQUIRE),
        ("episodes = 3", "episodes = 16"),
        ("\"pid-tuned\"]", "\"pid-robust-observer\"]"),
    ]);
    let said = place
        .program(&["run", "c.toml", "--out", "out", "--verbose"])
        .stdout;
    let sure = how_sure(&Campaign::load(&place.path("c.toml")).unwrap());
    assert!(sure.contains("exact tests agree"));
    let parts: Vec<&str> = said.split(&format!("\nin short ({sure})\n")).collect();
    let [before, end] = parts.as_slice() else {
        panic!("{said}")
    };
    // The verdict is the last thing that is said.
    let lines: Vec<&str> = end.lines().collect();
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(lines[0].starts_with(
        "  ftc does better than pid: it fails in 0.0 % of the episodes, the other in "
    ));
    assert!(lines[1].starts_with("  ftc does better than pid-robust-observer: neither fails; "));
    let lines: Vec<&str> = before.lines().collect();
    let at = |wanted: &str| {
        lines
            .iter()
            .position(|line| line.starts_with(wanted))
            .unwrap()
    };
    assert!(at("on what terms: ") < at("written to out"));
    let at = at("requirements: the failure rate with 95 % confidence");
    // 1 - 0.05^(1/16) = 0.17074, and a bound is never rounded down.
    assert_eq!(
        lines[at + 1],
        "  met    require[0]  ftc  below 0.1708, required 0.6400 (0 of 16 failed)"
    );
    assert!(
        lines[at + 2].starts_with("  UNMET  require[1]  pid  below "),
        "{}",
        lines[at + 2]
    );
    // What fits a screen ends the same, and says where the rest is.
    let short = place.program(&["run", "c.toml", "--out", "out"]).stdout;
    assert!(
        short.ends_with(end) && short.lines().count() <= 40,
        "{short}"
    );
    assert!(
        short.contains("written to out: report.html has the whole, --verbose prints more of it")
    );
    // The manifest keeps them, so that a report can be made of the directory alone.
    let manifest: serde_json::Value =
        serde_json::from_str(&place.read("out/manifest.json")).unwrap();
    let [met, unmet] = [0, 1].map(|index| &manifest["requirements"][index]);
    assert_eq!(
        (&met["controller"], &met["stratum"]),
        (&"ftc".into(), &"all".into())
    );
    assert_eq!((&unmet["limit"], &unmet["n"]), (&0.5.into(), &16.into()));
    let found = place.program(&["run", "c.toml", "--out", "out", "--json"]);
    let found: serde_json::Value = serde_json::from_str(&found.stdout).unwrap();
    for (result, met) in [(0, true), (1, false)] {
        let (own, kept) = (
            &found["requirements"][result],
            &manifest["requirements"][result],
        );
        assert_eq!(own["met"], met);
        for key in ["controller", "stratum", "limit", "bound_95", "n", "failed"] {
            assert_eq!(own[key], kept[key], "{key}");
        }
    }
    assert_eq!(found["verdict"].as_array().unwrap().len(), 2);
    // The manifest of a run that knew nothing of them.
    let mut older = manifest;
    older.as_object_mut().unwrap().remove("requirements");
    older.as_object_mut().unwrap().remove("blake3");
    place.write("out/manifest.json", older.to_string());
    place.succeeds(&["replay", "out", "--episode", "0"]);
}

#[test]
fn a_replay_as_json_says_what_was_simulated_what_was_written_and_the_attenuation() {
    let place = Place::smoke(&[("probability = 0.25", "probability = 1.0")]);
    place.succeeds(&["run", "c.toml", "--out", "out", "--csv"]);
    let replay = ["replay", "out", "--episode", "1", "--json"];
    let found = place.json(&replay);
    for (key, value) in [
        ("run", "out".into()),
        ("episode", 1.into()),
        ("controller", "ftc".into()),
        ("file", "out/replay-1-ftc.parquet".into()),
        ("samples", 601.into()),
        ("stand_in", serde_json::Value::Null),
    ] {
        assert_eq!(found[key], value, "{key}");
    }
    assert!(place.path("out/replay-1-ftc.parquet").is_file());
    let rows = place.rows("out/channels.csv");
    let mut of_run = rows
        .iter()
        .filter(|row| row["episode"] == "1" && row["controller"] == "ftc");
    let (mut holds, mut not_applicable) = (0, 0);
    for agent in found["agents"].as_array().unwrap() {
        assert_eq!(agent["status"], "ok");
        assert_eq!(agent["failed_at_s"], serde_json::Value::Null);
        for channel in agent["channels"].as_array().unwrap() {
            let row = of_run.next().unwrap();
            assert_eq!(channel["channel"], *row["channel"]);
            assert_eq!(
                channel["rmse"].as_f64().unwrap(),
                row["rmse"].parse::<f64>().unwrap()
            );
            let attenuation = &channel["attenuation"];
            if attenuation.is_null() {
                not_applicable += 1;
                let reason = channel["attenuation_not_applicable"].as_str().unwrap();
                assert!(reason.contains("loss-of-effectiveness"), "{reason}");
            } else {
                holds += i32::from(attenuation["holds"] == true);
                let [level, certified] =
                    ["level", "certified"].map(|key| attenuation[key].as_f64().unwrap());
                assert!(0.0 < level && level < certified);
            }
        }
    }
    // One channel of each of the three UAVs loses effectiveness.
    assert_eq!((holds, not_applicable), (15, 3));
    assert!(of_run.next().is_none());
    // The PID fails here, and the replay says when.
    let pid = place.json(&[&replay as &[_], &["--controller", "pid"]].concat());
    let failed = pid["agents"].as_array().unwrap().iter();
    let failed = failed.filter(|agent| agent["status"] == "exceeded");
    let times: Vec<f64> = failed
        .map(|agent| agent["failed_at_s"].as_f64().unwrap())
        .collect();
    assert!(
        !times.is_empty() && times.iter().all(|time| (0.0..=6.0).contains(time)),
        "{times:?}"
    );
}

#[test]
fn a_mistyped_name_is_answered_with_the_nearest_one() {
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--out", "out"]);
    let replay = ["replay", "out", "--episode", "0", "--controller"];
    for (name, near) in [("pid-tuend", "pid-tuned"), ("fct", "ftc")] {
        let hint = format!("did you mean {near:?}?");
        place.refuses(&[&replay as &[_], &[name]].concat(), 2, &[name, &hint]);
    }
    let preset = ["synthesize", "--preset", "uav-papr"];
    place.refuses(&preset, 2, &["'uav-papr'", "'uav-paper'"]);
    let strata = "[[strata]]\nfaults = []\n[[strata]]\nfaults = \"all\"\n";
    for (table, key, near) in [
        (
            "[[require]]\nfailure_rate_upper_95 = 0.1\ncontroller = \"fct\"",
            "require[0].controller",
            "ftc",
        ),
        (
            "[[require]]\nfailure_rate_upper_95 = 0.1\ncontroller = \"ftc\"\nstratum = \"mixd\"",
            "require[0].stratum",
            "mixed",
        ),
        (
            "[[strata]]\nfaults = [\"sensor smoothed-squar\"]",
            "strata[2].faults[0]",
            "sensor smoothed-square",
        ),
    ] {
        let place = Place::smoke(&[("[verdict]", &format!("{strata}{table}\n[verdict]"))]);
        let hint = format!("did you mean {near:?}?");
        place.refuses(&["check", "c.toml"], 2, &[key, &hint]);
    }
    let stop = "[stop]\ncontroller = \"pid-tune\"\nfailure_rate_below = 0.1\n[verdict]";
    let place = Place::smoke(&[("[verdict]", stop)]);
    place.refuses(
        &["check", "c.toml"],
        2,
        &["stop.controller", "did you mean \"pid-tuned\"?"],
    );
}

#[test]
fn a_mistyped_adapter_is_answered_with_the_nearest_word_of_a_name() {
    let Some(name) = crate::common::adapter_or_skip() else {
        return;
    };
    let word = name.split_whitespace().next().unwrap();
    let mistyped = format!("{word}x");
    let place = Place::smoke(&[]);
    place.refuses(
        &["run", "c.toml", "--backend", "gpu", "--adapter", &mistyped],
        2,
        &[
            "no adapter of this name",
            &format!("did you mean {word:?}?"),
        ],
    );
}

#[test]
fn a_replay_that_is_printed_can_be_pasted_into_a_shell() {
    let place = Place::smoke(&[]);
    let said = place.succeeds(&["run", "c.toml", "--verbose", "--out", "it's my run"]);
    let (_, printed) = said.split_once(": urts-mc replay ").unwrap();
    let arguments = printed.lines().next().unwrap();
    assert!(arguments.starts_with(r"'it'\''s my run' --episode "));
    let ended = std::process::Command::new("sh")
        .current_dir(place.0.path())
        .arg("-c")
        .arg(format!("\"$0\" replay {arguments}"))
        .arg(env!("CARGO_BIN_EXE_urts-mc"))
        .output()
        .unwrap();
    assert!(ended.status.success() && ended.stderr.is_empty());
    // Quotes stand only where a shell needs them.
    for (dir, shown) in [
        ("reports/smoke", "reports/smoke"),
        ("/runs/2026-11:a,b_c@d+e=f%", "/runs/2026-11:a,b_c@d+e=f%"),
        ("a$b", "'a$b'"),
        ("~x", "'~x'"),
        ("-x", "./-x"),
        ("", "''"),
    ] {
        assert_eq!(
            command(dir.as_ref(), 9, "pid"),
            format!("urts-mc replay {shown} --episode 9 --controller pid")
        );
    }
}
