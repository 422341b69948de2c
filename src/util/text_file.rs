//! Text that people wrote: UTF-8, with or without a byte order mark, and what to do where it is something else.

use std::fs;
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

/// The text of a file, without a byte order mark.
///
/// # Errors
/// If it cannot be read, or is no UTF-8: the error says what it looks like and how to mend it.
pub(crate) fn read_text(path: &Path) -> Result<String> {
    let bytes = fs::read(path)?;
    let utf_16 = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]);
    match String::from_utf8(bytes) {
        Ok(text) => Ok(without_mark(&text).to_string()),
        Err(_) if utf_16 => Err(Error::new(
            ErrorKind::InvalidData,
            "it is UTF-16; save it as UTF-8",
        )),
        Err(error) => {
            let valid = error.utf8_error().valid_up_to();
            let bytes = error.as_bytes();
            let line = 1 + bytes[..valid].iter().filter(|byte| **byte == b'\n').count();
            let byte = bytes.get(valid).copied().unwrap_or_default();
            let looks = format!(
                "it is no UTF-8: the byte 0x{byte:02X} in line {line} looks like Latin-1; save it as UTF-8"
            );
            Err(Error::new(ErrorKind::InvalidData, looks))
        }
    }
}

/// A text without the byte order mark that some editors put in front.
pub(crate) fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// Characters of a line that an error quotes.
const QUOTED: usize = 200;

/// Some lines as an error quotes them: what is longer than that is cut, and marks below it, that would point at what is
/// not shown, are left out.
pub(crate) fn quoted(text: &str) -> String {
    let cut = |line: &str| match line.char_indices().nth(QUOTED) {
        Some(_) if line.trim_start_matches([' ', '|']).starts_with('^') => None,
        Some((end, _)) => Some(format!("{} ...", &line[..end])),
        None => Some(line.to_string()),
    };
    let lines: Vec<String> = text.split('\n').filter_map(cut).collect();
    lines.join("\n")
}
