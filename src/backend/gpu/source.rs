//! The WGSL text of a group of channels: the files of `shaders/`, joined, under constants that come from here and from
//! `src/model`, so that every number and size exists once.

use super::layout::{OUTCOME_WORDS, SHOWN_WORDS};
use super::shape::Shape;
use crate::agent::{FIRST_ATTITUDE, HEIGHT};
use crate::draw::MEMBERS_PER_AGENT;
use crate::model::agent::Coupling;
use crate::model::controller::OBSERVER;
use crate::model::controller::observer_feedback::FTC_STATES;
use crate::model::exogenous::vortex::{JET_PEAK, JET_SPREAD};
use crate::model::lanes::math;
use crate::model::plant::kinds::{FILTER_STATES, PlantKind};
use crate::model::team::{FAR_AWAY, FLUSH_STEPS};
use crate::random::philox::{self, Stream};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, LN_2, PI};
use std::fmt::Write;

/// The 64-bit product of the random numbers: from 16-bit ones, and where the device has 64-bit integers.
const WIDE_PRODUCT: [&str; 2] = [
    include_str!("../../../shaders/wide_product.wgsl"),
    include_str!("../../../shaders/wide_product_int64.wgsl"),
];
/// The files on which every plant builds, in the order of what builds on what.
const BELOW: [&str; 6] = [
    include_str!("../../../shaders/lanes.wgsl"),
    include_str!("../../../shaders/math.wgsl"),
    include_str!("../../../shaders/philox.wgsl"),
    include_str!("../../../shaders/integrator.wgsl"),
    include_str!("../../../shaders/observer_feedback.wgsl"),
    include_str!("../../../shaders/plant.wgsl"),
];
/// The files of the UAV.
const UAV: [&str; 1] = [include_str!("../../../shaders/plant_uav.wgsl")];
/// The files of the biped.
const BIPED: [&str; 2] = [
    include_str!("../../../shaders/leg.wgsl"),
    include_str!("../../../shaders/plant_biped.wgsl"),
];
/// The files that build on a plant.
const ABOVE: [&str; 10] = [
    include_str!("../../../shaders/window.wgsl"),
    include_str!("../../../shaders/delay_line.wgsl"),
    include_str!("../../../shaders/noise.wgsl"),
    include_str!("../../../shaders/command_path.wgsl"),
    include_str!("../../../shaders/exogenous.wgsl"),
    include_str!("../../../shaders/metric.wgsl"),
    include_str!("../../../shaders/friction.wgsl"),
    include_str!("../../../shaders/vortex.wgsl"),
    include_str!("../../../shaders/team.wgsl"),
    include_str!("../../../shaders/episode.wgsl"),
];

impl Shape {
    /// The whole text.
    pub(crate) fn text(&self) -> String {
        let mut text = self.constants();
        let plant: &[&str] = match self.plant {
            PlantKind::Axis | PlantKind::Translation | PlantKind::Attitude | PlantKind::Thrust => {
                &UAV
            }
            PlantKind::Leg => &BIPED,
        };
        let product = &WIDE_PRODUCT[usize::from(self.int64)..][..1];
        for file in product.iter().chain(&BELOW).chain(plant).chain(&ABOVE) {
            text.push('\n');
            text.push_str(file);
        }
        text
    }

    fn constants(&self) -> String {
        let mut text = Constants::default();
        self.declare_group(&mut text);
        self.declare_model(&mut text);
        self.declare_words(&mut text);
        declare_random(&mut text);
        declare_math(&mut text);
        text.0
    }

    /// What the group is.
    fn declare_group(&self, text: &mut Constants) {
        for plant in PlantKind::ALL {
            text.count(plant.spec().name, plant as usize);
        }
        for (name, value) in &self.plant_constants {
            text.count(name, *value as usize);
        }
        text.name("PLANT", self.plant.spec().name);
        text.count("NC", self.channels);
        text.count("ROWS", self.rows);
        text.count("TEAM", self.team);
        text.count("FIRST_AGENT", self.first_agent);
        text.count("LANES", self.lanes);
        text.count("WORKGROUP", self.workgroup());
        text.count("KINDS", self.kinds());
        text.count("HEIGHT", HEIGHT);
        text.count("FIRST_ATTITUDE", FIRST_ATTITUDE);
        text.flag("COUPLED", self.coupling != Coupling::None);
        text.flag("CENTROID", self.coupling == Coupling::Centroid);
        text.number("TEAM_SHARE", 1.0 / self.team as f64);
        text.flag("MEASURED_INTEGRAL", self.measured_integral);
        text.flag("RESTLESS", self.lists.restless);
        text.flag("REMEMBERS", self.lists.remembers);
        text.flag("CARRIES", self.lists.carries);
        text.flag("DISTORTS", self.lists.distorts);
        text.flag("FTC", self.ftc);
        text.flag("LIMITED", self.limited());
        text.flag("CUT", self.cut);
        text.flag("OBSERVER_MEASURED", self.observer_measured);
    }

    /// What it shares with every other: states, and the limits of the model.
    fn declare_model(&self, text: &mut Constants) {
        text.count("OBSERVER", OBSERVER);
        text.count("EXTRA", FTC_STATES);
        text.count("EXTRA_STATES", self.extra_states());
        text.count("STATES", FTC_STATES + FILTER_STATES);
        text.count("FLUSH_STEPS", FLUSH_STEPS as usize);
        text.number("JET_SPREAD", JET_SPREAD);
        text.number("JET_PEAK", JET_PEAK);
        text.number("FAR_AWAY", FAR_AWAY);
        text.number("MAX", f64::from(f32::MAX));
        text.word("NEVER", u32::MAX);
    }

