//! What lists and ranges make of a plan, in which order and by which names, and what is refused.

mod asked;

use super::*;

const START: &str = "schema_version = 1\nname = \"p\"\n";

fn read_all(text: &str) -> Result<Alternatives, Vec<String>> {
    let told = |faults: Vec<Fault>| faults.iter().map(super::super::sentence).collect();
    let read = alternatives_from_text(Path::new("p.toml"), text, ALTERNATIVE_LIMIT);
    read.map(|(read, _)| read).map_err(told)
}

fn faults(text: &str) -> Vec<String> {
    read_all(&format!("{START}{text}")).unwrap_err()
}

fn made(text: &str) -> Alternatives {
    read_all(&format!("{START}{text}")).unwrap_or_else(|faults| panic!("{faults:#?}"))
}

fn names(made: &Alternatives) -> Vec<&str> {
    made.alternatives.iter().map(|it| it.name.as_str()).collect()
}

/// A repair as its file would have it.
fn keys_of(repair: &Repair) -> serde_json::Value {
    serde_json::to_value(repair).unwrap()
}

/// Sizes of all rings of each alternative [mm].
fn sizes(made: &Alternatives) -> Vec<Vec<f64>> {
    let of = |repair: &Repair| keys_of(repair)["size_mm"].as_f64().unwrap();
    let all = made.alternatives.iter();
    all.map(|it| it.repairs.iter().map(of).collect()).collect()
}

const RING: &str = "[[alternative.repair]]\nkind = \"ring\"\nfamily = \"saddle\"\n";

#[test]
fn a_plan_without_alternatives_is_one() {
    let made = made("[[repair]]\nkind = \"ring\"\nfamily = \"saddle\"\nsize_mm = 28\n");
    assert_eq!(made.name, "p");
    assert_eq!(
        (names(&made), sizes(&made)),
        (vec!["ring saddle 28"], vec![vec![28.0]])
    );
    assert_eq!(made.keys, [["repair[0]"]]);
    assert_eq!(
        (made.criteria.as_ref(), made.ranked_by()),
        (None, Criterion::DEFAULT.to_vec())
    );
}

/// A value that a list has twice, as 28 and 28.0 too, and an alternative that does what another does are closed once, and told with file
/// and line; so many alternatives are counted. A search finds its repair all the same.
#[test]
fn what_is_there_twice_is_closed_once_and_told() {
    let read = |text: &str, limit: u64| {
        let text = format!("{START}{text}");
        let read = alternatives_from_text(Path::new("p.toml"), &text, limit);
        let (made, warnings) = read.unwrap_or_else(|faults| panic!("{faults:?}"));
        let told: Vec<String> = warnings.iter().map(super::super::sentence).collect();
        (made, told)
    };
    let text = format!("[[alternative]]\n{RING}size_mm = [28, 30, 28.0, 28]\n");
    let (made, told) = read(&text, 2);
    assert_eq!(sizes(&made), [[28.0], [30.0]]);
    let again = |value: &str| {
        format!("p.toml:7: alternative[0].repair[0].size_mm has {value} again; it is closed once")
    };
    assert_eq!(told, [again("28.0"), again("28")]);
    let goal = "[search]\nalternative = 1\nkey = \"size_mm\"\nfrom = 36\nto = 26\ntolerance = 0.1\nmeasure = \"orifice\"\nat_most = 8\n";
    let text = format!(
        "[[alternative]]\n{RING}size_mm = [28, 30]\n[[alternative]]\nname = \"b\"\n{RING}size_mm = 30\n{goal}"
    );
    let (made, told) = read(&text, 10);
    assert_eq!((sizes(&made), made.keys.len()), (vec![vec![28.0], vec![30.0]], 2));
    assert_eq!(
        made.asked.search.map(|search| search.place).as_deref(),
        Some("alternative[1].repair[0]")
    );
    assert_eq!(
        told,
        ["p.toml:10: alternative[1].repair[0] is done by `ring 30` already; the alternative is closed once"]
    );
    let (made, told) = read(&format!("[[alternative]]\n{RING}size_mm = [28, 30]\n"), 10);
    assert_eq!((made.alternatives.len(), told.len()), (2, 0));
}

