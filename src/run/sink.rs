//! Files on the way to their names.

use super::file_names::ON_THE_WAY;
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::Path;
use tempfile::NamedTempFile;

/// A file whose name nobody can guess, readable as others that the user makes.
pub(super) fn part_in(dir: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(ON_THE_WAY).suffix(".part");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(dir)
}

/// Brings the names in a directory to the disk, where directories can be opened.
pub(super) fn sync_names(dir: &Path) -> std::io::Result<()> {
    use ErrorKind::{InvalidInput, PermissionDenied, Unsupported};
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(dir)?.sync_all() {
        // Some file systems do this for files alone.
        Err(error) if [InvalidInput, PermissionDenied, Unsupported].contains(&error.kind()) => {
            Ok(())
        }
        synced => synced,
    }
}

/// A file that is being written, and what its disk said first when it took no more.
pub(super) struct Sink {
    file: BufWriter<File>,
    broken: Option<std::io::Error>,
}

impl Sink {
    pub(super) fn new(file: File) -> Self {
        let (file, broken) = (BufWriter::new(file), None);
        Self { file, broken }
    }

    /// What the disk said first, once.
    pub(super) fn broken(&mut self) -> Option<std::io::Error> {
        self.broken.take()
    }

    /// Brings all to the disk: a file that has its final name is whole even after a loss of power.
    pub(super) fn finish(&mut self) -> std::io::Result<()> {
        self.flush()?;
        self.file.get_ref().sync_all()
    }

    /// Keeps an error, for the encoder may not.
    fn heard<T>(&mut self, result: std::io::Result<T>) -> std::io::Result<T> {
        if let Err(error) = &result
            && error.kind() != ErrorKind::Interrupted
        {
            let again = error.raw_os_error().map(std::io::Error::from_raw_os_error);
            let again = again.unwrap_or_else(|| error.kind().into());
            self.broken.get_or_insert(again);
        }
        result
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.file.write(bytes);
        self.heard(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        let flushed = self.file.flush();
        self.heard(flushed)
    }
}
