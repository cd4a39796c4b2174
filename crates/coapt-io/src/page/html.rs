//! Tables and words of a page, which are there without any script.

use std::borrow::Cow;
use std::fmt::Write;

use coapt::measure::SlackNeochord;
use coapt::plan::Criterion;
use quick_xml::escape::escape;
use serde::Deserialize;
use serde_json::Value;

use super::{Page, PageState, Seals};
use crate::plan::below::{self, HARDLY_OPENS};
use crate::plan::search::{heading, sentence, tried};
use crate::plan::text::{FOUND, LIKELY, OPEN};
use crate::plan::words::{ranking, words};
use crate::plan::{Closed, SearchReport, Trust};
use crate::report::{
    LeftOutReport, NOT_CERTIFIED, RepairReport, TableRow, UntangledReport, is_zero, left_out_line, number,
    reasons, repair_line, slack_line, untangled_line,
};

const FRAME: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("../../viewer/built/report.js");

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
        ("verdicts", verdicts(page) + &changed(page)),
        ("choices", choices(page)),
        ("measures", measures(page)),
        ("alternatives", alternatives(page) + &beside(page) + &search(page)),
        ("trust", trust(page)),
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

fn verdicts(page: &Page) -> String {
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

fn doubt(certificate: &Trust) -> String {
    word(&reasons(
        certificate.status,
        certificate.stable,
        certificate.crossings,
    ))
}

/// What was changed of the valve as given, where something was.
fn changed(page: &Page) -> String {
    let untangled = UntangledReport::deserialize(&page.report["untangled"]).ok();
    let left_out = Vec::<LeftOutReport>::deserialize(&page.report["chordae_left_out"]).unwrap_or_default();
    let left_out = (!left_out.is_empty()).then(|| left_out_line(&left_out));
    let lines = [untangled.as_ref().map(untangled_line), left_out];
    let told = lines.into_iter().flatten();
    told.map(|line| format!("<p class=\"verdict uncertified\">{}</p>\n", word(&line)))
        .collect()
}

fn choices(page: &Page) -> String {
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

fn measures(page: &Page) -> String {
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
    out + "</tbody></table></div>"
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

fn readable(value: f64, digits: usize) -> String {
    number(value, digits).replace('-', "−")
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

fn column(heading: &'static str, path: &'static str, digits: usize) -> Column {
    Column {
        heading: heading.into(),
        path,
        factor: 1.0,
        digits,
    }
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

fn all_columns() -> [Column; 10] {
    [
        of_criterion(Criterion::Orifice, "/orifice/area_mm2"),
        column("widest gap [mm]", "/orifice/max_gap_mm", 1),
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

fn alternatives(page: &Page) -> String {
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

fn is_certified(closed: &Value) -> bool {
    closed["solve"]["certified"] == true
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

/// What stands beside the name of a row, whatever its rank.
fn marks(told: &Value) -> String {
    let found = (told["found_by_search"] == true).then_some(("found", FOUND));
    let narrow = (told["diastole"]["hardly_opens"] == true).then_some(("uncertified", HARDLY_OPENS));
    let marks = [found, narrow].into_iter().flatten();
    marks
        .map(|(class, words)| format!(" <span class=\"{class}\">{words}</span>"))
        .collect()
}

/// What is told of each valve beside its measures, in the words of [`crate::plan::text`]: what flows back, the open valve, an ensemble,
/// rates. Nothing where nothing of it is known.
fn beside(page: &Page) -> String {
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

/// What was sought and found; nothing where nothing was.
fn search(page: &Page) -> String {
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

fn trust(page: &Page) -> String {
    let states = page.states.iter().enumerate();
    let mut out: String = states.map(|(number, state)| certificate(number, state)).collect();
    let repairs = page.report["repairs"].as_array().into_iter().flatten();
    let repairs = repairs.filter_map(|repair| RepairReport::deserialize(repair).ok());
    out += &told("What was done", repairs.map(|repair| repair_line(&repair)));
    let slack = page.report["slack_neochordae"].as_array().into_iter().flatten();
    let slack = slack.filter_map(|slack| SlackNeochord::deserialize(slack).ok());
    out += &told(
        "Neochordae that hold nothing back",
        slack.map(|slack| slack_line(&slack)),
    );
    let of_alternatives = page.report["alternatives"].as_array().into_iter().flatten();
    let warnings = std::iter::once(&page.report)
        .chain(of_alternatives)
        .filter_map(|told| told["warnings"].as_array());
    let warnings = warnings
        .flatten()
        .filter_map(|text| text.as_str().map(str::to_owned));
    out + &told("Doubts", warnings)
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
                "{:.2} mm from an infinitely fine mesh, root mean square (estimate)",
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
