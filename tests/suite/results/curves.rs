//! Curves of a run, against the large tables that they stand for.

use super::scores_of_channels;
use crate::common::{altered, tables};
use polars::prelude::DataFrame;
use urts_mc::backend::cpu::Precision;
use urts_mc::campaign::Campaign;
use urts_mc::results::curves::{BAND, DISTRIBUTION, SURVIVAL, curves_table};
use urts_mc::results::scores::Status;
use urts_mc::results::sensitivity::{SensitivityResult, rank};
use urts_mc::results::tables::Tables;

/// A point of a curve: x, y, and what y lies between.
type Point = [f64; 4];

/// The points of a curve of a controller, on these channels where it is of some.
fn points(curves: &DataFrame, curve: &str, controller: &str, group: Option<&str>) -> Vec<Point> {
    let text = |name: &str, row: usize| {
        let column = curves.column(name).unwrap().str().unwrap();
        column.get(row).map(ToString::to_string)
    };
    let real = |name: &str, row: usize| {
        let column = curves.column(name).unwrap().f64().unwrap();
        column.get(row).unwrap_or(f64::NAN)
    };
    let own = |row: &usize| {
        text("curve", *row).as_deref() == Some(curve)
            && text("controller", *row).as_deref() == Some(controller)
            && text("group", *row).as_deref() == group
    };
    let rows = (0..curves.height()).filter(own);
    rows.map(|row| ["x", "y", "y_lower", "y_upper"].map(|name| real(name, row)))
        .collect()
}

/// The numbers of a column, not a number where it is empty.
fn column(frame: &DataFrame, name: &str) -> Vec<f64> {
    let column = frame.column(name).unwrap().f64().unwrap().iter();
    column.map(|value| value.unwrap_or(f64::NAN)).collect()
}

/// A campaign, its tables, its ranking and its curves.
fn simulated() -> (Campaign, Tables, Vec<SensitivityResult>, DataFrame) {
    let changes = [
        "controllers=[\"ftc\", \"pid-robust-observer\"]",
        "episodes=120",
        "verdict.max_error=0.6",
    ];
    let campaign = altered("uav-paper", &changes);
    let tables = tables(&campaign, Precision::F32);
    let ranking = rank(&campaign, &tables.scores);
    let curves = curves_table(&campaign, &tables.scores, &ranking);
    (campaign, tables, ranking, curves.to_frame().unwrap())
}

#[test]
fn curves_say_what_the_large_tables_say() {
    let (campaign, tables, _, curves) = simulated();
    let channels = tables.channels.to_frame().unwrap();
    let episodes = tables.episodes.to_frame().unwrap();
    let rmse = column(&channels, "rmse");
    let failed_at_s = column(&episodes, "failed_at_s");
    let (team, n) = (3, 120);
    let mut failed = 0;
    for (index, controller) in campaign.controllers.iter().enumerate() {
        let row = |episode: usize| (episode * 2 + index) * team;
        // The errors of attitude, of all agents.
        let of_episode = |episode: usize| {
            let agents = row(episode)..row(episode) + team;
            let squares = agents.flat_map(|agent| &rmse[agent * 6 + 3..agent * 6 + 6]);
            let mean = squares.map(|own| own * own).sum::<f64>() / 9.0;
            if mean.is_nan() {
                f64::INFINITY
            } else {
                mean.sqrt()
            }
        };
        let errors: Vec<f64> = (0..n).map(of_episode).collect();
        let points = points(&curves, DISTRIBUTION, controller, Some("attitude"));
        // Two ways to add the same squares.
        let upto = |x: f64| {
            errors
                .iter()
                .filter(|own| **own <= x * (1.0 + 1e-12))
                .count()
        };
        assert_eq!(
            points.len(),
            errors.iter().filter(|own| own.is_finite()).count()
        );
        for [x, y, lower, upper] in points {
            assert!((y - upto(x) as f64 / 120.0).abs() < 1e-12, "{x} {y}");
            assert!(lower.is_nan() && upper.is_nan());
        }

        let first = |episode: usize| {
            let own = &failed_at_s[row(episode)..row(episode) + team];
            own.iter().copied().fold(f64::INFINITY, f64::min)
        };
        let firsts: Vec<f64> = (0..n).map(first).collect();
        let survival = self::points(&curves, SURVIVAL, controller, None);
        for [time_s, y, ..] in &survival {
            let gone = firsts.iter().filter(|own| *own <= time_s).count();
            assert!(
                (y - (1.0 - gone as f64 / 120.0)).abs() < 1e-12,
                "{time_s} {y}"
            );
        }
        let gone = firsts.iter().filter(|own| own.is_finite()).count();
        failed += gone;
        let left = survival.last().map_or(1.0, |point| point[1]);
        assert!((left - (1.0 - gone as f64 / 120.0)).abs() < 1e-12);
    }
    assert!(failed > 10, "{failed}");
}

