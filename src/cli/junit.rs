//! The file of `--junit`.

use super::exit::Failure;
use std::fs;
use std::path::Path;
use urts_mc::report::junit::{junit, junit_of_comparison, junit_of_error};
use urts_mc::run::compare::RunComparison;
use urts_mc::run::directory::is_of_run;
use urts_mc::run::error::OutputError;
use urts_mc::run::manifest::Manifest;
use urts_mc::run::output_file::OutputFile;

/// The file of `--junit`.
pub(super) struct JunitFile(OutputFile);

impl JunitFile {
    /// Writes what became of a run.
    pub(super) fn write(&self, manifest: &Manifest, out: &Path) -> Result<(), Failure> {
        self.write_text(&junit(manifest, out)?)
    }

    /// Writes what became of a comparison.
    pub(super) fn write_comparison(&self, found: &RunComparison) -> Result<(), Failure> {
        self.write_text(&junit_of_comparison(found)?)
    }

    /// Writes that a command came to nothing, unless the file's directory is not there: a run that wrote nothing makes
    /// none.
    fn write_error(&self, name: &str, failure: &Failure) -> Result<(), Failure> {
        if !self.0.has_place() {
            return Ok(());
        }
        self.write_text(&junit_of_error(name, failure.message.clone())?)
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

impl JunitFile {
    /// The file of `--junit`, of which nothing is left from an earlier time: a command that is killed must not look as
    /// if it had passed. Another file is replaced only with `overwrite`, and none of a run ever: `runs` are the
    /// directories of those that the command reads or writes.
    pub(super) fn claim(
        path: Option<&Path>,
        overwrite: bool,
        runs: &[&Path],
    ) -> Result<Option<Self>, Failure> {
        let Some(path) = path else {
            return Ok(None);
        };
        let refused = |why: &str| Err(Failure::usage(format!("--junit {}: {why}", path.display())));
        if runs.iter().any(|run| is_of_run(run, path)) {
            return refused("the run writes a file of this name itself; give another file");
        }
        let file = OutputFile::claim(path).map_err(not_written)?;
        let earlier = || fs::read_to_string(path).is_ok_and(|text| text.contains("<testsuites"));
        if path.exists() && !overwrite && !earlier() {
            return refused(
                "exists already and is no JUnit file; give another file, or replace it with --overwrite",
            );
        }
        file.remove().map_err(not_written)?;
        Ok(Some(Self(file)))
    }
}

/// A failure of a command, after the JUnit file tells of it; that the file cannot be written is the lesser of two
/// failures.
pub(super) fn reported(report: Option<JunitFile>, name: &str, failure: Failure) -> Failure {
    if let Some(report) = report {
        report.write_error(name, &failure).ok();
    }
    failure
}
