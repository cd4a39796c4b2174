//! What people are told: words that a terminal may show, numbers that they can read, what a file looks like.

use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::program::{Folder, coapt, stderr, stdout};

/// Clears the screen, in both of its spellings, and begins a line that looks like ours.
const OBEYED: &str = "\u{1b}[2J\u{9b}2J\nerror: made up";
const SHOWN: &str = "\\u001b[2J\\u009b2J\\nerror: made up";

/// A small valve whose case and anterior leaflet have this name.
fn named(folder: &Folder, name: &str) -> String {
    let valve = folder.valve(&[]);
    let scene = Path::new(&valve).join("scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    let name = format!("name = {}", serde_json::to_string(name).unwrap());
    let text = text
        .replace("name = \"healthy\"", &name)
        .replace("name = \"anterior\"", &name);
    std::fs::write(&scene, text).unwrap();
    valve
}

fn assert_obeys_nothing(arguments: &[&str], output: &Output) {
    for stream in [stdout(output), stderr(output)] {
        let control = |letter: char| letter.is_control() && letter != '\n';
        assert!(!stream.contains(control), "{arguments:?}: {stream:?}");
        let made_up = |line: &str| line.trim_start().starts_with("error: made up");
        assert!(!stream.lines().any(made_up), "{arguments:?}: {stream:?}");
    }
}

#[test]
fn names_cannot_command_the_terminal() {
    let folder = Folder::new("obeyed");
    let valve = named(&folder, OBEYED);
    let out = folder.path("out");
    let file = folder.file(
        "wrong\u{1b}[31m.toml",
        "name = \"\\u001b[2J\"\n\"\\u001b[2J\" = 1\n",
    );
    let small = [
        "--reference-faces",
        "300",
        "--tolerance",
        "1e-2",
        "--repeats",
        "1",
    ];
    let study = [&["study", "--faces", "160", "--out", &out][..], &small].concat();
    for arguments in [
        &["closure", &valve, "--out", &out][..],
        &["closure", &valve, "--format", "json"],
        &["check", &valve],
        &["check", &valve, "--format", "json"],
        &["compare", &out, &out],
        &study,
        &["check", &file],
        &["closure", &file],
        &["closure", "\u{1b}[2J"],
        &["closure", "--plan", "\u{1b}[2J"],
        &["\u{1b}[2J"],
        &["generate", "--set", "faces=\u{1b}[2J", "--out", &out],
    ] {
        assert_obeys_nothing(arguments, &coapt(arguments));
    }
    let text = stdout(&coapt(&["closure", &valve]));
    assert!(text.starts_with(SHOWN), "{text}");
    // Machines get the name as it is.
    let report: Value =
        serde_json::from_str(&stdout(&coapt(&["closure", &valve, "--format", "json"]))).unwrap();
    assert_eq!(report["case"], OBEYED);
}
