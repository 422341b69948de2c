//! `[reference]`.

use crate::agent::robot::Robot;
use crate::agent::{ActuationKind, Agent, FIRST_ATTITUDE};
use crate::campaign::check::Check;
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::parameter::Bounds;
use crate::reference::path::{DEFAULT_STEP_M, PathLimits};
use crate::reference::walk::{Foot, Gait, WalkError, nearest};
use crate::reference::{AgentWalk, Reference, Sinusoid, Walk, WaypointPath};
use std::sync::Arc;

/// The channel after roll and pitch.
const YAW: usize = FIRST_ATTITUDE + 2;

impl Check<'_> {
    /// The references of a team.
    pub(super) fn reference(
        &self,
        file: &ReferenceFile,
        team: usize,
        agent: &Agent,
    ) -> Result<Reference, CampaignError> {
        self.only_own_keys(file)?;
        self.blocks("reference.agents", file.agents.as_deref(), team)?;
        match (file.kind, agent) {
            (ReferenceKind::Sinusoid, _) => {
                let sinusoid = |index| self.sinusoid(file, index, agent.actuation());
                let agents = (0..team).map(sinusoid).collect::<Result<_, _>>();
                agents.map(Reference::Sinusoid)
            }
            (ReferenceKind::Waypoints, Agent::Uav(_)) => self.waypoints(file, team),
            (ReferenceKind::Walk, Agent::Biped(biped)) => self.walks(file, team, &biped.robot),
            (ReferenceKind::Waypoints, Agent::Biped(_)) => Err(self.invalid(
                "reference.kind",
                "\"waypoints\"",
                "a path through space is a UAV's",
                "use \"walk\" with points (x, y), or \"sinusoid\"",
            )),
            (ReferenceKind::Walk, Agent::Uav(_)) => Err(self.invalid(
                "reference.kind",
                "\"walk\"",
                "a UAV does not walk",
                "use \"waypoints\" with points (x, y, z), or \"sinusoid\"",
            )),
        }
    }

    /// Refuses keys of other kinds of references.
    fn only_own_keys(&self, file: &ReferenceFile) -> Result<(), CampaignError> {
        use ReferenceKind::{Sinusoid, Walk, Waypoints};
        let of: [(&str, bool, &[ReferenceKind]); 12] = [
            ("center", file.center.is_some(), &[Sinusoid]),
            ("amplitude", file.amplitude.is_some(), &[Sinusoid]),
            (
                "frequency_rad_s",
                file.frequency_rad_s.is_some(),
                &[Sinusoid],
            ),
            ("phase_rad", file.phase_rad.is_some(), &[Sinusoid]),
            ("points_m", file.points_m.is_some(), &[Waypoints, Walk]),
            ("offset_m", file.offset_m.is_some(), &[Waypoints]),
            ("max_speed_m_s", file.max_speed_m_s.is_some(), &[Waypoints]),
            (
                "max_acceleration_m_s2",
                file.max_acceleration_m_s2.is_some(),
                &[Waypoints],
            ),
            ("step_m", file.step_m.is_some(), &[Waypoints]),
            ("start_s", file.start_s.is_some(), &[Walk]),
            ("gait", file.gait.is_some(), &[Walk]),
            ("agents", file.agents.is_some(), &[Sinusoid, Walk]),
        ];
        let kind = match file.kind {
            Sinusoid => "sinusoid",
            Waypoints => "waypoints",
            Walk => "walk",
        };
        let foreign = of.map(|(key, given, kinds)| (key, given && !kinds.contains(&file.kind)));
        self.unused("reference", kind, &foreign)?;
        for (agent, block) in file.agents.iter().flatten().enumerate() {
            let walks = file.kind == Walk;
            let foreign = [
                ("center", block.center.is_some() && walks),
                ("amplitude", block.amplitude.is_some() && walks),
                ("frequency_rad_s", block.frequency_rad_s.is_some() && walks),
                ("phase_rad", block.phase_rad.is_some() && walks),
                ("points_m", block.points_m.is_some() && !walks),
                ("start_s", block.start_s.is_some() && !walks),
            ];
            self.unused(&format!("reference.agents[{agent}]"), kind, &foreign)?;
        }
        Ok(())
    }

    fn sinusoid(
        &self,
        file: &ReferenceFile,
        agent: usize,
        actuation: ActuationKind,
    ) -> Result<Vec<Sinusoid>, CampaignError> {
        let block = file.agents.as_ref().map(|blocks| &blocks[agent]);
        let of = |name: &str, moves: bool, base: &Option<Numbers>, own: Option<&Numbers>| {
            let key = if own.is_some() {
                format!("reference.agents[{agent}].{name}")
            } else {
                format!("reference.{name}")
            };
            let values = self.numbers(&key, own.or(base.as_ref()), 0.0, Bounds::Any)?;
            let tilts = || {
                values[FIRST_ATTITUDE..YAW]
                    .iter()
                    .any(|value| *value != 0.0)
            };
            if actuation == ActuationKind::Thrust && moves && tilts() {
                return Err(self.invalid(
                    key,
                    format!("{values:?}"),
                    "with the actuation \"thrust\" roll and pitch follow from the force",
                    "give a list with 0 on channels 4 and 5",
                ));
            }
            Ok(values)
        };
        let own = |pick: fn(&ReferenceBlock) -> Option<&Numbers>| block.and_then(pick);
        let center = own(|block| block.center.as_ref());
        let center = of("center", true, &file.center, center)?;
        let amplitude = own(|block| block.amplitude.as_ref());
        let amplitude = of("amplitude", true, &file.amplitude, amplitude)?;
        let frequency = own(|block| block.frequency_rad_s.as_ref());
        let frequency = of("frequency_rad_s", false, &file.frequency_rad_s, frequency)?;
        let phase = own(|block| block.phase_rad.as_ref());
        let phase = of("phase_rad", false, &file.phase_rad, phase)?;
        let sinusoid = |c: usize| Sinusoid {
            center: center[c],
            amplitude: amplitude[c],
            frequency_rad_s: frequency[c],
            phase_rad: phase[c],
        };
        Ok((0..self.channels.len()).map(sinusoid).collect())
    }

    /// Points of so many coordinates, under a key.
    fn points<const N: usize>(
        &self,
        key: &str,
        points: Option<&[Vec<f64>]>,
    ) -> Result<Vec<[f64; N]>, CampaignError> {
        let Some(points) = points else {
            return Err(self.invalid(key, "absent", "this kind needs it", "add it"));
        };
        let point = |(index, point): (usize, &Vec<f64>)| {
            <[f64; N]>::try_from(point.as_slice()).map_err(|_| {
                self.invalid(
                    format!("{key}[{index}]"),
                    format!("{point:?}"),
                    &format!("a point of this kind has {N} coordinates"),
                    "complete or shorten it",
                )
            })
        };
        points.iter().enumerate().map(point).collect()
    }

    fn walks(
        &self,
        file: &ReferenceFile,
        team: usize,
        robot: &Robot,
    ) -> Result<Reference, CampaignError> {
        let gait = file.gait.clone().unwrap_or_default();
        let mut planned: Vec<(Vec<[f64; 2]>, Arc<Walk>)> = Vec::new();
        let mut walks = Vec::with_capacity(team);
        for agent in 0..team {
            let block = file.agents.as_ref().map(|blocks| &blocks[agent]);
            let own = block.and_then(|block| block.points_m.as_deref());
            let key = match own {
                Some(_) => format!("reference.agents[{agent}].points_m"),
                None => "reference.points_m".to_string(),
            };
            let points = self.points(&key, own.or(file.points_m.as_deref()))?;
            let walk = match planned.iter().find(|(known, _)| *known == points) {
                Some((_, walk)) => Arc::clone(walk),
                None => {
                    let walk = Arc::new(self.walk(&key, &points, &gait, robot)?);
                    planned.push((points, Arc::clone(&walk)));
                    walk
                }
            };
            let start = block.and_then(|block| block.start_s);
            let key = match start {
                Some(_) => format!("reference.agents[{agent}].start_s"),
                None => "reference.start_s".to_string(),
            };
            let start_s = self.number(&key, start.or(file.start_s).unwrap_or(0.0), Bounds::Any)?;
            walks.push(AgentWalk { walk, start_s });
        }
        Ok(Reference::Walk(walks))
    }

    fn walk(
        &self,
        key: &str,
        points: &[[f64; 2]],
        file: &GaitFile,
        robot: &Robot,
    ) -> Result<Walk, CampaignError> {
        let gait = gait(file, &Gait::of(robot));
        let plan = |gait: &Gait| match &file.com_offset_m {
            None => Walk::plan(robot, points, gait),
            Some(offset_m) => Walk::plan_with_com_offset(robot, points, gait, offset_m.0),
        };
        plan(&gait).map_err(|error| match error {
            WalkError::Gait {
                name,
                value,
                limit,
                remedy,
            } => self.invalid(
                format!("reference.gait.{name}"),
                in_toml(value),
                &limit,
                remedy,
            ),
            other => {
                let text = other.to_string();
                let (limit, remedy) = text.rsplit_once("; ").unwrap_or((&text, "correct it"));
                let length_m = points.windows(2).map(|ends| {
                    let [[x0, y0], [x1, y1]] = [ends[0], ends[1]];
                    (x1 - x0).hypot(y1 - y0)
                });
                let length_m = length_m.sum();
                let tried = other
                    .is_of_the_gait()
                    .then(|| walkable(&gait, length_m, plan));
                let remedy = tried.unwrap_or_else(|| remedy.to_string());
                self.invalid(key, format!("{points:?}"), limit, &remedy)
            }
        })
    }

    fn waypoints(&self, file: &ReferenceFile, team: usize) -> Result<Reference, CampaignError> {
        let missing = |key: &str| {
            self.invalid(
                format!("reference.{key}"),
                "absent",
                "waypoints need it",
                "add it",
            )
        };
        let points: Vec<[f64; 3]> = self.points("reference.points_m", file.points_m.as_deref())?;
        let limits = PathLimits {
            max_speed_m_s: file.max_speed_m_s.ok_or_else(|| missing("max_speed_m_s"))?,
            max_acceleration_m_s2: file
                .max_acceleration_m_s2
                .ok_or_else(|| missing("max_acceleration_m_s2"))?,
        };
        self.number(
            "reference.max_speed_m_s",
            limits.max_speed_m_s,
            Bounds::Positive,
        )?;
        self.number(
            "reference.max_acceleration_m_s2",
            limits.max_acceleration_m_s2,
            Bounds::Positive,
        )?;
        let step_m = self.number(
            "reference.step_m",
            file.step_m.unwrap_or(DEFAULT_STEP_M),
            Bounds::Positive,
        )?;
        self.blocks("reference.offset_m", file.offset_m.as_deref(), team)?;
        for (agent, offset) in file.offset_m.iter().flatten().enumerate() {
            for (axis, metres) in offset.0.iter().enumerate() {
                let key = format!("reference.offset_m[{agent}][{axis}]");
                self.number(&key, *metres, Bounds::Any)?;
            }
        }
        (0..team)
            .map(|agent| {
                let offset = file
                    .offset_m
                    .as_ref()
                    .map_or([0.0; 3], |offsets| offsets[agent].0);
                let own: Vec<[f64; 3]> = points
                    .iter()
                    .map(|point| std::array::from_fn(|axis| point[axis] + offset[axis]))
                    .collect();
                WaypointPath::with_step(&own, step_m, limits).map_err(|error| {
                    self.invalid(
                        "reference.points_m",
                        format!("{points:?}"),
                        &error.to_string(),
                        "correct the points",
                    )
                })
            })
            .collect::<Result<_, _>>()
            .map(Reference::Waypoints)
    }
}

