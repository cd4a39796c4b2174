//! Writing files whole or not at all: a reader never meets half a file, and a full disk costs no old result.
//!
//! A file is written under another name, `.NAME.PROCESS-COUNT-MACHINE.tmp`, in the folder where it is to be, and renamed when it is
//! complete. Files that belong together are a [`Batch`]: all are written before the first is renamed, so that whatever may
//! fail or take time is over by then. A process that is killed between two of the renames leaves some files of each run, each
//! of them whole; the list of checksums that comes last ([`Batch::finish_listed`]) then does not fit them. What a killed process
//! leaves under other names is ignored, and removed by a later run that writes the same names.

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use coapt::scene::Fault;
use sha2::{Digest, Sha256};

mod owner;

/// The list of a run's files with the checksum of each, in the folder of its results: files that do not fit it are of another
/// run, or were changed since. `sha256sum --check SHA256SUMS` tells, and other systems have the like.
pub const LIST: &str = "SHA256SUMS";

/// Files under other names that are older belong to processes that are gone: none takes so long to write a file. Younger
/// ones go where the process is known to be gone: that cannot be asked of another machine that shares the folder.
const STALE: Duration = Duration::from_secs(60 * 60);

/// Files that appear together. Dropped unfinished, it leaves no trace.
#[derive(Debug, Default)]
pub struct Batch {
    /// What is complete, and where it belongs.
    staged: Vec<[PathBuf; 2]>,
    /// Checksums of what is staged, shape `[staged]`.
    checksums: Vec<String>,
    unwanted: Vec<PathBuf>,
}

impl Batch {
    /// Writes a file in full, for the time being beside its place.
    ///
    /// # Errors
    /// What the file system says, with the path that it speaks of; also where something else than a file has the place.
    pub fn write(&mut self, path: &Path, bytes: &[u8]) -> std::result::Result<(), Fault> {
        self.stage(path, bytes).map_err(|error| file_fault(path, &error))
    }

    fn stage(&mut self, path: &Path, bytes: &[u8]) -> Result<()> {
        // A rename would put a file in the place of a device or a pipe.
        if std::fs::metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
            return Err(Error::new(ErrorKind::AlreadyExists, "is not a regular file"));
        }
        let (temporary, mut file) = create_beside(path)?;
        self.staged.push([temporary, path.to_owned()]);
        self.checksums.push(checksum(bytes));
        file.write_all(bytes)?;
        file.sync_all()
    }

    /// Removes an old file once the new ones are in their places, and its folder if nothing else is left there; that there is none is
    /// no fault.
    pub fn remove(&mut self, path: PathBuf) {
        self.unwanted.push(path);
    }

    /// Puts all files in their places, where they replace old ones.
    ///
    /// # Errors
    /// What the file system says, with the path that it speaks of. Files before it in the batch are then in their places.
    pub fn finish(self) -> std::result::Result<(), Fault> {
        self.put_in_place(None)
    }

    /// The same, and last of all, once old files are removed too, a [`LIST`] of the batch's files in their common folder. Until
    /// then the old list, which fits the old files alone, has its place. The same files give the same list.
    ///
    /// # Errors
    /// As [`Self::finish`].
    pub fn finish_listed(mut self, folder: &Path) -> std::result::Result<(), Fault> {
        let names = self.staged.iter().map(|[_, path]| {
            let below = path.strip_prefix(folder).unwrap_or(path).components();
            let steps: Vec<_> = below.map(|step| step.as_os_str().to_string_lossy()).collect();
            steps.join("/")
        });
        let mut lines: Vec<[String; 2]> = names
            .zip(self.checksums.iter().cloned())
            .map(Into::into)
            .collect();
        lines.sort_unstable();
        // Two spaces: as the tools that check it write.
        let lines = lines
            .iter()
            .map(|[name, checksum]| format!("{checksum}  {name}\n"));
        let list = folder.join(LIST);
        self.write(&list, lines.collect::<String>().as_bytes())?;
        self.put_in_place(Some(&list))
    }

    fn put_in_place(mut self, last: Option<&Path>) -> std::result::Result<(), Fault> {
        let mut register = register();
        register.finished.clear();
        let mut put = |[temporary, path]: &[PathBuf; 2]| {
            std::fs::rename(temporary, path).map_err(|error| file_fault(path, &error))?;
            register.unfinished.remove(temporary);
            register.finished.push(path.clone());
            Ok(())
        };
        let is_last = |file: &&[PathBuf; 2]| Some(file[1].as_path()) == last;
        self.staged
            .iter()
            .filter(|file| !is_last(file))
            .try_for_each(&mut put)?;
        for path in &self.unwanted {
            match std::fs::remove_file(path) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(file_fault(path, &error)),
                // One that is not empty stays, and so says the file system.
                Ok(()) => _ = path.parent().map(std::fs::remove_dir),
                Err(_) => {}
            }
        }
        self.staged.iter().filter(is_last).try_for_each(put)?;
        self.staged.clear();
        remove_stale(&register.finished);
        Ok(())
    }
}

