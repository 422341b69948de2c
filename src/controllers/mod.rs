//! The gains that fly: synthesized, or from a file and verified the same way; and gains.json.

mod file;

pub use file::{ControllerFile, GainsFile};

use crate::agent::ActuationKind;
use crate::agent::{Agent, ChannelGroup};
use crate::campaign::{Campaign, CampaignError, FTC, PID, PID_TUNED, RandomQuantity};
use crate::synthesis::{
    Certificate, ChannelDesign, ChannelSynthesis, Check, ControllerGains, LoopAnalysis, LoopGains,
    SolverReport, SynthesisError, loop_gains, poles, synthesize,
};
use nalgebra::Complex;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why there are no gains to fly.
#[derive(Debug, Error)]
pub enum GainsError {
    /// The synthesis failed.
    #[error("{}: synthesis of the {role} channels: {source}", path.display())]
    Synthesis {
        /// The campaign file.
        path: PathBuf,
        /// The channels.
        role: &'static str,
        /// Why.
        source: Box<SynthesisError>,
    },
    /// Gains from a file do not pass the verification.
    #[error("{}: controllers.{controller}.{role}: {source}", path.display())]
    Refused {
        /// The gains file.
        path: PathBuf,
        /// The controller in the file.
        controller: String,
        /// The channels.
        role: &'static str,
        /// Why.
        source: Box<SynthesisError>,
    },
    /// A gains file cannot be read or lacks what is needed.
    #[error("{}: {reason}", path.display())]
    File {
        /// The gains file.
        path: PathBuf,
        /// What is wrong and what to do.
        reason: String,
    },
    /// The gains and the campaign do not go together.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
}

impl GainsError {
    /// Whether the user's files are at fault rather than the synthesis.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::File { .. } | Self::Campaign(_))
    }
}

/// The controllers of a campaign, in its order.
#[derive(Debug, Clone)]
pub struct GainSet {
    /// The controllers.
    pub controllers: Vec<SimulatedController>,
}

/// A controller ready to fly.
#[derive(Debug, Clone)]
pub struct SimulatedController {
    /// Its name in the campaign.
    pub name: String,
    /// Whose gains they are: "synthesized", or a file and the name there.
    pub source: String,
    /// Gains on each channel group of the campaign, in their order.
    pub groups: Vec<ChannelController>,
}

impl SimulatedController {
    /// Whether its gains have a certificate: whether it estimates the faults.
    #[must_use]
    pub fn is_certified(&self) -> bool {
        let mut groups = self.groups.iter();
        groups.any(|group| group.certificate().is_some())
    }
}

/// A controller on one channel group.
#[derive(Debug, Clone)]
pub struct ChannelController {
    /// The gains as designed.
    pub gains: ControllerGains,
    /// The gains as integrated.
    pub loop_gains: LoopGains,
    /// What was found about them; for gains read back from a run what the run wrote, where it did.
    pub findings: Option<Findings>,
}

impl ChannelController {
    /// The certificate of its gains, where it has one that is at hand.
    #[must_use]
    pub fn certificate(&self) -> Option<&Certificate> {
        let findings = self.findings.as_ref()?;
        findings.certificate.as_ref()
    }
}

/// What synthesis and verification found about the gains of one controller on one channel group.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Findings {
    /// Poles and margins.
    pub analysis: LoopAnalysis,
    /// The certified attenuation level, where the controller estimates the faults.
    pub certificate: Option<Certificate>,
    /// Every check.
    pub checks: Vec<Check>,
    /// How the solver ended, where the gains are its own.
    pub solver: Vec<SolverReport>,
}

