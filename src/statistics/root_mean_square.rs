//! The size of numbers whose sign does not matter: of errors, whose number is always the same, and of drawn quantities,
//! whose number is not.

/// Root mean square of errors: the plain formula; NaN of no values.
pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(sum, count), value| {
        (sum + value * value, count + 1.0)
    });
    (sum / count).sqrt()
}

/// Root mean square of drawn quantities; `None` if there are no values.
///
/// Values of one size give exactly this size, however many there are. The formula alone would not: 0.1 over 12 values
/// gives 0.10000000000000002, over 4 values 0.1, so that a constant seemed to vary with the number of those that it
/// strikes.
#[expect(clippy::float_cmp, reason = "sizes that are equal to the last digit")]
pub fn root_mean_square(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut sizes = values.into_iter().map(f64::abs);
    let first = sizes.next()?;
    let (sum, count, equal) = sizes
        .fold((first * first, 1.0, true), |(sum, count, equal), size| {
            (sum + size * size, count + 1.0, equal && size == first)
        });
    Some(if equal { first } else { (sum / count).sqrt() })
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "what is exact is compared so")]
mod tests {
    use super::root_mean_square;

    /// The formula as it stands, which rounds twice.
    fn formula(values: &[f64]) -> f64 {
        let squares: f64 = values.iter().map(|value| value * value).sum();
        (squares / values.len() as f64).sqrt()
    }

    #[test]
    fn values_of_one_size_give_exactly_this_size() {
        let mut inexact = 0;
        for size in [0.1, 0.3, 1.0 / 3.0, 1e-200, 2.5e170, 0.0] {
            for count in 1..=400 {
                let mut values = vec![size; count];
                assert_eq!(root_mean_square(values.clone()), Some(size), "{count}");
                // The sign does not matter.
                values
                    .iter_mut()
                    .step_by(3)
                    .for_each(|value| *value = -size);
                assert_eq!(root_mean_square(values.clone()), Some(size), "{count}");
                // Of tiny and huge sizes the squares are none.
                let rounds = (0.01..1.0).contains(&size);
                inexact += u32::from(rounds && formula(&values) != size);
            }
        }
        // Negative control: the formula alone misses the size of many of them, of 0.1 over 12 values among others.
        assert!(inexact > 1000, "{inexact}");
        assert_eq!(formula(&[0.1; 12]), 0.100_000_000_000_000_02);
    }

    #[test]
    fn other_values_give_what_the_formula_says() {
        assert_eq!(root_mean_square([]), None);
        assert_eq!(
            root_mean_square([3.0, -4.0, 5.0, 0.0]),
            Some(12.5_f64.sqrt())
        );
        let varied = [0.1, 0.1, 0.100_000_000_000_000_02];
        assert_eq!(root_mean_square(varied), Some(formula(&varied)));
    }
}
