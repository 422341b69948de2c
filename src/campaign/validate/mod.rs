//! From the file as written to the campaign that runs: every range, shape and contradiction is checked here, and
//! nowhere later.

mod agent;
mod disturbance;
mod fault;
mod fault_channels;
mod group;
mod plan;
mod reference;
mod requirement;
mod sampling;
mod sensors;
mod synthesis;
mod timing;
mod tune;

use super::check::Check;
use super::common::Common;
use super::error::CampaignError;
use super::file::*;
use super::parameter::Bounds;
use super::source::Source;
use super::time::Time;
use super::validated::Campaign;
use crate::util::hidden::is_hidden;
use group::{Begun, MAX_AGENTS, RobotTexts};
use std::sync::Arc;
use synthesis::known_controllers;

/// Steps that an episode may have: step numbers stay exact in single precision, half steps in 32 bits.
const MAX_STEPS: f64 = 8_388_608.0;
/// Longest description: it stands on the first screen of the report.
const LONGEST_DESCRIPTION: usize = 1000;
/// Memory that the reference tables of a campaign may take, bytes.
const MAX_TABLE_BYTES: f64 = 4_294_967_296.0;

/// Checks a file as written.
pub(super) fn validate(
    mut file: CampaignFile,
    source: Source<'_>,
    robots: RobotTexts<'_>,
) -> Result<Campaign, CampaignError> {
    let check = Check::new(source, String::new());
    file.episodes = source.episodes.unwrap_or(file.episodes);
    check.name("name", &file.name)?;
    check.episodes(file.episodes)?;
    let time = check.time(&file.time)?;
    let files = check.groups(&mut file)?;
    let mut begun = Vec::new();
    for (prefix, file) in files {
        let own = Check::new(source, prefix);
        begun.push(own.begin_group(file, robots)?);
    }
    check.agents_fit(&begun, &file.time, time)?;
    let synthesis: Vec<_> = begun.iter().map(|group| &group.synthesis).collect();
    let controllers = check.controllers(file.controllers.as_deref(), &synthesis)?;
    let faults: Vec<(Arc<str>, bool)> = begun.iter().flat_map(Begun::faults).collect();
    let strata = check.strata(&file.strata, &faults, file.episodes)?;
    let sampling = check.sampling(&file, begun.iter().map(Begun::entries).max())?;
    let known = known_controllers(&synthesis);
    let tune = file.tune.take();
    let common = Arc::new(Common {
        path: source.path.to_path_buf(),
        text: source.text.to_string(),
        overlay: source.overlay.to_vec(),
        requirements: Vec::new(),
        detail: file
            .output
            .as_ref()
            .map(|own| own.detail)
            .unwrap_or_default(),
        stop: check.stop(&file, &controllers, sampling)?,
        description: check.description(file.description.as_deref())?,
        name: file.name,
        seed: file.seed,
        episodes: file.episodes,
        episodes_given: source.episodes,
        controllers,
        time,
        strata,
        sampling,
    });
    let groups = begun.into_iter().map(|group| group.finish(&common));
    let campaign = Campaign::new(common.clone(), groups.collect::<Result<_, _>>()?);
    check.can_prove(&campaign)?;
    let requirements = check.requirements(&file.require, &campaign)?;
    let mut campaign = campaign.with(|parts| parts.requirements = requirements);
    let tune = tune.map(|tune| check.tune(&tune, &campaign, &known));
    campaign.tune = tune.transpose()?.map(Arc::new);
    Ok(campaign)
}

