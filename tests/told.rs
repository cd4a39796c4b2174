//! What a wrong input says must be told of it, and how that differs from what is told. `assets/bad/README.md` explains how
//! the files say it; the library is held to it in `it/bad_inputs.rs`, the program in its own tests.

use std::fs;
use std::path::{Path, PathBuf};

use coapt::scene::Severity;

/// The folder of the wrong inputs.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/bad")
}

/// A fault that must be told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expectation {
    /// Error or warning.
    pub severity: Severity,
    /// The start of the fault as a line of words, `file:line`, where the position in the file says it.
    pub place: Option<String>,
    /// Words of it.
    pub text: String,
}

/// All that a case says must be told.
#[derive(Clone, Debug, Default)]
pub struct Expected {
    /// Faults, no more and no less.
    pub faults: Vec<Expectation>,
    /// Not one.
    pub accepted: bool,
    /// Closing the valve ends without a certificate, and these words say why.
    pub uncertified: Option<String>,
}

impl Expected {
    /// Whether nobody can make a model of it.
    pub fn is_refused(&self) -> bool {
        let refused = |e: &Expectation| e.severity == Severity::Error;
        self.faults.iter().any(refused)
    }
}

/// The cases in a folder below that of the wrong inputs, in order: `name.toml`.
///
/// # Panics
/// When the folder cannot be read.
pub fn cases(below: &str) -> Vec<String> {
    let entries = fs::read_dir(folder().join(below)).expect("the folder of wrong inputs");
    let mut names: Vec<String> = entries
        .map(|entry| below.to_owned() + &entry.expect("an entry").file_name().to_string_lossy())
        .collect();
    names.retain(|name| name.ends_with(".toml") || name.ends_with(".json"));
    names.sort();
    names
}

/// What a case says: in itself, in a mesh of the same name, or, where neither can hold words, in `.expect`.
///
/// # Panics
/// When it says nothing, or something that has no meaning.
pub fn expected(case: &str) -> Expected {
    let stem = case.rsplit_once('.').map_or(case, |(stem, _)| stem);
    let mut expected = Expected::default();
    for file in [case.to_owned(), format!("{case}.expect"), format!("{stem}.obj")] {
        let bytes = fs::read(folder().join(&file)).unwrap_or_default();
        // Old files end their lines with a carriage return alone.
        let text = String::from_utf8_lossy(&bytes)
            .replace("\r\n", "\n")
            .replace('\r', "\n");
        take_up(&text, &file, &mut expected);
    }
    let says_nothing = expected.faults.is_empty() && expected.uncertified.is_none();
    assert!(
        expected.accepted == says_nothing,
        "{case} must say either what is told of it or `# expect accepted`: {expected:#?}"
    );
    expected
}

fn take_up(text: &str, file: &str, expected: &mut Expected) {
    let mut line_above = 0;
    for (number, line) in (1..).zip(text.lines()) {
        let (place, said) = if let Some(said) = line.strip_prefix("#^ ") {
            (Some(format!("{file}:{line_above}")), said)
        } else {
            line_above = number;
            let Some(said) = line.strip_prefix("# expect ") else {
                continue;
            };
            (None, said)
        };
        let (severity, text) = match said.trim_end().split_once(": ") {
            Some(("error", text)) => (Severity::Error, text),
            Some(("warning", text)) => (Severity::Warning, text),
            Some(("uncertified", text)) => {
                expected.uncertified = Some(text.to_owned());
                continue;
            }
            _ => {
                assert_eq!(said.trim_end(), "accepted", "{file}:{number}: what is expected?");
                expected.accepted = true;
                continue;
            }
        };
        assert!(text.len() > 9, "{file}:{number}: `{text}` is in many messages");
        expected.faults.push(Expectation {
            severity,
            place,
            text: text.to_owned(),
        });
    }
}

/// Where expectations and faults, as lines of words, differ.
pub fn differences<'a>(
    case: &str,
    expected: impl IntoIterator<Item = &'a Expectation>,
    mut told: Vec<(Severity, String)>,
) -> Vec<String> {
    let mut complaints = Vec::new();
    for expectation in expected {
        let at = expectation.place.as_deref().unwrap_or("");
        let fits = |(severity, line): &(Severity, String)| {
            let ends = line
                .strip_prefix(at)
                .is_some_and(|rest| at.is_empty() || rest.starts_with([':', ' ']));
            *severity == expectation.severity && ends && line.contains(&expectation.text)
        };
        match told.iter().position(fits) {
            Some(found) => drop(told.remove(found)),
            None => complaints.push(format!("{case}: {expectation:?} is not told")),
        }
    }
    let beyond = |(severity, line)| format!("{case}: told beyond what is expected: {severity:?} {line}");
    complaints.extend(told.into_iter().map(beyond));
    complaints
}

/// These valves are a few rectangles cut in two, no mesh for springs, and not one of them is about that.
pub fn is_about_springs(message: &str) -> bool {
    message.contains("the mesh is too irregular for springs")
}

/// Makes what no repository can hold, a FIFO without a writer, a link that leads to itself, one to an endless device and one
/// out of the folder, beside the good valve; gives their names and what must be told of each as a mesh.
///
/// # Panics
/// When they cannot be made.
#[cfg(unix)]
pub fn make_odd_files(scratch: &Path) -> [(&'static str, &'static str); 4] {
    use std::os::unix::fs::symlink;
    fs::create_dir_all(scratch).expect("a scratch folder");
    let parts = folder().join("parts");
    for file in ["good.toml", "anterior.obj", "posterior.obj"] {
        fs::copy(parts.join(file), scratch.join(file)).expect("a part of the good valve");
    }
    let made = std::process::Command::new("mkfifo")
        .arg(scratch.join("anterior.fifo"))
        .status();
    assert!(made.expect("mkfifo").success());
    let elsewhere = parts.join("anterior.obj");
    for (to, link) in [
        (Path::new("anterior.link"), "anterior.link"),
        (Path::new("/dev/zero"), "anterior.zero"),
        (&elsewhere, "anterior.out"),
    ] {
        symlink(to, scratch.join(link)).expect("a link");
    }
    [
        ("anterior.fifo", "anterior.fifo is not a regular file"),
        ("anterior.link", "anterior.link: "),
        ("anterior.zero", "a link that leads out of the scene's folder"),
        ("anterior.out", "a link that leads out of the scene's folder"),
    ]
}
