//! The file of a part: what it holds, in a line that says so, and the bytes of its episodes, under a hash of both.

use crate::simulation::Segment;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// What a part begins with: the version of the format, then its hash.
const MAGIC: &str = "urts-mc part 1 ";
/// Letters of a hash.
const HASH: usize = 64;
/// Bytes of the line that says what a part holds, at most.
const LONGEST: u64 = 1 << 16;

/// What a part holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Header {
    /// Hash of the plan that its episodes are of.
    pub(crate) plan: String,
    /// Its episodes, the first ones of its range, and what simulated them.
    pub(crate) segments: Vec<Segment>,
    /// The programs that simulated them.
    pub(crate) programs: Vec<String>,
    /// How long they took, s.
    pub(crate) loop_s: f64,
    /// When the last ended, s since 1970.
    pub(crate) ended_unix_s: u64,
    /// Bytes of its episodes.
    pub(crate) bytes: u64,
}

impl Header {
    /// How many episodes.
    pub(crate) fn episodes(&self) -> u32 {
        let all = self.segments.iter().map(|own| own.episodes);
        all.fold(0, u32::saturating_add)
    }
}

/// A part as it is written.
pub(crate) fn encoded(header: &Header, episodes: &[u8]) -> Result<Vec<u8>, serde_json::Error> {
    let mut text = serde_json::to_string(header)?;
    text.push('\n');
    let hash = hash(text.as_bytes(), episodes);
    let mut bytes = format!("{MAGIC}{hash}\n{text}").into_bytes();
    bytes.extend(episodes);
    Ok(bytes)
}

/// What a part says that it holds, which nothing has been compared with but its size.
///
/// # Errors
/// Why it is no part, in words.
pub(crate) fn header(path: &Path) -> Result<Header, String> {
    let (file, _, text) = opened(path)?;
    let header = parsed(&text)?;
    let metadata = file.get_ref().metadata();
    let size = metadata.map_err(|error| error.to_string())?.len();
    let before = (MAGIC.len() + HASH + 1 + text.len()) as u64;
    match size.checked_sub(before) == Some(header.bytes) {
        true => Ok(header),
        false => Err("it is not as long as it was written".to_string()),
    }
}

/// A part, whose bytes are those that were written.
///
/// # Errors
/// Why it is none, in words.
pub(crate) fn read(path: &Path) -> Result<(Header, Vec<u8>), String> {
    let (mut file, expected, text) = opened(path)?;
    let mut episodes = Vec::new();
    let read = file.read_to_end(&mut episodes);
    read.map_err(|error| error.to_string())?;
    if hash(text.as_bytes(), &episodes) != expected {
        return Err("its content was changed".to_string());
    }
    Ok((parsed(&text)?, episodes))
}

/// A part's file behind its header, with the hash that it names and the header's line.
fn opened(path: &Path) -> Result<(BufReader<File>, String, String), String> {
    let said = |error: std::io::Error| error.to_string();
    let mut file = BufReader::new(File::open(path).map_err(said)?);
    let [mut first, mut text] = [String::new(), String::new()];
    let mut begin = (&mut file).take(LONGEST);
    begin.read_line(&mut first).map_err(said)?;
    begin.read_line(&mut text).map_err(said)?;
    let hash = first
        .strip_prefix(MAGIC)
        .and_then(|own| own.strip_suffix('\n'));
    match hash.filter(|own| own.len() == HASH) {
        Some(hash) => Ok((file, hash.to_string(), text)),
        None => Err("it is no part of a run of this version".to_string()),
    }
}

fn parsed(text: &str) -> Result<Header, String> {
    serde_json::from_str(text).map_err(|error| format!("its first lines: {error}"))
}

fn hash(text: &[u8], episodes: &[u8]) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(text);
    hasher.update(episodes);
    hasher.finalize().to_hex().to_string()
}
