//! XML to links and joints: what the model uses, read number by number; what it does not use cannot stop it.

use crate::agent::robot::error::RobotError;
use crate::util::text_file::without_mark;
use roxmltree::{Document, Node};
use std::path::Path;

/// The links and joints of a URDF.
#[derive(Debug, Clone)]
pub(super) struct Urdf {
    pub name: String,
    pub links: Vec<Link>,
    pub joints: Vec<Joint>,
}

/// A `<link>`.
#[derive(Debug, Clone)]
pub(super) struct Link {
    pub name: String,
    /// None of a bare frame.
    pub inertial: Option<Inertial>,
}

/// An `<inertial>`.
#[derive(Debug, Clone)]
pub(super) struct Inertial {
    pub origin: Pose,
    pub mass: f64,
    /// ixx, ixy, ixz, iyy, iyz, izz.
    pub inertia: [f64; 6],
}

/// An `<origin>`; zero where there is none.
#[derive(Debug, Clone, Default)]
pub(super) struct Pose {
    pub xyz: [f64; 3],
    pub rpy: [f64; 3],
}

/// A `<joint>`.
#[derive(Debug, Clone)]
pub(super) struct Joint {
    pub name: String,
    pub kind: JointKind,
    pub origin: Pose,
    pub parent: String,
    pub child: String,
    pub axis: [f64; 3],
    /// What moves it, or what is wrong there: a joint that is held still may say anything.
    pub drive: Result<Drive, String>,
    /// The joint that it follows, if it does.
    pub mimic: Option<String>,
}

/// `<limit>` and `<dynamics>` of a joint.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    pub limit: Limit,
    pub damping: f64,
    pub friction: f64,
    /// Inertia of the rotor as seen from the joint, where the file says it, kg m^2.
    pub armature: Option<f64>,
}

/// A `<limit>`; zero where there is none.
#[derive(Debug, Clone, Default)]
pub(super) struct Limit {
    pub lower: f64,
    pub upper: f64,
    pub effort: f64,
    pub velocity: f64,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum JointKind {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    Floating,
    Planar,
    Spherical,
}

impl JointKind {
    const ALL: [Self; 7] = [
        Self::Revolute,
        Self::Continuous,
        Self::Prismatic,
        Self::Fixed,
        Self::Floating,
        Self::Planar,
        Self::Spherical,
    ];

    /// The word in the file.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
            Self::Fixed => "fixed",
            Self::Floating => "floating",
            Self::Planar => "planar",
            Self::Spherical => "spherical",
        }
    }
}

/// Reads what the model uses of a URDF.
///
/// # Errors
/// If it is no XML, has no `<robot>`, or something that is used is missing or no number: with line and element.
pub(super) fn read(text: &str, path: &Path) -> Result<Urdf, RobotError> {
    let document = Document::parse(without_mark(text)).map_err(|error| {
        let remedy = match text.contains("<xacro:") {
            true => "expand the file with xacro first",
            false => "write it as XML requires",
        };
        syntax(path, format!("{error}; {remedy}"))
    })?;
    let reader = Reader {
        document: &document,
        has_quaternions: false,
    };
    reader.robot().map_err(|message| syntax(path, message))
}

pub(super) fn syntax(path: &Path, message: String) -> RobotError {
    RobotError::Syntax {
        path: path.to_path_buf(),
        message,
    }
}

struct Reader<'a> {
    document: &'a Document<'a>,
    /// Whether the file is of a version that knows `quat_xyzw`.
    has_quaternions: bool,
}

