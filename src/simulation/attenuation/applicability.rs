//! Where (24) applies, as far as the campaign and the draw tell: faults that are continuously differentiable in time.
//! And why it does not.

use crate::agent::robot::LEG_JOINTS;
use crate::agent::{ActuationKind, Agent};
use crate::campaign::{AgentGroup, DisturbanceKind, Fault, FaultTarget, IntegralKind, Link, Time};
use crate::draw::{AgentDraw, FaultDraw};
use thiserror::Error;

/// Why (24) says nothing about a channel of an episode.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NotApplicable {
    /// A PID.
    #[error("the controller does not estimate the faults")]
    NoEstimate,
    /// Gains of an older run.
    #[error("gains.json holds no certificate of these gains")]
    NoCertificate,
    /// A certificate that does not verify.
    #[error("the certificate in gains.json does not belong to these gains and weights")]
    OtherCertificate,
    /// Thrust along the body axis.
    #[error("under thrust the command filter stands between u_fb and the plant")]
    CommandFilter,
    /// What (19) does not know.
    #[error(
        "[control] changes the loop: (19) knows no delay, no sampled controller and no measured integral"
    )]
    LoopOptions,
    /// A disturbance that is not differentiable.
    #[error("disturbance {entry} ({kind}) is not continuously differentiable in time")]
    RoughDisturbance {
        /// Which of the campaign.
        entry: usize,
        /// What it is.
        kind: &'static str,
    },
    /// A fault that is not differentiable.
    #[error("fault {entry} ({kind}) is not continuously differentiable in time")]
    RoughFault {
        /// Which of the campaign.
        entry: usize,
        /// What it is.
        kind: &'static str,
    },
    /// An episode that left the numbers.
    #[error("the trajectory is not finite from {t_s:.3} s on")]
    NotFinite {
        /// Since when, s.
        t_s: f64,
    },
    /// Limits, a delay or a hold.
    #[error("the feedback is not K ehat at {t_s:.3} s: a limit cuts it, or it is held")]
    OtherFeedback {
        /// When first, s.
        t_s: f64,
    },
    /// An integral that is measured.
    #[error("the first output is not the integral of e")]
    OtherIntegral,
    /// Faults too fast for the step.
    #[error("the step does not resolve how the faults move; use a smaller step_s")]
    Unresolved,
    /// No fault at all.
    #[error("there is nothing to attenuate: v is zero")]
    NoModelError,
}

/// What keeps (24) from saying anything about a channel of an agent, if anything does.
///
/// Other agents are none: they act through their positions, which are smooth whatever strikes them.
#[must_use]
pub fn obstacle(group: &AgentGroup, draw: &AgentDraw, channel: usize) -> Option<NotApplicable> {
    if group.agent.actuation() == ActuationKind::Thrust {
        return Some(NotApplicable::CommandFilter);
    }
    let control = &group.control;
    if control.delay_s.is_some()
        || control.hold_steps > 1
        || control.integral == IntegralKind::Sensor
    {
        return Some(NotApplicable::LoopOptions);
    }
    let rough = |kind: DisturbanceKind| {
        let reaches = |struck| kind.acts_on(struck) && command_meets(group, struck, channel);
        !kind.is_smooth() && (0..group.channels().len()).any(reaches)
    };
    for (entry, disturbance) in group.disturbances.iter().enumerate() {
        if rough(disturbance.kind) {
            let kind = disturbance.kind.name();
            return Some(NotApplicable::RoughDisturbance { entry, kind });
        }
    }
    let rough = |&(_, (fault, own)): &(usize, (&Fault, &FaultDraw))| {
        (0..own.strikes.len())
            .any(|struck| own.strikes[struck] && meets(group, fault, struck, channel))
            && !is_smooth(fault, own, group.time)
    };
    let mut faults = group.faults.iter().zip(&draw.faults).enumerate();
    faults
        .find(rough)
        .map(|(entry, (fault, _))| NotApplicable::RoughFault {
            entry,
            kind: fault.kind.name(),
        })
}

/// Whether a fault as drawn is continuously differentiable in time from t = 0 on.
#[must_use]
pub fn is_smooth(fault: &Fault, draw: &FaultDraw, time: Time) -> bool {
    // All fields by name: whoever adds one decides here what it does to smoothness.
    let Fault {
        name: _,
        target: _,
        link: _,
        kind,
        probability: _,
        background: _,
        channels: _,
        onset_s: _,
        duration_s: _,
        ramp_s: _,
        parameters: _,
    } = fault;
    let FaultDraw {
        strikes: _,
        onset_s,
        duration_s,
        ramp_s,
        parameters: _,
    } = draw;
    let onset = time.onset_step(*onset_s);
    match kind {
        _ if onset >= time.steps => true,
        _ if duration_s.is_finite() || *ramp_s > 0.0 => false,
        // A constant share or offset, and smooth waves, that are there from the start.
        kind => kind.is_smooth() && onset == 0,
    }
}

/// Whether a jump of a fault on channel `struck` is a jump of f1 or f2 of channel `channel`. The torques of a leg act
/// on all its joints at once; a UAV's channels, and whatever passes through a sensor, act on others through integrals
/// only.
fn meets(group: &AgentGroup, fault: &Fault, struck: usize, channel: usize) -> bool {
    match (fault.target, fault.link) {
        (FaultTarget::Plant, _) => true,
        (_, Link::Measurement) => struck == channel,
        (_, Link::Command) => command_meets(group, struck, channel),
    }
}

/// The same for whatever acts like a command.
fn command_meets(group: &AgentGroup, struck: usize, channel: usize) -> bool {
    match &group.agent {
        Agent::Uav(_) => struck == channel,
        Agent::Biped(_) => struck / LEG_JOINTS == channel / LEG_JOINTS,
    }
}