#[test]
fn a_band_is_about_the_condition_that_moves_the_errors_most() {
    let (campaign, tables, ranking, curves) = simulated();
    let sure = ranking
        .iter()
        .find(|own| own.target.kind == "rmse" && own.p_holm.unwrap() <= 0.05);
    let sure = sure.unwrap();
    let group = sure.target.group.as_deref().unwrap();
    let mut conditions = tables.scores.conditions.iter();
    let (_, sizes) = conditions
        .find(|(name, _)| *name == sure.condition)
        .unwrap();
    let mut order: Vec<usize> = (0..120).collect();
    order.sort_by(|&a, &b| sizes[a].total_cmp(&sizes[b]));
    let role = campaign
        .channel_groups()
        .into_iter()
        .position(|own| &*own.name == group)
        .unwrap();
    let errors = &tables.scores.groups[0].channel_groups[1];
    let points = points(&curves, BAND, "pid-robust-observer", Some(group));
    assert_eq!(points.len(), 10);
    for (bin, [x, y, lower, upper]) in order.chunks(12).zip(points) {
        let mut of_bin: Vec<f64> = bin.iter().map(|k| errors[k * 2 + role].rmse).collect();
        of_bin.sort_by(f64::total_cmp);
        assert_eq!(
            [x, y, lower, upper],
            [sizes[bin[6]], of_bin[6], of_bin[0], of_bin[11]]
        );
    }
}

#[test]
fn a_curve_of_many_episodes_has_a_thousand_points_and_ends_where_they_end() {
    let campaign = altered("smoke", &["episodes=2500", "controllers.2="]);
    let scores = scores_of_channels(&campaign, |controller, episode, _| {
        let status = if controller == 0 {
            Status::Ok
        } else {
            Status::Exceeded
        };
        // No two alike, in no order.
        (status, 1.0 + (episode * 1009 % 2500) as f64)
    });
    let curves = curves_table(&campaign, &scores, &[]).to_frame().unwrap();
    let points = |curve, controller: usize, group| {
        points(&curves, curve, &campaign.controllers[controller], group)
    };
    let errors = points(DISTRIBUTION, 0, Some("position"));
    assert_eq!(
        errors.len(),
        2500_usize.div_ceil(3) + usize::from(2499 % 3 != 0)
    );
    assert_eq!(
        (errors[0][1], errors.last().unwrap()[1]),
        (1.0 / 2500.0, 1.0)
    );
    for [x, y, ..] in errors {
        assert!((x - 2500.0 * y).abs() < 1e-9, "{x} {y}");
    }
    // Those that break the limit of the RMS error fail together, at the end.
    let end_s = f64::from(campaign.time.steps) * campaign.time.step_s;
    assert!(points(SURVIVAL, 0, None).is_empty());
    assert_eq!(points(SURVIVAL, 1, None)[0][..2], [end_s, 0.0]);
}
