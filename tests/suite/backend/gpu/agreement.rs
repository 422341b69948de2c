//! Whether episodes of the GPU agree with those of the CPU: one comparison, which parity demands and every mutation
//! fails.

use super::Gains;
use std::fmt;
use urts_mc::backend::EpisodeResult;
use urts_mc::backend::cpu::{Cpu, Precision, Simd};
use urts_mc::campaign::Campaign;
use urts_mc::draw::Episode;
use urts_mc::model::episode::AgentOutcome;
use urts_mc::model::metric::ChannelOutcome;

/// A metric, given the seconds from settle_s on; it is compared relative to its size, or to one below which singles
/// have not the digits.
type Metric = (&'static str, fn(&ChannelOutcome, f64) -> f64, f64);
/// Mean errors of 2 cm or 1 degree; rates of 0.1 m/s or rad/s; efforts and commands of 1 N or N m; accelerations of 1 %
/// of gravity; f2 as e.
const METRICS: [Metric; 8] = [
    ("rmse", |channel, _| channel.rmse, 2e-2),
    ("iae", |channel, seconds| channel.iae / seconds, 2e-2),
    (
        "ise",
        |channel, seconds| (channel.ise / seconds).sqrt(),
        2e-2,
    ),
    ("peak rate", |channel, _| channel.peak_rate, 1e-1),
    ("effort", |channel, _| channel.effort, 1.0),
    ("u_max", |channel, _| channel.u_max, 1.0),
    ("f1 error", |channel, _| channel.f1_rms_error, 1e-1),
    ("f2 error", |channel, _| channel.f2_rms_error, 2e-2),
];

/// What the GPU is compared with, and how far apart they may be.
pub(super) struct Against {
    name: &'static str,
    precision: Precision,
    /// Of the largest |e|, m or rad; and how far |e| may be from a threshold that only one of them meets.
    error: f64,
    /// Of each of [`METRICS`].
    relative: [f64; METRICS.len()],
    /// Of the step at which an agent leaves the numbers before |e| is judged.
    overflow_steps: u32,
    /// Of the steps at which a limit cuts the command; none if episodes that saturate are not compared.
    saturated_steps: Option<f64>,
}

/// The contract between backends (`simulation::cross_check`).
pub(super) const CONTRACT: Against = Against {
    name: "double",
    precision: Precision::F64,
    error: 2e-4,
    // The contract names the RMS error; the others are averages and maxima too.
    relative: [1e-4; METRICS.len()],
    // Doubles hold larger numbers. What grows as its square gets from 1e38 to 1e308 in a few steps.
    overflow_steps: 4,
    saturated_steps: None,
};

/// The same operations in single precision, which differ in the rounding of fused products alone: three to five times
/// the largest differences of a million steps on the campaigns here.
pub(super) const TWIN: Against = Against {
    name: "single",
    precision: Precision::F32,
    error: 3e-6,
    relative: [4e-5, 4e-5, 4e-5, 4e-5, 6e-6, 4e-5, 3e-5, 4e-5],
    overflow_steps: 0,
    saturated_steps: Some(1.0),
};

/// What the CPU makes of a campaign.
pub(super) struct Expected {
    campaign: Campaign,
    against: &'static Against,
    simulated: Vec<EpisodeResult>,
    /// The same campaign with every threshold on |e| lower and higher by the tolerance.
    strict: Cpu,
    lenient: Cpu,
}

/// How an agent fared: as the campaign says, and with strict and lenient thresholds.
struct Bracket<'a> {
    expected: &'a Expected,
    episode: u32,
    controller: usize,
    agent: usize,
}

/// What was compared, and the largest differences.
#[derive(Debug, Default)]
pub(super) struct Summary {
    /// Episodes of a team whose metrics were compared.
    pub(super) compared: usize,
    /// Agents that broke a limit, that left the numbers, and that a limit of their actuators cut.
    pub(super) exceeded: usize,
    pub(super) diverged: usize,
    pub(super) saturated: usize,
    /// Steps that differ, each within the tolerance of its threshold.
    pub(super) near: usize,
    pub(super) max_abs: f64,
    pub(super) relative: [f64; METRICS.len()],
    pub(super) saturated_steps: f64,
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [compared, near] = [self.compared, self.near];
        writeln!(
            f,
            "{compared} flights compared, {near} steps near a threshold;"
        )?;
        let [exceeded, diverged, saturated] = [self.exceeded, self.diverged, self.saturated];
        writeln!(
            f,
            "  agents: {exceeded} exceeded, {diverged} diverged, {saturated} saturated;"
        )?;
        writeln!(
            f,
            "  max_abs {:.1e}, saturated steps {:.1}",
            self.max_abs, self.saturated_steps
        )?;
        write!(
            f,
            "  {:?} {}",
            METRICS.map(|(name, ..)| name),
            figures(&self.relative)
        )
    }
}

