//! What several test modules need.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, Once, OnceLock};
use urts_mc::backend::EpisodeResult;
use urts_mc::backend::cpu::{Cpu, Precision};
use urts_mc::backend::gpu::{Gpu, Wanted, adapters};
use urts_mc::campaign::{AgentGroup, Campaign, Setting};
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
    altered(name, &[])
}

/// A shipped campaign with changes laid over it, see [`settings`].
pub(crate) fn altered(name: &str, changes: &[&str]) -> Campaign {
    altered_file(&format!("campaigns/{name}.toml"), changes)
}

/// A campaign file of this repository with changes laid over it, see [`settings`].
pub(crate) fn altered_file(file: &str, changes: &[&str]) -> Campaign {
    let overlay = settings(changes);
    named_if_a_test_fails(file, &overlay);
    Campaign::load_with(&repository(file), &overlay).unwrap_or_else(|error| panic!("{error}"))
}

/// A campaign that [`altered`] or this has made, with further changes laid over it.
pub(crate) fn further(base: &Campaign, changes: &[&str]) -> Campaign {
    let overlay = [&base.overlay[..], &settings(changes)].concat();
    let file = base.path.strip_prefix(repository("")).unwrap_or(&base.path);
    named_if_a_test_fails(&file.display().to_string(), &overlay);
    Campaign::parse_with(&base.text, &base.path, &overlay).unwrap_or_else(|error| panic!("{error}"))
}

/// Has a failure say which campaigns its test has asked for, as commands that run them. What
/// a test changes in a parsed campaign (`Campaign::with`) is not in them.
fn named_if_a_test_fails(file: &str, overlay: &[Setting]) {
    thread_local! {
        static ASKED: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
    }
    static HOOK_SET: Once = Once::new();
    HOOK_SET.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            usual(panic);
            for command in ASKED.with_borrow(Clone::clone) {
                eprintln!("a campaign of this test: {command}");
            }
        }));
    });
    let set = overlay.iter().map(|setting| format!(" --set '{setting}'"));
    let command = format!("urts-mc run {file}{}", set.collect::<String>());
    ASKED.with_borrow_mut(|asked| {
        if !asked.contains(&command) {
            asked.push(command);
        }
    });
}

/// Changes of a campaign: settings, as `--set` takes them, and pieces of a campaign file, such as `[[fault]]` and what
/// belongs to it, whose lists of tables go behind those of the campaign and whose other keys replace its own.
pub(crate) fn settings(changes: &[&str]) -> Vec<Setting> {
    let of_piece = |piece: &str| -> Vec<String> {
        let piece: toml::Table = piece.parse().unwrap();
        let of_key = |(key, value)| match value {
            toml::Value::Array(entries) => entries
                .into_iter()
                .map(|entry| format!("{key}.+={entry}"))
                .collect(),
            toml::Value::Table(table) => table
                .into_iter()
                .map(|(name, value)| format!("{key}.{name}={value}"))
                .collect(),
            value => vec![format!("{key}={value}")],
        };
        piece.into_iter().flat_map(of_key).collect()
    };
    let all = changes.iter().flat_map(|change| {
        if change.is_empty() || change.starts_with('[') || change.starts_with('\n') {
            of_piece(change)
        } else {
            vec![(*change).to_string()]
        }
    });
    all.map(|setting| {
        setting
            .parse()
            .unwrap_or_else(|error| panic!("{setting}: {error}"))
    })
    .collect()
}

/// A golden file.
pub(crate) fn golden(name: &str) -> serde_json::Value {
    serde_json::from_str(
        &std::fs::read_to_string(repository(&format!("tests/golden/{name}"))).unwrap(),
    )
    .unwrap()
}

/// The gains of a campaign with a single group of agents, synthesized or read once for all tests whose campaigns agree
/// in all that gains depend on.
pub(crate) fn gains(campaign: &Campaign) -> &'static GainSet {
    let [only] = gains_of_groups(campaign) else {
        panic!("{} has several groups", campaign.name);
    };
    only
}

/// The same of each group of agents.
pub(crate) fn gains_of_groups(campaign: &Campaign) -> &'static [GainSet] {
    type Known = HashMap<String, &'static OnceLock<Vec<GainSet>>>;
    static KNOWN: LazyLock<Mutex<Known>> = LazyLock::new(Mutex::default);
    // What is designed, for which plant, and what the step is checked against.
    let of_group = |group: &AgentGroup| {
        let scales = (&group.mass_scale, &group.inertia_scale);
        format!("{:?}", (&group.synthesis, &group.agent, scales))
    };
    let groups: Vec<String> = campaign.groups().iter().map(of_group).collect();
    let decides = (groups, &campaign.controllers, campaign.time.step_s);
    let own = *KNOWN
        .lock()
        .unwrap()
        .entry(format!("{decides:?}"))
        .or_insert_with(|| Box::leak(Box::default()));
    own.get_or_init(|| GainSet::of_groups(campaign).unwrap())
}

/// Simulates the first group of a campaign with its own gains on the widest lanes.
pub(crate) fn simulate(campaign: &Campaign, precision: Precision) -> Vec<EpisodeResult> {
    simulate_group(campaign, 0, precision)
}

/// Simulates a group of a campaign with its own gains on the widest lanes.
pub(crate) fn simulate_group(
    campaign: &Campaign,
    index: usize,
    precision: Precision,
) -> Vec<EpisodeResult> {
    let loops = gains_of_groups(campaign)[index].loops();
    let cpu = Cpu::new(&campaign.groups()[index], &loops, precision, None);
    cpu.simulate(0..campaign.episodes, &|_| ())
}

/// The text of a manifest as an older version would have written it, which gave it no hash of its own.
pub(crate) fn without_hash(manifest: &str) -> String {
    let (before, _) = manifest.rsplit_once(",\n  \"blake3\": ").unwrap();
    format!("{before}\n}}\n")
}

/// The tables of a campaign.
pub(crate) fn tables(campaign: &Campaign, precision: Precision) -> Tables {
    let mut tables = Tables::new(campaign);
    let groups = 0..campaign.groups().len();
    let groups: Vec<Vec<EpisodeResult>> = groups
        .map(|index| simulate_group(campaign, index, precision))
        .collect();
    for episode in 0..campaign.episodes as usize {
        let of_groups: Vec<&EpisodeResult> = groups.iter().map(|group| &group[episode]).collect();
        tables.add(campaign, &of_groups);
    }
    tables
}

/// Name of the adapter: hardware if there is any, else the first; none where there is none and none is required, and
/// none under URTS_REQUIRE_GPU=0.
pub(crate) fn adapter_or_skip() -> Option<String> {
    if std::env::var("URTS_REQUIRE_GPU").as_deref() == Ok("0") {
        println!("SKIPPED: no adapter is wanted");
        return None;
    }
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
