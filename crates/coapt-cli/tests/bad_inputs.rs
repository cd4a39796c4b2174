//! The program and wrong inputs: of every file of `assets/bad` exactly what it asks for is told, with the right exit status,
//! soon and without a panic.

use std::process::{Command, Output};
use std::time::{Duration, Instant};

use coapt::scene::Severity;
use coapt_tests::told::{Expected, cases, differences, expected, folder, is_about_springs};
use serde_json::Value;

/// The longest of these closures takes less than a second, ten times that on a machine that is busy: whatever takes longer than
/// this hangs.
const LONGEST: Duration = Duration::from_secs(60);

fn run(arguments: &[&str]) -> Output {
    let start = Instant::now();
    let output = Command::new(env!("CARGO_BIN_EXE_coapt"))
        .args(arguments)
        .current_dir(folder())
        // Where numbers have a decimal comma, nothing may change.
        .env("LC_ALL", "de_DE.UTF-8")
        .output()
        .unwrap();
    let took = start.elapsed();
    assert!(took < LONGEST, "{arguments:?} took {took:?}");
    output
}

/// Both streams without line breaks within paragraphs: the report breaks its warnings to the width of a page.
fn words(arguments: &[&str], output: &Output) -> String {
    let [out, err] =
        [&output.stdout, &output.stderr].map(|stream| String::from_utf8(stream.clone()).unwrap());
    let all = out + "\n" + &err;
    assert!(!all.contains("panicked"), "{arguments:?}: {all}");
    flat(&all)
}

fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The faults that `coapt check` lists, as lines of words.
fn checked(case: &str) -> (Option<i32>, Vec<(Severity, String)>) {
    let output = run(&["check", "--format", "json", case]);
    let report: Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{case}: {error}: {output:?}"));
    let line = |fault: &Value| {
        let text = |key: &str| {
            fault[key]
                .as_str()
                .unwrap_or_default()
                .trim_start_matches("./")
                .to_owned()
        };
        let severity = match fault["severity"].as_str() {
            Some("error") => Severity::Error,
            _ => Severity::Warning,
        };
        (
            severity,
            coapt_io::scene::sentence(&coapt::scene::Fault {
                severity,
                ..coapt::scene::Fault::error(text("place"), text("message"))
            }),
        )
    };
    let faults = report["faults"].as_array().unwrap().iter().map(line);
    let meant = faults.filter(|(_, line)| !is_about_springs(line)).collect();
    (output.status.code(), meant)
}

/// Whether all of these faults are told; severity and place stand before the words.
fn compare(case: &str, expected: &Expected, told: &str) {
    for fault in &expected.faults {
        let text = flat(&fault.text);
        let found = told
            .find(&text)
            .unwrap_or_else(|| panic!("{case}: `{text}` is not in: {told}"));
        let before = &told[..found];
        let last = [before.rfind("error: "), before.rfind("warning: ")];
        let is_error = last[0] > last[1];
        assert_eq!(
            is_error,
            fault.severity == Severity::Error,
            "{case}: `{text}` in: {told}"
        );
    }
    if let Some(text) = &expected.uncertified {
        assert!(told.contains(&flat(text)), "{case}: `{text}` is not in: {told}");
    }
}

/// How `coapt closure` must end.
fn closure_status(expected: &Expected) -> i32 {
    match expected.is_refused() {
        true => 2,
        false if expected.uncertified.is_some() => 3,
        false => 0,
    }
}

#[test]
fn check_says_exactly_what_every_wrong_scene_asks_for() {
    let mut complaints = Vec::new();
    for case in &cases("") {
        let expected = expected(case);
        let (status, faults) = checked(case);
        complaints.extend(differences(case, &expected.faults, faults));
        let any_error = expected
            .faults
            .iter()
            .any(|fault| fault.severity == Severity::Error);
        if status != Some(if any_error { 2 } else { 0 }) {
            complaints.push(format!("{case}: check ends with {status:?}"));
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn closure_says_what_every_wrong_scene_asks_for() {
    for case in &cases("") {
        let expected = expected(case);
        let output = run(&["closure", case]);
        let told = words(&["closure", case], &output);
        assert_eq!(
            output.status.code(),
            Some(closure_status(&expected)),
            "{case}: {told}"
        );
        compare(case, &expected, &told);
    }
}

#[test]
fn closure_says_what_every_wrong_plan_asks_for() {
    for case in &cases("plans/") {
        let expected = expected(case);
        let arguments = ["closure", "parts/good.toml", "--plan", case];
        let output = run(&arguments);
        let told = words(&arguments, &output);
        assert_eq!(
            output.status.code(),
            Some(closure_status(&expected)),
            "{case}: {told}"
        );
        compare(case, &expected, &told);
    }
}

#[cfg(unix)]
#[test]
fn what_is_no_regular_file_is_told_and_not_waited_for() {
    let scratch = std::env::temp_dir().join(format!("coapt-cli-bad-inputs-{}", std::process::id()));
    for (file, text) in coapt_tests::told::make_odd_files(&scratch) {
        let scene = scratch.join("scene.toml");
        let good = std::fs::read_to_string(scratch.join("good.toml")).unwrap();
        std::fs::write(&scene, good.replace("anterior.obj", file)).unwrap();
        let odd = scratch.join(file);
        let [scene, odd] = [&scene, &odd].map(|path| path.to_str().unwrap());
        for arguments in [
            vec!["check", scene],
            vec!["closure", scene],
            vec!["check", odd],
            vec!["closure", "parts/good.toml", "--plan", odd],
            vec!["fit-tissue", odd],
        ] {
            let output = run(&arguments);
            let told = words(&arguments, &output);
            assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
            assert!(
                arguments[1] != scene || told.contains(text),
                "{arguments:?}: {told}"
            );
        }
    }
    std::fs::remove_dir_all(&scratch).unwrap();
}
