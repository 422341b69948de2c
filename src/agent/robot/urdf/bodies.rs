//! The masses of links, and of links that do not move relative to each other.

use super::tree::{Rigid, Tree};
use crate::agent::robot::check::{Place, tensor};
use crate::agent::robot::error::RobotError;
use crate::agent::robot::structure::Body;
use nalgebra::Isometry3;

/// What of a link's body is refused.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Care {
    /// What no distribution of mass has.
    Strict,
    /// What is no number, and a negative mass.
    Lenient,
}

/// A body of a link with a frame.
fn in_frame(body: &Body, frame: &Isometry3<f64>) -> Body {
    let rotation = frame.rotation.to_rotation_matrix();
    body.moved(rotation.matrix(), &frame.translation.vector)
}

impl Tree<'_> {
    /// The body of rigid links; a link that moves needs one.
    pub(super) fn body(&self, first: usize, rigid: &Rigid<'_>) -> Result<Body, RobotError> {
        let bodies = rigid.links.iter().map(|(link, frame)| {
            let own = self.own_body(*link, Care::Strict)?;
            Ok::<_, RobotError>(own.map(|own| in_frame(&own, frame)))
        });
        let bodies: Vec<Option<Body>> = bodies.collect::<Result<_, _>>()?;
        self.whole(first, bodies.into_iter().flatten())
    }

    /// The body of the pelvis and of all that hangs on it and is held still. Of those parts, what no distribution of
    /// mass has is noted: simulators pad the inertias of arms and sensors, and the whole is checked.
    pub(super) fn trunk(
        &self,
        pelvis: usize,
        rigid: &Rigid<'_>,
        notes: &mut Vec<String>,
    ) -> Result<Body, RobotError> {
        let mut bodies = Vec::new();
        for (link, frame) in &rigid.links {
            let own = match self.own_body(*link, Care::Strict) {
                Err(_) if *link != pelvis => {
                    let own = self.own_body(*link, Care::Lenient)?;
                    notes.push(format!(
                        "link {}, which is held still, has a mass or an inertia that no body has; it is part of the pelvis \
                         as it stands",
                        self.name(*link)
                    ));
                    own
                }
                own => own?,
            };
            bodies.extend(own.map(|own| in_frame(&own, frame)));
        }
        self.whole(pelvis, bodies.into_iter())
    }

    fn whole(&self, first: usize, bodies: impl Iterator<Item = Body>) -> Result<Body, RobotError> {
        let name = self.name(first);
        let place = Place {
            prefix: "link ",
            name,
        };
        let Some(body) = bodies.reduce(|whole, own| whole.joined(&own)) else {
            return Err(self.check.invalid(
                place.key("inertial"),
                "none",
                "a moving link and the pelvis have a mass and an inertia",
                "add <inertial> to the link or to one fixed to it",
            ));
        };
        self.check
            .body(place, body.mass_kg, body.com_m, &body.inertia_kg_m2)
    }

    /// A link's own mass; none for a bare frame. The inertia of a point or a line will do where other links add to it.
    fn own_body(&self, link: usize, care: Care) -> Result<Option<Body>, RobotError> {
        let Some(inertial) = &self.links[link].inertial else {
            return Ok(None);
        };
        let place = Place {
            prefix: "link ",
            name: self.name(link),
        };
        let six = inertial.inertia;
        if inertial.mass == 0.0 && six.iter().all(|entry| *entry == 0.0) {
            return Ok(None);
        }
        let names = self.check.names;
        let origin = self.check.pose(
            &place.key(names.com),
            inertial.origin.xyz,
            &place.key("inertial origin rpy"),
            inertial.origin.rpy,
        )?;
        let (mass_kg, tensor) = (inertial.mass, tensor(six));
        let com_m = origin.translation.vector;
        match care {
            Care::Strict => self.check.realizable(place, mass_kg, com_m, &tensor)?,
            Care::Lenient => {
                self.check
                    .not_negative(&place.key(names.mass), mass_kg, "a mass")?;
                self.check
                    .finite(&place.key(names.com), &com_m.as_slice())?;
                self.check
                    .finite(&place.key(names.inertia), &tensor.as_slice())?;
            }
        }
        let rotation = origin.rotation.to_rotation_matrix();
        Ok(Some(Body {
            mass_kg,
            com_m,
            inertia_kg_m2: rotation.matrix() * tensor * rotation.matrix().transpose(),
        }))
    }
}
