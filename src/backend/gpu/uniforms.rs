//! The constants of a group of channels under a controller, as its shaders read them: `Uniforms` in
//! shaders/episode.wgsl.

use super::layout::word;
use crate::agent::HEIGHT;
use crate::campaign::AgentGroup;
use crate::model::controller::kinds::Controller;
use crate::model::controller::observer_feedback::ChannelGains;
use crate::model::integrator::Step;
use crate::model::metric::Limits;
use crate::model::plant::biped::LegPlant;
use crate::model::plant::kinds::AnyPlant;
use crate::model::plant::leg::{LEG_JOINTS, LegUniforms};
use crate::model::plant::uav::{Attitude, Axis, Thrust, Translation};
use crate::model::subsystem::Subsystem;
use crate::random::philox::key;
use bytemuck::{Pod, Zeroable};

/// Twin of `Uav` in shaders/plant_uav.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct UavUniforms {
    pub(crate) mass: f32,
    pub(crate) inverse_mass: f32,
    pub(crate) drag: f32,
    pub(crate) gravity: f32,
    pub(crate) inertia: [f32; 4],
    pub(crate) inverse_inertia: [f32; 4],
    pub(crate) gyro: [f32; 4],
    pub(crate) angular_drag: f32,
    pub(crate) filter_rad_s: f32,
    pub(crate) max_thrust: f32,
    pub(crate) max_torque: f32,
    pub(crate) max_tilt: f32,
    pub(crate) unused: [f32; 3],
}

/// Twin of `Leg` in shaders/plant_biped.wgsl.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LegPlantUniforms {
    pub(crate) model: LegUniforms,
    pub(crate) max_torque: [f32; 8],
}

/// Twin of `ChannelGains` in shaders/observer_feedback.wgsl.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct GainsUniforms {
    pub(crate) feedback: [f32; 8],
    pub(crate) injection: [[f32; 4]; 7],
    pub(crate) smoothing: [f32; 4],
    pub(crate) sensor_fault_input: [f32; 4],
}

/// Twin of `Uniforms` in shaders/episode.wgsl, up to the constants of its plant and its arrays: limits, gains.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SettingHead {
    pub(crate) seed: [u32; 2],
    pub(crate) settle_step: u32,
    pub(crate) first_channel: u32,
    pub(crate) h: [f32; 4],
}

fn four<const N: usize>(values: [f32; N]) -> [f32; 4] {
    std::array::from_fn(|k| values.get(k).copied().unwrap_or_default())
}

impl From<Axis<f32>> for UavUniforms {
    fn from(axis: Axis<f32>) -> Self {
        Self {
            mass: axis.mass,
            drag: axis.drag,
            gravity: axis.gravity,
            ..Self::default()
        }
    }
}

impl From<Translation<f32>> for UavUniforms {
    fn from(translation: Translation<f32>) -> Self {
        // Gravity is that of the height; the shaders know which axis it pulls along.
        Self::from(translation.axes[HEIGHT])
    }
}

impl From<Attitude<f32>> for UavUniforms {
    fn from(attitude: Attitude<f32>) -> Self {
        Self {
            inertia: four(attitude.inertia),
            gyro: four(attitude.gyro),
            angular_drag: attitude.drag,
            ..Self::default()
        }
    }
}

impl From<Thrust<f32>> for UavUniforms {
    fn from(thrust: Thrust<f32>) -> Self {
        Self {
            mass: thrust.mass,
            inverse_mass: thrust.inverse_mass,
            drag: thrust.drag,
            gravity: thrust.gravity,
            inverse_inertia: four(thrust.inverse_inertia),
            filter_rad_s: thrust.filter,
            max_thrust: thrust.max_thrust,
            max_torque: thrust.max_torque,
            max_tilt: thrust.max_tilt,
            ..Self::from(thrust.attitude)
        }
    }
}

/// A plant's constants as its shaders read them.
pub(crate) trait PlantUniforms {
    /// The bytes of `Plant` in the shaders.
    fn bytes(&self) -> Vec<u8>;

