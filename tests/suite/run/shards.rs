//! Shards of a run as a program flies them.

use crate::common::altered;
use urts_mc::backend::cpu::Precision;
use urts_mc::run::directory::OutputDir;
use urts_mc::run::shard::{Shard, Shards};
use urts_mc::run::status::Status;
use urts_mc::run::{Extras, RunError, fly_shard};
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
