//! The loop of a robot's FTC against the paper's formulas in double precision, with the dynamics of `robot::dynamics`:
//! no tables, no reduced operations, the full matrices of (19) and (20).

use super::everything;
use crate::common::gains;
use nalgebra::{SMatrix, SVector, Vector3, Vector6};
use urts_mc::agent::Agent;
use urts_mc::agent::robot::dynamics::{bias_force, mass_matrix};
use urts_mc::agent::robot::{JOINTS, Joint, LEG_JOINTS, Robot};
use urts_mc::backend::cpu::{Cpu, Precision};
use urts_mc::campaign::{Campaign, DisturbanceKind, FaultKind, FaultTarget};
use urts_mc::draw::{AgentDraw, Episode, draw};
use urts_mc::model::ChannelSample;
use urts_mc::synthesis::LoopGains;

/// Steps that are compared: every fault begins among them.
const STEPS: u32 = 200;

type Joints = SVector<f64, JOINTS>;
/// int e, e, e' and ehat (7 rows), a column per joint.
type State = SMatrix<f64, 10, JOINTS>;

struct World {
    campaign: Campaign,
    robot: Robot,
    episode: Episode,
    gains: LoopGains,
}

/// What an agent does at one instant.
struct Answer {
    slope: State,
    reference: Joints,
    /// x'' - r''.
    error_acceleration: Joints,
    told: Joints,
    command: Joints,
    sensor_fault: Joints,
}

fn row(state: &State, row: usize) -> Joints {
    state.row(row).transpose()
}

/// One after the other for both legs.
fn each_leg(f: impl Fn(usize) -> Vector6<f64>) -> Joints {
    let legs = [f(0), f(1)];
    Joints::from_fn(|c, _| legs[c / LEG_JOINTS][c % LEG_JOINTS])
}

fn of_leg(joints: &Joints, leg: usize) -> Vector6<f64> {
    joints.fixed_rows::<LEG_JOINTS>(LEG_JOINTS * leg).into()
}

impl World {
    fn new(campaign: Campaign, index: u32) -> Self {
        let Agent::Biped(biped) = &campaign.first_group().agent else {
            panic!("a campaign of robots");
        };
        Self {
            robot: biped.robot.clone(),
            episode: draw(campaign.first_group(), index),
            gains: gains(&campaign).loops()[0][0],
            campaign,
        }
    }

    fn reference(&self, agent: usize, t_s: f64) -> [Joints; 3] {
        let points = self.campaign.first_group().reference.at(agent, t_s);
        [
            Joints::from_fn(|c, _| points[c].value),
            Joints::from_fn(|c, _| points[c].rate),
            Joints::from_fn(|c, _| points[c].acceleration),
        ]
    }

    /// d1 without the coupling, at the rates of the joints.
    fn disturbance(&self, agent: usize, t_s: f64, rate: &Joints) -> Joints {
        let drawn = &self.episode.agents[agent].disturbances;
        let kinds = self
            .campaign
            .first_group()
            .disturbances
            .iter()
            .map(|entry| entry.kind);
        let mut sum = Joints::zeros();
        for (kind, drawn) in kinds.zip(drawn) {
            let reference = &self.campaign.first_group().reference;
            let ground = reference.ground_reaction(&self.robot, agent, t_s);
            sum += Joints::from_fn(|c, _| match kind {
                DisturbanceKind::Sine => drawn[0][c] * (drawn[1][c] * t_s + drawn[2][c]).sin(),
                DisturbanceKind::Constant => drawn[0][c],
                DisturbanceKind::GroundReaction => drawn[0][c] * ground[c],
                DisturbanceKind::Friction => {
                    -drawn[0][c] * (rate[c] / drawn[2][c]).tanh() - drawn[1][c] * rate[c]
                }
                DisturbanceKind::Gust1Cosine
                | DisturbanceKind::Dryden
                | DisturbanceKind::RotorVortex => {
                    panic!("neither wind nor rotors act on joints")
                }
            });
        }
        sum
    }

