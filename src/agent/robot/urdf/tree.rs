//! The tree of links and joints of a URDF, and what of it is rigid.

use super::syntax::{Joint, JointKind, Link, Urdf};
use crate::agent::robot::check::{Check, Place, tensor};
use crate::agent::robot::error::RobotError;
use crate::agent::robot::structure::Body;
use nalgebra::Isometry3;
use std::collections::HashMap;

/// A URDF whose joints connect its links to one tree.
pub(super) struct Tree<'a> {
    check: &'a Check<'a>,
    links: &'a [Link],
    joints: &'a [Joint],
    locked: &'a [String],
    /// Index of each link.
    index: HashMap<&'a str, usize>,
    /// The joints that each link carries.
    carried: Vec<Vec<usize>>,
    /// The joint that carries each link, none for the root.
    carrier: Vec<Option<usize>>,
    root: usize,
}

/// Links that do not move relative to each other, in the frame of the first.
pub(super) struct Rigid<'a> {
    /// Their mass; none if all are bare frames.
    body: Option<Body>,
    /// The moving joints that they carry.
    pub moving: Vec<Moving<'a>>,
}

/// A moving joint.
#[derive(Clone, Copy)]
pub(super) struct Moving<'a> {
    pub joint: &'a Joint,
    /// Frame of the link that carries it, in the frame of the rigid links that this link belongs to.
    parent: Isometry3<f64>,
}

impl<'a> Tree<'a> {
    /// Refuses links and joints that are no tree.
    pub(super) fn new(
        check: &'a Check<'a>,
        urdf: &'a Urdf,
        locked: &'a [String],
    ) -> Result<Self, RobotError> {
        if urdf.links.is_empty() {
            return Err(check.invalid(
                "number of <link>",
                0,
                "a robot has links",
                "write them and their joints into <robot>",
            ));
        }
        check.unique(
            "link name",
            urdf.links.iter().map(|link| link.name.as_str()),
        )?;
        check.unique(
            "joint name",
            urdf.joints.iter().map(|joint| joint.name.as_str()),
        )?;
        if let Some(unknown) = locked
            .iter()
            .find(|name| urdf.joints.iter().all(|joint| joint.name != **name))
        {
            return Err(check.invalid(
                "locked",
                format!("{unknown:?}"),
                "no such joint",
                "name joints of the file",
            ));
        }
        let names = urdf.links.iter().map(|link| link.name.as_str());
        let mut tree = Self {
            check,
            links: &urdf.links,
            joints: &urdf.joints,
            locked,
            index: names.zip(0..).collect(),
            carried: vec![Vec::new(); urdf.links.len()],
            carrier: vec![None; urdf.links.len()],
            root: 0,
        };
        for (j, joint) in urdf.joints.iter().enumerate() {
            let parent = tree.link(&joint.name, "parent link", &joint.parent)?;
            let child = tree.link(&joint.name, "child link", &joint.child)?;
            if let Some(first) = tree.carrier[child] {
                return Err(check.invalid(
                    format!("joint child link ({})", joint.name),
                    format!("{:?}", joint.child),
                    format!("this link hangs on {:?} already", tree.joints[first].name),
                    "let one joint carry it",
                ));
            }
            tree.carrier[child] = Some(j);
            tree.carried[parent].push(j);
        }
        tree.root = tree.only_root()?;
        Ok(tree)
    }

    /// The one link that no joint carries and from which all others hang.
    fn only_root(&self) -> Result<usize, RobotError> {
        let roots: Vec<usize> = (0..self.links.len())
            .filter(|link| self.carrier[*link].is_none())
            .collect();
        let [root] = roots[..] else {
            let names: Vec<&str> = roots.iter().map(|root| self.name(*root)).collect();
            return Err(self.check.invalid(
                "root link",
                format!("{names:?}"),
                "one link, and only one, hangs on no joint",
                "connect the links to one tree",
            ));
        };
        let mut hanging = vec![root];
        let mut reached = vec![false; self.links.len()];
        while let Some(link) = hanging.pop() {
            reached[link] = true;
            hanging.extend(self.carried[link].iter().map(|joint| self.child_of(*joint)));
        }
        match reached.iter().position(|reached| !reached) {
            Some(link) => Err(self.check.invalid(
                "link",
                format!("{:?}", self.name(link)),
                format!("it does not hang on the root link {:?}", self.name(root)),
                "connect the links to one tree",
            )),
            None => Ok(root),
        }
    }

    /// The pelvis: the link of that name, else what a floating joint carries, else the root.
    pub(super) fn pelvis(&self, name: Option<&str>) -> Result<usize, RobotError> {
        let Some(name) = name else {
            let floating = self
                .joints
                .iter()
                .position(|joint| joint.kind == JointKind::Floating);
            return Ok(floating.map_or(self.root, |joint| self.child_of(joint)));
        };
        let pelvis = self.index.get(name).copied().ok_or_else(|| {
            self.check.invalid(
                "pelvis",
                format!("{name:?}"),
                "no such link",
                "name a link of the file",
            )
        })?;
        let mut highest = pelvis;
        while let Some(joint) = self.carrier[highest].map(|joint| &self.joints[joint]) {
            if joint.kind == JointKind::Floating {
                break;
            }
            if !self.is_fixed(joint) {
                return Err(self.check.invalid(
                    format!("joint above the pelvis ({})", joint.name),
                    joint.kind.word(),
                    "the pelvis carries the upper body, nothing carries the pelvis",
                    "lock this joint, or make it floating if the ground is above it",
                ));
            }
            highest = self.index[joint.parent.as_str()];
        }
        Ok(pelvis)
    }

