//! Batches of episodes into parts.

use super::file::Header;
use super::plan::program;
use super::record::Record;
use super::store::Parts;
use crate::campaign::Campaign;
use crate::model::episode::AgentOutcome;
use crate::results::scores::{Status, status};
use crate::run::error::OutputError;
use crate::simulation::Segment;
use crate::simulation::flight::Batch;
use crate::simulation::stopping::StoppingRule;
use std::ops::ControlFlow;

/// Takes in episodes in order, and keeps each part as soon as it is whole.
pub(crate) struct Writer<'a> {
    parts: &'a mut Parts,
    campaign: &'a Campaign,
    program: String,
    open: Option<Open>,
    /// What ends the run early, and the first episode that it has not seen.
    stopping: StoppingRule,
    next: u32,
    failed: Option<OutputError>,
}

/// A part that is being filled.
struct Open {
    index: u32,
    header: Header,
    bytes: Vec<u8>,
}

impl<'a> Writer<'a> {
    /// Goes on with parts.
    ///
    /// # Errors
    /// If one that is there cannot be read.
    pub(crate) fn new(parts: &'a mut Parts, campaign: &'a Campaign) -> Result<Self, OutputError> {
        let mut writer = Self {
            parts,
            campaign,
            program: program(),
            open: None,
            stopping: StoppingRule::new(campaign),
            next: 0,
            failed: None,
        };
        writer.look_on()?;
        Ok(writer)
    }

    /// Whether no more episodes are needed.
    pub(crate) fn is_done(&self) -> bool {
        self.stopping.is_done()
    }

    /// Takes in a batch; ends the flight where nothing can be kept any more, or no more is needed.
    pub(crate) fn take(&mut self, batch: &Batch) -> ControlFlow<()> {
        let kept = self.keep(batch);
        if let Err(error) = kept {
            self.failed = Some(error);
        }
        match self.failed.is_some() || self.stopping.is_done() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    /// Keeps what is left: a part that is not whole holds the first episodes of its range.
    ///
    /// # Errors
    /// What kept a part from being written.
    pub(crate) fn finish(mut self) -> Result<(), OutputError> {
        match self.failed.take() {
            Some(error) => Err(error),
            None => self.close(),
        }
    }

    fn keep(&mut self, batch: &Batch) -> Result<(), OutputError> {
        let size = self.parts.size();
        let mut place = 0;
        while place < batch.len() {
            let first = batch.first + u32::try_from(place).unwrap_or(u32::MAX);
            let index = first / size;
            let count = (size - first % size) as usize;
            let count = count.min(batch.len() - place);
            self.open(index)?;
            let Some(open) = &mut self.open else { break };
            for episode in place..place + count {
                Record::write(&mut open.bytes, &batch.episode(episode));
            }
            let next = Segment {
                first,
                episodes: u32::try_from(count).unwrap_or(u32::MAX),
                engine: batch.engine.clone(),
            };
            Segment::append(&mut open.header.segments, next);
            if !open.header.programs.contains(&self.program) {
                open.header.programs.push(self.program.clone());
            }
            open.header.loop_s += batch.loop_s * count as f64 / batch.len() as f64;
            let is_whole = open.header.episodes() == self.parts.episodes_of(index);
            if is_whole {
                self.close()?;
            }
            place += count;
        }
        self.look_on()?;
        for place in 0..batch.len() {
            let groups = batch.episode(place);
            let outcomes: Vec<_> = groups.iter().map(|group| &group.outcomes[..]).collect();
            self.see(batch.first, place, &outcomes);
        }
        self.look_on()
    }

    /// Makes a part the one that is filled, from what is there of it.
    fn open(&mut self, index: u32) -> Result<(), OutputError> {
        if self.open.as_ref().is_some_and(|open| open.index == index) {
            return Ok(());
        }
        self.close()?;
        let (header, bytes) = match self.parts.read(index)? {
            Some(part) => part,
            None => (self.parts.header(), Vec::new()),
        };
        self.open = Some(Open {
            index,
            header,
            bytes,
        });
        Ok(())
    }

    /// Writes the part that is filled.
    fn close(&mut self) -> Result<(), OutputError> {
        match self.open.take() {
            Some(open) => self.parts.write(open.index, open.header, &open.bytes),
            None => Ok(()),
        }
    }

    /// Shows the stopping rule what was there already, up to the next episode that is not. A shard has not the episodes
    /// before its own, so it flies all of them; where the run ends is found when it is made one.
    fn look_on(&mut self) -> Result<(), OutputError> {
        if self.campaign.stop.is_none() || self.parts.is_shard() {
            return Ok(());
        }
        let size = self.parts.size();
        while let Some((header, bytes)) = self.parts.read(self.next / size)? {
            let first = self.next / size * size;
            let seen = self.next % size;
            if seen >= header.episodes() {
                break;
            }
            let all = self.parts.episodes(&bytes);
            for (place, outcomes) in all.iter().enumerate() {
                let groups: Vec<_> = outcomes.iter().map(|group| &group[..]).collect();
                self.see(first, place, &groups);
            }
        }
        Ok(())
    }

    /// Shows the stopping rule an episode, if it is the next.
    fn see(&mut self, first: u32, place: usize, groups: &[&[Vec<AgentOutcome>]]) {
        let episode = first + u32::try_from(place).unwrap_or(u32::MAX);
        if episode != self.next || self.parts.is_shard() {
            return;
        }
        self.next += 1;
        if !self.stopping.is_done() {
            let campaign = self.campaign;
            self.stopping
                .take(|controller| worst(campaign, groups, controller));
        }
    }
}

/// How an episode ended under a controller, `groups` being `[controller][agent]` of each group of agents.
fn worst(campaign: &Campaign, groups: &[&[Vec<AgentOutcome>]], controller: usize) -> Status {
    let groups = campaign.groups().iter().zip(groups);
    let agents = groups.flat_map(|(group, own)| {
        let agents = own[controller].iter();
        agents.map(move |agent| status(group, agent))
    });
    agents.max().unwrap_or(Status::Ok)
}
