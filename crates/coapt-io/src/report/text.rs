//! The report as a person reads it: what was closed, how far to trust it, one row per measure.

use std::fmt::Write;

use coapt::measure::{Agreement, OrificeMeasures};
use coapt::relax::Status;
use coapt::scene::{Readable, Settings};

use super::repairs::{joins_edges, repair_line, slack_line, slack_mark};
use super::rows::{TableRow, rows};
use super::{LeftOutReport, Report, Solve, UntangledReport};
use crate::escape::escaped;

/// Longest line.
pub(crate) const WIDTH: usize = 100;

/// Columns: the name of a measure, its unit, its values.
const NAME: usize = 42;
const UNIT: usize = 5;
const VALUE: usize = 11;

/// The report as text, at most 100 letters wide, with a line break at its end.
pub fn text(report: &Report) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "{}: mitral valve closed at {:.0} mmHg (coapt {})",
        escaped(&report.case),
        Readable(report.pressure_mmhg),
        report.version
    );
    let mesh = report.mesh;
    let _ = writeln!(
        out,
        "{} triangles, {} vertices, {} chord segments",
        mesh.faces, mesh.vertices, mesh.chords
    );
    for repair in &report.repairs {
        line(&mut out, "repair", &repair_line(repair));
    }
    for slack in &report.slack_neochordae {
        line(&mut out, slack_mark(slack), &slack_line(slack));
    }
    out.push('\n');
    match &report.after {
        None => certificate(&mut out, "", &report.before.solve),
        Some(after) => {
            certificate(&mut out, "before: ", &report.before.solve);
            certificate(&mut out, "after:  ", &after.solve);
        }
    }
    if let Some(untangled) = &report.untangled {
        line(&mut out, "drawn apart", &untangled_line(untangled));
    }
    if !report.chordae_left_out.is_empty() {
        line(&mut out, "left out", &left_out_line(&report.chordae_left_out));
    }
    if !report.certified() {
        line(
            &mut out,
            "void",
            "figures of a shape that is not certified are no prediction",
        );
    }
    table(&mut out, report);
    let notes = orifice_doubts(report)
        .into_iter()
        .map(|doubt| ("orifice", doubt))
        .chain(
            report
                .repairs
                .iter()
                .any(joins_edges)
                .then(|| ("coaptation", GRASP.to_owned())),
        );
    for (of, note) in notes {
        out.push('\n');
        line(&mut out, of, &note);
    }
    if !report.warnings.is_empty() {
        out.push('\n');
        for warning in &report.warnings {
            line(&mut out, "warning", warning);
        }
    }
    let _ = writeln!(out, "\n{}", report.notice);
    out
}

/// What stands beside figures of a shape that is not certified, and before why it is not.
pub(crate) const NOT_CERTIFIED: &str = "NOT CERTIFIED";

/// What coaptation of valves that are joined edge to edge is not.
pub(crate) const GRASP: &str = "what a clip grasps or stitches hold counts as coaptation: at the joint, as at A2-P2, lengths are in part the grasp's, \
     and do not tell how the leaflets meet beside it";

/// Where margins and passage do not agree on what is open, by state.
pub(crate) fn orifice_doubts(report: &Report) -> Vec<String> {
    let states = [("before", Some(&report.before)), ("after", report.after.as_ref())];
    let doubts = states.into_iter().filter_map(|(state, outcome)| {
        let doubt = orifice_doubt(&outcome?.measures.orifice)?;
        Some(match report.after {
            Some(_) => format!("{state}: {doubt}"),
            None => doubt,
        })
    });
    doubts.collect()
}

/// That margins and passage do not agree on what is open.
pub(crate) fn orifice_doubt(orifice: &OrificeMeasures) -> Option<String> {
    let passage_mm2 = orifice.passage_mm2?;
    let area_mm2 = orifice.area_mm2;
    match orifice.agreement() {
        Agreement::Fair => None,
        Agreement::MarginsMiss => Some(format!(
            "in doubt: {passage_mm2:.1} mm² can pass between the surfaces, of which the margins show {area_mm2:.1}; a finer mesh tells more"
        )),
        Agreement::MarginsExceed => Some(format!(
            "in doubt: the margins bound {area_mm2:.1} mm², and {passage_mm2:.1} can pass between the surfaces; a finer mesh tells more"
        )),
    }
}

/// Two lines on how far a result can be trusted.
fn certificate(out: &mut String, name: &str, solve: &Solve) {
    let verdict = match verdict(solve) {
        None if solve.residual > Settings::default().residual_tolerance => format!(
            "CERTIFIED, but only to a residual of {:.0e} that the scene allows (converged, stable, no surfaces cross)",
            solve.residual
        ),
        None => "CERTIFIED (converged, stable, no surfaces cross)".to_owned(),
        Some(reasons) => format!("{NOT_CERTIFIED}: {reasons}"),
    };
    wrapped(out, name, &verdict);
    let work = format!(
        "residual {:.1e}; {} iterations in {:.0} ms; mesh error up to {:.2} mm (estimate); penetration {:.2} mm",
        solve.residual, solve.iterations, solve.wall_ms, solve.discretisation_mm, solve.max_penetration_mm
    );
    wrapped(out, &" ".repeat(name.len()), &work);
}

