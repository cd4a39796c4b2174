//! The gallery of hard cases as files: `assets/hard`, and how each must end by `docs/hard-cases.md`.

use std::path::{Path, PathBuf};

/// Where the files are.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/hard")
}

/// The name of a case's file without its ending: `healthy: 5 mmHg` is `healthy-5-mmhg`.
pub fn file_stem(case: &str) -> String {
    let letters = case
        .to_lowercase()
        .replace(|c: char| !c.is_ascii_alphanumeric(), " ");
    letters
        .split(' ')
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join("-")
}

/// A case with a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Case {
    /// Its scene.
    pub scene: PathBuf,
    /// Its plan, for a case that is a preset on a ring.
    pub plan: Option<PathBuf>,
    /// The exit status that the program must end with.
    pub exit_status: i32,
}

/// Every row of the table that has a file, in the order of the table.
///
/// # Panics
/// When the table cannot be read, which fails the test that asked.
pub fn cases() -> Vec<Case> {
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/hard-cases.md");
    let text = std::fs::read_to_string(table).expect("the table is there");
    text.lines().filter_map(case).collect()
}

fn case(line: &str) -> Option<Case> {
    let mut cells = line.strip_prefix("| ")?.split(" | ");
    let (name, end) = (cells.next()?, cells.nth(1)?);
    let exit_status = match end {
        "certified" => 0,
        "not certified" => 3,
        "refused" => 2,
        _ => return None,
    };
    let file = |stem: &str| folder().join(format!("{stem}.toml"));
    let (scene, plan) = match name.split_once(": ring ") {
        Some((preset, ring)) => (
            file(&file_stem(&format!("{preset}: base"))),
            Some(file(&format!("plans/{}", file_stem(&format!("ring {ring}"))))),
        ),
        None => (file(&file_stem(name)), None),
    };
    scene.is_file().then_some(Case {
        scene,
        plan,
        exit_status,
    })
}
