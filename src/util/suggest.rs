//! Suggests the closest known name for a misspelt one.

/// The known name that is nearest to an unknown one, if it is near.
pub(crate) fn nearest<'a>(
    unknown: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    known
        .into_iter()
        .map(|known| {
            let similarity = strsim::normalized_damerau_levenshtein(unknown, known);
            (similarity, known)
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(similarity, _)| *similarity >= 0.5)
        .map(|(_, known)| known)
}

/// The nearest known name as a question, or `otherwise` where none is near.
pub(crate) fn did_you_mean<'a>(
    unknown: &str,
    known: impl IntoIterator<Item = &'a str>,
    otherwise: &str,
) -> String {
    nearest(unknown, known).map_or_else(
        || otherwise.to_string(),
        |name| format!("did you mean {name:?}?"),
    )
}
