//! What is told of open valves, ensembles, rates and searches.

use coapt::plan::ensemble::Probability;
use coapt::plan::{CHORD_SCALE, Rates, Sampling, summaries};
use coapt::search::{Found, Tried};

use super::*;

/// The open valve has a column, its openings and gradient a line, CSV and JSON its numbers; what is not certified has none.
#[test]
fn the_open_valve_is_told_where_it_is_certified() {
    let mut compared = compared_with(&format!("diastole = true\n{PLAN}"), true);
    let report = report(&compared);
    let told = text(&report);
    for words in [
        "open orifice",
        "      open without pressure: 1 opening; mean gradient at most ",
        " % of what opened before; mean gradient at most ",
        "orifice in steps of 8 mm², then open orifice, by how often it is halved from 400 mm², then coaptation at A2-P2",
        "they compare repairs, are no mitral valve area, and no limit for one is held against them",
    ] {
        assert!(
            told.split_whitespace()
                .collect::<Vec<_>>()
                .join(" ")
                .contains(words.trim()),
            "{words}: {told}"
        );
    }
    assert!(told.lines().all(|line| line.chars().count() <= 100), "{told}");
    let json: serde_json::Value = serde_json::from_str(&report.json().unwrap()).unwrap();
    let area = json["before"]["diastole"]["area_mm2"].as_f64().unwrap();
    let head = csv(&report).lines().next().unwrap().to_owned();
    for column in [
        "diastole.area_mm2",
        "diastole.openings_mm2.0",
        "diastole.mean_gradient_mmhg",
        "regurgitant_volume_ml.1",
    ] {
        assert!(head.split(',').any(|it| it == column), "{column}: {head}");
    }
    // No measure's name holds a comma, which would be read as the end of it.
    assert!(units_csv().lines().all(|line| line.split(',').count() == 2));
    assert!(long_csv(&report).contains(&format!(",Orifice area without pressure,{area}\n")));
    let open = compared.comparison.rows[0]
        .result
        .as_mut()
        .unwrap()
        .diastole
        .as_mut()
        .unwrap();
    // As if it opened to six square millimetres: hundreds of times that gradient are no figure, and the rank does not hide it.
    let kept = open.clone();
    open.orifice.as_mut().unwrap().area_mm2 = 6.0;
    open.mean_gradient_mmhg = coapt::measure::flow::mean_diastolic_gradient_mmhg(6.0, &Default::default());
    let narrow = self::report(&compared);
    let told = text(&narrow).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        told.contains("; HARDLY OPENS: through 6 mm², under 50, no gradient is told"),
        "{told}"
    );
    let json = serde_json::to_value(&narrow).unwrap();
    let opened = &json["alternatives"][0]["diastole"];
    assert_eq!(
        (&json["alternatives"][0]["rank"], &opened["hardly_opens"]),
        (&1.into(), &true.into())
    );
    assert!(opened.get("mean_gradient_mmhg").is_none());
    assert_eq!(json["before"]["diastole"]["hardly_opens"], false);
    let table = csv(&narrow);
    let mut lines = table.lines();
    let column = lines
        .next()
        .unwrap()
        .split(',')
        .position(|head| head == "diastole.mean_gradient_mmhg");
    let cells: Vec<&str> = lines
        .map(|line| line.split(',').nth(column.unwrap()).unwrap())
        .collect();
    assert!(
        cells[0].parse::<f64>().is_ok() && cells[1].is_empty(),
        "{cells:?}"
    );
    let open = compared.comparison.rows[0]
        .result
        .as_mut()
        .unwrap()
        .diastole
        .as_mut()
        .unwrap();
    *open = kept;
    (open.status, open.orifice, open.mean_gradient_mmhg) = (Status::Stalled, None, None);
    let lost = self::report(&compared);
    assert!(!lost.certified());
    let told = text(&lost);
    assert!(
        told.contains("      open valve NOT CERTIFIED: the solver made no progress any more\n"),
        "{told}"
    );
    assert_eq!(
        serde_json::to_value(&lost).unwrap()["alternatives"][0]["diastole"].get("area_mm2"),
        None
    );
}

