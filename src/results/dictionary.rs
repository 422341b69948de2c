//! The data dictionary: what every column of every table means, in which unit, and when a cell is empty.

use crate::campaign::AgentGroup;
use crate::draw::quantities::{Quantity, Source};
use serde::Serialize;

/// Of which type the cells of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Text.
    Text,
    /// A whole number, 64 bits with sign.
    Whole,
    /// A real number, double precision.
    Real,
    /// Yes or no.
    Flag,
}

impl Kind {
    /// Its word in the dictionary.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Whole => "whole",
            Self::Real => "real",
            Self::Flag => "flag",
        }
    }
}

/// What a column is. A name may have parts in angle brackets that stand for any text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ColumnEntry {
    /// The tables that have it; "*" of all.
    pub tables: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Of which type its cells are.
    pub kind: Kind,
    /// Its unit; empty of what has none.
    pub unit: &'static str,
    /// When a cell is empty (null); never if this is.
    pub empty: &'static str,
    /// What it is.
    pub meaning: &'static str,
}

macro_rules! entries {
    ($(of $tables:literal: $($name:literal $kind:ident $unit:literal $empty:literal $meaning:literal,)*)*) => {
        &[$($(ColumnEntry {
            tables: $tables,
            name: $name,
            kind: Kind::$kind,
            unit: $unit,
            empty: $empty,
            meaning: $meaning,
        },)*)*]
    };
}

