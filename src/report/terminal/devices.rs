//! The GPUs of this machine, and which of them a run would take.

use super::text::line;
use crate::backend::cpu::Simd;
use crate::backend::gpu::AdapterReport;

/// What `--backend auto` would take, and every adapter with the reason.
pub fn devices(adapters: &[AdapterReport], simd: Simd) -> String {
    let mut text = String::new();
    let lanes = format!("{simd:?}").to_lowercase();
    let auto = adapters.iter().find(|report| report.auto).map_or_else(
        || format!("the CPU ({lanes}): there is no hardware GPU"),
        |report| report.adapter.name.clone(),
    );
    line(&mut text, &format!("--backend auto takes {auto}"));
    if adapters.is_empty() {
        line(
            &mut text,
            "\nno adapter: is a driver for Vulkan, Metal or DirectX 12 installed?",
        );
    }
    for report in adapters {
        let adapter = &report.adapter;
        let kind = format!("{:?}", adapter.kind).to_lowercase();
        let [least, most] = report.subgroup_sizes;
        let lockstep = if least == most {
            least.to_string()
        } else {
            format!("{least} to {most}")
        };
        line(&mut text, &format!("\n{}", adapter.name));
        line(
            &mut text,
            &format!("  {kind}, {}, driver {}", adapter.api, adapter.driver),
        );
        line(
            &mut text,
            &format!(
                "  buffers up to {} MiB, workgroups up to {} invocations and {} KiB, {lockstep} in lockstep",
                report.max_storage_buffer_bytes >> 20,
                report.max_workgroup_invocations,
                report.max_workgroup_bytes >> 10,
            ),
        );
        line(&mut text, &format!("  {}", report.reason));
    }
    text
}
