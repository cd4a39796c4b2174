//! What a report tells, as a page: its shapes come from whoever holds them.

use coapt::measure::{Measures, ValveFrame};
use coapt::scene::Fault;
use serde::Deserialize;
use serde_json::Value;

use super::geometry::Geometry;
use super::{Page, PageState, Seals};
use crate::report::{TableRow, rows_of};

/// The page of a `report.json`, which `place` names in messages; `shape` finds where the valve lies `before`, and `after` where it
/// was closed again.
pub(super) fn closure_page(
    place: &str,
    report: Value,
    shape: impl Fn(&str) -> Result<Geometry, Vec<Fault>>,
) -> Result<Page, Vec<Fault>> {
    let state = |key: &str, name: &str| -> Result<PageState, Vec<Fault>> {
        let told = &report[key];
        Ok(PageState {
            name: name.to_owned(),
            rank: None,
            only_takes_chordae: false,
            certificate: parsed(place, &format!("{key}.solve"), &told["solve"])?,
            chord_groups: parsed(place, &format!("{key}.chord_groups"), &told["chord_groups"])?,
            geometry: shape(key)?,
            seals: None,
        })
    };
    let states = match report.get("after") {
        Some(_) => vec![state("before", "before")?, state("after", "after")?],
        None => vec![state("before", "the valve")?],
    };
    let measures = match states.len() {
        1 => vec![&report["before"]],
        _ => vec![&report["before"], &report["after"]],
    };
    let rows = table(place, &measures)?;
    page(place, report, None, states, rows)
}

/// The page of a `plan.json`, with the shapes of so many alternatives, the first-ranked first; `shape` finds where one lies, by its
/// number in the plan (0 is the valve as it is) and its name.
pub(super) fn plan_page(
    place: &str,
    report: Value,
    most_alternatives: usize,
    shape: impl Fn(u64, &str) -> Result<Geometry, Vec<Fault>>,
) -> Result<Page, Vec<Fault>> {
    let state = |number: u64, name: &str, told: &Value| -> Result<PageState, Vec<Fault>> {
        Ok(PageState {
            name: name.to_owned(),
            rank: told["rank"].as_u64(),
            only_takes_chordae: told["only_takes_chordae"].as_bool().unwrap_or(false),
            certificate: parsed(place, &format!("solve of {name}"), &told["solve"])?,
            chord_groups: group_names(&report["before"], told),
            geometry: shape(number, name)?,
            seals: seals(&told["uncertainty"]),
        })
    };
    let mut states = vec![state(0, "before", &report["before"])?];
    let mut measures = vec![&report["before"]];
    let rows = report["alternatives"].as_array().map_or(&[][..], Vec::as_slice);
    let closed = rows.iter().filter(|row| row["solve"].is_object());
    for row in closed.take(most_alternatives) {
        let number = row["number"].as_u64().unwrap_or(0);
        states.push(state(number, row["name"].as_str().unwrap_or("?"), row)?);
        measures.push(row);
    }
    let rows = table(place, &measures)?;
    let plan = report["plan"].as_str().unwrap_or("").to_owned();
    page(place, report, Some(plan), states, rows)
}

/// The table of the measures of some states.
fn table(place: &str, states: &[&Value]) -> Result<Vec<TableRow>, Vec<Fault>> {
    let measures = states.iter().map(|told| parsed(place, "measures", told));
    let measures: Vec<Measures> = measures.collect::<Result<_, _>>()?;
    Ok(rows_of(&measures.iter().collect::<Vec<_>>()))
}

fn page(
    place: &str,
    report: Value,
    plan: Option<String>,
    states: Vec<PageState>,
    rows: Vec<TableRow>,
) -> Result<Page, Vec<Fault>> {
    let frame = report.get("frame");
    let frame = frame.ok_or_else(|| {
        fault(
            place,
            "has no `frame`, as the annulus has no plane: cannot be drawn",
        )
    })?;
    let frame: ValveFrame = parsed(place, "frame", frame)?;
    let word = |key: &str| report[key].as_str().unwrap_or("").to_owned();
    Ok(Page {
        case: word("case"),
        plan,
        version: word("version"),
        pressure_mmhg: parsed(place, "pressure_mmhg", &report["pressure_mmhg"])?,
        frame,
        rows,
        states,
        report,
    })
}

/// Names of the chord groups of an alternative in the order of its model: chordae of the valve, then what repairs strung. A plan tells
/// neochordae and sutures apart, not in which order they came: where there are both, no names are given.
fn group_names(before: &Value, told: &Value) -> Vec<String> {
    let names = |state: &Value, path: &str| -> Vec<String> {
        let groups = state
            .pointer(path)
            .and_then(Value::as_array)
            .into_iter()
            .flatten();
        groups
            .map(|group| group["name"].as_str().unwrap_or("?").to_owned())
            .collect()
    };
    let chordae = names(told, "/chords/groups");
    let sutures = names(told, "/sutures");
    let strung = chordae.len() > names(before, "/chords/groups").len();
    match strung && !sutures.is_empty() {
        true => Vec::new(),
        false => [chordae, sutures].concat(),
    }
}

fn seals(uncertainty: &Value) -> Option<Seals> {
    let sealed = &uncertainty["sealed"];
    let part = |key: &str| sealed[key].as_f64();
    Some(Seals {
        probability: [part("estimate")?, part("low")?, part("high")?],
        samples: uncertainty["certified"].as_u64()?,
    })
}

/// A part of a report; `key` is what messages call it.
fn parsed<T: for<'a> Deserialize<'a>>(place: &str, key: &str, value: &Value) -> Result<T, Vec<Fault>> {
    T::deserialize(value).map_err(|error| {
        fault(
            place,
            format!("`{key}` cannot be read ({error}): close the valve again with this version"),
        )
    })
}

fn fault(place: &str, message: impl Into<String>) -> Vec<Fault> {
    vec![Fault::error(place, message)]
}
