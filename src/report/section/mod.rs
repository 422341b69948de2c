//! What a report says, section by section.

pub(crate) mod band;
pub(crate) mod conditions;
pub(crate) mod errors;
pub(crate) mod failures;
pub(crate) mod fairness;
pub(crate) mod flights;
pub(crate) mod gains;
pub(crate) mod provenance;
pub(crate) mod strata;
