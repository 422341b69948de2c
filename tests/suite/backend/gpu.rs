//! The GPU backend on whatever adapter there is; a software Vulkan will do, slowly.
//!
//! | module | holds |
//! |---|---|
//! | `agreement` | the comparison of episodes with the CPU's |
//! | `parity`, `bipeds` | every kind of campaign against double and single precision on the CPU |
//! | `faults` | all faults and disturbances at once |
//! | `mutations` | changed shaders and gains, each of which that comparison must notice |
//! | `determinism` | the same bits for any batch, span of steps, order and company |
//! | `spans` | the same bits for the shortest, the longest and adapted spans, also of large teams and many signals |
//! | `failures` | lost devices, shaders that do not compile, too little memory, too large teams |
//!
//! Without an adapter these tests print SKIPPED, unless URTS_REQUIRE_GPU=1 asks for one.

mod agreement;
mod bipeds;
mod determinism;
mod failures;
mod faults;
mod mutations;
mod parity;
mod spans;

use crate::common::{self, altered_file, further};
use urts_mc::agent::Agent;
use urts_mc::backend::EpisodeResult;
use urts_mc::backend::gpu::{Gpu, GpuError, GpuSimulator, Tuning};
use urts_mc::campaign::Campaign;
use urts_mc::synthesis::LoopGains;

/// Gains of every controller on every channel group.
type Gains = Vec<Vec<LoopGains>>;

/// The controllers for which the tolerances of the agreement were made. The errors of tuned ones are so small that the
/// rounding of a position is a larger part of them.
const CONTROLLERS: &str = "controllers=[\"ftc\", \"pid\", \"pid-robust-observer\"]";

/// A shipped campaign under these, with changes laid over it.
fn altered(name: &str, changes: &[&str]) -> Campaign {
    common::altered(name, &[&[CONTROLLERS], changes].concat())
}

/// A campaign of tests/suite/backend/gpu with changes laid over it.
fn gpu_campaign(name: &str, changes: &[&str]) -> Campaign {
    altered_file(&format!("tests/suite/backend/gpu/{name}.toml"), changes)
}

/// Everything at once.
fn mixed(changes: &[&str]) -> Campaign {
    gpu_campaign("mixed", changes)
}

/// Jets of rotors and nothing else, between UAVs whose paths cross.
fn jets(changes: &[&str]) -> Campaign {
    let brief = [
        "episodes=8",
        "time.duration_s=4.0",
        // Who is above another, and who beside, changes all the time.
        "reference.amplitude=[2.0, 1.5, 1.0, 0.0, 0.0, 0.0]",
        "reference.frequency_rad_s.2=2.5",
        "initial.observer=",
        JETS,
    ];
    altered("no-fault", &[&brief[..], changes].concat())
}

const JETS: &str = "
[[disturbance]]
kind = \"rotor-vortex\"
force_n = { uniform = [5.0, 15.0] }
radius_m = { uniform = [0.5, 1.5] }
length_m = { uniform = [0.5, 1.5] }
[[disturbance]]
kind = \"rotor-vortex\"
force_n = 4.0
radius_m = 3.0
length_m = 0.3
";

/// A link and actuators that fail together, under a sampled controller whose commands come late by half its period.
fn linked(changes: &[&str]) -> Campaign {
    let own = [
        "episodes=8",
        "time.duration_s=2.0",
        "initial.observer=",
        LINKED,
    ];
    altered("no-fault", &[&own[..], changes].concat())
}

const LINKED: &str = "
[control]
rate_hz = 250.0
delay_s = 0.002
[[fault]]
target = \"network\"
kind = \"denial-of-service\"
probability = 0.7
onset_s = { uniform = [0.4, 1.2] }
duration_s = 0.3
burst_s = 0.006
share = 0.4
[[fault]]
target = \"network\"
kind = \"replay\"
probability = 0.5
onset_s = { uniform = [0.5, 1.5] }
duration_s = 0.03
window_s = 0.014
[[fault]]
target = \"actuator\"
kind = \"float\"
probability = 0.7
onset_s = { uniform = [0.4, 1.5] }
duration_s = { uniform = [0.002, 0.03] }
[[fault]]
target = \"actuator\"
kind = \"loss-of-effectiveness\"
probability = 0.7
onset_s = { uniform = [0.4, 1.5] }
magnitude = { uniform = [0.1, 0.4] }
[[fault]]
target = \"actuator\"
kind = \"rate-limit\"
probability = 0.7
onset_s = { uniform = [0.4, 1.5] }
duration_s = 0.2
rate = { uniform = [200.0, 600.0] }
";

