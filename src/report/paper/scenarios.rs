//! The episodes that figures and claims are read from, and what is met in them.

use super::error::PaperError;
use super::measures::Series;
use crate::backend::cpu::{Cpu, Precision};
use crate::campaign::{
    AgentGroup, Campaign, Distribution, DisturbanceKind, FTC, FaultKind, PID, PID_PLACED,
    Parameter, PlacedPoles,
};
use crate::controllers::GainSet;
use crate::draw::draw;
use crate::model::ChannelSample;
use crate::model::episode::Snapshot;
use std::f64::consts::TAU;

/// Steps between two samples: 10 ms.
const EVERY: u32 = 10;

/// An episode of a campaign, by its controller and its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scenario {
    /// Under the FTC.
    Ftc,
    /// Under the FTC, but without initial errors.
    OnCourse,
    /// Under the PID as the paper's text reads: hardly any integral action.
    Pid,
    /// Under a PID whose error has a triple pole.
    Placed,
}

/// The readings of the paper's PID, the plain one first.
pub(super) const READINGS: [Scenario; 2] = [Scenario::Pid, Scenario::Placed];

impl Scenario {
    /// What the episode is called in a sentence.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Ftc => "the episode under the FTC",
            Self::OnCourse => "the episode under the FTC without initial errors",
            Self::Pid => "the episode under the PID as the text reads",
            Self::Placed => "the episode under the PID with a triple pole",
        }
    }
}

/// The first agent of a campaign under the FTC, with and without its initial errors, and under the PID.
#[derive(Debug)]
pub struct Scenarios {
    pub(super) group: AgentGroup,
    pub(super) met: Met,
    ftc: Vec<Snapshot>,
    on_course: Vec<Snapshot>,
    pid: Vec<Snapshot>,
    placed: Vec<Snapshot>,
}

impl Scenarios {
    /// Simulates the first episode of a campaign in double precision.
    ///
    /// # Errors
    /// If it has no gains, or if the claims cannot be asked of it: its first agent must meet one sine
    /// and one smoothed square wave, the same on all channels.
    pub fn simulate(campaign: &Campaign) -> Result<Self, PaperError> {
        let compared = [FTC, PID, PID_PLACED].map(Into::into).to_vec();
        let group = campaign.first_group().clone();
        let group = group.with(|group| group.controllers = compared);
        let path = &group.path;
        let met = Met::of(&group).ok_or_else(|| PaperError::Unsuited { path: path.clone() })?;
        let gains = GainSet::synthesize_or_load(&group)?;
        let trace = |group: &AgentGroup, controller: usize| {
            let cpu = Cpu::new(group, &gains.loops(), Precision::F64, None);
            cpu.trace(0, controller, EVERY).1
        };
        let on_course = without_initial_errors(&group);
        let ((ftc, on_course), (pid, placed)) = rayon::join(
            || rayon::join(|| trace(&group, 0), || trace(&on_course, 0)),
            || rayon::join(|| trace(&group, 1), || trace(&group, 2)),
        );
        Ok(Self {
            group,
            met,
            ftc,
            on_course,
            pid,
            placed,
        })
    }

    fn snapshots(&self, simulated: Scenario) -> &[Snapshot] {
        match simulated {
            Scenario::Ftc => &self.ftc,
            Scenario::OnCourse => &self.on_course,
            Scenario::Pid => &self.pid,
            Scenario::Placed => &self.placed,
        }
    }

    /// A quantity of a channel of the first agent over time.
    pub(super) fn series(
        &self,
        simulated: Scenario,
        channel: usize,
        pick: impl Fn(&ChannelSample) -> f64,
    ) -> Series {
        let of_channel = |snapshot: &Snapshot| {
            let shown = snapshot.agents.first()?.get(channel)?;
            Some((self.time_s(snapshot), pick(shown)))
        };
        Series(
            self.snapshots(simulated)
                .iter()
                .filter_map(of_channel)
                .collect(),
        )
    }

    /// When the first agent's episode was no longer finite, s.
    pub(super) fn lost_s(&self, simulated: Scenario) -> Option<f64> {
        let lost = |snapshot: &&Snapshot| {
            let mut shown = snapshot.agents.first().into_iter().flatten();
            shown.any(|shown| !is_finite(shown))
        };
        let snapshot = self.snapshots(simulated).iter().find(lost)?;
        Some(self.time_s(snapshot))
    }

    fn time_s(&self, snapshot: &Snapshot) -> f64 {
        f64::from(snapshot.step) * self.group.time.step_s
    }

    /// The reading of the paper's PID that flies: the plain one if it stays finite.
    pub(super) fn flying_pid(&self) -> Scenario {
        let mut readings = READINGS.into_iter();
        let flies = |reading: &Scenario| self.lost_s(*reading).is_none();
        readings.find(flies).unwrap_or(Scenario::Pid)
    }

