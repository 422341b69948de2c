//! Values that have several forms, read by hand: serde's untagged enums would hide what is wrong with a value, and its
//! structs would take a list for a table.

use crate::campaign::parameter::SamplingScope;
use crate::util::fixed_list::List;
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::value::{Error as PlainError, MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error, IntoDeserializer, MapAccess, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// A number for all channels, or a list with one number per channel.
#[derive(Debug, Clone, JsonSchema)]
#[schemars(untagged)]
pub enum Numbers {
    /// The same for all channels.
    One(f64),
    /// One per channel.
    List(Vec<f64>),
}

/// A number, a distribution, or a list with one of them per channel.
#[derive(Debug, Clone, JsonSchema)]
#[schemars(untagged)]
pub enum Value {
    /// A constant.
    Number(f64),
    /// A distribution.
    Distribution(DistributionFile),
    /// One per channel.
    List(Vec<Value>),
}

/// A distribution: exactly one of the forms, and how often it is drawn.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DistributionFile {
    /// [low, high]
    pub uniform: Option<List<f64, 2>>,
    /// [low, high], both positive; uniform in the logarithm.
    pub log_uniform: Option<List<f64, 2>>,
    /// Normal.
    #[serde(default, deserialize_with = "some_table")]
    pub normal: Option<NormalFile>,
    /// Normal, restricted to an interval.
    #[serde(default, deserialize_with = "some_table")]
    pub truncated_normal: Option<TruncatedNormalFile>,
    /// One of these values.
    pub choice: Option<Vec<f64>>,
    /// Relative weights of `choice` (default: equal).
    pub weights: Option<Vec<f64>>,
    /// Drawn once per "episode", "agent" or "channel".
    #[serde(default, deserialize_with = "some_word")]
    pub per: Option<SamplingScope>,
}

/// `normal`
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NormalFile {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub std: f64,
}

/// `truncated_normal`
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TruncatedNormalFile {
    /// Mean before truncation.
    pub mean: f64,
    /// Standard deviation before truncation.
    pub std: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// The channels of a fault.
#[derive(Debug, Clone, JsonSchema)]
#[schemars(untagged)]
pub enum ChannelsFile {
    /// "all", or "one" for a random channel per agent.
    Word(String),
    /// Channel numbers from 1.
    Numbers(Vec<u32>),
    /// Names of channels.
    Names(Vec<String>),
    /// A list with something else in it, as it was written: no channels, but the names of the agent's are known only
    /// where it is refused.
    #[schemars(skip)]
    Others(Vec<String>),
}

/// A word, or a list in its place.
#[derive(Debug, Clone, JsonSchema)]
#[schemars(untagged, inline)]
pub enum WordOr<W, L> {
    /// One of some words.
    Word(W),
    /// A list.
    List(L),
}

/// A value as a campaign file would say it.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => f.write_str(&in_toml(*number)),
            Self::Distribution(distribution) => distribution.fmt(f),
            Self::List(values) => {
                let values: Vec<String> = values.iter().map(Self::to_string).collect();
                write!(f, "[{}]", values.join(", "))
            }
        }
    }
}

impl fmt::Display for DistributionFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |values: &[f64]| {
            let values: Vec<String> = values.iter().copied().map(in_toml).collect();
            format!("[{}]", values.join(", "))
        };
        let table = |pairs: &[(&str, f64)]| {
            let pairs: Vec<String> = pairs
                .iter()
                .map(|(name, value)| format!("{name} = {}", in_toml(*value)))
                .collect();
            format!("{{ {} }}", pairs.join(", "))
        };
        let normal = |normal: &NormalFile| table(&[("mean", normal.mean), ("std", normal.std)]);
        let truncated = |normal: &TruncatedNormalFile| {
            table(&[
                ("mean", normal.mean),
                ("std", normal.std),
                ("low", normal.low),
                ("high", normal.high),
            ])
        };
        let forms: Vec<String> = [
            ("uniform", self.uniform.map(|ends| list(&ends.0))),
            ("log_uniform", self.log_uniform.map(|ends| list(&ends.0))),
            ("normal", self.normal.as_ref().map(normal)),
            (
                "truncated_normal",
                self.truncated_normal.as_ref().map(truncated),
            ),
            ("choice", self.choice.as_deref().map(list)),
            ("weights", self.weights.as_deref().map(list)),
            ("per", self.per.map(|per| format!("{:?}", per.name()))),
        ]
        .into_iter()
        .filter_map(|(name, form)| form.map(|form| format!("{name} = {form}")))
        .collect();
        write!(f, "{{ {} }}", forms.join(", "))
    }
}