/// What is done otherwise than a plan says is told with its line: a name that is there twice, open valves that it refuses and ranks by.
#[test]
fn what_is_done_otherwise_is_told() {
    let text = format!(
        "{START}diastole = false\n[ranking]\ncriteria = [\"orifice\", \"diastolic_orifice\"]\n[[alternative]]\nname = \"a\"\n\
         {RING}size_mm = 28\n[[alternative]]\nname = \"a\"\n{RING}size_mm = 30\n"
    );
    let read = |text: &str| alternatives_from_text(Path::new("p.toml"), text, 10).unwrap();
    let (made, warnings) = read(&text);
    let told: Vec<String> = warnings.iter().map(super::super::sentence).collect();
    assert_eq!(
        told,
        [
            "p.toml:3: diastole is false, but `ranking.criteria` has `diastolic_orifice`, for which a comparison computes open valves",
            "p.toml:13: alternative[1].name is `a`, as that of another; one of them is called `a (2)`",
        ]
    );
    assert!(made.asked.diastole);
    assert_eq!(names(&made), ["a", "a (2)"]);
    let (made, warnings) = read(
        &text
            .replace(", \"diastolic_orifice\"", "")
            .replacen("\"a\"", "\"b\"", 1),
    );
    assert_eq!((made.asked.diastole, warnings.len()), (false, 0));
}

/// Lists multiply; the first key changes most slowly; each alternative begins with the common repairs.
#[test]
fn lists_make_the_product_in_order_with_names() {
    let text = format!(
        "[[repair]]\nkind = \"ring\"\nfamily = \"saddle\"\nsize_mm = 40\n[[alternative]]\n[[alternative.repair]]\nkind = \"ring\"\n\
         family = [\"saddle\", \"physio-like\"]\nsize_mm = [30, 28.5]\n[[alternative]]\nname = \"the big one\"\n{RING}size_mm = 32\n"
    );
    let made = made(&text);
    assert_eq!(
        names(&made),
        [
            "ring saddle 30",
            "ring saddle 28.5",
            "ring physio-like 30",
            "ring physio-like 28.5",
            "the big one"
        ]
    );
    let expected = [30.0, 28.5, 30.0, 28.5, 32.0].map(|mm| vec![40.0, mm]);
    assert_eq!(sizes(&made), expected);
    assert_eq!(made.keys[3], ["repair[0]", "alternative[0].repair[0]"]);
    assert_eq!(made.keys[4], ["repair[0]", "alternative[1].repair[0]"]);
}

#[test]
fn common_lists_multiply_with_alternatives() {
    let text = "[[repair]]\nkind = \"ring\"\nfamily = \"saddle\"\nsize_mm = [28, 30]\n[[alternative]]\n\
                [[alternative]]\n[[alternative.repair]]\nkind = \"ring\"\nfamily = \"saddle\"\nsize_mm = 26\n";
    let made = made(text);
    assert_eq!(
        names(&made),
        [
            "ring 28",
            "ring 30",
            "ring 28 + ring saddle 26",
            "ring 30 + ring saddle 26"
        ]
    );
    assert_eq!(
        sizes(&made),
        [vec![28.0], vec![30.0], vec![28.0, 26.0], vec![30.0, 26.0]]
    );
}

#[test]
fn names_are_given_once_and_say_what_a_named_list_holds() {
    let named = |size: u32| format!("[[alternative]]\nname = \"a\"\n{RING}size_mm = {size}\n");
    assert_eq!(names(&made(&(named(28) + &named(30)))), ["a", "a (2)"]);
    let named = format!(
        "[[alternative]]\nname = \"tight\\nones\"\n{RING}size_mm = [26, 28]\nplaced = [true, false]\n"
    );
    assert_eq!(
        names(&made(&named)),
        [
            "tight ones: ring placed 26",
            "tight ones: ring placed 28",
            "tight ones: ring not placed 26",
            "tight ones: ring not placed 28"
        ]
    );
}

/// Whole numbers stay whole, tenths stay tenths, and the end is in it although sums of tenths miss it.
#[test]
fn ranges_count_to_their_end() {
    let with = |range: &str| made(&format!("[[alternative]]\n{RING}size_mm = {range}\n"));
    let whole = with("{ from = 26, to = 33, step = 2 }");
    assert_eq!(sizes(&whole), [[26.0], [28.0], [30.0], [32.0]]);
    assert_eq!(names(&whole)[1], "ring 28");
    let tenths = with("{ from = 28, to = 28.3, step = 0.1 }");
    assert_eq!(sizes(&tenths), [[28.0], [28.1], [28.2], [28.3]]);
    assert_eq!(names(&tenths)[3], "ring 28.3");
    assert_eq!(sizes(&with("{ from = 28, to = 28, step = 1 }")), [[28.0]]);
}

