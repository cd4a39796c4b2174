//! The program and wrong inputs: every file of `assets/bad` gets the words that it asks for and the right exit
//! status, soon and without a panic. That nothing else is told, and where, is tested with the library.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// None of the files is larger than a few kilobytes: whatever takes longer than this hangs.
const LONGEST: Duration = Duration::from_secs(10);

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/bad")
}

/// The names of the cases below the folder.
fn cases(below: &str) -> Vec<String> {
    let entries = fs::read_dir(folder().join(below)).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| below.to_owned() + &entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.retain(|name| name.ends_with(".toml") || name.ends_with(".json"));
    names.sort();
    names
}

/// Severity and words of what must be told.
fn expected(case: &str) -> Vec<(String, String)> {
    let stem = case.rsplit_once('.').map_or(case, |(stem, _)| stem);
    let mut found = Vec::new();
    for file in [case.to_owned(), format!("{case}.expect"), format!("{stem}.obj")] {
        let bytes = fs::read(folder().join(file)).unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes);
        let said = text.lines().filter_map(|line| {
            let said = line
                .strip_prefix("#^ ")
                .or_else(|| line.strip_prefix("# expect "))?;
            let (severity, words) = said.trim_start_matches("check ").split_once(": ")?;
            Some((severity.to_owned(), words.trim_end().to_owned()))
        });
        found.extend(said);
    }
    found
}

fn run(arguments: &[&str]) -> Output {
    let start = Instant::now();
    let output = Command::new(env!("CARGO_BIN_EXE_coapt"))
        .args(arguments)
        .current_dir(folder())
        .output()
        .unwrap();
    let took = start.elapsed();
    assert!(took < LONGEST, "{arguments:?} took {took:?}");
    output
}

/// Both streams without line breaks within paragraphs: the report breaks its warnings to the width of a page.
fn told(arguments: &[&str], output: &Output) -> String {
    let [out, err] =
        [&output.stdout, &output.stderr].map(|stream| String::from_utf8(stream.clone()).unwrap());
    assert!(!(out + &err).contains("panicked"), "{arguments:?}: {output:?}");
    let [out, err] =
        [&output.stdout, &output.stderr].map(|stream| String::from_utf8(stream.clone()).unwrap());
    (out + "\n" + &err)
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

/// Whether all of them are told; severity and place stand before the words.
fn compare(case: &str, expected: &[(String, String)], told: &str) {
    for (severity, words) in expected {
        let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
        let found = told
            .find(&words)
            .unwrap_or_else(|| panic!("{case}: `{words}` is not in: {told}"));
        let before = &told[..found];
        let last = [before.rfind("error: "), before.rfind("warning: ")];
        assert_eq!(
            last[0] > last[1],
            severity == "error",
            "{case}: `{words}` is no {severity} in: {told}"
        );
    }
}

#[test]
fn check_says_what_every_wrong_scene_asks_for() {
    let cases = cases("");
    assert!(cases.len() >= 30, "only {} cases", cases.len());
    for case in &cases {
        let expected = expected(case);
        let output = run(&["check", case]);
        let told = told(&["check", case], &output);
        compare(case, &expected, &told);
        let status = if expected.iter().any(|(severity, _)| severity == "error") {
            2
        } else {
            0
        };
        assert_eq!(output.status.code(), Some(status), "{case}: {told}");
    }
}

#[test]
fn closure_refuses_every_wrong_scene() {
    for case in &cases("") {
        let expected = expected(case);
        if expected.iter().all(|(severity, _)| severity == "warning") {
            continue;
        }
        let output = run(&["closure", case]);
        let told = told(&["closure", case], &output);
        assert_eq!(output.status.code(), Some(2), "{case}: {told}");
    }
}

#[test]
fn closure_says_what_every_wrong_plan_asks_for() {
    let cases = cases("plans/");
    assert!(cases.len() >= 10, "only {} plans", cases.len());
    for case in &cases {
        let expected = expected(case);
        assert!(!expected.is_empty(), "{case} says nothing");
        let arguments = ["closure", "parts/good.toml", "--plan", case];
        let output = run(&arguments);
        compare(case, &expected, &told(&arguments, &output));
        let refused = output.status.code() == Some(2);
        let wrong = expected.iter().any(|(severity, _)| severity == "error");
        assert_eq!(refused, wrong, "{case}: {:?}", output.status);
    }
}
