//! The controllers of a campaign with their gains, and what is known about them.

use crate::synthesis::{
    Certificate, ChannelDesign, Check, ControllerGains, LoopAnalysis, LoopGains, SolverReport,
    SynthesisError, Verified, loop_gains, verify,
};
use serde::{Deserialize, Serialize};

/// The controllers of a campaign with their gains for one group of agents, in the campaign's order.
#[derive(Debug, Clone)]
pub struct GainSet {
    /// The controllers.
    pub controllers: Vec<SimulatedController>,
}

/// A controller with its gains.
#[derive(Debug, Clone)]
pub struct SimulatedController {
    /// Its name in the campaign.
    pub name: String,
    /// Whose gains they are: "synthesized", or a file and the name there.
    pub source: String,
    /// Gains on each channel group of the agents, in their order.
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
    /// The weights and the smoothing model that the gains belong to.
    pub design: ChannelDesign,
    /// The gains as designed.
    pub gains: ControllerGains,
    /// The gains as integrated.
    pub loop_gains: LoopGains,
    /// What was found about them; for gains read back from a run what the run wrote, where it did.
    pub findings: Option<Findings>,
}

impl ChannelController {
    /// A controller of gains that are found to be sound.
    ///
    /// # Errors
    /// If episodes cannot integrate them.
    pub fn new(
        design: ChannelDesign,
        gains: ControllerGains,
        findings: Option<Findings>,
    ) -> Result<Self, SynthesisError> {
        Ok(Self {
            loop_gains: integrable(&design, &gains)?,
            design,
            gains,
            findings,
        })
    }

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

impl Findings {
    /// What verification finds about gains that were not designed here.
    ///
    /// # Errors
    /// If they do not pass.
    pub fn of(design: &ChannelDesign, gains: &ControllerGains) -> Result<Self, SynthesisError> {
        verify(design, gains).map(Self::from)
    }
}

impl From<Verified> for Findings {
    fn from(verified: Verified) -> Self {
        Self {
            analysis: verified.analysis,
            certificate: verified.certificate,
            checks: verified.checks,
            solver: Vec::new(),
        }
    }
}

impl GainSet {
    /// The gains of each group as the episode loop takes them, `[group][controller][channel group]`.
    #[must_use]
    pub fn loops_of(groups: &[Self]) -> Vec<Vec<Vec<LoopGains>>> {
        groups.iter().map(Self::loops).collect()
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