/// A repair that is alone of its kind says all of itself; of two of a kind each says what tells it from the other.
#[test]
fn an_only_repair_of_its_kind_is_called_by_all_of_it() {
    let alternative = |rest: &str| format!("[[alternative]]\n[[alternative.repair]]\n{rest}\n");
    let clip = alternative("kind = \"clip\"\nsite = \"A2P2\"\nmodel = \"rigid\"");
    let chord = "kind = \"neochord\"\nleaflet = \"posterior\"\nposition = 0.4\nlength_mm = 20";
    let rings = [28, 30]
        .map(|size| format!("[[alternative]]\n{RING}size_mm = {size}\n"))
        .concat();
    let made = made(&format!("{clip}{}{rings}", alternative(chord)));
    assert_eq!(
        names(&made),
        [
            "clip rigid A2P2",
            "neochord posterior length_mm 20 position 0.4",
            "ring 28",
            "ring 30"
        ]
    );
}

/// What 3.5 or 2 is, a length or a count, nobody could tell; a ring goes by its size.
#[test]
fn only_the_size_of_a_ring_stands_without_its_key() {
    let named = |repair: &str| -> Vec<String> {
        let made = made(&format!("[[alternative]]\n[[alternative.repair]]\n{repair}\n"));
        names(&made).into_iter().map(str::to_owned).collect()
    };
    for (repair, expected) in [
        (
            "kind = \"clip\"\nsite = \"A2P2\"\ngrasp_anterior_mm = [3.5, 5]",
            ["clip grasp_anterior_mm 3.5", "clip grasp_anterior_mm 5"],
        ),
        (
            "kind = \"neochord\"\nleaflet = \"posterior\"\nsite = \"A2P2\"\nstrands = [2, 4]",
            ["neochord strands 2", "neochord strands 4"],
        ),
        (
            "kind = \"ring\"\nfamily = \"saddle\"\nsize_mm = 30\nsaddle_height_mm = [3, 6]",
            ["ring saddle_height_mm 3", "ring saddle_height_mm 6"],
        ),
        (
            "kind = \"ring\"\nfamily = \"saddle\"\nsize_mm = [28, 30]",
            ["ring 28", "ring 30"],
        ),
    ] {
        assert_eq!(named(repair), expected, "{repair}");
    }
    let lone = "kind = \"neochord\"\nleaflet = \"posterior\"\nsite = \"A2P2\"\nlength_mm = 22";
    assert_eq!(named(lone), ["neochord posterior length_mm 22 A2P2"]);
}

/// A curve is a list by nature: one ring, not four.
#[test]
fn points_and_curves_are_no_lists_of_values() {
    let curve = "curve_mm = [[10, 0, 0], [0, 10, 0], [-10, 0, 0], [0, -10, 0]]\n";
    let made = made(&format!(
        "[[alternative]]\n[[alternative.repair]]\nkind = \"ring\"\n{curve}"
    ));
    assert_eq!(names(&made), ["ring curve_mm"]);
    let ring = keys_of(&made.alternatives[0].repairs[0]);
    assert_eq!(ring["curve_mm"].as_array().unwrap().len(), 4);
    // With one value of a wrong type it is a wrong curve, not a list of four.
    let wrong = faults(&format!(
        "[[alternative]]\n[[alternative.repair]]\nkind = \"ring\"\n{}",
        curve.replace("[0, 10, 0]", "\"x\"")
    ));
    assert!(
        wrong[0].contains("p.toml:6") && wrong[0].contains("invalid type: string"),
        "{wrong:?}"
    );
    // A list of values in the place of one coordinate is told where it stands.
    let wrong = faults(
        "[[alternative]]\n[[alternative.repair]]\nkind = \"relocate-papillary\"\nmuscle = \"anterolateral\"\nby_mm = [0, 0, [2, 4]]\n",
    );
    assert_eq!(
        wrong,
        ["p.toml:7: alternative[0].repair[0].by_mm: invalid type: list, expected a number"]
    );
}

