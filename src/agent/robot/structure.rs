//! The structure of a biped: a pelvis, and two legs of six joints with their links and a foot.

use nalgebra::{Isometry3, Matrix3, Unit, Vector3};

/// Joints of a leg.
pub const LEG_JOINTS: usize = 6;
/// Joints of a robot.
pub const JOINTS: usize = 2 * LEG_JOINTS;
/// The left leg's place in [`Robot::legs`].
pub const LEFT: usize = 0;
/// The right leg's place in [`Robot::legs`].
pub const RIGHT: usize = 1;

/// A biped.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Robot {
    /// Name.
    pub name: String,
    /// Licence of the numbers; empty where none is known.
    pub licence: String,
    /// Whose numbers they are; empty where nobody is known.
    pub attribution: String,
    /// Gravity in the world frame (z up), m/s^2.
    pub gravity_m_s2: Vector3<f64>,
    /// Pelvis and everything fixed to it, in the pelvis frame.
    pub base: Body,
    /// Nominal height of the pelvis frame above the ground, m.
    pub base_height_m: f64,
    /// Standing pose, rad.
    pub standing_rad: [f64; JOINTS],
    /// Left and right leg.
    pub legs: [Leg; 2],
    /// What was assumed or left out in reading its file, a sentence each.
    pub notes: Vec<String>,
}

impl Robot {
    /// Mass of the whole robot, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.base.mass_kg + self.legs.iter().map(Leg::mass_kg).sum::<f64>()
    }

    /// The twelve joints in the order of the joint vector.
    pub fn joints(&self) -> impl Iterator<Item = &Joint> {
        self.legs.iter().flat_map(|leg| &leg.joints)
    }
}

/// A leg: six joints, each with the link that it moves, and a foot on the last of them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Leg {
    /// The joints from the hip to the ankle.
    pub joints: [Joint; LEG_JOINTS],
    /// The foot.
    pub foot: Foot,
}

impl Leg {
    /// Mass of the leg's links, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.joints.iter().map(|joint| joint.body.mass_kg).sum()
    }
}

/// A revolute joint and the link that it moves.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Joint {
    /// Name.
    pub name: String,
    /// The joint's frame at q = 0 in the frame of the link before it (or of the pelvis), m.
    pub placement: Isometry3<f64>,
    /// Axis in the joint's frame.
    pub axis: Unit<Vector3<f64>>,
    /// Least angle, rad.
    pub q_min_rad: f64,
    /// Largest angle, rad; above the least.
    pub q_max_rad: f64,
    /// Largest rate, rad/s; positive.
    pub rate_max_rad_s: f64,
    /// Largest torque, N m; positive.
    pub torque_max_n_m: f64,
    /// Inertia of the rotor as seen from the joint, kg m^2; not negative.
    pub armature_kg_m2: f64,
    /// Viscous damping, N m s/rad; not negative, zero in the paper's (4).
    pub damping_n_m_s: f64,
    /// The link, in the joint's frame.
    pub body: Body,
}

/// A rigid body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Body {
    /// Mass, kg; positive.
    pub mass_kg: f64,
    /// Centre of mass in the link's frame, m.
    pub com_m: Vector3<f64>,
    /// Inertia about the centre of mass, in the link's axes, kg m^2; positive definite.
    pub inertia_kg_m2: Matrix3<f64>,
}

impl Body {
    /// The body in the coordinates of another frame, given this frame there.
    #[must_use]
    pub fn moved(&self, rotation: &Matrix3<f64>, origin_m: &Vector3<f64>) -> Self {
        Self {
            mass_kg: self.mass_kg,
            com_m: origin_m + rotation * self.com_m,
            inertia_kg_m2: rotation * self.inertia_kg_m2 * rotation.transpose(),
        }
    }

    /// Two bodies of one frame as one, by the parallel-axis theorem.
    #[must_use]
    pub fn joined(&self, other: &Self) -> Self {
        let mass_kg = self.mass_kg + other.mass_kg;
        let apart = other.com_m - self.com_m;
        // Two bodies without mass have no common centre.
        if mass_kg == 0.0 {
            return Self {
                inertia_kg_m2: self.inertia_kg_m2 + other.inertia_kg_m2,
                ..*self
            };
        }
        let reduced_kg = self.mass_kg * other.mass_kg / mass_kg;
        let spread =
            Matrix3::from_diagonal_element(apart.norm_squared()) - apart * apart.transpose();
        Self {
            mass_kg,
            com_m: self.com_m + apart * (other.mass_kg / mass_kg),
            inertia_kg_m2: self.inertia_kg_m2 + other.inertia_kg_m2 + spread * reduced_kg,
        }
    }
}

/// What touches the ground, in the frame of a leg's last link.
#[derive(Debug, Clone, PartialEq)]
pub struct Foot {
    /// Origin of the ankle frame, whose axes are the last link's, m.
    pub ankle_offset_m: Vector3<f64>,
    /// The sole's frame, x forward and z up when the foot stands, m.
    pub sole: Isometry3<f64>,
    /// Corners of the sole in the x and y of its frame, m; empty where they are not known.
    pub sole_corners_m: Vec<[f64; 2]>,
}