/// All columns, in the order of the tables.
pub const DICTIONARY: &[ColumnEntry] = entries! {
    of "episodes channels faults conditions":
    "episode" Whole "" "" "number of the episode, from 0",
    "group" Text "" "" "group of agents; only in campaigns with [[group]]",
    "agent" Whole "" "" "number of the agent, from 0 through all groups",
    of "episodes channels":
    "controller" Text "" "" "name of the controller",
    of "episodes":
    "stratum" Text "" "" "stratum of the episode; only with [[strata]]",
    "replicate" Whole "" "" "replicate of the sampling design; only with [sampling]",
    "status" Text "" "" "how the agent ended: ok, exceeded, diverged",
    "episode_status" Text "" "" "how the episode ended: the worst of its agents",
    "failed_at_s" Real "s" "the agent did not fail" "when it first broke max_error or left the numbers; the end if only max_rmse was broken",
    "rmse_<role>" Real "m or rad" "the agent diverged" "RMS error over the agent's channels of that kind: root of the mean of their squared rmse",
    "max_abs_<role>" Real "m or rad" "the agent diverged" "largest error of any of them",
    "settling_s" Real "s" "the agent did not settle" "when the last of its channels was settled before its first fault, see the table of channels",
    "recovery_s" Real "s" "no fault began in flight, or the agent did not settle again" "how long after the first fault its last channel was settled again",
    "saturated_fraction" Real "" "the agent diverged" "largest share of the steps at a limit of any of its channels",
    "mass_scale" Real "" "the other kind of agent" "true mass over the modelled one",
    "inertia_scale" Real "" "the other kind of agent" "true inertia over the modelled one",
    "kappa" Real "" "" "strength of the coupling (10)",
    "control_<parameter>" Real "by name" "" "what is between measurement and command",
    "initial_error_<channel>" Real "m or rad" "a channel of the other kind of agent" "error at the start",
    "initial_error_rate_<channel>" Real "m/s or rad/s" "a channel of the other kind of agent" "its rate at the start",
    "initial_error_integral_<channel>" Real "m s or rad s" "a channel of the other kind of agent" "its integral at the start",
    "disturbance<n>_<parameter>_<channel>" Real "by name" "the disturbance does not act there" "a parameter of disturbance n, numbered through all groups",
    "fault<n>_occurs" Flag "" "the other group" "whether the agent has fault n, numbered through all groups",
    "fault<n>_name" Text "" "the fault does not occur" "name of fault n",
    "fault<n>_channel" Text "" "the fault does not occur" "the channel that it strikes, of a fault that strikes one at random",
    "fault<n>_<parameter>" Real "by name" "the fault does not occur, or not there" "a parameter of fault n; onset_s, duration_s, ramp_s, or one of a channel",
    of "channels":
    "channel" Text "" "" "name of the channel: axis, angle or joint",
    "rmse" Real "m or rad" "the agent diverged" "root mean square of e from settle_s on",
    "max_abs" Real "m or rad" "the agent diverged" "largest |e| from settle_s on",
    "ise" Real "m² s or rad² s" "the agent diverged" "integral of e² from settle_s on",
    "iae" Real "m s or rad s" "the agent diverged" "integral of |e| from settle_s on",
    "peak_rate" Real "m/s or rad/s" "the agent diverged" "largest |e'| from settle_s on",
    "settling_s" Real "s" "it did not settle" "when |e| went below verdict.settled_error for good, before the agent's first fault",
    "recovery_s" Real "s" "no fault began in flight, or it did not settle again" "how long after the agent's first fault |e| went below it for good",
    "effort" Real "N² s or N² m² s" "the agent diverged" "integral of u² over the whole run",
    "u_max" Real "N or N m" "the agent diverged" "largest |u| over the whole run",
    "saturated_fraction" Real "" "the agent diverged" "share of the steps at which a limit cuts the command",
    "f1_rms_error" Real "m/s² or rad/s²" "the agent diverged" "root mean square of f1hat - f1 from settle_s on",
    "f2_rms_error" Real "m/s or rad/s" "the agent diverged" "root mean square of f2hat - f2 from settle_s on",
    of "faults":
    "fault" Text "" "" "name of the fault",
    "target" Text "" "" "what fails: actuator, sensor, network, plant",
    "kind" Text "" "" "how",
    "channels" Text "" "" "the channels that it strikes, with blanks between them",
    "onset_s" Real "s" "" "when it begins",
    "duration_s" Real "s" "it stays to the end" "how long it stays",
    "ramp_s" Real "s" "" "the time in which it comes",
    "parameters" Text "" "it has none" "its parameters as JSON, by name and channel",
    of "conditions":
    "source" Text "" "" "what a number belongs to: agent, control, initial, disturbance n, or the name of a fault",
    "quantity" Text "" "" "its key in the campaign file",
    "channel" Text "" "it is one of the agent" "the channel that it is of",
    "value" Real "see unit" "it is infinite: to the end" "what was drawn, times as they happen",
    "unit" Text "" "it has none, or one of its own" "the unit of the value",
    of "summary":
    "controller" Text "" "" "name of the controller",
    "stratum" Text "" "" "which episodes: all first, then each stratum, or those with and without a fault",
    "metric" Text "" "" "number of an episode: rmse, max_abs, peak_command, effort, saturated_share, settling_s, recovery_s",
    "group" Text "" "" "channels: position, attitude or joints, with the group of agents in front where it has a name",
    "n" Whole "" "" "episodes",
    "failed" Whole "" "" "those that exceeded or diverged",
    "exceeded" Whole "" "" "those that broke a limit and stayed finite",
    "diverged" Whole "" "" "those that left the numbers",
    "failure_rate" Real "" "there are no episodes" "failed over n",
    "failure_rate_<method>_<end>" Real "" "nothing is random, or another method holds" "end of its 95 % interval: wilson, sequential ([stop]), replicates ([sampling])",
    "failure_rate_upper_95" Real "" "nothing is random, or a design is used" "its one-sided 95 % bound: Clopper-Pearson's, or that of the confidence sequence",
    "group_<count>" Whole "" "" "the same of the group of agents alone: failed, exceeded, diverged; only with [[group]]",
    "group_failure_rate" Real "" "there are no episodes" "the same of the group of agents alone",
    "group_failure_rate_<part>" Real "" "as above" "ends of its interval, and its bound",
    "q<percent>" Real "that of the metric" "no episode has one" "quantile over the episodes, an order statistic; infinite where it falls on a diverged one",
    "q<percent>_<end>" Real "that of the metric" "too few episodes, or a design" "end of its 95 % interval by order statistics",
    of "fairness":
    "controller" Text "" "" "name of the controller",
    "group" Text "" "" "channels, as in the summary",
    "crossover_rad_s" Real "rad/s" "the gains' design is not known" "gain crossover at which the delay margin is taken",
    "phase_margin_deg" Real "deg" "the gains' design is not known" "smallest phase margin",
    "delay_margin_ms" Real "ms" "the gains' design is not known" "smallest dead time that destabilises the loop",
    "sensitivity_peak" Real "" "the gains' design is not known" "largest |1 / (1 + loop gain)|",
    "noise_peak" Real "" "the gains' design is not known" "largest gain from noise on x and x' to the feedback acceleration",
    "noise_h2" Real "" "the gains' design is not known" "the same of white noise, root mean square",
    "peak_command_p95" Real "N or N m" "it is infinite" "95th percentile over the episodes of the largest |u|",
    "effort_p50" Real "N² s or N² m² s" "it is infinite" "median over the episodes of the integral of u², in the mean over agents and channels",
    "saturated_share" Real "" "all diverged" "share of the steps at a limit, mean over the episodes, of the channel where it is largest",
    "nominal_settling_s" Real "s" "more than two minutes" "how long 5 % of an initial error are left, without faults",
    "settling_p50_s" Real "s" "half of the episodes do not settle" "median over the episodes of when the last channel settles",
    "reversals_per_s" Real "1/s" "there is no median flight" "changes of sign of the command that has most of them, in the median flight",
    "command_rate_per_s" Real "N/s or N m/s" "there is no median flight" "root mean square of du/dt in the median flight",
    of "comparison":
    "a" Text "" "" "first controller",
    "b" Text "" "" "second controller",
    "stratum" Text "" "" "which episodes, as in the summary",
    "scope" Text "" "" "group of channels, or channel",
    "name" Text "" "" "of which",
    "both_failed" Whole "" "" "episodes in which both failed",
    "only_a_failed" Whole "" "" "episodes in which a alone failed",
    "only_b_failed" Whole "" "" "episodes in which b alone failed",
    "neither_failed" Whole "" "" "episodes in which neither failed",
    "mcnemar_mid_p" Real "" "nothing is random, or a design" "mid-p of equal failure rates",
    "mcnemar_mid_p_holm" Real "" "nothing is random, or a design" "the same after Holm's correction for all pairs and strata",
    "failure_rate_difference" Real "" "there are no episodes" "failure rate of a less that of b",
    "failure_rate_difference_<end>" Real "" "nothing is random, or a design" "end of its 95 % interval, Tango's",
    "failure_rate_difference_replicates" Real "" "too few replicates" "the same over the replicates of a design",
    "failure_rate_difference_replicates_<end>" Real "" "too few replicates" "end of its 95 % interval, Student's t",
    "log_ratio" Real "" "there are no episodes" "median over the episodes of ln(rmse of b / rmse of a)",
    "log_ratio_<end>" Real "" "nothing is random, or a design" "end of its 95 % interval, BCa",
    "ratio" Real "" "there are no episodes" "exp(log_ratio): above 1, a is closer",
    "ratio_<end>" Real "" "nothing is random, or a design" "end of its 95 % interval",
    "log_ratio_replicates" Real "" "too few replicates" "mean over the replicates of a design of their medians",
    "log_ratio_replicates_<end>" Real "" "too few replicates" "end of its 95 % interval, Student's t",
    "win_rate" Real "" "there are no episodes" "share of the episodes in which a is closer, ties half",
    "win_rate_<end>" Real "" "nothing is random, or a design" "end of its 95 % interval, Tango's",
    "only_a_diverged" Whole "" "" "episodes in which a alone diverged",
    "only_b_diverged" Whole "" "" "episodes in which b alone diverged",
    "both_diverged" Whole "" "" "episodes in which both diverged",
    of "screening":
    "controller" Text "" "" "name of the controller",
    "stratum" Text "" "" "a stratum with faults",
    "reference" Text "" "" "the stratum that it is compared with: the one without faults, or the mildest",
    "failure_rate_difference" Real "" "there are no episodes" "failure rate of the stratum less that of the reference",
    "failure_rate_difference_<end>" Real "" "there are no episodes" "end of its 95 % interval, Newcombe's",
    "may_fail_most" Flag "" "" "whether it may be the one in which the controller fails most",
    "log_growth_<group>" Real "" "there are no episodes" "logarithm of the ratio of median RMS errors to the reference",
    "log_growth_<group>_<end>" Real "" "there are no episodes" "end of its 95 % interval",
    "may_grow_most_<group>" Flag "" "" "whether it may be the one in which the errors grow most",
    of "ranking":
    "target" Text "" "" "what a condition may move: failure, rmse, log_ratio",
    "controller" Text "" "" "the controller",
    "against" Text "" "not a log-ratio" "the controller that it is compared with",
    "group" Text "" "failures" "channels",
    "condition" Text "" "" "what was drawn: its key in the tables, summed up over the team",
    "episodes" Whole "" "" "those to which it applies",
    "trend" Real "" "it cannot be computed" "monotone effect: Somers' d on failures, Spearman's correlation else",
    "trend_<end>" Real "" "nothing is random, or a design" "end of its 95 % interval",
    "trend_p" Real "" "not tested" "p-value of no such effect, by permutations",
    "shape" Real "" "it cannot be computed" "effect of any form",
    "shape_p" Real "" "not tested" "p-value of no such effect, by permutations",
    "p_holm" Real "" "not tested" "p-value of no effect after Holm's correction for all conditions of the target",
    of "worst":
    "controller" Text "" "" "name of the controller",
    "rank" Whole "" "" "1 is the worst",
    "episode" Whole "" "" "number of the episode",
    "status" Text "" "" "how it ended",
    "largest_error_over_limit" Real "" "" "largest |e| over verdict.max_error, or over 1 where there is no limit; infinite if it diverged",
    "failed_at_s" Real "s" "it did not fail" "when the first agent failed",
    "agent" Whole "" "" "the agent with that error, or that failed first",
    "channel" Text "" "" "the channel with that error",
    "stratum" Text "" "" "its stratum; only with [[strata]]",
    "faults" Text "" "nobody has one" "names of the faults that somebody has",
    "mass_scale" Real "" "" "root mean square over the team",
    "inertia_scale" Real "" "the other kind of agent" "root mean square over the team",
    "kappa" Real "" "" "root mean square over the team",
    "control_<parameter>" Real "by name" "" "root mean square over the team",
    "initial_<parameter>" Real "by name" "" "root mean square over team and channels",
    "disturbance<n>_<parameter>" Real "by name" "it does not act" "root mean square over team and channels",
    "fault<n>_agents" Real "" "" "how many agents have fault n",
    "fault<n>_<parameter>" Real "by name" "nobody has it" "of an onset the first; else root mean square over team and channels",
    "<group>_<condition>" Real "by name" "it does not act, or nobody has it" "with [[group]]: what the column without the group's name is, of that group",
    of "curves":
    "curve" Text "" "" "distribution: of the team's RMS error; survival; band: errors over the strongest condition",
    "controller" Text "" "" "name of the controller",
    "group" Text "" "survival" "channels, as in the summary, or one channel",
    "condition" Text "" "not a band" "the condition, as in the ranking",
    "x" Real "see curve" "" "distribution: an RMS error; survival: a time in s; band: a value of the condition",
    "y" Real "see curve" "" "distribution: share of the episodes with no larger error; survival: share not failed by then; band: median RMS error",
    "y_lower" Real "see curve" "not a band" "band: 5th percentile of the RMS error",
    "y_upper" Real "see curve" "not a band" "band: 95th percentile of the RMS error",
    of "flights":
    "flight" Text "" "" "median or worst, of the first controller",
    "episode" Whole "" "" "number of the episode",
    "controller" Text "" "" "name of the controller",
    "group" Text "" "" "channels",
    "t_s" Real "s" "" "time",
    "error" Real "m or rad" "the flight diverged" "root mean square of e over agents and channels at that time",
    "command" Real "N or N m" "the flight diverged" "largest |u| of them",
    "failed_at_s" Real "s" "it did not fail" "when the first agent failed; the end if only max_rmse was broken",
    of "replay":
    "t_s" Real "s" "" "time",
    "agent" Whole "" "" "number of the agent",
    "channel" Text "" "" "name of the channel",
    "r" Real "m or rad" "the agent diverged" "reference",
    "x" Real "m or rad" "the agent diverged" "state",
    "e" Real "m or rad" "the agent diverged" "tracking error x - r",
    "e_rate" Real "m/s or rad/s" "the agent diverged" "its rate",
    "e_hat" Real "m or rad" "the agent diverged" "its estimate",
    "f1" Real "m/s² or rad/s²" "the agent diverged" "actuator fault (14), with all that the feedforward does not cancel",
    "f1_hat" Real "m/s² or rad/s²" "the agent diverged" "its estimate",
    "f2" Real "m/s or rad/s" "the agent diverged" "sensor fault (16)",
    "f2_hat" Real "m/s or rad/s" "the agent diverged" "its estimate",
    "u" Real "N or N m" "the agent diverged" "command that acts",
};