#[test]
fn the_count_is_refused_before_anything_is_made() {
    let range = "{ from = 20, to = 40, step = 0.001 }";
    let told = faults(&format!("[[alternative]]\n{RING}size_mm = {range}\n"));
    assert_eq!(
        told,
        [
            "p.toml has 20,001 alternatives, the product of its lists and ranges; expected 10,000 at most (--max-alternatives)"
        ]
    );
    let text = format!("{START}[[alternative]]\n{RING}size_mm = {{ from = 20, to = 40, step = 1e-7 }}\n");
    let told = alternatives_from_text(Path::new("p.toml"), &text, u64::MAX).unwrap_err();
    assert_eq!(
        told[0].message,
        "has 200,000,001 alternatives; expected 10,000,000 at most, whatever the limit: they are all held in memory"
    );
    // Any of these would fill any memory.
    let endless = format!("{RING}size_mm = {{ from = 0, to = 1e300, step = 1e-300 }}\n").repeat(3);
    let told = faults(&format!("[[alternative]]\n{endless}[[alternative]]\n{endless}"));
    assert!(told[0].contains("has more than 10^19 alternatives"), "{told:?}");
    let text = format!("{START}[[alternative]]\n{RING}size_mm = [26, 28]\n");
    let told = plan_from_text(Path::new("p.toml"), &text).unwrap_err();
    assert_eq!(
        told[0].message,
        "has 2 alternatives; expected one (`coapt plan SCENE PLAN` compares several)"
    );
    assert_eq!(
        plan_from_text(Path::new("p.toml"), &text.replace(", 28", ""))
            .unwrap()
            .0
            .repair
            .len(),
        1
    );
}

/// Every fault of a list or range has the line of its key or item, and of an alternative those that a plan of one has.
#[test]
fn faults_have_lines() {
    let start = "[[alternative]]\n[[alternative.repair]]\nkind = \"ring\"\nfamily = \"saddle\"\n";
    for (wrong, told) in [
        (
            "size_mm = []",
            "p.toml:7 alternative[0].repair[0].size_mm is an empty list; expected one value at least",
        ),
        (
            "size_mm = { from = 30, to = 26, step = 2 }",
            "p.toml:7 alternative[0].repair[0].size_mm is a range from 30 to 26 in steps of 2; expected a step above 0 and an end \
             not below the start",
        ),
        (
            "size_mm = { from = 26, to = 30 }",
            "p.toml:7 alternative[0].repair[0].size_mm is a range without a number as `step`; expected from, to and step",
        ),
        (
            "size_mm = { from = 26, to = 30, by = 2 }",
            "p.toml:7 alternative[0].repair[0].size_mm has the key `by`; a range has from, to and step",
        ),
        (
            "size_mm = [26,\n 28,\n \"30\"]",
            "p.toml:9 alternative[0].repair[0].size_mm[2]: invalid type: string \"30\", expected a number",
        ),
        (
            "size_mm = [\"26\", 28]",
            "p.toml:7:12: size_mm: invalid type: string \"26\", expected a number",
        ),
        (
            "size = [26, 28]",
            "p.toml:7:1: unknown key `size`; did you mean `size_mm`?",
        ),
        (
            "size_mm = [26, 28]\n[[alternatives]]",
            "p.toml:8:3: unknown key `alternatives`; did you mean `alternative`?",
        ),
        (
            "size_mm = 26\ncurve_file = [\"a.json\", \"../b.json\"]",
            "p.toml:8 alternative[0].repair[0].curve_file",
        ),
        (
            "size_mm = 26\n[ranking]\ncriteria = [\"orifice\", \"chord\"]",
            "p.toml:9:24: unknown value `chord`; did you mean `chord_force`?",
        ),
        (
            "size_mm = 26\n[ranking]\ncriteria = [\"orifice\", \"orifice\"]",
            "p.toml:9 ranking.criteria has `orifice` twice; expected each once",
        ),
        (
            "size_mm = 26\n[ranking]\ncriteria = []",
            "p.toml:9 ranking.criteria is an empty list; expected some of orifice, coaptation_length_a2p2, coaptation_length, \
             chord_force, strain, diastolic_orifice",
        ),
    ] {
        let faults = faults(&format!("{start}{wrong}\n"));
        assert!(
            faults[0]
                .replace(": alt", " alt")
                .replace(": rank", " rank")
                .starts_with(told),
            "{wrong}: {faults:#?}"
        );
    }
    let family = faults(
        "[[alternative]]\n[[alternative.repair]]\nkind = \"ring\"\nfamily = [\"saddle\", \"sadle\"]\nsize_mm = 3\n",
    );
    assert!(
        family[0].contains("p.toml:6") && family[0].contains("did you mean `saddle`?"),
        "{family:?}"
    );
}

