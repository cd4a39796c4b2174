//! A comparison as a person reads it: the valve as it is, then the alternatives, the best first.

use std::fmt::Write;

use coapt::plan::Criterion;

use super::words::{Words, ranking, words};
use super::{AnatomicLimit, Closed, PlanReport, Row, Trust, below, search};
use crate::report::{GRASP, NOT_CERTIFIED, WIDTH, is_zero, line, number, reasons, wrapped};
use crate::scene::BEFORE;

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
        "{}{}: {} compared at {:.0} mmHg (coapt {})",
        report.case,
        named(&report.plan),
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
    let ranked_by = report.ranking.iter().map(|it| (it.criterion, it.bin));
    line(&mut out, "ranked by", &ranking(ranked_by));
    let columns = columns(report);
    heads(&mut out, &columns);
    values(&mut out, &columns, (None, BEFORE), &report.before, None);
    let is_out = |row: &&Row| row.rank.is_none();
    for row in report.alternatives.iter().filter(|row| row.rank.is_some()) {
        told(&mut out, &columns, row, &report.before);
    }
    if report.alternatives.iter().any(|row| is_out(&row)) {
        out.push_str("\nnot ranked\n");
    }
    for row in report.alternatives.iter().filter(is_out) {
        told(&mut out, &columns, row, &report.before);
    }
    if let Some(found) = &report.search {
        search::told(&mut out, found);
    }
    notes(&mut out, report);
    warnings(&mut out, report);
    let _ = writeln!(out, "\n{}", report.notice);
    out
}

/// How the plan is called, on one line whatever it is; nothing where it has no name.
fn named(plan: &str) -> String {
    match plan {
        "" => String::new(),
        _ => format!(", plan \"{}\"", plan.replace(char::is_control, " ")),
    }
}

fn counted(count: usize, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        _ => format!("{count} {what}s"),
    }
}

/// The columns of the table: the coaptation that ranks, and the open valve where it was computed.
fn columns(report: &PlanReport) -> Vec<Criterion> {
    let ranks = |criterion| report.ranking.iter().any(|it| it.criterion == criterion);
    let is_mean = ranks(Criterion::CoaptationLength) && !ranks(Criterion::CoaptationLengthA2P2);
    let coaptation = match is_mean {
        true => Criterion::CoaptationLength,
        false => Criterion::CoaptationLengthA2P2,
    };
    let mut columns = vec![
        Criterion::Orifice,
        coaptation,
        Criterion::ChordForce,
        Criterion::Strain,
    ];
    columns.extend(
        report
            .before
            .diastole
            .as_ref()
            .map(|_| Criterion::DiastolicOrifice),
    );
    columns
}

/// Letters that are left for names.
fn name_width(columns: &[Criterion]) -> usize {
    let left = WIDTH.saturating_sub(RANK + 2 + columns.len() * (VALUE + CHANGE));
    left.min(NAME)
}

fn heads(out: &mut String, columns: &[Criterion]) {
    let (pair, width) = (VALUE + CHANGE, name_width(columns));
    let titles: String = columns
        .iter()
        .map(|criterion| format!("  {:>1$}", words(*criterion).head, pair - 2))
        .collect();
    let _ = writeln!(out, "\n{:RANK$}  {:width$}{titles}", "", "");
    let units: String = columns
        .iter()
        .map(|criterion| format!("{:>VALUE$}{:>CHANGE$}", words(*criterion).unit, "change"))
        .collect();
    let _ = writeln!(out, "{:>RANK$}  {:width$}{units}", "rank", "alternative");
}

fn told(out: &mut String, columns: &[Criterion], row: &Row, before: &Closed) {
    match &row.closed {
        Some(closed) => {
            values(out, columns, (row.rank, &row.name), closed, Some(before));
            if row.found_by_search {
                let _ = writeln!(out, "{:RANK$}  {FOUND}", "");
            }
            if row.only_takes_chordae {
                wrapped(out, &format!("{:RANK$}  NO REPAIR: ", ""), TAKES_CHORDAE);
            }
        }
        None => {
            let _ = writeln!(out, "{:>RANK$}  {}", "-", row.name);
            for fault in &row.faults {
                wrapped(out, &format!("{:RANK$}  REFUSED: ", ""), fault);
            }
        }
    }
}