/// Before and the best have an ensemble, in words, in JSON and in CSV; what is not counted is told.
#[test]
fn ensembles_are_told_as_a_surgeon_reads_them() {
    let compared = compared();
    let sampling = Sampling {
        samples: 4,
        alternatives: 1,
        ..Sampling::default()
    };
    let look = |_: &coapt::plan::Progress| std::ops::ControlFlow::Continue(());
    let (alternatives, comparison) = (&compared.plan.alternatives, &compared.comparison);
    let found = summaries(&compared.model, alternatives, comparison, &sampling, &look);
    let mut report = report(&compared).with_ensembles(&found);
    assert!(
        report.alternatives[0]
            .closed
            .as_ref()
            .unwrap()
            .uncertainty
            .is_some()
    );
    assert!(
        report.alternatives[1]
            .closed
            .as_ref()
            .unwrap()
            .uncertainty
            .is_none()
    );
    let json = serde_json::to_value(&report).unwrap();
    let sampled = &json["before"]["uncertainty"];
    assert!(
        sampled["orifice"]["median"].is_number() && sampled["samples"] == 4,
        "{sampled}"
    );
    let head = csv(&report).lines().next().unwrap().to_owned();
    assert!(
        head.contains(",uncertainty.coaptation_length_a2p2.low,")
            && head.contains(",uncertainty.sealed.estimate,")
    );
    let sampled = report.before.uncertainty.as_mut().unwrap();
    (sampled.samples, sampled.certified, sampled.refused) = (200, 190, 3);
    sampled.in_doubt = 12;
    sampled.sealed = Some(Probability {
        estimate: 0.93,
        low: 0.884,
        high: 0.957,
    });
    let told = text(&report);
    assert!(
        told.contains("      seals in 93 % of 190 valves like this one (88 to 96 %)\n"),
        "{told}"
    );
    assert!(told.contains("      median (nine of ten): orifice "), "{told}");
    let words = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains("of 190 valves 12 leave their orifice in doubt: more can pass"),
        "{told}"
    );
    assert!(
        told.contains(
            "of 200 valves 7 closed without a certificate and 3 could not be repaired: they are not counted"
        ),
        "{told}"
    );
    let sampled = report.before.uncertainty.as_mut().unwrap();
    (sampled.certified, sampled.sealed) = (0, None);
    assert!(text(&report).contains("none of 200 valves like this one closed with a certificate"));
}

#[test]
fn rates_are_told_per_unit_of_each_number() {
    let compared = compared();
    let of = |row: &coapt::plan::Row| {
        let outcome = row.result.as_ref().ok()?;
        Some(rates_of(
            &compared.model,
            &compared.plan.alternatives[row.alternative].repairs,
            outcome,
        ))
    };
    let rows: Vec<_> = compared.comparison.rows.iter().map(of).collect();
    let before = Ok(vec![Rates {
        key: CHORD_SCALE.into(),
        value: 1.0,
        rates: Err(vec![Fault::error("closure", "is not in a stable balance")]),
    }]);
    let report = report(&compared).with_rates(&before, &rows);
    let best = report.alternatives[0].closed.as_ref().unwrap();
    let rate = &best.sensitivities.as_ref().unwrap()["repair[0].size_mm"];
    assert_eq!(rate.value, 28.0);
    let told = text(&report);
    let length = rate.per_unit["coaptation_length_a2p2"];
    let words = format!("coaptation at A2-P2 {length:+.2} mm");
    assert!(
        told.contains("      per mm of repair[0].size: orifice ") && told.contains(&words),
        "{words}: {told}"
    );
    assert!(
        told.contains("      per 1 % of length of all chordae: "),
        "{told}"
    );
    assert!(
        told.contains(
            "      per 1 % of length of all chordae: no rates, closure is not in a stable balance\n"
        ),
        "{told}"
    );
    let head = csv(&report).lines().next().unwrap().to_owned();
    assert!(
        head.contains(",sensitivities.repair[0].size_mm.coaptation_length_a2p2,"),
        "{head}"
    );
}