#[test]
fn criteria_are_those_of_the_plan() {
    let criteria = "[ranking]\ncriteria = [\"strain\", \"orifice\"]\n";
    let made = made(&format!("[[alternative]]\n{RING}size_mm = 28\n{criteria}"));
    assert_eq!(made.ranked_by(), [Criterion::Strain, Criterion::Orifice]);
}

/// However much is wrong or there twice, twenty of it are told and how much more there is.
#[test]
fn faults_of_plans_are_told_up_to_twenty() {
    let alternative = |sizes: &str| format!("[[alternative]]\n{RING}size_mm = {sizes}\n");
    for sizes in ["[]", "[28, \"large\"]"] {
        let told = faults(&alternative(sizes).repeat(30));
        assert_eq!(told.len(), 21, "{told:#?}");
        assert!(told[20].contains("and 10 more like these"), "{told:#?}");
    }
    let text = format!("{START}{}", alternative("28").repeat(30));
    let (made, warnings) = alternatives_from_text(Path::new("p.toml"), &text, 30).unwrap();
    assert_eq!((made.alternatives.len(), warnings.len()), (1, 21));
}

/// What does nothing would rank above what does harm, and a name that stands for the valve as it is, or none, tells nothing.
#[test]
fn alternatives_without_a_repair_or_a_name_are_refused() {
    assert!(faults("")[0].contains("repair is missing"), "{:?}", faults(""));
    let ring = format!("[[alternative]]\n{RING}size_mm = 28\n");
    let idle = faults(&format!("{ring}[[alternative]]\nname = \"nothing\"\n"));
    assert!(idle[0].contains("alternative[1] has no repair"), "{idle:?}");
    for name in ["", " ", "before"] {
        let named = ring.replace(
            "[[alternative]]\n",
            &format!("[[alternative]]\nname = \"{name}\"\n"),
        );
        let told = faults(&named);
        assert!(told[0].contains("alternative[0].name is `"), "{told:?}");
    }
    // A common repair is one.
    let common = format!(
        "{}[[alternative]]\nname = \"the ring alone\"\n",
        ring.replace("alternative.repair", "repair")
            .replace("[[alternative]]\n", "")
    );
    assert_eq!(names(&made(&common)), ["the ring alone"]);
}

/// JSON makes the same alternatives; its faults have keys instead of lines.
#[test]
fn json_is_read_as_toml_is() {
    let json = |size: &str| {
        format!(
            "{{\"schema_version\": 1, \"name\": \"p\", \"alternative\": [{{\"repair\": [{{\"kind\": \"ring\",\n\
             \"family\": \"saddle\", \"closed\": null, \"size_mm\": {size}}}]}}]}}"
        )
    };
    let toml = |size: &str| made(&format!("[[alternative]]\n{RING}size_mm = {size}\n"));
    assert_eq!(read_all(&json("[26, 28]")).unwrap(), toml("[26, 28]"));
    let range = "{\"from\": 26, \"to\": 27, \"step\": 0.5}";
    assert_eq!(
        read_all(&json(range)).unwrap(),
        toml("{ from = 26, to = 27, step = 0.5 }")
    );
    assert_eq!(read_all(&json("30")).unwrap(), toml("30"));
    for (size, told) in [
        (
            "[26, \"28\"]",
            "p.toml: alternative[0].repair[0].size_mm[1]: invalid type: string \"28\", expected a number",
        ),
        (
            "[]",
            "p.toml: alternative[0].repair[0].size_mm is an empty list; expected one value at least",
        ),
        (
            "[26], \"sze\": 1",
            "p.toml: alternative[0].repair[0].sze: unknown key `sze`",
        ),
        ("26, \"sze\": 1", "p.toml:2:61: unknown key `sze`"),
    ] {
        let faults = read_all(&json(size)).unwrap_err();
        assert!(faults[0].starts_with(told), "{size}: {faults:#?}");
    }
}
