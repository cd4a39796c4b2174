//! What is told of a small comparison, and its files.

mod asked;
mod repaired;

use std::path::Path;
use std::path::PathBuf;

use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::plan::{Settings, compare};

use super::*;
use crate::mesh::read_mesh;
use crate::page::{page_of_plan, read_page};
use crate::scene::alternatives_from_text;

/// Two rings that hold, one of which widens the annulus, and one of 10 mm, which belongs to no mitral valve.
const PLAN: &str = "schema_version = 1\nname = \"rings\"\n[[alternative]]\n[[alternative.repair]]\nkind = \"ring\"\n\
                    family = \"saddle\"\nsize_mm = [28, 10, 44]\n";
const FILE: PlanFile = PlanFile {
    name: "plan.toml",
    text: PLAN,
};

pub(crate) struct Compared {
    pub(crate) model: Model,
    pub(crate) plan: Alternatives,
    pub(crate) comparison: Comparison,
}

fn compared() -> Compared {
    compared_with(PLAN, false)
}

pub(crate) fn compared_with(plan: &str, diastole: bool) -> Compared {
    let parameters = ValveParameters {
        face_count_target: 200,
        name: "a, \"b\"".into(),
        ..ValveParameters::preset(Preset::Dilated)
    };
    let model = Model::build(&generate(&parameters).unwrap()).unwrap().model;
    let (plan, _) = alternatives_from_text(Path::new("plan.toml"), plan, 10).unwrap();
    let settings = Settings {
        keep_positions: true,
        passage: true,
        warm: false,
        diastole,
        criteria: plan.ranked_by(),
    };
    let comparison = compare(&model, &plan.alternatives, &settings);
    Compared {
        model,
        plan,
        comparison,
    }
}

pub(crate) fn report(of: &Compared) -> PlanReport {
    PlanReport::new(
        &of.model,
        FILE,
        &of.plan,
        &of.comparison,
        &[Fault::warning("scene.toml:3", "leaflets: turned")],
    )
}

/// As if the first ranked alternative had not been certified.
fn spoilt() -> PlanReport {
    let mut compared = compared();
    let row = &mut compared.comparison.rows[0];
    row.rank = None;
    row.result.as_mut().unwrap().status = Status::Stalled;
    report(&compared)
}

/// A comparison in memory makes the page that its files make, of all alternatives or of the first; without shapes it makes none.
#[test]
fn memory_and_files_make_the_same_page() {
    let of = compared();
    let report = report(&of);
    let mut shapes = Shapes::from(of.comparison);
    let folder = std::env::temp_dir().join(format!("coapt-plan-page-{}", std::process::id()));
    write_plan(&folder, &report, &of.model, &shapes).unwrap();
    for most in [30, 1] {
        let page = page_of_plan(&report, &of.model, &shapes, most).unwrap();
        assert_eq!(page.states.len(), 1 + most.min(2));
        assert_eq!(page, read_page(&folder, most).unwrap());
    }
    std::fs::remove_dir_all(&folder).unwrap();
    shapes.before_mm.clear();
    let faults = page_of_plan(&report, &of.model, &shapes, 30).unwrap_err();
    assert!(faults[0].message.contains("holds no closed shapes"), "{faults:?}");
}

