//! `[reference]`.

use super::super::FIRST_ATTITUDE;
use super::super::check::{Bounds, CHANNELS, Check};
use super::super::error::CampaignError;
use super::super::file::*;
use crate::reference::path::{DEFAULT_STEP_M, PathLimits};
use crate::reference::{Reference, Sinusoid, WaypointPath};

/// The channel after roll and pitch.
const YAW: usize = CHANNELS - 1;

impl Check<'_> {
    /// The references of a team.
    pub(super) fn reference(
        &self,
        file: &ReferenceFile,
        team: usize,
        actuation: ActuationKind,
    ) -> Result<Reference, CampaignError> {
        match file.kind {
            ReferenceKind::Sinusoid => {
                let foreign = [
                    ("points_m", file.points_m.is_some()),
                    ("offset_m", file.offset_m.is_some()),
                    ("max_speed_m_s", file.max_speed_m_s.is_some()),
                    (
                        "max_acceleration_m_s2",
                        file.max_acceleration_m_s2.is_some(),
                    ),
                    ("step_m", file.step_m.is_some()),
                ];
                self.unused("reference", "sinusoid", &foreign)?;
                self.blocks("reference.agents", file.agents.as_deref(), team)?;
                let base = SinusoidFile {
                    center: file.center.clone(),
                    amplitude: file.amplitude.clone(),
                    frequency_rad_s: file.frequency_rad_s.clone(),
                    phase_rad: file.phase_rad.clone(),
                };
                (0..team)
                    .map(|agent| {
                        self.sinusoid(
                            &base,
                            file.agents.as_ref().map(|blocks| &blocks[agent]),
                            agent,
                            actuation,
                        )
                    })
                    .collect::<Result<_, _>>()
                    .map(Reference::Sinusoid)
            }
            ReferenceKind::Waypoints => {
                let foreign = [
                    ("center", file.center.is_some()),
                    ("amplitude", file.amplitude.is_some()),
                    ("frequency_rad_s", file.frequency_rad_s.is_some()),
                    ("phase_rad", file.phase_rad.is_some()),
                    ("agents", file.agents.is_some()),
                ];
                self.unused("reference", "waypoints", &foreign)?;
                self.waypoints(file, team)
            }
        }
    }

    fn sinusoid(
        &self,
        base: &SinusoidFile,
        block: Option<&SinusoidFile>,
        agent: usize,
        actuation: ActuationKind,
    ) -> Result<[Sinusoid; CHANNELS], CampaignError> {
        let of = |name: &str, moves: bool, pick: fn(&SinusoidFile) -> Option<&Numbers>| {
            let own = block.and_then(pick);
            let key = if own.is_some() {
                format!("reference.agents[{agent}].{name}")
            } else {
                format!("reference.{name}")
            };
            let values = self.numbers(&key, own.or_else(|| pick(base)), 0.0, Bounds::Any)?;
            let tilts = values[FIRST_ATTITUDE..YAW]
                .iter()
                .any(|value| *value != 0.0);
            if actuation == ActuationKind::Thrust && moves && tilts {
                return Err(self.invalid(
                    key,
                    format!("{values:?}"),
                    "with the actuation \"thrust\" roll and pitch follow from the force",
                    "give a list with 0 on channels 4 and 5",
                ));
            }
            Ok(values)
        };
        let center = of("center", true, |file| file.center.as_ref())?;
        let amplitude = of("amplitude", true, |file| file.amplitude.as_ref())?;
        let frequency_rad_s = of("frequency_rad_s", false, |file| {
            file.frequency_rad_s.as_ref()
        })?;
        let phase_rad = of("phase_rad", false, |file| file.phase_rad.as_ref())?;
        Ok(std::array::from_fn(|c| Sinusoid {
            center: center[c],
            amplitude: amplitude[c],
            frequency_rad_s: frequency_rad_s[c],
            phase_rad: phase_rad[c],
        }))
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
        let points = file
            .points_m
            .as_deref()
            .ok_or_else(|| missing("points_m"))?;
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
            for (axis, metres) in offset.iter().enumerate() {
                let key = format!("reference.offset_m[{agent}][{axis}]");
                self.number(&key, *metres, Bounds::Any)?;
            }
        }
        (0..team)
            .map(|agent| {
                let offset = file
                    .offset_m
                    .as_ref()
                    .map_or([0.0; 3], |offsets| offsets[agent]);
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
