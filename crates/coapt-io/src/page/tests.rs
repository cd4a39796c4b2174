use std::fs;
use std::path::{Path, PathBuf};

use super::*;
use crate::report::tests::closure_of;
use crate::report::{Closure, Report, write_results};

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
    assert!(html.contains("esearch use, not a medical device"));
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