/// Everything at once that bipeds can meet. Their joints are damped, which those of the robots that are shipped are
/// not.
fn mixed_biped(changes: &[&str]) -> Campaign {
    gpu_campaign("mixed_biped", changes).with(|campaign| {
        if let Agent::Biped(biped) = &mut campaign.agent {
            let joints = biped.robot.legs.iter_mut().flat_map(|leg| &mut leg.joints);
            for (j, joint) in (1_u8..).zip(joints) {
                joint.damping_n_m_s = 0.02 * f64::from(j);
            }
        }
    })
}

/// [`mixed`] with thrust along the body axis.
fn mixed_thrust(changes: &[&str]) -> Campaign {
    let thrust = [
        "agent.actuation=thrust",
        "synthesis.preset=uav-physical",
        // Roll and pitch follow from the force, and x and y have no actuators.
        "reference.amplitude=[2.0, 1.5, 1.0, 0.0, 0.0, 0.3]",
        "reference.frequency_rad_s=[0.4, 0.5, 0.3, 0.0, 0.0, 0.2]",
        "reference.agents.1.phase_rad=[0.3, 0.7, 1.1, 0.0, 0.0, 0.6]",
        "fault.0.channels=[3]",
        "fault.2.channels=[3, 4, 5]",
        // What a UAV with one thrust can bear.
        "initial.error.normal.std=0.03",
        "initial.error_rate.normal.std=0.03",
        "coupling.kappa.choice=[0.0, 0.05, 20.0]",
        "disturbance.0.amplitude.uniform=[1.0, 5.0]",
        "disturbance.1.amplitude.normal.std=0.3",
        "fault.2.magnitude.uniform=[-0.3, 0.3]",
        "fault.3.magnitude.normal.std=0.005",
        "fault.4.amplitude.uniform=[0.02, 0.1]",
        "fault.5.std.log_uniform=[0.00001, 0.0002]",
        "fault.6.std=0.0005",
    ];
    mixed(&[&thrust, changes].concat())
}

/// The same with another number of UAVs, all of which have one reference.
fn team_of(base: &Campaign, team: usize) -> Campaign {
    let campaign = further(
        base,
        &[
            &format!("agent.team={team}"),
            "reference.agents=",
            "reference.center=[0.0, 0.0, 3.0, 0.0, 0.0, 0.0]",
        ],
    );
    assert_eq!(campaign.first_group().team, team);
    campaign
}

/// The longest spans that the adapter may take: parity holds with these, however fast the machine is.
const LONGEST: Tuning = Tuning {
    batch: None,
    steps: Some(u32::MAX),
};

/// Changes of [`mixed`]: 600 steps, so that there are two flushes of the metrics and 150 blocks of noise, and a rest.
const BRIEF: [&str; 5] = [
    "time.duration_s=1.2",
    "fault.0.onset_s.uniform=[0.4, 1.1]",
    "fault.2.onset_s=0.7007",
    "fault.4.onset_s.choice=[0.0, 0.5003]",
    "fault.6.onset_s.uniform=[0.5, 1.1]",
];

/// Changes of [`mixed`]: the same signals on all channels, so that the axes share their shaders; these take long to
/// compile.
const ALIKE: [&str; 3] = [
    "fault.1.channels=all",
    "fault.2.channels=all",
    "fault.5.channels=all",
];

/// Simulates a campaign batch by batch.
fn simulate_all(
    simulator: &mut GpuSimulator<'_>,
    campaign: &Campaign,
) -> Result<Vec<EpisodeResult>, GpuError> {
    let mut simulated = Vec::new();
    let mut first = 0;
    while first < campaign.episodes {
        let next = first
            .saturating_add(simulator.batch())
            .min(campaign.episodes);
        simulated.extend(simulator.simulate(first..next, &|_| ())?);
        first = next;
    }
    Ok(simulated)
}

/// Simulates a campaign on the GPU.
fn simulate(gpu: &Gpu, campaign: &Campaign, gains: &Gains, tuning: Tuning) -> Vec<EpisodeResult> {
    let mut simulator = GpuSimulator::new(gpu, campaign.first_group(), gains, tuning).unwrap();
    simulate_all(&mut simulator, campaign).unwrap()
}
