//! RRT-Connect (Kuffner and LaValle, "RRT-Connect: an efficient approach to single-query path planning", ICRA 2000).

use crate::mission::plane::{Point, between, distance, dot, minus};
use crate::mission::planner::segment::Space;

/// Nearer samples do not extend a tree, m.
const SAME_M: f64 = 1e-9;

/// Points, each with the index of the one that it was reached from.
struct Tree {
    nodes: Vec<(Point, Option<usize>)>,
}

impl Tree {
    fn new(root: Point) -> Self {
        Self {
            nodes: vec![(root, None)],
        }
    }

    fn add(&mut self, point: Point, parent: usize) -> usize {
        self.nodes.push((point, Some(parent)));
        self.nodes.len() - 1
    }

    /// The node nearest to a point and its place; of equally near ones the first.
    fn nearest(&self, point: Point) -> (usize, Point) {
        let square = |node: Point| {
            let way = minus(node, point);
            dot(way, way)
        };
        let mut best = (f64::INFINITY, 0, point);
        for (index, &(node, _)) in self.nodes.iter().enumerate() {
            let square = square(node);
            if square < best.0 {
                best = (square, index, node);
            }
        }
        (best.1, best.2)
    }

    /// The way from a node back to the root.
    fn way_back(&self, node: usize) -> impl Iterator<Item = Point> + '_ {
        let nodes = std::iter::successors(Some(node), |&node| self.nodes[node].1);
        nodes.map(|node| self.nodes[node].0)
    }
}

/// A way from `start` to `goal` as vertices, and the samples that it took; no way after `iterations` of them.
/// `unit` gives the random numbers by their index: 2i and 2i + 1 are the place of sample i.
pub(super) fn search(
    space: &Space<'_>,
    [start, goal]: [Point; 2],
    range_m: f64,
    iterations: u32,
    unit: impl Fn(u32) -> f64,
) -> (Option<Vec<Point>>, u32) {
    let area = space.world().area();
    let towards = |from: Point, to: Point| {
        let apart_m = distance(from, to);
        if apart_m <= range_m {
            to
        } else {
            between(from, to, range_m / apart_m)
        }
    };
    let mut trees = [Tree::new(start), Tree::new(goal)];
    for iteration in 0..iterations {
        // The trees take turns: the one extends towards the sample, the other tries to connect.
        let turn = usize::from(iteration % 2 == 1);
        let sample = area.at([unit(2 * iteration), unit(2 * iteration + 1)]);
        let (parent, from) = trees[turn].nearest(sample);
        let reached = towards(from, sample);
        if distance(from, sample) <= SAME_M || !space.is_free(from, reached) {
            continue;
        }
        let node = trees[turn].add(reached, parent);
        let other = &mut trees[1 - turn];
        let (mut last, mut place) = other.nearest(reached);
        loop {
            let next = towards(place, reached);
            if !space.is_free(place, next) {
                break;
            }
            if distance(place, reached) <= range_m {
                return (Some(joined(&trees, turn, [node, last])), iteration + 1);
            }
            last = other.add(next, last);
            place = next;
        }
    }
    (None, iterations)
}

/// The way through both trees, from the start: `nodes` are the end in the tree whose turn it was, and in the other.
fn joined(trees: &[Tree; 2], turn: usize, nodes: [usize; 2]) -> Vec<Point> {
    let mut way: Vec<Point> = trees[turn].way_back(nodes[0]).collect();
    way.reverse();
    way.extend(trees[1 - turn].way_back(nodes[1]));
    if turn == 1 {
        way.reverse();
    }
    way
}
