//! Values as the text of a JSON file.

use serde::Serialize;

/// A value as the text of a file, for people too.
///
/// # Errors
/// If it cannot be encoded.
pub fn pretty(value: &impl Serialize) -> Result<Vec<u8>, serde_json::Error> {
    let mut bytes = serde_json::to_vec_pretty(value)?;
    bytes.push(b'\n');
    Ok(bytes)
}
