//! Who writes into a directory: one run at a time.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::thread;
use std::time::Duration;

/// The file that says who holds a directory. The system frees its lock when the holder ends, however that ends, so one
/// that is left behind is taken over.
pub(super) const LOCK: &str = ".urts-mc-lock";

/// How often a lock is tried that somebody holds, and how long after each.
const TRIES: u32 = 5;
const MOMENT: Duration = Duration::from_millis(20);

/// Bytes that a lock says at most.
const LONGEST: usize = 400;

/// Who else may hold a directory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sharing {
    /// Nobody.
    Alone,
    /// Others that share it, too.
    Shared,
}

/// A directory that nobody else writes while this is there, but those that share it.
#[derive(Debug)]
pub(super) struct Lock {
    file: File,
    path: PathBuf,
    sharing: Sharing,
    /// Directories that were made for it, the innermost first.
    made: Vec<PathBuf>,
    /// Whether the file system keeps locks.
    excludes: bool,
}

/// Why a directory is not held.
pub(super) enum NotHeld {
    /// By whom it is.
    Taken(String),
    /// What went wrong.
    Failed(std::io::Error),
}

impl Lock {
    /// Takes a directory by a lock of this name, which both are made if they are not there.
    pub(super) fn take(dir: &Path, name: &str, sharing: Sharing) -> Result<Self, NotHeld> {
        let absent = dir.ancestors();
        let absent = absent.take_while(|dir| !dir.as_os_str().is_empty() && !dir.exists());
        let made: Vec<PathBuf> = absent.map(Path::to_path_buf).collect();
        let created = fs::create_dir_all(dir).inspect_err(|_| undo(&made));
        created.map_err(NotHeld::Failed)?;
        let path = dir.join(name);
        let mut tries = 0;
        let taken = loop {
            let file = match open(&path) {
                Ok(file) => file,
                Err(error) => break Err(NotHeld::Failed(error)),
            };
            let tried = match sharing {
                Sharing::Alone => file.try_lock(),
                Sharing::Shared => file.try_lock_shared(),
            };
            match tried {
                // Whoever held it may have taken its file away after it was opened here.
                Ok(()) if is_at(&file, &path) => break Ok((file, true)),
                Ok(()) => {}
                // Whoever looks who holds it, holds it for a moment.
                Err(TryLockError::WouldBlock) if tries < TRIES => {
                    tries += 1;
                    thread::sleep(MOMENT);
                }
                Err(TryLockError::WouldBlock) => break Err(NotHeld::Taken(holder(file))),
                // A file system without locks has none to keep.
                Err(TryLockError::Error(_)) => break Ok((file, false)),
            }
        };
        let (mut file, excludes) = taken.inspect_err(|_| undo(&made))?;
        // Of use to people alone.
        let said = format!("{} on {}\n", process::id(), host());
        let _ = file
            .set_len(0)
            .and_then(|()| file.write_all(said.as_bytes()));
        Ok(Self {
            file,
            path,
            sharing,
            made,
            excludes,
        })
    }

    /// Who holds a directory by a lock of this name; nobody where the system keeps no locks.
    pub(super) fn holder_of(dir: &Path, name: &str) -> Option<String> {
        let file = File::open(dir.join(name)).ok()?;
        match file.try_lock_shared() {
            Err(TryLockError::WouldBlock) => Some(holder(file)),
            _ => None,
        }
    }

    /// Whether nobody else can hold the directory; where a file system keeps no locks, somebody may.
    pub(super) fn excludes(&self) -> bool {
        self.excludes
    }
}

/// Opens the lock of a directory, if what has its name is one.
fn open(path: &Path) -> std::io::Result<File> {
    let other = || std::io::Error::other(format!("{} is no lock", path.display()));
    if fs::symlink_metadata(path).is_ok_and(|there| !there.is_file()) {
        return Err(other());
    }
    let mut options = OpenOptions::new();
    let options = options.read(true).write(true).create(true).truncate(false);
    let mut file = options.open(path)?;
    let mut said = String::new();
    // What cannot be read is locked by somebody, on some systems.
    let is_lock = match file.read_to_string(&mut said) {
        Ok(_) => said.is_empty() || said.contains(" on "),
        Err(error) => error.kind() != std::io::ErrorKind::InvalidData,
    };
    match is_lock && said.len() <= LONGEST {
        true => file.rewind().map(|()| file),
        false => Err(other()),
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // What cannot be taken away is taken over by the next run. What others hold too is left to the last of them.
        let is_last = self.sharing == Sharing::Alone || self.file.try_lock().is_ok();
        if is_last {
            let _ = fs::remove_file(&self.path);
        }
        let _ = self.file.unlock();
        undo(&self.made);
    }
}

/// Takes away directories in which nothing was written.
fn undo(made: &[PathBuf]) {
    for dir in made {
        // One that holds something stays.
        let _ = fs::remove_dir(dir);
    }
}

/// Whether an open file is still the one of its path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    let (own, there) = (
        file.metadata().map(identity),
        fs::metadata(path).map(identity),
    );
    matches!((own, there), (Ok(own), Ok(there)) if own == there)
}

/// Where an open file cannot be removed, it is.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}

/// Who wrote itself into a lock.
fn holder(mut file: File) -> String {
    let mut said = String::new();
    let read = file.rewind().and_then(|()| file.read_to_string(&mut said));
    match (read, said.trim()) {
        (Ok(_), said) if !said.is_empty() => format!("process {said}"),
        _ => "another process".to_string(),
    }
}

/// The name of this machine.
fn host() -> String {
    let named = fs::read_to_string("/proc/sys/kernel/hostname");
    let named = named.ok().or_else(|| std::env::var("HOSTNAME").ok());
    let named = named.or_else(|| std::env::var("COMPUTERNAME").ok());
    named.map_or("this machine".to_string(), |name| name.trim().to_string())
}
