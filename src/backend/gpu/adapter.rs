//! Which GPUs there are, and which one a run takes.

use super::GpuError;
use serde::{Deserialize, Serialize};

/// Share of the device's free memory that a run may take, percent: an allocation beyond is refused, which is better
/// than a driver that swaps or fails later.
pub(super) const MEMORY_PERCENT: u8 = 80;

/// What kind of device an adapter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AdapterKind {
    /// A card of its own.
    Discrete,
    /// Part of the processor.
    Integrated,
    /// A share of a card, in a virtual machine.
    Virtual,
    /// The processor itself, through a software driver.
    Software,
    /// The driver does not say.
    Other,
}

impl AdapterKind {
    /// Whether `--backend auto` may take it: hardware only, since a software driver is slower than the CPU backend.
    #[must_use]
    pub fn is_hardware(self) -> bool {
        matches!(self, Self::Discrete | Self::Integrated | Self::Virtual)
    }
}

/// An adapter, as far as a run's record needs it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adapter {
    /// Name.
    pub name: String,
    /// What kind of device it is.
    pub kind: AdapterKind,
    /// The interface that it is reached through.
    pub api: String,
    /// Driver and its version.
    pub driver: String,
}

/// An adapter and the limits that matter here.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AdapterReport {
    /// The adapter.
    #[serde(flatten)]
    pub adapter: Adapter,
    /// Largest buffer that a shader may use, bytes.
    pub max_storage_buffer_bytes: u64,
    /// Largest workgroup, invocations.
    pub max_workgroup_invocations: u32,
    /// Largest workgroup memory, bytes.
    pub max_workgroup_bytes: u32,
    /// Invocations that run in lockstep, at least and at most.
    pub subgroup_sizes: [u32; 2],
    /// Whether `--backend auto` would take it.
    pub auto: bool,
    /// Why, or why not.
    pub reason: String,
}

/// Which adapter is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted<'a> {
    /// The best hardware one.
    Hardware,
    /// The one of this name, else the best of those whose name contains it, whatever the case; software ones too.
    Named(&'a str),
    /// This one, with the same driver.
    Same(&'a Adapter),
}

/// All adapters, the best first, with what `--backend auto` makes of them.
#[must_use]
pub fn adapters() -> Vec<AdapterReport> {
    let mut taken = false;
    found(MEMORY_PERCENT)
        .into_iter()
        .map(|found| {
            let limits = found.limits();
            let info = found.get_info();
            let adapter = describe(&info);
            let auto = adapter.kind.is_hardware() && !taken;
            let reason = match adapter.kind {
                AdapterKind::Software => format!(
                    "a software driver, slower than the CPU backend: only by name, with --backend gpu --adapter {}",
                    first_word(&adapter.name)
                ),
                AdapterKind::Other => {
                    "the driver does not say whether it is hardware: only by name".to_string()
                }
                _ if taken => "hardware, but the one above is preferred".to_string(),
                _ => "the first hardware adapter; discrete cards come first".to_string(),
            };
            taken |= auto;
            AdapterReport {
                adapter,
                max_storage_buffer_bytes: limits
                    .max_storage_buffer_binding_size
                    .min(limits.max_buffer_size),
                max_workgroup_invocations: limits.max_compute_invocations_per_workgroup,
                max_workgroup_bytes: limits.max_compute_workgroup_storage_size,
                subgroup_sizes: [info.subgroup_min_size, info.subgroup_max_size],
                auto,
                reason,
            }
        })
        .collect()
}

/// The adapters that are wanted, the best first; at least one.
pub(super) fn find(
    wanted: Wanted<'_>,
    memory_percent: u8,
) -> Result<Vec<(wgpu::Adapter, Adapter)>, GpuError> {
    let mut found: Vec<(wgpu::Adapter, Adapter)> = found(memory_percent)
        .into_iter()
        .map(|found| {
            let adapter = describe(&found.get_info());
            (found, adapter)
        })
        .collect();
    let names: Vec<String> = found.iter().map(|(_, own)| own.name.clone()).collect();
    match wanted {
        Wanted::Hardware => found.retain(|(_, own)| own.kind.is_hardware()),
        Wanted::Same(adapter) => found.retain(|(_, own)| own == adapter),
        // A number counts them as `urts-mc devices` lists them: two adapters of one name are told apart by it.
        Wanted::Named(name) if name.parse().is_ok_and(|index: usize| index < found.len()) => {
            let index: usize = name.parse().unwrap_or_default();
            found = found.into_iter().skip(index).take(1).collect();
        }
        Wanted::Named(name) => {
            let name = name.to_lowercase();
            found.retain(|(_, own)| own.name.to_lowercase().contains(&name));
            found.sort_by_key(|(_, own)| own.name.to_lowercase() != name);
        }
    }
    if !found.is_empty() {
        return Ok(found);
    }
    Err(match wanted {
        Wanted::Hardware => GpuError::NoHardware { found: names },
        Wanted::Named(name) => GpuError::NoSuchAdapter {
            name: name.to_string(),
            found: names,
        },
        Wanted::Same(adapter) => GpuError::Gone {
            name: adapter.name.clone(),
            driver: adapter.driver.clone(),
        },
    })
}

/// All adapters, in the order of their kinds; a device that is reached through several interfaces comes once for each.
fn found(memory_percent: u8) -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        memory_budget_thresholds: wgpu::MemoryBudgetThresholds {
            for_resource_creation: Some(memory_percent),
            for_device_loss: None,
        },
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut found = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    // A stable sort: within a kind, the order of the drivers stays.
    found.sort_by_key(|adapter| describe(&adapter.get_info()).kind);
    found
}

fn describe(info: &wgpu::AdapterInfo) -> Adapter {
    Adapter {
        name: info.name.clone(),
        kind: match info.device_type {
            wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
            wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
            wgpu::DeviceType::VirtualGpu => AdapterKind::Virtual,
            wgpu::DeviceType::Cpu => AdapterKind::Software,
            wgpu::DeviceType::Other => AdapterKind::Other,
        },
        api: format!("{:?}", info.backend),
        driver: [info.driver.as_str(), info.driver_info.as_str()]
            .into_iter()
            .filter(|part| !part.is_empty())
            .collect::<Vec<_>>()
            .join(" "),
    }
}

fn first_word(name: &str) -> &str {
    name.split_whitespace().next().unwrap_or(name)
}
