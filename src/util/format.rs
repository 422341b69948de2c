//! Numbers as reports and the terminal write them.

/// A size, in the unit that people read it in.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "three digits of it are shown")]
pub fn bytes(count: u64) -> String {
    let units = ["kB", "MB", "GB", "TB"];
    let (mut size, mut unit) = (count as f64 / 1e3, 0);
    while size >= 999.5 && unit + 1 < units.len() {
        size /= 1e3;
        unit += 1;
    }
    format!("{} {}", digits(size, 3), units[unit])
}

/// A share in percent.
#[must_use]
pub fn share(value: f64) -> String {
    format!("{} %", percent(value))
}

/// A length of time in its two largest units.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "what is longer than can be counted is the longest"
)]
pub fn time(seconds: f64) -> String {
    let whole = seconds.max(0.0).ceil() as u64;
    let [days, hours, minutes] = [86_400, 3_600, 60].map(|unit| whole / unit);
    match (days, hours, minutes) {
        (0, 0, 0) => format!("{whole} s"),
        (0, 0, minutes) => format!("{minutes} min {} s", whole % 60),
        (0, hours, minutes) => format!("{hours} h {} min", minutes % 60),
        (days, hours, _) => format!("{days} d {} h", hours % 24),
    }
}

/// A share in percent with its interval.
#[must_use]
pub fn rate(value: f64, interval: Option<[f64; 2]>) -> String {
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

/// An upper bound with so many decimals: never below what was proved.
#[must_use]
pub fn rounded_up(bound: f64, decimals: usize) -> String {
    let nearest = format!("{bound:.decimals$}");
    if nearest.parse().is_ok_and(|nearest: f64| nearest < bound) {
        let last = 0.1_f64.powi(i32::try_from(decimals).unwrap_or(i32::MAX));
        return format!("{:.decimals$}", bound + 0.5 * last);
    }
    nearest
}

/// An upper bound of a share, in percent.
#[must_use]
pub fn at_most(share: f64) -> String {
    let percent = 100.0 * share;
    match percent.is_finite() {
        true => format!("{} %", rounded_up(percent, decimals_of(percent))),
        false => "-".to_string(),
    }
}

/// A difference of shares in percentage points with its interval, signs written out.
#[must_use]
pub fn points(value: f64, lower: f64, upper: f64) -> String {
    let [value, lower, upper] = [value, lower, upper].map(|share| 100.0 * share);
    if lower.is_nan() || upper.is_nan() {
        return format!("{value:+.1}");
    }
    format!("{value:+.1} [{lower:+.1}, {upper:+.1}]")
}

/// A correlation with its interval.
#[must_use]
pub fn correlation(value: f64, interval: Option<[f64; 2]>) -> String {
    match interval {
        Some([lower, upper]) => format!("{value:+.2} [{lower:+.2}, {upper:+.2}]"),
        None => format!("{value:+.2}"),
    }
}

/// A computed number without the dust of binary fractions: 12 digits of it.
#[must_use]
pub fn without_dust(number: f64) -> f64 {
    format!("{number:.11e}").parse().unwrap_or(number)
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    format!("{percent:.*}", decimals_of(percent))
}

fn decimals_of(percent: f64) -> usize {
    if percent != 0.0 && percent < 10.0 {
        2
    } else {
        1
    }
}

/// A quantity with four digits that count; a dash for none.
#[must_use]
pub fn number(value: f64) -> String {
    digits(value, 4)
}

/// A quantity with so many digits that count; a dash for none.
#[must_use]
pub fn digits(value: f64, count: usize) -> String {
    let size = value.abs();
    let decimals = count.saturating_sub(1);
    match () {
        () if value.is_nan() => "-".to_string(),
        () if value.is_infinite() => if value > 0.0 { "∞" } else { "-∞" }.to_string(),
        () if size == 0.0 => "0".to_string(),
        () if !(1e-3..1e5).contains(&size) => format!("{value:.decimals$e}"),
        () => {
            let before = [1.0, 10.0, 100.0, 1e3, 1e4].into_iter();
            let before = before.filter(|power| size >= *power).count();
            let zeros = [0.1, 0.01]
                .into_iter()
                .filter(|power| size < *power)
                .count();
            format!("{value:.*}", (count + zeros).saturating_sub(before))
        }
    }
}

/// A quantity with its interval.
#[must_use]
pub fn measured(value: f64, lower: f64, upper: f64) -> String {
    if lower.is_nan() || upper.is_nan() {
        return number(value);
    }
    format!("{} [{}, {}]", number(value), number(lower), number(upper))
}

/// A p-value.
#[must_use]
pub fn p_value(p: f64) -> String {
    match () {
        () if p.is_nan() => "-".to_string(),
        () if p < 1e-4 => "< 0.0001".to_string(),
        () => format!("{p:.4}"),
    }
}

/// A phrase as a sentence: with a capital and a full stop.
#[must_use]
pub fn sentence(phrase: &str) -> String {
    let mut letters = phrase.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string());
    format!("{}{}.", first.unwrap_or_default(), letters.as_str())
}