/// Numbers in two digits.
pub(super) fn figures(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| format!("{value:.1e}")).collect();
    values.join(", ")
}

/// Fails with a message unless a condition holds.
fn require(condition: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if condition { Ok(()) } else { Err(message()) }
}

impl Expected {
    pub(super) fn new(campaign: &Campaign, gains: &Gains, against: &'static Against) -> Self {
        let cpu = |shift: f64| {
            let shifted = campaign.clone().with(|own| {
                let verdict = &mut own.verdict;
                let limits = verdict.max_error.iter_mut();
                for limit in limits.chain(&mut verdict.settled_error) {
                    *limit += shift;
                }
            });
            Cpu::new(
                shifted.first_group(),
                gains,
                against.precision,
                Some(Simd::Scalar),
            )
        };
        Self {
            campaign: campaign.clone(),
            against,
            simulated: cpu(0.0).simulate(0..campaign.episodes, &|_| ()),
            strict: cpu(-against.error),
            lenient: cpu(against.error),
        }
    }

    /// Compares every episode, controller, agent and channel; the error is the first difference.
    pub(super) fn compare(&self, simulated: &[EpisodeResult]) -> Result<Summary, String> {
        let mut summary = Summary::default();
        require(simulated.len() == self.simulated.len(), || {
            format!("{} episodes", simulated.len())
        })?;
        for (own, expected) in simulated.iter().zip(&self.simulated) {
            let episode = own.episode.index;
            require(own.episode == expected.episode, || {
                format!("episode {episode} has another draw")
            })?;
            let teams = own.outcomes.iter().zip(&expected.outcomes);
            for (controller, (team, expected)) in teams.enumerate() {
                self.compare_agent_outcome(&own.episode, controller, team, expected, &mut summary)
                    .map_err(|difference| {
                        let against = self.against.name;
                        format!(
                            "{against}: episode {episode}, controller {controller}, {difference}"
                        )
                    })?;
            }
        }
        Ok(summary)
    }

    /// Compares how a team fared under a controller.
    fn compare_agent_outcome(
        &self,
        episode: &Episode,
        controller: usize,
        team: &[AgentOutcome],
        expected: &[AgentOutcome],
        summary: &mut Summary,
    ) -> Result<(), String> {
        // Near divergence and saturation verdicts are compared, not trajectories.
        let comparable = |agent: &AgentOutcome| {
            !failed(agent) && (self.against.saturated_steps.is_some() || !saturated(agent))
        };
        let comparable = expected.iter().all(comparable);
        summary.compared += usize::from(comparable);
        for (agent, (own, expected)) in team.iter().zip(expected).enumerate() {
            let bracket = Bracket {
                expected: self,
                episode: episode.index,
                controller,
                agent,
            };
            self.compare_verdict(own, expected, &bracket, summary)
                .map_err(|difference| format!("agent {agent}: {difference}"))?;
            if !comparable {
                continue;
            }
            let later_fault = episode.agents[agent]
                .faults
                .iter()
                .any(|fault| fault.occurs() && self.campaign.time.onset_step(fault.onset_s) > 0);
            for (c, (channel, expected)) in own.channels.iter().zip(&expected.channels).enumerate()
            {
                self.compare_metrics(channel, expected, summary)
                    .and_then(|()| {
                        let steps = [channel, expected];
                        bracket.compare_outside(steps, c, later_fault, summary)
                    })
                    .map_err(|difference| format!("agent {agent}, channel {c}: {difference}"))?;
            }
        }
        Ok(())
    }

