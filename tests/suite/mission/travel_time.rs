//! Travel times on the coarse grid.

use crate::mission::scenarios::*;
use urts_mc::mission::plane::Disc;
use urts_mc::mission::travel_time::CoarseGrid;

#[test]
fn val_times_on_free_ground_are_those_of_the_golden_file() {
    let golden = &GOLDEN["planner"]["dijkstra_free_10x10_1s_per_m"];
    let grid = CoarseGrid::uniform([10, 10], |_| false, 1.0).unwrap();
    let times = grid.times_to([0.5, 0.5], &[]);
    let at = |row: usize, column: usize| times.all_ms()[10 * row + column];
    for (row, column, key) in [(9, 9, "corner"), (0, 9, "side"), (5, 9, "mixed")] {
        assert_eq!(at(row, column), golden[key].as_u64(), "{key}");
    }
    assert_eq!(at(0, 0), Some(0));
}

#[test]
fn ways_do_not_cut_the_corners_of_blocked_cells() {
    // A wall in column 2 with a door in its top row.
    let grid = CoarseGrid::uniform([5, 5], |cell| cell % 5 == 2 && cell < 20, 1.0).unwrap();
    let times = grid.times_to([0.5, 4.5], &[]);
    // Through the door straight on; a cell below its level needs a step down behind the wall's column.
    assert_eq!(times.from_ms([4.5, 4.5]), Some(4000));
    assert_eq!(times.from_ms([3.5, 3.5]), Some(3000 + 1000));
    // Blocked itself: the best cell around it and a second more.
    assert_eq!(times.from_ms([2.5, 3.5]), Some(1000 + 1000));
    let closed = CoarseGrid::uniform([5, 5], |cell| cell % 5 == 2, 1.0).unwrap();
    assert_eq!(closed.times_to([0.5, 4.5], &[]).from_ms([4.5, 4.5]), None);
}

#[test]
fn an_obstacle_that_becomes_known_blocks_cells_and_slow_ground_costs_more() {
    let grid = PAPER.grid();
    let target = [20.0, 30.0];
    let free = grid.times_to(target, &[]);
    // On the road to the north at 0.5 m/s: the middle of the target's cell is 10 cells from that of the start's.
    assert_eq!(free.from_ms([20.5, 20.5]), Some(20_000));
    let disc = Disc {
        centre_m: [20.5, 25.5],
        radius_m: 1.0,
    };
    let blocked = grid.times_to(target, &[disc]);
    assert!(blocked.from_ms([20.5, 20.5]) > free.from_ms([20.5, 20.5]));
}