#[test]
fn the_table_has_before_then_ranks_then_what_failed_and_why() {
    let text = text(&report(&compared()));
    let at = |words: &str| text.find(words).unwrap_or_else(|| panic!("{words}: {text}"));
    assert!(
        text.starts_with("a, \"b\", plan \"rings\": 3 alternatives compared at 100 mmHg"),
        "{text}"
    );
    let order = [
        "ranked by: orifice",
        "before ",
        "   1  ring 28 ",
        "   2  ring 44 ",
        "not ranked",
        "   -  ring 10\n",
    ];
    let places: Vec<usize> = order.iter().map(|words| at(words)).collect();
    assert!(places.is_sorted(), "{places:?} {text}");
    assert!(
        at("REFUSED: plan.toml:7: alternative[0].repair[0].size_mm: 10 mm is") > at("ring 10\n"),
        "{text}"
    );
    assert!(
        at("warning: scene.toml:3: leaflets: turned") < at("warning: ring 44: plan.toml:4: alternative"),
        "{text}"
    );
    assert!(text.ends_with("\nresearch use, not a medical device\n"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    // Values and changes stand under their heads.
    let ends = |start: &str| {
        text.lines()
            .find(|line| line.starts_with(start))
            .map(|line| line.chars().count())
    };
    assert_eq!(ends("rank  "), ends("   1  "), "{text}");
}

/// Names differ at their ends: none is cut.
#[test]
fn a_long_name_has_a_line_of_its_own() {
    let mut report = report(&compared());
    let short = text(&report);
    let values = short
        .lines()
        .find(|line| line.starts_with("   1  ring 28 "))
        .unwrap();
    report.alternatives[0].name = "long ".repeat(9) + "28";
    let long = text(&report);
    let start = format!("   1  {}28\n{:36}", "long ".repeat(9), "");
    assert!(long.contains(&(start + &values[36..])), "{long}");
}

#[test]
fn what_is_not_certified_is_marked_and_out_of_the_ranking() {
    let report = spoilt();
    assert!(!report.certified());
    let text = text(&report);
    assert!(
        text.contains("      NOT CERTIFIED: the solver made no progress any more\n"),
        "{text}"
    );
    let line = csv(&report);
    let line = line
        .lines()
        .find(|line| line.contains("ring 28"))
        .unwrap()
        .to_owned();
    assert!(
        line.starts_with("1,,ring 28,false,stalled,the solver made no progress any more,"),
        "{line}"
    );
    assert!(
        !long_csv(&report).contains("ring 28"),
        "a line there cannot carry a mark"
    );
}

/// As if the valve as it is had not been certified: nothing is told to have changed from it, nor are its figures held against limits.
#[test]
fn from_an_uncertified_valve_nothing_has_changed() {
    let plan =
        "schema_version = 1\n[[alternative]]\n[[alternative.repair]]\nkind = \"clip\"\nsite = \"A2P2\"\n";
    let mut compared = compared_with(plan, false);
    let certified = report(&compared);
    assert_eq!(certified.anatomic_limits.len(), 1);
    compared.comparison.before.status = Status::Stalled;
    let spoilt = report(&compared);
    assert!(spoilt.anatomic_limits.is_empty());
    let [told, doubted] = [text(&certified), text(&spoilt)];
    let row = |text: &str| -> Vec<String> {
        let line = text.lines().find(|line| line.starts_with("   1  clip"));
        line.unwrap_or_else(|| panic!("{text}"))
            .split_whitespace()
            .map(str::to_owned)
            .collect()
    };
    // Rank, two words of a name, then four values each with its change, or without.
    assert_eq!(row(&told).len(), 3 + 8, "{told}");
    assert_eq!(row(&doubted).len(), 3 + 4, "{doubted}");
    assert!(
        doubted.contains("NOT CERTIFIED: the solver made no progress any more"),
        "{doubted}"
    );
}

/// Ranks decide what is filmed; of what has none nothing is.
#[test]
fn what_ranks_first_is_filmed() {
    let mut compared = compared();
    let name = |compared: &Compared| {
        let found = filmed(&compared.plan, &compared.comparison);
        found.map(|alternative| alternative.name.clone())
    };
    assert_eq!(name(&compared).as_deref(), Some("ring 28"));
    for row in &mut compared.comparison.rows {
        row.rank = None;
    }
    assert_eq!(name(&compared), None);
}

#[test]
fn tables_are_whole_and_agree_with_the_json() {
    let report = report(&compared());
    let json: serde_json::Value = serde_json::from_str(&report.json().unwrap()).unwrap();
    let csv = csv(&report);
    let mut lines = csv.lines();
    let heads: Vec<&str> = lines.next().unwrap().split(',').collect();
    for head in [
        "orifice.area_mm2",
        "leaflets.anterior.strain_p95",
        "annulus_force_n.2",
    ] {
        assert!(heads.contains(&head), "{heads:?}");
    }
    let before: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(before[..3], ["0", "", "before"]);
    // What differs has a column, whose cell in the row of the valve as it is is empty; the family is the same in all.
    let size = heads.iter().position(|head| *head == "ring.size_mm").unwrap();
    assert!(
        before[size].is_empty() && !heads.contains(&"ring.family"),
        "{heads:?}"
    );
    let sizes = lines.clone().map(|line| line.split(',').nth(size).unwrap());
    assert_eq!(sizes.take(2).collect::<Vec<_>>(), ["28.0", "44.0"]);
    for line in lines.clone().filter(|line| !line.contains("refused")) {
        assert_eq!(line.split(',').count(), heads.len(), "{line}");
    }
    let refused = lines.clone().last().unwrap();
    assert!(refused.starts_with("2,,ring 10,false,refused,"), "{refused}");
    // Each number is the one of the JSON, to the last digit.
    let column = heads.iter().position(|head| *head == "orifice.area_mm2").unwrap();
    let area: f64 = lines
        .next()
        .unwrap()
        .split(',')
        .nth(column)
        .unwrap()
        .parse()
        .unwrap();
    assert_eq!(
        json["alternatives"][0]["orifice"]["area_mm2"].as_f64(),
        Some(area)
    );
    assert_eq!(json["alternatives"][0]["repairs"][0]["size_mm"], 28.0);
    assert_eq!(json["alternatives"][2]["rank"], serde_json::Value::Null);
    assert_eq!(json["ranking"][0]["bin"], 8.0);
    let long = long_csv(&report);
    assert!(
        long.starts_with(
            "Filename,Phase,Measurement,Value\n\"a, \"\"b\"\": before\",MS,ValveType,MitralValve\n"
        ),
        "{long}"
    );
    let units = units_csv();
    // Each measure of three closures has its unit; the three of the open valve were not asked for.
    assert_eq!(long.lines().count(), 1 + 3 * (units.lines().count() - 3));
    for line in long.lines().skip(1).filter(|line| !line.contains("ValveType")) {
        let measurement = line.rsplit(',').nth(1).unwrap();
        assert!(
            units
                .lines()
                .any(|unit| unit.starts_with(&format!("{measurement},"))),
            "{line}"
        );
    }
}

#[test]
fn files_replace_those_of_an_earlier_comparison_and_nothing_else() {
    let folder: PathBuf = std::env::temp_dir().join(format!("coapt-plan-{}", std::process::id()));
    let compared = compared();
    let report = report(&compared);
    let write = |comparison: &Comparison| {
        write_plan(
            &folder,
            &report,
            &compared.model,
            &Shapes::from(comparison.clone()),
        )
        .unwrap();
        let mut names: Vec<String> = std::fs::read_dir(folder.join("shapes"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    let shapes = ["0000_before", "0001_ring-28", "0003_ring-44"];
    let files = shapes.iter().flat_map(|name| {
        let endings: &[&str] = match *name {
            "0000_before" => &[".vtp", "_chords.vtp"],
            _ => &[".vtp", "_chords.vtp", "_ring.vtp"],
        };
        endings.iter().map(move |ending| format!("{name}{ending}"))
    });
    assert_eq!(write(&compared.comparison), files.collect::<Vec<_>>());
    let first = std::fs::read(folder.join("plan.json")).unwrap();
    let (shape, _) = read_mesh(&folder.join("shapes/0001_ring-28.vtp")).unwrap();
    assert_eq!(shape.triangles, compared.model.faces);
    std::fs::write(folder.join("shapes/mine.vtp"), "").unwrap();
    let mut without = compared.comparison.clone();
    without.before.positions_mm.clear();
    without
        .rows
        .iter_mut()
        .flat_map(|row| &mut row.result)
        .for_each(|outcome| outcome.positions_mm.clear());
    assert_eq!(write(&without), ["mine.vtp"]);
    assert_eq!(first, std::fs::read(folder.join("plan.json")).unwrap());
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn places_in_a_repair_become_places_in_the_plan() {
    for (place, there) in [
        ("ring", "repair[1]"),
        ("ring.size_mm", "repair[1].size_mm"),
        ("ring.curve_mm point 3", "repair[1].curve_mm point 3"),
        ("clip vertex 3.5", "repair[1] vertex 3.5"),
    ] {
        assert_eq!(in_plan("repair[1]", &Fault::error(place, "x")).place, there);
    }
}

/// A row may have two of a kind, points have a cell for each coordinate, curves none; what a row lacks is empty.
#[test]
fn what_tells_alternatives_apart_has_a_column() {
    let mut report = report(&compared());
    let repairs = [
        r#"[{"kind": "clip", "position": 0.4}, {"kind": "clip", "position": 0.6, "model": "rigid"}]"#,
        r#"[{"kind": "cut-chord", "near_mm": [1, 2, 3.5]}, {"kind": "clip", "position": 0.4}]"#,
        r#"[{"kind": "ring", "curve_mm": [[1, 2, 3], [4, 5, 6], [7, 8, 9], [1, 1, 1]]}]"#,
    ];
    for (row, repairs) in report.alternatives.iter_mut().zip(repairs) {
        row.repairs = serde_json::from_str(repairs).unwrap();
    }
    let csv = csv(&report);
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| -> Vec<&str> {
        let at = lines[0].iter().position(|head| *head == name);
        let at = at.unwrap_or_else(|| panic!("{name}: {:?}", lines[0]));
        lines[2..4].iter().map(|line| line[at]).collect()
    };
    assert_eq!(column("clip.position"), ["0.4", "0.4"]);
    assert_eq!(column("clip.2.position"), ["0.6", ""]);
    assert_eq!(column("clip.2.model"), ["rigid", ""]);
    assert_eq!(column("cut-chord.near_mm.2"), ["", "3.5"]);
    assert!(
        !csv.contains("curve_mm"),
        "{}",
        csv.lines().next().unwrap_or_default()
    );
}
