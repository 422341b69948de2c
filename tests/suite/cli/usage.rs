//! The command line itself.

use super::Place;
use std::fs::File;
use std::process::{Command, Stdio};

#[test]
fn a_wrong_command_line_exits_with_2_and_says_what_would_be_right() {
    let place = Place::smoke(&[]);
    for (arguments, words) in [
        ("run", ["<CAMPAIGN>", "Usage"]),
        ("rum c.toml", ["'rum'", "'run'"]),
        ("run c.toml --epsiodes 3", ["'--epsiodes'", "'--episodes'"]),
        ("run c.toml --episodes 0", ["'0'", "1..=4294967295"]),
        ("run c.toml --episodes -1", ["'-1'", "1..=4294967295"]),
        (
            "run c.toml --seed -1",
            ["'-1'", "from 0 to 18446744073709551615"],
        ),
        (
            "run c.toml --seed 18446744073709551616",
            ["--seed", "from 0 to 18446744073709551615"],
        ),
        (
            "plan --failure-rate 0.01 --confidence 95",
            ["'95'", "0.95 for 95 percent"],
        ),
        ("plan --failure-rate 1", ["'1'", "0.01 for one percent"]),
        ("run c.toml --precision f16", ["'f16'", "f32, f64"]),
        ("run c.toml --simd neon", ["'neon'", "auto, scalar"]),
        (
            "run c.toml --threads 100000000",
            ["'100000000'", "0..=1024"],
        ),
        ("run c.toml --threads -1", ["'-1'", "0..=1024"]),
        ("replay out", ["--episode <EPISODE>", "Usage"]),
        ("check c.toml d.toml", ["'d.toml'", "Usage"]),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        place.refuses(&arguments, 2, &words);
    }
    let ended = place.program(&[]);
    assert_eq!((ended.code, ended.stdout.as_str()), (2, ""));
    assert!(ended.stderr.contains("Usage"), "{}", ended.stderr);
}

#[test]
fn a_campaign_file_that_cannot_be_read_is_named() {
    let place = Place::smoke(&[]);
    place.write("bytes.toml", [0xff, 0xfe, 0x00]);
    for command in ["run", "check", "synthesize"] {
        for file in ["absent.toml", ".", "bytes.toml", "c.toml/below"] {
            let named = format!("error: {file}: cannot be read (");
            place.refuses(
                &[command, file],
                2,
                &[&named, "name an existing campaign file"],
            );
        }
    }
}

#[test]
fn a_replay_of_what_was_not_simulated_is_refused() {
    let place = Place::smoke(&[]);
    place.succeeds(&["run", "c.toml", "--out", "out"]);
    let replay = |more: &str, words: &[&str]| {
        let arguments: Vec<&str> = ["replay"].into_iter().chain(more.split(' ')).collect();
        place.refuses(&arguments, 2, words);
    };
    replay(
        "out --episode 3",
        &["--episode 3", "3 episodes", "use 0 to 2"],
    );
    replay("out --episode -1", &["'-1'"]);
    replay(
        "out --episode 0 --controller lqr",
        &[
            "--controller lqr",
            "no such controller",
            "ftc, pid, pid-tuned",
        ],
    );
    for interval in ["0", "-1", "nan", "7", "0.003"] {
        replay(
            &format!("out --episode 0 --interval {interval}"),
            &["--interval", "0.002 s", "use a multiple of the step"],
        );
    }
    replay(
        "absent --episode 0",
        &[
            "error: absent: ",
            "name the output directory of a finished run",
        ],
    );
    replay(
        "c.toml --episode 0",
        &["error: c.toml: ", "name the output directory"],
    );
    replay(
        "out --episode 0 --out c.toml/below",
        &["c.toml", "cannot be written"],
    );
    // Not even a typing error replaces a file of the run.
    replay(
        "out --episode 0 --out out/manifest.json",
        &["--out out/manifest.json: exists already", "--overwrite"],
    );
    place.write("mine.parquet", "old");
    place.succeeds(&[
        "replay",
        "out",
        "--episode",
        "0",
        "--overwrite",
        "--out",
        "mine.parquet",
    ]);
    assert!(place.read_bytes("mine.parquet").starts_with(b"PAR1"));

    std::fs::remove_file(place.path("out/gains.json")).unwrap();
    replay(
        "out --episode 0",
        &["error: out/gains.json: is not the file that the run wrote"],
    );
    let manifest = place.read("out/manifest.json");
    place.write("out/manifest.json", &manifest[..200]);
    replay(
        "out --episode 0",
        &["error: out: holds no readable run", "manifest.json"],
    );
}

#[test]
fn help_lists_the_commands_and_the_exit_codes() {
    let place = Place::smoke(&[]);
    let help = place.succeeds(&["--help"]);
    for word in [
        "run",
        "check",
        "synthesize",
        "replay",
        "schema",
        "3 synthesis failed",
        "4 a [[require]]",
    ] {
        assert!(help.contains(word), "{word:?} is missing from: {help}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_printed_exits_with_1_and_a_reader_that_left_is_none() {
    let schema = |stdout: Stdio| {
        Command::new(env!("CARGO_BIN_EXE_urts-mc"))
            .arg("schema")
            .stdout(stdout)
            .output()
            .unwrap()
    };
    let full = schema(
        File::options()
            .write(true)
            .open("/dev/full")
            .unwrap()
            .into(),
    );
    assert_eq!(full.status.code(), Some(1));
    let said = String::from_utf8(full.stderr).unwrap();
    assert!(
        said.starts_with("error: standard output: cannot be written (No space left"),
        "{said}"
    );

    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let left = schema(writer.into());
    assert_eq!((left.status.code(), left.stderr.len()), (Some(0), 0));
}

#[test]
fn plan_tells_the_episodes_that_a_claim_needs() {
    let place = Place::smoke(&[]);
    for (rate, episodes) in [
        ("0.01", 299),
        ("0.0027", 1109),
        ("0.001", 2995),
        ("0.0001", 29956),
    ] {
        let said = place.json(&[
            "plan",
            "--failure-rate",
            rate,
            "--confidence",
            "0.95",
            "--json",
        ]);
        let rows = said["rows"].as_array().unwrap();
        assert_eq!(rows.len(), 6);
        assert_eq!(rows[0]["episodes"], episodes);
        assert!(rows[1]["episodes"].as_u64() > rows[0]["episodes"].as_u64());
        let text = place.succeeds(&["plan", "--failure-rate", rate]);
        assert!(text.contains(&format!(" {episodes} ")), "{text}");
    }
    // Neither "0%" nor "100%".
    let rare = [
        "plan",
        "--failure-rate",
        "1e-12",
        "--confidence",
        "0.9999999",
    ];
    let text = place.succeeds(&rare);
    let claim = "to be 99.99999% sure that fewer than 0.0000000001% of all episodes fail\n";
    assert!(text.starts_with(claim), "{text}");
    let text = place.succeeds(&["plan", "--failure-rate", "0.0027"]);
    let claim = "to be 95% sure that fewer than 0.27% of all episodes fail\n";
    assert!(text.starts_with(claim), "{text}");
    let text = place.succeeds(&["plan", "--failure-rate", "1e-17"]);
    assert!(text.contains("\n  no number of episodes"), "{text}");
    for rate in ["0", "1", "-0.1", "nan", "1%"] {
        place.refuses(&["plan", "--failure-rate", rate], 2, &["--failure-rate"]);
    }
}
