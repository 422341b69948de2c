//! The texts that the shipped campaigns need, and their translation as wgpu's Vulkan backend does it.

use naga::back::spv;
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use std::cell::RefCell;
use std::fs;
use std::path::Path;
use urts_mc::backend::gpu::{Gpu, GpuSimulator, Tuning, Wanted, adapters, unrolled};
use urts_mc::campaign::Campaign;
use urts_mc::controllers::GainSet;

/// The entry points with nothing in them, so that the driver at hand need not compile the real ones.
const EMPTY: &str = "
@compute @workgroup_size(1) fn start() {}
@compute @workgroup_size(1) fn advance() {}
@compute @workgroup_size(1) fn show() {}
@compute @workgroup_size(1) fn finish() {}
";

/// The different texts, as they are compiled, each under the name of a campaign, its plant and a controller.
pub(crate) fn texts() -> Vec<(String, String)> {
    // Any driver will do: it says nothing but how large a workgroup may be.
    let adapter = adapters().into_iter().map(|own| own.adapter).next_back();
    let gpu = Gpu::open(Wanted::Named(&adapter.unwrap().name)).unwrap();
    let entries = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("campaigns")).unwrap();
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|own| own == "toml"));
    paths.sort();
    let mut all: Vec<(String, String)> = Vec::new();
    for path in paths {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let campaign = Campaign::load(&path).unwrap();
        let gains = GainSet::of_groups(&campaign).unwrap();
        for (group, gains) in campaign.groups().iter().zip(GainSet::loops_of(&gains)) {
            let found: RefCell<Vec<String>> = RefCell::default();
            let tuning = Tuning {
                batch: Some(64),
                steps: Some(1),
            };
            let catch = |text: String| {
                found.borrow_mut().push(unrolled(&text));
                EMPTY.to_string()
            };
            // What does not fit the driver at hand is compiled for no other here.
            if GpuSimulator::rewritten(&gpu, group, &gains, tuning, &catch).is_err() {
                continue;
            }
            for text in found.into_inner() {
                if all.iter().any(|(_, known)| *known == text) {
                    continue;
                }
                let constant = |name: &str| {
                    let line = text
                        .lines()
                        .find_map(|own| own.strip_prefix(&format!("const {name} = ")));
                    line.unwrap().trim_end_matches(';').to_lowercase()
                };
                let controller = ["pid", "ftc"][usize::from(constant("FTC") == "true")];
                let mut own = format!("{name}.{}.{controller}", constant("PLANT"));
                // Groups of agents may differ in nothing that the name says.
                while all.iter().any(|(known, _)| *known == own) {
                    own.push('+');
                }
                all.push((own, text));
            }
        }
    }
    all
}

/// A text as the words of SPIR-V that wgpu hands to a driver that bounds accesses to buffers itself.
pub(crate) fn spirv(text: &str) -> Vec<u8> {
    let module = naga::front::wgsl::parse_str(text).unwrap();
    let flags = naga::valid::ValidationFlags::all();
    let capabilities = naga::valid::Capabilities::all();
    let info = naga::valid::Validator::new(flags, capabilities)
        .validate(&module)
        .unwrap();
    let options = spv::Options {
        lang_version: (1, 6),
        flags: spv::WriterFlags::LABEL_VARYINGS | spv::WriterFlags::FORCE_POINT_SIZE,
        bounds_check_policies: BoundsCheckPolicies {
            index: BoundsCheckPolicy::Restrict,
            buffer: BoundsCheckPolicy::Unchecked,
            image_load: BoundsCheckPolicy::Unchecked,
            binding_array: BoundsCheckPolicy::Unchecked,
        },
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::Native,
        force_loop_bounding: true,
        emit_int_div_checks: true,
        ..spv::Options::default()
    };
    let words = spv::write_vec(&module, &info, &options, None).unwrap();
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}
