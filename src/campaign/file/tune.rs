//! `[tune]`: what `urts-mc tune` searches.

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use std::fmt;

/// `[tune]`: a measure is a name with the channels that it is of (default: all, one after the other) and, where it
/// differs from episode to episode, a quantile: "rmse position p50", "delay_margin_ms", "failure_rate".
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TuneFile {
    /// Measures whose sum is to be small, several in units of their limits in `[verdict]`; "2 * rmse position p50"
    /// counts twice.
    pub minimise: Texts,
    /// What has to hold, such as "delay_margin_ms >= 7" (default: nothing).
    pub limits: Option<Texts>,
    /// No margin and no noise gain may be worse than that of this controller (default: no matter).
    pub margins_of: Option<String>,
    /// The largest command (95th percentile) may not be larger than that of this controller (default: no matter).
    pub commands_of: Option<String>,
    /// Candidates, at most (default 2000).
    pub budget: Option<u32>,
    /// Episodes under which each candidate is tried; others in every generation (default 64).
    pub episodes: Option<u32>,
    /// Fresh episodes under which the result is confirmed (default 1024).
    pub confirmation: Option<u32>,
}

/// A text, or a list of texts.
#[derive(Debug, Clone, PartialEq, Eq, JsonSchema)]
#[schemars(untagged)]
pub enum Texts {
    /// One.
    One(String),
    /// Several.
    Several(Vec<String>),
}

impl Texts {
    /// Each with its key.
    pub(in crate::campaign) fn keyed(&self, key: &str) -> Vec<(String, &str)> {
        match self {
            Self::One(text) => vec![(key.to_string(), text)],
            Self::Several(texts) => {
                let texts = texts.iter().enumerate();
                texts
                    .map(|(index, text)| (format!("{key}[{index}]"), text.as_str()))
                    .collect()
            }
        }
    }
}

impl<'de> Deserialize<'de> for Texts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TextsVisitor;
        impl<'de> Visitor<'de> for TextsVisitor {
            type Value = Texts;
            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("a text such as \"rmse position p50\", or a list of such")
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Texts, E> {
                Ok(Texts::One(text.to_string()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Texts, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Texts::Several)
            }
        }
        deserializer.deserialize_any(TextsVisitor)
    }
}
