//! The alternatives of a plan, the best first.

use std::borrow::Cow;
use std::fmt::Write;

use coapt::plan::Criterion;
use serde::Deserialize;
use serde_json::Value;

use super::{readable, word};
use crate::page::Page;
use crate::plan::below::HARDLY_OPENS;
use crate::plan::text::FOUND;
use crate::plan::words::{ranking, words};
use crate::report::NOT_CERTIFIED;

pub(super) fn alternatives(page: &Page) -> String {
    if page.plan.is_none() {
        return String::new();
    }
    let rows = page.report["alternatives"]
        .as_array()
        .map_or(&[][..], Vec::as_slice);
    let is_known = |path: &str| {
        rows.iter()
            .any(|row| row.pointer(path).is_some_and(Value::is_number))
    };
    let columns: Vec<Column> = all_columns()
        .into_iter()
        .filter(|column| is_known(column.path))
        .collect();
    let mut out = String::from(
        "<section class=\"alternatives\" aria-label=\"Alternatives\">\n<h2>Alternatives, the best first</h2>\n<p class=\"words\">",
    );
    out += &ranked_by(&page.report);
    let _ = write!(
        out,
        " Choose a row to see it above: the first {} have shapes on this page.",
        page.states.len() - 1
    );
    out +=
        "</p>\n<div class=\"scroll\"><table>\n<thead><tr><th>rank</th><th class=\"name\">what is done</th>";
    for column in &columns {
        let _ = write!(out, "<th>{}</th>", column.heading);
    }
    out += "</tr></thead>\n<tbody>\n";
    let before = &page.report["before"];
    let doubted = if is_certified(before) { "" } else { NOT_CERTIFIED };
    out += &alternative(doubted, "before (nothing done)", "", before, &columns);
    // Shapes were taken in the order of the rows.
    let mut shapes = 1..page.states.len();
    for row in rows {
        let certified = row["solve"]["certified"].as_bool();
        let rank = match (row["rank"].as_u64(), certified) {
            (Some(rank), _) => rank.to_string(),
            (None, Some(true)) => "no repair: it only takes chordae away".to_owned(),
            (None, Some(false)) => NOT_CERTIFIED.to_owned(),
            (None, None) => "refused".to_owned(),
        };
        let chosen = row["solve"].is_object().then(|| shapes.next()).flatten();
        let chosen = chosen.map_or(String::new(), |number| {
            format!(" data-state=\"{number}\" tabindex=\"0\"")
        });
        let faults: Vec<&str> = row["faults"]
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(Value::as_str)
            .collect();
        let name = row["name"].as_str().unwrap_or("?").to_owned();
        let name = if faults.is_empty() {
            name
        } else {
            format!("{name}: {}", faults.join("; "))
        };
        out += &alternative(&rank, &name, &chosen, row, &columns);
    }
    out + "</tbody></table></div>\n</section>"
}

fn ranked_by(report: &Value) -> String {
    let criteria = report["ranking"].as_array().into_iter().flatten();
    let known = criteria.filter_map(|it| {
        let criterion = Criterion::deserialize(&it["criterion"]).ok()?;
        Some((criterion, it["bin"].as_f64()?))
    });
    word(&format!(
        "Ranked by {}; what is not certified is not ranked.",
        ranking(known)
    ))
}

/// A column of the table of alternatives.
struct Column {
    heading: Cow<'static, str>,
    /// Where its value stands in the plan's report.
    path: &'static str,
    /// From there to the unit of the heading.
    factor: f64,
    digits: usize,
}

fn all_columns() -> [Column; 11] {
    [
        of_criterion(Criterion::Orifice, "/orifice/area_mm2"),
        column("widest gap [mm]", "/orifice/max_gap_mm", 1),
        column("narrowest passage [mm²]", "/orifice/passage_mm2", 1),
        of_criterion(Criterion::CoaptationLengthA2P2, "/coaptation/length_a2p2_mm"),
        of_criterion(Criterion::CoaptationLength, "/coaptation/length_mean_mm"),
        column("contact [mm²]", "/coaptation/area_mm2", 0),
        column("tenting [mm]", "/tenting/height_mm", 1),
        of_criterion(Criterion::ChordForce, "/chords/max_force_n"),
        of_criterion(Criterion::DiastolicOrifice, "/diastole/area_mm2"),
        column("mean gradient, at most [mmHg]", "/diastole/mean_gradient_mmhg", 1),
        Column {
            factor: 100.0,
            ..column("seals [%]", "/uncertainty/sealed/estimate", 0)
        },
    ]
}

/// The column of a criterion, called as everywhere.
fn of_criterion(criterion: Criterion, path: &'static str) -> Column {
    let words = words(criterion);
    Column {
        heading: words.heading().into(),
        path,
        factor: words.factor,
        digits: words.digits,
    }
}

fn column(heading: &'static str, path: &'static str, digits: usize) -> Column {
    Column {
        heading: heading.into(),
        path,
        factor: 1.0,
        digits,
    }
}

fn alternative(rank: &str, name: &str, attributes: &str, told: &Value, columns: &[Column]) -> String {
    // Figures of a shape that is not certified must not look like results.
    let doubted = match told["solve"].is_object() && !is_certified(told) {
        true => " class=\"doubted\"",
        false => "",
    };
    let mut out = format!(
        "<tr{attributes}{doubted}><td>{rank}</td><td class=\"name\">{}{}</td>",
        word(name),
        marks(told)
    );
    for column in columns {
        let value = told.pointer(column.path).and_then(Value::as_f64);
        let told = value.map(|value| readable(value * column.factor, column.digits));
        let _ = write!(out, "<td>{}</td>", told.unwrap_or_else(|| "–".to_owned()));
    }
    out + "</tr>\n"
}

fn is_certified(closed: &Value) -> bool {
    closed["solve"]["certified"] == true
}

/// What stands beside the name of a row, whatever its rank.
fn marks(told: &Value) -> String {
    let found = (told["found_by_search"] == true).then_some(("found", FOUND));
    let narrow = (told["diastole"]["hardly_opens"] == true).then_some(("uncertified", HARDLY_OPENS));
    let marks = [found, narrow].into_iter().flatten();
    marks
        .map(|(class, words)| format!(" <span class=\"{class}\">{words}</span>"))
        .collect()
}
