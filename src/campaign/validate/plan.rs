//! Names of faults and `[[strata]]`.

use crate::campaign::check::Check;
use crate::campaign::error::CampaignError;
use crate::campaign::file::*;
use crate::campaign::plan::{ALL, Strata, Stratum, StratumFaults};
use crate::util::hidden::is_hidden;
use crate::util::suggest::did_you_mean;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Longest name of a fault or stratum: it heads lines and fills cells.
const LONGEST_NAME: usize = 60;
/// Largest share of a stratum.
const LARGEST_SHARE: u32 = 1000;

impl Check<'_> {
    /// The name of each fault: its own, or what fails and how, numbered where that is taken.
    pub(super) fn fault_names(&self, files: &[FaultFile]) -> Result<Vec<Arc<str>>, CampaignError> {
        let own: Vec<Option<&str>> = files.iter().map(|file| file.name.as_deref()).collect();
        for (index, name) in own.iter().enumerate() {
            let Some(name) = name else { continue };
            let key = format!("fault[{index}].name");
            self.title(&key, name)?;
            if own[..index].contains(&Some(name)) {
                return Err(self.invalid(
                    key,
                    format!("{name:?}"),
                    "another fault has this name",
                    "rename one of them",
                ));
            }
        }
        let mut names: Vec<Arc<str>> = Vec::new();
        let mut taken: HashSet<String> = own.iter().flatten().map(ToString::to_string).collect();
        // Of each plain name, the numbers that were tried.
        let mut tried: HashMap<String, usize> = HashMap::new();
        for (file, own_name) in files.iter().zip(&own) {
            let plain = format!("{} {}", file.target.name(), file.kind.name());
            let numbered = |k: usize| match k {
                1 => plain.clone(),
                _ => format!("{plain} {k}"),
            };
            let name = match own_name {
                Some(name) => (*name).to_string(),
                None => {
                    let tried = tried.entry(plain.clone()).or_default();
                    loop {
                        *tried += 1;
                        let name = numbered(*tried);
                        if taken.insert(name.clone()) {
                            break name;
                        }
                    }
                }
            };
            names.push(name.into());
        }
        Ok(names)
    }

    /// A name that people read: one line, not too long, without blanks at its ends, and nothing that a spreadsheet
    /// takes for a formula.
    fn title(&self, key: &str, name: &str) -> Result<(), CampaignError> {
        let fits = !name.is_empty() && name.chars().count() <= LONGEST_NAME;
        let limit = if !fits || name.trim() != name || name.chars().any(is_hidden) {
            &format!(
                "a name is one line of 1 to {LONGEST_NAME} characters that can be seen, without blanks at its ends"
            )
        } else if name.starts_with(['=', '+', '-', '@']) {
            "a name begins with none of = + - @, which spreadsheets take for a formula"
        } else {
            return Ok(());
        };
        Err(self.invalid(key, format!("{name:?}"), limit, "rename it"))
    }

    /// The strata of a campaign's faults, of which the second says whether it is part of the background. Faults of
    /// different groups may have one name, which stands for all of them.
    pub(super) fn strata(
        &self,
        files: &[StratumFile],
        faults: &[(Arc<str>, bool)],
        episodes: u32,
    ) -> Result<Strata, CampaignError> {
        let mut list: Vec<Stratum> = Vec::new();
        for (index, file) in files.iter().enumerate() {
            let table = format!("strata[{index}]");
            let share = file.share.unwrap_or(1);
            if !(1..=LARGEST_SHARE).contains(&share) {
                return Err(self.invalid(
                    format!("{table}.share"),
                    share,
                    &format!("a share is a whole number from 1 to {LARGEST_SHARE}"),
                    "give the episodes relative to the other strata, or remove the stratum",
                ));
            }
            for (name, faults) in self.stratum(&table, file, faults)? {
                let key = match file.name {
                    Some(_) => format!("{table}.name"),
                    None => table.clone(),
                };
                if name.as_ref() == ALL || list.iter().any(|other| other.name == name) {
                    return Err(self.invalid(
                        key,
                        format!("{name:?}"),
                        match name.as_ref() {
                            ALL => "in the tables this name stands for all episodes",
                            _ => "another stratum has this name",
                        },
                        "give it another `name`",
                    ));
                }
                list.push(Stratum {
                    name,
                    faults,
                    share,
                });
            }
        }
        let strata = Strata::new(list);
        self.goes_round("episodes", &strata, episodes)?;
        Ok(strata)
    }

    /// Refuses a number of episodes with which some stratum has not had its share.
    pub(crate) fn goes_round(
        &self,
        key: &str,
        strata: &Strata,
        episodes: u32,
    ) -> Result<(), CampaignError> {
        if strata.turn() <= episodes as usize {
            return Ok(());
        }
        let limit = format!(
            "the shares of the {} strata take {} episodes to go round once",
            strata.all().len(),
            strata.turn()
        );
        let remedy = "simulate more, or give smaller shares";
        Err(self.invalid(key, episodes, &limit, remedy))
    }

    /// The name and the faults of each stratum that a table stands for. Of the campaign's faults, the second says
    /// whether it is part of the background.
    fn stratum(
        &self,
        table: &str,
        file: &StratumFile,
        faults: &[(Arc<str>, bool)],
    ) -> Result<Vec<(Arc<str>, StratumFaults)>, CampaignError> {
        let key = format!("{table}.faults");
        let name = |default: &str| Arc::from(file.name.as_deref().unwrap_or(default));
        if let Some(name) = &file.name {
            self.title(&format!("{table}.name"), name)?;
        }
        match &file.faults {
            StratumFaultsFile::Word(word) if word == "all" || word == "each" => {
                if faults.iter().all(|(_, background)| *background) {
                    return Err(self.invalid(
                        key,
                        format!("{word:?}"),
                        "the campaign has no faults beside a background",
                        "add a [[fault]], or write []",
                    ));
                }
                if word == "all" {
                    return Ok(vec![(name("mixed"), StratumFaults::ByProbability)]);
                }
                if let Some(name) = &file.name {
                    return Err(self.invalid(
                        format!("{table}.name"),
                        format!("{name:?}"),
                        "faults = \"each\" makes several strata, which have the names of the faults",
                        "remove it",
                    ));
                }
                let mut alone: Vec<(Arc<str>, Vec<usize>)> = Vec::new();
                for (k, (name, background)) in faults.iter().enumerate() {
                    match alone.iter_mut().find(|(own, _)| own == name) {
                        _ if *background => {}
                        Some((_, faults)) => faults.push(k),
                        None => alone.push((name.clone(), vec![k])),
                    }
                }
                let certain = |(name, faults)| (name, StratumFaults::Certain(faults));
                Ok(alone.into_iter().map(certain).collect())
            }
            StratumFaultsFile::Word(word) => Err(self.invalid(
                key,
                format!("{word:?}"),
                "\"each\", \"all\", or a list of names of faults",
                "take one of these; [] for none",
            )),
            StratumFaultsFile::Names(names) => {
                let certain = self.named_faults(&key, names, faults)?;
                let default = match names.as_slice() {
                    [] => "none".to_string(),
                    names => names.join(" + "),
                };
                Ok(vec![(name(&default), StratumFaults::Certain(certain))])
            }
        }
    }

    /// The faults of these names, by index.
    fn named_faults(
        &self,
        key: &str,
        names: &[String],
        faults: &[(Arc<str>, bool)],
    ) -> Result<Vec<usize>, CampaignError> {
        let mut certain = Vec::new();
        for (place, own) in names.iter().enumerate() {
            let key = format!("{key}[{place}]");
            let named = faults.iter().enumerate();
            let named = named.filter(|(_, (name, _))| name.as_ref() == own);
            if named.clone().count() == 0 {
                let mut all: Vec<&str> = faults.iter().map(|(name, _)| &**name).collect();
                all.dedup();
                let limit = format!("the campaign's faults are {}", all.join(", "));
                let remedy = did_you_mean(own, all, "name one of them");
                return Err(self.invalid(key, format!("{own:?}"), &limit, &remedy));
            }
            let drawn = named.filter(|(_, (_, background))| !background);
            let drawn: Vec<usize> = drawn.map(|(fault, _)| fault).collect();
            let Some(first) = drawn.first() else {
                return Err(self.invalid(
                    key,
                    format!("{own:?}"),
                    "this fault is part of the background of all strata",
                    "remove it from the list, or its background = true",
                ));
            };
            if certain.contains(first) {
                return Err(self.invalid(
                    key,
                    format!("{own:?}"),
                    "this fault is in the list already",
                    "name it once",
                ));
            }
            certain.extend(drawn);
        }
        Ok(certain)
    }
}
