//! A group of agents: its tables, whether they stand in a `[[group]]` or at the top of the file.

use crate::agent::{ActuationKind, Agent};
use crate::campaign::check::Check;
use crate::campaign::common::Common;
use crate::campaign::disturbances_and_faults::{Disturbance, Fault};
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::group::{Control, GainSource, GroupParts, Initial, Verdict};
use crate::campaign::parameter::{Bounds, SamplingScope, required};
use crate::campaign::quantity::RandomQuantity;
use crate::campaign::time::Time;
use std::sync::Arc;

/// Smallest ratio of errors that counts, if the file has none.
const SMALLEST_RATIO: f64 = 1.05;
/// Errors below this, m or rad, are rounding, if the file has none: steps of single precision at a distance of 10 m.
const SMALLEST_ERROR: f64 = 1e-6;

/// Agents that all groups of a campaign may have together.
pub(super) const MAX_AGENTS: usize = 64;

/// The text of the robot's file of a group, by the group's name, where it is at hand and is not to be read.
pub(in crate::campaign) type RobotTexts<'a> = &'a dyn Fn(&str) -> Option<String>;

/// A group of which is known what its agents, its gains and its faults are: what the tables of the campaign refer to.
pub(super) struct Begun<'a> {
    check: Check<'a>,
    file: GroupFile,
    agent: Agent,
    fault_names: Vec<Arc<str>>,
    pub(super) team: usize,
    pub(super) synthesis: GainSource,
}

impl<'a> Check<'a> {
    /// Begins with a group of agents.
    pub(super) fn begin_group(
        mut self,
        file: GroupFile,
        robots: RobotTexts<'_>,
    ) -> Result<Begun<'a>, CampaignError> {
        let team = self.team(&file.agent)?;
        let agent = self.agent(&file.agent, robots(&file.name))?;
        self.channels = agent.channels();
        Ok(Begun {
            synthesis: self.synthesis(&file.synthesis, &agent)?,
            fault_names: self.fault_names(&file.fault)?,
            check: self,
            file,
            agent,
            team,
        })
    }
}

impl Begun<'_> {
    /// The names of its faults, each with whether it is part of the background.
    pub(super) fn faults(&self) -> impl Iterator<Item = (Arc<str>, bool)> {
        let faults = self.fault_names.iter().cloned().zip(&self.file.fault);
        faults.map(|(name, file)| (name, file.background == Some(true)))
    }

    /// The number of its disturbances or faults, whichever is larger.
    pub(super) fn entries(&self) -> usize {
        self.file.disturbance.len().max(self.file.fault.len())
    }

    /// Bytes of its references at one instant.
    pub(super) fn row_bytes(&self) -> f64 {
        let of_channel = match &self.agent {
            Agent::Uav(_) => 32,
            // Beside the reference a row of M(r) and, where limits cut, of its inverse.
            Agent::Biped(biped) if biped.actuation == ActuationKind::Full => 96,
            Agent::Biped(_) => 160,
        };
        (self.team * self.check.channels.len() * of_channel) as f64
    }

    /// Checks what is left.
    pub(super) fn finish(self, common: &Arc<Common>) -> Result<GroupParts, CampaignError> {
        let Self {
            check,
            file,
            agent,
            fault_names,
            team,
            synthesis,
        } = self;
        let time = common.time;
        let scale = |key: &str, value: &Option<Value>| {
            check.of_agents(
                key,
                value.as_ref(),
                Some(1.0),
                SamplingScope::Episode,
                Bounds::Positive,
                team,
            )
        };
        Ok(GroupParts {
            common: common.clone(),
            first_agent: 0,
            first_disturbance: 0,
            first_fault: 0,
            team,
            reference: check.reference(&file.reference, team, &agent)?,
            sensors: check.sensors(file.sensors.as_ref(), &agent, &synthesis)?,
            synthesis,
            mass_scale: scale("agent.mass_scale", &file.agent.mass_scale)?,
            inertia_scale: scale("agent.inertia_scale", &file.agent.inertia_scale)?,
            kappa: check.kappa(file.coupling.as_ref(), team)?,
            coordinates: file
                .coupling
                .as_ref()
                .and_then(|coupling| coupling.coordinates)
                .unwrap_or(CouplingCoordinates::Absolute),
            control: check.control(
                file.control.as_ref().unwrap_or(&ControlFile::default()),
                team,
                time,
            )?,
            initial: check.initial(file.initial.as_ref(), team)?,
            disturbances: check.disturbances(&file, team, time, &agent)?,
            faults: check.faults(&file.fault, fault_names, team, time, &agent)?,
            verdict: check.verdict(file.verdict.as_ref().unwrap_or(&VerdictFile::default()))?,
            name: file.name.into(),
            channels: check.channels,
            agent,
        })
    }
}

