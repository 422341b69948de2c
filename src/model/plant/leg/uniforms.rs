//! A leg as the shaders read it.

use super::parameters::{Joint, LEG_JOINTS, LegModel, Twist};
use bytemuck::{Pod, Zeroable};

/// Twin of `Joint` in shaders/leg.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct JointUniforms {
    angle: [f32; 4],
    lever: [f32; 4],
    lever_twice: [f32; 4],
    moments: [f32; 4],
    products: [f32; 4],
}

/// Twin of `LegModel` in shaders/leg.wgsl.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub struct LegUniforms {
    joints: [JointUniforms; LEG_JOINTS],
    pelvis: [f32; 4],
}

impl From<&Joint<f32>> for JointUniforms {
    fn from(joint: &Joint<f32>) -> Self {
        let [sine, cosine] = joint.twist;
        let [x, y, z] = joint.lever;
        let [x_twice, y_twice, z_twice] = joint.lever_twice;
        let [hx, hy] = joint.first;
        let [xx, yy, xy, xz, yz] = joint.second;
        Self {
            angle: [joint.offset, joint.armature, sine, cosine],
            lever: [x, y, z, joint.damping],
            lever_twice: [x_twice, y_twice, z_twice, 0.0],
            moments: [hx, hy, xx, yy],
            products: [xy, xz, yz, 0.0],
        }
    }
}

impl From<&LegModel<f32>> for LegUniforms {
    fn from(model: &LegModel<f32>) -> Self {
        let [across, along] = model.lift;
        Self {
            joints: model.joints.each_ref().map(JointUniforms::from),
            pelvis: [across, along, model.tip_inverse, 0.0],
        }
    }
}

impl<R> LegModel<R> {
    /// The constants that shaders/leg.wgsl is compiled with, name and value.
    #[must_use]
    pub fn shader_constants(&self) -> Vec<(String, u32)> {
        let [_, twists @ ..] = self.build.twists();
        let kinds = [
            ("PARALLEL", Twist::Parallel),
            ("RIGHT", Twist::Right),
            ("ANY", Twist::Any),
        ];
        let kinds = kinds.map(|(name, kind)| (name.to_string(), kind as u32));
        let twists = (1..).zip(twists);
        let twists = twists.map(|(j, twist)| (format!("TWIST_{j}"), twist as u32));
        kinds.into_iter().chain(twists).collect()
    }
}