/// A criterion and a path mean the same measure; more and less are both sought; what there is not is told with what was meant.
#[test]
fn goals_are_reached_and_told() {
    let goal = |measure: &str, bound: &str| {
        format!(
            "{}[search]\nalternative = 0\nkey = \"size_mm\"\nfrom = 36\nto = 26\ntolerance = 0.1\nmeasure = \"{measure}\"\n{bound}\n",
            PLAN.replace("[28, 10, 44]", "30")
        )
    };
    let compared = compared();
    let seek = |text: &str| {
        let (plan, _) = alternatives_from_text(Path::new("plan.toml"), text, 10).unwrap();
        found(&compared.model, &plan.asked.search.unwrap(), &|_| {
            std::ops::ControlFlow::Continue(())
        })
    };
    let by_path = seek(&goal("coaptation/length_a2p2_mm", "at_least = 5")).unwrap();
    let by_name = seek(&goal("coaptation_length_a2p2", "at_least = 5")).unwrap();
    assert_eq!(by_path.tried, by_name.tried);
    let answer = by_path.answer.unwrap();
    assert!(answer.certified && answer.measured >= 5.0 && by_path.repairs.len() == 1);
    let ring = serde_json::to_value(&by_path.repairs[0]).unwrap();
    assert_eq!(ring["size_mm"].as_f64(), Some(answer.value));
    let mut report = report(&compared);
    report.search = Some(by_path);
    let told = text(&report);
    let start = format!(
        "search: the first `size_mm` of alternative[0].repair[0] from 36 to 26 that gives coaptation at A2-P2 of 5 mm or more is {:.3}",
        answer.value
    );
    let flat = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(flat.contains(&start) && told.contains("  the answer\n"), "{told}");
    assert!(
        told.contains("\n     size_mm  coaptation at A2-P2 [mm]\n"),
        "{told}"
    );
    let less = seek(&goal("annulus.ap_mm", "at_most = 26")).unwrap();
    let answer = less.answer.unwrap();
    assert!(answer.measured <= 26.0 && answer.measured > 25.0, "{less:?}");
    let never = seek(&goal("orifice", "at_most = -1")).unwrap();
    assert_eq!((never.answer, never.repairs.len()), (None, 0));
    report.search = Some(never);
    let told = text(&report);
    let flat = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        flat.contains("that was tried gives orifice of -1 mm² or less"),
        "{told}"
    );
    let faults = seek(&goal("coaptation/length_a2p2", "at_least = 5")).unwrap_err();
    assert_eq!(
        sentence(&faults[0]),
        "search.measure is `coaptation/length_a2p2`, which is not measured; did you mean `coaptation.length_a2p2_mm`?"
    );
    let faults = seek(&goal("orifice", "at_most = 8").replace("to = 26", "to = 6")).unwrap_err();
    assert_eq!(
        sentence(&faults[0]),
        "search.to is 6, at which alternative[0].repair[0].size_mm: 6 mm is out of range, expected 20 to 44 mm"
    );
}