    /// f2, and what actuator faults leave of and add to the command; steps switch at the start of a step.
    fn faults(&self, agent: usize, step: u32, t_s: f64) -> [Joints; 3] {
        let (mut sensor, mut left, mut added) =
            (Joints::zeros(), Joints::repeat(1.0), Joints::zeros());
        let drawn = &self.episode.agents[agent].faults;
        for (fault, drawn) in self.campaign.first_group().faults.iter().zip(drawn) {
            let begun = step >= self.campaign.time.onset_step(drawn.onset_s);
            for c in (0..JOINTS).filter(|&c| begun && drawn.strikes[c]) {
                let value = |k: usize| drawn.parameters[k][c];
                match (fault.target, fault.kind) {
                    (FaultTarget::Actuator, FaultKind::LossOfEffectiveness) => {
                        left[c] *= 1.0 - value(0);
                    }
                    (FaultTarget::Actuator, FaultKind::Bias) => added[c] += value(0),
                    (FaultTarget::Sensor, FaultKind::Bias) => sensor[c] += value(0),
                    (FaultTarget::Sensor, FaultKind::SmoothedSquare) => {
                        let turn = std::f64::consts::TAU * t_s / value(1) + value(3);
                        sensor[c] += value(0) * (turn.sin() / value(2)).tanh();
                    }
                    other => panic!("{other:?} is not written down here"),
                }
            }
        }
        [sensor, left, added]
    }

    /// The team at a time within a step.
    fn answers(&self, team: &[State], step: u32, t_s: f64) -> Vec<Answer> {
        let positions: Vec<Joints> = (0..team.len())
            .map(|agent| self.reference(agent, t_s)[0] + row(&team[agent], 1))
            .collect();
        (0..team.len())
            .map(|agent| {
                let others = positions.iter().enumerate().filter(|(k, _)| *k != agent);
                let others: Joints = others.map(|(_, x)| x).sum();
                let coupling = positions[agent].component_mul(&others);
                self.answer(agent, &team[agent], coupling, step, t_s)
            })
            .collect()
    }

    fn answer(&self, agent: usize, state: &State, coupling: Joints, step: u32, t_s: f64) -> Answer {
        let drawn: &AgentDraw = &self.episode.agents[agent];
        let [r, r_rate, r_acceleration] = self.reference(agent, t_s);
        let gravity = &self.robot.gravity_m_s2;
        let legs = &self.robot.legs;

        // (21), (9).
        let k = SMatrix::<f64, 1, 7>::from_row_slice(&self.gains.k);
        let feedback: Joints = (k * state.fixed_rows::<7>(3)).transpose();
        let modelled = |leg: usize| {
            let (r, rate) = (of_leg(&r, leg), of_leg(&r_rate, leg));
            let mass = mass_matrix(&legs[leg], &r);
            (mass, bias_force(&legs[leg], gravity, &r, &rate))
        };
        let wanted = each_leg(|leg| {
            let (mass, bias) = modelled(leg);
            mass * of_leg(&(r_acceleration + feedback), leg) + bias
        });
        let limits = self.robot.joints().map(|joint| joint.torque_max_n_m);
        let limits = Joints::from_iterator(limits);
        let (mut limited, mut told) = (wanted, feedback);
        if self.campaign.first_group().is_limited() {
            limited = Joints::from_fn(|c, _| wanted[c].clamp(-limits[c], limits[c]));
            told = each_leg(|leg| {
                let (mass, bias) = modelled(leg);
                mass.lu().solve(&(of_leg(&limited, leg) - bias)).unwrap()
                    - of_leg(&r_acceleration, leg)
            });
        }
        let [sensor_fault, left, added] = self.faults(agent, step, t_s);
        let command = left.component_mul(&limited) + added;

        // (4) of the true robot, whose M and H are those of the model times a number; (11).
        let (q, rate) = (r + row(state, 1), r_rate + row(state, 2));
        let force = self.disturbance(agent, t_s, &rate) + drawn.kappa * coupling;
        let acceleration = each_leg(|leg| {
            let (q, rate) = (of_leg(&q, leg), of_leg(&rate, leg));
            let bias = drawn.mass_scale * bias_force(&legs[leg], gravity, &q, &rate);
            let mass = drawn.mass_scale * mass_matrix(&legs[leg], &q);
            let torque = of_leg(&(command + force), leg);
            mass.lu().solve(&(torque - bias)).unwrap()
        });
        let error_acceleration = acceleration - r_acceleration;

        // (20), with the two taps of each fault that feed back.
        let [a, b, c] = self.gains.smoothing;
        let mut observer = SMatrix::<f64, 7, 7>::zeros();
        observer[(0, 1)] = 1.0;
        observer[(1, 2)] = 1.0;
        observer[(2, 3)] = 1.0;
        for first in [3, 5] {
            observer[(first, first)] = a;
            observer[(first, first + 1)] = b;
            observer[(first + 1, first)] = c;
            observer[(first + 1, first + 1)] = -c;
        }
        let l = SMatrix::<f64, 7, 3>::from_fn(|i, j| self.gains.l[i][j]);
        let b20: Vector3<f64> = self.gains.sensor_fault_input.into();
        let estimate = state.fixed_rows::<7>(3);
        let mut slope = State::zeros();
        for joint in 0..JOINTS {
            let true_errors = Vector3::from(state.fixed_view::<3, 1>(0, joint));
            let measured = true_errors + b20 * sensor_fault[joint];
            let estimated = Vector3::from(estimate.fixed_view::<3, 1>(0, joint));
            let expected = estimated + b20 * estimate[(5, joint)];
            let mut own = observer * estimate.column(joint) - l * (measured - expected);
            own[2] += told[joint];
            slope[(0, joint)] = state[(1, joint)];
            slope[(1, joint)] = state[(2, joint)];
            slope[(2, joint)] = error_acceleration[joint];
            slope.fixed_view_mut::<7, 1>(3, joint).copy_from(&own);
        }
        Answer {
            slope,
            reference: r,
            error_acceleration,
            told,
            command,
            sensor_fault,
        }
    }

