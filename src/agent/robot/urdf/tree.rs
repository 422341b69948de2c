//! The tree of links and joints of a URDF, and what of it is rigid.

use super::syntax::{Joint, JointKind, Link, Urdf};
use crate::agent::robot::check::{Check, Place};
use crate::agent::robot::error::RobotError;
use nalgebra::Isometry3;
use std::collections::HashMap;

/// A URDF whose joints connect its links to one tree.
pub(super) struct Tree<'a> {
    pub(super) check: &'a Check<'a>,
    pub(super) links: &'a [Link],
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
    /// The links, each with its frame.
    pub links: Vec<(usize, Isometry3<f64>)>,
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

/// A limb at q = 0.
pub(super) struct Limb<'a> {
    /// How high its last moving joint is in the root link's frame, m.
    pub height_m: f64,
    /// Its moving joints, from the last link that carries several of them.
    pub joints: Vec<&'a Joint>,
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
            links: Vec::new(),
            moving: Vec::new(),
        };
        let mut todo = vec![(first, Isometry3::identity(), None)];
        while let Some((link, frame, via)) = todo.pop() {
            rigid.links.push((link, frame));
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

    /// A link's frame at q = 0 in the root link's.
    pub(super) fn at_zero(&self, mut link: usize) -> Result<Isometry3<f64>, RobotError> {
        let mut frame = Isometry3::identity();
        while let Some(joint) = self.carrier[link].map(|joint| &self.joints[joint]) {
            frame = self.origin(joint)? * frame;
            link = self.index[joint.parent.as_str()];
        }
        Ok(frame)
    }

    /// The limbs, the one that hangs lowest first: where their last joints are, for what is fixed behind these may be
    /// anything.
    pub(super) fn limbs(&self) -> Result<Vec<Limb<'a>>, RobotError> {
        let mut limbs = Vec::new();
        for carrier in self.carriers() {
            if self.rigid(carrier)?.moving.is_empty() {
                let height_m = self.at_zero(carrier)?.translation.z;
                let joints = self.limb(carrier)?;
                limbs.push(Limb { height_m, joints });
            }
        }
        limbs.sort_by(|a, b| a.height_m.total_cmp(&b.height_m));
        Ok(limbs)
    }

    /// The moving joints from the last link that carries several of them to a link.
    fn limb(&self, mut link: usize) -> Result<Vec<&'a Joint>, RobotError> {
        let mut joints = Vec::new();
        while let Some(joint) = self.carrier[link].map(|joint| &self.joints[joint]) {
            link = self.index[joint.parent.as_str()];
            if self.is_fixed(joint) {
                continue;
            }
            joints.insert(0, joint);
            if self.rigid(self.carrier_link(link))?.moving.len() > 1 {
                break;
            }
        }
        Ok(joints)
    }

    /// The first of the links that a link is fixed to.
    fn carrier_link(&self, mut link: usize) -> usize {
        while let Some(joint) = self.carrier[link].map(|joint| &self.joints[joint])
            && self.is_fixed(joint)
        {
            link = self.index[joint.parent.as_str()];
        }
        link
    }

    /// Whether a link of this name is fixed to a link, over however many others.
    pub(super) fn are_rigid(&self, link: usize, name: &str) -> bool {
        let other = self.index.get(name);
        other.is_some_and(|other| self.carrier_link(*other) == link)
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

    /// Frame of a moving joint at q = 0 in the frame of the rigid links that carry it.
    pub(super) fn placement(&self, moving: &Moving<'_>) -> Result<Isometry3<f64>, RobotError> {
        Ok(moving.parent * self.origin(moving.joint)?)
    }

    /// A link's frame in that of the link which a joint of this name moves, to which it has to be fixed.
    pub(super) fn frame_below(
        &self,
        joint: &str,
        name: &str,
    ) -> Result<Isometry3<f64>, RobotError> {
        let last = self.joints.iter().find(|own| own.name == joint);
        let last = last.map_or(self.root, |own| self.index[own.child.as_str()]);
        let refused = |limit: String| {
            self.check.invalid(
                "sole",
                format!("{name:?}"),
                limit,
                "name a link that is fixed to the last one of this leg",
            )
        };
        let named = self.index.get(name).copied();
        let mut link = named.ok_or_else(|| refused("no such link".to_string()))?;
        let mut frame = Isometry3::identity();
        while link != last {
            let joint = self.carrier[link].map(|joint| &self.joints[joint]);
            let Some(joint) = joint.filter(|joint| self.is_fixed(joint)) else {
                let last = self.name(last);
                return Err(refused(format!("it is not fixed to {last:?}")));
            };
            frame = self.origin(joint)? * frame;
            link = self.index[joint.parent.as_str()];
        }
        Ok(frame)
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

    pub(super) fn name(&self, link: usize) -> &'a str {
        &self.links[link].name
    }
}
