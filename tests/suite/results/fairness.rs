//! On what terms controllers are compared.

use crate::common::{altered, gains_of_groups, tables};
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::Campaign;
use urts_mc::results::tables::Tables;
use urts_mc::results::{Terms, terms, unlike};

fn found(campaign: &Campaign) -> (Vec<Terms>, Tables) {
    let tables = tables(campaign, Precision::F32);
    let terms = terms(campaign, gains_of_groups(campaign), &tables.scores);
    (terms, tables)
}

/// A column of a run's table of channels for a controller and some channels: values of an episode one after the other.
fn of_channels(
    tables: &Tables,
    column: &str,
    controller: &str,
    channels: &[&str],
) -> Vec<Vec<f64>> {
    let frame = tables.channels.to_frame().unwrap();
    let text = |name: &str| frame.column(name).unwrap().str().unwrap().clone();
    let (controllers, names) = (text("controller"), text("channel"));
    let values = frame.column(column).unwrap().f64().unwrap().clone();
    let episodes = frame.column("episode").unwrap().i64().unwrap().clone();
    let mut all: Vec<Vec<f64>> = Vec::new();
    for row in 0..frame.height() {
        let wanted = controllers.get(row) == Some(controller)
            && names.get(row).is_some_and(|name| channels.contains(&name));
        if wanted {
            let episode = usize::try_from(episodes.get(row).unwrap()).unwrap();
            all.resize(all.len().max(episode + 1), Vec::new());
            all[episode].push(values.get(row).unwrap());
        }
    }
    all
}

#[test]
fn val_the_terms_are_those_of_the_gains_and_of_the_table_of_channels() {
    let controllers = "controllers=[\"ftc\", \"pid\", \"pid-robust-observer\"]";
    let campaign = altered("smoke", &["episodes=40", controllers]);
    let (terms, tables) = found(&campaign);
    let names: Vec<(&str, &str)> = terms
        .iter()
        .map(|own| (&*own.controller, &*own.group))
        .collect();
    assert_eq!(names[..2], [("ftc", "position"), ("ftc", "attitude")]);
    assert_eq!(names.len(), 6);
    // As in the independent study: 7.6 and 27.3 ms.
    let margin = |index: usize| terms[index].margins.unwrap().delay_margin_ms;
    assert!((margin(0) - 7.6).abs() < 0.05 && (margin(4) - 27.3).abs() < 0.05);
    for own in &terms {
        let channels: &[&str] = match &*own.group {
            "position" => &["x", "y", "z"],
            _ => &["roll", "pitch", "yaw"],
        };
        let of = |column: &str| of_channels(&tables, column, &own.controller, channels);
        let mut peaks: Vec<f64> = of("u_max")
            .iter()
            .map(|all| all.iter().copied().fold(0.0, f64::max))
            .collect();
        peaks.sort_by(f64::total_cmp);
        // Type 7 of Hyndman and Fan lies between two of the sorted values.
        let peak = own.peak_command_p95.unwrap();
        assert!(
            peaks[36] <= peak && peak <= peaks[39] && peak > 10.0,
            "{peak}"
        );
        let mut efforts: Vec<f64> = of("effort")
            .iter()
            .map(|all| all.iter().sum::<f64>() / all.len() as f64)
            .collect();
        efforts.sort_by(f64::total_cmp);
        let effort = own.effort_p50.unwrap();
        assert!(efforts[18] <= effort && effort <= efforts[21], "{effort}");
        assert_eq!(own.saturated_share, Some(0.0));
    }
}

#[test]
fn what_is_unlike_is_said_and_what_is_alike_is_not() {
    let campaign = altered(
        "smoke",
        &[
            "episodes=8",
            "controllers=[\"ftc\", \"pid-robust-observer\", \"pid-placed\"]",
        ],
    );
    let (terms, _) = found(&campaign);
    let sentences = unlike(&terms);
    assert_eq!(sentences.len(), 2, "{sentences:?}");
    for said in [
        "ftc and pid-robust-observer are compared on unlike terms: crossover 101 against ",
        "delay margin 7.59 against 27.3 ms, peak gain from noise 346 against 1898 in position and attitude",
    ] {
        assert!(sentences[0].contains(said), "{sentences:?}");
    }
    // With the FTC's delay margin the placed PID has no other, but commands of its own.
    assert!(!sentences[1].contains("delay margin"), "{sentences:?}");
    assert!(
        sentences[1].contains("largest command (95th percentile)"),
        "{sentences:?}"
    );
    // Two of a kind are alike, whatever they are called.
    let mut twins = terms[..2].to_vec();
    twins.extend(terms[..2].iter().cloned().map(|own| Terms {
        controller: "twin".into(),
        ..own
    }));
    assert!(unlike(&twins).is_empty());
    // A quarter more is enough, a fifth is not.
    for (factor, said) in [(1.2, false), (1.3, true)] {
        let mut other = twins.clone();
        let margins = other[3].margins.as_mut().unwrap();
        margins.crossover_rad_s *= factor;
        assert_eq!(unlike(&other).len(), usize::from(said));
    }
    let mut other = twins.clone();
    other[2].effort_p50 = twins[0].effort_p50.map(|effort| 2.0 * effort);
    let said = unlike(&other);
    assert!(
        said[0].contains("effort (median) ")
            && said[0].ends_with(" N^2 s or N^2 m^2 s in position"),
        "{said:?}"
    );
    let mut other = twins.clone();
    other[2].saturated_share = Some(0.4);
    assert_eq!(
        unlike(&other),
        [
            "ftc and twin are compared on unlike terms: 0 against 40 % of the time at a limit in position"
        ]
    );
}
