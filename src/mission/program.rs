//! Programs: what an agent does in the epochs to come, one item each.

use crate::mission::behaviour::runs;
use crate::mission::motion::Activity;
use crate::mission::pages::{Gait, Page, PageLibrary};
use crate::mission::plane::Point;
use crate::mission::planner::{Curve, Way};
use crate::mission::uav_leg::{FlightEpoch, FlightPhase, UavLeg, flight};
use std::collections::VecDeque;

/// The program of a UAV: at most one leg.
#[derive(Clone, Debug, Default)]
pub(crate) struct FlightProgram {
    epochs: VecDeque<FlightEpoch>,
}

/// The program of a robot: epochs on the spot, then at most one way.
#[derive(Clone, Debug, Default)]
pub(crate) struct WalkProgram {
    epochs: VecDeque<WalkEpoch>,
    curve: Curve,
}

/// An epoch of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WalkEpoch {
    pub(crate) activity: Activity,
    pub(crate) page: u32,
    /// Where the reference is at its end, m.
    pub(crate) place_m: Point,
    pub(crate) direction: [f64; 2],
    step: Step,
}

/// Where in a run of one behaviour an epoch lies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    /// On the spot.
    Still,
    Start,
    /// After so many pages of the cycle, from a place on the curve.
    Cycle {
        pages: usize,
        line: Line,
    },
    Stop,
}

/// A robot on its way along a curve: at the arc length `from_m + scale · advanced_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    from_m: f64,
    /// What the advances of its pages are multiplied by.
    scale: f64,
    /// Sum of the advances so far, m.
    advanced_m: f64,
}

impl FlightProgram {
    pub(crate) fn leg(from: Point, leg: &UavLeg) -> Self {
        Self {
            epochs: leg.flight(from).into(),
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.epochs.is_empty()
    }

    pub(crate) fn pop(&mut self) -> Option<FlightEpoch> {
        self.epochs.pop_front()
    }

    /// What is left if the UAV, now at a place, is told to stop: its leg without the cruise.
    pub(crate) fn cut(&self, place_m: Point) -> Self {
        let turns = self
            .epochs
            .iter()
            .filter(|epoch| epoch.phase != FlightPhase::Cruise);
        let phases = turns.map(|epoch| (epoch.leg, epoch.phase));
        Self {
            epochs: flight(place_m, phases).into(),
        }
    }

    /// Epochs until the UAV rests, and where it then is, if it is now at a place.
    pub(crate) fn rest(&self, place_m: Point) -> (usize, Point) {
        let last = self.epochs.back();
        (
            self.epochs.len(),
            last.map_or(place_m, |epoch| epoch.end.place_m),
        )
    }
}

impl WalkProgram {
    pub(crate) fn is_empty(&self) -> bool {
        self.epochs.is_empty()
    }

    pub(crate) fn len(&self) -> usize {
        self.epochs.len()
    }

    pub(crate) fn pop(&mut self) -> Option<WalkEpoch> {
        self.epochs.pop_front()
    }

    /// Where the references are at the ends of its epochs, m.
    pub(crate) fn places_m(&self) -> impl Iterator<Item = Point> + '_ {
        self.epochs.iter().map(|epoch| epoch.place_m)
    }

    /// Where it ends if the robot is now at a place, m.
    pub(crate) fn end_m(&self, place_m: Point) -> Point {
        self.epochs.back().map_or(place_m, |epoch| epoch.place_m)
    }

    /// Adds so many epochs on the spot, after which the robot still looks in its direction.
    pub(crate) fn stay(
        &mut self,
        activity: Activity,
        epochs: usize,
        (place_m, direction): (Point, [f64; 2]),
        library: &PageLibrary,
    ) {
        let (place_m, direction) = self
            .epochs
            .back()
            .map_or((place_m, direction), |last| (last.place_m, last.direction));
        let still = WalkEpoch {
            activity,
            page: library.stand,
            place_m,
            direction,
            step: Step::Still,
        };
        self.epochs.extend(std::iter::repeat_n(still, epochs));
    }

    /// Adds a way.
    pub(crate) fn walk(&mut self, epochs: Vec<WalkEpoch>, curve: Curve) {
        self.epochs.extend(epochs);
        self.curve = curve;
    }

