//! The counterparts of the paper's figures.

use super::error::PaperError;
use super::scenarios::{Scenario, Scenarios};
use crate::campaign::Campaign;
use crate::model::ChannelSample;
use crate::reference::Reference;
use crate::report::page::document::LegendEntry;
use crate::report::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::report::page::plot_grid::plot_grid;
use std::path::Path;

/// The campaign of Figure 8.
const WAYPOINTS: &str = include_str!("../../../campaigns/waypoints.toml");
/// Points of a drawn path.
const PATH_POINTS: u32 = 400;

/// A figure in a file of its own.
pub(super) struct Figure {
    pub(super) file: String,
    pub(super) title: String,
    pub(super) caption: String,
    pub(super) svg: String,
}

/// What a figure shows of every channel.
struct View {
    number: u32,
    what: &'static str,
    lines: &'static [Line],
    unit: fn(&str) -> String,
    simulated: Scenario,
}

/// A line of a figure.
struct Line {
    name: &'static str,
    color: Color,
    stroke: Stroke,
    pick: fn(&ChannelSample) -> f64,
}

const STATES: &[Line] = &[
    Line {
        name: "reference r",
        color: Color::Truth,
        stroke: Stroke::Dashed,
        pick: |shown| shown.r,
    },
    Line {
        name: "state x",
        color: Color::Series(0),
        stroke: Stroke::Solid,
        pick: |shown| shown.x,
    },
    Line {
        name: "its estimate",
        color: Color::Series(1),
        stroke: Stroke::Dashed,
        pick: |shown| shown.r + shown.e_hat,
    },
];
const ACTUATOR_FAULT: &[Line] = &[
    Line {
        name: "actuator fault f1",
        color: Color::Truth,
        stroke: Stroke::Solid,
        pick: |shown| shown.f1,
    },
    Line {
        name: "its estimate",
        color: Color::Series(1),
        stroke: Stroke::Dashed,
        pick: |shown| shown.f1_hat,
    },
];
const SENSOR_FAULT: &[Line] = &[
    Line {
        name: "sensor fault f2",
        color: Color::Truth,
        stroke: Stroke::Solid,
        pick: |shown| shown.f2,
    },
    Line {
        name: "its estimate",
        color: Color::Series(1),
        stroke: Stroke::Dashed,
        pick: |shown| shown.f2_hat,
    },
];
const CONTROL: &[Line] = &[Line {
    name: "control input u",
    color: Color::Series(0),
    stroke: Stroke::Solid,
    pick: |shown| shown.u,
}];

/// All of them, in the paper's order.
///
/// # Errors
/// If the campaign of Figure 8 is none.
pub(super) fn all(uavs: &Scenarios, robots: &Scenarios) -> Result<Vec<Figure>, PaperError> {
    let length: fn(&str) -> String = |unit| unit.to_string();
    let acceleration: fn(&str) -> String = |unit| format!("{unit}/s²");
    let rate: fn(&str) -> String = |unit| format!("{unit}/s");
    let effort: fn(&str) -> String = |unit| {
        if unit == "m" {
            "N".into()
        } else {
            "N m".into()
        }
    };
    let view = |number, what, lines, unit, simulated| View {
        number,
        what,
        lines,
        unit,
        simulated,
    };
    let of_uavs = [
        view(11, "states", STATES, length, Scenario::Ftc),
        view(
            12,
            "actuator fault",
            ACTUATOR_FAULT,
            acceleration,
            Scenario::Ftc,
        ),
        view(13, "sensor fault", SENSOR_FAULT, rate, Scenario::Ftc),
        view(14, "control input", CONTROL, effort, Scenario::Ftc),
        view(
            19,
            "states under the PID",
            STATES,
            length,
            uavs.flying_pid(),
        ),
    ];
    let of_robots = [
        view(15, "states", STATES, length, Scenario::Ftc),
        view(
            16,
            "actuator fault",
            ACTUATOR_FAULT,
            acceleration,
            Scenario::Ftc,
        ),
        view(17, "sensor fault", SENSOR_FAULT, rate, Scenario::Ftc),
        view(18, "control input", CONTROL, effort, Scenario::Ftc),
        view(
            20,
            "states under the PID",
            STATES,
            length,
            robots.flying_pid(),
        ),
    ];
    let mut figures: Vec<(u32, Figure)> = Vec::new();
    for view in &of_uavs {
        figures.push((view.number, of_view(uavs, view, "UAV")));
    }
    for view in &of_robots {
        figures.push((view.number, of_view(robots, view, "robot")));
    }
    figures.push((8, paths()?));
    figures.extend(walk(robots).map(|figure| (10, figure)));
    figures.sort_by_key(|(number, _)| *number);
    Ok(figures.into_iter().map(|(_, figure)| figure).collect())
}