/// That the valve closed is not quite the one given.
pub(crate) fn untangled_line(untangled: &UntangledReport) -> String {
    let [x, y, z] = untangled.first_at_mm.first().copied().unwrap_or_default();
    format!(
        "surfaces of the open valve crossed or touched at {} places, the first at ({x:.1}, {y:.1}, {z:.1}) mm; {} points were \
         moved before it was closed, by {:.2} mm at most",
        untangled.places, untangled.moved_points, untangled.farthest_mm
    )
}

/// That the valve closed lacks chordae of the one given.
pub(crate) fn left_out_line(left_out: &[LeftOutReport]) -> String {
    let count = |of: &LeftOutReport| format!("{} of `{}`", of.segments, of.group);
    format!(
        "the valve was closed without chord segments that reach neither tip nor leaflet: {}; what they should hold is not held",
        left_out.iter().map(count).collect::<Vec<_>>().join(", ")
    )
}

/// Why a result is not certified; none if it is.
fn verdict(solve: &Solve) -> Option<String> {
    (!solve.certified).then(|| reasons(solve.status, solve.stable, solve.crossings))
}

/// What stands against a certificate.
pub(crate) fn reasons(status: Status, stable: bool, crossings: usize) -> String {
    let mut reasons = Vec::new();
    match status {
        Status::Converged => {}
        Status::IterationLimit => reasons.push("the iteration limit came first".to_owned()),
        Status::Stalled => reasons.push("the solver made no progress any more".to_owned()),
        Status::Burst => {
            reasons.push("the valve grew to five times its size, it does not bear this pressure".to_owned());
        }
        Status::TangledStart => reasons.push("surfaces cross in the open valve already".to_owned()),
        Status::Interrupted => reasons.push("it was interrupted".to_owned()),
    }
    // After these nobody has looked.
    if !stable && !matches!(status, Status::Interrupted | Status::Burst) {
        reasons.push("the shape is not stable".to_owned());
    }
    if crossings > 0 {
        reasons.push(format!("surfaces cross at {crossings} edges"));
    }
    reasons.join("; ")
}

fn table(out: &mut String, report: &Report) {
    let mut heads = report.after.as_ref().map(|_| ["before", "after", "change"]);
    let mut last = String::new();
    for row in rows(report) {
        let title = &row.title;
        if *title != last {
            let _ = match heads.take() {
                Some([a, b, c]) => writeln!(
                    out,
                    "\n{title:NAME$} {:UNIT$}{a:>VALUE$}{b:>VALUE$}{c:>VALUE$}",
                    ""
                ),
                None => writeln!(out, "\n{title}"),
            };
            last.clone_from(title);
        }
        let _ = writeln!(out, "{}", row_line(&row));
    }
}

fn row_line(row: &TableRow) -> String {
    let digits = row.digits;
    let name = format!("  {}", shortened(&escaped(&row.name), NAME - 2));
    let told = |value: Option<f64>| value.map_or("-".to_owned(), |value| number(value, digits));
    let [before, after] = [0, 1].map(|state| row.values.get(state).copied().flatten());
    let mut text = format!("{name:NAME$} {:UNIT$}{:>VALUE$}", row.unit, told(before));
    if after.is_some() {
        let change = before.zip(after).map(|(before, after)| after - before);
        let sign = match change {
            Some(change) if change > 0.0 && !is_zero(change, digits) => "+",
            _ => "",
        };
        let change = format!("{sign}{}", told(change));
        let _ = write!(text, "{:>VALUE$}{change:>VALUE$}", told(after));
    }
    text
}

/// A number to so many digits, without a minus before zero.
pub(crate) fn number(value: f64, digits: usize) -> String {
    if is_zero(value, digits) {
        return format!("{:.digits$}", 0.0);
    }
    format!("{:.digits$}", Readable(value))
}

pub(crate) fn is_zero(value: f64, digits: usize) -> bool {
    let text = format!("{value:.digits$}");
    text.chars().all(|letter| matches!(letter, '-' | '0' | '.'))
}

fn shortened(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.to_owned();
    }
    text.chars()
        .take(width.saturating_sub(3))
        .chain("...".chars())
        .collect()
}

/// A paragraph that begins with a word and a colon.
pub(crate) fn line(out: &mut String, word: &str, text: &str) {
    wrapped(out, &format!("{word}: "), text);
}

/// Text broken between words, the further lines below the text of the first.
pub(crate) fn wrapped(out: &mut String, start: &str, text: &str) {
    let indent = start.chars().count();
    let mut column = indent;
    out.push_str(start);
    for (number, word) in escaped(text).split_whitespace().enumerate() {
        let length = word.chars().count();
        if number > 0 && column + 1 + length > WIDTH {
            out.push('\n');
            out.push_str(&" ".repeat(indent));
            column = indent;
        } else if number > 0 {
            out.push(' ');
            column += 1;
        }
        out.push_str(word);
        column += length;
    }
    out.push('\n');
}

