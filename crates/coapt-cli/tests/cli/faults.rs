//! Disks that are full, folders that nobody may write to, readers that go away: told, and no old result lost.

use std::fs::File;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::program::{Folder, Snapshot, coapt, snapshot, stderr, temporaries, with_membranes};

/// Every verb that writes files, over results of an earlier run: its name, its arguments, and the folder it writes to.
fn writers(folder: &Folder) -> Vec<(Vec<String>, String)> {
    let valve = with_membranes(&folder.valve(&[]));
    let words = |text: &str, out: &str| -> (Vec<String>, String) {
        let arguments = text.replace("VALVE", &valve).replace("OUT", out);
        (arguments.split(' ').map(str::to_owned).collect(), out.to_owned())
    };
    let [closed, other, exported, compared, studied] =
        ["closed", "other", "exported", "compared", "studied"].map(|name| folder.path(name));
    std::fs::create_dir_all(&exported).unwrap();
    vec![
        words("closure VALVE --ring saddle:30 --out OUT", &closed),
        words("generate dilated --force --set faces=300 --out OUT", &other),
        words("export VALVE --format calculix --out OUT/valve.inp", &exported),
        words(
            &format!("compare {closed}/before {closed}/after --out OUT"),
            &compared,
        ),
        words(
            "study --faces 160 --reference-faces 300 --tolerance 1e-2 --thickness 1 --repeats 1 --out OUT",
            &studied,
        ),
    ]
}

/// Runs all of them once, and then again as `again` does; that must fail, and change nothing.
fn assert_old_results_stay(folder: &Folder, again: impl Fn(&[String], &str) -> Output, reason: &str) {
    for (arguments, out) in writers(folder) {
        let first = coapt(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(
            matches!(first.status.code(), Some(0 | 3)),
            "{arguments:?} {}",
            stderr(&first)
        );
        let before: Snapshot = snapshot(Path::new(&out));
        assert!(!before.is_empty());
        let output = again(&arguments, &out);
        assert_eq!(output.status.code(), Some(1), "{arguments:?} {}", stderr(&output));
        let told = stderr(&output);
        assert!(
            told.contains(reason) && told.contains(&out),
            "{arguments:?} {told}"
        );
        assert!(snapshot(Path::new(&out)) == before, "{arguments:?}");
        assert_eq!(
            temporaries(Path::new(&out)),
            Vec::<String>::new(),
            "{arguments:?}"
        );
    }
}

/// Files may grow to 512 or, as some shells count, 1024 bytes.
#[cfg(unix)]
#[test]
fn a_file_that_may_not_grow_leaves_the_old_results() {
    let folder = Folder::new("size-limit");
    let limited = |arguments: &[String], _: &str| {
        Command::new("sh")
            .args([
                "-c",
                "ulimit -f 1; exec \"$0\" \"$@\"",
                env!("CARGO_BIN_EXE_coapt"),
            ])
            .args(arguments)
            .output()
            .unwrap()
    };
    assert_old_results_stay(&folder, limited, "File too large");
}

/// A folder that was made for results that could not be written is gone again; one that was there stays.
#[cfg(unix)]
#[test]
fn a_run_that_fails_leaves_no_empty_folder() {
    let folder = Folder::new("empty-folder");
    let there = folder.path("there");
    std::fs::create_dir(&there).unwrap();
    for out in [folder.path("a/b"), there.clone()] {
        let output = Command::new("sh")
            .args([
                "-c",
                "ulimit -f 1; exec \"$0\" \"$@\"",
                env!("CARGO_BIN_EXE_coapt"),
            ])
            .args([
                "study",
                "--faces",
                "160",
                "--reference-faces",
                "300",
                "--tolerance",
                "1e-2",
            ])
            .args(["--repeats", "1", "--out", &out])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    }
    assert!(!Path::new(&folder.path("a")).exists());
    assert!(Path::new(&there).is_dir());
}

/// A file system of a few pages, full of earlier results; only root can make one.
#[cfg(target_os = "linux")]
#[test]
#[allow(clippy::print_stderr, reason = "a skipped test must say so")]
fn a_full_disk_leaves_the_old_results() {
    struct Mounted(String);
    impl Drop for Mounted {
        fn drop(&mut self) {
            let _ = Command::new("umount").arg(&self.0).status();
        }
    }
    let folder = Folder::new("full-disk");
    let disk = folder.path("disk");
    std::fs::create_dir_all(&disk).unwrap();
    let mount = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=1m", "tmpfs", &disk])
        .output();
    if !mount.is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: no right to mount a file system");
        return;
    }
    let _mounted = Mounted(disk.clone());
    let valve = folder.valve(&[]);
    let run = || coapt(&["closure", &valve, "--out", &disk]);
    assert!(matches!(run().status.code(), Some(0 | 3)));
    let before = snapshot(Path::new(&disk));
    // All room that is left but for one page.
    let rest = vec![0; 1 << 20];
    let _ = std::fs::write(Path::new(&disk).join("rest"), rest);
    let length = std::fs::metadata(Path::new(&disk).join("rest")).unwrap().len();
    let file = File::options()
        .write(true)
        .open(Path::new(&disk).join("rest"))
        .unwrap();
    file.set_len(length.saturating_sub(4096)).unwrap();
    let output = run();
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("No space left on device"),
        "{}",
        stderr(&output)
    );
    std::fs::remove_file(Path::new(&disk).join("rest")).unwrap();
    assert!(snapshot(Path::new(&disk)) == before);
    assert!(temporaries(Path::new(&disk)).is_empty());
}