/// What a column of a table is; the most exact of the entries that fit.
#[must_use]
pub fn entry(table: &str, column: &str) -> Option<&'static ColumnEntry> {
    let of_table = DICTIONARY
        .iter()
        .filter(|own| own.tables.split(' ').any(|name| name == table));
    let fitting = of_table.filter(|own| fits(own.name, column));
    // Letters that are said, not left open.
    fitting.max_by_key(|own| {
        let open = own.name.split('<').skip(1);
        let open: usize = open
            .map(|rest| rest.find('>').unwrap_or_default() + 2)
            .sum();
        own.name.len() - open
    })
}

/// Whether a name is one of a pattern, whose parts in angle brackets stand for any text.
fn fits(pattern: &str, name: &str) -> bool {
    let Some((before, rest)) = pattern.split_once('<') else {
        return pattern == name;
    };
    let Some(name) = name.strip_prefix(before) else {
        return false;
    };
    let rest = rest.split_once('>').map_or("", |(_, rest)| rest);
    let ends = name
        .char_indices()
        .map(|(place, letter)| place + letter.len_utf8());
    let mut ends = ends;
    ends.any(|end| fits(rest, &name[end..]))
}

/// Units that the names of quantities end in.
const SUFFIXES: &[(&str, &str)] = &[
    ("_rad_s", "rad/s"),
    ("_n_s_m", "N s/m"),
    ("_m_s", "m/s"),
    ("_kg", "kg"),
    ("_rad", "rad"),
    ("_ms", "ms"),
    ("_s", "s"),
    ("_n", "N"),
    ("_m", "m"),
];

