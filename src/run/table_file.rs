//! The file of a table, written piece by piece.

use super::error::OutputError;
use super::labels::Labels;
use super::sink::{Sink, part_in};
use polars::io::parquet::write::BatchedWriter as ParquetBatches;
use polars::prelude::{
    CsvWriter, DataFrame, KeyValueMetadata, ParquetCompression, ParquetWriter, PolarsError,
    SerWriter,
};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use tempfile::TempPath;

/// Rows per group of a Parquet file: fixed, so that the bytes do not depend on how the rows came about.
pub(super) const ROW_GROUP: usize = 1 << 17;

/// A table's file, which gets its name when it is whole.
pub(super) struct TableFile {
    part: TempPath,
    whole: PathBuf,
    /// What errors call it.
    shown: PathBuf,
    sink: Shared,
    encoder: Encoder,
}

enum Encoder {
    Parquet(Box<ParquetBatches<Shared>>),
    /// Whether the head has been written.
    Csv(bool),
}

/// A file that its encoder and its owner hold.
#[derive(Clone)]
struct Shared(Arc<Mutex<Sink>>);

impl TableFile {
    /// Begins a table as Parquet, with labels in its metadata, in a directory that errors call by another name;
    /// `first` are rows of it.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn parquet(
        dirs: [&Path; 2],
        name: &str,
        first: &DataFrame,
        labels: &Labels,
    ) -> Result<Self, OutputError> {
        let begun = Self::begun(dirs, name, Encoder::Csv(false))?;
        let writer = ParquetWriter::new(begun.sink.clone())
            .with_compression(ParquetCompression::Snappy)
            .with_key_value_metadata(Some(KeyValueMetadata::from_static(labels.of(first))));
        match writer.batched(first.schema()) {
            Ok(writer) => Ok(Self {
                encoder: Encoder::Parquet(Box::new(writer)),
                ..begun
            }),
            Err(error) => Err(begun.failed(error)),
        }
    }

    /// The same as CSV.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn csv(dirs: [&Path; 2], name: &str) -> Result<Self, OutputError> {
        Self::begun(dirs, name, Encoder::Csv(false))
    }

    fn begun([dir, shown]: [&Path; 2], name: &str, encoder: Encoder) -> Result<Self, OutputError> {
        let shown = shown.join(name);
        match part_in(dir) {
            Ok(part) => {
                let (file, part) = part.into_parts();
                let sink = Shared(Arc::new(Mutex::new(Sink::new(file))));
                Ok(Self {
                    part,
                    whole: dir.join(name),
                    shown,
                    sink,
                    encoder,
                })
            }
            Err(source) => Err(OutputError::Unwritable {
                path: shown,
                source,
            }),
        }
    }

    /// Adds rows.
    ///
    /// # Errors
    /// If they cannot be encoded or written.
    pub(super) fn write(&mut self, rows: &DataFrame) -> Result<(), OutputError> {
        let written = match &mut self.encoder {
            Encoder::Csv(has_head) => {
                let head = !std::mem::replace(has_head, true);
                let mut rows = rows.clone();
                let writer = CsvWriter::new(self.sink.clone());
                writer.include_header(head).finish(&mut rows)
            }
            Encoder::Parquet(writer) => {
                let groups = (0..rows.height()).step_by(ROW_GROUP);
                let mut groups = groups.filter_map(|first| {
                    let first = i64::try_from(first).ok()?;
                    Some(rows.slice(first, ROW_GROUP))
                });
                groups.try_for_each(|group| writer.write_batch(&group))
            }
        };
        written.map_err(|error| self.failed(error))
    }

    /// Ends the file and gives it its name.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn finish(self) -> Result<(), OutputError> {
        if let Encoder::Parquet(writer) = &self.encoder
            && let Err(error) = writer.finish()
        {
            return Err(self.failed(error));
        }
        let Self {
            part,
            whole,
            shown,
            sink,
            encoder,
        } = self;
        drop(encoder);
        let ended = sink.with(Sink::finish);
        let ended = ended.and_then(|()| part.persist(whole).map_err(|error| error.error));
        ended.map_err(|source| OutputError::Unwritable {
            path: shown,
            source,
        })
    }

    /// Why rows were not written: encoders call a full disk a malformed table.
    fn failed(&self, error: PolarsError) -> OutputError {
        let path = self.shown.clone();
        match self.sink.with(|sink| sink.broken()) {
            Some(source) => OutputError::Unwritable { path, source },
            None => OutputError::Table {
                path,
                source: error,
            },
        }
    }
}

impl Shared {
    fn with<T>(&self, of: impl FnOnce(&mut Sink) -> T) -> T {
        // Whoever panicked while writing has left a file that gets no name.
        of(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.with(|sink| sink.write(bytes))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.with(Write::flush)
    }
}
