//! How far each state can be trusted, what was done, and what is doubtful.

use coapt::measure::{OrificeMeasures, SlackNeochord};
use serde::Deserialize;
use serde_json::Value;

use super::{doubt, word};
use crate::page::{Page, PageState, Seals};
use crate::report::{RepairReport, orifice_doubt, repair_line, slack_line};

pub(super) fn trust(page: &Page) -> String {
    let states = page.states.iter().enumerate();
    let mut out: String = states.map(|(number, state)| certificate(number, state)).collect();
    let repairs = page.report["repairs"].as_array().into_iter().flatten();
    let repairs = repairs.filter_map(|repair| RepairReport::deserialize(repair).ok());
    out += &told("What was done", repairs.map(|repair| repair_line(&repair)));
    let slack = page.report["slack_neochordae"].as_array().into_iter().flatten();
    let slack = slack.filter_map(|slack| SlackNeochord::deserialize(slack).ok());
    out += &told(
        "Neochordae with slack strands",
        slack.map(|slack| slack_line(&slack)),
    );
    let of_alternatives = page.report["alternatives"].as_array().into_iter().flatten();
    let warnings = std::iter::once(&page.report)
        .chain(of_alternatives)
        .flat_map(|told| warnings(told, told["name"].as_str()));
    let states = ["before", "after"].into_iter();
    let of_orifices = states.filter_map(|state| {
        let orifice = OrificeMeasures::deserialize(&page.report[state]["orifice"]).ok()?;
        Some(format!("orifice {state}: {}", orifice_doubt(&orifice)?))
    });
    out + &told("Doubts", warnings.chain(of_orifices))
}

/// What is doubtful, with the name of the alternative that it is told of.
fn warnings(told: &Value, name: Option<&str>) -> Vec<String> {
    let texts = told["warnings"].as_array().into_iter().flatten();
    let texts = texts.filter_map(Value::as_str);
    let named = texts.map(|text| match name {
        Some(name) => format!("{name}: {text}"),
        None => text.to_owned(),
    });
    named.collect()
}

fn told(heading: &str, lines: impl Iterator<Item = String>) -> String {
    let lines: String = lines.map(|line| format!("<li>{}</li>", word(&line))).collect();
    if lines.is_empty() {
        return String::new();
    }
    format!("<h3>{heading}</h3>\n<ul>{lines}</ul>\n")
}

/// The certificate of a state, and how often valves like it seal where that is known.
fn certificate(number: usize, state: &PageState) -> String {
    let certificate = &state.certificate;
    let verdict = match certificate.certified {
        true => "yes: converged, stable, no surfaces cross".to_owned(),
        false => format!("NO: {}", doubt(certificate)),
    };
    let mut lines = vec![
        ("certified", verdict),
        (
            "largest force left",
            format!(
                "{:.1e} of the mean force of the pressure on a point",
                certificate.residual
            ),
        ),
        (
            "deepest contact",
            format!(
                "{:.2} mm nearer than the contact distance",
                certificate.max_penetration_mm
            ),
        ),
        (
            "what the mesh costs",
            format!(
                "up to {:.2} mm from an infinitely fine mesh, root mean square (estimate)",
                certificate.discretisation_mm
            ),
        ),
        ("iterations", certificate.iterations.to_string()),
    ];
    if let Some(Seals { probability, samples }) = state.seals {
        let [estimate, low, high] = probability.map(|part| 100.0 * part);
        lines.push((
            "seals",
            format!(
                "{estimate:.0} % of {samples} valves that an image could not tell from it (95 % interval {low:.0} to {high:.0} %)"
            ),
        ));
    }
    let lines: String = lines
        .iter()
        .map(|(name, value)| format!("<dt>{name}</dt><dd>{}</dd>\n", word(value)))
        .collect();
    let name = word(&state.name);
    format!("<div data-details=\"{number}\"><h3>{name}</h3>\n<dl>{lines}</dl></div>\n")
}
