//! What plans ask for beside their alternatives.

use super::*;

/// What is asked for is read with its defaults; what ranks is computed.
#[test]
fn a_plan_asks_for_more_than_closures() {
    let ring = format!("[[alternative]]\n{RING}size_mm = 28\n");
    assert_eq!(made(&ring).asked, Asked::default());
    let ranked = made(&format!("{ring}[ranking]\ncriteria = [\"diastolic_orifice\"]\n"));
    assert!(ranked.asked.diastole && !ranked.asked.sensitivities);
    let all = made(&format!(
        "diastole = true\nsensitivities = true\nwarm = true\n{ring}[uncertainty]\nsamples = 7\npressure = 0\n"
    ));
    let sampling = all.asked.sampling.unwrap();
    assert!(all.asked.diastole && all.asked.sensitivities && all.asked.warm);
    assert_eq!(
        (sampling.samples, sampling.seed, sampling.alternatives),
        (7, 1, 5)
    );
    assert_eq!(
        (sampling.uncertainty.pressure, sampling.uncertainty.annulus_mm),
        (0.0, 0.7)
    );
    assert_eq!(all.ranked_by(), Criterion::default_with(true));
}

/// Where leaflets are joined edge to edge the open valve ranks second, unless the plan says otherwise.
#[test]
fn a_plan_with_clips_asks_for_the_open_valve() {
    let clip = "[[alternative]]\n[[alternative.repair]]\nkind = \"clip\"\nsite = \"A2P2\"\n";
    let clipped = made(clip);
    assert!(clipped.asked.diastole);
    assert_eq!(
        clipped.ranked_by()[..2],
        [Criterion::Orifice, Criterion::DiastolicOrifice]
    );
    let ring = format!("[[alternative]]\n{RING}size_mm = 28\n");
    for (plan, asks) in [
        (format!("{ring}{clip}"), true),
        (format!("diastole = false\n{clip}"), false),
        (format!("{clip}[ranking]\ncriteria = [\"orifice\"]\n"), false),
        (ring, false),
    ] {
        assert_eq!(made(&plan).asked.diastole, asks, "{plan}");
    }
}

const GOAL: &str =
    "[search]\nkey = \"size_mm\"\nfrom = 36\nto = 24\ntolerance = 0.05\nmeasure = \"orifice\"\nat_most = 8\n";

/// The number of a common repair is sought with these alone, that of an alternative's with all that it does; of lists the first
/// values count. JSON asks for the same.
#[test]
fn a_search_finds_its_repair() {
    let plan = format!(
        "[[repair]]\nkind = \"ring\"\nfamily = \"saddle\"\nsize_mm = [40, 41]\n[[alternative]]\n{RING}size_mm = 30\n{GOAL}"
    );
    let common = made(&plan).asked.search.unwrap();
    assert_eq!(
        (common.place.as_str(), common.repairs.len(), common.repair),
        ("repair[0]", 1, 0)
    );
    assert_eq!(keys_of(&common.repairs[0])["size_mm"], 40.0);
    assert_eq!(
        (common.bound, common.from, common.to),
        (Bound::AtMost(8.0), 36.0, 24.0)
    );
    let own = made(&format!("{plan}alternative = 0\n")).asked.search.unwrap();
    assert_eq!(own.places, ["repair[0]", "alternative[0].repair[0]"]);
    assert_eq!((own.place.as_str(), own.repair), ("alternative[0].repair[0]", 1));
    let json = "{\"schema_version\": 1, \"repair\": [{\"kind\": \"ring\", \"family\": \"saddle\", \"size_mm\": [40, 41]}],\
                \"search\": {\"key\": \"size_mm\", \"from\": 36, \"to\": 24, \"tolerance\": 0.05, \"measure\": \"orifice\",\
                \"at_most\": 8}}";
    assert_eq!(read_all(json).unwrap().asked.search, Some(common));
}

#[test]
fn wrong_wishes_are_told_with_their_lines() {
    let ring = format!("[[alternative]]\n{RING}size_mm = 28\n");
    let own = format!("{ring}{GOAL}alternative = 0\n");
    for (text, told) in [
        (
            own.replace("at_most = 8\n", ""),
            "p.toml:8: search has no goal; expected `at_least` or `at_most`",
        ),
        (
            format!("{own}at_least = 3\n"),
            "p.toml:14: search.at_most is given beside `at_least`",
        ),
        (
            own.replace("to = 24", "to = 36"),
            "p.toml:11: search.to is 36, as is `from`; expected another number",
        ),
        (
            own.replace("to = 24", "to = nan"),
            "p.toml:11: search.to is NaN; expected a number",
        ),
        (
            own.replace("0.05", "0"),
            "p.toml:12: search.tolerance is 0; expected 0.000012 or more, a millionth of the range",
        ),
        (
            own.replace("0.05", "1e-12"),
            "p.toml:12: search.tolerance is 1e-12; expected 0.000012 or more, a millionth of the range",
        ),
        (
            own.replace("\"size_mm\"", "\"sizes_mm\""),
            "p.toml:9: search.key is `sizes_mm`: unknown key `sizes_mm`; did you mean `size_mm`?; expected a key that takes a number, \
             such as `size_mm`",
        ),
        (
            own.replace("\"size_mm\"", "\"family\""),
            "p.toml:9: search.key is `family`, which takes no number; expected",
        ),
        (
            own.replace("\"orifice\"", "\"diastolic_orifice\""),
            "p.toml:13: search.measure is `diastolic_orifice`; expected a measure of the closed valve",
        ),
        (
            own.replace("alternative = 0", "alternative = 3"),
            "p.toml:15: search.alternative is 3; expected the number of an alternative with repairs, from 0",
        ),
        (
            format!("{own}repair = 4\n"),
            "p.toml:16: search.repair is 4; expected the number of one of that alternative's repairs",
        ),
        (
            own.replace("alternative = 0", "repair = 0"),
            "p.toml:15: search.repair is 0; expected the number of a repair that every alternative begins with, from 0, or \
             `alternative` beside it",
        ),
        (
            format!("{ring}[uncertainty]\nsamples = 0\npressure = -1\n"),
            "p.toml:10: uncertainty.pressure is -1; expected 0 to 0.3",
        ),
        (
            format!("{ring}[uncertainty]\nsamples = 0\n"),
            "p.toml:9: uncertainty.samples is 0; expected 1 to 100000",
        ),
    ] {
        let faults = faults(&text);
        assert!(faults[0].starts_with(told), "{told}: {faults:#?}");
    }
}

#[test]
fn numbers_of_repairs_are_found_by_their_type() {
    let ring = made(&format!("[[alternative]]\n{RING}size_mm = 28\nclosed = true\n"))
        .alternatives
        .remove(0)
        .repairs
        .remove(0);
    assert_eq!(number_keys(&ring), [("size_mm".to_owned(), 28.0)]);
    assert_eq!(
        keys_of(&with_number(&ring, "size_mm", 29.5).unwrap())["size_mm"],
        29.5
    );
    assert!(with_number(&ring, "closed", 1.0).is_err());
}
