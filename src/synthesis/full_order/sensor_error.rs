//! What can be wrong with the sensors of a group of channels.

use thiserror::Error;

/// A value of the table of sensors that is out of its limits, or a contradiction.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{key} = {value}: {limit}; {remedy}")]
pub struct SensorError {
    /// The key within the table.
    pub key: String,
    /// The value as it was understood.
    pub value: String,
    /// The limit that it breaks.
    pub limit: String,
    /// What to write instead.
    pub remedy: String,
}

impl SensorError {
    pub(super) fn new(
        key: impl Into<String>,
        value: impl Into<String>,
        limit: &str,
        remedy: &str,
    ) -> Self {
        Self {
            key: key.into(),
            value: value.into(),
            limit: limit.to_string(),
            remedy: remedy.to_string(),
        }
    }
}
