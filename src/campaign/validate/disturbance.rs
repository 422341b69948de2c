//! `[[disturbance]]`.

use crate::agent::Agent;
use crate::campaign::check::Check;
use crate::campaign::disturbances_and_faults::Disturbance;
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::kinds::{DisturbanceKind, Needs};
use crate::campaign::time::Time;
use std::borrow::Cow;

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
        let blocks = file.agents.as_deref();
        let parameters = self.parameters(&table, file, blocks, kind.parameters(), team)?;
        let drawn = (kind.parameters(), &*parameters);
        self.shown(&table, (file, blocks), drawn, time)?;
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
        let refused = |limit, remedy| {
            let value = format!("{:?}", kind.name());
            Err(self.invalid(key, value, limit, remedy))
        };
        let flies = matches!(agent, Agent::Uav(_));
        match kind.needs() {
            Needs::Walk if !walks => refused(
                "a ground reaction needs a walking reference",
                "set reference.kind = \"walk\", or remove it",
            ),
            Needs::Uav if !flies => refused(
                "wind acts on a UAV, not on joints",
                "use \"sine\" or \"constant\" for a biped",
            ),
            Needs::OtherUavs if !flies => refused(
                "rotors blow on UAVs, not on joints",
                "use \"sine\" or \"constant\" for a biped",
            ),
            Needs::OtherUavs if team == 1 => refused(
                "a single UAV has no other UAV whose rotors could act on it",
                "remove it, or raise agent.team",
            ),
            Needs::Nothing | Needs::Walk | Needs::Uav | Needs::OtherUavs => Ok(()),
        }
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