#[cfg(test)]
mod tests {
    use super::super::tests::{closure_of, closure_with, spoil};
    use super::*;
    use coapt::scene::{Clip, Neochord, Repair, Site};

    #[test]
    fn lines_are_aligned_and_not_wider_than_a_screen() {
        let mut report = Report::new(&closure_of("physio-like:28"));
        report.warnings = vec!["word ".repeat(60), "x".repeat(30)];
        let text = text(&report);
        let width = text.lines().map(|line| line.chars().count()).max();
        assert!(width <= Some(WIDTH), "{text}");
        let ends = |line: &str| line.chars().count() == NAME + 1 + UNIT + 3 * VALUE;
        let lines: Vec<&str> = text
            .lines()
            .filter(|line| line.starts_with("  ") && ends(line))
            .collect();
        // Every row of every group, in three columns that end at the same place.
        let expected = rows(&report).len();
        assert_eq!(lines.len(), expected, "{text}");
        assert!(text.lines().any(|line| ends(line) && line.ends_with("change")));
        assert!(text.ends_with("research use, not a medical device\n"));
        assert!(text.contains("warning: word word"));
    }

    /// A row of what the repair put in has a dash before, and no change; the others are paired by name, whatever comes between.
    #[test]
    fn what_a_repair_adds_has_rows_of_its_own() {
        let clip = Clip {
            site: Some(Site::A2P2),
            ..Clip::default()
        };
        let neochord = Neochord {
            position: Some(0.35),
            ..Neochord::to("posterior")
        };
        let report = Report::new(&closure_with(&[Repair::Neochord(neochord), Repair::Clip(clip)]));
        let text = text(&report);
        let row = |name: &str| {
            text.lines()
                .find(|line| line.trim_start().starts_with(name))
                .unwrap_or_default()
        };
        let cells = |name: &str| {
            row(name)
                .split_whitespace()
                .rev()
                .take(3)
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        for new in [
            "clip A2P2: total tension",
            "neochord posterior 0.35: largest tension",
        ] {
            let [change, after, before] = &cells(new)[..] else {
                panic!("{text}")
            };
            assert!(
                change == "-" && before == "-" && after.parse::<f64>().is_ok(),
                "{text}"
            );
        }
        assert!(
            cells("strut: total tension")
                .iter()
                .all(|cell| cell.parse::<f64>().is_ok()),
            "{text}"
        );
        assert!(text.contains("\nSutures and clips"), "{text}");
        let note = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(note.contains(&format!("coaptation: {GRASP}")), "{text}");
        assert!(
            text.contains("repair: clip A2P2: arms 9 mm long and 4 mm wide"),
            "{text}"
        );
        assert!(
            text.contains("repair: neochord posterior 0.35: 2 strands from tip"),
            "{text}"
        );
        let json: serde_json::Value = serde_json::from_str(&report.json().unwrap()).unwrap();
        assert_eq!(
            (&json["repairs"][0]["kind"], &json["repairs"][1]["kind"]),
            (&"neochord".into(), &"clip".into())
        );
        assert_eq!(json["repairs"][1]["name"], "clip A2P2");
        assert!(json["after"]["sutures"][0]["total_force_n"].as_f64() > Some(0.0));
    }

    /// A neochord too long to hold anything looks like a repair and is none.
    #[test]
    fn a_slack_neochord_says_so() {
        let at = |length_mm: f64| {
            let neochord = Neochord {
                position: Some(0.35),
                length_mm: Some(length_mm),
                ..Neochord::to("posterior")
            };
            Report::new(&closure_with(&[Repair::Neochord(neochord)]))
        };
        let slack = at(40.0);
        let told = text(&slack).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            told.contains("SLACK: repair[0], neochord posterior 0.35: no strand bears 0.01 N"),
            "{told}"
        );
        assert_eq!(slack.slack_neochordae.len(), 1);
        let taut = at(6.0);
        assert!(!text(&taut).contains("SLACK") && taut.slack_neochordae.is_empty());
    }

    #[test]
    fn what_is_not_certified_says_why() {
        let mut report = Report::new(&closure_of("physio-like:28"));
        assert!(!text(&report).contains("NOT CERTIFIED"), "{}", text(&report));
        assert!(!text(&report).contains("clip grasps"), "{}", text(&report));
        spoil(&mut report.before.solve);
        let text = text(&report).split_whitespace().collect::<Vec<_>>().join(" ");
        for reason in ["iteration limit", "not stable", "cross at 3 edges"] {
            assert!(text.contains(reason), "{text}");
        }
    }

    #[test]
    fn changes_have_signs_and_zero_has_none() {
        let line = |before, after| {
            row_line(&TableRow {
                title: "A".to_owned(),
                name: "a".to_owned(),
                unit: "mm".to_owned(),
                digits: 1,
                values: vec![Some(before), Some(after)],
            })
        };
        assert!(line(1.0, 2.0).ends_with(" 2.0       +1.0"));
        assert!(line(2.0, 1.0).ends_with(" 1.0       -1.0"));
        assert!(line(1.0, 0.99).ends_with(" 1.0        0.0"));
        assert_eq!(number(-0.01, 1), "0.0");
    }
}