    /// Where things are: in workgroup memory, in the words of a channel, and in the lists of its signals.
    fn declare_words(&self, text: &mut Constants) {
        text.count("SHARED", self.shared());
        for (name, slot) in [
            ("POSITION", 0),
            ("VELOCITY", 1),
            ("COMMAND_BIAS", 1),
            ("REFERENCE", 2),
            ("DEMAND", 2),
            ("REFERENCE_RATE", 3),
            ("COMMAND_GAIN", 3),
            ("TORQUE", 3),
            ("COMMAND_LOW", 4),
            ("BIAS", 4),
            ("COMMAND_HIGH", 5),
            ("SINE", 5),
            ("COSINE", 6),
            // Behind all that thrust shows without it.
            ("COMMAND_DEAD_ZONE", PlantKind::Thrust.spec().shared),
        ] {
            text.count(name, slot);
        }
        for (name, word) in self.words().named() {
            text.count(&name, word);
        }
        text.count("PUBLISHED", self.published());
        text.count("SHOWN", SHOWN_WORDS);
        text.count("OUTCOME_WORDS", OUTCOME_WORDS);
        let lists = &self.lists;
        text.list("NOISE_ENTRIES", &lists.noise_entries);
        text.list("TURBULENCE_ENTRIES", &lists.turbulence_entries);
        let (entries, together): (Vec<u32>, Vec<bool>) = lists.bursts.iter().copied().unzip();
        text.list("BURST_ENTRIES", &entries);
        text.flags("BURST_TOGETHER", &together);
        text.flags("RING_RECORDS", &lists.rings);
    }
}

/// The generator of random numbers.
fn declare_random(text: &mut Constants) {
    text.word("ROUNDS", philox::ROUNDS);
    text.words("MULTIPLIERS", philox::MULTIPLIERS);
    text.words("WEYL", philox::WEYL);
    text.count("STREAM_NOISE", Stream::Noise as usize);
    text.count("STREAM_INTERMITTENT", Stream::Intermittent as usize);
    text.count("STREAM_TURBULENCE", Stream::Turbulence as usize);
    text.count("MEMBERS_PER_AGENT", MEMBERS_PER_AGENT);
}

/// Elementary functions.
fn declare_math(text: &mut Constants) {
    text.number("UNIT_SPACING", math::UNIT_SPACING);
    text.word("QUARTER_TURN", math::QUARTER_TURN);
    text.word("SIGN_BIT", math::SIGN_BIT);
    text.word("MANTISSA_BITS", math::MANTISSA_BITS);
    text.word("SQRT_HALF_BITS", math::SQRT_HALF_BITS);
    text.number("FOLD_SCALE", f64::from(math::FOLD_SCALE));
    text.number("MIN_POSITIVE", f64::from(f32::MIN_POSITIVE));
    text.number("PI", PI);
    text.number("FRAC_PI_2", FRAC_PI_2);
    text.number("FRAC_1_PI", FRAC_1_PI);
    text.number("LN_2", LN_2);
    text.number("PI_HIGH", math::PI_HIGH);
    text.number("PI_LOW", math::PI_LOW);
    text.number("TANH_LIMIT", math::TANH_LIMIT);
    text.numbers("SIN_FOLDED", &math::SIN_FOLDED);
    text.numbers("SIN", &math::SIN);
    text.numbers("COS", &math::COS);
    text.numbers("ATAN", &math::ATAN);
    text.numbers("LN", &math::LN);
    text.numbers("TANH_NUMERATOR", &math::TANH_NUMERATOR);
    text.numbers("TANH_DENOMINATOR", &math::TANH_DENOMINATOR);
}

/// Declarations of constants, one a line.
#[derive(Default)]
struct Constants(String);

impl Constants {
    fn name(&mut self, name: &str, value: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "const {name} = {value};");
    }

    fn count(&mut self, name: &str, value: usize) {
        self.name(name, &format!("{value}u"));
    }

    fn word(&mut self, name: &str, value: u32) {
        self.name(name, &format!("{value:#x}u"));
    }

    fn words(&mut self, name: &str, [x, y]: [u32; 2]) {
        self.name(name, &format!("vec2({x:#x}u, {y:#x}u)"));
    }

    fn flag(&mut self, name: &str, value: bool) {
        self.name(name, &value.to_string());
    }

    /// An array of words; of one zero where there is none, since an array must not be empty.
    fn list(&mut self, name: &str, words: &[u32]) {
        let words: Vec<String> = words.iter().map(|word| format!("{word}u")).collect();
        self.array(name, words, "0u");
    }

    /// An array of flags; of one false where there is none.
    fn flags(&mut self, name: &str, flags: &[bool]) {
        self.array(name, flags.iter().map(bool::to_string).collect(), "false");
    }

    fn array(&mut self, name: &str, mut items: Vec<String>, empty: &str) {
        if items.is_empty() {
            items.push(empty.to_string());
        }
        self.name(name, &format!("array({})", items.join(", ")));
    }

    fn number(&mut self, name: &str, value: f64) {
        self.name(name, &single(value));
    }

    fn numbers(&mut self, name: &str, values: &[f64]) {
        let values: Vec<String> = values.iter().map(|&value| single(value)).collect();
        self.name(name, &format!("array({})", values.join(", ")));
    }
}

/// The nearest single, in the shortest digits that mean no other.
#[expect(
    clippy::cast_possible_truncation,
    reason = "rounding to single precision is what this does"
)]
fn single(value: f64) -> String {
    format!("{:?}f", value as f32)
}
