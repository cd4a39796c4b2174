//! What was sought and found.

use serde::Deserialize;

use super::word;
use crate::page::Page;
use crate::plan::SearchReport;
use crate::plan::search::{heading, sentence, tried};
use crate::report::NOT_CERTIFIED;

/// What was sought and found; nothing where nothing was.
pub(super) fn search(page: &Page) -> String {
    let Ok(report) = SearchReport::deserialize(&page.report["search"]) else {
        return String::new();
    };
    let rows: String = tried(&report)
        .map(|[value, measured, mark]| {
            let class = match &*mark {
                NOT_CERTIFIED => " class=\"doubted\"",
                _ => "",
            };
            format!("<tr{class}><td>{value}</td><td>{measured}</td><td class=\"name\">{mark}</td></tr>\n")
        })
        .collect();
    format!(
        "<section class=\"search\" aria-label=\"Search\">\n<h2>Search</h2>\n<p>{}.</p>\n<table>\n<thead><tr><th scope=\"col\">{}</th>\
         <th scope=\"col\">{}</th><th class=\"name\">values tried</th></tr></thead>\n<tbody>\n{rows}</tbody></table>\n</section>\n",
        word(&sentence(&report)),
        word(&report.key),
        word(&heading(&report))
    )
}
