//! The program, and a folder to run it in.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use coapt_io::atomic::LIST;

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

/// A generated valve with leaflets of a law that other engines have.
pub(crate) fn with_membranes(valve: &str) -> String {
    let scene = Path::new(valve).join("scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    let springs = [
        "law = \"bilinear-springs\"",
        "pre_transition_modulus_mpa",
        "transition_strain",
        "post_transition_modulus_mpa",
        "compression_modulus_ratio",
        "bending_modulus_ratio",
    ];
    let membrane: Vec<&str> = text
        .lines()
        .filter_map(
            |line| match springs.iter().position(|key| line.starts_with(key)) {
                None => Some(line),
                Some(0) => Some("law = \"st-venant-kirchhoff\"\nmodulus_mpa = 0.4"),
                Some(_) => None,
            },
        )
        .collect();
    std::fs::write(&scene, membrane.join("\n")).unwrap();
    valve.to_owned()
}

/// Files by their path below a folder; of reports all but the times.
pub(crate) type Snapshot = BTreeMap<String, Vec<u8>>;

/// All complete files below a folder, but for the list of their checksums, those of wall-clock times among them.
pub(crate) fn snapshot(folder: &Path) -> Snapshot {
    let timeless = |bytes: Vec<u8>| match String::from_utf8(bytes) {
        Ok(text) => text
            .lines()
            .filter(|line| !line.contains("wall_ms"))
            .collect::<Vec<_>>()
            .join("\n")
            .into_bytes(),
        Err(error) => error.into_bytes(),
    };
    let complete = files(folder)
        .into_iter()
        .filter(|name| !name.ends_with(".tmp") && name != LIST);
    complete
        .map(|name| {
            let bytes = timeless(std::fs::read(folder.join(&name)).unwrap());
            (name, bytes)
        })
        .collect()
}

/// Whether all files that a folder's list names are as it says, by the tool that reads such lists; nothing where the system
/// has none.
pub(crate) fn fits_its_list(folder: &Path) -> Option<bool> {
    let check = Command::new("sha256sum")
        .args(["--check", "--strict", "--quiet", LIST])
        .current_dir(folder)
        .output();
    Some(check.ok()?.status.success())
}

/// What is left below a folder of files that were not finished.
pub(crate) fn temporaries(folder: &Path) -> Vec<String> {
    let mut names = files(folder);
    names.retain(|name| name.ends_with(".tmp"));
    names
}

fn files(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        match entry.file_type().unwrap().is_dir() {
            true => names.extend(files(&entry.path()).iter().map(|file| format!("{name}/{file}"))),
            false => names.push(name),
        }
    }
    names
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
