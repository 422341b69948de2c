//! The shaders of a group of channels under one controller: their shape on an adapter, and their bindings.

use super::device::Gpu;
use super::shape::Shape;
use super::uniforms::PlantUniforms;
use super::{GpuError, layout};
use crate::campaign::{AgentGroup, IntegralKind, ObserverStart};
use crate::draw::draw;
use crate::model::agent::Coupling;
use crate::model::subsystem::Subsystem;

/// Invocations that a workgroup should have: several warps, and several workgroups on each multiprocessor.
pub(super) const WORKGROUP: usize = 256;
/// Episodes that a workgroup has at most.
pub(super) const MAX_LANES: usize = 64;
/// Episodes that a batch has at most: enough to fill the largest cards several times, few enough that the tables of one
/// batch are filled while the next one is simulated.
pub(super) const MAX_BATCH: u32 = 16_384;

/// A group of channels under one controller, and its shaders.
pub(super) struct Pipeline {
    /// Which of the model's groups.
    pub(super) part: usize,
    pub(super) controller: usize,
    pub(super) shape: Shape,
    pub(super) entries: [wgpu::ComputePipeline; 4],
    pub(super) setting: wgpu::Buffer,
}

/// The entry points, in the order of [`Pipeline::pipelines`].
#[derive(Clone, Copy)]
pub(super) enum Entry {
    Start,
    Advance,
    Show,
    Finish,
}

pub(crate) const ENTRIES: [&str; 4] = ["start", "advance", "show", "finish"];

impl Pipeline {
    /// Invocations of a dispatch.
    pub(super) fn invocations(&self, episodes: usize) -> usize {
        episodes.div_ceil(self.shape.lanes) * self.shape.workgroup()
    }
}

/// What the bindings of shaders/episode.wgsl are, in their order.
pub(crate) const BINDINGS: [wgpu::BufferBindingType; 6] = {
    use wgpu::BufferBindingType::{Storage, Uniform};
    let (read, write) = (Storage { read_only: true }, Storage { read_only: false });
    [Uniform, Uniform, read, write, read, write]
};

/// The layout of these bindings.
pub(crate) fn binding_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(BINDINGS)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty,
                // The span moves from group to group.
                has_dynamic_offset: binding == 1,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &entries,
        })
}

/// The shape of a part's shaders on this adapter.
pub(super) fn shape(
    gpu: &Gpu,
    group: &AgentGroup,
    part: &Subsystem<f32>,
    ftc: bool,
) -> Result<Shape, GpuError> {
    let episode = draw(group, 0);
    let lists = layout::lists(group, part.channels.clone(), &episode);
    let limits = gpu.limits();
    let mut shape = Shape {
        plant: part.plant.kind(),
        plant_constants: part.plant.constants(),
        cut: group.is_limited(),
        channels: part.plant.kind().spec().channels,
        rows: part.rows,
        team: group.team,
        first_agent: group.first_agent,
        lanes: MAX_LANES,
        ftc,
        coupling: Coupling::of(group),
        measured_integral: group.control.integral == IntegralKind::Sensor,
        observer_measured: group.initial.observer == ObserverStart::Measured,
        int64: gpu.has_int64(),
        lists,
    };
    // The same for every batch: another shape is another text, which a driver might compile to other roundings.
    while shape.lanes > 1 && shape.workgroup() > WORKGROUP {
        shape.lanes /= 2;
    }
    for (what, needed, limit) in [
        (
            "a team in one workgroup, in invocations,",
            shape.workgroup(),
            limits.max_compute_invocations_per_workgroup,
        ),
        (
            "a team in one workgroup, in bytes of its memory,",
            shape.shared_bytes(),
            limits.max_compute_workgroup_storage_size,
        ),
    ] {
        if needed as u64 > u64::from(limit) {
            return Err(GpuError::TooLarge {
                adapter: gpu.adapter().name.clone(),
                what,
                needed: needed as u64,
                limit: u64::from(limit),
            });
        }
    }
    Ok(shape)
}