impl GainSet {
    /// Synthesizes, reads and verifies the gains of a campaign's controllers, and checks its step against them.
    ///
    /// # Errors
    /// If a synthesis fails, a file is unreadable or refused, or the step is too long for the gains.
    pub fn synthesize_or_load(campaign: &Campaign) -> Result<Self, GainsError> {
        let source = &campaign.synthesis;
        let built_in = |name: &String| [FTC, PID, PID_TUNED].contains(&name.as_str());
        let synthesized = if source.gains.is_none() && campaign.controllers.iter().any(built_in) {
            Some(synthesize_groups(campaign)?)
        } else {
            None
        };
        let mut controllers = Vec::new();
        for name in &campaign.controllers {
            let named = source.named.iter().find(|named| named.name == *name);
            let file = named
                .map(|named| (&named.gains, &named.controller))
                .or(source.gains.as_ref().map(|path| (path, name)));
            controllers.push(match (file, &synthesized) {
                (Some((path, controller)), _) => {
                    file::controller(campaign, name, path, controller, true)?
                }
                (None, Some(synthesized)) => from_synthesis(campaign, name, synthesized)?,
                (None, None) => {
                    let reason = format!("no gains for the controller {name:?}");
                    return Err(GainsError::File {
                        path: campaign.path.clone(),
                        reason,
                    });
                }
            });
        }
        let set = Self { controllers };
        set.check_step(campaign)?;
        Ok(set)
    }

    /// Reads the gains of a run back; they were verified when it was flown.
    ///
    /// # Errors
    /// If the file is unreadable or lacks a controller.
    pub fn read(campaign: &Campaign, path: &Path) -> Result<Self, GainsError> {
        let read = |name: &String| file::controller(campaign, name, path, name, false);
        Ok(Self {
            controllers: campaign
                .controllers
                .iter()
                .map(read)
                .collect::<Result<_, _>>()?,
        })
    }

    /// The gains as the episode loop takes them, `[controller][channel group]`.
    #[must_use]
    pub fn loops(&self) -> Vec<Vec<LoopGains>> {
        let of_groups = |controller: &SimulatedController| {
            let groups = controller.groups.iter();
            groups.map(|group| group.loop_gains).collect()
        };
        self.controllers.iter().map(of_groups).collect()
    }

    /// The gains as a file.
    #[must_use]
    pub fn to_file(&self, campaign: &Campaign) -> GainsFile {
        file::of(self, campaign)
    }

    /// Refuses a step at which the Runge-Kutta method would not be stable on the closed loop.
    fn check_step(&self, campaign: &Campaign) -> Result<(), CampaignError> {
        let step_s = campaign.time.step_s;
        let of_controllers = self.controllers.iter().flat_map(|controller| {
            let poles = controller
                .groups
                .iter()
                .flat_map(|channel| poles(&channel.loop_gains));
            poles.map(move |pole| (pole, format!("{:?}", controller.name)))
        });
        let of_plant = plant_poles(campaign)
            .into_iter()
            .map(|(pole, of)| (Complex::new(pole, 0.0), of.to_string()));
        let worst = of_controllers
            .chain(of_plant)
            .map(|(pole, of)| (longest_stable_step(pole), of, pole))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match worst {
            Some((limit_s, of, pole)) if step_s > limit_s => Err(CampaignError::Invalid {
                path: campaign.path.clone(),
                key: "time.step_s".into(),
                value: step_s.to_string(),
                limit: format!(
                    "above {limit_s:.2e} s the integration is unstable at the pole {:.1} {:+.1}i 1/s of {of}",
                    pole.re, pole.im
                ),
                remedy: format!("use {:.1e} or less", limit_s / 2.0),
            }),
            _ => Ok(()),
        }
    }
}

/// The poles of what is not a controller: a UAV's damping at its lightest, and its command filter.
fn plant_poles(campaign: &Campaign) -> Vec<(f64, &'static str)> {
    let Agent::Uav(uav) = &campaign.agent else {
        return Vec::new();
    };
    let least = |scale: &RandomQuantity| {
        let lows = scale
            .distributions
            .iter()
            .map(|distribution| distribution.support().0);
        lows.fold(f64::INFINITY, f64::min)
    };
    let smallest_inertia = uav.inertia_kg_m2.into_iter().fold(f64::INFINITY, f64::min);
    let filter = match uav.actuation {
        ActuationKind::Thrust => -uav.command_filter_rad_s,
        _ => 0.0,
    };
    vec![
        (
            -uav.drag_n_s_m / (uav.mass_kg * least(&campaign.mass_scale)),
            "the drag",
        ),
        (
            -uav.angular_drag_n_m_s / (smallest_inertia * least(&campaign.inertia_scale)),
            "the angular drag",
        ),
        (filter, "the command filter"),
    ]
}

