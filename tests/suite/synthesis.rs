//! Controller synthesis against an independent implementation, against itself
//! in other coordinates, and against gains and designs that must be refused.
//!
//! The reference numbers and their tolerances, each with its reason, are in `tests/golden/synthesis.json`.

use nalgebra::{Complex, DMatrix};
use serde_json::Value;
use std::sync::LazyLock;
use urts_mc::agent::ChannelRole;
use urts_mc::synthesis::{
    ChannelDesign, ChannelSynthesis, ControllerGains, LOOP_STATES, Preset, Smoothing,
    SmoothingRule, Step, SynthesisError, Verified, augmented_channel, feedback_riccati,
    geometric_q2, loop_gains, observer_riccati, pid_gains, pid_robust_observer_gains, poles,
    synthesize, verify,
};

mod certificate;
mod designs;
mod full_order;
mod lapack;
mod loop_form;
mod pid_shape;
mod placed;
mod reference;
mod refusals;
mod responses;

static GOLDEN: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("../golden/synthesis.json")).unwrap());

/// The reference blocks, the preset channel each belongs to, and its synthesis (made once).
static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
    [
        ("uav_paper", Preset::UavPaper),
        ("robot_paper", Preset::BipedPaper),
        ("uav_position_physical", Preset::UavPhysical),
    ]
    .map(|(name, preset)| {
        let design = preset.designs()[0].1.clone();
        Case {
            name,
            golden: &GOLDEN[name],
            synthesis: synthesize(&design).unwrap(),
            reference: verify(&design, &reference_gains(&GOLDEN[name])).unwrap(),
            design,
        }
    })
    .into()
});

struct Case {
    name: &'static str,
    golden: &'static Value,
    design: ChannelDesign,
    synthesis: ChannelSynthesis,
    /// What our verification says about the reference gains.
    reference: Verified,
}

fn reference_gains(golden: &Value) -> ControllerGains {
    ControllerGains {
        k: matrix(&golden["K"]).iter().copied().collect(),
        l: matrix(&golden["L"])
            .row_iter()
            .map(|r| [r[0], r[1], r[2]])
            .collect(),
    }
}

impl Case {
    fn matrix(&self, key: &str) -> DMatrix<f64> {
        matrix(&self.golden[key])
    }
}

fn uav() -> &'static Case {
    &CASES[0]
}

fn tolerance(key: &str) -> f64 {
    GOLDEN["tolerances"][key].as_f64().unwrap()
}

fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = serde_json::from_value(value.clone()).unwrap();
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

fn row(k: &[f64]) -> DMatrix<f64> {
    DMatrix::from_row_slice(1, k.len(), k)
}

fn column_of_rows(l: &[[f64; 3]]) -> DMatrix<f64> {
    DMatrix::from_fn(l.len(), 3, |i, j| l[i][j])
}

/// The largest difference relative to the largest entry of `expected`.
fn relative_difference(found: &DMatrix<f64>, expected: &DMatrix<f64>) -> f64 {
    assert_eq!(found.shape(), expected.shape());
    (found - expected).amax() / expected.amax()
}

#[track_caller]
fn assert_close(what: &str, found: f64, expected: f64, relative: f64) {
    let difference = (found / expected - 1.0).abs();
    assert!(
        difference <= relative,
        "{what}: {found} is not {expected}: relative difference {difference:e} above {relative:e}"
    );
}
