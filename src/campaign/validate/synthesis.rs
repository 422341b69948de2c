//! `[synthesis]` and the controllers that it can give.

use crate::agent::{ActuationKind, Agent, ChannelRole};
use crate::campaign::check::Check;
use crate::campaign::common::{BUILT_IN, COMPARED, FTC, SYNTHESIZED};
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::group::{GainSource, NamedGains, PidPlaced, PlacedPoles};
use crate::synthesis::{ChannelDesign, PLACED_RAD_S, Preset, SmoothingRule, SynthesisError};
use crate::util::suggest::did_you_mean;

/// Poles of the observer of "pid-placed", rad/s: so fast that it shows what is measured, so slow that a step of 2 ms
/// resolves it.
const OBSERVER_RAD_S: f64 = 800.0;

/// The controllers that a campaign can name: those that need no file, and those that every group has a file for.
pub(super) fn known_controllers(sources: &[&GainSource]) -> Vec<String> {
    let named = sources.first().map_or(&[][..], |source| &source.named);
    let named = named.iter().map(|named| named.name.clone());
    let everywhere = named.filter(|name| sources.iter().all(|source| source.names(name)));
    BUILT_IN
        .into_iter()
        .map(String::from)
        .chain(everywhere)
        .collect()
}

impl GainSource {
    /// Whether it names a file for a controller.
    fn names(&self, controller: &str) -> bool {
        self.named.iter().any(|named| named.name == controller)
    }
}

