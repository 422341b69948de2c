//! What the metadata of a Parquet file says: where its rows come from, and of which types they are.

use super::manifest::campaign_hash;
use crate::campaign::Campaign;
use crate::results::dictionary::unit;
use polars::prelude::{ArrowDataType, ArrowSchema, CompatLevel, DataFrame, SchemaExt};
use polars_parquet::write::schema_to_metadata_key;

/// Labels of the tables of a campaign: `urts-mc.campaign`, `.campaign_blake3`, `.seed`, `.version`, and the unit of
/// each column that has one as `urts-mc.unit.<column>`.
#[derive(Debug, Clone)]
pub struct Labels {
    /// The table's name in the data dictionary.
    table: &'static str,
    common: Vec<(String, String)>,
}

impl Labels {
    /// Of a table of a campaign, by its name in the data dictionary.
    #[must_use]
    pub fn new(campaign: &Campaign, table: &'static str) -> Self {
        let label = |name: &str, value: String| (format!("urts-mc.{name}"), value);
        Self {
            table,
            common: vec![
                label("campaign", campaign.name.clone()),
                label("campaign_blake3", campaign_hash(campaign)),
                label("seed", campaign.seed.to_string()),
                label("version", env!("CARGO_PKG_VERSION").to_string()),
            ],
        }
    }

    /// Those of a table of the campaign, and its types as every reader knows them: text that the encoder holds as views
    /// is named plain text, of which the file's bytes are the same.
    pub(super) fn of(&self, frame: &DataFrame) -> Vec<(String, String)> {
        let types = frame.schema().to_arrow(CompatLevel::oldest());
        let types = types.into_iter().map(|(name, mut field)| {
            if field.dtype == ArrowDataType::LargeUtf8 {
                field.dtype = ArrowDataType::Utf8;
            }
            (name, field)
        });
        let types = schema_to_metadata_key(&types.collect::<ArrowSchema>());
        let types = (types.key, types.value.unwrap_or_default());
        let names = frame.get_column_names();
        let units = names.into_iter().filter_map(|name| {
            let unit = unit(self.table, name)?;
            Some((format!("urts-mc.unit.{name}"), unit.to_string()))
        });
        [types]
            .into_iter()
            .chain(self.common.iter().cloned())
            .chain(units)
            .collect()
    }
}
