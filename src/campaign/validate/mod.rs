//! From the file as written to the campaign that runs: every range, shape and contradiction is checked here, and
//! nowhere later.

mod agent;
mod disturbance;
mod fault;
mod fault_channels;
mod plan;
mod reference;
mod sampling;
mod synthesis;
mod timing;

use super::check::Check;
use super::disturbances_and_faults::{Disturbance, Fault};
use super::error::CampaignError;
use super::file::*;
use super::parameter::SamplingScope;
use super::parameter::{Bounds, required};
use super::quantity::RandomQuantity;
use super::source::Source;
use super::time::Time;
use super::validated::{Campaign, Control, Initial, Validated, Verdict};
use crate::agent::{ActuationKind, Agent};
use std::sync::Arc;

/// Steps that an episode may have: step numbers stay exact in single precision, half steps in 32 bits.
const MAX_STEPS: f64 = 8_388_608.0;
/// Memory that the reference tables of a campaign may take, bytes.
const MAX_TABLE_BYTES: f64 = 4_294_967_296.0;

/// Checks a file as written; `robot` is the text of the robot's file, if it is not to be read.
pub(super) fn validate(
    file: CampaignFile,
    source: Source<'_>,
    robot: Option<&str>,
) -> Result<Campaign, CampaignError> {
    let mut check = Check {
        source,
        channels: Vec::new(),
    };
    check.name("name", &file.name)?;
    check.episodes(file.episodes)?;
    let time = check.time(&file.time)?;
    let team = check.team(&file.agent)?;
    let agent = check.agent(&file.agent, robot)?;
    check.channels = agent.channels();
    check.table_fits(&file.time, time, team, &agent)?;
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
    let synthesis = check.synthesis(&file.synthesis, &agent)?;
    let fault_names = check.fault_names(&file.fault)?;
    let controllers = check.controllers(file.controllers.as_deref(), &synthesis)?;
    let strata = check.strata(&file.strata, &file.fault, &fault_names, file.episodes)?;
    let sampling = check.sampling(&file)?;
    Ok(Campaign::new(Validated {
        path: source.path.to_path_buf(),
        text: source.text.to_string(),
        overlay: source.overlay.to_vec(),
        name: file.name.clone(),
        seed: file.seed,
        episodes: file.episodes,
        requirements: check.requirements(&file.require, &controllers, &strata, sampling)?,
        stop: check.stop(&file, &controllers, sampling)?,
        controllers,
        time,
        team,
        reference: check.reference(&file.reference, team, &agent)?,
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
        strata,
        sampling,
        faults: check.faults(&file.fault, fault_names, team, time, &agent)?,
        verdict: check.verdict(file.verdict.as_ref().unwrap_or(&VerdictFile::default()))?,
        channels: check.channels,
        agent,
    }))
}

impl Check<'_> {
    /// A name that can be a folder's and a column's.
    fn name(&self, key: &str, name: &str) -> Result<(), CampaignError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if name.is_empty() || !name.chars().all(plain) {
            return Err(self.invalid(
                key,
                format!("{name:?}"),
                "a name consists of letters, digits, '-' and '_'",
                "rename it",
            ));
        }
        Ok(())
    }

    fn episodes(&self, episodes: u32) -> Result<(), CampaignError> {
        if episodes == 0 {
            return Err(self.invalid(
                "episodes",
                0,
                "at least one episode must run",
                "give a positive number",
            ));
        }
        Ok(())
    }

    /// The number of agents.
    fn team(&self, file: &AgentFile) -> Result<usize, CampaignError> {
        let team = file.team.unwrap_or(1) as usize;
        if !(1..=64).contains(&team) {
            return Err(self.invalid(
                "agent.team",
                team,
                "a team has 1 to 64 agents",
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
        file: &CampaignFile,
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

    fn time(&self, file: &TimeFile) -> Result<Time, CampaignError> {
        let duration_s = self.number("time.duration_s", file.duration_s, Bounds::Positive)?;
        let step_s = self.number("time.step_s", file.step_s, Bounds::Positive)?;
        let settle_s = self.number(
            "time.settle_s",
            file.settle_s.unwrap_or(0.0),
            Bounds::NonNegative,
        )?;
        let steps = (duration_s / step_s).round();
        if steps < 1.0 || (steps * step_s - duration_s).abs() > 1e-6 * step_s {
            return Err(self.invalid(
                "time.step_s",
                in_toml(step_s),
                &format!("must divide time.duration_s = {duration_s} into whole steps"),
                &format!(
                    "use {} for {} in all",
                    in_toml(duration_s / steps.max(1.0)),
                    steps.max(1.0)
                ),
            ));
        }
        if steps > MAX_STEPS {
            return Err(self.invalid(
                "time.duration_s",
                in_toml(duration_s),
                &format!(
                    "an episode has at most {MAX_STEPS} steps of time.step_s = {}",
                    in_toml(step_s)
                ),
                "shorten it or take longer steps",
            ));
        }
        if settle_s >= duration_s {
            return Err(self.invalid(
                "time.settle_s",
                in_toml(settle_s),
                &format!("metrics must start before the end at {duration_s} s"),
                "start them earlier",
            ));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "bounded by MAX_STEPS"
        )]
        let mut time = Time {
            step_s,
            steps: steps as u32,
            settle_step: 0,
        };
        time.settle_step = time.onset_step(settle_s).min(time.steps - 1);
        Ok(time)
    }

    /// Refuses references that no memory would hold.
    fn table_fits(
        &self,
        file: &TimeFile,
        time: Time,
        team: usize,
        agent: &Agent,
    ) -> Result<(), CampaignError> {
        let row_bytes = match agent {
            Agent::Uav(_) => 32,
            // Beside the reference a row of M(r) and, where limits cut, of its inverse.
            Agent::Biped(biped) if biped.actuation == ActuationKind::Full => 96,
            Agent::Biped(_) => 160,
        };
        let bytes = f64::from(2 * time.steps + 1) * (team * self.channels.len() * row_bytes) as f64;
        if bytes <= MAX_TABLE_BYTES {
            return Ok(());
        }
        Err(self.invalid(
            "time.duration_s",
            file.duration_s,
            &format!(
                "the references of {team} agents over {} steps would take {:.0} GiB",
                time.steps,
                bytes / 1_073_741_824.0
            ),
            "shorten it, take longer steps or a smaller team",
        ))
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
        })
    }
}
