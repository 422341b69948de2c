//! A run flown by several processes, each a shard of its parts; and which one this process is, as the engine that began
//! it says.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;

/// One of the shards of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which, from 1.
    number: u32,
    /// Of how many.
    of: u32,
}

/// In how many shards a run was begun, kept beside its parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shards {
    /// How many.
    pub of: u32,
    /// What the engine that began them calls the first.
    pub first: u32,
}

impl Shard {
    /// Shards that a run may have: more than any engine's array.
    pub const MOST: u32 = 100_000;

    /// One of so many, if there is such a one.
    #[must_use]
    pub fn new(number: u32, of: u32) -> Option<Self> {
        (1 <= number && number <= of && of <= Self::MOST).then_some(Self { number, of })
    }

    /// Which, from 1.
    #[must_use]
    pub fn number(self) -> u32 {
        self.number
    }

    /// Of how many.
    #[must_use]
    pub fn of(self) -> u32 {
        self.of
    }

    /// Its parts of a run: as many as each of the others has, or one more.
    #[must_use]
    pub fn parts(self, count: u32) -> Range<u32> {
        let until = |number: u32| {
            let parts = u64::from(count) * u64::from(number) / u64::from(self.of);
            u32::try_from(parts).unwrap_or(count)
        };
        until(self.number - 1)..until(self.number)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// What `--shard` asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AskedShard {
    /// This one.
    Given(Shard),
    /// The one that the engine says, of so many if that is given.
    Auto(Option<u32>),
}

impl std::str::FromStr for AskedShard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const FORM: &str = "write it as 3/8, from 1/8 to 8/8, or auto; there are at most 100000";
        let count = |text: &str| text.parse().ok().filter(|count: &u32| *count > 0);
        let form = || FORM.to_string();
        match text.split_once('/') {
            None if text == "auto" => Ok(Self::Auto(None)),
            Some(("auto", of)) => Ok(Self::Auto(Some(count(of).ok_or_else(form)?))),
            Some((number, of)) => {
                let [number, of] = [number, of].map(count);
                let shard = number
                    .zip(of)
                    .and_then(|(number, of)| Shard::new(number, of));
                shard.map(Self::Given).ok_or_else(form)
            }
            None => Err(form()),
        }
    }
}

/// How an engine tells its tasks which they are.
struct Convention {
    /// The engine.
    engine: &'static str,
    /// The variable with the task's number.
    number: &'static str,
    /// That with the number of the first task, or that number.
    first: Result<&'static str, u32>,
    /// That with the number of the last.
    last: Option<&'static str>,
    /// That with how many there are.
    count: Option<&'static str>,
}

const CONVENTIONS: [Convention; 5] = [
    Convention {
        engine: "Slurm",
        number: "SLURM_ARRAY_TASK_ID",
        first: Ok("SLURM_ARRAY_TASK_MIN"),
        last: Some("SLURM_ARRAY_TASK_MAX"),
        count: Some("SLURM_ARRAY_TASK_COUNT"),
    },
    Convention {
        engine: "Kubernetes",
        number: "JOB_COMPLETION_INDEX",
        first: Err(0),
        last: None,
        count: Some("JOB_COMPLETIONS"),
    },
    Convention {
        engine: "AWS Batch",
        number: "AWS_BATCH_JOB_ARRAY_INDEX",
        first: Err(0),
        last: None,
        count: Some("AWS_BATCH_JOB_ARRAY_SIZE"),
    },
    Convention {
        engine: "PBS",
        number: "PBS_ARRAY_INDEX",
        first: Err(1),
        last: None,
        count: None,
    },
    Convention {
        engine: "Grid Engine",
        number: "SGE_TASK_ID",
        first: Ok("SGE_TASK_FIRST"),
        last: Some("SGE_TASK_LAST"),
        count: None,
    },
];

/// The shard that the engine says this process is, what the engine calls the first, and a sentence on what it was taken
/// from. `variable` reads the environment; `begun` is in how many shards the directory was begun, if it was: an array
/// of those that are missing says nothing of how many there are.
///
/// # Errors
/// If no engine says so, or nothing says of how many.
pub fn shard_of(
    variable: &dyn Fn(&str) -> Option<String>,
    asked: Option<u32>,
    begun: Option<Shards>,
) -> Result<(Shard, Shards, String), String> {
    let number = |name: &str| variable(name)?.trim().parse::<u32>().ok();
    let mut known = CONVENTIONS.iter();
    let found = known.find_map(|own| Some((own, number(own.number)?)));
    let Some((own, task)) = found else {
        let names: Vec<&str> = CONVENTIONS.iter().map(|own| own.number).collect();
        return Err(format!(
            "none of {} is there; begin it by one of these engines, or give it as 3/8",
            names.join(", ")
        ));
    };
    let lowest = match own.first {
        Ok(name) => number(name),
        Err(first) => Some(first),
    };
    let highest = own.last.and_then(number);
    let count = own.count.and_then(number);
    // An array without gaps.
    let whole = match (lowest, highest, count) {
        (Some(lowest), Some(highest), Some(count)) => {
            (highest.checked_sub(lowest) == count.checked_sub(1)).then_some(count)
        }
        (Some(lowest), Some(highest), None) => (highest - lowest.min(highest)).checked_add(1),
        (_, None, count) => count,
        (None, Some(_), _) => None,
    };
    let first = match (begun, own.first) {
        (Some(begun), Ok(_)) => begun.first,
        (_, Err(first)) => first,
        (None, Ok(_)) => lowest.unwrap_or(1),
    };
    let of = asked.or(begun.map(|own| own.of)).or(whole);
    let Some(of) = of else {
        return Err(format!(
            "{} says {} = {task}, but not of how many; say it as auto/8",
            own.engine, own.number
        ));
    };
    let place = task.checked_sub(first).and_then(|own| own.checked_add(1));
    let shard = place.and_then(|number| Shard::new(number, of));
    match shard {
        Some(shard) => Ok((
            shard,
            Shards { of, first },
            format!(
                "shard {shard}, by {} = {task} of {}",
                own.number, own.engine
            ),
        )),
        None => Err(format!(
            "{} says {} = {task}, which is none of {of} shards that begin with {first}; give it as 3/8, or \
             all of them as auto/8",
            own.engine, own.number
        )),
    }
}