impl Check<'_> {
    /// Where the gains come from.
    pub(super) fn synthesis(
        &self,
        file: &SynthesisFile,
        agent: &Agent,
    ) -> Result<GainSource, CampaignError> {
        let known: Vec<Preset> = match agent {
            Agent::Uav(uav) if uav.actuation == ActuationKind::Full => {
                vec![Preset::UavPaper, Preset::UavPhysical]
            }
            Agent::Uav(_) => vec![Preset::UavPhysical, Preset::UavPaper],
            Agent::Biped(_) => vec![Preset::BipedPaper],
        };
        let preset = match &file.preset {
            None => known.first(),
            Some(name) => known.iter().find(|preset| preset.name() == name),
        };
        let Some(preset) = preset else {
            let names: Vec<String> = known
                .iter()
                .map(|preset| format!("{:?}", preset.name()))
                .collect();
            let name = file.preset.as_deref().unwrap_or_default();
            let limit = format!("the presets of {} are {}", agent.plural(), names.join(", "));
            let remedy = did_you_mean(
                name,
                known.iter().map(|preset| preset.name()),
                "take one of them",
            );
            return Err(self.invalid("synthesis.preset", format!("{name:?}"), &limit, &remedy));
        };
        let tables = [
            (ChannelRole::Position, &file.position),
            (ChannelRole::Attitude, &file.attitude),
            (ChannelRole::Joints, &file.joints),
        ];
        let groups = agent.channel_groups();
        let foreign = tables.map(|(role, table)| {
            let own = groups.iter().any(|group| group.role == role);
            (role.name(), table.is_some() && !own)
        });
        self.unused("synthesis", preset.name(), &foreign)?;
        let design = |(role, design): (ChannelRole, ChannelDesign)| {
            let table = tables.iter().find(|(of, _)| *of == role);
            let weights = table.and_then(|(_, weights)| weights.as_ref());
            self.design(&format!("synthesis.{}", role.name()), design, weights)
        };
        let designs = preset.designs().into_iter().map(design);
        let designs = designs.collect::<Result<_, _>>()?;
        let beside = |file: &str| self.source.beside(file);
        let mut named = Vec::new();
        for (name, entry) in &file.named {
            let key = format!("synthesis.named.{name}");
            self.name(&key, name)?;
            if BUILT_IN.contains(&name.as_str()) {
                return Err(self.invalid(
                    key,
                    "a table",
                    "this name is a built-in controller's",
                    "choose another",
                ));
            }
            named.push(NamedGains {
                name: name.clone(),
                gains: beside(&entry.gains),
                controller: entry.controller.clone().unwrap_or_else(|| FTC.to_string()),
            });
        }
        Ok(GainSource {
            designs,
            preset: preset.name().to_string(),
            gains: file.gains.as_deref().map(beside),
            placed: self.placed(
                file.pid_placed
                    .as_ref()
                    .unwrap_or(&PidPlacedFile::default()),
            )?,
            named,
        })
    }

    /// How a PID is placed.
    fn placed(&self, file: &PidPlacedFile) -> Result<PidPlaced, CampaignError> {
        let table = "synthesis.pid-placed";
        let within = |key: &str, value: f64| {
            let [low, high] = PLACED_RAD_S;
            if (low..=high).contains(&value) {
                return Ok(value);
            }
            Err(self.invalid(
                format!("{table}.{key}"),
                in_toml(value),
                &format!("must lie within {low} and {high} rad/s"),
                "give a value within the limits",
            ))
        };
        let poles = match (file.poles_rad_s, file.delay_margin_of.as_deref()) {
            (Some(poles_rad_s), None) => PlacedPoles::At(within("poles_rad_s", poles_rad_s)?),
            (None, margin_of) => {
                let margin_of = margin_of.unwrap_or(FTC);
                let known = SYNTHESIZED;
                if !known.contains(&margin_of) {
                    return Err(self.invalid(
                        format!("{table}.delay_margin_of"),
                        format!("{margin_of:?}"),
                        &format!("the controllers that have one are {}", known.join(", ")),
                        &did_you_mean(margin_of, known.iter().copied(), "take one of them"),
                    ));
                }
                PlacedPoles::DelayMarginOf(margin_of.to_string())
            }
            (Some(_), Some(_)) => {
                return Err(self.invalid(
                    format!("{table}.delay_margin_of"),
                    "given",
                    "poles_rad_s is given too, which decides where the poles are",
                    "remove either",
                ));
            }
        };
        let observer_rad_s = file.observer_rad_s.unwrap_or(OBSERVER_RAD_S);
        Ok(PidPlaced {
            poles,
            observer_rad_s: within("observer_rad_s", observer_rad_s)?,
        })
    }

    /// The controllers to compare: those that need no file, and those that every group names.
    pub(super) fn controllers(
        &self,
        names: Option<&[String]>,
        sources: &[&GainSource],
    ) -> Result<Vec<String>, CampaignError> {
        let known = known_controllers(sources);
        let Some(names) = names else {
            let compared = |name: &&String| {
                COMPARED.contains(&name.as_str()) || !BUILT_IN.contains(&name.as_str())
            };
            return Ok(known.iter().filter(compared).cloned().collect());
        };
        if let Some(at) = names.iter().position(|name| !known.contains(name)) {
            let name = &names[at];
            let limit = format!("the controllers are {}", known.join(", "));
            let remedy = match sources.iter().any(|source| source.names(name)) {
                true => format!("give every group a [group.synthesis.named.{name}]"),
                false => did_you_mean(name, known.iter().map(String::as_str), "take one of them"),
            };
            return Err(self.invalid(
                format!("controllers[{at}]"),
                format!("{name:?}"),
                &limit,
                &remedy,
            ));
        }
        if names.is_empty() || (1..names.len()).any(|k| names[..k].contains(&names[k])) {
            return Err(self.invalid(
                "controllers",
                format!("{names:?}"),
                "one or more, each once",
                "list what to compare",
            ));
        }
        Ok(names.to_vec())
    }

    /// A preset's weights with the file's overrides.
    fn design(
        &self,
        table: &str,
        mut design: ChannelDesign,
        file: Option<&WeightsFile>,
    ) -> Result<ChannelDesign, CampaignError> {
        let file = file.cloned().unwrap_or_default();
        let replace = |weight: &mut f64, given: Option<f64>| *weight = given.unwrap_or(*weight);
        replace(&mut design.r, file.r);
        replace(&mut design.rho, file.rho);
        replace(&mut design.nu, file.nu);
        replace(&mut design.eps2, file.eps2);
        replace(&mut design.pid_nu, file.pid_nu);
        replace(&mut design.smoothing.spacing_s, file.smoothing_spacing_s);
        if file.smoothing_weights.is_some()
            && (file.smoothing_order.is_some() || file.smoothing_leak_per_s.is_some())
        {
            return Err(self.invalid(
                format!("{table}.smoothing_weights"),
                "given",
                "they replace smoothing_order and smoothing_leak_per_s, which are given too",
                "remove either",
            ));
        }
        design.q1 = file.q1.map_or(design.q1, |list| list.0);
        design.q2 = file.q2.unwrap_or(design.q2);
        design.sensor_fault_input = file
            .sensor_fault_input
            .map_or(design.sensor_fault_input, |list| list.0);
        design.smoothing.windows = file
            .smoothing_windows
            .map_or(design.smoothing.windows, |list| list.0);
        if let SmoothingRule::Leaky { order, leak_per_s } = &mut design.smoothing.rule {
            *order = file.smoothing_order.unwrap_or(*order);
            replace(leak_per_s, file.smoothing_leak_per_s);
        }
        if let Some(weights) = file.smoothing_weights {
            design.smoothing.rule = SmoothingRule::Weights(weights);
        }
        if design.sensor_fault_input[0] != 0.0 {
            return Err(self.invalid(
                format!("{table}.sensor_fault_input"),
                format!("{:?}", design.sensor_fault_input),
                "the integral is computed, not sensed, so no sensor fault enters it",
                "begin the list with 0",
            ));
        }
        match design.validate() {
            Ok(()) => Ok(design),
            Err(error) => Err(self.unsound(table, &design, error)),
        }
    }

    /// What the synthesis says about a design, in the words of the file.
    fn unsound(&self, table: &str, design: &ChannelDesign, error: SynthesisError) -> CampaignError {
        match error {
            SynthesisError::InvalidDesign { key, value, limit } => {
                let (name, value) = match key.strip_prefix("number of ") {
                    Some(list) => (list, format!("a list of {value}")),
                    None => (key.as_str(), value.to_string()),
                };
                self.invalid(
                    format!("{table}.{}", name.replace("smoothing.", "smoothing_")),
                    value,
                    &format!("must be {limit}"),
                    "give a value within the limit",
                )
            }
            SynthesisError::WrongLength {
                key,
                given,
                needed,
                why,
            } => self.invalid(
                format!("{table}.{key}"),
                format!("a list of {given}"),
                &format!("needs {needed} values: {why}"),
                "complete it",
            ),
            SynthesisError::UnstableSmoothing { eigenvalue } => {
                let (name, value) = match &design.smoothing.rule {
                    SmoothingRule::Leaky { leak_per_s, .. } => {
                        ("smoothing_leak_per_s", in_toml(*leak_per_s))
                    }
                    SmoothingRule::Weights(weights) => {
                        ("smoothing_weights", format!("{weights:?}"))
                    }
                };
                let limit = format!(
                    "the fault model must decay, but has an eigenvalue of real part {} 1/s",
                    in_toml(eigenvalue.re + 0.0)
                );
                let remedy = "give a leak above 0, or weights whose model decays";
                self.invalid(format!("{table}.{name}"), value, &limit, remedy)
            }
            other => self.invalid(table, "these weights", &other.to_string(), "change them"),
        }
    }
}
