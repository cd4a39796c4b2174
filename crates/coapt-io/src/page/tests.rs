use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use coapt::measure::SlackNeochord;
use coapt::plan::Comparison;
use coapt::plan::ensemble::{Interval, Probability};
use coapt::relax::Status;
use coapt::scene::Fault;
use coapt::search::Tried;

use super::*;
use crate::plan::tests::{compared_with, report as plan_report};
use crate::plan::text::{LIKELY, OPEN};
use crate::plan::{PlanReport, Sampled, SearchReport, Shapes, below, rates_of, write_plan};
use crate::report::tests::closure_of;
use crate::report::{Closure, GRASP, Report, write_results};

/// A folder of its own for each test, gone with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("coapt-page-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A small valve whose name is markup, closed, and closed on a ring.
fn named_closure() -> Closure {
    let mut closure = closure_of("physio-like:30");
    closure.before.model.name = "</script><b>&".to_owned();
    closure
}

/// The same, written to a folder.
fn results(folder: &Path) -> Report {
    let closure = named_closure();
    let report = Report::new(&closure);
    write_results(folder, &closure, &report).unwrap();
    report
}

fn told(folder: &Path) -> String {
    let faults = read_page(folder, 30).unwrap_err();
    faults
        .iter()
        .map(crate::scene::sentence)
        .collect::<Vec<_>>()
        .join("\n")
}

/// What was written comes onto the page: shapes to single precision, numbers to the digits of the table, and nothing of a name is
/// taken for markup.
#[test]
fn a_page_shows_what_was_written() {
    let folder = Folder::new("shown");
    let report = results(folder.path());
    let page = read_page(folder.path(), 30).unwrap();
    assert_eq!(page.states.len(), 2);
    assert_eq!(page.states[1].geometry.rings.len(), 1);
    let chords = page.states[1].geometry.chords.as_ref().unwrap();
    let largest = chords.force_n.0.iter().copied().fold(0.0, f32::max);
    let after = report.after.as_ref().unwrap();
    assert!((f64::from(largest) - after.measures.chords.max_force_n).abs() < 1e-6);
    assert_eq!(page.rows, crate::report::rows(&report));
    let html = page_html(&page).unwrap();
    assert_eq!(html.matches("</script>").count(), 2);
    assert!(!html.contains("<b>&"), "a name is taken for markup");
    assert!(html.contains("&lt;/script&gt;&lt;b&gt;&amp;"));
    let area = format!("{:.1}", after.measures.coaptation.area_mm2);
    assert!(html.contains(&format!(">{area}<")), "{area}");
    assert!(html.contains("esearch use, not a medical device") && html.contains(MIDDLE_SURFACES));
    assert!(!html.contains("{{"), "a place of the page was not filled");
    assert_eq!(html, page_html(&read_page(folder.path(), 30).unwrap()).unwrap());
}

/// A closure in memory makes the page that its files make, with a repair and without.
#[test]
fn memory_and_files_make_the_same_page() {
    let folder = Folder::new("memory");
    let both = named_closure();
    let alone = Closure {
        after: None,
        repairs: Vec::new(),
        ..both.clone()
    };
    for closure in [both, alone] {
        let report = Report::new(&closure);
        write_results(folder.path(), &closure, &report).unwrap();
        let page = page_of_closure(&closure, &report).unwrap();
        assert_eq!(page, read_page(folder.path(), 30).unwrap());
    }
}

/// What no file would hold is on no page: a point that is not finite, a valve that has no up and down.
#[test]
fn what_cannot_be_drawn_is_told() {
    let mut closure = named_closure();
    let report = Report::new(&closure);
    closure.before.equilibrium.state.positions_mm[3].x = f64::NAN;
    let faults = page_of_closure(&closure, &report).unwrap_err();
    assert_eq!(
        crate::scene::sentence(&faults[0]),
        "before: point 3 is not finite"
    );
    let report = Report {
        frame: None,
        ..report
    };
    let faults = page_of_closure(&named_closure(), &report).unwrap_err();
    let words = crate::scene::sentence(&faults[0]);
    assert!(words.contains("annulus has no plane"), "{words}");
}

/// The open valve is the closed one less its displacement: to rounding in double precision, and then to single.
#[test]
fn open_positions_are_those_of_the_open_file() {
    let folder = Folder::new("open");
    results(folder.path());
    let page = read_page(folder.path(), 30).unwrap();
    let (open, _) = crate::mesh::read_mesh(&folder.path().join("before/open.vtp")).unwrap();
    let read = &page.states[0].geometry.open.0;
    assert_eq!(read.len(), 3 * open.points.len());
    let apart = read
        .iter()
        .zip(open.points.iter().flatten())
        .map(|(&a, b)| (f64::from(a) - b).abs());
    assert!(apart.fold(0.0, f64::max) < 1e-5);
}