    /// Verdicts are equal unless within the tolerance of their threshold.
    fn compare_verdict(
        &self,
        own: &AgentOutcome,
        expected: &AgentOutcome,
        bracket: &Bracket<'_>,
        summary: &mut Summary,
    ) -> Result<(), String> {
        summary.exceeded += usize::from(failed(own) && !own.diverged);
        summary.diverged += usize::from(own.diverged);
        summary.saturated += usize::from(saturated(own));
        require(own.diverged == expected.diverged, || {
            format!("diverged {} against {}", own.diverged, expected.diverged)
        })?;
        if own.failed_step != expected.failed_step {
            let never = |step: Option<u32>| step.unwrap_or(u32::MAX);
            let [mut first, mut last] = bracket.flights().map(|agent| never(agent.failed_step));
            if first.min(never(own.failed_step)) < self.campaign.time.settle_step {
                first = first.saturating_sub(self.against.overflow_steps);
                last = last.saturating_add(self.against.overflow_steps);
            }
            require((first..=last).contains(&never(own.failed_step)), || {
                format!("failed {:?}, not in {first}..={last}", own.failed_step)
            })?;
            summary.near += 1;
        }
        if failed(expected) {
            return Ok(());
        }
        let limits = &self.campaign.first_group().verdict.max_rmse;
        for ((own, expected), limit) in own.channels.iter().zip(&expected.channels).zip(limits) {
            let near = (expected.rmse - limit).abs() <= self.against.relative[0] * limit;
            require(
                near || (own.rmse > *limit) == (expected.rmse > *limit),
                || format!("rmse {} against {} of {limit}", own.rmse, expected.rmse),
            )?;
        }
        Ok(())
    }

    fn compare_metrics(
        &self,
        own: &ChannelOutcome,
        expected: &ChannelOutcome,
        summary: &mut Summary,
    ) -> Result<(), String> {
        let max_abs = (own.max_abs - expected.max_abs).abs();
        summary.max_abs = summary.max_abs.max(max_abs);
        require(max_abs <= self.against.error, || {
            format!("max_abs {} against {}", own.max_abs, expected.max_abs)
        })?;
        let time = self.campaign.time;
        let seconds = f64::from(time.steps - time.settle_step) * time.step_s;
        let metrics = METRICS.iter().zip(self.against.relative);
        for (((name, of, size), tolerance), largest) in metrics.zip(&mut summary.relative) {
            let (own, expected) = (of(own, seconds), of(expected, seconds));
            let difference = (own - expected).abs() / expected.max(*size);
            *largest = largest.max(difference);
            require(difference <= tolerance, || {
                format!("{name} {own} against {expected}")
            })?;
        }
        let share = (own.saturated_fraction - expected.saturated_fraction).abs();
        let saturated = share * f64::from(self.campaign.time.steps);
        summary.saturated_steps = summary.saturated_steps.max(saturated);
        let tolerance = self.against.saturated_steps.unwrap_or(0.0);
        // Half a step more, since a share of the steps is no whole number.
        require(saturated <= tolerance + 0.5, || {
            format!("{saturated} more or less saturated steps")
        })
    }
}

impl Bracket<'_> {
    /// With strict thresholds, and with lenient ones.
    fn flights(&self) -> [AgentOutcome; 2] {
        [&self.expected.strict, &self.expected.lenient].map(|cpu| {
            let simulated = cpu.simulate(self.episode..self.episode + 1, &|_| ());
            simulated[0].outcomes[self.controller][self.agent].clone()
        })
    }

    /// The last steps outside the settled error are equal unless within the tolerance of this threshold.
    fn compare_outside(
        &self,
        [own, expected]: [&ChannelOutcome; 2],
        c: usize,
        later_fault: bool,
        summary: &mut Summary,
    ) -> Result<(), String> {
        // Without a later fault, nothing reads the step before it.
        let steps = |channel: &ChannelOutcome| {
            let before = channel.last_outside_before_fault;
            [channel.last_outside, before.filter(|_| later_fault)]
        };
        if steps(own) == steps(expected) {
            return Ok(());
        }
        summary.near += 1;
        let [strict, lenient] = self.flights().map(|agent| steps(&agent.channels[c]));
        for (k, own) in steps(own).into_iter().enumerate() {
            // A lower threshold is left later; never to be outside comes before every step.
            require((lenient[k]..=strict[k]).contains(&own), || {
                format!(
                    "last outside {own:?}, not in {:?}..={:?}",
                    lenient[k], strict[k]
                )
            })?;
        }
        Ok(())
    }
}

/// Whether an agent broke a limit or left the numbers.
pub(super) fn failed(agent: &AgentOutcome) -> bool {
    agent.diverged || agent.failed_step.is_some()
}

/// Whether a limit cut its commands.
pub(super) fn saturated(agent: &AgentOutcome) -> bool {
    agent
        .channels
        .iter()
        .any(|channel| channel.saturated_fraction > 0.0)
}
