//! The tables at the top of a campaign file, and those of a group of agents, which stand at the top too where there is
//! a single group.

use super::value::{some_table, table, tables};
use super::{
    AgentFile, ControlFile, CouplingFile, DisturbanceFile, FaultFile, InitialFile, OutputFile,
    ReferenceFile, RequireFile, SamplingFile, SensorsFile, StopFile, StratumFile, SynthesisFile,
    TimeFile, TuneFile, VerdictFile,
};
use schemars::JsonSchema;
use serde::Deserialize;

/// A campaign and a group of agents: what each has of its own, and the tables that stand in a group or, of a file
/// without `[[group]]`, at the top. Of those, the first are needed.
macro_rules! campaign_and_group {
    (
        $(#[$campaign_doc:meta])*
        $campaign:ident { $($(#[$common_doc:meta])* $common:ident: $common_type:ty,)* }
        $(#[$group_doc:meta])*
        $group:ident { $($(#[$own_doc:meta])* $own:ident: $own_type:ty,)* }
        needed { $($(#[$needed_doc:meta])* $needed:ident: $needed_type:ty,)* }
        optional { $($(#[$optional_doc:meta])* $optional:ident: $optional_type:ty,)* }
    ) => {
        $(#[$campaign_doc])*
        #[derive(Debug, Clone, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $campaign {
            $($(#[$common_doc])* pub $common: $common_type,)*
            $(
                $(#[$needed_doc])*
                #[serde(default, deserialize_with = "some_table")]
                pub $needed: Option<$needed_type>,
            )*
            $($(#[$optional_doc])* pub $optional: $optional_type,)*
        }

        $(#[$group_doc])*
        #[derive(Debug, Clone, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $group {
            $($(#[$own_doc])* pub $own: $own_type,)*
            $(
                $(#[$needed_doc])*
                #[serde(deserialize_with = "table")]
                pub $needed: $needed_type,
            )*
            $($(#[$optional_doc])* pub $optional: $optional_type,)*
        }

        impl $campaign {
            /// The first table at the top that belongs to a group of agents.
            pub(in crate::campaign) fn group_table_at_the_top(&self) -> Option<&'static str> {
                $(if self.$needed.is_some() { return Some(stringify!($needed)); })*
                $(if self.$optional.is_given() { return Some(stringify!($optional)); })*
                None
            }

            /// Takes the group whose tables are at the top.
            ///
            /// # Errors
            /// The name of the first table that is missing.
            pub(in crate::campaign) fn take_only_group(&mut self) -> Result<$group, &'static str> {
                Ok($group {
                    $($own: <$own_type>::default(),)*
                    $($needed: self.$needed.take().ok_or(stringify!($needed))?,)*
                    $($optional: std::mem::take(&mut self.$optional),)*
                })
            }
        }
    };
}

/// Whether a table is written at all.
trait IsGiven {
    fn is_given(&self) -> bool;
}

impl<T> IsGiven for Option<T> {
    fn is_given(&self) -> bool {
        self.is_some()
    }
}

impl<T> IsGiven for Vec<T> {
    fn is_given(&self) -> bool {
        !self.is_empty()
    }
}

campaign_and_group! {
    /// A campaign: which closed loop is simulated, what disturbs it, how often, and what counts as failure.
    CampaignFile {
        /// Name of the campaign and of its output folder.
        name: String,
        /// What is tested and why, in a few sentences for the report.
        description: Option<String>,
        /// Seed of every random number.
        seed: u64,
        /// Number of episodes.
        episodes: u32,
        /// Controllers to compare, all on the same draws: "ftc", "ftc-tuned", "pid", "pid-placed", "pid-tuned",
        /// "pid-robust-observer" or a name under `[synthesis.named]`.
        controllers: Option<Vec<String>>,
        /// Duration and step.
        #[serde(deserialize_with = "table")]
        time: TimeFile,
        /// Parts of the episodes with faults of their own (default: all episodes draw all faults).
        #[serde(default, deserialize_with = "tables")]
        strata: Vec<StratumFile>,
        /// How the random numbers of the episodes are chosen.
        #[serde(default, deserialize_with = "some_table")]
        sampling: Option<SamplingFile>,
        /// When the run may end before its last episode (default: never).
        #[serde(default, deserialize_with = "some_table")]
        stop: Option<StopFile>,
        /// What the run writes.
        #[serde(default, deserialize_with = "some_table")]
        output: Option<OutputFile>,
        /// Conditions on the result; one that does not hold makes the run exit with 4.
        #[serde(default, deserialize_with = "tables")]
        require: Vec<RequireFile>,
        /// What `urts-mc tune` searches.
        #[serde(default, deserialize_with = "some_table")]
        tune: Option<TuneFile>,
        /// Groups of agents that are simulated in one episode, each with tables of its own; without them the tables of
        /// the only group stand at the top.
        #[serde(default, deserialize_with = "tables")]
        group: Vec<GroupFile>,
    }
    /// `[[group]]`: agents of one kind, which may act on each other and on no other group.
    GroupFile {
        /// Its name in tables and texts.
        name: String,
    }
    needed {
        /// The plant.
        agent: AgentFile,
        /// Where the agents are to go.
        reference: ReferenceFile,
        /// How the gains are found.
        synthesis: SynthesisFile,
    }
    optional {
        /// What is between measurement and command, beside the controller.
        #[serde(default, deserialize_with = "some_table")]
        control: Option<ControlFile>,
        /// Initial errors.
        #[serde(default, deserialize_with = "some_table")]
        initial: Option<InitialFile>,
        /// Coupling between the agents of a team, (10).
        #[serde(default, deserialize_with = "some_table")]
        coupling: Option<CouplingFile>,
        /// External disturbances d1, summed.
        #[serde(default, deserialize_with = "tables")]
        disturbance: Vec<DisturbanceFile>,
        /// Faults of actuators, sensors, the network and the plant.
        #[serde(default, deserialize_with = "tables")]
        fault: Vec<FaultFile>,
        /// What counts as failure.
        #[serde(default, deserialize_with = "some_table")]
        verdict: Option<VerdictFile>,
        /// Sensors that are not three of each channel.
        #[serde(default, deserialize_with = "some_table")]
        sensors: Option<SensorsFile>,
    }
}