/// A number as TOML writes it.
pub(crate) fn in_toml(number: f64) -> String {
    if number.is_nan() {
        "nan".to_string()
    } else {
        format!("{number:?}")
    }
}

/// A table; a list is refused.
pub(super) fn table<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<T, D::Error> {
    struct TableVisitor<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for TableVisitor<T> {
        type Value = T;
        fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
            formatter.write_str("a table of keys and values")
        }
        fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<T, A::Error> {
            T::deserialize(MapAccessDeserializer::new(table))
        }
    }
    deserializer.deserialize_any(TableVisitor(PhantomData))
}

/// A table that may be absent.
pub(super) fn some_table<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    table(deserializer).map(Some)
}

/// A list of tables.
pub(super) fn tables<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    struct Item<T>(T);
    impl<'de, T: Deserialize<'de>> Deserialize<'de> for Item<T> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            table(deserializer).map(Self)
        }
    }
    struct TablesVisitor<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for TablesVisitor<T> {
        type Value = Vec<T>;
        fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
            formatter.write_str("a list of tables, each headed by its name in [[double brackets]]")
        }
        fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
            let mut items = Vec::new();
            while let Some(Item(item)) = list.next_element()? {
                items.push(item);
            }
            Ok(items)
        }
    }
    deserializer.deserialize_any(TablesVisitor(PhantomData))
}

/// A list of tables that may be absent.
pub(super) fn some_tables<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<Vec<T>>, D::Error> {
    tables(deserializer).map(Some)
}

/// The words of an enum: serde tells them only to whom takes none of them.
fn words<'de, T: Deserialize<'de>>() -> String {
    let none: Result<T, PlainError> = T::deserialize("".into_deserializer());
    let said = none.err().map(|error| error.to_string());
    let words = said
        .as_deref()
        .and_then(|said| said.split_once(", expected "));
    words
        .map_or("a word in quotes", |(_, words)| words)
        .to_string()
}

/// One of several words; anything else is refused with all of them.
pub(super) fn word<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<T, D::Error> {
    struct WordVisitor<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for WordVisitor<T> {
        type Value = T;
        fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
            formatter.write_str(&words::<T>())
        }
        fn visit_str<E: Error>(self, word: &str) -> Result<T, E> {
            T::deserialize(word.into_deserializer())
        }
    }
    deserializer.deserialize_any(WordVisitor(PhantomData))
}

impl<'de, W: Deserialize<'de>, L: Deserialize<'de>> Deserialize<'de> for WordOr<W, L> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct WordOrVisitor<W, L>(PhantomData<(W, L)>);
        impl<'de, W: Deserialize<'de>, L: Deserialize<'de>> Visitor<'de> for WordOrVisitor<W, L> {
            type Value = WordOr<W, L>;
            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                write!(formatter, "{} or a list", words::<W>())
            }
            fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
                W::deserialize(word.into_deserializer()).map(WordOr::Word)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
                L::deserialize(SeqAccessDeserializer::new(list)).map(WordOr::List)
            }
        }
        deserializer.deserialize_any(WordOrVisitor(PhantomData))
    }
}

/// A word that may be absent.
pub(super) fn some_word<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    word(deserializer).map(Some)
}

