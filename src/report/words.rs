//! Numbers as a report writes them.

/// A share in percent with its interval.
pub(crate) fn rate(value: f64, interval: Option<[f64; 2]>) -> String {
    match interval {
        _ if !value.is_finite() => "-".to_string(),
        Some([lower, upper]) => format!(
            "{} % [{}, {}]",
            percent(value),
            percent(lower),
            percent(upper)
        ),
        None => format!("{} %", percent(value)),
    }
}

/// A correlation with its interval.
pub(crate) fn correlation(value: f64, interval: Option<[f64; 2]>) -> String {
    match interval {
        Some([lower, upper]) => format!("{value:+.2} [{lower:+.2}, {upper:+.2}]"),
        None => format!("{value:+.2}"),
    }
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent != 0.0 && percent < 10.0 {
        format!("{percent:.2}")
    } else {
        format!("{percent:.1}")
    }
}

/// A quantity with four digits that count; a dash for none.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    match () {
        () if value.is_nan() => "-".to_string(),
        () if value.is_infinite() => if value > 0.0 { "∞" } else { "-∞" }.to_string(),
        () if size == 0.0 => "0".to_string(),
        () if !(1e-3..1e5).contains(&size) => format!("{value:.2e}"),
        () if size >= 1000.0 => format!("{value:.0}"),
        () if size >= 100.0 => format!("{value:.1}"),
        () if size >= 10.0 => format!("{value:.2}"),
        () if size >= 1.0 => format!("{value:.3}"),
        () => format!("{value:.4}"),
    }
}

/// A quantity with its interval.
pub(crate) fn measured(value: f64, lower: f64, upper: f64) -> String {
    if lower.is_nan() || upper.is_nan() {
        return number(value);
    }
    format!("{} [{}, {}]", number(value), number(lower), number(upper))
}

/// A p-value.
pub(crate) fn p_value(p: f64) -> String {
    match () {
        () if p.is_nan() => "-".to_string(),
        () if p < 1e-4 => "< 0.0001".to_string(),
        () => format!("{p:.4}"),
    }
}
