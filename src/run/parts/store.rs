//! The parts in a directory.

use super::file::{self, Header};
use super::folder::{FOLDER, Found, PART, PLAN, Resume, SHARDS, judged, lock_of};
use super::plan::{Plan, program};
use super::record::{Outcomes, Record};
use crate::campaign::Campaign;
use crate::run::directory::OutputDir;
use crate::run::error::{GAINS, OutputError};
use crate::run::lock::{LOCK, Lock, NotHeld, Sharing};
use crate::run::shard::{Shard, Shards};
use crate::run::sink::sync_names;
use crate::simulation::Engine;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{Error, ErrorKind};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Bytes of a part, about: what a process that is killed loses at most, and what is held in memory of it.
const BYTES: usize = 8 << 20;
/// Episodes of a part, at least and at most.
const FEWEST: usize = 16;
const MOST: usize = 1024;

/// The parts of a run.
#[derive(Debug)]
pub(crate) struct Parts {
    /// The run's directory.
    pub(super) out: PathBuf,
    pub(super) dir: PathBuf,
    pub(super) plan: Plan,
    pub(super) id: String,
    pub(super) record: Record,
    /// Those that this process looks after: all, or a shard's.
    pub(super) own: Range<u32>,
    /// Keeps others from the same shard.
    pub(super) lock: Option<Lock>,
    pub(super) held: BTreeMap<u32, Header>,
    /// What there is to know about those that were there.
    pub(crate) notes: Vec<String>,
}

impl Parts {
    /// Episodes of a part of a campaign: a power of two, whatever flies them.
    pub(crate) fn size_of(campaign: &Campaign) -> u32 {
        let fitting = (BYTES / Record::of(campaign).bytes().max(1)).clamp(FEWEST, MOST);
        let below = |size: &u32| *size as usize <= fitting;
        (0..)
            .map(|power| 1 << power)
            .take_while(below)
            .last()
            .unwrap_or(1)
    }

    /// Refuses parts of another run that are in a directory, before any work.
    ///
    /// # Errors
    /// If there are some that nobody said are to go.
    pub(crate) fn may_be_in(
        out: &Path,
        campaign: &Campaign,
        plan: &Plan,
        resume: Resume,
    ) -> Result<(), OutputError> {
        judged(out, campaign, plan, resume).map(|_| ())
    }

    /// Opens the parts of a run in its directory: those that are there are gone on with, if they are of the same plan.
    ///
    /// # Errors
    /// If there are others, or they cannot be read.
    pub(crate) fn open(
        out: &OutputDir,
        campaign: &Campaign,
        plan: Plan,
        gains: &[u8],
        engine: &Engine,
        resume: Resume,
    ) -> Result<Self, OutputError> {
        let found = judged(out.path(), campaign, &plan, resume)?;
        let mut parts = Self::none(out.path(), campaign, plan);
        match found {
            Found::Nothing => parts.remove()?,
            Found::Ours => {
                parts.clear();
                parts.find();
            }
        }
        parts.may_go_on(engine, resume)?;
        if let Err(error) = parts.begin(gains) {
            parts.leave();
            return Err(error);
        }
        Ok(parts)
    }

    /// Opens a shard's parts of a run, beside the processes of other shards.
    ///
    /// # Errors
    /// As [`Parts::open`], and if another process flies this shard.
    pub(crate) fn open_shard(
        out: &OutputDir,
        campaign: &Campaign,
        plan: Plan,
        gains: &[u8],
        (shard, shards): (Shard, Shards),
        engine: &Engine,
        resume: Resume,
    ) -> Result<Self, OutputError> {
        let found = judged(out.path(), campaign, &plan, resume)?;
        let mut parts = Self::none(out.path(), campaign, plan);
        parts.own = shard.parts(parts.count());
        let lock = Lock::take(&parts.dir, &lock_of(shard), Sharing::Alone);
        parts.lock = Some(lock.map_err(|error| match error {
            NotHeld::Taken(holder) => OutputError::Busy {
                path: parts.out.clone(),
                holder: format!("{holder} (shard {shard})"),
            },
            NotHeld::Failed(error) => parts.unwritable(error),
        })?);
        if matches!(found, Found::Ours) {
            parts.find();
        }
        parts.may_go_on(engine, resume)?;
        parts.begin(gains)?;
        let json = serde_json::to_vec(&shards).map_err(Error::other);
        let json = json.map_err(|error| parts.unwritable(error))?;
        parts.folder().write(SHARDS, &json)?;
        Ok(parts)
    }

    /// The process that holds the whole run, if there is one.
    pub(crate) fn pilot(&self) -> Option<String> {
        Lock::holder_of(&self.out, LOCK)
    }

    /// Whether these are the parts of one shard, beside which others are flown.
    pub(crate) fn is_shard(&self) -> bool {
        self.lock.is_some()
    }

