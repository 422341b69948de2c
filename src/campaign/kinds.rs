//! The parameters of every kind of disturbance and fault, by name: one list serves validation, draws and tables.

use super::check::{Bounds, Parameter, required};
use super::file::{DisturbanceKind, FaultKind, FaultTarget};

const PHASE: Parameter = Parameter {
    name: "phase_rad",
    default: Some(0.0),
    bounds: Bounds::Any,
};

impl DisturbanceKind {
    /// The parameters of this kind.
    #[must_use]
    pub fn parameters(self) -> &'static [Parameter] {
        match self {
            Self::Sine => {
                const {
                    &[
                        required("amplitude", Bounds::Any),
                        required("frequency_rad_s", Bounds::NonNegative),
                        PHASE,
                    ]
                }
            }
            Self::Constant => const { &[required("amplitude", Bounds::Any)] },
            Self::GroundReaction => {
                const {
                    &[Parameter {
                        name: "scale",
                        default: Some(1.0),
                        bounds: Bounds::Any,
                    }]
                }
            }
        }
    }
}

impl FaultKind {
    /// The parameters of this kind.
    #[must_use]
    pub fn parameters(self) -> &'static [Parameter] {
        match self {
            Self::LossOfEffectiveness => const { &[required("magnitude", Bounds::Share)] },
            Self::Bias => const { &[required("magnitude", Bounds::Any)] },
            Self::SmoothedSquare => {
                const {
                    &[
                        required("amplitude", Bounds::Any),
                        required("period_s", Bounds::Positive),
                        required("smoothing", Bounds::AtLeast(1e-6)),
                        PHASE,
                    ]
                }
            }
            Self::Noise => const { &[required("std", Bounds::NonNegative)] },
        }
    }

    /// The name of this kind in a campaign file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::LossOfEffectiveness => "loss-of-effectiveness",
            Self::Bias => "bias",
            Self::SmoothedSquare => "smoothed-square",
            Self::Noise => "noise",
        }
    }

    /// Whether this kind can strike the target.
    pub(super) fn strikes(self, target: FaultTarget) -> bool {
        match self {
            Self::LossOfEffectiveness => target == FaultTarget::Actuator,
            Self::Bias => true,
            Self::SmoothedSquare | Self::Noise => target == FaultTarget::Sensor,
        }
    }
}
