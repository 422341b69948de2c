//! A run by several processes: shards, what is known of them while they fly, and the one run that they make.

use super::parts::{place, tables, until};
use crate::common::repository;
use serde_json::{Value, json};
use std::ffi::OsStr;
use std::io::Write;
use std::process::{Command, Stdio};
use urts_mc::run::shard::{AskedShard, Shard, Shards, shard_of};

/// The command of a run of five parts.
pub(super) fn run<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let begin = [
        "run",
        "c.toml",
        "--out",
        out,
        "--quiet",
        "--episodes",
        "4500",
    ];
    begin.into_iter().chain(more.iter().copied()).collect()
}

#[test]
fn shards_in_any_order_and_of_several_directories_make_the_run_of_one_process() {
    let place = place();
    assert_eq!(place.program(&run("whole", &[])).code, 0);
    let whole = tables(&place, "whole");
    for shard in ["3/3", "1/3"] {
        let ended = place.program(&run("one", &["--shard", shard]));
        assert_eq!((ended.code, ended.stderr.as_str()), (0, ""));
    }
    // What is missing is told, in ranges and as an array.
    let said = place.program(&["merge", "one"]);
    assert_eq!(said.code, 5, "{}", said.stderr);
    for words in [
        "partial: one: 2048 of 4500 episodes are missing (1024 to 3071)",
        "submit the shards 2 again (--array=2)",
    ] {
        assert!(said.stderr.contains(words), "{}", said.stderr);
    }
    assert_eq!(place.succeeds(&["status", "one", "--missing"]), "2\n");
    let status = place.program(&["status", "one", "--json"]);
    let status: serde_json::Value = serde_json::from_str(&status.stdout).unwrap();
    let shards = status["shards"].as_array().unwrap().iter();
    let states: Vec<&str> = shards.map(|own| own["state"].as_str().unwrap()).collect();
    assert_eq!(states, ["done", "waiting", "done"]);
    assert_eq!(
        (&status["kept"], &status["asked"]),
        (&2452.into(), &4500.into())
    );

    // The second is flown elsewhere, twice; the directories are merged into a third.
    for out in ["two", "three"] {
        let ended = place.program(&run(out, &["--shard", "2/3"]));
        assert_eq!((ended.code, ended.stderr.as_str()), (0, ""));
    }
    let merge = ["merge", "one", "two", "three", "--out", "all", "--quiet"];
    let ended = place.program(&merge);
    assert_eq!((ended.code, ended.stderr.as_str()), (0, ""));
    assert!(tables(&place, "all") == whole);
    // Into the first, which then has all.
    let ended = place.program(&["merge", "one", "two"]);
    assert_eq!(ended.code, 0, "{}", ended.stderr);
    assert!(
        ended.stdout.contains("short: 4500 episodes"),
        "{}",
        ended.stdout
    );
    assert!(tables(&place, "one") == whole);
    assert!(!place.path("one/.urts-mc-parts").exists());
    // A process alone goes on with what shards have flown.
    assert_eq!(place.program(&run("two", &[])).code, 0);
    assert!(tables(&place, "two") == whole);
}

