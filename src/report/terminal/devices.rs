//! The GPUs of this machine, and which of them a run would take.

use crate::backend::cpu::Simd;
use crate::backend::gpu::AdapterReport;
use crate::report::page::document::{Block, Document, Section};
use crate::report::page::text::text;

/// What `--backend auto` would take, and every adapter with the reason.
pub fn devices(adapters: &[AdapterReport], simd: Simd) -> String {
    let lanes = format!("{simd:?}").to_lowercase();
    let auto = adapters.iter().find(|report| report.auto).map_or_else(
        || format!("the CPU ({lanes}): there is no hardware GPU"),
        |report| report.adapter.name.clone(),
    );
    let none = "no adapter: is a driver for Vulkan, Metal or DirectX 12 installed?";
    let none = adapters
        .is_empty()
        .then(|| Section::new("", vec![Block::text(none)]));
    text(&Document {
        title: format!("--backend auto takes {auto}"),
        sections: none
            .into_iter()
            .chain(adapters.iter().enumerate().map(adapter))
            .collect(),
        ..Document::default()
    })
}

fn adapter((index, report): (usize, &AdapterReport)) -> Section {
    let adapter = &report.adapter;
    let kind = format!("{:?}", adapter.kind).to_lowercase();
    let [least, most] = report.subgroup_sizes;
    let lockstep = if least == most {
        least.to_string()
    } else {
        format!("{least} to {most}")
    };
    let blocks = vec![
        Block::Text(format!(
            "{kind}, {}, driver {}",
            adapter.api, adapter.driver
        )),
        Block::Text(format!(
            "buffers up to {} MiB, workgroups up to {} invocations and {} KiB, {lockstep} in lockstep",
            report.max_storage_buffer_bytes >> 20,
            report.max_workgroup_invocations,
            report.max_workgroup_bytes >> 10,
        )),
        Block::text(&report.reason),
    ];
    Section::new(format!("{index}: {}", adapter.name), blocks)
}
