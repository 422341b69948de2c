//! Every kind of fault and disturbance against its definition, in episodes of one UAV axis that are seen at every step.

mod command;
mod company;
mod coupling;
mod friction;
mod independent;
mod measurement;
mod plant;
mod vortex;
mod wind;

use crate::common::{gains, repository, settings};
use urts_mc::backend::cpu::{Cpu, Precision};
use urts_mc::campaign::{Campaign, CampaignError};
use urts_mc::model::ChannelSample;

const STEP_S: f64 = 0.002;
const MASS_KG: f64 = 2.0;
const DRAG_N_S_M: f64 = 0.01;
const GRAVITY_M_S2: f64 = 9.81;
/// Of x.
const AMPLITUDE_M: f64 = 2.0;
const FREQUENCY_RAD_S: f64 = 1.5;
const X: usize = 0;

/// A second of a team of two under a PID: what is unwanted moves it by centimetres and no more.
const BASE: &str = r#"
name = "faults"
seed = 5
episodes = 4
controllers = ["pid"]
[time]
duration_s = 1.0
step_s = 0.002
[agent]
kind = "uav"
team = 2
mass_scale = 1.0
[reference]
kind = "sinusoid"
amplitude = [2.0, 1.0, 0.5, 0.0, 0.0, 0.0]
frequency_rad_s = [1.5, 1.0, 0.7, 1.0, 1.0, 1.0]
[synthesis]
preset = "uav-paper"
[initial]
error = 0.05
"#;

/// A campaign with some more of its file.
fn campaign(more: &str) -> Campaign {
    parsed(more, &[]).unwrap()
}

/// The same with changes laid over it.
fn parsed(more: &str, changes: &[&str]) -> Result<Campaign, CampaignError> {
    let path = repository("campaigns/faults.toml");
    Campaign::parse_with(&format!("{BASE}{more}"), &path, &settings(changes))
}

/// What every agent and channel shows at every step, `[step][agent][channel]`.
fn trajectory(campaign: &Campaign) -> Vec<Vec<Vec<ChannelSample>>> {
    let gains = gains(campaign);
    let cpu = Cpu::new(campaign.first_group(), &gains.loops(), Precision::F64, None);
    let (_, snapshots) = cpu.trace(0, 0, 1);
    assert_eq!(snapshots.len() as u32, campaign.time.steps + 1);
    snapshots
        .into_iter()
        .map(|snapshot| snapshot.agents)
        .collect()
}

/// What channel x of the first agent shows.
fn of_x(more: &str) -> Vec<ChannelSample> {
    let simulated = trajectory(&campaign(more));
    simulated.into_iter().map(|agents| agents[0][X]).collect()
}

/// The command that a channel of translation wanted: m e'' = u + F - K v - m r'' and u_wanted = m (r'' + told) + K r',
/// where no force F acts.
fn wanted(shown: &ChannelSample) -> f64 {
    shown.u - DRAG_N_S_M * shown.e_rate - MASS_KG * shown.f1
}

fn time_s(step: usize) -> f64 {
    step as f64 * STEP_S
}

/// x' of the first agent.
fn velocity(shown: &ChannelSample, step: usize) -> f64 {
    AMPLITUDE_M * FREQUENCY_RAD_S * (FREQUENCY_RAD_S * time_s(step)).cos() + shown.e_rate
}

/// Rounding of sums of some hundred newtons.
#[track_caller]
fn near(found: f64, expected: f64, what: &str) {
    assert!(
        (found - expected).abs() <= 1e-9,
        "{what}: {found} and not {expected}"
    );
}