    /// A reading of the paper's PID, in a few words.
    pub(super) fn reading(&self, simulated: Scenario) -> String {
        match (simulated, &self.group.synthesis.placed.poles) {
            (Scenario::Placed, PlacedPoles::At(rad_s)) => {
                format!("PID with a triple pole at -{rad_s} 1/s")
            }
            (Scenario::Placed, PlacedPoles::DelayMarginOf(_)) => {
                "PID with a triple pole".to_string()
            }
            _ => "PID as the text reads".to_string(),
        }
    }

    /// How long an episode is, s.
    pub(super) fn end_s(&self) -> f64 {
        f64::from(self.group.time.steps) * self.group.time.step_s
    }

    /// When the sensor fault changes its sign after `from_s` and has half a period left, s.
    pub(super) fn jumps_s(&self, from_s: f64) -> Vec<f64> {
        let half_s = self.met.half_period_s();
        // The sign of tanh(sin(2 pi t/T + phase)/tau) changes where the sine has a zero.
        let first_s = (-self.met.phase_rad / TAU * self.met.period_s).rem_euclid(half_s);
        let jumps = (0..self.group.time.steps).map(|k| first_s + f64::from(k) * half_s);
        jumps
            .skip_while(|jump_s| *jump_s <= from_s)
            .take_while(|jump_s| jump_s + half_s <= self.end_s() + 1e-9)
            .collect()
    }
}

fn is_finite(shown: &ChannelSample) -> bool {
    let ChannelSample {
        r,
        x,
        e,
        e_rate,
        e_hat,
        f1,
        f1_hat,
        f2,
        f2_hat,
        u,
    } = *shown;
    let all = [r, x, e, e_rate, e_hat, f1, f1_hat, f2, f2_hat, u];
    all.iter().all(|value| value.is_finite())
}

/// The same agents from the reference itself.
fn without_initial_errors(group: &AgentGroup) -> AgentGroup {
    group.clone().with(|group| {
        let initial = &mut group.initial;
        for drawn in [
            &mut initial.error,
            &mut initial.error_rate,
            &mut initial.error_integral,
        ] {
            drawn.distributions.fill(Distribution::Constant(0.0));
        }
    })
}

/// What the first agent meets.
#[derive(Debug)]
pub(super) struct Met {
    /// Initial errors `[channel]`, m or rad.
    pub(super) errors: Vec<f64>,
    /// Amplitude of the disturbance on every channel, N or N m.
    pub(super) force: f64,
    /// Its frequency, rad/s.
    pub(super) force_rad_s: f64,
    /// Amplitude of the sensor fault on every channel, m/s or rad/s.
    pub(super) fault: f64,
    /// Its period, s.
    pub(super) period_s: f64,
    /// Its phase at t = 0, rad.
    phase_rad: f64,
    /// True mass over modelled mass.
    pub(super) mass_scale: f64,
}

impl Met {
    fn of(group: &AgentGroup) -> Option<Self> {
        let agent = draw(group, 0).agents.into_iter().next()?;
        let ([disturbance], [fault]) = (&*group.disturbances, &*group.faults) else {
            return None;
        };
        let (sine, square) = (DisturbanceKind::Sine, FaultKind::SmoothedSquare);
        let struck = agent.faults.first()?;
        if disturbance.kind != sine
            || fault.kind != square
            || !struck.strikes.iter().all(|strikes| *strikes)
        {
            return None;
        }
        let of_sine = |name| common(sine.parameters(), agent.disturbances.first()?, name);
        let of_square = |name| common(square.parameters(), &struck.parameters, name);
        Some(Self {
            errors: agent.error.clone(),
            force: of_sine("amplitude")?,
            force_rad_s: of_sine("frequency_rad_s")?,
            fault: of_square("amplitude")?,
            period_s: of_square("period_s")?,
            phase_rad: of_square("phase_rad")?,
            mass_scale: agent.mass_scale,
        })
    }

    /// Time between two jumps of the sensor fault, s.
    pub(super) fn half_period_s(&self) -> f64 {
        0.5 * self.period_s
    }

    /// Frequency of the sensor fault, rad/s.
    pub(super) fn fault_rad_s(&self) -> f64 {
        TAU / self.period_s
    }
}

/// The value that a parameter has on all channels.
fn common(parameters: &[Parameter], drawn: &[Vec<f64>], name: &str) -> Option<f64> {
    let index = parameters.iter().position(|own| own.name == name)?;
    let values = drawn.get(index)?;
    let first = *values.first()?;
    values
        .iter()
        .all(|value| value.to_bits() == first.to_bits())
        .then_some(first)
}