impl<'a> Reader<'a> {
    fn robot(mut self) -> Result<Urdf, String> {
        let root = self.document.root_element();
        if root.tag_name().name() != "robot" {
            return Err(self.wrong(root, "this is no <robot>; name a URDF"));
        }
        let unexpanded = |node: &Node<'_, '_>| {
            let namespace = node.tag_name().namespace();
            namespace.is_some_and(|own| own.ends_with("/xacro"))
        };
        if let Some(node) = root.descendants().find(unexpanded) {
            return Err(self.wrong(node, "this is xacro; expand the file with xacro first"));
        }
        // Version 1.0 where none is said; quaternions came with 1.1.
        let version = root.attribute("version").unwrap_or("1.0").trim();
        let minor = version.split_once('.');
        self.has_quaternions = minor.is_some_and(|(major, minor)| {
            let number = |text: &str| text.parse::<u32>().unwrap_or(0);
            (number(major), number(minor)) >= (1, 1)
        });
        let of_kind = |tag: &'static str| {
            let children = root.children();
            children.filter(move |node| node.tag_name().name() == tag && node.is_element())
        };
        let links = of_kind("link").map(|node| self.link(node));
        let joints = of_kind("joint").map(|node| self.joint(node));
        Ok(Urdf {
            name: root.attribute("name").unwrap_or_default().to_string(),
            links: links.collect::<Result<_, _>>()?,
            joints: joints.collect::<Result<_, _>>()?,
        })
    }

    fn link(&self, node: Node<'a, 'a>) -> Result<Link, String> {
        let inertial = child(node, "inertial").map(|inertial| {
            let inertia = self.needed(inertial, "inertia")?;
            let mut six = [0.0; 6];
            let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
            for (entry, name) in six.iter_mut().zip(names) {
                *entry = self.number(inertia, name, None)?;
            }
            Ok::<_, String>(Inertial {
                origin: self.origin(inertial)?,
                mass: self.number(self.needed(inertial, "mass")?, "value", None)?,
                inertia: six,
            })
        });
        Ok(Link {
            name: self.text(node, "name")?,
            inertial: inertial.transpose()?,
        })
    }

    fn joint(&self, node: Node<'a, 'a>) -> Result<Joint, String> {
        let word = self.text(node, "type")?;
        let kind = JointKind::ALL.into_iter().find(|kind| kind.word() == word);
        let kind = kind.ok_or_else(|| {
            let known = JointKind::ALL.map(JointKind::word).join(", ");
            self.wrong(
                node,
                &format!("the type {word:?} is none of {known}; take one of these"),
            )
        })?;
        let axis = child(node, "axis").map(|axis| self.three(axis, "xyz"));
        let link = |tag| self.text(self.needed(node, tag)?, "link");
        let mimic = child(node, "mimic").map(|mimic| self.text(mimic, "joint"));
        Ok(Joint {
            name: self.text(node, "name")?,
            kind,
            origin: self.origin(node)?,
            parent: link("parent")?,
            child: link("child")?,
            axis: axis.transpose()?.flatten().unwrap_or([1.0, 0.0, 0.0]),
            drive: self.drive(node),
            mimic: mimic.transpose()?,
        })
    }

    fn drive(&self, joint: Node<'a, 'a>) -> Result<Drive, String> {
        let limit = child(joint, "limit").map(|limit| {
            Ok::<_, String>(Limit {
                lower: self.number(limit, "lower", Some(0.0))?,
                upper: self.number(limit, "upper", Some(0.0))?,
                effort: self.number(limit, "effort", None)?,
                velocity: self.number(limit, "velocity", None)?,
            })
        });
        let dynamics = child(joint, "dynamics");
        let of_dynamics = |name| match dynamics {
            Some(dynamics) => self.number(dynamics, name, Some(0.0)),
            None => Ok(0.0),
        };
        let armature = dynamics.filter(|node| node.has_attribute("armature"));
        let armature = armature.map(|node| self.number(node, "armature", None));
        Ok(Drive {
            limit: limit.transpose()?.unwrap_or_default(),
            damping: of_dynamics("damping")?,
            friction: of_dynamics("friction")?,
            armature: armature.transpose()?,
        })
    }

    fn origin(&self, node: Node<'a, 'a>) -> Result<Pose, String> {
        let Some(origin) = child(node, "origin") else {
            return Ok(Pose::default());
        };
        let rpy = self.three(origin, "rpy")?;
        let quaternion = match self.has_quaternions {
            true => self.numbers::<4>(origin, "quat_xyzw")?,
            false => None,
        };
        let rpy = match (rpy, quaternion) {
            (Some(_), Some(_)) => {
                return Err(self.wrong(origin, "rpy and quat_xyzw are two rotations; keep one"));
            }
            (Some(rpy), None) => rpy,
            (None, Some([x, y, z, w])) => {
                let quaternion = nalgebra::Quaternion::new(w, x, y, z);
                let rotation = nalgebra::UnitQuaternion::from_quaternion(quaternion);
                rotation.euler_angles().into()
            }
            (None, None) => [0.0; 3],
        };
        Ok(Pose {
            xyz: self.three(origin, "xyz")?.unwrap_or_default(),
            rpy,
        })
    }

    /// A child element that has to be there.
    fn needed(&self, node: Node<'a, 'a>, tag: &str) -> Result<Node<'a, 'a>, String> {
        child(node, tag)
            .ok_or_else(|| self.wrong(node, &format!("<{tag}> is missing; add this element")))
    }

    /// An attribute that has to be there.
    fn text(&self, node: Node<'a, 'a>, name: &str) -> Result<String, String> {
        let text = node.attribute(name).map(str::to_string);
        text.ok_or_else(|| self.wrong(node, &format!("{name} is missing; add this attribute")))
    }

    /// A number; the given one where there is none.
    fn number(&self, node: Node<'a, 'a>, name: &str, default: Option<f64>) -> Result<f64, String> {
        match (self.numbers::<1>(node, name)?, default) {
            (Some([number]), _) | (None, Some(number)) => Ok(number),
            (None, None) => {
                Err(self.wrong(node, &format!("{name} is missing; add this attribute")))
            }
        }
    }

    fn three(&self, node: Node<'a, 'a>, name: &str) -> Result<Option<[f64; 3]>, String> {
        self.numbers::<3>(node, name)
    }

    /// So many numbers with blanks between them, if the attribute is there. Each word has to be one: a sign that lost
    /// its number would turn the robot into another one.
    fn numbers<const N: usize>(
        &self,
        node: Node<'a, 'a>,
        name: &str,
    ) -> Result<Option<[f64; N]>, String> {
        let Some(text) = node.attribute(name) else {
            return Ok(None);
        };
        let numbers: Option<Vec<f64>> = text
            .split_whitespace()
            .map(|own| own.parse().ok())
            .collect();
        let numbers = numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
        numbers.map(Some).ok_or_else(|| {
            let count = match N {
                1 => "a number".to_string(),
                many => format!("{many} numbers with blanks between them"),
            };
            self.wrong(
                node,
                &format!("{name} = {text:?} is not {count}; correct it"),
            )
        })
    }

    /// What is wrong with an element: its line, its tag, and, unless it is one itself, the link or joint around it.
    fn wrong(&self, node: Node<'_, '_>, message: &str) -> String {
        let line = self.document.text_pos_at(node.range().start).row;
        let named = node.ancestors().find(|own| {
            let tag = own.tag_name().name();
            own.is_element() && (tag == "link" || tag == "joint")
        });
        let mut place = format!("line {line}, ");
        if let Some(own) = named {
            let tag = own.tag_name().name();
            place += &match own.attribute("name") {
                Some(name) => format!("<{tag} name={name:?}>"),
                None => format!("<{tag}>"),
            };
        }
        if named.is_none_or(|own| own != node) {
            let blank = if named.is_some() { " " } else { "" };
            place += &format!("{blank}<{}>", node.tag_name().name());
        }
        format!("{place}: {message}")
    }
}

/// The first child element of a name.
fn child<'a>(node: Node<'a, 'a>, tag: &str) -> Option<Node<'a, 'a>> {
    let mut children = node.children();
    children.find(|own| own.is_element() && own.tag_name().name() == tag)
}
