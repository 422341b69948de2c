//! `[sensors]`

use crate::agent::Agent;
use crate::campaign::check::Check;
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::group::{ChannelSensors, GainSource};
use crate::synthesis::{Sensor, SensorChanges, Sensors};

impl Check<'_> {
    /// The sensors of the groups of channels that have some of their own.
    pub(super) fn sensors(
        &self,
        file: Option<&SensorsFile>,
        agent: &Agent,
        source: &GainSource,
    ) -> Result<Vec<ChannelSensors>, CampaignError> {
        let Some(file) = file else {
            return Ok(Vec::new());
        };
        let tables = [
            ("position", &file.position),
            ("attitude", &file.attitude),
            ("left-leg", &file.left_leg),
            ("right-leg", &file.right_leg),
        ];
        let groups = agent.sensor_groups();
        let foreign = tables.map(|(name, table)| {
            let own = groups.iter().any(|group| group.name == name);
            (name, table.is_some() && !own)
        });
        self.unused("sensors", agent.plural(), &foreign)?;
        let mut found = Vec::new();
        for group in groups {
            let table = tables.iter().find(|(name, _)| *name == group.name);
            let Some(table) = table.and_then(|(_, table)| table.as_ref()) else {
                continue;
            };
            let channels = self.channels[group.channels.clone()].iter();
            let channels: Vec<String> = channels.map(ToString::to_string).collect();
            let design = &source.designs[group.place];
            let sensors = Sensors::new(&channels, design, &changes(table));
            found.push(ChannelSensors {
                name: group.name,
                place: group.place,
                sensors: sensors.map_err(|error| {
                    let key = format!("sensors.{}.{}", group.name, error.key);
                    self.invalid(key, error.value, &error.limit, &error.remedy)
                })?,
            });
        }
        if found.is_empty() {
            return Err(self.invalid(
                "sensors",
                "an empty table",
                "no group of channels has sensors of its own",
                "write them, or remove it",
            ));
        }
        Ok(found)
    }
}

/// The changes that a table says.
fn changes(file: &ChannelSensorsFile) -> SensorChanges {
    let sensor = |file: &SensorFile| Sensor {
        of: file.of.clone(),
        faults: file.faults.clone(),
        noise: file.noise,
    };
    let replaced = file.replace.iter();
    SensorChanges {
        faults: file.faults.clone(),
        replace: replaced
            .map(|(name, own)| (name.clone(), sensor(own)))
            .collect(),
        add: file.add.iter().map(sensor).collect(),
        remove: file.remove.clone(),
    }
}
