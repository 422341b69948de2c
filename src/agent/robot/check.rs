//! The limits of a robot's numbers, the same for every format.

use super::error::RobotError;
use super::structure::{Body, Foot, JOINTS, Joint, Leg};
use nalgebra::{Cholesky, Isometry3, Matrix3, Rotation3, Unit, Vector3};
use std::collections::HashSet;
use std::fmt::{Debug, Display};
use std::path::Path;

/// No length, angle, mass, torque or inertia of a biped is larger, and nothing computed from such numbers overflows.
pub(super) const LARGEST: f64 = 1e6;

/// Shorter axes have no direction.
const SHORTEST_AXIS: f64 = 1e-6;

/// Slack of the triangle inequality, relative to the largest moment: tables of flat and slender parts are rounded.
const ROUNDING: f64 = 1e-3;

/// What a format calls the quantities.
pub(super) struct Names {
    pub mass: &'static str,
    pub com: &'static str,
    pub inertia: &'static str,
    pub xyz: &'static str,
    pub rpy: &'static str,
    pub axis: &'static str,
    pub q_min: &'static str,
    pub q_max: &'static str,
    pub rate_max: &'static str,
    pub torque_max: &'static str,
    pub armature: &'static str,
    pub damping: &'static str,
}

/// A joint as a format gives it.
pub(super) struct RawJoint {
    pub xyz: [f64; 3],
    pub rpy: [f64; 3],
    pub axis: [f64; 3],
    pub q_min: f64,
    pub q_max: f64,
    pub rate_max: f64,
    pub torque_max: f64,
    pub armature: f64,
    pub damping: f64,
}

/// A link or joint of the file.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    /// What precedes the quantity, for example `joint[3].`.
    pub prefix: &'a str,
    /// Name of the link or joint.
    pub name: &'a str,
}

impl Place<'_> {
    /// A quantity's key, for example `joint[3].mass (l_knee)`.
    pub(super) fn key(&self, quantity: &str) -> String {
        if self.name.is_empty() {
            format!("{}{quantity}", self.prefix)
        } else {
            format!("{}{quantity} ({})", self.prefix, self.name)
        }
    }
}

/// Checks the numbers of one file.
pub(super) struct Check<'a> {
    pub path: &'a Path,
    pub names: &'static Names,
}

