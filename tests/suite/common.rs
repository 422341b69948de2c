//! What several test modules need.

use std::path::{Path, PathBuf};
use urts_mc::backend::EpisodeResult;
use urts_mc::backend::cpu::{Cpu, Precision};
use urts_mc::backend::gpu::{Gpu, Wanted, adapters};
use urts_mc::campaign::Campaign;
use urts_mc::controllers::GainSet;
use urts_mc::results::tables::Tables;

/// A file of this repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The files of the shipped campaigns.
pub(crate) fn shipped_campaigns() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(repository("campaigns")).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let is_campaign = |path: &PathBuf| path.extension().is_some_and(|own| own == "toml");
    paths.filter(is_campaign).collect()
}

/// A shipped campaign.
pub(crate) fn campaign(name: &str) -> Campaign {
    Campaign::load(&repository(&format!("campaigns/{name}.toml"))).unwrap()
}

/// A shipped campaign with parts of its text replaced; each part must be there.
pub(crate) fn altered(name: &str, changes: &[(&str, &str)]) -> Campaign {
    let path = repository(&format!("campaigns/{name}.toml"));
    let mut text = std::fs::read_to_string(&path).unwrap();
    for (old, new) in changes {
        assert!(text.contains(old), "{name}.toml does not contain {old:?}");
        text = text.replace(old, new);
    }
    Campaign::parse(&text, &path).unwrap()
}

/// A golden file.
pub(crate) fn golden(name: &str) -> serde_json::Value {
    serde_json::from_str(
        &std::fs::read_to_string(repository(&format!("tests/golden/{name}"))).unwrap(),
    )
    .unwrap()
}

/// Flies a campaign with its own gains on the widest lanes.
pub(crate) fn fly(campaign: &Campaign, precision: Precision) -> Vec<EpisodeResult> {
    let gains = GainSet::synthesize_or_load(campaign).unwrap();
    Cpu::new(campaign, &gains.loops(), precision, None).fly(0..campaign.episodes, &|_| ())
}

/// The tables of a campaign.
pub(crate) fn tables(campaign: &Campaign, precision: Precision) -> Tables {
    let mut tables = Tables::new(campaign);
    for flown in fly(campaign, precision) {
        tables.add(campaign, &flown);
    }
    tables
}

/// Name of the adapter: hardware if there is any, else the first; none where there is none and none is required.
pub(crate) fn adapter_or_skip() -> Option<String> {
    let name = adapters().first().map(|report| report.adapter.name.clone());
    if name.is_none() {
        assert!(
            std::env::var("URTS_REQUIRE_GPU").as_deref() != Ok("1"),
            "URTS_REQUIRE_GPU=1, but there is no adapter"
        );
        println!("SKIPPED: no adapter");
    }
    name
}

/// A device; none where there is no adapter and none is required. An adapter that gives no device is a failure.
pub(crate) fn gpu_or_skip() -> Option<Gpu> {
    adapter_or_skip().map(|name| Gpu::open(Wanted::Named(&name)).unwrap())
}
