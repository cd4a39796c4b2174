//! Writing a file whole or not at all: a reader never meets half a file, and a full disk costs no old result.

use std::fs::{File, OpenOptions};
use std::io::{Error, ErrorKind, Result, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use coapt::scene::Fault;

/// Writes `bytes` to a new file beside `path`, then renames it to `path`, which replaces an old file there.
///
/// # Errors
/// Whatever the file system says; the old file is then untouched and the new one removed.
pub fn write_text_atomically(path: &Path, bytes: &[u8]) -> Result<()> {
    let (temporary, mut file) = create_beside(path)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    drop(file);
    let renamed = written.and_then(|()| std::fs::rename(&temporary, path));
    if renamed.is_err() {
        // The first error is the one worth telling.
        let _ = std::fs::remove_file(&temporary);
    }
    renamed
}

/// Writes texts as files of a folder, which is made if need be; each as [`write_text_atomically`] does.
///
/// # Errors
/// What the file system says, with the path that it speaks of.
pub fn write_files(folder: &Path, files: &[(&str, String)]) -> std::result::Result<(), Fault> {
    std::fs::create_dir_all(folder).map_err(|error| file_fault(folder, &error))?;
    for (name, text) in files {
        let path = folder.join(name);
        write_text_atomically(&path, text.as_bytes()).map_err(|error| file_fault(&path, &error))?;
    }
    Ok(())
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
    loop {
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        // Process and count keep two writers of one name apart.
        hidden.push(format!(
            ".{}-{}.tmp",
            std::process::id(),
            COUNTER.fetch_add(1, Ordering::Relaxed)
        ));
        let temporary = path.with_file_name(hidden);
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Ok(file) => return Ok((temporary, file)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_the_old_file_and_leaves_nothing_beside_it() {
        let folder = std::env::temp_dir().join(format!("coapt-atomic-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("result.txt");
        write_text_atomically(&path, b"old, and longer").unwrap();
        write_text_atomically(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_target_that_cannot_be_replaced_stays_and_no_temporary_is_left() {
        let folder = std::env::temp_dir().join(format!("coapt-atomic-folder-{}", std::process::id()));
        let target = folder.join("a folder");
        std::fs::create_dir_all(target.join("with content")).unwrap();
        assert!(write_text_atomically(&target, b"new").is_err());
        assert!(target.join("with content").is_dir());
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        assert!(write_text_atomically(Path::new("/"), b"new").is_err());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