impl Check<'_> {
    /// The groups of agents, each with what precedes its keys: those of `[[group]]`, or the one whose tables are at the
    /// top.
    fn groups(&self, file: &mut CampaignFile) -> Result<Vec<(String, GroupFile)>, CampaignError> {
        if file.group.is_empty() {
            let only = file.take_only_group();
            let only = only.map_err(|missing| self.source.missing(missing))?;
            return Ok(vec![(String::new(), only)]);
        }
        if let Some(table) = file.group_table_at_the_top() {
            return Err(self.invalid(
                table,
                "given",
                "in a file with [[group]] each group has this of its own",
                "move it into the [[group]] that it is about",
            ));
        }
        let groups = std::mem::take(&mut file.group);
        for (index, group) in groups.iter().enumerate() {
            let key = format!("group[{index}].name");
            self.name(&key, &group.name)?;
            if groups[..index].iter().any(|other| other.name == group.name) {
                return Err(self.invalid(
                    key,
                    format!("{:?}", group.name),
                    "another group has this name",
                    "rename one of them",
                ));
            }
        }
        let groups = groups.into_iter().enumerate();
        Ok(groups
            .map(|(index, group)| (format!("group[{index}]."), group))
            .collect())
    }

    /// A name that can be a folder's and a column's.
    fn name(&self, key: &str, name: &str) -> Result<(), CampaignError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if name.is_empty() || !name.chars().all(plain) {
            return Err(self.invalid(
                key,
                format!("{name:?}"),
                "a name consists of letters, digits, '-' and '_'",
                "rename it",
            ));
        }
        Ok(())
    }

    /// What a campaign is for, as one line.
    fn description(&self, text: Option<&str>) -> Result<String, CampaignError> {
        let words = text.unwrap_or_default().split_whitespace();
        let line = words.collect::<Vec<_>>().join(" ");
        let length = line.chars().count();
        if length > LONGEST_DESCRIPTION || line.chars().any(is_hidden) {
            return Err(self.invalid(
                "description",
                format!("{length} characters"),
                &format!("a description has at most {LONGEST_DESCRIPTION} characters, all of which can be seen"),
                "say it in fewer words",
            ));
        }
        Ok(line)
    }

    fn episodes(&self, episodes: u32) -> Result<(), CampaignError> {
        if episodes == 0 {
            return Err(self.invalid(
                "episodes",
                0,
                "at least one episode must run",
                "give a positive number",
            ));
        }
        Ok(())
    }

    /// Refuses to prove a rate of episodes that are all the same.
    fn can_prove(&self, campaign: &Campaign) -> Result<(), CampaignError> {
        if campaign.is_random() || campaign.stop.is_none() {
            return Ok(());
        }
        Err(self.invalid(
            "stop",
            "given",
            "nothing in the campaign is random: its episodes are all the same, and prove no rate",
            "draw something from a distribution, or remove it",
        ))
    }

    fn time(&self, file: &TimeFile) -> Result<Time, CampaignError> {
        let duration_s = self.number("time.duration_s", file.duration_s, Bounds::Positive)?;
        let step_s = self.number("time.step_s", file.step_s, Bounds::Positive)?;
        let settle_s = self.number(
            "time.settle_s",
            file.settle_s.unwrap_or(0.0),
            Bounds::NonNegative,
        )?;
        let steps = (duration_s / step_s).round();
        if steps > MAX_STEPS || steps.is_nan() {
            return Err(self.invalid(
                "time.duration_s",
                in_toml(duration_s),
                &format!(
                    "an episode has at most {MAX_STEPS} steps of time.step_s = {}",
                    in_toml(step_s)
                ),
                "shorten it or take longer steps",
            ));
        }
        if steps < 1.0 || (steps * step_s - duration_s).abs() > 1e-6 * step_s {
            return Err(self.invalid(
                "time.step_s",
                in_toml(step_s),
                &format!("must divide time.duration_s = {duration_s} into whole steps"),
                &format!(
                    "use {} for {} in all",
                    in_toml(duration_s / steps.max(1.0)),
                    steps.max(1.0)
                ),
            ));
        }
        if settle_s >= duration_s {
            return Err(self.invalid(
                "time.settle_s",
                in_toml(settle_s),
                &format!("metrics must start before the end at {duration_s} s"),
                "start them earlier",
            ));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "bounded by MAX_STEPS"
        )]
        let mut time = Time {
            step_s,
            steps: steps as u32,
            settle_step: 0,
        };
        time.settle_step = time.onset_step(settle_s).min(time.steps - 1);
        Ok(time)
    }

    /// Refuses more agents than there are addresses for, and references that no memory would hold.
    fn agents_fit(
        &self,
        groups: &[Begun<'_>],
        file: &TimeFile,
        time: Time,
    ) -> Result<(), CampaignError> {
        let agents: usize = groups.iter().map(|group| group.team).sum();
        if agents > MAX_AGENTS {
            return Err(self.invalid(
                "group",
                format!("{agents} agents"),
                &format!("all groups together have at most {MAX_AGENTS} agents"),
                "make the teams smaller",
            ));
        }
        let row_bytes: f64 = groups.iter().map(Begun::row_bytes).sum();
        let bytes = f64::from(2 * time.steps + 1) * row_bytes;
        if bytes <= MAX_TABLE_BYTES {
            return Ok(());
        }
        Err(self.invalid(
            "time.duration_s",
            file.duration_s,
            &format!(
                "the references of {agents} agents over {} steps would take {:.0} GiB",
                time.steps,
                bytes / 1_073_741_824.0
            ),
            "shorten it, take longer steps or a smaller team",
        ))
    }
}