/// The nearest gait that was found to give a walk, as a remedy.
fn walkable(
    gait: &Gait,
    length_m: f64,
    plan: impl FnMut(&Gait) -> Result<Walk, WalkError>,
) -> String {
    let Some(found) = nearest(gait, length_m, plan) else {
        return "no other height of the pelvis and no shorter or slower steps were found that help: take a line with wider bends, or \
                say how the robot stands (agent.standing, agent.sole)"
            .to_string();
    };
    let changed = found.unlike(gait).into_iter();
    let changed: Vec<String> = changed
        .map(|(name, value)| format!("{name} = {}", in_toml(value)))
        .collect();
    format!(
        "the nearest gait that can be walked has {} in [reference.gait]",
        changed.join(", ")
    )
}

/// The robot's own gait with the file's overrides; its numbers are checked when a walk is planned.
fn gait(file: &GaitFile, own: &Gait) -> Gait {
    let GaitFile {
        sampling_s,
        step_length_m,
        step_height_m,
        step_period_s,
        double_support_s,
        foot_offset_m,
        pelvis_height_m,
        ankle_height_m,
        zmp_ahead_m,
        standing_before_s,
        standing_after_s,
        first_foot,
        smoothing_step_m,
        com_offset_m: _,
    } = *file;
    Gait {
        sampling_s: sampling_s.unwrap_or(own.sampling_s),
        step_length_m: step_length_m.unwrap_or(own.step_length_m),
        step_height_m: step_height_m.unwrap_or(own.step_height_m),
        step_period_s: step_period_s.unwrap_or(own.step_period_s),
        double_support_s: double_support_s.unwrap_or(own.double_support_s),
        foot_offset_m: foot_offset_m.unwrap_or(own.foot_offset_m),
        pelvis_height_m: pelvis_height_m.unwrap_or(own.pelvis_height_m),
        ankle_height_m: ankle_height_m.unwrap_or(own.ankle_height_m),
        zmp_ahead_m: zmp_ahead_m.unwrap_or(own.zmp_ahead_m),
        standing_before_s: standing_before_s.unwrap_or(own.standing_before_s),
        standing_after_s: standing_after_s.unwrap_or(own.standing_after_s),
        first_foot: match first_foot {
            None => own.first_foot,
            Some(FootFile::Left) => Foot::Left,
            Some(FootFile::Right) => Foot::Right,
        },
        smoothing_step_m: smoothing_step_m.unwrap_or(own.smoothing_step_m),
    }
}