impl Check<'_> {
    /// The number of agents.
    fn team(&self, file: &AgentFile) -> Result<usize, CampaignError> {
        let team = file.team.unwrap_or(1) as usize;
        if !(1..=MAX_AGENTS).contains(&team) {
            return Err(self.invalid(
                "agent.team",
                team,
                &format!("a team has 1 to {MAX_AGENTS} agents"),
                "give the agents of one episode",
            ));
        }
        Ok(team)
    }

    /// The strength of the coupling.
    fn kappa(
        &self,
        file: Option<&CouplingFile>,
        team: usize,
    ) -> Result<RandomQuantity, CampaignError> {
        self.of_agents(
            "coupling.kappa",
            file.map(|coupling| &coupling.kappa),
            Some(0.0),
            SamplingScope::Episode,
            Bounds::Any,
            team,
        )
    }

    fn disturbances(
        &self,
        file: &GroupFile,
        team: usize,
        time: Time,
        agent: &Agent,
    ) -> Result<Vec<Disturbance>, CampaignError> {
        let walks = file.reference.kind == ReferenceKind::Walk;
        let disturbances = file.disturbance.iter().enumerate();
        disturbances
            .map(|(index, own)| self.disturbance(index, own, team, time, agent, walks))
            .collect()
    }

    fn faults(
        &self,
        files: &[FaultFile],
        names: Vec<Arc<str>>,
        team: usize,
        time: Time,
        agent: &Agent,
    ) -> Result<Vec<Fault>, CampaignError> {
        let faults = files.iter().zip(names).enumerate();
        faults
            .map(|(index, (fault, name))| self.fault(index, fault, name, team, time, agent))
            .collect()
    }

    fn control(
        &self,
        file: &ControlFile,
        team: usize,
        time: Time,
    ) -> Result<Control, CampaignError> {
        let delay_s = match &file.delay_s {
            None => None,
            value => Some(self.of_agents(
                "control.delay_s",
                value.as_ref(),
                None,
                SamplingScope::Episode,
                Bounds::Positive,
                team,
            )?),
        };
        if let Some(delay_s) = &delay_s {
            self.remembered("control.delay_s", delay_s, time)?;
        }
        let hold_steps = match file.rate_hz {
            None => 1.0,
            Some(rate_hz) => {
                let rate_hz = self.number("control.rate_hz", rate_hz, Bounds::Positive)?;
                let exact = 1.0 / (rate_hz * time.step_s);
                let steps = exact.round();
                if steps < 1.0
                    || steps > f64::from(time.steps)
                    || (exact - steps).abs() > 1e-6 * exact
                {
                    return Err(self.invalid(
                        "control.rate_hz",
                        in_toml(rate_hz),
                        &format!(
                            "a command is held for whole steps of time.step_s = {}",
                            in_toml(time.step_s)
                        ),
                        &format!(
                            "use {} for {} steps, or another step",
                            in_toml(1.0 / (steps.max(1.0) * time.step_s)),
                            steps.max(1.0)
                        ),
                    ));
                }
                steps
            }
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked to lie within the steps"
        )]
        let hold_steps = hold_steps as u32;
        Ok(Control {
            integral: file.integral.unwrap_or(IntegralKind::Exact),
            delay_s,
            hold_steps,
        })
    }

    fn initial(&self, file: Option<&InitialFile>, team: usize) -> Result<Initial, CampaignError> {
        let blocks = file.and_then(|file| file.agents.as_deref());
        self.blocks("initial.agents", blocks, team)?;
        let of = |name| {
            let parameter = required(name, Bounds::Any).or(0.0);
            self.per_channel("initial", file, blocks, parameter, team)
        };
        Ok(Initial {
            error: of("error")?,
            error_rate: of("error_rate")?,
            error_integral: of("error_integral")?,
            observer: file
                .and_then(|file| file.observer)
                .unwrap_or(ObserverStart::Measured),
        })
    }

    fn verdict(&self, file: &VerdictFile) -> Result<Verdict, CampaignError> {
        let limit = |key: &str, numbers: &Option<Numbers>| match numbers {
            None => Ok(vec![f64::INFINITY; self.channels.len()]),
            some => self.numbers(key, some.as_ref(), 0.0, Bounds::Positive),
        };
        Ok(Verdict {
            max_error: limit("verdict.max_error", &file.max_error)?,
            max_rmse: limit("verdict.max_rmse", &file.max_rmse)?,
            settled_error: self.numbers(
                "verdict.settled_error",
                file.settled_error.as_ref(),
                0.05,
                Bounds::Positive,
            )?,
            smallest_ratio: self.number(
                "verdict.smallest_ratio",
                file.smallest_ratio.unwrap_or(SMALLEST_RATIO),
                Bounds::Between(1.0, 10.0),
            )?,
            smallest_error: self.number(
                "verdict.smallest_error",
                file.smallest_error.unwrap_or(SMALLEST_ERROR),
                Bounds::Positive,
            )?,
        })
    }
}
