//! Optimal assignment.

use crate::mission::scenarios::GOLDEN;
use urts_mc::mission::assignment::{Costs, INFEASIBLE_MS, Pair};

fn costs(rows: &[Vec<i64>]) -> Costs {
    let columns = rows.first().map_or(0, Vec::len);
    Costs::new([rows.len(), columns], |row, column| rows[row][column])
}

/// The least sum over all ways to give as many rows as possible a column of their own, by trying all.
fn brute_force(rows: &[Vec<i64>]) -> i64 {
    fn search(rows: &[Vec<i64>], row: usize, taken: &mut Vec<bool>, left: usize) -> i64 {
        if left == 0 {
            return 0;
        }
        if row == rows.len() {
            return i64::MAX / 4;
        }
        let mut best = search(rows, row + 1, taken, left);
        for column in 0..taken.len() {
            if !taken[column] {
                taken[column] = true;
                best = best.min(rows[row][column] + search(rows, row + 1, taken, left - 1));
                taken[column] = false;
            }
        }
        best
    }
    let columns = rows[0].len();
    search(rows, 0, &mut vec![false; columns], rows.len().min(columns))
}

#[test]
fn val_assignments_are_optimal_in_the_golden_cases() {
    let cases = GOLDEN["assignment"].as_array().unwrap();
    assert_eq!(cases.len(), 8);
    for case in cases {
        let rows = case["cost"].as_array().unwrap().iter();
        let rows: Vec<Vec<i64>> = rows
            .map(|row| {
                row.as_array()
                    .unwrap()
                    .iter()
                    .map(|x| x.as_i64().unwrap())
                    .collect()
            })
            .collect();
        let pairs = costs(&rows).optimum();
        let sum: i64 = pairs.iter().map(|pair| pair.cost_ms).sum();
        assert_eq!(sum, case["optimum"].as_i64().unwrap(), "{}", case["name"]);
        let ours = serde_json::json!(
            pairs
                .iter()
                .map(|pair| [pair.row, pair.column])
                .collect::<Vec<_>>()
        );
        let optimal = case["optimal"].as_array().unwrap();
        assert!(optimal.contains(&ours), "{}: {ours}", case["name"]);
    }
}

#[test]
fn val_assignments_are_optimal_among_all() {
    let unit = |k: u32| crate::mission::world::unit(9, k);
    let mut k = 0;
    let mut next = |n: f64| {
        k += 1;
        (n * unit(k)) as i64
    };
    for _ in 0..300 {
        let size = [1 + next(6.0), 1 + next(6.0)].map(|side| usize::try_from(side).unwrap());
        let row = |next: &mut dyn FnMut(f64) -> i64| (0..size[1]).map(|_| next(100.0)).collect();
        let rows: Vec<Vec<i64>> = (0..size[0]).map(|_| row(&mut next)).collect();
        let pairs = costs(&rows).optimum();
        assert_eq!(pairs.len(), size[0].min(size[1]));
        let sum: i64 = pairs.iter().map(|pair| pair.cost_ms).sum();
        assert_eq!(sum, brute_force(&rows), "{rows:?}");
    }
}

#[test]
fn pairs_that_are_not_possible_stay_open() {
    let never = INFEASIBLE_MS;
    let pairs = costs(&[vec![never, never], vec![never, 7], vec![5 * never, 9]]).optimum();
    let only = Pair {
        row: 1,
        column: 1,
        cost_ms: 7,
    };
    assert_eq!(pairs, [only]);
}

#[test]
fn nothing_is_assigned_where_there_is_nobody_or_nothing() {
    assert!(Costs::new([0, 3], |_, _| 1).optimum().is_empty());
    assert!(Costs::new([3, 0], |_, _| 1).optimum().is_empty());
}
