//! Whether what a page shows may be trusted, and what was changed of the valve as given.

use serde::Deserialize;

use super::{doubt, word};
use crate::page::{Page, PageState};
use crate::report::{LeftOutReport, NOT_CERTIFIED, UntangledReport, left_out_line, untangled_line};

pub(super) fn verdicts(page: &Page) -> String {
    let shown = match page.plan {
        Some(_) => &page.states[..1],
        None => &page.states[..],
    };
    shown.iter().map(verdict).collect()
}

fn verdict(state: &PageState) -> String {
    let name = word(&state.name);
    let certificate = &state.certificate;
    match certificate.certified {
        true => format!(
            "<p class=\"verdict certified\">{name}: CERTIFIED (converged, stable, no surfaces cross)</p>\n"
        ),
        false => format!(
            "<p class=\"verdict uncertified\">{name}: {NOT_CERTIFIED} ({}); figures of a shape that is not certified are no \
             prediction</p>\n",
            doubt(certificate)
        ),
    }
}

/// What was changed of the valve as given, where something was.
pub(super) fn changed(page: &Page) -> String {
    let untangled = UntangledReport::deserialize(&page.report["untangled"]).ok();
    let left_out = Vec::<LeftOutReport>::deserialize(&page.report["chordae_left_out"]).unwrap_or_default();
    let left_out = (!left_out.is_empty()).then(|| left_out_line(&left_out));
    let lines = [untangled.as_ref().map(untangled_line), left_out];
    let told = lines.into_iter().flatten();
    told.map(|line| format!("<p class=\"verdict uncertified\">{}</p>\n", word(&line)))
        .collect()
}