    /// Constants of its own in the shaders' text, name and value.
    fn constants(&self) -> Vec<(String, u32)> {
        Vec::new()
    }
}

impl PlantUniforms for Axis<f32> {
    fn bytes(&self) -> Vec<u8> {
        bytemuck::bytes_of(&UavUniforms::from(*self)).to_vec()
    }
}

impl PlantUniforms for Translation<f32> {
    fn bytes(&self) -> Vec<u8> {
        bytemuck::bytes_of(&UavUniforms::from(*self)).to_vec()
    }
}

impl PlantUniforms for Attitude<f32> {
    fn bytes(&self) -> Vec<u8> {
        bytemuck::bytes_of(&UavUniforms::from(*self)).to_vec()
    }
}

impl PlantUniforms for Thrust<f32> {
    fn bytes(&self) -> Vec<u8> {
        bytemuck::bytes_of(&UavUniforms::from(*self)).to_vec()
    }
}

impl<const CUT: bool> PlantUniforms for LegPlant<f32, CUT> {
    fn bytes(&self) -> Vec<u8> {
        let mut max_torque = [0.0; 8];
        max_torque[..LEG_JOINTS].copy_from_slice(&self.max_torque);
        let words = LegPlantUniforms {
            model: LegUniforms::from(&self.model),
            max_torque,
        };
        bytemuck::bytes_of(&words).to_vec()
    }

    fn constants(&self) -> Vec<(String, u32)> {
        self.model.shader_constants()
    }
}

impl PlantUniforms for AnyPlant<f32> {
    fn bytes(&self) -> Vec<u8> {
        match self {
            Self::Axis(plant) => plant.bytes(),
            Self::Translation(plant) => plant.bytes(),
            Self::Attitude(plant) => plant.bytes(),
            Self::Thrust(plant) => plant.bytes(),
            Self::FreeLeg(plant) => plant.bytes(),
            Self::CutLeg(plant) => plant.bytes(),
        }
    }

    fn constants(&self) -> Vec<(String, u32)> {
        match self {
            Self::FreeLeg(plant) => plant.constants(),
            Self::CutLeg(plant) => plant.constants(),
            Self::Axis(_) | Self::Translation(_) | Self::Attitude(_) | Self::Thrust(_) => {
                Vec::new()
            }
        }
    }
}

impl From<&ChannelGains<f32>> for GainsUniforms {
    fn from(gains: &ChannelGains<f32>) -> Self {
        Self {
            feedback: std::array::from_fn(|k| gains.feedback.get(k).copied().unwrap_or_default()),
            injection: gains.injection.map(four),
            smoothing: four(gains.smoothing),
            sensor_fault_input: four(gains.sensor_fault_input),
        }
    }
}

/// The bytes of a group's `Uniforms` under a controller.
pub(crate) fn setting(
    group: &AgentGroup,
    part: &Subsystem<f32>,
    controller: &Controller<f32>,
) -> Vec<u8> {
    let h = Step::<f32>::new(group.time.step_s);
    let head = SettingHead {
        seed: key(group.seed),
        settle_step: group.time.settle_step,
        first_channel: word(part.channels.start),
        h: [h.sixth, h.third, h.half, h.whole],
    };
    let mut bytes = bytemuck::bytes_of(&head).to_vec();
    bytes.extend(part.plant.bytes());
    for channel in part.channels.clone() {
        let verdict = &group.verdict;
        let limits = Limits::<f32>::new(verdict.max_error[channel], verdict.settled_error[channel]);
        bytes.extend(bytemuck::bytes_of(&[
            limits.max_error,
            limits.settled_error,
            0.0,
            0.0,
        ]));
    }
    for (channels, gains) in group
        .channel_groups()
        .iter()
        .zip(controller.observer_gains())
    {
        if part
            .channels
            .clone()
            .any(|channel| channels.channels.contains(&channel))
        {
            bytes.extend(bytemuck::bytes_of(&GainsUniforms::from(gains)));
        }
    }
    bytes
}