/// The answer of a search is closed as an alternative: a row with all criteria, marked in text, JSON and CSV, with a shape of its own; where
/// an alternative of the plan is the answer, that one is marked.
#[test]
fn the_answer_of_a_search_has_a_row() {
    let goal = |from: f64| {
        format!(
            "diastole = true\n{}[search]\nalternative = 0\nkey = \"size_mm\"\nfrom = {from}\nto = 26\ntolerance = 0.1\nmeasure = \
             \"coaptation_length_a2p2\"\nat_least = 5\n",
            PLAN.replace("[28, 10, 44]", "28")
        )
    };
    let compared = compared();
    let look = |_: &coapt::plan::Progress| std::ops::ControlFlow::Continue(());
    let on_stage = |_, work: &mut dyn FnMut(coapt::plan::Watch)| work(&look);
    let carried = |text: &str| {
        let (mut plan, _) = alternatives_from_text(Path::new("plan.toml"), text, 10).unwrap();
        let file = PlanFile {
            name: "plan.toml",
            text,
        };
        let (report, comparison) = carry_out(&compared.model, file, &mut plan, true, &[], &on_stage).unwrap();
        (report, comparison)
    };
    let (report, comparison) = carried(&goal(36.0));
    let answer = report.search.as_ref().unwrap().answer.unwrap();
    let row = report
        .alternatives
        .iter()
        .find(|row| row.found_by_search)
        .unwrap();
    assert_eq!((report.alternatives.len(), row.number), (2, 2));
    assert_eq!(row.name, format!("search: ring size_mm {:.3}", answer.value));
    let closed = row.closed.as_ref().unwrap();
    // Closed again from the open valve, to the same bits.
    assert_eq!(closed.measures.coaptation.length_a2p2_mm, answer.measured);
    assert!(row.rank.is_some() && closed.diastole.as_ref().unwrap().area_mm2.is_some());
    let told = text(&report);
    assert_eq!(told.matches("\n      FOUND BY SEARCH\n").count(), 1, "{told}");
    assert!(told.contains("  search: ring size_mm "), "{told}");
    let json: serde_json::Value = serde_json::from_str(&report.json().unwrap()).unwrap();
    let found: Vec<bool> = json["alternatives"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["found_by_search"] == true)
        .collect();
    assert_eq!(found.iter().filter(|found| **found).count(), 1);
    let csv = csv(&report);
    let line = csv.lines().find(|line| line.contains("search: ring")).unwrap();
    assert_eq!(line.split(',').nth(12), Some("true"), "{line}");
    assert!(csv.lines().next().unwrap().split(',').nth(12) == Some("found_by_search"));
    let folder = std::env::temp_dir().join(format!("coapt-plan-search-{}", std::process::id()));
    write_plan(&folder, &report, &compared.model, &Shapes::from(comparison)).unwrap();
    let page = crate::page::page_html(&read_page(&folder, 30).unwrap()).unwrap();
    let shapes: Vec<PathBuf> = std::fs::read_dir(folder.join("shapes"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(page.contains(" <span class=\"found\">FOUND BY SEARCH</span>"));
    assert!(page.contains("<th scope=\"col\">coaptation at A2-P2 [mm]</th>"));
    assert!(
        shapes
            .iter()
            .any(|path| path.to_string_lossy().contains("0002_search-ring-size-mm-")),
        "{shapes:?}"
    );
    // From 28 on the first value tried is the alternative that stands there.
    let (report, _) = carried(&goal(28.0));
    assert_eq!(report.alternatives.len(), 1);
    assert!(report.alternatives[0].found_by_search && report.alternatives[0].name.starts_with("ring"));
}

/// A goal that is reached and lost again among the values tried is told with the first at which it is lost.
#[test]
fn a_goal_that_is_lost_again_is_told() {
    let compared = compared();
    let tried = |value: f64, measured: f64, certified: bool| Tried {
        value,
        measured,
        certified,
    };
    let found = Found {
        answer: Some(tried(34.0, 8.2, true)),
        tried: vec![
            tried(36.0, 6.0, true),
            tried(34.0, 8.2, true),
            tried(30.0, 7.5, true),
            tried(28.0, 9.0, true),
        ],
    };
    assert_eq!(found.lost_again(8.0), Some(tried(30.0, 7.5, true)));
    assert_eq!(found.lost_again(7.0), None);
    let mut report = report(&compared);
    report.search = Some(SearchReport {
        place: "repair[0]".into(),
        key: "size_mm".into(),
        from: 36.0,
        to: 28.0,
        tolerance: 0.1,
        measure: "coaptation_length_a2p2".into(),
        at_least: Some(8.0),
        at_most: None,
        answer: found.answer,
        lost_again: found.lost_again(8.0),
        repairs: Vec::new(),
        tried: found.tried,
    });
    let flat = text(&report).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        flat.contains("beyond it the goal is lost again: 30.000 gives 7.500"),
        "{flat}"
    );
}

/// Published limits are information beside the figure that they are about, for plans with the repair that they are about.
#[test]
fn limits_of_the_anatomy_are_told_of_the_valve_before() {
    let mut compared = compared();
    assert!(report(&compared).anatomic_limits.is_empty() && !text(&report(&compared)).contains("EACVI"));
    let clip = serde_json::from_str(r#"{"kind": "clip", "site": "A2P2"}"#).unwrap();
    compared.plan.alternatives[0].repairs.push(clip);
    let report = report(&compared);
    let limit = &report.anatomic_limits[0];
    assert_eq!(limit.value, report.before.measures.coaptation.length_a2p2_mm);
    assert!(
        text(&report)
            .contains("anatomy: for edge-to-edge repair EACVI asks for a coaptation length of 2 mm or more")
    );
}
