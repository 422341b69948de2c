//! `[[strata]]`, `[sampling]`, `[stop]`, `[output]` and `[[require]]`: which episodes meet what, how their numbers are
//! drawn, when enough is known, what is written, and what has to be.

use super::super::plan::Detail;
use super::value::some_word;
use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// `[[strata]]`
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StratumFile {
    /// Its name in the tables (default: the names of its faults, "none" or "mixed"). "each" has the names of the
    /// faults.
    pub name: Option<String>,
    /// The faults of its episodes.
    pub faults: StratumFaultsFile,
    /// How many episodes it has, relative to the other strata: a whole number (default 1).
    pub share: Option<u32>,
}

/// `[sampling]`
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SamplingFile {
    /// How the random numbers of the episodes are chosen (default "independent").
    #[serde(default, deserialize_with = "some_word")]
    pub design: Option<DesignFile>,
    /// Independent repetitions of the design, whose scatter gives its intervals (default 8).
    pub replicates: Option<u32>,
}

/// How random numbers are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DesignFile {
    /// Independently: every statistic holds.
    Independent,
    /// Latin hypercubes: each of n equally likely ranges of every quantity once in n episodes.
    LatinHypercube,
    /// Scrambled Sobol nets of 2^m episodes: that, and pairs of quantities evenly too.
    Sobol,
}

/// `[stop]`: any of the goals ends the run.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StopFile {
    /// The controller whose failures decide.
    pub controller: String,
    /// Goal: the failure rate is proved to be below this.
    pub failure_rate_below: Option<f64>,
    /// Goal: the failure rate is proved to be above this.
    pub failure_rate_above: Option<f64>,
    /// Goal: the interval of the failure rate is no wider than twice this.
    pub half_width: Option<f64>,
    /// How sure that is to be, although the run is looked at again and again (default 0.95).
    pub confidence: Option<f64>,
    /// Episodes between two looks (default 64).
    pub every: Option<u32>,
}

/// `[output]`: what the run writes.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputFile {
    /// Which of the tables that grow with the episodes (default "all"): "episodes" leaves out those of channels, faults
    /// and conditions, "summary" all four.
    #[serde(default)]
    pub detail: Detail,
}

/// `[[require]]`: a limit that has to be proved, with 95 % confidence where chance is in it.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RequireFile {
    /// The controller that has to meet it.
    pub controller: String,
    /// The stratum in which it has to (default: all episodes).
    pub stratum: Option<String>,
    /// In short for measure = "failure_rate" and at_most: upper limit of the one-sided 95 % bound of the failure rate.
    pub failure_rate_upper_95: Option<f64>,
    /// What is measured: a name with the channels that it is of (default: all, one after the other) and, where it
    /// differs from episode to episode, a quantile: "rmse position p95", "survival_at_s 10", "delay_margin_ms".
    pub measure: Option<String>,
    /// Compared with another controller on the same episodes: the measure is of the ratio to that controller's number.
    pub ratio_to: Option<String>,
    /// The same of the difference from that controller's number.
    pub difference_to: Option<String>,
    /// Upper limit: the measure's one-sided 95 % upper bound may not be above it.
    pub at_most: Option<f64>,
    /// Lower limit: the measure's one-sided 95 % lower bound may not be below it.
    pub at_least: Option<f64>,
}

/// The faults of a stratum's episodes.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(untagged)]
pub enum StratumFaultsFile {
    /// "each": one stratum per fault, in which every agent has it (but those whose probability is 0) and no other;
    /// "all": every fault with its own probability.
    Word(String),
    /// Names of faults that every agent has (but those whose probability is 0); it has no other. None at all: [].
    Names(Vec<String>),
}

impl<'de> Deserialize<'de> for StratumFaultsFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct FaultsVisitor;
        impl<'de> Visitor<'de> for FaultsVisitor {
            type Value = StratumFaultsFile;
            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str(
                    "\"each\", \"all\", or a list of names of faults such as [\"actuator bias\"]",
                )
            }
            fn visit_str<E: Error>(self, word: &str) -> Result<StratumFaultsFile, E> {
                Ok(StratumFaultsFile::Word(word.to_string()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<StratumFaultsFile, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(StratumFaultsFile::Names)
            }
        }
        deserializer.deserialize_any(FaultsVisitor)
    }
}
