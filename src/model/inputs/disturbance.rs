//! From the draws of a disturbance to what it does to an agent's channels: the one place that says what each kind
//! means.

use super::block::{LaneBlock, Selection};
use crate::agent::{FIRST_ATTITUDE, HEIGHT};
use crate::campaign::kinds::{
    AIRSPEED, ALTITUDE, AMPLITUDE, COULOMB, FREQUENCY, GUST_DURATION, GUST_ONSET, GUST_SPEED,
    JET_FORCE, JET_LENGTH, JET_RADIUS, MEAN_WIND, PHASE, SERIES_SHARE, SMOOTHING_RATE, VISCOUS,
    WIND_GAIN,
};
use crate::campaign::{Disturbance, DisturbanceKind, Parameter};
use crate::draw::{AgentDraw, member};
use crate::model::exogenous::ExogenousInputs;
use crate::model::exogenous::dryden::{Dryden, at_rest};
use crate::model::exogenous::friction::Friction;
use crate::model::exogenous::lists::Oscillation;
use crate::model::exogenous::noise::{Filter, Turbulence};
use crate::model::exogenous::vortex::Vortex;
use crate::model::exogenous::window::Window;
use crate::model::lanes::{Lane, MAX_WIDTH};
use crate::random::philox::{Address, Stream};
use std::f64::consts::TAU;

