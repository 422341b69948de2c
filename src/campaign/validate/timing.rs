//! What the step and the end of an episode allow.

use crate::campaign::check::{Check, Written};
use crate::campaign::distribution::Distribution;
use crate::campaign::error::CampaignError;
use crate::campaign::file::Parameters;
use crate::campaign::parameter::{Parameter, Resolution};
use crate::campaign::quantity::RandomQuantity;
use crate::campaign::time::{Time, Timing};
use std::f64::consts::TAU;

/// The key that says when something begins.
pub(super) const ONSET_KEY: &str = "onset_s";

/// How far a signal may turn in one step, rad; beyond it the method's stages no longer see its shape.
const MAX_STEP_RAD: f64 = 0.5;

/// Samples that a delay or a replay may keep of each channel.
const MAX_REMEMBERED: f64 = 1024.0;

impl Check<'_> {
    /// Refuses parameters of a disturbance or fault that the step, the end or the memory of an episode cannot show.
    pub(super) fn shown<T: Parameters, B: Parameters>(
        &self,
        table: &str,
        (base, blocks): (&T, Option<&[B]>),
        (parameters, drawn): (&[Parameter], &[RandomQuantity]),
        time: Time,
    ) -> Result<(), CampaignError> {
        for (parameter, drawn) in parameters.iter().zip(drawn) {
            let key = format!("{table}.{}", parameter.name);
            if parameter.timing == Timing::Onset {
                let written = Written {
                    base: base.parameter(parameter.name),
                    own: &|agent| blocks?[agent].parameter(parameter.name),
                };
                self.begins(table, written, drawn, time)?;
            }
            match parameter.resolution {
                None => {}
                Some(Resolution::Period) => {
                    self.resolved(&key, drawn, |(low, _)| TAU / low, time)?
                }
                Some(Resolution::Frequency) => {
                    self.resolved(&key, drawn, |(_, high)| high, time)?
                }
                Some(Resolution::Memory) => self.remembered(&key, drawn, time)?,
            }
        }
        Ok(())
    }

    /// Refuses what begins after the run has ended.
    pub(super) fn begins(
        &self,
        table: &str,
        written: Written<'_>,
        onset_s: &RandomQuantity,
        time: Time,
    ) -> Result<(), CampaignError> {
        let latest =
            |own: &[Distribution]| own.iter().map(|own| own.support().1).fold(0.0, f64::max);
        let of_agents = onset_s.distributions.chunks(onset_s.channels).enumerate();
        let mut late = of_agents.filter(|(_, own)| time.onset_step(latest(own)) >= time.steps);
        match late
            .next()
            .map(|(agent, _)| written.of(table, ONSET_KEY, agent))
        {
            Some((key, Some(value))) => {
                let last_step_s = time.shown_s(time.steps - 1);
                Err(self.invalid(
                    key,
                    value,
                    &format!("it must begin before the end, by the last step at {last_step_s} s"),
                    "begin it earlier",
                ))
            }
            _ => Ok(()),
        }
    }

    /// Refuses pasts that no memory would hold.
    pub(super) fn remembered(
        &self,
        key: &str,
        length_s: &RandomQuantity,
        time: Time,
    ) -> Result<(), CampaignError> {
        let supports = length_s.distributions.iter().map(Distribution::support);
        let longest_s = supports.map(|(_, high)| high).fold(0.0, f64::max);
        if time.whole_steps(longest_s) <= MAX_REMEMBERED {
            return Ok(());
        }
        Err(self.invalid(
            key,
            format!("up to {longest_s} s"),
            &format!(
                "at most {MAX_REMEMBERED} steps of {} s are remembered, {:.3} s",
                time.step_s,
                MAX_REMEMBERED * time.step_s
            ),
            "shorten it, or lengthen time.step_s",
        ))
    }

    /// Refuses frequencies that a step cannot resolve: they would be seen as others.
    fn resolved(
        &self,
        key: &str,
        drawn: &RandomQuantity,
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
}