fn of_view(scenarios: &Scenarios, view: &View, agent: &str) -> Figure {
    let group = &scenarios.group;
    let panels: Vec<Plot> = group
        .channels()
        .iter()
        .enumerate()
        .map(|(channel, name)| {
            let marks = view.lines.iter().map(|line| {
                let points = scenarios.series(view.simulated, channel, line.pick);
                Mark::Line(points.0, line.color, line.stroke)
            });
            Plot {
                title: name.to_string(),
                x: Axis {
                    range: Some((0.0, scenarios.end_s())),
                    ..Axis::new("time, s")
                },
                y: Axis::new((view.unit)(group.unit(channel))),
                marks: marks.collect(),
                ..Plot::default()
            }
        })
        .collect();
    let legend: Vec<LegendEntry> = view
        .lines
        .iter()
        .map(|line| LegendEntry::of(line.stroke, line.color, line.name))
        .collect();
    let title = format!("Figure {}: {agent}, {}", view.number, view.what);
    let controller = match view.simulated {
        Scenario::Pid | Scenario::Placed => scenarios.reading(view.simulated),
        Scenario::Ftc | Scenario::OnCourse => "FTC".to_string(),
    };
    let mut caption = format!("First {agent} of the team under the {controller}.");
    if view.simulated == Scenario::Placed
        && let Some(lost_s) = scenarios.lost_s(Scenario::Pid)
    {
        let plain = scenarios.reading(Scenario::Pid);
        caption.push_str(&format!(
            " Under the {plain} it diverges within {lost_s:.2} s."
        ));
    }
    if let Some(lost_s) = scenarios.lost_s(view.simulated) {
        caption.push_str(&format!(" The episode diverges within {lost_s:.2} s."));
    }
    Figure {
        file: format!("figure-{:02}.svg", view.number),
        svg: plot_grid(&title, &caption, &panels, 3, &legend),
        title,
        caption,
    }
}

/// Figure 8: the planned paths of UAVs, from above and from the side.
fn paths() -> Result<Figure, PaperError> {
    let campaign = Campaign::parse(WAYPOINTS, Path::new("campaigns/waypoints.toml"))?;
    let group = campaign.first_group();
    let end_s = f64::from(campaign.time.steps) * campaign.time.step_s;
    let view = |title: &str, labels: [&str; 2], axes: [usize; 2]| {
        let of_agent = |agent: usize| {
            let points = (0..=PATH_POINTS).map(|k| {
                let t_s = end_s * f64::from(k) / f64::from(PATH_POINTS);
                let at = group.reference.at(agent, t_s);
                axes.map(|axis| at.get(axis).map_or(f64::NAN, |point| point.value))
            });
            let points = points.map(|[a, b]| (a, b)).collect();
            Mark::Line(points, Color::Series(agent), Stroke::Solid)
        };
        Plot {
            title: title.into(),
            x: Axis::new(labels[0]),
            y: Axis::new(labels[1]),
            marks: (0..group.team).map(of_agent).collect(),
            equal: true,
            ..Plot::default()
        }
    };
    let panels = [
        view("from above", ["x, m", "y, m"], [0, 1]),
        view("from the side", ["x, m", "z, m"], [0, 2]),
    ];
    let legend: Vec<LegendEntry> = (0..group.team)
        .map(|agent| LegendEntry::line(Color::Series(agent), format!("UAV {agent}")))
        .collect();
    let title = "Figure 8: planned path".to_string();
    let caption =
        "Smooth paths through the waypoints of campaigns/waypoints.toml, at rest at both ends."
            .to_string();
    Ok(Figure {
        file: "figure-08.svg".into(),
        svg: plot_grid(&title, &caption, &panels, 2, &legend),
        title,
        caption,
    })
}

/// Figure 10: the planned walk of a robot from above.
fn walk(robots: &Scenarios) -> Option<Figure> {
    let Reference::Walk(walks) = &robots.group.reference else {
        return None;
    };
    let walk = &walks.first()?.walk;
    let com = walk.com.states.iter().map(|[x, y]| (x[0], y[0])).collect();
    let zmp = walk.com.zmp_m.iter().map(|[x, y]| (*x, *y)).collect();
    let feet = walk.feet.footholds().into_iter();
    let feet = feet.map(|foothold| {
        let [x, y] = foothold.placement.position_m;
        (x, y)
    });
    let panel = Plot {
        title: "from above".into(),
        x: Axis::new("x, m"),
        y: Axis::new("y, m"),
        marks: vec![
            Mark::Line(zmp, Color::Series(1), Stroke::Solid),
            Mark::Line(com, Color::Series(0), Stroke::Solid),
            Mark::Dots(feet.collect(), Color::Truth),
        ],
        ..Plot::default()
    };
    let legend = [
        LegendEntry::line(Color::Series(0), "centre of mass"),
        LegendEntry::line(Color::Series(1), "zero moment point"),
        LegendEntry::line(Color::Truth, "footholds (ankles)"),
    ];
    let title = "Figure 10: planned walk".to_string();
    let caption =
        "Straight walk of campaigns/paper-robots.toml; y is drawn larger than x.".to_string();
    Some(Figure {
        file: "figure-10.svg".into(),
        svg: plot_grid(&title, &caption, &[panel], 1, &legend),
        title,
        caption,
    })
}