    /// Tells the robot to stop, see [`WalkProgram::until_rest`].
    pub(crate) fn cut(&mut self, library: &PageLibrary) {
        self.epochs = self.until_rest(library).into();
    }

    /// Epochs until the robot rests if it is told to stop, and where it then is, if it is now at a place.
    pub(crate) fn rest(&self, place_m: Point, library: &PageLibrary) -> (usize, Point) {
        let left = self.until_rest(library);
        let last = left.last().map_or(place_m, |epoch| epoch.place_m);
        (left.len(), last)
    }

    /// What is left if the robot is told to stop: nothing if it is on the spot; else it goes on to the next end of a
    /// page at which a step ends, and stops from there along its way.
    fn until_rest(&self, library: &PageLibrary) -> Vec<WalkEpoch> {
        let mut left = Vec::new();
        let mut epochs = self.epochs.iter().peekable();
        if epochs.peek().is_some_and(|first| first.step == Step::Still) {
            return left;
        }
        let is_stop = |epoch: &WalkEpoch| epoch.step == Step::Stop;
        while let Some(epoch) = epochs.next() {
            if let Some(stop) = self.stop_before(epoch, library) {
                left.extend(stop);
                break;
            }
            left.push(*epoch);
            if is_stop(epoch) && epochs.peek().is_some_and(|&next| !is_stop(next)) {
                break;
            }
        }
        left
    }

    /// The epochs in which the robot stops instead of walking on with one of the cycle, if a step ends before it.
    fn stop_before(&self, epoch: &WalkEpoch, library: &PageLibrary) -> Option<Vec<WalkEpoch>> {
        let (Activity::Walk(behaviour), Step::Cycle { pages, line }) = (epoch.activity, epoch.step)
        else {
            return None;
        };
        let stop = library.gaits.get(behaviour)?.stop(pages)?;
        let mut line = line;
        let stop = stop.iter();
        Some(
            stop.map(|&page| line.step(&self.curve, behaviour, page, Step::Stop))
                .collect(),
        )
    }
}

/// The epochs of a way whose legs have these behaviours: each run of legs with one behaviour, and between points of
/// rest, from standing to standing.
pub(crate) fn walk_epochs(
    way: &Way,
    behaviours: &[usize],
    library: &PageLibrary,
) -> Vec<WalkEpoch> {
    let mut epochs = Vec::new();
    for run in runs(behaviours) {
        let rests = way.rests.iter().copied();
        let rests = rests.filter(|rest| run.start < *rest && *rest < run.end);
        let ends: Vec<usize> = rests.chain([run.end]).collect();
        let mut begin = run.start;
        for end in ends {
            let behaviour = behaviours[begin];
            if let (Some(gait), Some(&from_m), Some(&to_m)) = (
                library.gaits.get(behaviour),
                way.arcs_m.get(begin),
                way.arcs_m.get(end),
            ) {
                walk_run(&mut epochs, gait, behaviour, &way.curve, [from_m, to_m]);
            }
            begin = end;
        }
    }
    epochs
}

fn walk_run(
    epochs: &mut Vec<WalkEpoch>,
    gait: &Gait,
    behaviour: usize,
    curve: &Curve,
    [from_m, to_m]: [f64; 2],
) {
    let stride = gait.stride(to_m - from_m);
    let mut line = Line {
        from_m,
        scale: stride.scale,
        advanced_m: 0.0,
    };
    for &page in gait.start() {
        epochs.push(line.step(curve, behaviour, page, Step::Start));
    }
    for pages in 0..stride.cycle_pages {
        let step = Step::Cycle { pages, line };
        epochs.push(line.step(curve, behaviour, gait.cycle_page(pages), step));
    }
    for &page in gait.stop(stride.cycle_pages).unwrap_or_default() {
        epochs.push(line.step(curve, behaviour, page, Step::Stop));
    }
}

impl Line {
    /// Goes on by a page.
    fn step(&mut self, curve: &Curve, behaviour: usize, page: Page, step: Step) -> WalkEpoch {
        self.advanced_m += page.advance_m;
        let (place_m, direction) = curve.at(self.from_m + self.scale * self.advanced_m);
        WalkEpoch {
            activity: Activity::Walk(behaviour),
            page: page.number,
            place_m,
            direction,
            step,
        }
    }
}
