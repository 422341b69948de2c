//! The plan of a campaign: which episodes meet what, how their numbers are drawn, and when enough is known.

use crate::random::Design;
use schemars::JsonSchema;
use serde::Deserialize;
use std::sync::Arc;

/// Which of the tables that grow with the episodes a run writes. Statistics, curves, flights and the report are the
/// same whichever.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Detail {
    /// None.
    Summary,
    /// That of the episodes alone, with every parameter drawn.
    Episodes,
    /// That of the channels, of the faults and of the conditions, too.
    #[default]
    All,
}

impl Detail {
    /// All of them, the least first.
    pub const ALL: [Self; 3] = [Self::Summary, Self::Episodes, Self::All];

    /// The word in a campaign file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Summary => "summary",
            Self::Episodes => "episodes",
            Self::All => "all",
        }
    }
}

/// A part of the episodes, which meets faults of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stratum {
    /// Its name, different from all others.
    pub name: Arc<str>,
    /// The faults of its episodes.
    pub faults: StratumFaults,
    /// How many episodes it has, relative to the other strata; at least 1.
    pub share: u32,
}

/// The faults of a stratum's episodes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StratumFaults {
    /// Every fault with its own probability.
    ByProbability,
    /// Every agent has these (by index) and no other.
    Certain(Vec<usize>),
}

/// The strata of a campaign, and which episode belongs to which. None at all: the campaign is not divided.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Strata {
    list: Vec<Stratum>,
    /// Indices of strata, episode by episode, over and over.
    pattern: Vec<usize>,
}

impl Strata {
    /// Strata in the order of the tables. Episodes go round by round: one to each stratum, then a second to each whose
    /// share is 2 or more, and so on to the largest share, and all over again. So a longer run begins as a shorter one
    /// does, and every whole turn has the shares to the episode.
    #[must_use]
    pub fn new(list: Vec<Stratum>) -> Self {
        let rounds = list.iter().map(|stratum| stratum.share).max().unwrap_or(0);
        let all = &list;
        let of_round = |round| (0..all.len()).filter(move |&k| round < all[k].share);
        let pattern = (0..rounds).flat_map(of_round).collect();
        Self { list, pattern }
    }

    /// All of them.
    #[must_use]
    pub fn all(&self) -> &[Stratum] {
        &self.list
    }

    /// Whether the campaign is not divided.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Episodes after which every stratum has had its share.
    #[must_use]
    pub fn turn(&self) -> usize {
        self.pattern.len()
    }

    /// How many of the first `episodes` are a stratum's.
    #[must_use]
    pub fn count(&self, stratum: usize, episodes: u32) -> u64 {
        let own = |places: &[usize]| places.iter().filter(|&&own| own == stratum).count() as u64;
        let turn = self.pattern.len().max(1);
        let rest = (episodes as usize % turn).min(self.pattern.len());
        (episodes as usize / turn) as u64 * own(&self.pattern) + own(&self.pattern[..rest])
    }

    /// How many episodes there are when a stratum has had its `nth`, counted from 1; 0 if the stratum does not exist.
    #[must_use]
    pub fn episodes_for(&self, stratum: usize, nth: u64) -> u64 {
        let places = (1u64..).zip(&self.pattern);
        let own: Vec<u64> = places
            .filter(|(_, own)| **own == stratum)
            .map(|(place, _)| place)
            .collect();
        let before = nth.saturating_sub(1);
        let place = before.checked_rem(own.len() as u64);
        let place = place.and_then(|place| own.get(usize::try_from(place).ok()?));
        place.map_or(0, |place| {
            let turns = before / own.len() as u64;
            turns
                .saturating_mul(self.pattern.len() as u64)
                .saturating_add(*place)
        })
    }

    /// The index of an episode's stratum.
    #[must_use]
    pub fn index(&self, episode: u32) -> Option<usize> {
        let place = (episode as usize).checked_rem(self.pattern.len())?;
        self.pattern.get(place).copied()
    }

    /// An episode's stratum.
    #[must_use]
    pub fn of(&self, episode: u32) -> Option<&Stratum> {
        self.list.get(self.index(episode)?)
    }
}

/// What stands for all episodes in the tables, beside the names of the strata.
pub const ALL: &str = "all";

/// How the random numbers of the episodes are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// Independently.
    Independent,
    /// In Latin hypercubes, so many.
    LatinHypercube {
        /// Hypercubes, at least 1; they divide the episodes.
        replicates: u32,
    },
    /// In scrambled Sobol nets, so many.
    Sobol {
        /// Nets, at least 1; they divide the episodes into powers of two.
        replicates: u32,
    },
}

impl Sampling {
    /// The design.
    #[must_use]
    pub fn design(self) -> Design {
        match self {
            Self::Independent => Design::Independent,
            Self::LatinHypercube { .. } => Design::LatinHypercube,
            Self::Sobol { .. } => Design::Sobol,
        }
    }

    /// Independent repetitions of the design; none of independent numbers.
    #[must_use]
    pub fn replicates(self) -> Option<u32> {
        match self {
            Self::Independent => None,
            Self::LatinHypercube { replicates } | Self::Sobol { replicates } => Some(replicates),
        }
    }

    /// An episode's replicate, and its place in it: they take turns, so that what is simulated of a run that ends early
    /// is balanced.
    #[must_use]
    pub fn place(self, episode: u32) -> Option<(u32, u32)> {
        let replicates = self.replicates()?.max(1);
        Some((episode % replicates, episode / replicates))
    }
}

/// When a run may end before its last episode.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// The controller whose failures decide, by index.
    pub controller: usize,
    /// Any of these is enough; at least one.
    pub goals: Vec<Goal>,
    /// How sure the bounds are, whenever the run ends.
    pub confidence: f64,
    /// Episodes between two looks at them, at least 1.
    pub every: u32,
}

/// What is to be known of a failure rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// That it is below this.
    Below(f64),
    /// That it is above this.
    Above(f64),
    /// The rate itself, give or take this.
    HalfWidth(f64),
}
