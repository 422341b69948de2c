//! How a robot was to walk, from above and from the side (the paper's Figure 10), and how it walked, as a stick figure.

use super::episode_data::{ControllerTrace, EpisodeView};
use super::path::height;
use crate::agent::robot::kinematics::{by_leg, leg_pose};
use crate::agent::robot::{JOINTS, Robot};
use crate::campaign::AgentGroup;
use crate::model::ChannelSample;
use crate::model::episode::Snapshot;
use crate::reference::walk::{Ankle, Foot, Placement, Walk, zmp};
use crate::reference::{AgentWalk, Reference};
use crate::report::page::document::{Block, Figure, LegendEntry, Section};
use crate::report::page::plot::{Axis, Color, Mark, Plot, Stroke};
use crate::util::format::sentence;
use nalgebra::{Vector3, Vector6};

/// Poses of a stick figure.
const POSES: usize = 7;
/// Distance between the poses, m: they would hide each other where they are.
const APART_M: f64 = 0.35;
/// Points of a planned path.
const POINTS: usize = 300;

/// Colours of the left and of the right leg: none of the first controllers'.
const LEGS: [Color; 2] = [Color::Series(4), Color::Series(3)];
const COM: Color = Color::Series(5);
const ZMP: Color = Color::Limit;

/// The walk of the robot of a group that fared worst, and its stick figures.
pub(super) fn section(view: &EpisodeView<'_>, group: &AgentGroup, robot: &Robot) -> Section {
    let agents = EpisodeView::agents_of(group);
    let mut order = view.worst_first().into_iter();
    let agent = order.find(|agent| agents.contains(agent));
    let agent = agent.unwrap_or(agents.start);
    let mut blocks = Vec::new();
    let walk = match &group.reference {
        Reference::Walk(walks) => walks.get(agent - group.first_agent),
        Reference::Sinusoid(_) | Reference::Waypoints(_) => None,
    };
    if let Some(AgentWalk { walk, start_s }) = walk {
        blocks.push(Block::text(format!(
            "The walk planned for agent {agent}, which begins at {start_s} s of the episode."
        )));
        blocks.push(Block::Figure(plan(walk, robot)));
    }
    blocks.push(Block::Figure(sticks(view, robot, agent, walk)));
    Section::new(sentence(&group.titled("walk")), blocks)
}

/// How far the pelvis has come ahead at the samples of a walk; its swaying from side to side is no way.
struct Way<'a> {
    walk: &'a Walk,
    /// (time s, way m).
    samples: Vec<(f64, f64)>,
}

impl<'a> Way<'a> {
    fn of(walk: &'a Walk) -> Self {
        let mut samples: Vec<(f64, f64)> = Vec::new();
        let mut last = walk.pelvis_at(0.0);
        let mut way_m = 0.0;
        for t_s in walk.times_s() {
            let at = walk.pelvis_at(t_s);
            way_m += last.local(at.position_m)[0];
            samples.push((t_s, way_m));
            last = at;
        }
        Self { walk, samples }
    }

    fn at(&self, t_s: f64) -> f64 {
        let right = self
            .samples
            .partition_point(|&(sample_s, _)| sample_s <= t_s);
        let sample = self.samples.get(right.saturating_sub(1));
        sample.map_or(0.0, |&(_, way_m)| way_m)
    }

    /// Where a point of the ground is ahead on the way, as seen from the pelvis at a time.
    fn ahead(&self, t_s: f64, point_m: [f64; 2]) -> f64 {
        self.at(t_s) + self.walk.pelvis_at(t_s).local(point_m)[0]
    }
}

