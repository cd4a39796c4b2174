//! What is told of each valve of a plan beside its measures.

use std::fmt::Write;

use serde::Deserialize;

use super::word;
use crate::page::Page;
use crate::plan::text::{LIKELY, OPEN};
use crate::plan::{Closed, below};
use crate::report::NOT_CERTIFIED;

/// What is told of each valve beside its measures, in the words of [`crate::plan::text`]: what flows back, the open valve, an ensemble,
/// rates. Nothing where nothing of it is known.
pub(super) fn beside(page: &Page) -> String {
    if page.plan.is_none() {
        return String::new();
    }
    let before = Closed::deserialize(&page.report["before"]).ok();
    let mut out = String::new();
    let mut tell = |name: &str, closed: &Closed, before: Option<&Closed>| {
        let lines: Vec<String> = below::lines(closed, before)
            .iter()
            .map(|line| format!("<li>{}</li>", word(line)))
            .collect();
        let doubt = match closed.solve.certified {
            true => "",
            false => &format!(" <span class=\"uncertified\">{NOT_CERTIFIED}</span>"),
        };
        if !lines.is_empty() {
            let _ = writeln!(
                out,
                "<tr><th scope=\"row\">{}{doubt}</th><td><ul>{}</ul></td></tr>",
                word(name),
                lines.concat()
            );
        }
    };
    if let Some(before) = &before {
        tell("before (nothing done)", before, None);
    }
    for row in page.report["alternatives"].as_array().into_iter().flatten() {
        if let Ok(closed) = Closed::deserialize(row) {
            tell(row["name"].as_str().unwrap_or("?"), &closed, before.as_ref());
        }
    }
    if out.is_empty() {
        return out;
    }
    let is_asked = |of: fn(&Closed) -> bool| before.as_ref().is_some_and(of);
    let notes = [
        (is_asked(|closed| closed.diastole.is_some()), "Open orifice", OPEN),
        (is_asked(|closed| closed.uncertainty.is_some()), "Valves", LIKELY),
    ];
    let notes = notes.into_iter().filter(|(is_told, ..)| *is_told);
    let notes: String = notes
        .map(|(_, name, told)| format!("<p class=\"words\">{name}: {}.</p>\n", word(told)))
        .collect();
    format!(
        "<section class=\"beside\" aria-label=\"Beside the measures\">\n<h2>Beside the measures</h2>\n<table><tbody>\n{out}</tbody></table>\n{notes}</section>\n"
    )
}
