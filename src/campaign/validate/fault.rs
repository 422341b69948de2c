//! `[[fault]]`: what fails, and when.

use super::timing::ONSET_KEY;
use crate::agent::Agent;
use crate::campaign::check::{Check, Written};
use crate::campaign::disturbances_and_faults::Fault;
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::kinds::{FaultKind, FaultTarget};
use crate::campaign::parameter::{Bounds, Parameter, of_agent};
use crate::campaign::quantity::RandomQuantity;
use crate::campaign::time::Time;
use std::sync::Arc;

/// When a fault begins.
const ONSET: Parameter = of_agent(ONSET_KEY, Bounds::NonNegative).or(0.0);
/// How long it stays: to the end, if nothing is said.
const DURATION: Parameter = of_agent("duration_s", Bounds::Positive);
/// The time in which it comes.
const RAMP: Parameter = of_agent("ramp_s", Bounds::NonNegative).or(0.0);

/// When a fault is there, as in [`Fault`].
struct Presence {
    onset_s: RandomQuantity,
    duration_s: Option<RandomQuantity>,
    ramp_s: Option<RandomQuantity>,
}

impl Check<'_> {
    /// A fault.
    pub(super) fn fault(
        &self,
        index: usize,
        file: &FaultFile,
        name: Arc<str>,
        team: usize,
        time: Time,
        agent: &Agent,
    ) -> Result<Fault, CampaignError> {
        let table = format!("fault[{index}]");
        let key = |name: &str| format!("{table}.{name}");
        let (kind, target) = (file.kind, file.target);
        self.can_strike(&key("kind"), kind, target)?;
        let link = self.link(&key("link"), file)?;
        let blocks = file.agents.as_deref();
        let parameters = self.parameters(&table, file, blocks, kind.parameters(), team)?;
        let presence = self.presence(&table, file, team, time)?;
        let drawn = (kind.parameters(), &*parameters);
        self.shown(&table, (file, blocks), drawn, time)?;
        let (mut probability, mut channels) = (Vec::new(), Vec::new());
        for agent_index in 0..team {
            let own = blocks.map(|blocks| &blocks[agent_index]);
            let of_block = |name: &str| format!("{table}.agents[{agent_index}].{name}");
            let (probability_key, value) = match own.and_then(|own| own.probability) {
                Some(own) => (of_block("probability"), own),
                None => (key("probability"), file.probability.unwrap_or(1.0)),
            };
            probability.push(self.number(&probability_key, value, Bounds::Share)?);
            let (channels_key, value) = match own.and_then(|own| own.channels.as_ref()) {
                Some(own) => (of_block("channels"), Some(own)),
                None => (key("channels"), file.channels.as_ref()),
            };
            channels.push(self.struck_channels(&channels_key, value, &table, file, link, agent)?);
        }
        Ok(Fault {
            name,
            target,
            link,
            kind,
            probability,
            background: file.background.unwrap_or(false),
            channels,
            onset_s: presence.onset_s,
            duration_s: presence.duration_s,
            ramp_s: presence.ramp_s,
            parameters,
        })
    }

    /// Refuses a kind that does not strike its target.
    fn can_strike(
        &self,
        key: &str,
        kind: FaultKind,
        target: FaultTarget,
    ) -> Result<(), CampaignError> {
        if !kind.strikes(target) {
            let those = FaultKind::ALL
                .iter()
                .copied()
                .filter(|kind| kind.strikes(target));
            let names: Vec<&str> = those.map(FaultKind::name).collect();
            return Err(self.invalid(
                key,
                format!("{:?}", kind.name()),
                "this kind does not strike this target",
                &format!("the target {:?} has {}", target.name(), names.join(", ")),
            ));
        }
        Ok(())
    }

    /// When a fault is there.
    fn presence(
        &self,
        table: &str,
        file: &FaultFile,
        team: usize,
        time: Time,
    ) -> Result<Presence, CampaignError> {
        let blocks = file.agents.as_deref();
        let onset = Written {
            base: file.onset_s.as_ref(),
            own: &|agent| blocks?[agent].onset_s.as_ref(),
        };
        let onset_s = self.of_team(table, onset, ONSET, team, 1)?;
        self.begins(table, onset, &onset_s, time)?;
        let duration = Written {
            base: file.duration_s.as_ref(),
            own: &|agent| blocks?[agent].duration_s.as_ref(),
        };
        let duration_s = self.perhaps(table, duration, DURATION, team)?;
        let ramp = Written {
            base: file.ramp_s.as_ref(),
            own: &|agent| blocks?[agent].ramp_s.as_ref(),
        };
        let ramp_s = self.perhaps(table, ramp, RAMP, team)?;
        let mut ramps = (0..team).map(|agent| ramp.of(table, RAMP.name, agent));
        if let Some((key, ramp_s)) = ramps.find_map(|(key, value)| Some((key, value?)))
            && !file.kind.can_ramp()
        {
            return Err(self.invalid(
                key,
                ramp_s,
                &format!("{:?} cannot build up gradually", file.kind.name()),
                "remove it",
            ));
        }
        Ok(Presence {
            onset_s,
            duration_s,
            ramp_s,
        })
    }

    /// A quantity of each agent that a fault may have or not.
    fn perhaps(
        &self,
        table: &str,
        written: Written<'_>,
        parameter: Parameter,
        team: usize,
    ) -> Result<Option<RandomQuantity>, CampaignError> {
        let given = |agent: &usize| written.of(table, parameter.name, *agent).1.is_some();
        match (0..team).filter(given).count() {
            0 => Ok(None),
            some if some < team && parameter.default.is_none() => Err(self.invalid(
                format!("{table}.{}", parameter.name),
                "absent",
                "some agents have one and others do not",
                "give it here for those that have none of their own",
            )),
            _ => self.of_team(table, written, parameter, team, 1).map(Some),
        }
    }
}