/// Results go to a full device: told, with status 1, whatever is printed. Files are complete before anything is printed.
#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_told() {
    let folder = Folder::new("full-output");
    let out = folder.path("out");
    for arguments in [
        &["closure", "--out", &out][..],
        &["closure", "--format", "json"],
        &["check", "healthy"],
        &["generate", "--set", "faces=300", "--out", &folder.path("valve")],
        &["--help"],
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_coapt"))
            .args(arguments)
            .stdout(File::options().write(true).open("/dev/full").unwrap())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let told = stderr(&output);
        assert!(
            told.contains("standard output: No space") || arguments == ["--help"],
            "{told}"
        );
    }
    assert!(Path::new(&out).join("report.json").is_file() && temporaries(Path::new(&out)).is_empty());
}

/// Below a file there is no folder, whoever asks; bits of permission mean nothing to root.
#[test]
#[allow(clippy::print_stderr, reason = "a skipped test must say so")]
fn where_nobody_may_write_is_status_1() {
    let folder = Folder::new("read-only");
    let valve = with_membranes(&folder.valve(&[]));
    let below = folder.file("file", "in the way") + "/out";
    let closed = folder.path("closed");
    assert!(
        coapt(&["closure", &valve, "--out", &closed])
            .status
            .code()
            .is_some()
    );
    let leaflet = Path::new(&valve)
        .join("leaflet_anterior.vtp")
        .display()
        .to_string();
    for arguments in [
        &["closure", &valve, "--out", &below][..],
        &["generate", "--set", "faces=300", "--out", &below],
        &["export", &valve, "--format", "febio", "--out", &below],
        &["compare", &closed, &closed, "--out", &below],
        &["personalise", &valve, &leaflet, "--out", &below],
        &["study", "--faces", "160", "--out", &below],
    ] {
        let output = coapt(arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments:?} {}", stderr(&output));
        assert!(
            stderr(&output).contains("file/out"),
            "{arguments:?} {}",
            stderr(&output)
        );
    }
    let mut permissions = std::fs::metadata(&closed).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&closed, permissions.clone()).unwrap();
    if std::fs::write(Path::new(&closed).join("probe"), "").is_ok() {
        eprintln!("skipped in part: permissions do not bind this user");
    } else {
        let before = snapshot(Path::new(&closed));
        let output = coapt(&["closure", &valve, "--out", &closed]);
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(snapshot(Path::new(&closed)) == before);
    }
    #[allow(
        clippy::permissions_set_readonly_false,
        reason = "so that the folder can be removed"
    )]
    permissions.set_readonly(false);
    std::fs::set_permissions(&closed, permissions).unwrap();
}

/// `coapt ... | head -0`: the reader is gone before the first word.
#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = Folder::new("reader");
    let valve = folder.valve(&[]);
    let closed = folder.path("closed");
    assert!(
        coapt(&["closure", &valve, "--out", &closed])
            .status
            .code()
            .is_some()
    );
    let surface = Path::new(&closed).join("closed.vtp").display().to_string();
    let curve = folder.file(
        "curve.csv",
        "stretch_circ,stretch_rad,cauchy_stress_circ_kpa,cauchy_stress_rad_kpa\n1.02,1.05,1,1\n1.05,1.1,2,2\n1.08,1.15,5,5\n1.1,1.2,10,10\n1.11,1.22,20,20\n1.12,1.25,40,40\n1.14,1.28,90,90\n",
    );
    let small = [
        "--faces",
        "160",
        "--reference-faces",
        "300",
        "--tolerance",
        "1e-2",
        "--repeats",
        "1",
    ];
    let out = folder.path("study");
    let study = [&["study", "--out", &out][..], &small].concat();
    for arguments in [
        &["closure"][..],
        &["closure", "--format", "json"],
        &["check", "healthy"],
        &[
            "generate",
            "--set",
            "faces=300",
            "--out",
            &folder.path("generated"),
        ],
        &["compare", &surface, &surface],
        &["personalise", &valve, &surface],
        &["fit-tissue", &curve],
        &study,
        &["--help"],
        &["study", "--help"],
    ] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_coapt"))
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(
            matches!(output.status.code(), Some(0 | 3)),
            "{arguments:?} {}",
            stderr(&output)
        );
        assert!(!stderr(&output).contains("panicked"), "{}", stderr(&output));
    }
}

#[test]
fn a_file_in_place_of_a_folder_is_told() {
    let folder = Folder::new("file-for-folder");
    let file = folder.file("taken", "mine");
    let output = coapt(&["closure", "healthy", "--out", &file]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("taken is a file; expected a folder to write to"),
        "{}",
        stderr(&output)
    );
    assert_eq!(std::fs::read_to_string(file).unwrap(), "mine");
}

#[cfg(unix)]
#[test]
fn a_link_that_leads_nowhere_is_told() {
    let folder = Folder::new("link-for-folder");
    let link = folder.path("loop");
    std::os::unix::fs::symlink(&link, &link).unwrap();
    let output = coapt(&["closure", "healthy", "--out", &link]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("loop is a link that leads nowhere; expected a folder to write to"),
        "{}",
        stderr(&output)
    );
}