/// A state without a certificate says so in the same words as everywhere.
#[test]
fn what_is_not_certified_says_so() {
    let folder = Folder::new("uncertified");
    results(folder.path());
    let mut page = read_page(folder.path(), 30).unwrap();
    page.states[1].certificate.certified = false;
    page.states[1].certificate.crossings = 3;
    let html = page_html(&page).unwrap();
    assert!(html.contains("after: NOT CERTIFIED (surfaces cross at 3 edges)"));
    assert!(html.contains("before: CERTIFIED"));
}

/// A small plan of two clips, written with its shapes, and its page.
fn plan_page(folder: &Path, change: impl Fn(&mut Comparison)) -> (PlanReport, String) {
    let plan = "schema_version = 1\n[[alternative]]\n[[alternative.repair]]\nkind = \"clip\"\nsite = [\"A1P1\", \"A2P2\"]\n";
    let mut compared = compared_with(plan, true);
    change(&mut compared.comparison);
    let rates = rates_of(&compared.model, &[], &compared.comparison.before);
    let mut report = plan_report(&compared).with_rates(&rates, &[]);
    let sealed = Some(Probability {
        estimate: 0.5,
        low: 0.19,
        high: 0.81,
    });
    let lengths = Interval {
        low: 1.24,
        median: 2.0,
        high: 3.06,
    };
    report.before.uncertainty = Some(Sampled {
        samples: 8,
        certified: 6,
        in_doubt: 2,
        refused: 1,
        sealed,
        intervals: BTreeMap::from([("coaptation_length".to_owned(), lengths)]),
    });
    let tried = |value, measured, certified| Tried {
        value,
        measured,
        certified,
    };
    report.search = Some(SearchReport {
        place: "alternative[0].repair[0]".to_owned(),
        key: "position".to_owned(),
        from: 0.4,
        to: 0.6,
        tolerance: 0.01,
        measure: "coaptation/<length>".to_owned(),
        at_least: Some(3.0),
        at_most: None,
        answer: Some(tried(0.5, 3.25, true)),
        lost_again: None,
        repairs: Vec::new(),
        tried: vec![
            tried(0.4, 2.0, true),
            tried(0.45, 9.0, false),
            tried(0.5, 3.25, true),
        ],
    });
    write_plan(
        folder,
        &report,
        &compared.model,
        &Shapes::from(compared.comparison),
    )
    .unwrap();
    let html = page_html(&read_page(folder, 30).unwrap()).unwrap();
    (report, html)
}