/// The plan: footholds, centre of mass and zero moment point from above; the ankles from the side.
fn plan(walk: &Walk, robot: &Robot) -> Figure {
    let times: Vec<f64> = walk.times_s().collect();
    let few: Vec<f64> = every(&times, POINTS).copied().collect();
    let mut above = Vec::new();
    let soles = zmp::soles(robot);
    for hold in walk.feet.footholds() {
        let leg = hold.foot.index();
        above.push(sole(&soles[leg], hold.placement, LEGS[leg]));
        let at = hold.placement.position_m;
        above.push(Mark::Dots(vec![at.into()], LEGS[leg]));
    }
    let states = &walk.com.states;
    let com = states.iter().map(|[x, y]| (x[0], y[0]));
    let zmp = walk.com.zmp_m.iter().map(|&point| point.into());
    let reference = few.iter().map(|&t_s| walk.zmp_reference.at(t_s).into());
    let path =
        |points: Vec<(f64, f64)>| -> Vec<(f64, f64)> { every(&points, POINTS).copied().collect() };
    let (com, zmp): (Vec<_>, Vec<_>) = (com.collect(), zmp.collect());
    above.push(Mark::Line(
        reference.collect(),
        Color::Truth,
        Stroke::Dashed,
    ));
    above.push(Mark::Line(path(zmp.clone()), ZMP, Stroke::Solid));
    above.push(Mark::Line(path(com.clone()), COM, Stroke::Solid));

    let side = ankles(walk, &few);
    let over_time = |coordinate: usize| -> Vec<Mark> {
        let pick = |points: &[(f64, f64)]| -> Vec<(f64, f64)> {
            let of = |(&t_s, &(x, y)): (&f64, &(f64, f64))| (t_s, [x, y][coordinate]);
            let all: Vec<(f64, f64)> = times.iter().zip(points).map(of).collect();
            path(all)
        };
        let reference = |&t_s: &f64| (t_s, walk.zmp_reference.at(t_s)[coordinate]);
        let reference = few.iter().map(reference).collect();
        vec![
            Mark::Line(reference, Color::Truth, Stroke::Dashed),
            Mark::Line(pick(&zmp), ZMP, Stroke::Solid),
            Mark::Line(pick(&com), COM, Stroke::Solid),
        ]
    };
    let [across, up] = extent(walk);
    let panel = |title: &str, labels: [&str; 2], marks: Vec<Mark>, equal: bool| Plot {
        title: title.to_string(),
        x: Axis::new(labels[0]),
        y: Axis::new(labels[1]),
        marks,
        equal,
        height: equal.then(|| height(across, up)),
        ..Plot::default()
    };
    let time = "time since the walk began, s";
    Figure {
        panels: vec![
            panel("from above", ["x, m", "y, m"], above, true),
            panel("x over time", [time, "x, m"], over_time(0), false),
            panel("y over time", [time, "y, m"], over_time(1), false),
            panel(
                "ankles from the side",
                ["way along the path, m", "height, m"],
                side.into(),
                false,
            ),
        ],
        legend: vec![
            LegendEntry::line(COM, "centre of mass"),
            LegendEntry::line(ZMP, "zero moment point"),
            LegendEntry::dashes(Color::Truth, "reference of the zero moment point"),
            LegendEntry::line(LEGS[0], "left foot"),
            LegendEntry::line(LEGS[1], "right foot"),
        ],
        caption: "The plan: footholds with the outlines of the soles, the centre of mass, the zero moment point of the pendulum \
                  and the one planned for."
            .into(),
    }
}

/// The ways of both ankles from the side.
fn ankles(walk: &Walk, times_s: &[f64]) -> [Mark; 2] {
    let way = Way::of(walk);
    let ankle = |foot: Foot| -> Vec<(f64, f64)> {
        let point = |&t_s: &f64| {
            let Ankle {
                placement,
                height_m,
            } = walk.feet.ankles_at(t_s)[foot.index()];
            (way.ahead(t_s, placement.position_m), height_m)
        };
        times_s.iter().map(point).collect()
    };
    Foot::BOTH.map(|foot| Mark::Line(ankle(foot), LEGS[foot.index()], Stroke::Solid))
}

/// How far the footholds lie apart along x and y, with a margin, m.
fn extent(walk: &Walk) -> [f64; 2] {
    let ends = |pick: fn(&[f64; 2]) -> f64| {
        let places = walk.feet.footholds();
        let values = places.iter().map(|hold| pick(&hold.placement.position_m));
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        })
    };
    [ends(|at| at[0]), ends(|at| at[1])].map(|(low, high)| high - low + 0.3)
}

/// The outline of a sole at a foothold.
fn sole(corners: &[[f64; 2]], at: Placement, color: Color) -> Mark {
    let closed = corners.iter().chain(corners.first());
    let outline = closed.map(|&corner| at.point(corner).into());
    Mark::Line(outline.collect(), color, Stroke::Solid)
}