impl Drop for Batch {
    fn drop(&mut self) {
        for [temporary, _] in &self.staged {
            // Gone where it is in its place already; another error has been told.
            let _ = std::fs::remove_file(temporary);
            register().unfinished.remove(temporary);
        }
    }
}

/// What this process is writing.
#[derive(Debug, Default)]
struct Register {
    unfinished: BTreeSet<PathBuf>,
    /// Files of the batch that was finished last.
    finished: Vec<PathBuf>,
    /// Folders that this process made, inner ones last.
    made: Vec<PathBuf>,
}

static REGISTER: Mutex<Register> = Mutex::new(Register {
    unfinished: BTreeSet::new(),
    finished: Vec::new(),
    made: Vec::new(),
});

fn register() -> MutexGuard<'static, Register> {
    // Paths are whole whatever a thread that panicked was doing.
    REGISTER.lock().unwrap_or_else(PoisonError::into_inner)
}

/// No file of this process is begun or renamed while this lives.
#[derive(Debug)]
pub struct Halted(MutexGuard<'static, Register>);

impl Halted {
    /// The files of the batch that was finished last; none before the first.
    pub fn finished(&self) -> &[PathBuf] {
        &self.0.finished
    }
}

/// Stops all writing in this process and removes what is not finished; for who is about to end the process. Batches that
/// are being put in their places come to their end before.
pub fn halt() -> Halted {
    let mut register = register();
    for temporary in std::mem::take(&mut register.unfinished) {
        let _ = std::fs::remove_file(temporary);
    }
    remove_empty(&mut register);
    Halted(register)
}

/// Removes folders that [`make_folder`] made in this process and that are empty; for who has failed to fill them.
pub fn remove_empty_folders() {
    remove_empty(&mut register());
}

fn remove_empty(register: &mut Register) {
    for folder in register.made.drain(..).rev() {
        // One with something in it stays, whoever put it there.
        let _ = std::fs::remove_dir(folder);
    }
}

/// Writes `bytes` to a new file beside `path`, then renames it to `path`, which replaces an old file there.
///
/// # Errors
/// What the file system says; the old file is then untouched and the new one removed.
pub fn write_text_atomically(path: &Path, bytes: &[u8]) -> std::result::Result<(), Fault> {
    let mut batch = Batch::default();
    batch.write(path, bytes)?;
    batch.finish()
}

/// Files that the [`LIST`] of a folder has otherwise: those of another run, or changed since. None where there is no list.
pub fn files_of_other_runs(folder: &Path) -> Vec<String> {
    let list = std::fs::read_to_string(folder.join(LIST)).unwrap_or_default();
    let lines = list.lines().filter_map(|line| line.split_once("  "));
    let is_other = |(sum, name): &(&str, &str)| {
        let bytes = std::fs::read(folder.join(name));
        bytes.map_or(true, |bytes| checksum(&bytes) != *sum)
    };
    lines.filter(is_other).map(|(_, name)| name.to_owned()).collect()
}

/// Whether the [`LIST`] of a folder lacks a file: who wrote the list did not write that file. Without a list nothing is known.
pub fn is_unlisted(folder: &Path, file: &str) -> bool {
    let list = std::fs::read_to_string(folder.join(LIST));
    list.is_ok_and(|list| {
        !list
            .lines()
            .any(|line| line.split_once("  ").is_some_and(|(_, name)| name == file))
    })
}

/// As 64 hexadecimal digits.
fn checksum(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// Writes texts as files of a folder, which is made if need be, in one [`Batch`] with its list.
///
/// # Errors
/// What the file system says, with the path that it speaks of.
pub fn write_files(folder: &Path, files: &[(&str, String)]) -> std::result::Result<(), Fault> {
    make_folder(folder)?;
    let mut batch = Batch::default();
    for (name, text) in files {
        batch.write(&folder.join(name), text.as_bytes())?;
    }
    batch.finish_listed(folder)
}

/// Makes a folder and those above it, if need be.
///
/// # Errors
/// What the file system says.
pub fn make_folder(folder: &Path) -> std::result::Result<(), Fault> {
    if folder.exists() && !folder.is_dir() {
        return Err(file_fault(folder, &"is a file; expected a folder to write to"));
    }
    if folder.is_symlink() && !folder.exists() {
        return Err(file_fault(
            folder,
            &"is a link that leads nowhere; expected a folder to write to",
        ));
    }
    // Held from before the folder exists: who halts must know of it.
    let mut register = register();
    let all = folder.ancestors().filter(|above| !above.as_os_str().is_empty());
    let mut absent: Vec<PathBuf> = all
        .take_while(|above| !above.exists())
        .map(Path::to_owned)
        .collect();
    absent.reverse();
    register.made.extend(absent);
    std::fs::create_dir_all(folder).map_err(|error| file_fault(folder, &error))
}

/// What the file system says of a path.
pub fn file_fault(path: &Path, error: &dyn std::fmt::Display) -> Fault {
    Fault::error(path.display().to_string(), error.to_string())
}

/// A new file in the folder of `path`: a rename is atomic only within one file system.
fn create_beside(path: &Path) -> Result<(PathBuf, File)> {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let name = path
        .file_name()
        .ok_or_else(|| Error::new(ErrorKind::InvalidInput, "not a file name"))?;
    // Held from before the file exists: who halts must know of it.
    let mut register = register();
    loop {
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        // Process and count keep two writers of one name apart.
        let count = COUNTER.fetch_add(1, Ordering::Relaxed);
        let machine = owner::machine().map_or(String::new(), |machine| format!("-{machine}"));
        hidden.push(format!(".{}-{count}{machine}.tmp", std::process::id()));
        let temporary = path.with_file_name(hidden);
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Ok(file) => {
                register.unfinished.insert(temporary.clone());
                return Ok((temporary, file));
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// Removes what killed processes left of earlier files of these names. That it cannot be removed is nobody's concern.
fn remove_stale(paths: &[PathBuf]) {
    let folders: BTreeSet<&Path> = paths.iter().filter_map(|path| path.parent()).collect();
    for folder in folders {
        let names = || paths.iter().filter(|path| path.parent() == Some(folder));
        // A bare file name has an empty parent.
        let listed = if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        };
        for entry in std::fs::read_dir(listed).into_iter().flatten().flatten() {
            let name = entry.file_name();
            let Some(owner) = names().find_map(|path| owner::of_temporary(&name, path)) else {
                continue;
            };
            let Ok(metadata) = entry.metadata() else { continue };
            let age = metadata.modified().ok().and_then(|time| time.elapsed().ok());
            if age.is_some_and(|age| age > STALE) || owner.is_gone(&metadata) {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}

#[cfg(test)]
mod tests;
