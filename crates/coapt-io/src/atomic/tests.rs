use std::time::SystemTime;

use super::*;

/// A folder that is gone at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("coapt-atomic-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn replaces_the_old_file_and_leaves_nothing_beside_it() {
    let folder = Folder::new("replace");
    let path = folder.path("result.txt");
    write_text_atomically(&path, b"old, and longer").unwrap();
    write_text_atomically(&path, b"new").unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"new");
    assert_eq!(folder.names(), ["result.txt"]);
}

#[test]
fn a_target_that_cannot_be_replaced_stays_and_no_temporary_is_left() {
    let folder = Folder::new("target");
    let target = folder.path("a folder");
    std::fs::create_dir_all(target.join("with content")).unwrap();
    assert!(write_text_atomically(&target, b"new").is_err());
    assert!(target.join("with content").is_dir());
    assert_eq!(folder.names(), ["a folder"]);
    assert!(write_text_atomically(Path::new("/"), b"new").is_err());
}

/// As root, `--out /dev/null` would replace the device for everybody.
#[cfg(unix)]
#[test]
fn a_device_is_not_replaced_by_a_file() {
    let folder = Folder::new("device");
    std::os::unix::fs::symlink("/dev/null", folder.path("null")).unwrap();
    let fault = write_text_atomically(&folder.path("null"), b"new").unwrap_err();
    assert!(fault.message.contains("not a regular file"), "{fault:?}");
    assert_eq!(folder.names(), ["null"]);
}

#[test]
fn nothing_of_a_batch_appears_before_all_of_it_is_written() {
    let folder = Folder::new("batch");
    std::fs::write(folder.path("a"), "old").unwrap();
    std::fs::write(folder.path("stale"), "old").unwrap();
    for below in ["c", "left", "emptied"] {
        std::fs::create_dir(folder.path(below)).unwrap();
    }
    for old in ["left/kept", "left/stale", "emptied/stale"] {
        std::fs::write(folder.path(old), "old").unwrap();
    }
    let mut batch = Batch::default();
    batch.write(&folder.path("a"), b"new").unwrap();
    batch.remove(folder.path("stale"));
    assert!(batch.write(&folder.path("c"), b"new").is_err());
    drop(batch);
    assert_eq!(folder.names(), ["a", "c", "emptied", "left", "stale"]);
    assert_eq!(std::fs::read(folder.path("a")).unwrap(), b"old");
    let mut batch = Batch::default();
    batch.write(&folder.path("a"), b"new").unwrap();
    batch.write(&folder.path("b"), b"new").unwrap();
    batch.remove(folder.path("stale"));
    batch.remove(folder.path("never there"));
    batch.remove(folder.path("left/stale"));
    batch.remove(folder.path("emptied/stale"));
    assert_eq!(std::fs::read(folder.path("a")).unwrap(), b"old");
    batch.finish().unwrap();
    assert_eq!(folder.names(), ["a", "b", "c", "left"]);
    assert_eq!(std::fs::read(folder.path("a")).unwrap(), b"new");
}

