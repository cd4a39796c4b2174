//! A comparison as a person reads it: the valve as it is, then the alternatives, the best first.

use std::fmt::Write;

use coapt::plan::{COAPTATION_TARGET_MM, Criterion};

use super::{Closed, PlanReport, Ranking, Row, Trust};
use crate::report::{WIDTH, is_zero, line, number, reasons, wrapped};

/// Columns: place, name, and for each measure its value and its change.
const RANK: usize = 4;
const NAME: usize = 30;
const VALUE: usize = 7;
const CHANGE: usize = 8;

/// Warnings about repairs that are told; the others are counted.
const MOST_WARNINGS: usize = 20;

/// The comparison as text, at most 100 letters wide, with a line break at its end.
pub fn text(report: &PlanReport) -> String {
    let mut out = String::new();
    let count = report.alternatives.len();
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "{}: {} compared at {:.0} mmHg (coapt {})",
        report.case,
        counted(count, "alternative"),
        report.pressure_mmhg,
        report.version
    );
    let mesh = report.mesh;
    let _ = writeln!(
        out,
        "{} triangles, {} vertices, {} chord segments",
        mesh.faces, mesh.vertices, mesh.chords
    );
    line(&mut out, "ranked by", &ranking(&report.ranking));
    heads(&mut out);
    values(&mut out, None, "before", &report.before, None);
    let is_out = |row: &&Row| row.rank.is_none();
    for row in report.alternatives.iter().filter(|row| row.rank.is_some()) {
        told(&mut out, row, &report.before);
    }
    if report.alternatives.iter().any(|row| is_out(&row)) {
        out.push_str("\nnot ranked\n");
    }
    for row in report.alternatives.iter().filter(is_out) {
        told(&mut out, row, &report.before);
    }
    warnings(&mut out, report);
    let _ = writeln!(out, "\n{}", report.notice);
    out
}

fn counted(count: usize, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        _ => format!("{count} {what}s"),
    }
}

fn ranking(criteria: &[Ranking]) -> String {
    let told = criteria.iter().map(|ranking| {
        let bin = ranking.bin;
        match ranking.criterion {
            Criterion::Orifice => format!("orifice area in steps of {bin} mm²"),
            Criterion::CoaptationLength => format!(
                "mean coaptation length, as far as it is below {COAPTATION_TARGET_MM} mm, in steps of {bin} mm"
            ),
            Criterion::ChordForce => format!("largest chord tension in steps of {bin} N"),
            Criterion::Strain => format!("strain in steps of {:.0} %", 100.0 * bin),
        }
    });
    let told: Vec<String> = told.collect();
    format!(
        "{}; smaller differences are noise, and share a rank",
        told.join(", then ")
    )
}

/// The measures of the table, with the digits that they are told to.
const COLUMNS: [(&str, &str, Criterion, usize); 4] = [
    ("orifice", "mm²", Criterion::Orifice, 1),
    ("coaptation", "mm", Criterion::CoaptationLength, 1),
    ("chord, most", "N", Criterion::ChordForce, 2),
    ("strain, 95 %", "%", Criterion::Strain, 1),
];

fn heads(out: &mut String) {
    let pair = VALUE + CHANGE;
    let titles: String = COLUMNS
        .iter()
        .map(|(title, ..)| format!("  {title:>0$}", pair - 2))
        .collect();
    let _ = writeln!(out, "\n{:RANK$}  {:NAME$}{titles}", "", "");
    let units: String = COLUMNS
        .iter()
        .map(|(_, unit, ..)| format!("{unit:>VALUE$}{:>CHANGE$}", "change"))
        .collect();
    let _ = writeln!(out, "{:>RANK$}  {:NAME$}{units}", "rank", "alternative");
}

fn told(out: &mut String, row: &Row, before: &Closed) {
    match &row.closed {
        Some(closed) => values(out, row.rank, &row.name, closed, Some(before)),
        None => {
            let _ = writeln!(out, "{:>RANK$}  {}", "-", row.name);
            for fault in &row.faults {
                wrapped(out, &format!("{:RANK$}  FAILED: ", ""), fault);
            }
        }
    }
}

fn values(out: &mut String, rank: Option<usize>, name: &str, closed: &Closed, before: Option<&Closed>) {
    let rank = rank.map_or("-".to_owned(), |rank| rank.to_string());
    let is_long = name.chars().count() > NAME;
    if is_long {
        // On a line of its own: names differ at their ends.
        let _ = writeln!(out, "{rank:>RANK$}  {name}");
    }
    let (rank, name) = if is_long { ("", "") } else { (&*rank, name) };
    let _ = write!(out, "{rank:>RANK$}  {name:NAME$}");
    for (_, unit, criterion, digits) in COLUMNS {
        let scale = if unit == "%" { 100.0 } else { 1.0 };
        let value = scale * criterion.value(&closed.measures);
        let change = before.map(|before| value - scale * criterion.value(&before.measures));
        let change = change.map_or(String::new(), |change| signed(change, digits));
        let _ = write!(out, "{:>VALUE$}{change:>CHANGE$}", number(value, digits));
    }
    let kept = out.trim_end().len();
    out.truncate(kept);
    out.push('\n');
    if let Some(reasons) = doubt(&closed.solve) {
        wrapped(out, &format!("{:RANK$}  NOT CERTIFIED: ", ""), &reasons);
    }
}

/// Why a closure is not certified; none if it is.
pub(super) fn doubt(solve: &Trust) -> Option<String> {
    (!solve.certified).then(|| reasons(solve.status, solve.stable, solve.crossings))
}

fn signed(change: f64, digits: usize) -> String {
    match change > 0.0 && !is_zero(change, digits) {
        true => format!("+{}", number(change, digits)),
        false => number(change, digits),
    }
}

fn warnings(out: &mut String, report: &PlanReport) {
    let of_rows = report.alternatives.iter().flat_map(|row| {
        let told = row.warnings.iter();
        told.map(|warning| format!("{}: {warning}", row.name))
    });
    let all: Vec<String> = report.warnings.iter().cloned().chain(of_rows).collect();
    if all.is_empty() {
        return;
    }
    out.push('\n');
    for warning in all.iter().take(MOST_WARNINGS) {
        line(out, "warning", warning);
    }
    if all.len() > MOST_WARNINGS {
        let more = all.len() - MOST_WARNINGS;
        line(
            out,
            "warning",
            &format!("and {more} more; plan.json has them all"),
        );
    }
}

/// What a line may hold beside a long name.
const _: () = assert!(RANK + 2 + NAME + 4 * (VALUE + CHANGE) <= WIDTH);