    /// Episodes of a part that are kept.
    pub(crate) fn kept_of(&self, index: u32) -> u32 {
        let kept = self.held.get(&index).map_or(0, Header::episodes);
        kept.min(self.episodes_of(index))
    }

    pub(super) fn none(out: &Path, campaign: &Campaign, plan: Plan) -> Self {
        let mut parts = Self {
            out: out.to_path_buf(),
            dir: out.join(FOLDER),
            id: plan.id(campaign),
            record: Record::of(campaign),
            plan,
            own: 0..0,
            lock: None,
            held: BTreeMap::new(),
            notes: Vec::new(),
        };
        parts.own = 0..parts.count();
        parts
    }

    /// Writes whose the parts are.
    pub(super) fn begin(&self, gains: &[u8]) -> Result<(), OutputError> {
        self.folder().write(GAINS, gains)?;
        let json = serde_json::to_vec_pretty(&self.plan).map_err(Error::other);
        let json = json.map_err(|error| self.unwritable(error))?;
        self.folder().write(PLAN, &json)
    }

    /// The file of the gains that the parts were flown with.
    pub(crate) fn gains(&self) -> PathBuf {
        self.dir.join(GAINS)
    }

    /// Takes away what processes that were killed have left half written. Nobody else may be writing there.
    fn clear(&self) {
        let entries = fs::read_dir(&self.dir).into_iter().flatten().flatten();
        for entry in entries.filter(|own| own.file_name().to_string_lossy().ends_with(".part")) {
            // What stays takes room, and does no harm.
            let _ = fs::remove_file(entry.path());
        }
    }

    /// Finds the parts that are there and whole.
    pub(super) fn find(&mut self) {
        let entries = fs::read_dir(&self.dir).into_iter().flatten().flatten();
        for entry in entries {
            let name = entry.file_name().to_string_lossy().into_owned();
            let number = name.strip_prefix(PART).and_then(|own| own.parse().ok());
            let is_part = |index: &u32| self.name(*index) == name && self.own.contains(index);
            let Some(index) = number.filter(is_part) else {
                continue;
            };
            match self.verified(index) {
                Ok((header, _)) => {
                    self.held.insert(index, header);
                }
                Err(reason) => self.notes.push(format!(
                    "{name} is left out ({reason}); its episodes have to be simulated again"
                )),
            }
        }
    }

    /// Refuses to go on where other engines simulated what is there.
    ///
    /// # Errors
    /// If there are some that nobody said may stand beside this one.
    fn may_go_on(&self, engine: &Engine, resume: Resume) -> Result<(), OutputError> {
        let own = (program(), engine.class());
        let mut simulated = self.simulated_by().into_iter();
        match simulated.find(|other| *other != own) {
            Some((program, engine)) if !resume.allow_mixed => Err(OutputError::Unfinished {
                path: self.out.clone(),
                what: format!(
                    "episodes that {program} simulated on {engine}, not {} on {}",
                    own.0, own.1
                ),
                remedy: "simulate the rest so, let both stand in one run with --allow-mixed, or begin anew with --restart",
            }),
            _ => Ok(()),
        }
    }

    /// What simulated the parts that are kept: programs and engines.
    pub(crate) fn simulated_by(&self) -> BTreeSet<(String, String)> {
        let of_part = |part: &Header| {
            let engines: Vec<String> = part.segments.iter().map(|own| own.engine.class()).collect();
            let programs = part.programs.iter();
            let pairs = programs.flat_map(|program| {
                let engines = engines.iter().cloned();
                engines
                    .map(|engine| (program.clone(), engine))
                    .collect::<Vec<_>>()
            });
            pairs.collect::<Vec<_>>()
        };
        self.held.values().flat_map(of_part).collect()
    }

    /// Where the files are written.
    fn folder(&self) -> OutputDir {
        OutputDir::existing(&self.dir)
    }

    fn unwritable(&self, source: Error) -> OutputError {
        let path = self.dir.clone();
        OutputError::Unwritable { path, source }
    }

    pub(super) fn name(&self, index: u32) -> String {
        format!("{PART}{index:08}")
    }

    /// The run's directory.
    pub(crate) fn out(&self) -> &Path {
        &self.out
    }

    /// Episodes of a part.
    pub(crate) fn size(&self) -> u32 {
        self.plan.part
    }

    /// The plan that they are parts of.
    pub(crate) fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Parts of the run.
    pub(crate) fn count(&self) -> u32 {
        self.plan.episodes.div_ceil(self.plan.part)
    }

    /// Episodes of a part, when it is whole.
    pub(crate) fn episodes_of(&self, index: u32) -> u32 {
        let first = index.saturating_mul(self.plan.part);
        self.plan.part.min(self.plan.episodes.saturating_sub(first))
    }

    /// Episodes that are kept.
    pub(crate) fn kept(&self) -> u32 {
        self.held.keys().map(|index| self.kept_of(*index)).sum()
    }