#[test]
fn what_is_no_shard_of_the_same_run_is_refused_by_merge() {
    let place = place();
    let fly = |out: &str, shard: &str, more: &[&str]| {
        let ended = place.program(&run(out, &[&["--shard", shard], more].concat()));
        assert_eq!((ended.code, ended.stderr.as_str()), (0, ""));
    };
    fly("a", "1/2", &[]);
    fly("b", "2/2", &["--seed", "7"]);
    place.refuses(
        &["merge", "a", "b"],
        2,
        &["b: is not of the run in a: seed 7"],
    );
    place.refuses(&["merge", "nowhere"], 2, &["nowhere: keeps no episodes"]);
    fly("a", "2/2", &["--simd", "scalar"]);
    place.refuses(
        &["merge", "a"],
        2,
        &["a: its episodes were simulated by ", "--allow-mixed"],
    );
    let ended = place.program(&["merge", "a", "--allow-mixed", "--quiet"]);
    assert_eq!((ended.code, ended.stderr.as_str()), (0, ""));
    // The same episodes with other numbers contradict each other.
    fly("c", "1/2", &[]);
    fly("d", "1/2", &["--simd", "scalar"]);
    let words = [
        "c/.urts-mc-parts/part-00000000",
        "is not what d holds of the same episodes",
    ];
    place.refuses(&["merge", "c", "d"], 1, &words);
    // Of parts that were changed, the range is missing.
    let name = "c/.urts-mc-parts/part-00000001";
    let mut bytes = place.read_bytes(name);
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    place.write(name, bytes);
    fly("c", "2/2", &[]);
    let said = place.program(&["merge", "c"]);
    assert_eq!(said.code, 5, "{}", said.stderr);
    assert!(
        said.stderr
            .contains("1024 of 4500 episodes are missing (1024 to 2047)"),
        "{}",
        said.stderr
    );
    assert!(
        said.stderr
            .contains("part-00000001 is left out (its content was changed)"),
        "{}",
        said.stderr
    );
    // Its shard flies them again.
    fly("c", "1/2", &[]);
    assert_eq!(place.program(&["merge", "c", "--quiet"]).code, 0);
}

#[cfg(target_os = "linux")]
#[test]
fn a_shard_is_flown_by_one_process_beside_others_and_a_killed_one_is_told_from_one_that_waits() {
    let place = place();
    let endless = |out, shard| {
        let mut all = run(out, &["--shard", shard]);
        let place = all.iter().position(|word| *word == "4500").unwrap();
        all[place] = "4000000";
        all
    };
    let mut first = place.command(&endless("out", "1/4")).spawn().unwrap();
    let mut second = place.command(&endless("out", "2/4")).spawn().unwrap();
    let part = |number: u32| place.path(&format!("out/.urts-mc-parts/part-{number:08}"));
    // 3,907 parts: those of the second begin with 976.
    until(&mut first, &|| part(0).exists());
    until(&mut second, &|| part(976).exists());
    let said = place.program(&endless("out", "2/4"));
    assert_eq!(said.code, 2);
    let holder = format!("process {} on ", second.id());
    assert!(
        said.stderr.contains(&holder) && said.stderr.contains("(shard 2/4)"),
        "{}",
        said.stderr
    );
    // Neither one that flies all, nor a merge, comes between them.
    let mut alone = endless("out", "2/4");
    alone.truncate(alone.len() - 2);
    for command in [alone, vec!["merge", "out"]] {
        let said = place.program(&command);
        assert_eq!(said.code, 2, "{}", said.stderr);
        assert!(
            said.stderr.contains("out: is being written by process "),
            "{}",
            said.stderr
        );
    }
    second.kill().unwrap();
    second.wait().unwrap();
    let status = place.program(&["status", "out", "--json"]);
    let status: serde_json::Value = serde_json::from_str(&status.stdout).unwrap();
    let shards = status["shards"].as_array().unwrap().iter();
    let states: Vec<&str> = shards.map(|own| own["state"].as_str().unwrap()).collect();
    assert_eq!(states, ["running", "failed", "waiting", "waiting"]);
    assert!(status["left_s"].as_f64().unwrap() > 0.0);
    assert_eq!(
        place.succeeds(&["status", "out", "--missing"]),
        "2-4
"
    );
    first.kill().unwrap();
    first.wait().unwrap();
}

#[test]
fn shards_have_all_parts_once_and_as_many_as_each_other() {
    for count in [0, 1, 5, 7, 977, 4_000_000] {
        for of in [1, 2, 3, 8, 100] {
            let shards = (1..=of).map(|number| Shard::new(number, of).unwrap().parts(count));
            let shards: Vec<std::ops::Range<u32>> = shards.collect();
            assert_eq!((shards[0].start, shards.last().unwrap().end), (0, count));
            assert!(shards.windows(2).all(|pair| pair[0].end == pair[1].start));
            let sizes = shards.iter().map(ExactSizeIterator::len);
            assert!(sizes.clone().max().unwrap() - sizes.min().unwrap() <= 1);
        }
    }
    assert!(Shard::new(0, 3).is_none() && Shard::new(4, 3).is_none());
}