/// Words without line breaks and what a page writes otherwise.
fn plain(text: &str) -> String {
    let text = text
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&apos;", "'");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Gradients, ensembles, rates and the search are told on the page in the words of the text: no line of it lacks.
#[test]
fn a_plan_tells_on_its_page_what_its_text_tells() {
    let folder = Folder::new("beside");
    let (report, html) = plan_page(folder.path(), |_| {});
    let [text, html] = [crate::plan::text(&report), html].map(|told| plain(&told));
    let closed = report.alternatives.iter().filter_map(|row| row.closed.as_ref());
    let told: Vec<String> = closed
        .map(|closed| below::lines(closed, Some(&report.before)))
        .chain([below::lines(&report.before, None)])
        .flatten()
        .collect();
    for start in [
        "open without pressure",
        "seals in 50 % of 6 valves",
        "median (nine of ten)",
        "per 1 % of length",
    ] {
        assert!(
            told.iter().any(|line| line.starts_with(start)),
            "{start}: {told:?}"
        );
    }
    for line in &told {
        assert!(text.contains(line), "{line} is not in the text");
        assert!(
            html.contains(&format!("<li>{line}</li>")),
            "{line} is not on the page"
        );
    }
    let sought = "the first `position` of alternative[0].repair[0] from 0.4 to 0.6 that gives coaptation/<length> of 3 or more is 0.500";
    assert!(text.contains(sought), "{text}");
    assert!(html.contains(sought));
    assert!(html.contains("<td>0.450</td><td>9.000</td><td class=\"name\">NOT CERTIFIED</td>"));
    assert!(html.contains("mean gradient, at most [mmHg]"));
    for note in [LIKELY, OPEN, GRASP] {
        assert!(text.contains(note) && html.contains(note), "{note}");
    }
}

/// A valve that seals by hardly opening is marked in its row, and a neochord that holds nothing back in its list; no gradient is told.
#[test]
fn what_hardly_opens_is_marked_on_the_page() {
    let folder = Folder::new("narrow");
    let (_, html) = plan_page(folder.path(), |comparison| {
        let outcome = comparison.rows[0].result.as_mut().unwrap();
        let open = outcome.diastole.as_mut().unwrap();
        (open.orifice.as_mut().unwrap().area_mm2, open.mean_gradient_mmhg) = (6.0, None);
        outcome.slack_neochordae = vec![SlackNeochord {
            repair: 3,
            name: "neochord <P2>".to_owned(),
            strands: 2,
            slack_strands: 1,
        }];
    });
    assert_eq!(
        html.matches("<span class=\"uncertified\">HARDLY OPENS</span></td>")
            .count(),
        1
    );
    let html = plain(&html);
    assert!(html.contains("HARDLY OPENS: through 6 mm², under 50, no gradient is told</li>"));
    assert!(html.contains(
        "<li>partly slack: repair[3], neochord <P2>: 1 of 2 strands bears less than 0.01 N in the closed valve</li>"
    ));
}

/// Doubts of all alternatives stand in one list: each says whose it is.
#[test]
fn doubts_of_an_alternative_have_its_name() {
    let folder = Folder::new("doubts");
    let (report, html) = plan_page(folder.path(), |comparison| {
        let outcome = comparison.rows[0].result.as_mut().unwrap();
        outcome.warnings = vec![(0, Fault::warning("ring.size_mm", "is doubted"))];
    });
    let doubt = &report.alternatives[0].warnings[0];
    assert!(doubt.ends_with("is doubted"), "{doubt}");
    let expected = format!("<li>{}: {doubt}</li>", report.alternatives[0].name);
    assert!(plain(&html).contains(&expected), "{expected}");
}

/// Figures of a valve as it is that is not certified must not look like results: they are marked, and nothing has changed from them.
#[test]
fn an_uncertified_valve_before_is_marked() {
    let folder = Folder::new("doubted");
    let (_, html) = plan_page(folder.path(), |_| {});
    let marks = "<span id=\"before-doubt\" class=\"uncertified mark\" hidden>";
    assert!(html.contains(marks) && !html.contains("class=\"doubted\"><td>NOT CERTIFIED</td>"));
    let (_, html) = plan_page(folder.path(), |comparison| {
        comparison.before.status = Status::Stalled
    });
    assert!(html.contains("<span id=\"before-doubt\" class=\"uncertified mark\">NOT CERTIFIED</span>"));
    assert!(html.contains(
        "<tr class=\"doubted\"><td>NOT CERTIFIED</td><td class=\"name\">before (nothing done)</td>"
    ));
    let changes: Vec<&str> = html.split("<td id=\"change-").skip(1).collect();
    assert!(changes.len() > 30, "{}", changes.len());
    for change in changes {
        let told = change
            .split_once('>')
            .and_then(|(_, rest)| rest.split_once("</td>"));
        assert_eq!(told.map(|(told, _)| told), Some(""), "{change}");
    }
}

/// Every way in which a folder may be wrong is told with its file.
#[test]
fn wrong_folders_are_told() {
    let folder = Folder::new("wrong");
    assert!(told(folder.path()).contains("holds no results; expected the folder of `coapt closure --out`"));
    assert!(told(&folder.path().join("nowhere")).contains("holds no results"));
    results(folder.path());
    let path = folder.path().join("after/closed.vtp");
    fs::copy(folder.path().join("before/closed.vtp"), &path).unwrap();
    let words = told(folder.path());
    assert!(
        words.contains("after/closed.vtp is not as SHA256SUMS lists it (so are 1 of its files)"),
        "{words}"
    );
    results(folder.path());
    crate::atomic::write_files(folder.path(), &[("study.json", "{}".to_owned())]).unwrap();
    assert!(told(folder.path()).contains("report.json is not among the files that SHA256SUMS lists"));
    results(folder.path());
    let (mut surface, _) = crate::mesh::read_mesh(&path).unwrap();
    surface.point_arrays.retain(|array| array.name != "strain");
    crate::mesh::write_vtp(&path, &surface).unwrap();
    let words = told(folder.path());
    assert!(
        words.contains("closed.vtp") && words.contains("no point array `strain`"),
        "{words}"
    );
    fs::remove_file(&path).unwrap();
    assert!(told(folder.path()).contains("closed.vtp"));
    fs::write(folder.path().join("report.json"), "{\"before\": 1}").unwrap();
    assert!(told(folder.path()).contains("report.json"));
    fs::write(folder.path().join("report.json"), "{").unwrap();
    assert!(told(folder.path()).contains("report.json"));
    fs::write(folder.path().join("plan.json"), "{}").unwrap();
    assert!(told(folder.path()).contains("holds report.json and plan.json"));
    fs::remove_file(folder.path().join("report.json")).unwrap();
    assert!(told(folder.path()).contains("`coapt plan --out --shapes`"));
}
