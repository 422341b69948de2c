//! `[[require]]`: what has to be proved, and whether it can be.

use crate::campaign::check::Check;
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::measure::{FAILURE_RATE, Measure, Misnamed, Side};
use crate::campaign::parameter::Bounds;
use crate::campaign::plan::ALL;
use crate::campaign::requirement::{Compared, Requirement};
use crate::campaign::tune::Bound;
use crate::campaign::validated::Campaign;
use crate::random::{Method, allows};
use crate::util::suggest::did_you_mean;
use std::sync::Arc;

impl Check<'_> {
    /// The conditions on the result of a campaign.
    pub(super) fn requirements(
        &self,
        files: &[RequireFile],
        campaign: &Campaign,
    ) -> Result<Vec<Requirement>, CampaignError> {
        let mut all = Vec::new();
        for (place, file) in files.iter().enumerate() {
            all.extend(self.requirement(place, file, campaign)?);
        }
        Ok(all)
    }

    /// What a table requires: of each channel group, where its measure names none.
    fn requirement(
        &self,
        place: usize,
        file: &RequireFile,
        campaign: &Campaign,
    ) -> Result<Vec<Requirement>, CampaignError> {
        let table = format!("require[{place}]");
        let controllers = &campaign.controllers;
        self.controller(
            &format!("{table}.controller"),
            &file.controller,
            controllers,
        )?;
        let stratum = self.required_stratum(&table, file, campaign)?;
        let compared = self.compared(&table, file, controllers)?;
        let (key, measures) = self.required_measures(&table, file, campaign)?;
        let (side, limit) = self.required_limit(&table, file)?;
        let (limit_key, limit) = limit;
        let shown = match &file.measure {
            Some(words) => format!("{words:?}"),
            None => in_toml(limit),
        };
        let mut all = Vec::new();
        for measure in measures {
            if measure.is_rate() && compared.is_none() {
                self.number(&limit_key, limit, Bounds::Share)?;
            }
            self.can_be_proved(
                &table,
                (&key, &shown),
                &measure,
                compared.as_ref(),
                campaign,
            )?;
            all.push(Requirement {
                place,
                controller: file.controller.clone(),
                compared: compared.clone(),
                stratum: stratum.clone(),
                measure,
                side,
                limit,
            });
        }
        if all.iter().any(|own| !own.measure.is_of_episodes()) && file.stratum.is_some() {
            return Err(self.invalid(
                format!("{table}.stratum"),
                format!("{stratum:?}"),
                "a number of the loop is the same in all strata",
                "remove it",
            ));
        }
        Ok(all)
    }

    /// The limits that a text sets on how a controller compares with another one, in all episodes.
    pub(in crate::campaign) fn demanded(
        &self,
        text: &str,
        controller: &str,
        compared: &Compared,
        campaign: &Campaign,
    ) -> Result<Vec<Requirement>, CampaignError> {
        let groups = campaign.channel_groups();
        let names: Vec<Arc<str>> = groups.iter().map(|own| own.name.clone()).collect();
        let mut all = Vec::new();
        for own in self.limit("limit", text, &names)? {
            let Bound::Number(limit) = own.bound else {
                continue;
            };
            let shown = format!("{text:?}");
            self.can_be_proved(
                "limit",
                ("limit", &shown),
                &own.measure,
                Some(compared),
                campaign,
            )?;
            all.push(Requirement {
                place: 0,
                controller: controller.to_string(),
                compared: Some(compared.clone()),
                stratum: ALL.into(),
                measure: own.measure,
                side: own.side,
                limit,
            });
        }
        Ok(all)
    }

    /// The measures of a table, and the key that names them.
    fn required_measures(
        &self,
        table: &str,
        file: &RequireFile,
        campaign: &Campaign,
    ) -> Result<(String, Vec<Measure>), CampaignError> {
        let short = format!("{table}.failure_rate_upper_95");
        let key = format!("{table}.measure");
        match (file.failure_rate_upper_95, &file.measure) {
            (Some(_), None) => Ok((short, vec![Measure::FailureRate])),
            (Some(limit), Some(_)) => Err(self.invalid(
                short,
                in_toml(limit),
                &format!("it is short for measure = {FAILURE_RATE:?}, and the table has another `measure`"),
                "give each limit a [[require]] of its own",
            )),
            (None, None) => Err(self.invalid(
                table,
                "without a measure",
                "something has to be proved",
                "give a `measure` with at_most or at_least, or failure_rate_upper_95",
            )),
            (None, Some(words)) => {
                let groups = campaign.channel_groups();
                let names: Vec<Arc<str>> = groups.iter().map(|own| own.name.clone()).collect();
                let refused = |Misnamed { limit, remedy }| {
                    self.invalid(&key, format!("{words:?}"), &limit, &remedy)
                };
                Ok((key.clone(), Measure::parse(words, &names).map_err(refused)?))
            }
        }
    }

    /// The side of a table's limit, and the limit with its key.
    fn required_limit(
        &self,
        table: &str,
        file: &RequireFile,
    ) -> Result<(Side, (String, f64)), CampaignError> {
        let given = [
            (
                "failure_rate_upper_95",
                Side::AtMost,
                file.failure_rate_upper_95,
            ),
            ("at_most", Side::AtMost, file.at_most),
            ("at_least", Side::AtLeast, file.at_least),
        ];
        let mut given = given
            .into_iter()
            .filter_map(|(key, side, limit)| Some((format!("{table}.{key}"), side, limit?)));
        let Some((key, side, limit)) = given.next() else {
            return Err(self.invalid(
                table,
                "without a limit",
                "a measure has a limit",
                "give at_most or at_least",
            ));
        };
        if let Some((other, _, value)) = given.next() {
            return Err(self.invalid(
                other,
                in_toml(value),
                &format!("the table has a limit already: {key}"),
                "give each limit a [[require]] of its own",
            ));
        }
        let limit = self.number(&key, limit, Bounds::Any)?;
        Ok((side, (key, limit)))
    }

    /// The controller that another is compared with.
    fn compared(
        &self,
        table: &str,
        file: &RequireFile,
        controllers: &[String],
    ) -> Result<Option<Compared>, CampaignError> {
        let (key, name, compared): (_, _, fn(String) -> Compared) =
            match (&file.ratio_to, &file.difference_to) {
                (None, None) => return Ok(None),
                (Some(name), None) => ("ratio_to", name, Compared::RatioTo),
                (None, Some(name)) => ("difference_to", name, Compared::DifferenceTo),
                (Some(_), Some(name)) => {
                    return Err(self.invalid(
                        format!("{table}.difference_to"),
                        format!("{name:?}"),
                        "the table has ratio_to already",
                        "give each limit a [[require]] of its own",
                    ));
                }
            };
        let key = format!("{table}.{key}");
        self.controller(&key, name, controllers)?;
        if *name == file.controller {
            return Err(self.invalid(
                key,
                format!("{name:?}"),
                "this is the controller itself",
                "name another one of the campaign",
            ));
        }
        Ok(Some(compared(name.clone())))
    }

    /// Refuses what no number of episodes of a campaign proves.
    fn can_be_proved(
        &self,
        table: &str,
        (key, value): (&str, &str),
        measure: &Measure,
        compared: Option<&Compared>,
        campaign: &Campaign,
    ) -> Result<(), CampaignError> {
        if !measure.is_of_episodes() {
            return Ok(());
        }
        let refused = |limit: &str, remedy: &str| Err(self.invalid(key, value, limit, remedy));
        if let Measure::Survival { at_s } = measure
            && *at_s > campaign.time.shown_s(campaign.time.steps)
        {
            let end_s = campaign.time.shown_s(campaign.time.steps);
            return refused(
                &format!("an episode ends at {end_s} s"),
                "give a time within the episode",
            );
        }
        if measure.is_rate() && matches!(compared, Some(Compared::RatioTo(_))) {
            return refused(
                "the ratio of two shares has no bound where one of them is 0",
                "compare them by their difference: difference_to, or --difference",
            );
        }
        if !allows(campaign.sampling.design(), Method::FailureRate) {
            return refused(
                "its bound takes independent episodes, which those of a sampling design are not",
                "set sampling.design = \"independent\", or remove the [[require]]",
            );
        }
        if campaign.stop.is_some() && (!measure.is_rate() || compared.is_some()) {
            return refused(
                "its bound takes a number of episodes that nothing seen in them decides, and the campaign has a [stop]",
                "remove [stop] or the [[require]]; of a [stop] only shares such as the failure rate have bounds",
            );
        }
        if !campaign.is_random() {
            return Err(self.invalid(
                table,
                "given",
                "nothing in the campaign is random: its episodes are all the same, and prove no rate",
                "draw something from a distribution, or remove it",
            ));
        }
        Ok(())
    }

    fn required_stratum(
        &self,
        table: &str,
        file: &RequireFile,
        campaign: &Campaign,
    ) -> Result<Arc<str>, CampaignError> {
        let wanted = file.stratum.as_deref().unwrap_or(ALL);
        let strata = campaign.strata.all().iter();
        let names: Vec<&str> = strata.map(|stratum| &*stratum.name).collect();
        if wanted == ALL || names.contains(&wanted) {
            return Ok(wanted.into());
        }
        let remedy = did_you_mean(
            wanted,
            names.iter().copied(),
            "name one of them, or remove it",
        );
        let limit = match names.as_slice() {
            [] => "the campaign has no [[strata]]".to_string(),
            names => format!("the campaign's strata are {}", names.join(", ")),
        };
        Err(self.invalid(
            format!("{table}.stratum"),
            format!("{wanted:?}"),
            &limit,
            &remedy,
        ))
    }
}
