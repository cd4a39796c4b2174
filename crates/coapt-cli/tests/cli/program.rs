//! The program, and a folder to run it in.

use std::path::PathBuf;
use std::process::{Command, Output};

pub(crate) fn coapt(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_coapt"))
        .args(arguments)
        .output()
        .unwrap()
}

pub(crate) fn status(arguments: &[&str]) -> Option<i32> {
    coapt(arguments).status.code()
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A folder that is gone at the end.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("coapt-cli-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }

    pub(crate) fn file(&self, name: &str, text: &str) -> String {
        std::fs::write(self.0.join(name), text).unwrap();
        self.path(name)
    }

    /// A small healthy valve as a scene folder.
    pub(crate) fn valve(&self, settings: &[&str]) -> String {
        self.preset("valve", "healthy", settings)
    }

    /// A small valve of a preset as a scene folder of some name.
    pub(crate) fn preset(&self, name: &str, preset: &str, settings: &[&str]) -> String {
        let folder = self.path(name);
        let mut arguments = vec!["generate", preset, "--out", &folder, "--set", "faces=300"];
        settings
            .iter()
            .for_each(|setting| arguments.extend(["--set", setting]));
        let output = coapt(&arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        folder
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// `../shared` beside the repository, or what `COAPT_SHARED` names; where it is absent, nothing, and the test says so.
#[allow(clippy::print_stderr, reason = "a skipped test must say so")]
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared"));
    let folder = std::env::var_os("COAPT_SHARED")
        .map_or_else(beside, PathBuf::from)
        .join(name);
    if !folder.exists() {
        eprintln!("skipped: ../shared not present");
    }
    folder.exists().then_some(folder)
}
