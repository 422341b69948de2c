//! What kinds of controllers leave free: the parameters that a search may turn, and the gains that they give.

use crate::campaign::{FTC, FTC_TUNED, PID, PID_PLACED, PID_TUNED};
use crate::controllers::{ChannelController, Findings, fault_tolerant};
use crate::synthesis::{
    ChannelDesign, PidShape, SmoothingRule, SynthesisError, geometric_q2, synthesize,
    synthesize_by_riccati,
};

/// A kind of controller whose parameters can be searched. To add one, add it to [`STRUCTURES`].
#[derive(Debug, Clone, Copy)]
pub struct Structure {
    /// Its name on the command line.
    pub name: &'static str,
    /// The name of its result.
    pub tuned: &'static str,
    /// The controller that the search begins with.
    pub starts_from: &'static str,
    /// What it leaves free on each channel group.
    pub parameters: &'static [FreeParameter],
    /// The parameters of the controller that the search begins with.
    pub(super) start: fn(&ChannelController) -> Vec<f64>,
    /// The controller of some parameters; the design is that of the campaign.
    pub(super) controller: fn(&ChannelDesign, &[f64], Stage) -> Built,
}

/// A controller of some parameters, or why there is none.
type Built = Result<ChannelController, SynthesisError>;

/// What a controller is wanted for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    /// To be tried among many.
    Search,
    /// To be taken: synthesized, verified and certified as ever.
    Choice,
}

/// A parameter that a search may turn: a positive number, of which ratios count.
#[derive(Debug, Clone, Copy)]
pub struct FreeParameter {
    /// Its name in tables.
    pub name: &'static str,
    /// The factor by which the first candidates differ from the start, about.
    pub(super) spread: f64,
    /// The smallest and the largest value.
    pub(super) range: [f64; 2],
}

/// What a step of 2 ms resolves well, rad/s.
const FASTEST_OBSERVER_RAD_S: f64 = 800.0;

/// All of them.
pub const STRUCTURES: &[Structure] = &[
    Structure {
        name: PID,
        tuned: PID_TUNED,
        starts_from: PID_PLACED,
        parameters: &[
            free("real_pole_rad_s", 2.0, [0.1, 1000.0]),
            free("pole_pair_rad_s", 2.0, [0.1, 1000.0]),
            free("pole_pair_damping", 2.0, [0.05, 10.0]),
            free(
                "observer_integral_rad_s",
                2.0,
                [0.1, FASTEST_OBSERVER_RAD_S],
            ),
            free(
                "observer_position_rad_s",
                2.0,
                [0.1, FASTEST_OBSERVER_RAD_S],
            ),
            free("observer_rate_rad_s", 3.0, [0.1, FASTEST_OBSERVER_RAD_S]),
        ],
        start: |placed| {
            let poles_rad_s = -placed.gains.k[2] / 3.0;
            let observer_rad_s = 10.0 * poles_rad_s;
            let poles = [poles_rad_s, poles_rad_s, 1.0];
            [poles, [observer_rad_s; 3]].concat()
        },
        controller: |design, values, _| {
            let shape = PidShape {
                real_rad_s: values[0],
                pair_rad_s: values[1],
                damping: values[2],
                observer_rad_s: [values[3], values[4], values[5]],
            };
            let gains = shape.gains()?;
            let findings = Findings::of(design, &gains)?;
            ChannelController::new(design.clone(), gains, Some(findings))
        },
    },
    Structure {
        name: FTC,
        tuned: FTC_TUNED,
        starts_from: FTC,
        // R is not among them: R and rho are one, for Q1, Q2, R and rho^2 may be multiplied by the same.
        parameters: &[
            free("q1_integral", 3.0, [1e-6, 1e9]),
            free("q1_error", 3.0, [1e-6, 1e9]),
            free("q1_rate", 3.0, [1e-6, 1e9]),
            free("q2_actuator_fault", 3.0, [1e-6, 1e6]),
            free("q2_sensor_fault", 3.0, [1e-6, 1e6]),
            free("rho", 1.5, [1e-3, 1e6]),
            free("nu", 3.0, [1e-8, 1e2]),
            free("eps2", 3.0, [1e-6, 1e3]),
            free("smoothing_spacing_s", 1.5, [1e-3, 1.0]),
            free("smoothing_leak_per_s", 1.5, [1e-2, 1e2]),
        ],
        start: |own| {
            let design = &own.design;
            let [taps1, _] = design.smoothing.taps();
            let leak_per_s = match design.smoothing.rule {
                SmoothingRule::Leaky { leak_per_s, .. } => leak_per_s,
                SmoothingRule::Weights(_) => 1.0,
            };
            let faults = [design.q2[3], design.q2[3 + taps1]];
            let others = [
                design.rho,
                design.nu,
                design.eps2,
                design.smoothing.spacing_s,
                leak_per_s,
            ];
            [&design.q1[..], &faults, &others].concat()
        },
        controller: |design, values, stage| {
            let mut design = ChannelDesign {
                q1: [values[0], values[1], values[2]],
                rho: values[5],
                nu: values[6],
                eps2: values[7],
                ..design.clone()
            };
            design.smoothing.spacing_s = values[8];
            if let SmoothingRule::Leaky { leak_per_s, .. } = &mut design.smoothing.rule {
                *leak_per_s = values[9];
            }
            let error = [design.q2[0], design.q2[1], design.q2[2]];
            design.q2 = geometric_q2(&design.smoothing, error, values[3], values[4]);
            let (gains, findings) = match stage {
                Stage::Search => {
                    let (gains, verified) = synthesize_by_riccati(&design)?;
                    (gains, verified.into())
                }
                Stage::Choice => fault_tolerant(&synthesize(&design)?),
            };
            ChannelController::new(design, gains, Some(findings))
        },
    },
];

const fn free(name: &'static str, spread: f64, range: [f64; 2]) -> FreeParameter {
    FreeParameter {
        name,
        spread,
        range,
    }
}

impl Structure {
    /// The structure of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        STRUCTURES.iter().find(|own| own.name == name)
    }
}

impl FreeParameter {
    /// The value at a coordinate of the search, in which the first candidates are about one away from the start.
    pub(super) fn at(&self, start: f64, coordinate: f64) -> f64 {
        let [low, high] = self.range;
        (start * self.spread.powf(coordinate)).clamp(low, high)
    }
}
