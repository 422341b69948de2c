//! Shards of a run as a program flies them.

use crate::common::altered;
use urts_mc::backend::cpu::Precision;
use urts_mc::run::directory::OutputDir;
use urts_mc::run::shard::{Shard, Shards};
use urts_mc::run::status::Status;
use urts_mc::run::{Extras, Merging, RunError, fly_shard, merge, run};
use urts_mc::simulation::RunOptions;

#[test]
fn a_shard_that_is_ended_before_it_flew_anything_leaves_what_others_have_flown() {
    let campaign = altered("smoke", &["episodes=1100"]);
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run");
    let options = RunOptions::cpu(Precision::F32);
    let fly = |number: u32, halt: &(dyn Fn() -> bool + Sync)| {
        let out = OutputDir::claim_shared(&path, &campaign, false).unwrap();
        let shard = Shard::new(number, 2).unwrap();
        let extras = Extras {
            halt,
            ..Extras::default()
        };
        let shards = Shards { of: 2, first: 1 };
        let flown = fly_shard(&campaign, &options, &out, (shard, shards), extras, &|_| ());
        flown.map_err(Box::new)
    };
    assert_eq!(fly(1, &|| false).unwrap().episodes, 1024);
    let ended = fly(2, &|| true).unwrap_err();
    let RunError::Partial { kept, asked, .. } = *ended else {
        panic!("{ended}");
    };
    assert_eq!((kept, asked), (0, 76));
    assert_eq!(Status::of(&path).unwrap().kept, 1024);
    assert_eq!(fly(2, &|| false).unwrap().episodes, 76);
    assert_eq!(Status::of(&path).unwrap().kept, 1100);
}

#[test]
fn a_shard_of_a_run_that_may_stop_early_flies_all_its_episodes() {
    // The FTC hardly fails here: the first looks prove it.
    let stop = "[stop]\ncontroller = \"ftc\"\nfailure_rate_below = 0.5\nevery = 100";
    let campaign = altered("smoke", &["episodes=2100", stop]);
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run");
    let options = RunOptions::cpu(Precision::F32);
    let alone = OutputDir::claim(&dir.path().join("alone"), &campaign, false).unwrap();
    let alone = run(&campaign, &options, &alone, Extras::default(), &|_| ()).unwrap();
    assert!(
        alone.manifest.episodes < 1000,
        "{}",
        alone.manifest.episodes
    );
    for number in [1, 2] {
        let out = OutputDir::claim_shared(&path, &campaign, false).unwrap();
        let shard = (Shard::new(number, 2).unwrap(), Shards { of: 2, first: 1 });
        let extras = Extras::default();
        let flown = fly_shard(&campaign, &options, &out, shard, extras, &|_| ());
        assert_eq!(flown.unwrap().episodes, [1024, 1076][number as usize - 1]);
    }
    // Made one, it ends where the run of one process does.
    let merging = Merging::default();
    let dirs = [path.clone()];
    let (_, merged) = merge(&dirs, &path, &options, merging, &|_| ()).unwrap();
    assert_eq!(merged.manifest.episodes, alone.manifest.episodes);
    for name in ["episodes.parquet", "summary.parquet", "ranking.parquet"] {
        let read = |run: &str| std::fs::read(dir.path().join(run).join(name)).unwrap();
        assert!(read("run") == read("alone"), "{name}");
    }
}
