//! From the file as written to the campaign that runs: every range, shape and contradiction is checked here, and nowhere
//! later.

mod reference;
mod signals;
mod synthesis;

use super::check::{Bounds, CHANNELS, Check, Parameter};
use super::error::CampaignError;
use super::file::*;
use super::{Campaign, Initial, Requirement, Time, Uav, Verdict};
use std::path::Path;

/// Steps that an episode may have: step numbers stay exact in single precision, half steps in 32 bits.
const MAX_STEPS: f64 = 8_388_608.0;
/// Memory that the reference tables of a campaign may take, bytes.
const MAX_TABLE_BYTES: f64 = 4_294_967_296.0;
/// The paper's UAV, section V.
const PAPER_MASS_KG: f64 = 2.0;
const PAPER_INERTIA_KG_M2: [f64; 3] = [1.25, 1.25, 2.2];
const PAPER_DRAG_N_S_M: f64 = 0.01;
const PAPER_ANGULAR_DRAG_N_M_S: f64 = 0.012;
const PAPER_GRAVITY_M_S2: f64 = 9.81;

/// Checks a file as written.
pub(super) fn validate(
    file: CampaignFile,
    text: &str,
    path: &Path,
) -> Result<Campaign, CampaignError> {
    let check = Check { path, text };
    check.name("name", &file.name)?;
    if file.episodes == 0 {
        return Err(check.invalid(
            "episodes",
            0,
            "at least one episode must run",
            "give a positive number",
        ));
    }
    let time = check.time(&file.time)?;
    let team = file.agent.team.unwrap_or(1) as usize;
    if !(1..=64).contains(&team) {
        return Err(check.invalid(
            "agent.team",
            team,
            "a team has 1 to 64 agents",
            "give the agents of one episode",
        ));
    }
    let table_bytes = f64::from(2 * time.steps + 1) * (team * CHANNELS) as f64 * 32.0;
    if table_bytes > MAX_TABLE_BYTES {
        return Err(check.invalid(
            "time.duration_s",
            file.time.duration_s,
            &format!(
                "the references of {team} agents over {} steps would take {:.0} GiB",
                time.steps,
                table_bytes / 1_073_741_824.0
            ),
            "shorten it, take longer steps or a smaller team",
        ));
    }
    let uav = check.uav(&file.agent)?;
    let scale = |key: &str, value: &Option<Value>| {
        check.of_agents(
            key,
            value.as_ref(),
            Some(1.0),
            Per::Episode,
            Bounds::Positive,
            team,
        )
    };
    let synthesis = check.synthesis(&file.synthesis, &uav)?;
    let controllers = check.controllers(file.controllers.as_deref(), &synthesis)?;
    Ok(Campaign {
        path: path.to_path_buf(),
        text: text.to_string(),
        name: file.name,
        seed: file.seed,
        episodes: file.episodes,
        requirements: check.requirements(&file.require, &controllers)?,
        controllers,
        time,
        uav,
        team,
        reference: check.reference(&file.reference, team, uav.actuation)?,
        synthesis,
        mass_scale: scale("agent.mass_scale", &file.agent.mass_scale)?,
        inertia_scale: scale("agent.inertia_scale", &file.agent.inertia_scale)?,
        kappa: check.of_agents(
            "coupling.kappa",
            file.coupling.as_ref().map(|coupling| &coupling.kappa),
            Some(0.0),
            Per::Episode,
            Bounds::Any,
            team,
        )?,
        initial: check.initial(file.initial.as_ref(), team)?,
        disturbances: file
            .disturbance
            .iter()
            .enumerate()
            .map(|(index, disturbance)| check.disturbance(index, disturbance, team, time))
            .collect::<Result<_, _>>()?,
        faults: file
            .fault
            .iter()
            .enumerate()
            .map(|(index, fault)| check.fault(index, fault, team, time, uav.actuation))
            .collect::<Result<_, _>>()?,
        verdict: check.verdict(&file.verdict.unwrap_or_default())?,
    })
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

    fn uav(&self, file: &AgentFile) -> Result<Uav, CampaignError> {
        let AgentKind::Uav = file.kind;
        let actuation = file.actuation.unwrap_or(ActuationKind::Full);
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
        let number = |key: &str, value: Option<f64>, default: f64, bounds: Bounds| {
            self.number(key, value.unwrap_or(default), bounds)
        };
        let inertia_kg_m2 = file.inertia_kg_m2.unwrap_or(PAPER_INERTIA_KG_M2);
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
        let max_tilt_rad = number(
            "agent.max_tilt_rad",
            file.max_tilt_rad,
            1.0,
            Bounds::Positive,
        )?;
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
            mass_kg: number(
                "agent.mass_kg",
                file.mass_kg,
                PAPER_MASS_KG,
                Bounds::Positive,
            )?,
            inertia_kg_m2,
            drag_n_s_m: number(
                "agent.drag_n_s_m",
                file.drag_n_s_m,
                PAPER_DRAG_N_S_M,
                Bounds::NonNegative,
            )?,
            angular_drag_n_m_s: number(
                "agent.angular_drag_n_m_s",
                file.angular_drag_n_m_s,
                PAPER_ANGULAR_DRAG_N_M_S,
                Bounds::NonNegative,
            )?,
            gravity_m_s2: number(
                "agent.gravity_m_s2",
                file.gravity_m_s2,
                PAPER_GRAVITY_M_S2,
                Bounds::NonNegative,
            )?,
            command_filter_rad_s: number(
                "agent.command_filter_rad_s",
                file.command_filter_rad_s,
                20.0,
                Bounds::Positive,
            )?,
            max_thrust_n: number(
                "agent.max_thrust_n",
                file.max_thrust_n,
                80.0,
                Bounds::Positive,
            )?,
            max_torque_n_m: number(
                "agent.max_torque_n_m",
                file.max_torque_n_m,
                60.0,
                Bounds::Positive,
            )?,
            max_tilt_rad,
        })
    }

    fn initial(&self, file: Option<&InitialFile>, team: usize) -> Result<Initial, CampaignError> {
        let blocks = file.and_then(|file| file.agents.as_deref());
        self.blocks("initial.agents", blocks, team)?;
        let of = |name| {
            let parameter = Parameter {
                name,
                default: Some(0.0),
                bounds: Bounds::Any,
            };
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
            None => Ok(vec![f64::INFINITY; CHANNELS]),
            some => self
                .numbers(key, some.as_ref(), 0.0, Bounds::Positive)
                .map(Vec::from),
        };
        Ok(Verdict {
            max_error: limit("verdict.max_error", &file.max_error)?,
            max_rmse: limit("verdict.max_rmse", &file.max_rmse)?,
            settled_error: self
                .numbers(
                    "verdict.settled_error",
                    file.settled_error.as_ref(),
                    0.05,
                    Bounds::Positive,
                )?
                .to_vec(),
        })
    }

    fn requirements(
        &self,
        files: &[RequireFile],
        controllers: &[String],
    ) -> Result<Vec<Requirement>, CampaignError> {
        files
            .iter()
            .enumerate()
            .map(|(index, file)| {
                if !controllers.contains(&file.controller) {
                    return Err(self.invalid(
                        format!("require[{index}].controller"),
                        format!("{:?}", file.controller),
                        &format!("the campaign's controllers are {}", controllers.join(", ")),
                        "name one of them, or add it to `controllers`",
                    ));
                }
                let key = format!("require[{index}].failure_rate_upper_95");
                let failure_rate_upper_95 =
                    self.number(&key, file.failure_rate_upper_95, Bounds::Share)?;
                Ok(Requirement {
                    controller: file.controller.clone(),
                    failure_rate_upper_95,
                })
            })
            .collect()
    }
}