impl Check<'_> {
    /// A refusal.
    pub(super) fn invalid(
        &self,
        key: impl Into<String>,
        value: impl Display,
        limit: impl Into<String>,
        remedy: impl Into<String>,
    ) -> RobotError {
        RobotError::Invalid {
            path: self.path.to_path_buf(),
            key: key.into(),
            value: value.to_string(),
            limit: limit.into(),
            remedy: remedy.into(),
        }
    }

    /// Refuses numbers that are not finite or absurdly large.
    pub(super) fn finite<T: AsRef<[f64]> + Debug>(
        &self,
        key: &str,
        values: &T,
    ) -> Result<(), RobotError> {
        let wild = values
            .as_ref()
            .iter()
            .find(|value| !value.is_finite() || value.abs() > LARGEST);
        match wild {
            Some(wild) => Err(self.invalid(
                key,
                wild,
                "a number is finite and at most 1e6 in size",
                "give it in m, rad, kg, s and N",
            )),
            None => Ok(()),
        }
    }

    /// Refuses what is not a positive number.
    pub(super) fn positive(&self, key: &str, value: f64, what: &str) -> Result<(), RobotError> {
        self.finite(key, &[value])?;
        if value > 0.0 {
            return Ok(());
        }
        Err(self.invalid(
            key,
            value,
            format!("{what} is positive"),
            "give its true value",
        ))
    }

    /// Refuses what is a negative number or none.
    pub(super) fn not_negative(&self, key: &str, value: f64, what: &str) -> Result<(), RobotError> {
        self.finite(key, &[value])?;
        if value >= 0.0 {
            return Ok(());
        }
        Err(self.invalid(
            key,
            value,
            format!("{what} is not negative"),
            "give its true value, or 0 to leave it out",
        ))
    }

    /// A body whose inertia is that of some distribution of mass, if not of a single point or line.
    pub(super) fn body(
        &self,
        place: Place<'_>,
        mass_kg: f64,
        com_m: Vector3<f64>,
        inertia: &Matrix3<f64>,
    ) -> Result<Body, RobotError> {
        self.realizable(place, mass_kg, com_m, inertia)?;
        if Cholesky::new(*inertia).is_none() {
            return Err(self.invalid(
                place.key(self.names.inertia),
                six(inertia),
                "an inertia tensor about the centre of mass is positive definite",
                "give ixx ixy ixz iyy iyz izz in kg m^2, products with their sign in the tensor",
            ));
        }
        Ok(Body {
            mass_kg,
            com_m,
            inertia_kg_m2: *inertia,
        })
    }

    /// Refuses masses and inertias that no distribution of mass has. The principal moments of half the trace minus the
    /// tensor are the second moments of the mass, which are not negative: this is the triangle inequality.
    pub(super) fn realizable(
        &self,
        place: Place<'_>,
        mass_kg: f64,
        com_m: Vector3<f64>,
        inertia: &Matrix3<f64>,
    ) -> Result<(), RobotError> {
        self.positive(&place.key(self.names.mass), mass_kg, "a mass")?;
        self.finite(&place.key(self.names.com), &com_m.as_slice())?;
        let key = place.key(self.names.inertia);
        self.finite(&key, &inertia.as_slice())?;
        let slack = ROUNDING * inertia.diagonal().amax() + f64::MIN_POSITIVE;
        let second_moments =
            Matrix3::from_diagonal_element(inertia.trace() / 2.0 + slack) - inertia;
        if Cholesky::new(second_moments).is_some() {
            return Ok(());
        }
        Err(self.invalid(
            key,
            six(inertia),
            "no principal moment of a body is negative or exceeds the sum of the other two",
            "give ixx ixy ixz iyy iyz izz in kg m^2 about the centre of mass",
        ))
    }

    /// A joint.
    pub(super) fn joint(
        &self,
        place: Place<'_>,
        raw: &RawJoint,
        body: Body,
    ) -> Result<Joint, RobotError> {
        let key = |quantity: &str| place.key(quantity);
        let names = self.names;
        let placement = self.pose(&key(names.xyz), raw.xyz, &key(names.rpy), raw.rpy)?;
        self.finite(&key(names.axis), &raw.axis)?;
        let axis = Unit::try_new(Vector3::from(raw.axis), SHORTEST_AXIS).ok_or_else(|| {
            self.invalid(
                key(names.axis),
                three(raw.axis),
                "an axis has a direction",
                "give the direction of the joint's axis in its own frame",
            )
        })?;
        self.finite(&key(names.q_min), &[raw.q_min])?;
        self.finite(&key(names.q_max), &[raw.q_max])?;
        if raw.q_min >= raw.q_max {
            return Err(self.invalid(
                key(names.q_min),
                raw.q_min,
                format!("it lies below {} = {}", names.q_max, raw.q_max),
                "give both limits in rad",
            ));
        }
        self.positive(&key(names.rate_max), raw.rate_max, "a largest rate")?;
        self.positive(&key(names.torque_max), raw.torque_max, "a largest torque")?;
        self.not_negative(&key(names.armature), raw.armature, "an armature")?;
        self.not_negative(&key(names.damping), raw.damping, "a damping")?;
        Ok(Joint {
            name: place.name.to_string(),
            placement,
            axis,
            q_min_rad: raw.q_min,
            q_max_rad: raw.q_max,
            rate_max_rad_s: raw.rate_max,
            torque_max_n_m: raw.torque_max,
            armature_kg_m2: raw.armature,
            damping_n_m_s: raw.damping,
            body,
        })
    }

    /// A frame from its origin and its angles, R = Rz(yaw) Ry(pitch) Rx(roll).
    pub(super) fn pose(
        &self,
        xyz_key: &str,
        xyz: [f64; 3],
        rpy_key: &str,
        rpy: [f64; 3],
    ) -> Result<Isometry3<f64>, RobotError> {
        self.finite(xyz_key, &xyz)?;
        self.finite(rpy_key, &rpy)?;
        let [roll, pitch, yaw] = rpy;
        let rotation = Rotation3::from_euler_angles(roll, pitch, yaw);
        Ok(Isometry3::from_parts(
            Vector3::from(xyz).into(),
            rotation.into(),
        ))
    }

    /// Rejects a foot with NaN or infinite values.
    pub(super) fn foot(&self, key: &str, foot: &Foot) -> Result<(), RobotError> {
        self.finite(key, &foot.ankle_offset_m.as_slice())?;
        self.finite(key, &foot.sole.translation.vector.as_slice())?;
        self.finite(key, &foot.sole.rotation.coords.as_slice())?;
        foot.sole_corners_m
            .iter()
            .try_for_each(|corner| self.finite(key, corner))
    }

    /// Refuses a standing pose outside the limits of the joints.
    pub(super) fn standing(
        &self,
        key: &str,
        legs: &[Leg; 2],
        q_rad: &[f64; JOINTS],
    ) -> Result<(), RobotError> {
        self.finite(key, q_rad)?;
        let joints = legs.iter().flat_map(|leg| &leg.joints);
        for (i, (joint, q)) in joints.zip(q_rad).enumerate() {
            let (low, high) = (joint.q_min_rad, joint.q_max_rad);
            if *q < low || *q > high {
                return Err(self.invalid(
                    format!("{key}[{i}] ({})", joint.name),
                    q,
                    format!("the joint moves from {low} to {high} rad"),
                    "give a pose within the limits",
                ));
            }
        }
        Ok(())
    }

    /// Refuses a name that occurs twice.
    pub(super) fn unique<'n>(
        &self,
        what: &str,
        names: impl IntoIterator<Item = &'n str>,
    ) -> Result<(), RobotError> {
        let mut seen = HashSet::new();
        match names.into_iter().find(|name| !seen.insert(*name)) {
            Some(twice) => Err(self.invalid(
                what,
                format!("{twice:?}"),
                "this name occurs twice",
                "give each its own",
            )),
            None => Ok(()),
        }
    }
}

/// A symmetric tensor from ixx, ixy, ixz, iyy, iyz, izz.
pub(super) fn tensor([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

fn six(inertia: &Matrix3<f64>) -> String {
    let of = |i, j| inertia[(i, j)];
    let numbers = [of(0, 0), of(0, 1), of(0, 2), of(1, 1), of(1, 2), of(2, 2)];
    format!("{numbers:?}")
}

fn three(numbers: [f64; 3]) -> String {
    format!("{numbers:?}")
}
