//! XML to links and joints, and where in the file an error is.

use crate::agent::robot::error::RobotError;
use std::path::Path;
use urdf_rs::Robot;

/// The links and joints of a URDF.
pub(super) fn read(text: &str, path: &Path) -> Result<Robot, RobotError> {
    urdf_rs::read_from_string(text).map_err(|error| {
        let error = error.to_string();
        let place = place_of(text, &error).unwrap_or_default();
        let remedy = if text.contains("<xacro:") {
            "expand the file with xacro first"
        } else if error.contains("missing field") {
            "add this element or attribute"
        } else {
            "write it as URDF and XML require"
        };
        let message = error.strip_prefix("custom: ").unwrap_or(&error);
        RobotError::Syntax {
            path: path.to_path_buf(),
            message: format!("{place}{message}; {remedy}"),
        }
    })
}

/// Line and start tag of the link or joint that causes an error: the first one that, read alone, is not closed or
/// causes the same. The reader itself does not say.
fn place_of(text: &str, error: &str) -> Option<String> {
    let mut starts: Vec<(usize, &str)> = ["link", "joint"]
        .into_iter()
        .flat_map(|tag| text.match_indices(tag))
        .filter(|(at, _)| text[..*at].ends_with('<'))
        .map(|(at, tag)| (at - 1, tag))
        .collect();
    starts.sort_unstable();
    let (at, _) = starts.into_iter().find(|(at, tag)| {
        let Some(element) = element(&text[*at..], tag) else {
            return true;
        };
        let alone = format!("<robot name=\"\">{element}</robot>");
        urdf_rs::read_from_string(&alone).is_err_and(|alone| alone.to_string() == error)
    })?;
    let line = text[..at].matches('\n').count() + 1;
    let tag = text[at..].split_inclusive('>').next()?;
    Some(format!("line {line}, {tag}: "))
}

/// The element with which a text begins.
fn element<'a>(text: &'a str, tag: &str) -> Option<&'a str> {
    let opened = text.find('>')?;
    if text[..opened].ends_with('/') {
        return text.get(..=opened);
    }
    let close = format!("</{tag}>");
    text.find(&close)
        .and_then(|closed| text.get(..closed + close.len()))
}