/// The longest step at which the classical Runge-Kutta method damps a mode that decays.
fn longest_stable_step(pole: Complex<f64>) -> f64 {
    let grows = |step_s: f64| {
        let z = pole * step_s;
        let one = Complex::new(1.0, 0.0);
        (one + z * (one + z / 2.0 * (one + z / 3.0 * (one + z / 4.0)))).norm() > 1.0
    };
    // No decaying mode is stable beyond |z| = 4.
    let (mut stable, mut unstable) = (0.0, 4.0 / pole.norm().max(f64::MIN_POSITIVE));
    if !unstable.is_finite() || !grows(unstable) {
        return unstable;
    }
    for _ in 0..60 {
        let middle = f64::midpoint(stable, unstable);
        if grows(middle) {
            unstable = middle;
        } else {
            stable = middle;
        }
    }
    stable
}

/// The gains of each channel group; equal designs are synthesized once.
fn synthesize_groups(campaign: &Campaign) -> Result<Vec<ChannelSynthesis>, GainsError> {
    let mut done: Vec<ChannelSynthesis> = Vec::new();
    for (group, design) in campaign
        .channel_groups()
        .iter()
        .zip(&campaign.synthesis.designs)
    {
        let known = done.iter().find(|known| known.design == *design).cloned();
        done.push(match known {
            Some(known) => known,
            None => synthesize(design).map_err(|source| GainsError::Synthesis {
                path: campaign.path.clone(),
                role: group.role.name(),
                source: Box::new(source),
            })?,
        });
    }
    Ok(done)
}

/// The gains of a built-in controller in a synthesis, and what was found about them.
#[must_use]
pub fn built_in<'a>(
    synthesis: &'a ChannelSynthesis,
    name: &str,
) -> (&'a ControllerGains, Findings) {
    let analysis = &synthesis.analysis;
    let bare = |analysis: &LoopAnalysis| Findings {
        analysis: analysis.clone(),
        certificate: None,
        checks: Vec::new(),
        solver: Vec::new(),
    };
    match name {
        PID => (&synthesis.pid, bare(&analysis.pid)),
        PID_TUNED => (&synthesis.pid_tuned, bare(&analysis.pid_tuned)),
        _ => {
            let findings = Findings {
                analysis: analysis.ftc.clone(),
                certificate: Some(synthesis.certificate.clone()),
                checks: synthesis.checks.clone(),
                solver: synthesis.solver.clone(),
            };
            (&synthesis.ftc, findings)
        }
    }
}

fn from_synthesis(
    campaign: &Campaign,
    name: &str,
    synthesized: &[ChannelSynthesis],
) -> Result<SimulatedController, GainsError> {
    let of_group = |(group, synthesis): (ChannelGroup, &ChannelSynthesis)| {
        let (gains, findings) = built_in(synthesis, name);
        let loop_gains =
            integrable(&synthesis.design, gains).map_err(|source| GainsError::Synthesis {
                path: campaign.path.clone(),
                role: group.role.name(),
                source: Box::new(source),
            })?;
        Ok::<_, GainsError>(ChannelController {
            gains: gains.clone(),
            loop_gains,
            findings: Some(findings),
        })
    };
    let groups = campaign.channel_groups().into_iter().zip(synthesized);
    Ok(SimulatedController {
        name: name.to_string(),
        source: "synthesized".into(),
        groups: groups.map(of_group).collect::<Result<_, _>>()?,
    })
}

/// The gains as integrated; what the loop leaves out must be zero.
fn integrable(
    design: &ChannelDesign,
    gains: &ControllerGains,
) -> Result<LoopGains, SynthesisError> {
    let reduced = loop_gains(design, gains)?;
    match reduced.k[5..].iter().find(|gain| **gain != 0.0) {
        Some(gain) => Err(SynthesisError::Unsupported(format!(
            "k has {gain} on an estimate of the sensor fault, which episodes do not feed back; set it to zero"
        ))),
        None => Ok(reduced),
    }
}