/// The list comes last; what fits it is of one run, and what the other run left does not fit it.
#[test]
fn a_list_tells_which_files_are_of_one_run() {
    let folder = Folder::new("list");
    let write = |texts: [&str; 2]| {
        let mut batch = Batch::default();
        for (name, text) in ["a", "below/b"].into_iter().zip(texts) {
            batch.write(&folder.path(name), text.as_bytes()).unwrap();
        }
        batch
    };
    make_folder(&folder.path("below")).unwrap();
    std::fs::write(folder.path("stale"), "old").unwrap();
    let mut first = write(["one", "two"]);
    first.remove(folder.path("stale"));
    first.finish_listed(&folder.0).unwrap();
    assert_eq!(folder.names(), [LIST, "a", "below"]);
    let list = std::fs::read_to_string(folder.path(LIST)).unwrap();
    // As `sha256sum` gives them.
    let expected = [
        "7692c3ad3540bb803c020b3aee66cd8887123234ea0c6e7143c0add73ff431ed",
        "3fc4ccfe745870e2c0d99f71f30ff0656c8dedd41cc1d7d3d376b0dbe685e2f3",
    ];
    assert_eq!(list, format!("{}  a\n{}  below/b\n", expected[0], expected[1]));
    // A folder stands in the way of the second file, so that the second run ends between the two.
    std::fs::remove_file(folder.path("below/b")).unwrap();
    let second = write(["another one", "another two"]);
    std::fs::create_dir_all(folder.path("below/b/full")).unwrap();
    assert!(second.finish_listed(&folder.0).is_err());
    assert_eq!(std::fs::read(folder.path("a")).unwrap(), b"another one");
    assert_eq!(std::fs::read_to_string(folder.path(LIST)).unwrap(), list);
}

/// Files that a killed process left: only those of the same name that are too old to be anybody's go.
#[test]
fn what_a_killed_process_left_goes_with_time() {
    let folder = Folder::new("stale");
    let names = [
        ".a.txt.123-0.tmp",
        ".a.txt.124-7.tmp",
        ".b.txt.123-1.tmp",
        ".a.txt.tmp",
        ".a.txt.x-1.tmp",
    ];
    for name in names {
        std::fs::write(folder.path(name), "half").unwrap();
        let file = OpenOptions::new().write(true).open(folder.path(name)).unwrap();
        let age = if name.contains("124") {
            STALE / 2
        } else {
            STALE * 2
        };
        file.set_modified(SystemTime::now() - age).unwrap();
    }
    write_text_atomically(&folder.path("a.txt"), b"new").unwrap();
    let expected = [
        ".a.txt.124-7.tmp",
        ".a.txt.tmp",
        ".a.txt.x-1.tmp",
        ".b.txt.123-1.tmp",
        "a.txt",
    ];
    assert_eq!(folder.names(), expected);
}

/// At once where its process is known to be gone: it ran on this machine, and is not listed any more.
#[cfg(target_os = "linux")]
#[test]
fn what_a_killed_process_of_this_machine_left_goes_at_once() {
    let folder = Folder::new("gone");
    let mut child = std::process::Command::new("true").spawn().unwrap();
    let gone = child.id();
    child.wait().unwrap();
    let machine = owner::machine().unwrap();
    let living = format!(".a.{}-900-{machine}.tmp", std::process::id());
    let elsewhere = format!(".a.{gone}-0-0123456789abcdef.tmp");
    let unknown = format!(".a.{gone}-1.tmp");
    for name in [
        &living,
        &elsewhere,
        &unknown,
        &format!(".a.{gone}-2-{machine}.tmp"),
    ] {
        std::fs::write(folder.path(name), "half").unwrap();
    }
    write_text_atomically(&folder.path("a"), b"new").unwrap();
    let mut expected = vec![living, elsewhere, unknown, "a".to_owned()];
    expected.sort();
    assert_eq!(folder.names(), expected);
}

/// Two threads write one name again and again: whoever reads meets one of the two texts, whole.
#[test]
fn a_reader_never_meets_half_a_file() {
    let folder = Folder::new("readers");
    let path = folder.path("result");
    let texts = ["a".repeat(100_000), "b".repeat(70_000)];
    write_text_atomically(&path, texts[0].as_bytes()).unwrap();
    std::thread::scope(|scope| {
        let writers = texts.each_ref().map(|text| {
            scope.spawn(|| (0..20).for_each(|_| write_text_atomically(&path, text.as_bytes()).unwrap()))
        });
        while !writers.iter().all(|writer| writer.is_finished()) {
            let read = std::fs::read_to_string(&path).unwrap();
            assert!(texts.contains(&read), "{} bytes", read.len());
        }
    });
    assert_eq!(folder.names(), ["result"]);
}
