//! Wrong inputs as real files, `assets/bad`: each says itself what must be told of it and where, and exactly that
//! must be told, no less and no more. `README.md` there explains how files say it.

use std::fs;
use std::path::{Path, PathBuf};

use coapt::model::{Built, Model};
use coapt::relax::{Status, relax};
use coapt::repair;
use coapt::scene::{Fault, Severity};
use coapt::state::State;
use coapt_io::scene::{located, plan_from_text, read_text, scene_from_text, sentence};

/// Fewer would mean that the folder is not read.
const FEWEST_CASES: usize = 30;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/bad")
}

/// What a file says must be told.
#[derive(Debug)]
struct Expectation {
    severity: Severity,
    /// The start of the fault as a line of words, `file:line`, where the position in the file says it.
    place: Option<String>,
    text: String,
    /// Only `coapt check` tells it; the library takes the valve and says when closing it.
    check_only: bool,
}

/// The expectations of a file, and whether it must be accepted without a word.
fn expectations_in(file: &Path, name: &str) -> (Vec<Expectation>, bool) {
    let bytes = fs::read(file).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes);
    let (mut found, mut accepted, mut line_above) = (Vec::new(), false, 0);
    for (number, line) in (1..).zip(text.lines()) {
        let (place, said) = if let Some(said) = line.strip_prefix("#^ ") {
            (Some(format!("{name}:{line_above}")), said)
        } else {
            line_above = number;
            let Some(said) = line.strip_prefix("# expect ") else {
                continue;
            };
            (None, said)
        };
        let check_only = said.starts_with("check ");
        let said = said.trim_start_matches("check ").trim_end();
        let (severity, text) = match said.split_once(": ") {
            Some(("error", text)) => (Severity::Error, text),
            Some(("warning", text)) => (Severity::Warning, text),
            _ => {
                assert_eq!(said, "accepted", "{name}:{number}: what is expected?");
                accepted = true;
                continue;
            }
        };
        assert!(text.len() > 9, "{name}:{number}: `{text}` is in many messages");
        found.push(Expectation {
            severity,
            place,
            text: text.to_owned(),
            check_only,
        });
    }
    (found, accepted)
}

/// Expectations of a case: in itself, in a mesh of the same name, or, where neither can hold words, in `.expect`.
fn expectations(case: &Path) -> (Vec<Expectation>, bool) {
    let name = named(&case.display().to_string());
    let beside = PathBuf::from(format!("{}.expect", case.display()));
    let mesh = case.with_extension("obj");
    let mut found = (Vec::new(), false);
    for file in [case, &beside, &mesh] {
        let name = if file == mesh {
            named(&mesh.display().to_string())
        } else {
            name.clone()
        };
        let (more, accepted) = expectations_in(file, &name);
        found.0.extend(more);
        found.1 |= accepted;
    }
    assert!(
        found.1 == found.0.is_empty(),
        "{name} must say either what is told of it or `# expect accepted`: {found:#?}"
    );
    found
}

/// Words without the folder's path.
fn named(words: &str) -> String {
    words.replace(&format!("{}/", folder().display()), "")
}

/// The files with these extensions, in order.
fn cases(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| {
        file.extension()
            .is_some_and(|e| extensions.iter().any(|known| e == *known))
    });
    files.sort();
    files
}

/// Where expectations and faults differ, in words.
fn differences(case: &Path, expected: &[Expectation], faults: &[Fault]) -> Vec<String> {
    let name = named(&case.display().to_string());
    let mut left: Vec<String> = faults.iter().map(|fault| named(&sentence(fault))).collect();
    let mut severities: Vec<Severity> = faults.iter().map(|fault| fault.severity).collect();
    let mut complaints = Vec::new();
    for expectation in expected.iter().filter(|expectation| !expectation.check_only) {
        let at = expectation.place.as_deref().unwrap_or("");
        let fits = |i: &usize| {
            let ends = left[*i]
                .strip_prefix(at)
                .is_some_and(|rest| at.is_empty() || rest.starts_with(':'));
            severities[*i] == expectation.severity && ends && left[*i].contains(&expectation.text)
        };
        match (0..left.len()).find(fits) {
            Some(found) => drop((left.remove(found), severities.remove(found))),
            None => complaints.push(format!("{name}: {expectation:?} is not told")),
        }
    }
    complaints.extend(
        left.iter()
            .map(|line| format!("{name}: told beyond what is expected: {line}")),
    );
    complaints
}

/// All faults of a scene with their lines, and the model if there is one.
fn open(path: &Path) -> (Vec<Fault>, Option<Model>) {
    let text = match read_text(path) {
        Ok(text) => text,
        Err(fault) => return (vec![fault], None),
    };
    let (scene, mut faults) = match scene_from_text(path, &text) {
        Ok(read) => read,
        Err(faults) => return (faults, None),
    };
    let (more, model) = match Model::build(&scene) {
        Ok(Built { model, warnings }) => (warnings, Some(model)),
        Err(faults) => (faults, None),
    };
    let name = path.display().to_string();
    // These valves are a few rectangles cut in two, no mesh for springs, and not one of them is about that.
    let is_meant = |fault: &&Fault| !fault.message.starts_with("the mesh is too irregular for springs");
    let meant = more.iter().filter(is_meant);
    faults.extend(meant.map(|fault| located(&name, &text, fault)));
    (faults, model)
}

