//! What a URDF does not say.

use crate::agent::robot::structure::{Foot, JOINTS};
use nalgebra::Vector3;

/// What a URDF does not say.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfOptions {
    /// The link that is the pelvis (default: the child of a floating joint if there is one, else the root link).
    pub pelvis: Option<String>,
    /// The first joint of the left leg (default: the one with the larger y).
    pub left_hip: Option<String>,
    /// The first joint of the right leg (default: the other one).
    pub right_hip: Option<String>,
    /// Moving joints outside the legs, held at zero.
    pub locked: Vec<String>,
    /// Inertia of each joint's rotor as seen from the joint, kg m^2 (default: that of the file, else 0.01).
    pub armature_kg_m2: Option<[f64; JOINTS]>,
    /// The soles (default: parallel to the pelvis in the standing pose where one is given as angles, else at q = 0).
    pub soles: Option<Soles>,
    /// Standing pose (default: zero, or the nearest angle that a joint can reach).
    pub standing: Option<Standing>,
    /// Nominal height of the pelvis frame above the ground, m (default: that above the soles in the standing pose).
    pub base_height_m: Option<f64>,
    /// Gravity in the world frame, m/s^2.
    pub gravity_m_s2: Vector3<f64>,
    /// Licence of the numbers.
    pub licence: String,
    /// Whose numbers they are.
    pub attribution: String,
}

/// Where the soles are.
#[derive(Debug, Clone, PartialEq)]
pub enum Soles {
    /// In the origins of the last links, parallel to the pelvis in the standing pose.
    Standing,
    /// The frames of these links, left and right, which are fixed to the last ones: x forward and z up when the foot
    /// stands.
    Frames([String; 2]),
    /// Left and right foot in the frames of the last links.
    Feet([Foot; 2]),
}

/// How the robot stands.
#[derive(Debug, Clone, PartialEq)]
pub enum Standing {
    /// At these angles, those of the left leg first, rad.
    Angles([f64; JOINTS]),
    /// With its feet level below its hips and its knees bent forwards: a pose that the program finds.
    Bent,
}

impl Default for UrdfOptions {
    fn default() -> Self {
        Self {
            pelvis: None,
            left_hip: None,
            right_hip: None,
            locked: Vec::new(),
            armature_kg_m2: None,
            soles: None,
            standing: None,
            base_height_m: None,
            gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
            licence: String::new(),
            attribution: String::new(),
        }
    }
}