/// Poses of a robot over time under every controller, from the side.
fn sticks(view: &EpisodeView<'_>, robot: &Robot, agent: usize, walk: Option<&AgentWalk>) -> Figure {
    let height_m = walk.map_or(robot.base_height_m, |own| own.walk.gait.pelvis_height_m);
    let panels = view.traces.iter().map(|trace| {
        let (mut planned, mut simulated) = (Vec::new(), Vec::new());
        for (k, snapshot) in instants(view, trace, walk).into_iter().enumerate() {
            let ahead_m = APART_M * k as f64;
            let pose = |pick: fn(&ChannelSample) -> f64| {
                let angles = std::array::from_fn(|joint| pick(&snapshot.agents[agent][joint]));
                legs(robot, &angles).map(|leg| -> Vec<(f64, f64)> {
                    let point = |point: &Vector3<f64>| (ahead_m + point.x, height_m + point.z);
                    leg.iter().map(point).collect()
                })
            };
            for leg in pose(|shown| shown.r) {
                planned.push(Mark::Line(leg, Color::Truth, Stroke::Dashed));
            }
            let [left, right] = pose(|shown| shown.x);
            simulated.push(Mark::Line(right, LEGS[1], Stroke::Solid));
            simulated.push(Mark::Line(left, LEGS[0], Stroke::Solid));
        }
        Plot {
            title: trace.name.to_string(),
            x: Axis::new(format!("ahead, m; each pose {APART_M} m further")),
            y: Axis::new("height, m"),
            marks: planned.into_iter().chain(simulated).collect(),
            equal: true,
            ..Plot::default()
        }
    });
    let times: Vec<String> = instants(view, view.asked(), walk)
        .into_iter()
        .map(|snapshot| format!("{:.2}", view.time_s(snapshot)))
        .collect();
    Figure {
        panels: panels.collect(),
        legend: vec![
            LegendEntry::line(LEGS[0], "left leg"),
            LegendEntry::line(LEGS[1], "right leg"),
            LegendEntry::dashes(Color::Truth, "reference"),
        ],
        caption: format!(
            "Agent {agent} from the side at t = {} s: each leg from the pelvis over hip, knee and ankle to heel and toe, at the \
             joint angles simulated. The model's pelvis stands still; the poses are drawn side by side, upright and at the height \
             of the pelvis planned.",
            times.join(", ")
        ),
    }
}

/// Snapshots spread evenly over the walk, or over the episode.
fn instants<'a>(
    view: &EpisodeView<'_>,
    trace: &ControllerTrace<'a>,
    walk: Option<&AgentWalk>,
) -> Vec<&'a Snapshot> {
    let walking = |snapshot: &&Snapshot| {
        let Some(AgentWalk { walk, start_s }) = walk else {
            return true;
        };
        let (from_s, until_s) = (
            walk.gait.standing_before_s,
            walk.duration_s() - walk.gait.standing_after_s,
        );
        (from_s..=until_s).contains(&(view.time_s(snapshot) - start_s))
    };
    let all: Vec<&Snapshot> = trace.snapshots.iter().filter(walking).collect();
    let last = all.len().saturating_sub(1);
    let mut places: Vec<usize> = (0..POSES).map(|k| k * last / (POSES - 1)).collect();
    places.dedup();
    let found = places.iter().filter_map(|&place| all.get(place).copied());
    found.collect()
}

/// The joints of both legs in the pelvis frame, m, from the pelvis to the toe; not finite where the angles are not.
fn legs(robot: &Robot, angles_rad: &[f64; JOINTS]) -> [Vec<Vector3<f64>>; 2] {
    let angles: [Vector6<f64>; 2] = by_leg(angles_rad);
    [0, 1].map(|side| {
        let leg = &robot.legs[side];
        let pose = leg_pose(leg, &angles[side]);
        let mut points = vec![Vector3::zeros()];
        points.extend(pose.origins_m);
        points.push(pose.ankle_m());
        let along = leg.foot.sole_corners_m.iter().map(|corner| corner[0]);
        let (heel, toe) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        if heel <= toe {
            let sole = pose.sole();
            let point = |x: f64| (sole * nalgebra::Point3::new(x, 0.0, 0.0)).coords;
            points.extend([point(heel), point(toe), pose.ankle_m()]);
        }
        points
    })
}

/// Some of many values in their order, the last among them.
fn every<T>(values: &[T], most: usize) -> impl Iterator<Item = &T> {
    let step = values.len().div_ceil(most).max(1);
    let rest = (values.len() % step != 1).then(|| values.last()).flatten();
    values.iter().step_by(step).chain(rest)
}