/// All faults of a plan for the good valve with their lines, and the repaired model if there is one.
fn plan(path: &Path, good: &Model) -> (Vec<Fault>, Option<Model>) {
    let read = read_text(path).map_err(|fault| vec![fault]);
    let read = read.and_then(|text| Ok((plan_from_text(path, &text)?, text)));
    let ((plan, mut faults), text) = match read {
        Ok(read) => read,
        Err(faults) => return (faults, None),
    };
    let mut model = good.clone();
    for (number, deed) in plan.repair.iter().enumerate() {
        let (more, repaired) = match repair::apply(&model, deed) {
            Ok(repaired) => (repaired.warnings, Some(repaired.model)),
            Err(faults) => (faults, None),
        };
        faults.extend(more.into_iter().map(|fault| {
            let key = fault.place.strip_prefix("ring").unwrap_or("").to_owned();
            let place = format!("repair[{number}]{key}");
            located(&path.display().to_string(), &text, &Fault { place, ..fault })
        }));
        match repaired {
            Some(repaired) => model = repaired,
            None => return (faults, None),
        }
    }
    (faults, Some(model))
}

/// A valve that is accepted, with warnings or without, must not bring the solver down either.
fn close(name: &Path, model: &Model, tangled: bool) {
    let closed = relax(model, &State::open(model));
    let finite = |position: &coapt::Vec3| position.iter().all(|c| c.is_finite());
    assert!(closed.state.positions_mm.iter().all(finite), "{}", name.display());
    assert_eq!(
        closed.status == Status::TangledStart,
        tangled,
        "{}",
        name.display()
    );
}

#[test]
fn every_wrong_scene_is_told_as_it_says_itself() {
    let cases = cases(&folder(), &["toml", "json"]);
    assert!(cases.len() >= FEWEST_CASES, "only {} cases", cases.len());
    let mut complaints = Vec::new();
    for case in &cases {
        let (expected, _) = expectations(case);
        let (faults, model) = open(case);
        complaints.extend(differences(case, &expected, &faults));
        let is_error = |e: &Expectation| e.severity == Severity::Error && !e.check_only;
        let accepted = !expected.iter().any(is_error);
        assert_eq!(model.is_some(), accepted, "{}: {faults:#?}", case.display());
        if let Some(model) = model {
            close(
                case,
                &model,
                expected.iter().any(|expectation| expectation.check_only),
            );
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn every_wrong_plan_is_told_as_it_says_itself() {
    let (faults, good) = open(&folder().join("parts/good.toml"));
    assert!(faults.is_empty(), "the good valve has faults: {faults:#?}");
    let good = good.unwrap();
    let mut complaints = Vec::new();
    let cases = cases(&folder().join("plans"), &["toml"]);
    assert!(cases.len() >= 10, "only {} plans", cases.len());
    for case in &cases {
        let (expected, _) = expectations(case);
        let (faults, model) = plan(case, &good);
        complaints.extend(differences(case, &expected, &faults));
        let accepted = expected
            .iter()
            .all(|expectation| expectation.severity == Severity::Warning);
        assert_eq!(model.is_some(), accepted, "{}: {faults:#?}", case.display());
        if let Some(model) = model {
            close(case, &model, false);
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

/// What no repository can hold: a FIFO without a writer, a link that leads to itself, an endless device.
#[cfg(unix)]
#[test]
fn what_is_no_regular_file_is_told_and_not_waited_for() {
    let scratch = std::env::temp_dir().join(format!("coapt-bad-inputs-{}", std::process::id()));
    fs::create_dir_all(&scratch).unwrap();
    let text = fs::read_to_string(folder().join("parts/good.toml")).unwrap();
    fs::copy(
        folder().join("parts/posterior.obj"),
        scratch.join("posterior.obj"),
    )
    .unwrap();
    let made = std::process::Command::new("mkfifo")
        .arg(scratch.join("anterior.fifo"))
        .status();
    assert!(made.unwrap().success());
    std::os::unix::fs::symlink("anterior.link", scratch.join("anterior.link")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", scratch.join("anterior.zero")).unwrap();
    for (file, told) in [
        ("anterior.fifo", "anterior.fifo is not a regular file"),
        ("anterior.link", "anterior.link: "),
        ("anterior.zero", "anterior.zero is not a regular file"),
    ] {
        let scene = scratch.join("scene.toml");
        fs::write(&scene, text.replace("anterior.obj", file)).unwrap();
        let (faults, model) = open(&scene);
        let lines: Vec<String> = faults.iter().map(sentence).collect();
        assert!(
            model.is_none() && lines.len() == 1 && lines[0].contains(told),
            "{file}: {lines:#?}"
        );
        // The scene itself may be the odd file too.
        assert!(open(&scratch.join(file)).1.is_none());
    }
    fs::remove_dir_all(&scratch).unwrap();
}
