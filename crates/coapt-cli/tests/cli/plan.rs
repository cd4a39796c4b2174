//! `coapt plan`: what is printed and written, and how it ends.

use std::path::Path;

use coapt::scene::Settings;
use serde_json::Value;

use crate::program::{Folder, coapt, snapshot, stderr, stdout};

const START: &str = "schema_version = 1\nname = \"rings\"\n";
const RING: &str = "[[alternative]]\n[[alternative.repair]]\nkind = \"ring\"\nfamily = \"saddle\"\n";

fn plan(folder: &Folder, name: &str, rest: &str) -> String {
    folder.file(name, &format!("{START}{rest}"))
}

#[test]
fn alternatives_are_compared_in_one_table_and_its_files() {
    let folder = Folder::new("plan-table");
    let valve = folder.preset("valve", "dilated", &[]);
    let rings = plan(
        &folder,
        "plan.toml",
        &format!(
            "{RING}size_mm = {{ from = 28, to = 32, step = 2 }}\n[[alternative]]\n[[alternative.repair]]\nkind = \"clip\"\n\
             position = 0.02\n"
        ),
    );
    let out = folder.path("out");
    let output = coapt(&["plan", &valve, &rings, "--out", &out, "--shapes"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(
        text.contains(", plan \"rings\": 4 alternatives compared at 100 mmHg"),
        "{text}"
    );
    assert!(
        text.contains("REFUSED: ") && text.contains("plan.toml:11: alternative[1].repair[0].position"),
        "{text}"
    );
    assert!(text.ends_with("research use, not a medical device\n"), "{text}");
    // Nobody sits before a terminal: no line that counts.
    assert!(
        !stderr(&output).contains('\r') && stderr(&output).contains("5 closures in "),
        "{}",
        stderr(&output)
    );
    let files: Vec<String> = snapshot(Path::new(&out)).into_keys().collect();
    for name in [
        "plan.csv",
        "plan.json",
        "plan_long.csv",
        "plan_units.csv",
        "shapes/0000_before.vtp",
        "shapes/0003_ring-32.vtp",
    ] {
        assert!(files.iter().any(|file| file == name), "{name}: {files:?}");
    }
    let printed = stdout(&coapt(&["plan", &valve, &rings, "--format", "json"]));
    assert_eq!(
        printed,
        std::fs::read_to_string(Path::new(&out).join("plan.json")).unwrap()
    );
    let report: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(report["alternatives"].as_array().map(Vec::len), Some(4));
    assert_eq!(report["notice"], "research use, not a medical device");
}

/// Each row says what `closure` says of the same ring.
#[test]
fn a_row_is_what_closure_finds() {
    let folder = Folder::new("plan-closure");
    let valve = folder.preset("valve", "dilated", &[]);
    let rings = plan(&folder, "plan.toml", &format!("{RING}size_mm = [28, 30]\n"));
    let compared: Value =
        serde_json::from_str(&stdout(&coapt(&["plan", &valve, &rings, "--format", "json"]))).unwrap();
    let closed: Value = serde_json::from_str(&stdout(&coapt(&[
        "closure",
        &valve,
        "--ring",
        "saddle:30",
        "--format",
        "json",
    ])))
    .unwrap();
    let rows = compared["alternatives"].as_array().unwrap();
    let row = rows.iter().find(|row| row["name"] == "ring 30").unwrap();
    for measure in [
        "orifice",
        "coaptation",
        "annulus",
        "chords",
        "leaflets",
        "tenting",
    ] {
        assert_eq!(row[measure], closed["after"][measure], "{measure}");
        assert_eq!(
            compared["before"][measure], closed["before"][measure],
            "{measure}"
        );
    }
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let folder = Folder::new("plan-threads");
    let valve = folder.preset("valve", "dilated", &[]);
    let rings = plan(
        &folder,
        "plan.toml",
        &format!("{RING}size_mm = [26, 28, 30, 32, 34]\n"),
    );
    let of = |threads: &str| {
        let out = folder.path(threads);
        let output = coapt(&[
            "plan",
            &valve,
            &rings,
            "--out",
            &out,
            "--shapes",
            "--threads",
            threads,
        ]);
        (stdout(&output), snapshot(Path::new(&out)))
    };
    assert!(of("1") == of("3"));
}

/// Closures that end at the iteration limit are marked and unranked, and the program says so by its status.
#[test]
fn what_is_not_certified_is_status_3() {
    let folder = Folder::new("plan-limit");
    let valve = folder.preset("valve", "dilated", &[]);
    let scene = Path::new(&valve).join("scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    let default = format!("iteration_limit = {}", Settings::default().iteration_limit);
    let limited = text.replace(&default, "iteration_limit = 3");
    assert!(limited != text, "{text}");
    std::fs::write(&scene, limited).unwrap();
    let rings = plan(&folder, "plan.toml", &format!("{RING}size_mm = [28, 30]\n"));
    let output = coapt(&["plan", &valve, &rings]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let text = stdout(&output);
    assert_eq!(
        text.matches("NOT CERTIFIED: the iteration limit came first")
            .count(),
        3,
        "{text}"
    );
    assert!(
        text.contains("not ranked") && !text.contains("   1  ring"),
        "{text}"
    );
}

#[test]
fn wrong_plans_are_status_2_with_their_lines() {
    let folder = Folder::new("plan-wrong");
    for (name, rest, options, told) in [
        (
            "none.toml",
            "",
            &[][..],
            "none.toml: repair is missing; expected at least one [[repair]] or [[alternative.repair]]",
        ),
        (
            "all.toml",
            &*format!("{RING}size_mm = [10, 11]\n"),
            &[],
            "all.toml:7: alternative[0].repair[0].size_mm",
        ),
        (
            "many.toml",
            &format!("{RING}size_mm = [28, 30, 32]\n"),
            &["--max-alternatives", "2"],
            "many.toml has 3 alternatives, the product of its lists and ranges; expected 2 at most (--max-alternatives)",
        ),
        (
            "item.toml",
            &format!("{RING}size_mm = [28,\n\"30\"]\n"),
            &[],
            "item.toml:8: alternative[0].repair[0].size_mm[1]",
        ),
        (
            "out.toml",
            &format!("{RING}size_mm = 28\n"),
            &["--shapes"],
            "--out <DIR>",
        ),
    ] {
        let file = plan(&folder, name, rest);
        let output = coapt(&[&["plan", "dilated", &file], options].concat());
        assert_eq!(output.status.code(), Some(2), "{name}: {}", stdout(&output));
        assert!(stderr(&output).contains(told), "{name}: {}", stderr(&output));
        assert!(stdout(&output).is_empty());
    }
    // All that is wrong is told, of each alternative, before anything is closed; what does not fit is no fault of the plan.
    let clips =
        "[[alternative]]\n[[alternative.repair]]\nkind = \"clip\"\nposition = [0.02, 1.5]\nangle_deg = 60\n";
    let some = plan(
        &folder,
        "some.toml",
        &format!("{RING}size_mm = [28, 10]\n{clips}"),
    );
    let output = coapt(&["plan", "dilated", &some]);
    assert_eq!(output.status.code(), Some(2), "{}", stdout(&output));
    let told = stderr(&output);
    for words in [
        "some.toml:7: alternative[0].repair[0].size_mm",
        "some.toml:11: alternative[1].repair[0].position is 1.5, expected 0",
        "some.toml:12: alternative[1].repair[0].angle_deg is 60, expected -45 to 45",
    ] {
        assert_eq!(told.matches(words).count(), 1, "{words}: {told}");
    }
    assert!(
        !told.contains("commissure;") && !told.contains("closures"),
        "{told}"
    );
    // Where this valve allows none of them, nothing is closed either, nor said to be.
    let clips = "[[alternative]]\n[[alternative.repair]]\nkind = \"clip\"\nposition = [0.02, 0.98]\n";
    let none = plan(&folder, "none.toml", clips);
    let output = coapt(&["plan", "dilated", &none]);
    assert_eq!(output.status.code(), Some(2), "{}", stdout(&output));
    let told = stderr(&output);
    assert!(
        told.contains("none.toml:6: alternative[0].repair[0].position"),
        "{told}"
    );
    assert!(!told.contains("closures") && stdout(&output).is_empty(), "{told}");
    let two = plan(&folder, "two.toml", &format!("{RING}size_mm = [28, 30]\n"));
    let output = coapt(&["closure", "dilated", "--plan", &two]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output)
            .contains("two.toml has 2 alternatives; expected one (`coapt plan SCENE PLAN` compares several)"),
        "{}",
        stderr(&output)
    );
    // One alternative is a plan as any other.
    let one = plan(&folder, "one.toml", &format!("{RING}size_mm = [30]\n"));
    let output = coapt(&["closure", "dilated", "--plan", &one]);
    assert!(
        stdout(&output).contains("repair: ring saddle, size 30 mm"),
        "{}",
        stderr(&output)
    );
}

/// The example of `docs/plans.md`: the largest ring that gives 8 mm at A2-P2, which `closure` confirms.
#[test]
fn the_ring_with_the_smallest_reduction_is_found() {
    let folder = Folder::new("plan-search");
    let page =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/plans.md")).unwrap();
    let mut plans = page
        .split("```toml\n")
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap());
    let text = plans.find(|text| text.contains("[search]")).unwrap();
    let file = folder.file("plan.toml", text);
    let output = coapt(&["plan", "dilated", &file, "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let found = &report["search"];
    let size_mm = found["answer"]["value"].as_f64().unwrap();
    assert!(
        (26.0..28.0).contains(&size_mm) && found["answer"]["certified"] == true,
        "{found}"
    );
    let with = |size_mm: f64| -> f64 {
        let ring = format!("physio-like:{size_mm}");
        let closed = stdout(&coapt(&[
            "closure", "dilated", "--ring", &ring, "--format", "json",
        ]));
        let closed: Value = serde_json::from_str(&closed).unwrap();
        closed["after"]["coaptation"]["length_a2p2_mm"].as_f64().unwrap()
    };
    assert_eq!(Some(with(size_mm)), found["answer"]["measured"].as_f64());
    let tried = found["tried"].as_array().unwrap();
    let at = tried
        .iter()
        .position(|tried| tried["value"] == found["answer"]["value"])
        .unwrap();
    let before = &tried[at - 1];
    assert!(
        before["measured"].as_f64().unwrap() < 8.0 && before["value"].as_f64().unwrap() - size_mm <= 0.05,
        "{before}"
    );
}

/// All that can be asked for at the command line, in the same bytes at any number of threads; what is kept for rates alone is not written.
#[test]
fn more_can_be_asked_for_at_the_command_line() {
    let folder = Folder::new("plan-asked");
    let valve = folder.preset("valve", "dilated", &[]);
    let rings = plan(&folder, "plan.toml", &format!("{RING}size_mm = [28, 32]\n"));
    let of = |threads: &str| {
        let out = folder.path(threads);
        let asked = ["--diastole", "--sensitivities", "--samples", "3", "--seed", "2"];
        let output = coapt(
            &[
                &["plan", &valve, &rings, "--out", &out, "--threads", threads][..],
                &asked,
            ]
            .concat(),
        );
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stderr(&output).contains("9 samples in "), "{}", stderr(&output));
        (stdout(&output), snapshot(Path::new(&out)))
    };
    let (text, files) = of("1");
    assert!((text.clone(), files.clone()) == of("2"));
    for words in [
        "valves like this one (",
        "per mm of repair[0].size: ",
        "open without pressure: ",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(
        !files.keys().any(|name| name.starts_with("shapes")),
        "{:?}",
        files.keys()
    );
    let alone = coapt(&["plan", &valve, &rings, "--seed", "2"]);
    assert_eq!(alone.status.code(), Some(2));
    assert!(
        stderr(&alone).contains("--seed is given without an ensemble; expected --samples beside it"),
        "{}",
        stderr(&alone)
    );
}

#[test]
fn a_search_for_what_is_not_measured_is_status_2_with_its_line() {
    let folder = Folder::new("plan-search-wrong");
    let goal = "[search]\nalternative = 0\nkey = \"size_mm\"\nfrom = 36\nto = 24\ntolerance = 0.1\nmeasure = \"coaptation/length\"\nat_least = 8\n";
    let file = plan(&folder, "plan.toml", &format!("{RING}size_mm = 30\n{goal}"));
    let output = coapt(&["plan", "dilated", &file]);
    assert!(!stderr(&output).contains("search in "), "{}", stderr(&output));
    assert_eq!(output.status.code(), Some(2), "{}", stdout(&output));
    assert!(
        stderr(&output)
            .contains("plan.toml:14: search.measure is `coaptation/length`, which is not measured"),
        "{}",
        stderr(&output)
    );
}

/// The ends of a range are told by their own keys.
#[test]
fn a_search_from_where_no_repair_is_names_the_end() {
    let folder = Folder::new("plan-search-ends");
    let goal = "[search]\nalternative = 0\nkey = \"size_mm\"\nfrom = 0\nto = 24\ntolerance = 0.1\nmeasure = \"orifice\"\nat_most = 8\n";
    let file = plan(&folder, "plan.toml", &format!("{RING}size_mm = 30\n{goal}"));
    let output = coapt(&["plan", "dilated", &file]);
    assert_eq!(output.status.code(), Some(2), "{}", stdout(&output));
    assert!(
        stderr(&output)
            .contains("plan.toml:11: search.from is 0, at which alternative[0].repair[0].size_mm: 0 mm is"),
        "{}",
        stderr(&output)
    );
}
