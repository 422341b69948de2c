//! The file of `--junit`.

use super::arguments::RunArguments;
use super::exit::Failure;
use std::fs;
use std::path::Path;
use urts_mc::report::junit::{junit, junit_of_error};
use urts_mc::run::directory::{OutputFile, is_of_run};
use urts_mc::run::error::OutputError;
use urts_mc::run::manifest::Manifest;

/// The file of `--junit`.
pub(super) struct JunitFile(OutputFile);

impl JunitFile {
    /// Writes what became of a run.
    pub(super) fn write(&self, manifest: &Manifest, out: &Path) -> Result<(), Failure> {
        self.write_text(&junit(manifest, out)?)
    }

    /// Writes that a campaign came to nothing, unless the file's directory is not there: a run that wrote nothing makes
    /// none.
    pub(super) fn write_error(&self, campaign: &str, failure: &Failure) -> Result<(), Failure> {
        if !self.0.has_place() {
            return Ok(());
        }
        self.write_text(&junit_of_error(campaign, failure.message.clone())?)
    }

    fn write_text(&self, text: &str) -> Result<(), Failure> {
        self.0.write(text.as_bytes()).map_err(not_written)
    }
}

/// An error of the file of `--junit`, with the remedy that helps.
fn not_written(error: OutputError) -> Failure {
    match error {
        OutputError::Unwritable { path, source } => Failure::usage(format!(
            "--junit {}: cannot be written ({source}); give another file",
            path.display()
        )),
        other => other.into(),
    }
}

impl RunArguments {
    /// The file of `--junit`, of which nothing is left from an earlier run: one that is killed must not look as if it
    /// had passed. `out` is the run's directory, if it is known.
    pub(super) fn junit_file(&self, out: Option<&Path>) -> Result<Option<JunitFile>, Failure> {
        let Some(path) = &self.junit else {
            return Ok(None);
        };
        let refused = |why: &str| Err(Failure::usage(format!("--junit {}: {why}", path.display())));
        if out.is_some_and(|out| is_of_run(out, path)) {
            return refused("the run writes a file of this name itself; give another file");
        }
        let file = OutputFile::claim(path).map_err(not_written)?;
        let earlier = || fs::read_to_string(path).is_ok_and(|text| text.contains("<testsuites"));
        if path.exists() && !self.overwrite && !earlier() {
            return refused(
                "exists already and is no JUnit file; give another file, or replace it with --overwrite",
            );
        }
        file.remove().map_err(not_written)?;
        Ok(Some(JunitFile(file)))
    }
}