    /// ehat(0) = y(0) - C0 r(0), F = 0.
    fn start(&self, agent: usize) -> State {
        let drawn = &self.episode.agents[agent];
        let [f2, ..] = self.faults(agent, 0, 0.0);
        let b20 = self.gains.sensor_fault_input;
        let errors = [&drawn.error_integral, &drawn.error, &drawn.error_rate];
        let mut state = State::zeros();
        for joint in 0..JOINTS {
            for k in 0..3 {
                state[(k, joint)] = errors[k][joint];
                state[(3 + k, joint)] = errors[k][joint] + b20[k] * f2[joint];
            }
        }
        state
    }

    /// What the team shows at every step, by the classical Runge-Kutta method.
    fn simulate(&self) -> Vec<Vec<[ChannelSample; JOINTS]>> {
        let h = self.campaign.time.step_s;
        let mut team: Vec<State> = (0..self.campaign.first_group().team)
            .map(|a| self.start(a))
            .collect();
        let mut shown = vec![];
        for step in 0..=STEPS {
            let t_s = f64::from(step) * h;
            let slopes = |team: &[State], t_s: f64| -> Vec<State> {
                let answers = self.answers(team, step, t_s);
                answers.into_iter().map(|answer| answer.slope).collect()
            };
            let ahead = |slopes: &[State], h: f64| -> Vec<State> {
                let states = team.iter().zip(slopes);
                states.map(|(state, slope)| state + slope * h).collect()
            };
            let now = self.answers(&team, step, t_s);
            shown.push((0..team.len()).map(|a| show(&team[a], &now[a])).collect());
            let k1: Vec<State> = now.iter().map(|answer| answer.slope).collect();
            let k2 = slopes(&ahead(&k1, h / 2.0), t_s + h / 2.0);
            let k3 = slopes(&ahead(&k2, h / 2.0), t_s + h / 2.0);
            let k4 = slopes(&ahead(&k3, h), t_s + h);
            for (a, state) in team.iter_mut().enumerate() {
                *state += (k1[a] + (k2[a] + k3[a]) * 2.0 + k4[a]) * (h / 6.0);
            }
        }
        shown
    }
}

fn show(state: &State, answer: &Answer) -> [ChannelSample; JOINTS] {
    std::array::from_fn(|c| ChannelSample {
        r: answer.reference[c],
        x: answer.reference[c] + state[(1, c)],
        e: state[(1, c)],
        e_rate: state[(2, c)],
        e_hat: state[(4, c)],
        f1: answer.error_acceleration[c] - answer.told[c],
        f1_hat: state[(6, c)],
        f2: answer.sensor_fault[c],
        f2_hat: state[(8, c)],
        u: answer.command[c],
    })
}

