//! Full-order synthesis against an independent implementation, against the synthesis of a channel alone, and against
//! sensors that must be refused.
//!
//! The reference numbers and where they come from are in `tests/golden/full_order_synthesis.json`.

mod cases;
mod certificate;
mod confirmation;
mod gains;
mod sensors;

use nalgebra::DMatrix;
use serde_json::Value;
use std::sync::LazyLock;
use urts_mc::synthesis::{FullOrderSynthesis, synthesize_full_order};

static GOLDEN: LazyLock<Value> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../../golden/full_order_synthesis.json")).unwrap()
});

/// The reference cases of two channels and some of six, each synthesized once.
static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
    let pairs = ["kronecker", "rotated", "shared", "redundant", "no-rate"].map(|kind| (kind, 2));
    let more = [("rotated", 6), ("shared", 6), ("no-rate", 6)];
    let all = pairs.into_iter().chain(more);
    all.map(|(kind, n)| Case {
        kind,
        n,
        found: synthesize_full_order(&cases::design(), &cases::sensors(kind, n)).unwrap(),
    })
    .collect()
});

struct Case {
    kind: &'static str,
    n: usize,
    found: FullOrderSynthesis,
}

impl Case {
    fn name(&self) -> String {
        format!("{}-{}", self.kind, self.n)
    }

    /// A number of the reference.
    fn golden(&self, key: &str) -> f64 {
        GOLDEN["riccati"][self.name()][key].as_f64().unwrap()
    }
}

fn case(kind: &str, n: usize) -> &'static Case {
    let own = |case: &&Case| case.kind == kind && case.n == n;
    CASES.iter().find(own).unwrap()
}

fn matrix(rows: &[Vec<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

/// The largest difference in a row relative to the row's largest entry, over all rows that are not zero.
fn row_difference(found: &DMatrix<f64>, expected: &DMatrix<f64>) -> f64 {
    assert_eq!(found.shape(), expected.shape());
    let rows = found.row_iter().zip(expected.row_iter());
    let sizes = rows.map(|(found, expected)| (found - expected).amax() / expected.amax());
    sizes.filter(|size| size.is_finite()).fold(0.0, f64::max)
}
