//! The labels of an axis's ticks.

use kuva::render::layout::TickFormat;
use std::sync::Arc;

/// How the ticks of an axis are written: with as many digits as tell them apart.
pub(super) fn format_of(range: (f64, f64), logarithmic: bool) -> TickFormat {
    TickFormat::Custom(Arc::new(move |value| tick(value, range, logarithmic)))
}

fn tick(value: f64, (low, high): (f64, f64), logarithmic: bool) -> String {
    let size = value.abs();
    if logarithmic && !is_labelled(value, (low, high)) {
        return String::new();
    }
    if size != 0.0
        && !(1e-3..1e5).contains(&size)
        && (logarithmic || high - low >= 1e5 || high - low < 1e-3)
    {
        return format!("{value:.1e}").replace(".0e", "e");
    }
    let digits = if logarithmic {
        -size.log10().floor()
    } else {
        // One more than the distance of the ticks has, for those at quarters; zeros at the end are cut.
        (-((high - low) / 4.0).log10()).ceil() + 1.0
    };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a few digits"
    )]
    let digits = digits.clamp(0.0, 8.0) as usize;
    let text = format!("{value:.digits$}");
    let short = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &*text,
    };
    match short {
        "-0" => "0".to_string(),
        short => short.to_string(),
    }
}

/// Whether a tick of a logarithmic axis has a label: over many decades only every so many, and nothing between them.
fn is_labelled(value: f64, (low, high): (f64, f64)) -> bool {
    let decades = (high / low).log10();
    let decade = value.log10().round();
    let every = (decades / 6.0).ceil().max(1.0);
    let between = (value.log10() - decade).abs() > 1e-6;
    !(between && decades > 3.0) && (between || decade.rem_euclid(every) == 0.0)
}

/// Letters of the longest label of an axis.
pub(super) fn longest_label((low, high): (f64, f64), logarithmic: bool) -> f64 {
    let candidates: Vec<f64> = if logarithmic {
        let (first, last) = (low.log10().floor(), high.log10().ceil());
        let decades = (0..64).map(|k| first + f64::from(k));
        let decades = decades.take_while(|decade| *decade <= last);
        decades
            .flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powf(decade)))
            .collect()
    } else {
        let step = (high - low) / 5.0;
        let digits = 10f64.powf(step.log10().floor());
        (0..=5)
            .map(|k| ((low + f64::from(k) * step) / digits).round() * digits)
            .collect()
    };
    let labels = candidates
        .into_iter()
        .map(|value| tick(value, (low, high), logarithmic).len());
    let longest = labels.max().unwrap_or(1);
    u32::try_from(longest.min(9)).map_or(9.0, f64::from)
}

#[cfg(test)]
mod tests {
    use super::tick;

    #[test]
    fn ticks_have_the_digits_that_tell_them_apart() {
        let linear = |value, range| tick(value, range, false);
        assert_eq!(linear(0.25, (0.0, 1.0)), "0.25");
        assert_eq!(linear(0.2, (0.0, 0.5)), "0.2");
        assert_eq!(linear(20.0, (0.0, 20.0)), "20");
        assert_eq!(linear(2.000_005, (2.0, 2.000_02)), "2.000005");
        assert_eq!(linear(2.5, (0.0, 10.0)), "2.5");
        assert_eq!(linear(-0.0, (-1.0, 1.0)), "0");
        assert_eq!(linear(3e6, (0.0, 1e7)), "3e6");
        assert_eq!(linear(2e-5, (0.0, 1e-4)), "2e-5");
        let logarithmic = |value, range| tick(value, range, true);
        assert_eq!(logarithmic(0.05, (0.01, 1.0)), "0.05");
        assert_eq!(logarithmic(1e-5, (1e-6, 1e-4)), "1e-5");
        // Over many decades only some of them have labels.
        let labelled = (-4..=8).filter(|k| !logarithmic(10f64.powi(*k), (1e-4, 1e8)).is_empty());
        assert_eq!(labelled.count(), 7);
        assert_eq!(logarithmic(0.05, (1e-4, 1e8)), "");
    }
}
