//! Wrong inputs as real files, `assets/bad`: each says itself what must be told of it and where, and exactly that
//! must be told, no less and no more. `README.md` there explains how files say it.

use std::path::Path;

use coapt::model::{Built, Model};
use coapt::plan::apply_all;
use coapt::relax::relax;
use coapt::scene::{Fault, Severity};
use coapt::state::State;
use coapt_io::scene::{located, plan_from_text, read_text, scene_from_text, sentence};
use coapt_tests::told::{Expected, cases, differences, expected, folder, is_about_springs};

/// Fewer would mean that the folder is not read.
const FEWEST_CASES: usize = 200;
const FEWEST_PLANS: usize = 25;

/// Faults as lines of words, without the folder's path.
fn told(faults: &[Fault]) -> Vec<(Severity, String)> {
    let folder = format!("{}/", folder().display());
    let line = |fault: &Fault| (fault.severity, sentence(fault).replace(&folder, ""));
    faults.iter().map(line).collect()
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
        Ok(Built { model, warnings, .. }) => (warnings, Some(model)),
        Err(faults) => (faults, None),
    };
    let name = path.display().to_string();
    let meant = more.iter().filter(|fault| !is_about_springs(&fault.message));
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
    let in_plan = |number: usize, fault: &Fault| {
        let key = fault.place.strip_prefix("ring").unwrap_or("").to_owned();
        let place = format!("repair[{number}]{key}");
        let fault = Fault {
            place,
            ..fault.clone()
        };
        located(&path.display().to_string(), &text, &fault)
    };
    match apply_all(good, &plan.repair) {
        Ok(applied) => {
            let doubts = applied.warnings.iter();
            faults.extend(doubts.map(|(number, fault)| in_plan(*number, fault)));
            (faults, Some(applied.model))
        }
        Err(refusal) => {
            let told = refusal.faults.iter();
            faults.extend(told.map(|fault| in_plan(refusal.repair, fault)));
            (faults, None)
        }
    }
}

/// A valve that is accepted, with warnings or without, must not bring the solver down either, and is certified unless
/// the case says that it is not.
fn close(case: &str, model: &Model, expected: &Expected) {
    let closed = relax(model, &State::open(model));
    let finite = |position: &coapt::Vec3| position.iter().all(|c| c.is_finite());
    assert!(closed.state.positions_mm.iter().all(finite), "{case}");
    assert_eq!(
        closed.certificate.is_certified(closed.status),
        expected.uncertified.is_none(),
        "{case}: {:?} {:?}",
        closed.status,
        closed.certificate
    );
}

/// Reads, compares and closes every case.
fn judge(cases: &[String], read: impl Fn(&Path) -> (Vec<Fault>, Option<Model>)) {
    let mut complaints = Vec::new();
    for case in cases {
        let expected = expected(case);
        let (faults, model) = read(&folder().join(case));
        complaints.extend(differences(case, &expected.faults, told(&faults)));
        assert_eq!(model.is_none(), expected.is_refused(), "{case}: {faults:#?}");
        if let Some(model) = model {
            close(case, &model, &expected);
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn every_wrong_scene_is_told_as_it_says_itself() {
    let cases = cases("");
    assert!(cases.len() >= FEWEST_CASES, "only {} cases", cases.len());
    judge(&cases, open);
}

#[test]
fn every_wrong_plan_is_told_as_it_says_itself() {
    let (faults, good) = open(&folder().join("parts/good.toml"));
    assert!(faults.is_empty(), "the good valve has faults: {faults:#?}");
    let good = good.unwrap();
    let cases = cases("plans/");
    assert!(cases.len() >= FEWEST_PLANS, "only {} plans", cases.len());
    judge(&cases, |path| plan(path, &good));
}

#[test]
fn every_case_has_its_row() {
    let table = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let named = |case: &String| {
        let name = case.rsplit_once('.').map_or(&case[..], |(name, _)| name);
        table.contains(&format!("`{}`", name.replace("plans/", "p/")))
    };
    let absent: Vec<String> = [cases(""), cases("plans/")]
        .concat()
        .into_iter()
        .filter(|case| !named(case))
        .collect();
    assert!(absent.is_empty(), "not in the table of README.md: {absent:?}");
}

#[cfg(unix)]
#[test]
fn what_is_no_regular_file_is_told_and_not_waited_for() {
    let scratch = std::env::temp_dir().join(format!("coapt-bad-inputs-{}", std::process::id()));
    for (file, told) in coapt_tests::told::make_odd_files(&scratch) {
        let scene = scratch.join("scene.toml");
        let text = std::fs::read_to_string(scratch.join("good.toml")).unwrap();
        std::fs::write(&scene, text.replace("anterior.obj", file)).unwrap();
        let (faults, model) = open(&scene);
        let lines: Vec<String> = faults.iter().map(sentence).collect();
        assert!(
            model.is_none() && lines.len() == 1 && lines[0].contains(told),
            "{file}: {lines:#?}"
        );
        // The scene itself may be the odd file too.
        assert!(open(&scratch.join(file)).1.is_none());
    }
    std::fs::remove_dir_all(&scratch).unwrap();
}