impl LaneBlock<'_> {
    /// Adds what a disturbance does, if it may act (or does) in some lane.
    pub(super) fn add_disturbance<L: Lane, const NC: usize>(
        &self,
        signals: &mut ExogenousInputs<L, NC>,
        disturbance: &Disturbance,
        index: usize,
        agent: usize,
        first: usize,
        entries: Selection,
    ) {
        let values = |parameter: &Parameter, c: usize| {
            self.lanes::<L>(agent, |draw| {
                parameter.value(
                    disturbance.kind.parameters(),
                    &draw.disturbances[index],
                    first + c,
                )
            })
        };
        let acts = |force: &dyn Fn(usize) -> [f64; MAX_WIDTH]| {
            let acting = || (0..NC).any(|c| force(c).iter().any(|force| *force != 0.0));
            entries == Selection::Possible || acting()
        };
        match disturbance.kind {
            DisturbanceKind::Constant => {
                for (c, constant) in signals.constant.iter_mut().enumerate() {
                    *constant = *constant + L::load(&values(&AMPLITUDE, c));
                }
            }
            DisturbanceKind::GroundReaction => {
                for (c, ground) in signals.ground.iter_mut().enumerate() {
                    *ground = *ground + L::load(&values(&SERIES_SHARE, c));
                }
            }
            DisturbanceKind::Sine if acts(&|c| values(&AMPLITUDE, c)) => {
                signals
                    .lists
                    .sines
                    .push(std::array::from_fn(|c| Oscillation {
                        switch: Window::always(L::load(&values(&AMPLITUDE, c))),
                        inverse_smoothing: L::number(0.0),
                        phase: L::turns(&values(&PHASE, c).map(|phase_rad| phase_rad / TAU)),
                        advance: self.advance::<L>(
                            values(&FREQUENCY, c).map(|frequency_rad_s| frequency_rad_s / TAU),
                        ),
                        held: L::number(0.0),
                    }));
            }
            DisturbanceKind::Gust1Cosine => {
                let blows = |c: usize| disturbance.kind.acts_on(first + c);
                let force = |c: usize| {
                    let (speed_m_s, gain_n_s_m) = (values(&GUST_SPEED, c), values(&WIND_GAIN, c));
                    std::array::from_fn(|lane| {
                        if blows(c) {
                            speed_m_s[lane] * gain_n_s_m[lane]
                        } else {
                            0.0
                        }
                    })
                };
                if acts(&force) {
                    let waves = std::array::from_fn(|c| {
                        self.gust(force(c), values(&GUST_ONSET, c), values(&GUST_DURATION, c))
                    });
                    signals.lists.gusts.push(waves);
                }
            }
            DisturbanceKind::Dryden => {
                let blows = |c: usize| disturbance.kind.acts_on(first + c);
                if (0..NC).any(blows) {
                    signals
                        .turbulences
                        .push(self.turbulence(agent, disturbance, index, first));
                }
            }
            DisturbanceKind::Friction => signals.frictions.extend(friction(&values, entries)),
            DisturbanceKind::Sine | DisturbanceKind::RotorVortex => {}
        }
    }

    /// What an agent feels of the others' jets, where its channels are those of a place.
    pub(super) fn vortices<L: Lane, const NC: usize>(
        &self,
        agent: usize,
        first: usize,
        entries: Selection,
    ) -> Vec<Vortex<L>> {
        if first > 0 || NC <= HEIGHT {
            return Vec::new();
        }
        let all = self.group.disturbances.iter().enumerate();
        let felt = all.filter(|(_, disturbance)| disturbance.kind == DisturbanceKind::RotorVortex);
        felt.filter_map(|(index, felt)| {
            let of = |parameter: &Parameter, pick: fn(f64) -> f64| {
                self.lanes::<L>(agent, |draw| {
                    pick(parameter.value(felt.kind.parameters(), &draw.disturbances[index], HEIGHT))
                })
            };
            let force_n = of(&JET_FORCE, |force_n| force_n);
            let acts = force_n.iter().any(|force_n| *force_n != 0.0);
            (acts || entries == Selection::Possible).then(|| Vortex {
                force: L::load(&force_n),
                inverse_radius: L::load(&of(&JET_RADIUS, f64::recip)),
                inverse_length: L::load(&of(&JET_LENGTH, |length_m| 2.0 / length_m)),
            })
        })
        .collect()
    }

    /// One turn of 1 - cos from an onset on.
    fn gust<L: Lane>(
        &self,
        force_n: [f64; MAX_WIDTH],
        onset_s: [f64; MAX_WIDTH],
        duration_s: [f64; MAX_WIDTH],
    ) -> Oscillation<L> {
        let time = self.group.time;
        let onsets = onset_s.map(|onset_s| f64::from(time.onset_step(onset_s)));
        let steps = duration_s.map(|duration_s| time.whole_steps(duration_s));
        // A quarter turn back, the sine is at its bottom.
        let phases: [f64; MAX_WIDTH] =
            std::array::from_fn(|lane| -onsets[lane] / steps[lane] - 0.25);
        let ends: [f64; MAX_WIDTH] = std::array::from_fn(|lane| onsets[lane] + steps[lane]);
        Oscillation {
            switch: Window {
                onset: L::load(&onsets),
                end: L::load(&ends),
                inverse_ramp: L::number(1.0),
                value: L::load(&force_n),
            },
            inverse_smoothing: L::number(0.0),
            phase: L::turns(&phases),
            advance: L::turns(&steps.map(|steps| 0.5 / steps)),
            held: L::number(0.0),
        }
    }

    /// Turbulence along the axes of translation; nothing about the others.
    fn turbulence<L: Lane, const NC: usize>(
        &self,
        agent: usize,
        disturbance: &Disturbance,
        index: usize,
        first: usize,
    ) -> Turbulence<L, NC> {
        let group = self.group;
        let entry = u32::try_from(index).unwrap_or(u32::MAX);
        let members = std::array::from_fn(|c| member(group.first_agent + agent, first + c));
        let filter = |c: usize, draw: &AgentDraw| {
            let of = |parameter: &Parameter| {
                parameter.value(
                    disturbance.kind.parameters(),
                    &draw.disturbances[index],
                    first + c,
                )
            };
            if first + c < FIRST_ATTITUDE {
                let wind = Dryden {
                    wind_m_s: of(&MEAN_WIND),
                    altitude_m: of(&ALTITUDE),
                    airspeed_m_s: of(&AIRSPEED),
                };
                wind.filter(first + c, of(&WIND_GAIN), group.time.step_s)
            } else {
                Filter::still()
            }
        };
        let at_start: [[[f64; MAX_WIDTH]; 2]; NC] = std::array::from_fn(|c| {
            let mut state = [[0.0; MAX_WIDTH]; 2];
            for lane in 0..L::WIDTH {
                let address = Address {
                    episode: self.episode(lane).index,
                    stream: Stream::Turbulence,
                    entry,
                    member: members[c],
                    index: u32::MAX,
                };
                for (state, own) in state.iter_mut().zip(at_rest(address, group.seed)) {
                    state[lane] = own;
                }
            }
            state
        });
        Turbulence {
            entry,
            members,
            filter: std::array::from_fn(|c| {
                let number = |pick: &dyn Fn(Filter<f64>) -> f64| {
                    self.load(agent, |draw| pick(filter(c, draw)))
                };
                Filter {
                    keep: number(&|filter| filter.keep),
                    cross: number(&|filter| filter.cross),
                    noise: std::array::from_fn(|k| number(&|filter| filter.noise[k])),
                    output: std::array::from_fn(|k| number(&|filter| filter.output[k])),
                }
            }),
            state: at_start.map(|state| state.map(|values| L::load(&values))),
        }
    }
}

/// Friction of every channel, if it may act (or does) in some lane.
fn friction<L: Lane, const NC: usize>(
    values: &dyn Fn(&Parameter, usize) -> [f64; MAX_WIDTH],
    entries: Selection,
) -> Option<[Friction<L>; NC]> {
    let slows = |c: usize| {
        let both = [values(&COULOMB, c), values(&VISCOUS, c)];
        both.as_flattened().iter().any(|part| *part != 0.0)
    };
    let acts = entries == Selection::Possible || (0..NC).any(slows);
    acts.then(|| {
        std::array::from_fn(|c| Friction {
            coulomb: L::load(&values(&COULOMB, c)),
            inverse_smoothing: L::load(&values(&SMOOTHING_RATE, c).map(f64::recip)),
            viscous: L::load(&values(&VISCOUS, c)),
        })
    })
}