/// Visits of a number, however it is written.
macro_rules! numbers {
    ($number:expr) => {
        fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
            Ok($number(value))
        }
        #[expect(
            clippy::cast_precision_loss,
            reason = "an integer in a campaign stands for a real number"
        )]
        fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
            Ok($number(value as f64))
        }
    };
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ValueVisitor;
        impl<'de> Visitor<'de> for ValueVisitor {
            type Value = Value;
            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("a number, a list with one value per channel, or a distribution such as { uniform = [0, 1] }")
            }
            numbers!(Value::Number);
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Value, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Value::List)
            }
            fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<Value, A::Error> {
                DistributionFile::deserialize(MapAccessDeserializer::new(table))
                    .map(Value::Distribution)
            }
        }
        deserializer.deserialize_any(ValueVisitor)
    }
}

impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumbersVisitor;
        impl<'de> Visitor<'de> for NumbersVisitor {
            type Value = Numbers;
            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("a number, or a list with one number per channel")
            }
            numbers!(Numbers::One);
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Numbers, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Numbers::List)
            }
        }
        deserializer.deserialize_any(NumbersVisitor)
    }
}

/// An entry of a list of channels.
enum ChannelFile {
    Number(u32),
    Name(String),
    /// Neither, as it was written.
    Other(String),
}

impl<'de> Deserialize<'de> for ChannelFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ChannelVisitor;
        impl Visitor<'_> for ChannelVisitor {
            type Value = ChannelFile;
            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("a channel's name or number, from 1")
            }
            fn visit_i64<E: Error>(self, value: i64) -> Result<ChannelFile, E> {
                let other = |_| ChannelFile::Other(value.to_string());
                Ok(u32::try_from(value).map_or_else(other, ChannelFile::Number))
            }
            fn visit_f64<E: Error>(self, value: f64) -> Result<ChannelFile, E> {
                Ok(ChannelFile::Other(in_toml(value)))
            }
            fn visit_str<E: Error>(self, word: &str) -> Result<ChannelFile, E> {
                Ok(ChannelFile::Name(word.to_string()))
            }
        }
        deserializer.deserialize_any(ChannelVisitor)
    }
}

impl<'de> Deserialize<'de> for ChannelsFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ChannelsVisitor;
        impl<'de> Visitor<'de> for ChannelsVisitor {
            type Value = ChannelsFile;
            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str(
                    "\"all\", \"one\", or a list of channels such as [\"x\", \"yaw\"] or [1, 6]",
                )
            }
            fn visit_str<E: Error>(self, word: &str) -> Result<ChannelsFile, E> {
                Ok(ChannelsFile::Word(word.to_string()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<ChannelsFile, A::Error> {
                let list: Vec<ChannelFile> = Vec::deserialize(SeqAccessDeserializer::new(list))?;
                let number = |channel: &ChannelFile| match channel {
                    ChannelFile::Number(number) => Some(*number),
                    ChannelFile::Name(_) | ChannelFile::Other(_) => None,
                };
                let name = |channel: &ChannelFile| match channel {
                    ChannelFile::Name(name) => Some(name.clone()),
                    ChannelFile::Number(_) | ChannelFile::Other(_) => None,
                };
                let written = |channel: &ChannelFile| match channel {
                    ChannelFile::Number(number) => number.to_string(),
                    ChannelFile::Name(name) => format!("{name:?}"),
                    ChannelFile::Other(text) => text.clone(),
                };
                let numbers: Option<Vec<u32>> = list.iter().map(number).collect();
                let names: Option<Vec<String>> = list.iter().map(name).collect();
                Ok(match (numbers, names) {
                    (Some(numbers), _) => ChannelsFile::Numbers(numbers),
                    (None, Some(names)) => ChannelsFile::Names(names),
                    (None, None) => ChannelsFile::Others(list.iter().map(written).collect()),
                })
            }
        }
        deserializer.deserialize_any(ChannelsVisitor)
    }
}
