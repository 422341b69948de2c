//! `[agent]`.

use crate::agent::robot::{self, JOINTS, Robot, RobotError, Soles, Standing, UrdfOptions};
use crate::agent::{ActuationKind, Agent, Biped, RobotFile, Uav};
use crate::campaign::check::Check;
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::parameter::Bounds;
use std::path::Path;

/// The paper's UAV, section V.
const PAPER_MASS_KG: f64 = 2.0;
const PAPER_INERTIA_KG_M2: [f64; 3] = [1.25, 1.25, 2.2];
const PAPER_DRAG_N_S_M: f64 = 0.01;
const PAPER_ANGULAR_DRAG_N_M_S: f64 = 0.012;
const PAPER_GRAVITY_M_S2: f64 = 9.81;

/// The keys that only a URDF needs, and whether each is given.
fn of_urdf(file: &AgentFile) -> [(&'static str, bool); 5] {
    [
        ("pelvis", file.pelvis.is_some()),
        ("left_hip", file.left_hip.is_some()),
        ("right_hip", file.right_hip.is_some()),
        ("locked", file.locked.is_some()),
        ("sole", file.sole.is_some()),
    ]
}

impl Check<'_> {
    /// What the agents are; `robot` is the text of the robot's file, if it is not to be read.
    pub(super) fn agent(
        &self,
        file: &AgentFile,
        robot: Option<String>,
    ) -> Result<Agent, CampaignError> {
        match file.kind {
            AgentKind::Uav => {
                let of_bipeds = [
                    ("robot", file.robot.is_some()),
                    ("armature_kg_m2", file.armature_kg_m2.is_some()),
                    ("standing", file.standing.is_some()),
                ];
                self.unused("agent", "uav", &[&of_bipeds[..], &of_urdf(file)].concat())?;
                self.uav(file).map(Agent::Uav)
            }
            AgentKind::Biped => {
                let of_uavs = [
                    ("inertia_scale", file.inertia_scale.is_some()),
                    ("mass_kg", file.mass_kg.is_some()),
                    ("inertia_kg_m2", file.inertia_kg_m2.is_some()),
                    ("drag_n_s_m", file.drag_n_s_m.is_some()),
                    ("angular_drag_n_m_s", file.angular_drag_n_m_s.is_some()),
                    ("gravity_m_s2", file.gravity_m_s2.is_some()),
                    ("command_filter_rad_s", file.command_filter_rad_s.is_some()),
                    ("max_thrust_n", file.max_thrust_n.is_some()),
                    ("max_torque_n_m", file.max_torque_n_m.is_some()),
                    ("max_tilt_rad", file.max_tilt_rad.is_some()),
                ];
                self.unused("agent", "biped", &of_uavs)?;
                self.biped(file, robot).map(Agent::Biped)
            }
        }
    }

    fn biped(&self, file: &AgentFile, text: Option<String>) -> Result<Biped, CampaignError> {
        let actuation = file.actuation.unwrap_or(ActuationKind::Full);
        if actuation == ActuationKind::Thrust {
            return Err(self.invalid(
                "agent.actuation",
                "\"thrust\"",
                "a biped's joints have torques",
                "use \"full\", or \"limited\" to cut them at the robot's limits",
            ));
        }
        let beside = |name: &String| self.source.beside(name);
        let path = file.robot.as_ref().map_or(robot::G1_PATH.into(), beside);
        let text = match (text, &file.robot) {
            (Some(text), _) => text,
            (None, None) => robot::G1.to_string(),
            (None, Some(name)) => {
                Robot::text(&path).map_err(|error| self.no_robot(name, &error))?
            }
        };
        let options = self.urdf_options(file, &path)?;
        let own = RobotFile { path, text };
        Ok(Biped {
            actuation,
            robot: Robot::parse_with(&own.text, &own.path, &options).map_err(Box::new)?,
            file: own,
        })
    }

    /// What a campaign says of a robot's file. What only a URDF leaves open is refused of a table.
    fn urdf_options(&self, file: &AgentFile, path: &Path) -> Result<UrdfOptions, CampaignError> {
        let given = of_urdf(file).into_iter().find(|(_, given)| *given);
        if let (Some((key, _)), false) = (given, robot::is_urdf(path)) {
            return Err(self.invalid(
                format!("agent.{key}"),
                "given",
                "a joint table says this itself; only a URDF does not",
                "remove it, or write it into the table",
            ));
        }
        let armature_kg_m2 = file.armature_kg_m2.as_ref().map(|numbers| {
            let key = "agent.armature_kg_m2";
            let list = self.numbers_of(key, Some(numbers), 0.0, Bounds::NonNegative, JOINTS)?;
            Ok::<_, CampaignError>(std::array::from_fn(|joint| list[joint]))
        });
        Ok(UrdfOptions {
            pelvis: file.pelvis.clone(),
            left_hip: file.left_hip.clone(),
            right_hip: file.right_hip.clone(),
            locked: file.locked.clone().unwrap_or_default(),
            armature_kg_m2: armature_kg_m2.transpose()?,
            standing: file.standing.as_ref().map(|standing| match standing {
                WordOr::Word(StandingFile::Bent) => Standing::Bent,
                WordOr::List(angles) => Standing::Angles(angles.0),
            }),
            soles: file.sole.as_ref().map(|sole| match sole {
                WordOr::Word(SoleFile::Standing) => Soles::Standing,
                WordOr::List(frames) => Soles::Frames(frames.0.clone()),
            }),
            ..UrdfOptions::default()
        })
    }

    /// A robot's file that is none, by the key that names it; what is wrong within one is said with the file's own
    /// name.
    fn no_robot(&self, name: &str, error: &RobotError) -> CampaignError {
        let (limit, remedy) = match error {
            RobotError::Read { source, .. } => (
                format!("cannot be read ({source})"),
                "name an existing robot file, relative to the campaign",
            ),
            _ => (
                "a robot file ends in .toml (joint table) or .urdf".to_string(),
                "rename it or name another",
            ),
        };
        self.invalid("agent.robot", format!("{name:?}"), &limit, remedy)
    }

    fn uav(&self, file: &AgentFile) -> Result<Uav, CampaignError> {
        let actuation = self.uav_actuation(file)?;
        let number = |key: &str, value: Option<f64>, default: f64, bounds: Bounds| {
            self.number(key, value.unwrap_or(default), bounds)
        };
        let positive =
            |key: &str, value, default: f64| number(key, value, default, Bounds::Positive);
        let not_negative =
            |key: &str, value, default: f64| number(key, value, default, Bounds::NonNegative);
        let inertia_kg_m2 = self.uav_inertia(file)?;
        let max_tilt_rad = positive("agent.max_tilt_rad", file.max_tilt_rad, 1.0)?;
        if max_tilt_rad >= std::f64::consts::FRAC_PI_2 {
            return Err(self.invalid(
                "agent.max_tilt_rad",
                in_toml(max_tilt_rad),
                "must be below pi/2",
                "use 1.0 or less",
            ));
        }
        Ok(Uav {
            actuation,
            mass_kg: positive("agent.mass_kg", file.mass_kg, PAPER_MASS_KG)?,
            inertia_kg_m2,
            drag_n_s_m: not_negative("agent.drag_n_s_m", file.drag_n_s_m, PAPER_DRAG_N_S_M)?,
            angular_drag_n_m_s: not_negative(
                "agent.angular_drag_n_m_s",
                file.angular_drag_n_m_s,
                PAPER_ANGULAR_DRAG_N_M_S,
            )?,
            gravity_m_s2: not_negative(
                "agent.gravity_m_s2",
                file.gravity_m_s2,
                PAPER_GRAVITY_M_S2,
            )?,
            command_filter_rad_s: positive(
                "agent.command_filter_rad_s",
                file.command_filter_rad_s,
                20.0,
            )?,
            max_thrust_n: positive("agent.max_thrust_n", file.max_thrust_n, 80.0)?,
            max_torque_n_m: positive("agent.max_torque_n_m", file.max_torque_n_m, 60.0)?,
            max_tilt_rad,
        })
    }

    /// What a UAV's command acts through; what belongs to another actuation is refused.
    fn uav_actuation(&self, file: &AgentFile) -> Result<ActuationKind, CampaignError> {
        let actuation = file.actuation.unwrap_or(ActuationKind::Full);
        if actuation == ActuationKind::Limited {
            return Err(self.invalid(
                "agent.actuation",
                "\"limited\"",
                "a UAV is actuated in \"full\" or by \"thrust\", which has limits",
                "use one of these",
            ));
        }
        let thrust_only = [
            ("agent.command_filter_rad_s", file.command_filter_rad_s),
            ("agent.max_thrust_n", file.max_thrust_n),
            ("agent.max_torque_n_m", file.max_torque_n_m),
            ("agent.max_tilt_rad", file.max_tilt_rad),
        ];
        if actuation == ActuationKind::Full
            && let Some((key, Some(value))) =
                thrust_only.into_iter().find(|(_, value)| value.is_some())
        {
            return Err(self.invalid(
                key,
                in_toml(value),
                "only the actuation \"thrust\" has this",
                "remove it or set agent.actuation = \"thrust\"",
            ));
        }
        Ok(actuation)
    }

    /// Principal inertias that a body can have.
    fn uav_inertia(&self, file: &AgentFile) -> Result<[f64; 3], CampaignError> {
        let inertia_kg_m2 = file
            .inertia_kg_m2
            .map_or(PAPER_INERTIA_KG_M2, |list| list.0);
        for (axis, inertia) in inertia_kg_m2.into_iter().enumerate() {
            let key = format!("agent.inertia_kg_m2[{axis}]");
            self.number(&key, inertia, Bounds::Positive)?;
        }
        let [jx, jy, jz] = inertia_kg_m2;
        if jx > jy + jz || jy > jx + jz || jz > jx + jy {
            return Err(self.invalid(
                "agent.inertia_kg_m2",
                format!("{inertia_kg_m2:?}"),
                "no body has a principal inertia above the sum of the other two",
                "correct the inertias",
            ));
        }
        Ok(inertia_kg_m2)
    }
}
