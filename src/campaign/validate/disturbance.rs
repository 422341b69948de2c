//! `[[disturbance]]`.

use crate::agent::Agent;
use crate::campaign::check::{Check, Written};
use crate::campaign::disturbances_and_faults::Disturbance;
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::time::Time;
use std::borrow::Cow;
use std::f64::consts::TAU;

/// A knot, m/s.
const KNOT_M_S: f64 = 0.514_444;

impl Check<'_> {
    /// A disturbance; `walks` says whether the reference is a walk.
    pub(super) fn disturbance(
        &self,
        index: usize,
        file: &DisturbanceFile,
        team: usize,
        time: Time,
        agent: &Agent,
        walks: bool,
    ) -> Result<Disturbance, CampaignError> {
        let table = format!("disturbance[{index}]");
        let kind = file.kind;
        self.can_disturb(&format!("{table}.kind"), kind, team, agent, walks)?;
        let file = self.with_wind(&table, file)?;
        let file = file.as_ref();
        let parameters = self.parameters(
            &table,
            file,
            file.agents.as_deref(),
            kind.parameters(),
            team,
        )?;
        let key = |name: &str| format!("{table}.{name}");
        match kind {
            DisturbanceKind::Sine => {
                self.resolved(
                    &key("frequency_rad_s"),
                    &parameters[1],
                    |(_, high)| high,
                    time,
                )?;
            }
            DisturbanceKind::Gust1Cosine => {
                let written = Written {
                    base: file.onset_s.as_ref(),
                    own: &|agent| file.agents.as_ref()?[agent].onset_s.as_ref(),
                };
                self.begins(&table, written, &parameters[2], time)?;
                self.resolved(
                    &key("duration_s"),
                    &parameters[3],
                    |(low, _)| TAU / low,
                    time,
                )?;
            }
            DisturbanceKind::Constant
            | DisturbanceKind::GroundReaction
            | DisturbanceKind::RotorVortex
            | DisturbanceKind::Dryden => {}
        }
        Ok(Disturbance { kind, parameters })
    }

    /// Refuses what does not act on such agents, or has nothing to come from.
    fn can_disturb(
        &self,
        key: &str,
        kind: DisturbanceKind,
        team: usize,
        agent: &Agent,
        walks: bool,
    ) -> Result<(), CampaignError> {
        if kind == DisturbanceKind::GroundReaction && !walks {
            return Err(self.invalid(
                key,
                "\"ground-reaction\"",
                "a ground reaction needs a walking reference",
                "set reference.kind = \"walk\", or remove it",
            ));
        }
        let flies = matches!(agent, Agent::Uav(_));
        if matches!(kind, DisturbanceKind::Gust1Cosine | DisturbanceKind::Dryden) && !flies {
            return Err(self.invalid(
                key,
                format!("{:?}", kind.name()),
                "wind acts on a UAV, not on joints",
                "use \"sine\" or \"constant\" for a biped",
            ));
        }
        if kind == DisturbanceKind::RotorVortex {
            let refused = |limit, remedy| Err(self.invalid(key, "\"rotor-vortex\"", limit, remedy));
            if !flies {
                return refused(
                    "rotors blow on UAVs, not on joints",
                    "use \"sine\" or \"constant\" for a biped",
                );
            }
            if team == 1 {
                return refused(
                    "a single UAV has no other UAV whose rotors could act on it",
                    "remove it, or raise agent.team",
                );
            }
        }
        Ok(())
    }

    /// The table of a disturbance with the wind speed of its intensity.
    fn with_wind<'f>(
        &self,
        table: &str,
        file: &'f DisturbanceFile,
    ) -> Result<Cow<'f, DisturbanceFile>, CampaignError> {
        let Some(intensity) = file.intensity else {
            return Ok(Cow::Borrowed(file));
        };
        let (name, wind_kn) = match intensity {
            IntensityKind::Light => ("light", 15.0),
            IntensityKind::Moderate => ("moderate", 30.0),
            IntensityKind::Severe => ("severe", 45.0),
        };
        let refused = |remedy: &str| {
            Err(self.invalid(
                format!("{table}.intensity"),
                format!("{name:?}"),
                "it stands for the wind_m_s of turbulence",
                remedy,
            ))
        };
        if file.kind != DisturbanceKind::Dryden {
            return refused("remove it, or set kind = \"dryden\"");
        }
        if file.wind_m_s.is_some() {
            return refused("remove it, or remove wind_m_s");
        }
        Ok(Cow::Owned(DisturbanceFile {
            wind_m_s: Some(Value::Number(wind_kn * KNOT_M_S)),
            ..file.clone()
        }))
    }
}
