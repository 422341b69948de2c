//! Parts of several directories, and of one that others are writing.

use super::file::{self, Header};
use super::folder::{Found, Resume, judged};
use super::plan::Plan;
use super::store::Parts;
use crate::campaign::Campaign;
use crate::run::directory::OutputDir;
use crate::run::error::OutputError;
use std::fs;
use std::path::{Path, PathBuf};

impl Parts {
    /// The parts that are in some directories, in one of their own or in one of them.
    ///
    /// # Errors
    /// If they contradict each other, or cannot be written there.
    pub(crate) fn gathered(
        dirs: &[PathBuf],
        out: &OutputDir,
        campaign: &Campaign,
        plan: Plan,
    ) -> Result<Self, OutputError> {
        let found = judged(out.path(), campaign, &plan, Resume::default())?;
        let mut all = Self::none(out.path(), campaign, plan);
        if matches!(found, Found::Ours) {
            all.find();
        }
        let place = |dir: &Path| dir.canonicalize().ok();
        for dir in dirs.iter().filter(|dir| place(dir) != place(out.path())) {
            let mut others = Self::none(dir, campaign, all.plan.clone());
            others.find();
            if !all.gains().exists() {
                let path = others.gains();
                let gains = fs::read(&path);
                let gains = gains.map_err(|source| OutputError::Unwritable { path, source })?;
                all.begin(&gains)?;
            }
            for index in others.held.keys() {
                if let Some((header, bytes)) = others.read(*index)? {
                    all.take_in(dir, *index, header, &bytes)?;
                }
            }
            all.notes.append(&mut others.notes);
        }
        Ok(all)
    }

    /// Takes in a part of another directory.
    fn take_in(
        &mut self,
        from: &Path,
        index: u32,
        header: Header,
        bytes: &[u8],
    ) -> Result<(), OutputError> {
        if let Some((_, own)) = self.read(index)? {
            let common = own.len().min(bytes.len());
            if own[..common] != bytes[..common] {
                return Err(OutputError::Contradiction {
                    path: self.dir.join(self.name(index)),
                    other: from.to_path_buf(),
                });
            }
        }
        self.write(index, header, bytes)
    }

    /// The parts of a directory, whoever flies them, by what they say of themselves.
    pub(crate) fn seen(out: &Path, campaign: &Campaign, plan: Plan) -> Self {
        let mut parts = Self::none(out, campaign, plan);
        for index in 0..parts.count() {
            let said = file::header(&parts.dir.join(parts.name(index)));
            if let Ok(header) = said.and_then(|own| parts.expected(index, own)) {
                parts.held.insert(index, header);
            }
        }
        parts
    }
}