#[test]
fn the_shard_of_a_task_is_what_its_engine_says_and_an_unknown_number_of_them_is_refused() {
    let found = |variables: &[(&str, &str)], asked, begun| {
        let variable = |name: &str| {
            let mut own = variables.iter().filter(|(key, _)| *key == name);
            own.next().map(|(_, value)| (*value).to_string())
        };
        let found = shard_of(&variable, asked, begun);
        found.map(|(shard, shards, said)| (shard.to_string(), shards.first, said))
    };
    let slurm = |id, min, max, count| {
        [
            ("SLURM_ARRAY_TASK_ID", id),
            ("SLURM_ARRAY_TASK_MIN", min),
            ("SLURM_ARRAY_TASK_MAX", max),
            ("SLURM_ARRAY_TASK_COUNT", count),
        ]
    };
    let begun = |of, first| Some(Shards { of, first });
    let shard =
        |variables: &[(&str, &str)], asked, begun| found(variables, asked, begun).unwrap().0;
    assert_eq!(shard(&slurm("3", "1", "8", "8"), None, None), "3/8");
    assert_eq!(shard(&slurm("0", "0", "7", "8"), None, None), "1/8");
    // Those that are missing, again: the directory knows of how many.
    assert_eq!(shard(&slurm("5", "3", "5", "2"), None, begun(8, 1)), "5/8");
    assert_eq!(shard(&slurm("1", "1", "2", "2"), None, begun(8, 1)), "1/8");
    assert_eq!(shard(&slurm("4", "2", "4", "2"), None, begun(8, 0)), "5/8");
    assert_eq!(shard(&slurm("5", "3", "5", "2"), Some(8), None), "3/8");
    let sge = [
        ("SGE_TASK_ID", "2"),
        ("SGE_TASK_FIRST", "1"),
        ("SGE_TASK_LAST", "4"),
    ];
    assert_eq!(shard(&sge, None, None), "2/4");
    let kubernetes = [("JOB_COMPLETION_INDEX", "0"), ("JOB_COMPLETIONS", "5")];
    assert_eq!(shard(&kubernetes, None, None), "1/5");
    let aws = [
        ("AWS_BATCH_JOB_ARRAY_INDEX", "4"),
        ("AWS_BATCH_JOB_ARRAY_SIZE", "5"),
    ];
    assert_eq!(shard(&aws, None, None), "5/5");
    assert_eq!(shard(&[("PBS_ARRAY_INDEX", "2")], Some(4), None), "2/4");
    let said = found(&kubernetes, None, None).unwrap().2;
    assert_eq!(said, "shard 1/5, by JOB_COMPLETION_INDEX = 0 of Kubernetes");

    for (variables, asked, words) in [
        (
            &[("PBS_ARRAY_INDEX", "2")][..],
            None,
            "but not of how many; say it as auto/8",
        ),
        (
            &[("JOB_COMPLETION_INDEX", "2")],
            None,
            "but not of how many",
        ),
        (&slurm("5", "3", "5", "2"), None, "but not of how many"),
        (&aws, Some(3), "none of 3 shards that begin with 0"),
        (
            &[("SGE_TASK_ID", "undefined")],
            None,
            "none of SLURM_ARRAY_TASK_ID, ",
        ),
        (&[], None, "give it as 3/8"),
    ] {
        let said = found(variables, asked, None).unwrap_err();
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn a_shard_that_cannot_be_is_refused_with_the_form_that_can() {
    for text in [
        "0/3", "4/3", "3", "3/", "/3", "auto/0", "auto/x", "-1/3", "1/3/5",
    ] {
        let said = text.parse::<AskedShard>().unwrap_err();
        assert!(said.contains("3/8"), "{said}");
    }
    assert_eq!("auto/4".parse(), Ok(AskedShard::Auto(Some(4))));
    let place = place();
    place.refuses(&run("out", &["--shard", "4/3"]), 2, &["--shard", "3/8"]);
    place.refuses(
        &run("out", &["--shard", "1/3", "--restart"]),
        2,
        &["--restart"],
    );
    place.refuses(&["status", "nowhere"], 2, &["nowhere"]);
}

#[test]
fn kubernetes_tasks_that_are_simulated_make_the_run_of_one_process() {
    let place = place();
    let submit = [
        "submit",
        "c.toml",
        "--episodes",
        "4500",
        "--kubernetes",
        "8",
        "--image",
        "registry/urts-mc:0.1",
        "--backend",
        "cpu",
        "--out",
        "out",
        "--time",
        "1h",
    ];
    let list = place.json(&submit);
    let items = list["items"].as_array().unwrap();
    let container = &items[0]["spec"]["template"]["spec"]["containers"][0];
    let words = container["command"].as_array().unwrap().iter();
    let words: Vec<&str> = words.map(|word| word.as_str().unwrap()).collect();
    assert_eq!(words[0], "urts-mc");
    assert_eq!(container["env"][0]["value"], "8");
    let tasks = (0..8).map(|index| {
        let mut command = place.command(&words[1..]);
        let index = index.to_string();
        command.envs([
            ("JOB_COMPLETION_INDEX", index.as_str()),
            ("JOB_COMPLETIONS", "8"),
        ]);
        command.spawn().unwrap()
    });
    for mut task in tasks.collect::<Vec<_>>() {
        assert!(task.wait().unwrap().success());
    }
    let merge = items[1]["spec"]["template"]["spec"]["containers"][0]["command"].as_array();
    let merge: Vec<&str> = merge
        .unwrap()
        .iter()
        .map(|word| word.as_str().unwrap())
        .collect();
    let ended = place.program(&merge[1..]);
    assert_eq!((ended.code, ended.stderr.as_str()), (0, ""));
    assert_eq!(place.program(&run("whole", &[])).code, 0);
    assert!(tables(&place, "out") == tables(&place, "whole"));
}

/// Whether the published schema of Kubernetes takes manifests, and what it says.
fn schema_takes(python: &OsStr, manifests: &Value) -> (bool, String) {
    let mut check = Command::new(python)
        .arg(repository("tests/kubernetes.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let text = manifests.to_string();
    check
        .stdin
        .take()
        .unwrap()
        .write_all(text.as_bytes())
        .unwrap();
    let ended = check.wait_with_output().unwrap();
    let said = [ended.stdout, ended.stderr].concat();
    (
        ended.status.success(),
        String::from_utf8_lossy(&said).into_owned(),
    )
}

#[test]
fn val_kubernetes_manifests_keep_the_published_schema() {
    let Some(python) = std::env::var_os("URTS_PYTHON") else {
        println!("SKIPPED: URTS_PYTHON names no Python with schemas");
        return;
    };
    let place = place();
    let submit = |backend| {
        let words = [
            "submit",
            "c.toml",
            "--kubernetes",
            "8",
            "--image",
            "registry/urts-mc:0.1",
        ];
        place.json(&[&words[..], &["--time", "1h", "--backend", backend]].concat())
    };
    for backend in ["cpu", "gpu"] {
        let (taken, said) = schema_takes(&python, &submit(backend));
        assert!(taken && said.matches("valid in").count() == 4, "{said}");
    }
    // A key that is misspelled, and a number where there has to be a text.
    for (key, value) in [
        ("backofLimitPerIndex", json!(3)),
        ("completionMode", json!(1)),
    ] {
        let mut wrong = submit("cpu");
        wrong["items"][0]["spec"][key] = value;
        let (taken, said) = schema_takes(&python, &wrong);
        assert!(!taken && said.contains(key), "{said}");
    }
}