/// The unit that the name of a quantity says; none where it says none.
fn unit_of_name(name: &str) -> Option<&'static str> {
    let mut suffixes = SUFFIXES.iter();
    let found = suffixes.find(|(suffix, _)| name.ends_with(suffix))?;
    Some(found.1)
}

/// The unit of a column of a table, as its metadata say it: none of text, counts and numbers without unit.
#[must_use]
pub fn unit(table: &str, column: &str) -> Option<&'static str> {
    let entry = entry(table, column)?;
    match entry.unit {
        "" | "see unit" | "see curve" | "that of the metric" => None,
        "by name" => {
            // A channel's name follows the parameter's.
            let shorter = column.rsplit_once('_').map_or("", |(rest, _)| rest);
            unit_of_name(column).or_else(|| unit_of_name(shorter))
        }
        unit => Some(unit),
    }
}

/// The unit of a number that was drawn; empty of what has none or one of its own.
pub(super) fn unit_of_parameter(quantity: &Quantity, group: &AgentGroup, channel: usize) -> String {
    if let Some(unit) = unit_of_name(quantity.name) {
        return unit.to_string();
    }
    let length = group.unit(channel);
    match (quantity.source, quantity.name) {
        (Source::Initial, "error") => length.to_string(),
        (Source::Initial, "error_rate") => format!("{length}/s"),
        (Source::Initial, "error_integral") => format!("{length} s"),
        (Source::Disturbance(..), "amplitude") if length == "m" => "N".to_string(),
        (Source::Disturbance(..), "amplitude") => "N m".to_string(),
        _ => String::new(),
    }
}
