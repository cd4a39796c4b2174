//! Which states are shown, and the table of their measures.

use std::fmt::Write;

use serde_json::Value;

use super::{readable, word};
use crate::page::{Page, PageState};
use crate::report::{GRASP, NOT_CERTIFIED, TableRow, is_zero};

pub(super) fn choices(page: &Page) -> String {
    if page.states.len() < 2 {
        return String::new();
    }
    let mut out = String::new();
    let buttons = [("before", "Before"), ("after", "After"), ("both", "Side by side")];
    for (value, name) in buttons {
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "<button type=\"button\" data-shown=\"{value}\">{name}</button>"
        );
    }
    if page.plan.is_some() {
        out += "<label>After <select id=\"after\">";
        for (number, state) in page.states.iter().enumerate().skip(1) {
            let place = place(state);
            let _ = write!(
                out,
                "<option value=\"{number}\">{place} {}</option>",
                word(&state.name)
            );
        }
        out += "</select></label>\n";
    }
    out
}

/// `1.`, or why it has no place.
fn place(state: &PageState) -> String {
    match (state.rank, state.certificate.certified) {
        (Some(rank), _) => format!("{rank}."),
        (None, true) if state.only_takes_chordae => "no repair:".to_owned(),
        (None, true) => "not ranked:".to_owned(),
        (None, false) => "not certified:".to_owned(),
    }
}

pub(super) fn measures(page: &Page) -> String {
    let mut out = String::from("<h2>Measures</h2>\n<div class=\"scroll\"><table>\n<thead><tr><th>");
    let after = page.states.get(1);
    let certified = |state: Option<&PageState>| state.is_none_or(|state| state.certificate.certified);
    let trusted = [certified(page.states.first()), certified(after)];
    match after {
        Some(after) => {
            let _ = write!(
                out,
                "</th><th></th><th>before{}</th><th><span id=\"after-heading\">{}</span>{}</th><th>change</th>",
                mark("before-doubt", trusted[0]),
                word(&after.name),
                mark("after-doubt", trusted[1])
            );
        }
        None => {
            let _ = write!(
                out,
                "</th><th></th><th>closed{}</th>",
                mark("before-doubt", trusted[0])
            );
        }
    }
    out += "</tr></thead>\n<tbody>\n";
    let mut title = "";
    for (place, row) in page.rows.iter().enumerate() {
        if row.title != title {
            title = &row.title;
            let _ = writeln!(
                out,
                "<tr><th colspan=\"5\" scope=\"rowgroup\">{}</th></tr>",
                word(title)
            );
        }
        out += &measure(place, row, after.is_some(), trusted);
    }
    out += "</tbody></table></div>";
    if joins_edges(&page.report) {
        let _ = write!(out, "\n<p class=\"words\">Coaptation: {}.</p>", word(GRASP));
    }
    out
}

/// Whether a clip or stitches hold leaflets together in what the page shows.
fn joins_edges(report: &Value) -> bool {
    let alternatives = report["alternatives"].as_array().into_iter().flatten();
    let closed = alternatives.filter(|row| row["solve"].is_object());
    let repairs = std::iter::once(report)
        .chain(closed)
        .filter_map(|told| told["repairs"].as_array());
    let mut kinds = repairs.flatten().map(|repair| &repair["kind"]);
    kinds.any(|kind| kind == "clip" || kind == "alfieri")
}

/// What stands below the heading of a column whose figures are no results.
fn mark(id: &str, is_trusted: bool) -> String {
    let hidden = if is_trusted { " hidden" } else { "" };
    format!("<span id=\"{id}\" class=\"uncertified mark\"{hidden}>{NOT_CERTIFIED}</span>")
}

/// A row of the table of measures. From a shape that is not certified, or to one, nothing has changed.
fn measure(place: usize, row: &TableRow, has_after: bool, trusted: [bool; 2]) -> String {
    let told = |value: Option<f64>| value.map_or("–".to_owned(), |value| readable(value, row.digits));
    let [before, after] = [0, 1].map(|state| row.values.get(state).copied().flatten());
    let doubted = trusted.map(|is_trusted| if is_trusted { "" } else { " class=\"doubted\"" });
    let mut out = format!(
        "<tr><td>{}</td><td class=\"unit\">{}</td><td{}>{}</td>",
        word(&row.name),
        row.unit,
        doubted[0],
        told(before)
    );
    if has_after {
        let change = before
            .zip(after)
            .filter(|_| trusted == [true; 2])
            .map(|(before, after)| after - before);
        let sign = match change {
            Some(change) if change > 0.0 && !is_zero(change, row.digits) => "+",
            _ => "",
        };
        let change = change.map_or(String::new(), |change| readable(change, row.digits));
        let _ = write!(
            out,
            "<td id=\"after-{place}\"{}>{}</td><td id=\"change-{place}\">{sign}{change}</td>",
            doubted[1],
            told(after)
        );
    }
    out + "</tr>\n"
}
