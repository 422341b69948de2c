//! From the file as written to the campaign that runs: every range, shape and contradiction is checked here, and nowhere
//! later.

use super::check::{Bounds, CHANNELS, Check, Parameter};
use super::error::CampaignError;
use super::file::*;
use super::{
    Campaign, Disturbance, FTC, Fault, FaultChannels, GainSource, Initial, NamedGains, PID,
    PID_TUNED, Requirement, Time, Uav, Verdict,
};
use crate::reference::path::{DEFAULT_STEP_M, PathLimits};
use crate::reference::{Reference, Sinusoid, WaypointPath};
use crate::synthesis::{ChannelDesign, ChannelRole, Preset, SmoothingRule, SynthesisError};
use std::path::{Path, PathBuf};

/// Steps that an episode may have: step numbers stay exact in single precision, half steps in 32 bits.
const MAX_STEPS: f64 = 8_388_608.0;
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
    let check = Check { path };
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
        reference: check.reference(&file.reference, team)?,
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
            .map(|(index, disturbance)| check.disturbance(index, disturbance, team))
            .collect::<Result<_, _>>()?,
        faults: file
            .fault
            .iter()
            .enumerate()
            .map(|(index, fault)| check.fault(index, fault, team, &file.time))
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
                step_s,
                &format!("must divide time.duration_s = {duration_s} into whole steps"),
                &format!(
                    "use {}, which gives {} steps",
                    duration_s / steps.max(1.0),
                    steps.max(1.0)
                ),
            ));
        }
        if steps > MAX_STEPS {
            return Err(self.invalid(
                "time.duration_s",
                duration_s,
                &format!("an episode has at most {MAX_STEPS} steps of time.step_s = {step_s}"),
                "shorten it or take longer steps",
            ));
        }
        if settle_s >= duration_s {
            return Err(self.invalid(
                "time.settle_s",
                settle_s,
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
                value,
                "only the actuation \"thrust\" has this",
                "remove it or set agent.actuation = \"thrust\"",
            ));
        }
        let number = |key: &str, value: Option<f64>, default: f64, bounds: Bounds| {
            self.number(key, value.unwrap_or(default), bounds)
        };
        let inertia_kg_m2 = file.inertia_kg_m2.unwrap_or(PAPER_INERTIA_KG_M2);
        for inertia in inertia_kg_m2 {
            self.number("agent.inertia_kg_m2", inertia, Bounds::Positive)?;
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
                max_tilt_rad,
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

    fn reference(&self, file: &ReferenceFile, team: usize) -> Result<Reference, CampaignError> {
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
    ) -> Result<[Sinusoid; CHANNELS], CampaignError> {
        let of = |name: &str, pick: fn(&SinusoidFile) -> Option<&Numbers>| {
            let own = block.and_then(pick);
            let key = if own.is_some() {
                format!("reference.agents[{agent}].{name}")
            } else {
                format!("reference.{name}")
            };
            self.numbers(&key, own.or_else(|| pick(base)), 0.0, Bounds::Any)
        };
        let center = of("center", |file| file.center.as_ref())?;
        let amplitude = of("amplitude", |file| file.amplitude.as_ref())?;
        let frequency_rad_s = of("frequency_rad_s", |file| file.frequency_rad_s.as_ref())?;
        let phase_rad = of("phase_rad", |file| file.phase_rad.as_ref())?;
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

    fn synthesis(&self, file: &SynthesisFile, uav: &Uav) -> Result<GainSource, CampaignError> {
        let preset = file.preset.clone().unwrap_or_else(|| {
            if uav.actuation == ActuationKind::Full {
                "uav-paper"
            } else {
                "uav-physical"
            }
            .to_string()
        });
        let designs = Preset::ALL
            .into_iter()
            .find(|known| known.name() == preset)
            .map(Preset::designs);
        let Some(
            [
                (ChannelRole::Position, position),
                (ChannelRole::Attitude, attitude),
            ],
        ) = designs.as_deref()
        else {
            return Err(self.invalid(
                "synthesis.preset",
                format!("{preset:?}"),
                "a UAV's presets are \"uav-paper\" and \"uav-physical\"",
                "take one of them",
            ));
        };
        let beside = |file: &str| self.path.parent().unwrap_or(Path::new("")).join(file);
        let existing = |key: String, file: &str| -> Result<PathBuf, CampaignError> {
            let path = beside(file);
            if path.is_file() {
                Ok(path)
            } else {
                Err(self.invalid(
                    key,
                    format!("{file:?}"),
                    "no such file",
                    "name a gains.json, relative to the campaign",
                ))
            }
        };
        let mut named = Vec::new();
        for (name, entry) in &file.named {
            let key = format!("synthesis.named.{name}");
            self.name(&key, name)?;
            if [FTC, PID, PID_TUNED].contains(&name.as_str()) {
                return Err(self.invalid(
                    key,
                    "a table",
                    "this name is a built-in controller's",
                    "choose another",
                ));
            }
            named.push(NamedGains {
                name: name.clone(),
                gains: existing(format!("{key}.gains"), &entry.gains)?,
                controller: entry.controller.clone().unwrap_or_else(|| FTC.to_string()),
            });
        }
        Ok(GainSource {
            designs: [
                self.design(
                    "synthesis.position",
                    position.clone(),
                    file.position.as_ref(),
                )?,
                self.design(
                    "synthesis.attitude",
                    attitude.clone(),
                    file.attitude.as_ref(),
                )?,
            ],
            preset,
            gains: file
                .gains
                .as_deref()
                .map(|gains| existing("synthesis.gains".into(), gains))
                .transpose()?,
            named,
        })
    }

    fn controllers(
        &self,
        names: Option<&[String]>,
        source: &GainSource,
    ) -> Result<Vec<String>, CampaignError> {
        let Some(names) = names else {
            let named = source.named.iter().map(|named| named.name.clone());
            return Ok([FTC, PID, PID_TUNED]
                .into_iter()
                .map(String::from)
                .chain(named)
                .collect());
        };
        let known = |name: &String| {
            [FTC, PID, PID_TUNED].contains(&name.as_str())
                || source.named.iter().any(|named| named.name == *name)
        };
        if let Some(unknown) = names.iter().find(|name| !known(name)) {
            return Err(self.invalid(
                "controllers",
                format!("{unknown:?}"),
                "controllers are \"ftc\", \"pid\", \"pid-tuned\" and the tables of [synthesis.named]",
                "name one of them",
            ));
        }
        if names.is_empty() || (1..names.len()).any(|k| names[..k].contains(&names[k])) {
            return Err(self.invalid(
                "controllers",
                format!("{names:?}"),
                "one or more, each once",
                "list what to compare",
            ));
        }
        Ok(names.to_vec())
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

    fn disturbance(
        &self,
        index: usize,
        file: &DisturbanceFile,
        team: usize,
    ) -> Result<Disturbance, CampaignError> {
        let table = format!("disturbance[{index}]");
        let parameters = self.parameters(
            &table,
            file,
            file.agents.as_deref(),
            file.kind.parameters(),
            team,
        )?;
        Ok(Disturbance {
            kind: file.kind,
            parameters,
        })
    }

    fn fault(
        &self,
        index: usize,
        file: &FaultFile,
        team: usize,
        time: &TimeFile,
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
        if last >= time.duration_s {
            return Err(self.invalid(
                onset_key,
                &onset_s.distributions[0],
                &format!("a fault must begin before the end at {} s", time.duration_s),
                "begin it earlier",
            ));
        }
        Ok(Fault {
            target: file.target,
            kind: file.kind,
            probability: self.number(
                &format!("{table}.probability"),
                file.probability.unwrap_or(1.0),
                Bounds::Share,
            )?,
            channels: self.fault_channels(&format!("{table}.channels"), file.channels.as_ref())?,
            onset_s,
            parameters: self.parameters(
                &table,
                file,
                file.agents.as_deref(),
                file.kind.parameters(),
                team,
            )?,
        })
    }

    fn fault_channels(
        &self,
        key: &str,
        file: Option<&ChannelsFile>,
    ) -> Result<FaultChannels, CampaignError> {
        match file {
            None => Ok(FaultChannels::These((0..CHANNELS).collect())),
            Some(ChannelsFile::Word(word)) if word == "all" => {
                Ok(FaultChannels::These((0..CHANNELS).collect()))
            }
            Some(ChannelsFile::Word(word)) if word == "one" => Ok(FaultChannels::One),
            Some(ChannelsFile::Numbers(numbers))
                if !numbers.is_empty()
                    && numbers
                        .iter()
                        .all(|number| (1..=CHANNELS).contains(&(*number as usize)))
                    && (1..numbers.len()).all(|k| !numbers[..k].contains(&numbers[k])) =>
            {
                Ok(FaultChannels::These(
                    numbers.iter().map(|number| *number as usize - 1).collect(),
                ))
            }
            Some(other) => {
                let value = match other {
                    ChannelsFile::Word(word) => format!("{word:?}"),
                    ChannelsFile::Numbers(numbers) => format!("{numbers:?}"),
                };
                Err(self.invalid(
                    key,
                    value,
                    "\"all\", \"one\", or a list of different channel numbers from 1 (x, y, z, roll, pitch, yaw)",
                    "correct it",
                ))
            }
        }
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
                        "this controller is not among `controllers`",
                        "add it there or name another",
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

    /// A preset's weights with the file's overrides.
    fn design(
        &self,
        table: &str,
        mut design: ChannelDesign,
        file: Option<&WeightsFile>,
    ) -> Result<ChannelDesign, CampaignError> {
        let file = file.cloned().unwrap_or_default();
        let replace = |weight: &mut f64, given: Option<f64>| *weight = given.unwrap_or(*weight);
        replace(&mut design.r, file.r);
        replace(&mut design.rho, file.rho);
        replace(&mut design.nu, file.nu);
        replace(&mut design.eps2, file.eps2);
        replace(&mut design.pid_nu, file.pid_nu);
        replace(&mut design.smoothing.spacing_s, file.smoothing_spacing_s);
        design.q1 = file.q1.unwrap_or(design.q1);
        design.q2 = file.q2.unwrap_or(design.q2);
        design.sensor_fault_input = file.sensor_fault_input.unwrap_or(design.sensor_fault_input);
        design.smoothing.windows = file.smoothing_windows.unwrap_or(design.smoothing.windows);
        if let SmoothingRule::Leaky { order, leak_per_s } = &mut design.smoothing.rule {
            *order = file.smoothing_order.unwrap_or(*order);
            replace(leak_per_s, file.smoothing_leak_per_s);
        }
        if let Some(weights) = file.smoothing_weights {
            design.smoothing.rule = SmoothingRule::Weights(weights);
        }
        if design.sensor_fault_input[0] != 0.0 {
            return Err(self.invalid(
                format!("{table}.sensor_fault_input"),
                format!("{:?}", design.sensor_fault_input),
                "the integral is computed, not sensed, so no sensor fault enters it",
                "begin the list with 0",
            ));
        }
        match design.validate() {
            Ok(()) => Ok(design),
            Err(SynthesisError::InvalidDesign { key, value, limit }) => Err(self.invalid(
                format!("{table}.{}", key.replace("smoothing.", "smoothing_")),
                value,
                &format!("must be {limit}"),
                "give a value within the limit",
            )),
            Err(SynthesisError::WrongLength {
                key,
                given,
                needed,
                why,
            }) => Err(self.invalid(
                format!("{table}.{key}"),
                format!("a list of {given}"),
                &format!("needs {needed} values: {why}"),
                "complete it",
            )),
            Err(other) => {
                Err(self.invalid(table, "these weights", &other.to_string(), "change them"))
            }
        }
    }
}