/// A name and where a channel shows it.
type Quantity = (&'static str, fn(&ChannelSample) -> f64);
/// What is compared.
const QUANTITIES: [Quantity; 10] = [
    ("r", |shown| shown.r),
    ("x", |shown| shown.x),
    ("e", |shown| shown.e),
    ("e'", |shown| shown.e_rate),
    ("ehat", |shown| shown.e_hat),
    ("f1", |shown| shown.f1),
    ("f1hat", |shown| shown.f1_hat),
    ("f2", |shown| shown.f2),
    ("f2hat", |shown| shown.f2_hat),
    ("u", |shown| shown.u),
];

/// Of each quantity the largest difference from the formulas over all robots, joints and steps, relative to its largest
/// value.
fn differences(campaign: &Campaign, world: &World) -> Vec<(&'static str, f64)> {
    let gains = gains(campaign);
    let cpu = Cpu::new(campaign.first_group(), &gains.loops(), Precision::F64, None);
    let snapshots = cpu.trace(world.episode.index, 0, 1).1;
    let expected = world.simulate();
    let pairs = || {
        let steps = snapshots.iter().zip(&expected);
        let agents = steps.flat_map(|(ours, theirs)| ours.agents.iter().zip(theirs));
        agents.flat_map(|(ours, theirs)| ours.iter().zip(theirs))
    };
    assert_eq!(pairs().count(), 201 * 3 * JOINTS);
    // The first steps want more torque than the joints have.
    let joints: Vec<&Joint> = world.robot.joints().collect();
    let of_joints = joints.iter().cycle().zip(pairs());
    let at_limit = of_joints.filter(|(joint, (_, theirs))| theirs.u.abs() >= joint.torque_max_n_m);
    let at_limit = at_limit.count();
    assert!((10..1000).contains(&at_limit), "{at_limit} torques");
    let compare = |(name, pick): Quantity| {
        let largest = pairs().fold(0.0, |m: f64, (_, theirs)| m.max(pick(theirs).abs()));
        let difference = pairs().fold(0.0, |m: f64, (ours, theirs)| {
            let d = (pick(ours) - pick(theirs)).abs();
            if d <= m { m } else { d }
        });
        (name, difference / largest)
    };
    QUANTITIES.map(compare).to_vec()
}

/// Rounding, amplified by matrices of condition 1e3, over 200 steps of a loop that forgets.
const TOLERANCE: f64 = 1e-12;

#[test]
fn val_the_loop_of_a_robot_follows_the_formulas_of_the_paper() {
    for actuation in ["full", "limited"] {
        let campaign = everything(actuation);
        let world = World::new(campaign.clone(), 3);
        let (began, later): (Vec<u32>, Vec<u32>) = world
            .episode
            .agents
            .iter()
            .flat_map(|agent| &agent.faults)
            .map(|fault| campaign.time.onset_step(fault.onset_s))
            .partition(|&step| step == 0);
        assert!(!began.is_empty() && later.len() == 6 && later.iter().all(|&step| step < STEPS));
        for (name, difference) in differences(&campaign, &world) {
            println!("{actuation} {name}: {difference:.1e}");
            assert!(
                difference <= TOLERANCE,
                "{actuation}: {name} differs by {difference:e}"
            );
        }
    }
}

/// A number and how to change it.
type Change<'a> = (&'a str, &'a dyn Fn(&mut AgentDraw));

#[test]
fn the_formulas_notice_a_changed_number_of_every_draw() {
    let campaign = everything("limited");
    let worst = |change: &dyn Fn(&mut AgentDraw)| {
        let mut world = World::new(campaign.clone(), 3);
        change(&mut world.episode.agents[0]);
        let differences = differences(&campaign, &world);
        differences.into_iter().fold(0.0, |m: f64, (_, d)| m.max(d))
    };
    let changes: [Change<'_>; 8] = [
        ("mass", &|draw| draw.mass_scale *= 1.0 + 1e-6),
        ("coupling", &|draw| draw.kappa *= 1.0 + 1e-6),
        ("ground", &|draw| draw.disturbances[0][0][4] *= 1.0 + 1e-6),
        ("sine", &|draw| draw.disturbances[1][0][4] *= 1.0 + 1e-6),
        ("sensor bias", &|draw| {
            draw.faults[0].parameters[0][4] += 1e-6;
        }),
        ("loss", &|draw| draw.faults[2].parameters[0][4] += 1e-6),
        ("onset of the loss", &|draw| draw.faults[2].onset_s += 0.002),
        ("bias", &|draw| {
            for value in &mut draw.faults[3].parameters[0] {
                *value += 1e-6;
            }
        }),
    ];
    assert!(worst(&|_| ()) <= TOLERANCE);
    for (name, change) in changes {
        let worst = worst(change);
        println!("{name}: {worst:.1e}");
        assert!(worst > TOLERANCE, "{name} changes nothing: {worst:e}");
    }
}