    /// The links that are fixed to a link, in its frame, away from the moving joint that carries it. Above the pelvis
    /// only fixed joints are followed; beyond a floating one is the ground.
    pub(super) fn rigid(&self, first: usize) -> Result<Rigid<'a>, RobotError> {
        let mut rigid = Rigid {
            body: None,
            moving: Vec::new(),
        };
        let mut todo = vec![(first, Isometry3::identity(), None)];
        while let Some((link, frame, via)) = todo.pop() {
            if let Some(own) = self.own_body(link)? {
                let rotation = frame.rotation.to_rotation_matrix();
                let own = own.moved(rotation.matrix(), &frame.translation.vector);
                rigid.body = Some(rigid.body.map_or(own, |body| body.joined(&own)));
            }
            for j in &self.carried[link] {
                let joint = &self.joints[*j];
                if Some(*j) == via {
                    continue;
                }
                if self.is_fixed(joint) {
                    let frame = frame * self.origin(joint)?;
                    todo.push((self.child_of(*j), frame, Some(*j)));
                } else {
                    let parent = frame;
                    rigid.moving.push(Moving { joint, parent });
                }
            }
            if let Some(j) = self.carrier[link]
                && via != Some(j)
                && self.is_fixed(&self.joints[j])
            {
                let frame = frame * self.origin(&self.joints[j])?.inverse();
                let above = self.index[self.joints[j].parent.as_str()];
                todo.push((above, frame, Some(j)));
            }
        }
        Ok(rigid)
    }

    /// A link of each group of rigid links.
    pub(super) fn carriers(&self) -> Vec<usize> {
        let is_first = |link: &usize| match self.carrier[*link] {
            Some(joint) => !self.is_fixed(&self.joints[joint]),
            None => true,
        };
        (0..self.links.len()).filter(is_first).collect()
    }

    /// Whether a link of this name is fixed to a link, over however many others.
    pub(super) fn are_rigid(&self, link: usize, name: &str) -> bool {
        let Some(mut other) = self.index.get(name).copied() else {
            return false;
        };
        while let Some(joint) = self.carrier[other].map(|joint| &self.joints[joint]) {
            if !self.is_fixed(joint) {
                break;
            }
            other = self.index[joint.parent.as_str()];
        }
        other == link
    }

    /// Whether a link has this name.
    pub(super) fn is_named(&self, link: usize, name: &str) -> bool {
        self.name(link) == name
    }

    /// The link that carries a joint.
    pub(super) fn carrier_of(&self, joint: &str) -> String {
        let joint = self.joints.iter().find(|own| own.name == joint);
        joint.map_or(String::new(), |joint| joint.parent.clone())
    }

    /// The body of rigid links; a link that moves needs one.
    pub(super) fn body(&self, first: usize, rigid: &Rigid<'_>) -> Result<Body, RobotError> {
        let name = self.name(first);
        let place = Place {
            prefix: "link ",
            name,
        };
        let Some(body) = &rigid.body else {
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

    /// Frame of a moving joint at q = 0 in the frame of the rigid links that carry it.
    pub(super) fn placement(&self, moving: &Moving<'_>) -> Result<Isometry3<f64>, RobotError> {
        Ok(moving.parent * self.origin(moving.joint)?)
    }

    /// The link that a moving joint moves.
    pub(super) fn child(&self, moving: &Moving<'_>) -> usize {
        self.index[moving.joint.child.as_str()]
    }

    /// Refuses joints of a leg that are not revolute, or follow another one.
    pub(super) fn revolute(&self, joint: &Joint) -> Result<(), RobotError> {
        let place = Place {
            prefix: "joint ",
            name: &joint.name,
        };
        if let Some(mimic) = &joint.mimic {
            return Err(self.check.invalid(
                place.key("mimic"),
                format!("{mimic:?}"),
                "every joint of a leg has its own actuator",
                "remove the mimic, or lock the joint",
            ));
        }
        if joint.kind == JointKind::Revolute {
            return Ok(());
        }
        Err(self.check.invalid(
            place.key("type"),
            joint.kind.word(),
            "the joints of a leg are revolute",
            "make it revolute with limits, or fixed",
        ))
    }

    /// A link's own mass; none for a bare frame. The inertia of a point or a line will do where other links add to it.
    fn own_body(&self, link: usize) -> Result<Option<Body>, RobotError> {
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
        self.check.realizable(place, mass_kg, com_m, &tensor)?;
        let rotation = origin.rotation.to_rotation_matrix();
        Ok(Some(Body {
            mass_kg,
            com_m,
            inertia_kg_m2: rotation.matrix() * tensor * rotation.matrix().transpose(),
        }))
    }

    fn origin(&self, joint: &Joint) -> Result<Isometry3<f64>, RobotError> {
        let place = Place {
            prefix: "joint ",
            name: &joint.name,
        };
        let names = self.check.names;
        let (xyz, rpy) = (place.key(names.xyz), place.key(names.rpy));
        self.check
            .pose(&xyz, joint.origin.xyz, &rpy, joint.origin.rpy)
    }

    fn is_fixed(&self, joint: &Joint) -> bool {
        joint.kind == JointKind::Fixed || self.locked.contains(&joint.name)
    }

    fn link(&self, joint: &str, what: &str, name: &str) -> Result<usize, RobotError> {
        self.index.get(name).copied().ok_or_else(|| {
            self.check.invalid(
                format!("joint {what} ({joint})"),
                format!("{name:?}"),
                "no such link",
                "name a link of the file",
            )
        })
    }

    fn child_of(&self, joint: usize) -> usize {
        self.index[self.joints[joint].child.as_str()]
    }

    fn name(&self, link: usize) -> &'a str {
        &self.links[link].name
    }
}