/// What stands beside the alternative that a search found.
pub(crate) const FOUND: &str = "FOUND BY SEARCH";

/// Why what only tears or cuts chordae has no rank.
pub(super) const TAKES_CHORDAE: &str = "it only takes chordae away";

fn values(
    out: &mut String,
    columns: &[Criterion],
    (rank, name): (Option<usize>, &str),
    closed: &Closed,
    before: Option<&Closed>,
) {
    let width = name_width(columns);
    let rank = rank.map_or("-".to_owned(), |rank| rank.to_string());
    let is_long = name.chars().count() > width;
    if is_long {
        // On a line of its own: names differ at their ends.
        let _ = writeln!(out, "{rank:>RANK$}  {name}");
    }
    let (rank, name) = if is_long { ("", "") } else { (&*rank, name) };
    let _ = write!(out, "{rank:>RANK$}  {name:width$}");
    for &criterion in columns {
        let Words { factor, digits, .. } = words(criterion);
        let value = closed.value(criterion).map(|value| factor * value);
        // From a shape that is not certified nothing has changed: its figures are no results.
        let earlier = before.filter(|before| before.solve.certified);
        let earlier = earlier.and_then(|before| before.value(criterion));
        let change = value
            .zip(earlier)
            .map(|(value, earlier)| signed(value - factor * earlier, digits));
        let value = value.map_or("-".to_owned(), |value| number(value, digits));
        let _ = write!(out, "{value:>VALUE$}{:>CHANGE$}", change.unwrap_or_default());
    }
    let kept = out.trim_end().len();
    out.truncate(kept);
    out.push('\n');
    if let Some(reasons) = doubt(&closed.solve) {
        wrapped(out, &format!("{:RANK$}  {NOT_CERTIFIED}: ", ""), &reasons);
    }
    let start = " ".repeat(RANK + 2);
    for told in below::lines(closed, before) {
        wrapped(out, &start, &told);
    }
}

/// What areas and gradients of open valves are not.
pub(crate) const OPEN: &str = "the leaflets without pressure, annulus and papillary tips as in systole; blood pushes them wider, so that areas are rather too \
     small and gradients too high: they compare repairs, are no mitral valve area, and no limit for one is held against them";

/// What the valves of an ensemble are.
pub(crate) const LIKELY: &str = "like this one as far as an image tells: annulus, papillary tips, chordae, tissue and pressure vary by what is not known of them; \
     what the model itself leaves out is not in it";

/// What figures must not be taken for, and published limits beside them.
fn notes(out: &mut String, report: &PlanReport) {
    out.push('\n');
    if report.before.diastole.is_some() {
        line(out, "open orifice", OPEN);
    }
    if report.alternatives.iter().any(Row::joins_edges) {
        line(out, "coaptation", GRASP);
    }
    let closed = report.alternatives.iter().filter_map(|row| row.closed.as_ref());
    let warm = closed.filter(|closed| closed.solve.begun_at.is_some()).count();
    if warm > 0 {
        let told = format!(
            "{warm} of {} alternatives began at the closed shape of the first that differs in its last repair alone; begun open \
             they may come to rest a little elsewhere: close the best again without --warm",
            report.alternatives.len()
        );
        line(out, "warm", &told);
    }
    if report.before.uncertainty.is_some() {
        line(out, "valves", LIKELY);
    }
    for AnatomicLimit {
        repair,
        value,
        at_least,
        source,
        ..
    } in &report.anatomic_limits
    {
        let told = format!(
            "for {repair} repair {source} asks for a coaptation length of {at_least} mm or more; before repair it is {} mm at A2-P2",
            number(*value, 1)
        );
        line(out, "anatomy", &told);
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