    /// Episodes that are to be flown by this process.
    pub(crate) fn asked(&self) -> u32 {
        self.own.clone().map(|index| self.episodes_of(index)).sum()
    }

    /// How long the episodes that are kept took, s.
    pub(crate) fn loop_s(&self) -> f64 {
        self.held.values().map(|part| part.loop_s).sum()
    }

    /// Bytes of all parts, when they are whole.
    pub(crate) fn bytes(&self) -> u64 {
        u64::from(self.plan.episodes) * self.record.bytes() as u64
    }

    /// The episodes that are not kept yet, in ascending order.
    pub(crate) fn missing(&self) -> Vec<Range<u32>> {
        let mut missing: Vec<Range<u32>> = Vec::new();
        for index in self.own.clone() {
            let whole = self.episodes_of(index);
            let kept = self.held.get(&index).map_or(0, Header::episodes);
            let first = index * self.size();
            let own = first + kept.min(whole)..first + whole;
            match missing.last_mut().filter(|last| last.end == own.start) {
                _ if own.is_empty() => {}
                Some(last) => last.end = own.end,
                None => missing.push(own),
            }
        }
        missing
    }

    /// The header of a part of which nothing is there.
    pub(super) fn header(&self) -> Header {
        Header {
            plan: self.id.clone(),
            segments: Vec::new(),
            programs: Vec::new(),
            loop_s: 0.0,
            ended_unix_s: 0,
            bytes: 0,
        }
    }

    /// Keeps a part, unless it holds no more than what is there.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn write(
        &mut self,
        index: u32,
        mut header: Header,
        episodes: &[u8],
    ) -> Result<(), OutputError> {
        let there = self.held.get(&index).map_or(0, Header::episodes);
        if header.episodes() <= there {
            return Ok(());
        }
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        header.ended_unix_s = now.map_or(0, |now| now.as_secs());
        header.bytes = episodes.len() as u64;
        let encoded = file::encoded(&header, episodes).map_err(Error::other);
        let encoded = encoded.map_err(|error| self.unwritable(error))?;
        self.folder().write(&self.name(index), &encoded)?;
        sync_names(&self.dir).map_err(|error| self.unwritable(error))?;
        self.held.insert(index, header);
        Ok(())
    }

    /// A part with its bytes; none if nothing of it is kept.
    ///
    /// # Errors
    /// If it is not what was written.
    pub(crate) fn read(&self, index: u32) -> Result<Option<(Header, Vec<u8>)>, OutputError> {
        if !self.held.contains_key(&index) {
            return Ok(None);
        }
        match self.verified(index) {
            Ok(part) => Ok(Some(part)),
            Err(reason) => Err(OutputError::DamagedPart {
                path: self.dir.join(self.name(index)),
                reason,
            }),
        }
    }

    /// A part that is of this plan, to the last byte.
    fn verified(&self, index: u32) -> Result<(Header, Vec<u8>), String> {
        let path = self.dir.join(self.name(index));
        if fs::symlink_metadata(&path).is_ok_and(|there| !there.is_file()) {
            return Err("it is no file".to_string());
        }
        let (header, mut bytes) = file::read(&path)?;
        let header = self.expected(index, header)?;
        // Of a longer run of which this one is the beginning, it holds more.
        bytes.truncate(header.episodes() as usize * self.record.bytes());
        Ok((header, bytes))
    }

    /// What a part holds of this plan, if it is what is expected of it.
    pub(super) fn expected(&self, index: u32, mut header: Header) -> Result<Header, String> {
        if header.plan != self.id {
            return Err("it is of another run".to_string());
        }
        let first = header.segments.first().map(|own| own.first);
        let bytes = u64::from(header.episodes()) * self.record.bytes() as u64;
        if first != Some(index * self.size()) || bytes != header.bytes {
            return Err("it does not hold what it says".to_string());
        }
        let mut left = self.episodes_of(index);
        for segment in &mut header.segments {
            segment.episodes = segment.episodes.min(left);
            left -= segment.episodes;
        }
        header.segments.retain(|segment| segment.episodes > 0);
        Ok(header)
    }

    /// How the episodes of a part ended.
    pub(crate) fn episodes(&self, bytes: &[u8]) -> Vec<Outcomes> {
        let records = bytes.chunks_exact(self.record.bytes().max(1));
        records.map(|bytes| self.record.read(bytes)).collect()
    }

    /// Takes all away.
    ///
    /// # Errors
    /// If they cannot be removed.
    pub(crate) fn remove(&mut self) -> Result<(), OutputError> {
        self.held.clear();
        let gone = match fs::remove_dir_all(&self.dir) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        };
        gone.map_err(|error| self.unwritable(error))
    }

    /// Takes the folder away if it holds no part: a process that flew nothing leaves nothing.
    pub(crate) fn leave(&mut self) {
        // What other shards have flown is theirs.
        if self.held.is_empty() && !self.is_shard() {
            // What is left is written over by the next.
            let _ = self.remove();
        }
    }
}
