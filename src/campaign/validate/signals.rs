//! `[[disturbance]]` and `[[fault]]`.

use super::super::check::{Bounds, Check};
use super::super::error::CampaignError;
use super::super::file::*;
use super::super::{Distribution, Disturbance, Drawn, FIRST_ATTITUDE, Fault, FaultChannels, Time};
use std::f64::consts::TAU;

/// How far a signal may turn in one step, rad; beyond it the method's stages no longer see its shape.
const MAX_STEP_RAD: f64 = 0.5;
/// The channel whose actuator is the thrust where there is no other force.
const THRUST: usize = FIRST_ATTITUDE - 1;

impl Check<'_> {
    /// A disturbance; `walks` says whether the reference is a walk.
    pub(super) fn disturbance(
        &self,
        index: usize,
        file: &DisturbanceFile,
        team: usize,
        time: Time,
        walks: bool,
    ) -> Result<Disturbance, CampaignError> {
        let table = format!("disturbance[{index}]");
        if file.kind == DisturbanceKind::GroundReaction && !walks {
            return Err(self.invalid(
                format!("{table}.kind"),
                "\"ground-reaction\"",
                "the ground answers a walk",
                "set reference.kind = \"walk\", or remove it",
            ));
        }
        let parameters = self.parameters(
            &table,
            file,
            file.agents.as_deref(),
            file.kind.parameters(),
            team,
        )?;
        if file.kind == DisturbanceKind::Sine {
            let key = format!("{table}.frequency_rad_s");
            self.resolved(&key, &parameters[1], |(_, high)| high, time)?;
        }
        Ok(Disturbance {
            kind: file.kind,
            parameters,
        })
    }

    /// A fault.
    pub(super) fn fault(
        &self,
        index: usize,
        file: &FaultFile,
        team: usize,
        time: Time,
        actuation: ActuationKind,
    ) -> Result<Fault, CampaignError> {
        let table = format!("fault[{index}]");
        if !file.kind.strikes(file.target) {
            return Err(self.invalid(
                format!("{table}.kind"),
                format!("{:?}", file.kind.name()),
                "this kind does not strike this target",
                "actuators have loss-of-effectiveness and bias; sensors have smoothed-square, bias and noise",
            ));
        }
        let onset_key = format!("{table}.onset_s");
        let onset_s = self.of_agents(
            &onset_key,
            file.onset_s.as_ref(),
            Some(0.0),
            Per::Agent,
            Bounds::NonNegative,
            team,
        )?;
        let last = onset_s
            .distributions
            .iter()
            .map(|onset| onset.support().1)
            .fold(0.0, f64::max);
        if let Some(onset) = &file.onset_s
            && time.onset_step(last) >= time.steps
        {
            let last_step_s = f64::from(time.steps - 1) * time.step_s;
            return Err(self.invalid(
                onset_key,
                onset,
                &format!("a fault must begin before the end, by the last step at {last_step_s} s"),
                "begin it earlier",
            ));
        }
        let channels = self.fault_channels(&format!("{table}.channels"), file.channels.as_ref())?;
        let strikes_force = match &channels {
            FaultChannels::One => true,
            FaultChannels::These(channels) => channels.iter().any(|channel| *channel < THRUST),
        };
        if actuation == ActuationKind::Thrust
            && file.target == FaultTarget::Actuator
            && strikes_force
        {
            return Err(self.invalid(
                format!("{table}.channels"),
                file.channels.as_ref().map_or("\"all\"".into(), shown),
                "the actuation \"thrust\" has no actuators along x and y",
                "list some of [3, 4, 5, 6]: the thrust and three torques",
            ));
        }
        let parameters = self.parameters(
            &table,
            file,
            file.agents.as_deref(),
            file.kind.parameters(),
            team,
        )?;
        if file.kind == FaultKind::SmoothedSquare {
            let key = format!("{table}.period_s");
            self.resolved(&key, &parameters[1], |(low, _)| TAU / low, time)?;
        }
        Ok(Fault {
            target: file.target,
            kind: file.kind,
            probability: self.number(
                &format!("{table}.probability"),
                file.probability.unwrap_or(1.0),
                Bounds::Share,
            )?,
            channels,
            onset_s,
            parameters,
        })
    }

    /// Refuses frequencies that a step cannot resolve: they would be seen as others.
    fn resolved(
        &self,
        key: &str,
        drawn: &Drawn,
        fastest_rad_s: fn((f64, f64)) -> f64,
        time: Time,
    ) -> Result<(), CampaignError> {
        let limit_rad_s = MAX_STEP_RAD / time.step_s;
        let supports = drawn.distributions.iter().map(Distribution::support);
        let fastest = supports.map(fastest_rad_s).fold(0.0, f64::max);
        if fastest <= limit_rad_s {
            return Ok(());
        }
        Err(self.invalid(
            key,
            format!("up to {fastest:.1} rad/s"),
            &format!(
                "steps of {} s resolve at most {limit_rad_s:.1} rad/s",
                time.step_s
            ),
            "make it slower, or shorten time.step_s",
        ))
    }

    fn fault_channels(
        &self,
        key: &str,
        file: Option<&ChannelsFile>,
    ) -> Result<FaultChannels, CampaignError> {
        let count = self.channels.len();
        match file {
            None => Ok(FaultChannels::These((0..count).collect())),
            Some(ChannelsFile::Word(word)) if word == "all" => {
                Ok(FaultChannels::These((0..count).collect()))
            }
            Some(ChannelsFile::Word(word)) if word == "one" => Ok(FaultChannels::One),
            Some(ChannelsFile::Numbers(numbers))
                if !numbers.is_empty()
                    && numbers
                        .iter()
                        .all(|number| (1..=count).contains(&(*number as usize)))
                    && (1..numbers.len()).all(|k| !numbers[..k].contains(&numbers[k])) =>
            {
                Ok(FaultChannels::These(
                    numbers.iter().map(|number| *number as usize - 1).collect(),
                ))
            }
            Some(other) => {
                let limit = format!(
                    "\"all\", \"one\", or a list of different channel numbers from 1 ({})",
                    self.channels.join(", ")
                );
                Err(self.invalid(key, shown(other), &limit, "correct it"))
            }
        }
    }
}

/// The channels of a fault as a campaign file would say them.
fn shown(channels: &ChannelsFile) -> String {
    match channels {
        ChannelsFile::Word(word) => format!("{word:?}"),
        ChannelsFile::Numbers(numbers) => format!("{numbers:?}"),
    }
}
