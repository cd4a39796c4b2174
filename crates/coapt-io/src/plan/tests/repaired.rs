//! What is told below a row of what its repairs did: folds, rings as laid, lengths that were chosen, slack strands.

use super::*;

/// Folds that a repair brings are told, where there are enough of them and the valve is certified.
#[test]
fn folds_that_a_repair_brings_are_told() {
    let mut compared = compared();
    let folds_of = |compared: &Compared| text(&report(compared)).matches("FOLDS:").count();
    assert_eq!(folds_of(&compared), 0);
    let coaptation = |compared: &mut Compared, mm2: f64| {
        let outcome = compared.comparison.rows[0].result.as_mut().unwrap();
        outcome.measures.coaptation.self_contact_area_mm2 = mm2;
    };
    let before_mm2 = compared
        .comparison
        .before
        .measures
        .coaptation
        .self_contact_area_mm2;
    coaptation(&mut compared, before_mm2 + 24.0);
    assert_eq!(folds_of(&compared), 0);
    coaptation(&mut compared, before_mm2 + 40.0);
    let told = text(&report(&compared));
    let words = format!(
        "FOLDS: a leaflet touches itself over {:.0} mm²",
        before_mm2 + 40.0
    );
    assert!(told.contains(&words), "{told}");
    assert!(told.lines().all(|line| line.chars().count() <= 100), "{told}");
    compared.comparison.rows[0]
        .result
        .as_mut()
        .unwrap()
        .certificate
        .stable = false;
    assert_eq!(folds_of(&compared), 0);
}

/// A loop of thirty millimetres on a valve that lacks no chord holds nothing back: row, JSON and CSV say so, and the row that holds does not;
/// of a shape without a certificate nothing is told.
#[test]
fn neochordae_that_hold_nothing_back_are_told() {
    let plan = "schema_version = 1\n[[alternative]]\n[[alternative.repair]]\nkind = \"neochord\"\nleaflet = \"posterior\"\n\
                site = \"A2P2\"\nlength_mm = [30, 10]\n";
    let mut compared = compared_with(plan, false);
    let report = report(&compared);
    let row = |report: &PlanReport, number: usize| {
        let row = report.alternatives.iter().find(|row| row.number == number);
        row.unwrap().closed.clone().unwrap()
    };
    assert_eq!(row(&report, 2).slack_neochordae, [], "one that is taut");
    let line = "SLACK: repair[0], neochord posterior A2P2: no strand bears 0.01 N or more in the closed valve, which closes as without it";
    assert!(below::lines(&row(&report, 1), None).contains(&line.to_owned()));
    let told = text(&report).split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(told.matches("SLACK: ").count(), 1, "{told}");
    assert!(told.contains(line), "{told}");
    // As without it, to the last bit of the orifice.
    assert_eq!(row(&report, 1).measures.orifice, report.before.measures.orifice);
    let json: serde_json::Value = serde_json::from_str(&report.json().unwrap()).unwrap();
    let at = json["alternatives"]
        .as_array()
        .unwrap()
        .iter()
        .find(|row| row["number"] == 1)
        .unwrap();
    assert_eq!(at["slack_neochordae"][0]["repair"], 0);
    assert_eq!(at["slack_neochordae"][0]["slack_strands"], 2);
    let csv = csv(&report);
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let column = lines
        .next()
        .unwrap()
        .iter()
        .position(|head| *head == "slack_neochordae")
        .unwrap();
    let told: Vec<(String, String)> = lines
        .map(|line| (line[0].to_owned(), line[column].to_owned()))
        .collect();
    for (number, count) in [("0", "0"), ("1", "1"), ("2", "0")] {
        assert!(told.contains(&(number.to_owned(), count.to_owned())), "{told:?}");
    }
    for row in &mut compared.comparison.rows {
        row.result.as_mut().unwrap().status = Status::Stalled;
    }
    assert!(!text(&self::report(&compared)).contains("SLACK"));
}

/// Who gives no length has to know what was chosen: the row says it, and not where the length stands in the plan. The files have it
/// either way, beside all that other repairs did.
#[test]
fn a_length_that_was_chosen_is_told() {
    let plan = "schema_version = 1\n[[alternative]]\n[[alternative.repair]]\nkind = \"neochord\"\nleaflet = \"posterior\"\n\
                site = \"A2P2\"\n[[alternative]]\n[[alternative.repair]]\nkind = \"neochord\"\nleaflet = \"posterior\"\n\
                site = \"A2P2\"\nlength_mm = 10\n";
    let report = report(&compared_with(plan, false));
    let strung = |number: usize| {
        let row = report.alternatives.iter().find(|row| row.number == number);
        let closed = row.unwrap().closed.clone().unwrap();
        let [RepairReport::Neochord(neochord)] = &closed.carried_out[..] else {
            panic!("{:?}", closed.carried_out);
        };
        (neochord.length_mm.clone(), below::lines(&closed, None))
    };
    let (chosen_mm, told) = strung(1);
    let words = format!("{:.1} to ", chosen_mm[0].min(chosen_mm[1]));
    let told: Vec<&String> = told
        .iter()
        .filter(|line| line.contains("strands from tip"))
        .collect();
    assert!(
        matches!(told[..], [line] if line.contains(&words)),
        "{told:?} {words}"
    );
    let (given_mm, told) = strung(2);
    assert!(
        given_mm.iter().all(|length_mm| *length_mm == 10.0),
        "{given_mm:?}"
    );
    assert!(
        !told.iter().any(|line| line.contains("strands from tip")),
        "{told:?}"
    );
}

/// A ring is told by its own figures below its row and in the files: those of the annulus do not let its size be recognised.
#[test]
fn the_ring_is_told_as_it_lies() {
    let report = report(&compared());
    let row = report.alternatives.iter().find(|row| row.number == 1).unwrap();
    let closed = row.closed.as_ref().unwrap();
    let laid = closed.ring_laid.unwrap();
    assert!(
        (laid.width_mm - 28.0).abs() < 0.1 && closed.measures.annulus.commissural_mm < 26.0,
        "{laid:?}"
    );
    let told = text(&report);
    let expected = format!(
        "      ring as laid: 28.0 mm across and {:.1} mm from front to back, {:.1} mm high\n",
        laid.depth_mm, laid.height_mm
    );
    assert!(
        laid.height_mm > 1.0 && told.contains(&expected),
        "{expected}{told}"
    );
    let json: serde_json::Value = serde_json::from_str(&report.json().unwrap()).unwrap();
    let rows = json["alternatives"].as_array().unwrap();
    let row = rows.iter().find(|row| row["number"] == 1).unwrap();
    assert_eq!(row["ring_laid"]["height_mm"].as_f64(), Some(laid.height_mm));
    assert_eq!(report.before.ring_laid, None);
    let head = csv(&report).lines().next().unwrap().to_owned();
    assert!(
        head.contains(",ring_laid.depth_mm,ring_laid.height_mm,ring_laid.width_mm,"),
        "{head}"
    );
}
