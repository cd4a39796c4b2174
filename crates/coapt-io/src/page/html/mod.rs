//! Tables and words of a page, which are there without any script.
//!
//! | file | tells |
//! |---|---|
//! | `verdicts` | whether what is shown may be trusted, and what was changed of the valve as given |
//! | `measures` | which states are shown, and what they measure |
//! | `alternatives` | the alternatives of a plan, the best first |
//! | `beside` | what is told of each of them beside its measures |
//! | `search` | what was sought and found |
//! | `trust` | certificates, what was done, doubts |

mod alternatives;
mod beside;
mod measures;
mod search;
mod trust;
mod verdicts;

use quick_xml::escape::escape;

use super::{MIDDLE_SURFACES, Page};
use crate::plan::Trust;
use crate::report::{number, reasons};

const FRAME: &str = include_str!("../page.html");
const STYLE: &str = include_str!("../page.css");
const SCRIPT: &str = include_str!("../../../viewer/built/report.js");

/// The whole page; `data` is what its script reads.
pub(super) fn fill(page: &Page, data: &str) -> String {
    let title = match &page.plan {
        None => page.case.clone(),
        Some(plan) if plan.is_empty() => format!("{}: plans compared", page.case),
        Some(plan) => format!("{}: {plan}", page.case),
    };
    let report = serde_json::to_string_pretty(&page.report).unwrap_or_default();
    let parts = [
        ("title", word(&title)),
        ("style", STYLE.to_owned()),
        ("facts", facts(page)),
        ("verdicts", verdicts::verdicts(page) + &verdicts::changed(page)),
        ("choices", measures::choices(page)),
        ("measures", measures::measures(page)),
        (
            "alternatives",
            alternatives::alternatives(page) + &beside::beside(page) + &search::search(page),
        ),
        ("middle_surfaces", MIDDLE_SURFACES.to_owned()),
        ("trust", trust::trust(page)),
        ("report", word(&report)),
        ("data", data.to_owned()),
        ("script", SCRIPT.to_owned()),
    ];
    // Piece by piece: what is filled in may hold braces of its own.
    let mut out = String::new();
    let mut rest = FRAME;
    while let Some((before, after)) = rest.split_once("{{") {
        out += before;
        let (name, after) = after.split_once("}}").unwrap_or((after, ""));
        if let Some((_, part)) = parts.iter().find(|part| part.0 == name) {
            out += part;
        }
        rest = after;
    }
    out + rest
}

/// Text that is no markup; control letters, which HTML does not allow, become spaces.
fn word(text: &str) -> String {
    let letters = text.chars().map(|letter| match letter {
        '\n' | '\t' => letter,
        letter if letter.is_control() => ' ',
        letter => letter,
    });
    escape(letters.collect::<String>()).into_owned()
}

fn facts(page: &Page) -> String {
    let mesh = &page.report["mesh"];
    word(&format!(
        "Mitral valve closed at {} mmHg; {} triangles, {} chord segments; coapt {}",
        number(page.pressure_mmhg, 0),
        mesh["faces"],
        mesh["chords"],
        page.version
    ))
}

fn doubt(certificate: &Trust) -> String {
    word(&reasons(
        certificate.status,
        certificate.stable,
        certificate.crossings,
    ))
}

fn readable(value: f64, digits: usize) -> String {
    number(value, digits).replace('-', "−")
}
