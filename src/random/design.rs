//! The designs, and which statistics keep what they promise under each.

/// Disturbances, or faults, that the dimensions of a design can tell apart.
pub(crate) const MOST_ENTRIES: usize = 1 << 11;

/// How the random numbers of the episodes are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Design {
    /// Independent numbers.
    Independent,
    /// One or several Latin hypercubes.
    LatinHypercube,
    /// One or several scramblings of a Sobol sequence.
    Sobol,
}

impl Design {
    /// All designs.
    pub const ALL: [Self; 3] = [Self::Independent, Self::LatinHypercube, Self::Sobol];

    /// What its replicates are called.
    #[must_use]
    pub fn replicates_noun(self) -> &'static str {
        match self {
            Self::Independent => "independent draws",
            Self::LatinHypercube => "Latin hypercubes",
            Self::Sobol => "scrambled Sobol nets",
        }
    }
}

/// Kinds of statistics, by what they take for granted of the episodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Failure rates, means and quantiles of all episodes, without an interval.
    Estimate,
    /// Intervals and bounds of a failure rate, sequential ones too, and the number of runs they
    /// need.
    FailureRate,
    /// Intervals of quantiles and medians.
    Quantile,
    /// Paired tests, differences and win rates of two controllers, episode by episode.
    Paired,
    /// Intervals of rank correlations.
    EffectInterval,
    /// Permutation tests of effects.
    EffectTest,
    /// Student's t over the estimates of replicates.
    Replicates,
}

impl Method {
    /// All kinds.
    pub const ALL: [Self; 7] = [
        Self::Estimate,
        Self::FailureRate,
        Self::Quantile,
        Self::Paired,
        Self::EffectInterval,
        Self::EffectTest,
        Self::Replicates,
    ];
}

/// Whether a statistic keeps what it promises for the episodes of a design; the reasons are at the
/// head of [`random`](super). Effect tests of Latin hypercubes: within one of them.
#[must_use]
pub fn allows(design: Design, method: Method) -> bool {
    match design {
        Design::Independent => true,
        Design::LatinHypercube => matches!(
            method,
            Method::Estimate | Method::EffectTest | Method::Replicates
        ),
        Design::Sobol => matches!(method, Method::Estimate | Method::Replicates),
    }
}
