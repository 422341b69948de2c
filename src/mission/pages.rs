//! Gaits as pages: what a robot's legs do during one epoch, and how far it goes on with it.

use thiserror::Error;

use crate::mission::plane::{count, number};

/// One epoch of a gait.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Page {
    /// Its number among all pages.
    pub number: u32,
    /// How far the robot goes, m.
    pub advance_m: f64,
}

/// The pages of one gait: those that begin a walk, those that repeat, those that end it.
#[derive(Clone, Debug, PartialEq)]
pub struct Gait {
    name: String,
    start: Vec<Page>,
    cycle: Vec<Page>,
    stop: Vec<Option<Vec<Page>>>,
}

/// All gaits of a mission, and the page of a robot that stands.
#[derive(Clone, Debug, PartialEq)]
pub struct PageLibrary {
    /// The page of standing.
    pub stand: u32,
    /// The gaits; a behaviour is an index of this list.
    pub gaits: Vec<Gait>,
}

/// How many pages of its cycle a gait takes for a way, and what their advances are multiplied by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stride {
    pub(crate) cycle_pages: usize,
    pub(crate) scale: f64,
}

/// Why pages make no gait.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PagesError {
    /// A page goes backwards, or its advance is not finite.
    #[error("gait {gait}: page {page} advances by {advance_m} m and must go forward or stand")]
    Advance {
        /// The gait's name.
        gait: String,
        /// The page's number.
        page: u32,
        /// Its advance, m.
        advance_m: f64,
    },
    /// Repeating the cycle does not bring the robot forward.
    #[error("gait {gait}: its cycle of {pages} pages goes nowhere; give it pages that advance")]
    Nowhere {
        /// The gait's name.
        gait: String,
        /// Pages of its cycle.
        pages: usize,
    },
    /// It is not said how the walk ends after each page of the cycle.
    #[error(
        "gait {gait}: {stops} ways to stop are given for a cycle of {pages} pages; give one for each page after which \
         a step ends, the first for whole cycles"
    )]
    Stops {
        /// The gait's name.
        gait: String,
        /// Ways to stop.
        stops: usize,
        /// Pages of its cycle.
        pages: usize,
    },
}

impl Gait {
    /// The gait with pages to `start`, to repeat (`cycle`) and to `stop`: `stop[j]` ends the walk after whole cycles
    /// and `j` more pages, and is `None` where no step ends there.
    ///
    /// # Errors
    /// If a page goes backwards, the cycle goes nowhere, or there is not one entry of `stop` for every page of the
    /// cycle, the first of them with pages.
    pub fn new(
        name: &str,
        start: Vec<Page>,
        cycle: Vec<Page>,
        stop: Vec<Option<Vec<Page>>>,
    ) -> Result<Self, PagesError> {
        let gait = name.to_string();
        let pages = || {
            start
                .iter()
                .chain(&cycle)
                .chain(stop.iter().flatten().flatten())
        };
        if let Some(page) =
            pages().find(|page| !(page.advance_m >= 0.0 && page.advance_m.is_finite()))
        {
            return Err(PagesError::Advance {
                gait,
                page: page.number,
                advance_m: page.advance_m,
            });
        }
        let (cycle_pages, stops) = (cycle.len(), stop.len());
        // A comparison with zero that refuses an empty cycle as well.
        if total_m(&cycle) <= 0.0 {
            return Err(PagesError::Nowhere {
                gait,
                pages: cycle_pages,
            });
        }
        let ends = matches!(stop.first(), Some(Some(pages)) if !pages.is_empty());
        if stops != cycle_pages || !ends {
            return Err(PagesError::Stops {
                gait,
                stops,
                pages: cycle_pages,
            });
        }
        Ok(Self {
            name: gait,
            start,
            cycle,
            stop,
        })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How far the robot goes in an epoch of its cycle, m.
    #[must_use]
    pub fn advance_m(&self) -> f64 {
        total_m(&self.cycle) / number(self.cycle.len())
    }

    /// The pages that begin a walk.
    #[must_use]
    pub fn start(&self) -> &[Page] {
        &self.start
    }

    /// The `index`-th page of a walk after those that begin it.
    #[must_use]
    pub fn cycle_page(&self, index: usize) -> Page {
        self.cycle[index % self.cycle.len()]
    }

    /// The pages that end a walk after so many pages of the cycle; none if no step ends there.
    #[must_use]
    pub fn stop(&self, cycle_pages: usize) -> Option<&[Page]> {
        self.stop[cycle_pages % self.cycle.len()].as_deref()
    }

    /// The fewest pages of the cycle that reach over `length_m`, and the share to which the advances of all pages of
    /// the walk are then reduced, so that it ends there.
    pub(crate) fn stride(&self, length_m: f64) -> Stride {
        let reach_m = |cycle_pages: usize| {
            let cycles = number(cycle_pages / self.cycle.len()) * total_m(&self.cycle);
            let rest = total_m(&self.cycle[..cycle_pages % self.cycle.len()]);
            let stop = self.stop(cycle_pages).map(total_m);
            stop.map(|stop| total_m(&self.start) + cycles + rest + stop)
        };
        // Before this number the walk is too short even with the longest way to stop.
        let stops = self.stop.iter().flatten().map(|pages| total_m(pages));
        let ends_m = total_m(&self.start) + stops.fold(0.0, f64::max) + total_m(&self.cycle);
        let least = count((length_m - ends_m) / total_m(&self.cycle)) * self.cycle.len();
        // Lengths of whole pages, up to rounding, take no further page.
        let rounding_m = 1e-9 * self.advance_m();
        let enough = |cycle_pages: &usize| {
            reach_m(*cycle_pages).is_some_and(|reach_m| length_m <= reach_m + rounding_m)
        };
        // A further cycle reaches farther by its length, so the search ends.
        let cycle_pages = (least..).find(enough).unwrap_or(least);
        let reach_m = reach_m(cycle_pages).unwrap_or(length_m);
        Stride {
            cycle_pages,
            scale: if reach_m > 0.0 {
                length_m / reach_m
            } else {
                0.0
            },
        }
    }
}

impl PageLibrary {
    /// A library of points that walk: gaits of a name and a length per epoch `d`, which start with advances 0 and d/2,
    /// repeat d, and stop with d/2 and 0. Decisions are tested with it; its pages have no joints.
    ///
    /// # Errors
    /// If a length is not positive.
    pub fn of_points(gaits: &[(&str, f64)]) -> Result<Self, PagesError> {
        let gait = |(index, &(name, d)): (usize, &(&str, f64))| {
            // Five pages of each gait follow the page of standing.
            let first = u32::try_from(5 * index + 1).unwrap_or(u32::MAX);
            let page = |number: u32, advance_m: f64| Page {
                number: first.saturating_add(number),
                advance_m,
            };
            let start = vec![page(0, 0.0), page(1, d / 2.0)];
            let stop = vec![page(3, d / 2.0), page(4, 0.0)];
            Gait::new(name, start, vec![page(2, d)], vec![Some(stop)])
        };
        let gaits = gaits.iter().enumerate().map(gait);
        Ok(Self {
            stand: 0,
            gaits: gaits.collect::<Result<_, _>>()?,
        })
    }

    /// How far a robot goes in an epoch of a behaviour's cycle, m; zero if there is no such behaviour.
    #[must_use]
    pub fn advance_m(&self, behaviour: usize) -> f64 {
        self.gaits.get(behaviour).map_or(0.0, Gait::advance_m)
    }
}

fn total_m(pages: &[Page]) -> f64 {
    pages.iter().map(|page| page.advance_m).sum()
}
