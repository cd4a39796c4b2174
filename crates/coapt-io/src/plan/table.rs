//! A comparison as a table for machines: a line per alternative, a column per measure.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use serde_json::Value;

use super::text::{TAKES_CHORDAE, doubt};
use super::{Closed, PlanReport, Row};
use crate::scene::BEFORE;
use crate::study::status_name;

const COLUMNS: &str = "number,rank,name,certified,status,reason,residual,iterations,crossings,max_penetration_mm,\
                       discretisation_mm,begun_at,found_by_search";

/// A line per alternative, the best first, after one of number 0 for the valve as it is; columns with their names in the first
/// line: what tells the alternatives apart, as `ring.size_mm`, then measures by their paths in `plan.json`. What an alternative lacks
/// is empty.
pub fn csv(report: &PlanReport) -> String {
    let before = (0, None, BEFORE, Some(&report.before), None);
    let rows = report.alternatives.iter().map(|row| {
        let name = row.name.as_str();
        (row.number, row.rank, name, row.closed.as_ref(), Some(row))
    });
    let rows: Vec<_> = std::iter::once(before).chain(rows).collect();
    let repairs = parameters(report);
    let measures: Vec<BTreeMap<String, f64>> =
        rows.iter().map(|(_, _, _, closed, _)| flat(*closed)).collect();
    let names: BTreeSet<&String> = measures.iter().flat_map(BTreeMap::keys).collect();
    let mut out = COLUMNS.to_owned();
    for name in repairs.keys().chain(names.iter().copied()) {
        out.push(',');
        out += &quoted(name);
    }
    out.push('\n');
    for (index, ((number, rank, name, closed, row), measures)) in rows.iter().zip(&measures).enumerate() {
        let rank = rank.map_or(String::new(), |rank| rank.to_string());
        // Writing to a string cannot fail.
        let _ = write!(out, "{number},{rank},{},", quoted(name));
        out += &trust(*closed, *row);
        for values in repairs.values() {
            let value = index.checked_sub(1).and_then(|index| values[index].as_deref());
            let _ = write!(out, ",{}", quoted(value.unwrap_or_default()));
        }
        for name in &names {
            out.push(',');
            if let Some(value) = measures.get(*name) {
                let _ = write!(out, "{value}");
            }
        }
        out.push('\n');
    }
    out
}

/// The keys of repairs that differ between the alternatives, each with its value in each row; a key that a row lacks differs too.
/// The second repair of a kind in a row is called by its number: `clip.2.position`.
fn parameters(report: &PlanReport) -> BTreeMap<String, Vec<Option<String>>> {
    let count = report.alternatives.len();
    let mut columns: BTreeMap<String, Vec<Option<String>>> = BTreeMap::new();
    for (index, row) in report.alternatives.iter().enumerate() {
        let mut of_kind: BTreeMap<String, usize> = BTreeMap::new();
        for repair in &row.repairs {
            let Ok(Value::Object(mut keys)) = serde_json::to_value(repair) else {
                continue;
            };
            let kind = keys.remove("kind").map(|kind| cell(&kind)).unwrap_or_default();
            let number = of_kind.entry(kind.clone()).or_default();
            *number += 1;
            let start = match *number {
                1 => kind,
                number => format!("{kind}.{number}"),
            };
            for (path, value) in scalars(&start, &keys.into()) {
                columns.entry(path).or_insert_with(|| vec![None; count])[index] = Some(value);
            }
        }
    }
    columns.retain(|_, values| values.windows(2).any(|pair| pair[0] != pair[1]));
    columns
}

/// Coordinates at most: a longer list is a curve, and no cells.
const LONGEST_LIST: usize = 3;

/// Numbers, words and switches in a value, each by its path.
fn scalars(path: &str, value: &Value) -> Vec<(String, String)> {
    let inside = |name: &str, value: &Value| scalars(&format!("{path}.{name}"), value);
    match value {
        Value::Object(entries) => entries
            .iter()
            .flat_map(|(name, value)| inside(name, value))
            .collect(),
        Value::Array(items) if items.len() > LONGEST_LIST => Vec::new(),
        Value::Array(items) => {
            let numbered = items.iter().enumerate();
            numbered
                .flat_map(|(number, item)| inside(&number.to_string(), item))
                .collect()
        }
        Value::Null => Vec::new(),
        scalar => vec![(path.to_owned(), cell(scalar))],
    }
}

fn cell(value: &Value) -> String {
    match value {
        Value::String(word) => word.clone(),
        other => other.to_string(),
    }
}

fn trust(closed: Option<&Closed>, row: Option<&Row>) -> String {
    let Some(Closed { solve, .. }) = closed else {
        let faults = row.map(|row| row.faults.join("; ")).unwrap_or_default();
        return format!("false,refused,{},,,,,,,false", quoted(&faults));
    };
    let no_repair = row
        .filter(|row| row.only_takes_chordae)
        .map(|_| TAKES_CHORDAE.to_owned());
    format!(
        "{},{},{},{:e},{},{},{},{},{},{}",
        solve.certified,
        status_name(solve.status),
        quoted(&doubt(solve).or(no_repair).unwrap_or_default()),
        solve.residual,
        solve.iterations,
        solve.crossings,
        solve.max_penetration_mm,
        solve.discretisation_mm,
        solve.begun_at.map_or(String::new(), |number| number.to_string()),
        row.is_some_and(|row| row.found_by_search)
    )
}

/// All numbers of a closed state, each by its path: `annulus.ap_mm`, `leaflets.anterior.strain_p95`.
fn flat(closed: Option<&Closed>) -> BTreeMap<String, f64> {
    let Some(Ok(Value::Object(mut whole))) = closed.map(serde_json::to_value) else {
        return BTreeMap::new();
    };
    // Has columns of its own; what repairs did differs from row to row.
    whole.remove("solve");
    whole.remove("carried_out");
    // How many hold nothing at all: their names differ from row to row.
    let idle = |closed: &Closed| {
        closed
            .slack_neochordae
            .iter()
            .filter(|slack| slack.is_idle())
            .count()
    };
    let slack = closed.map_or(0, idle);
    whole.insert("slack_neochordae".to_owned(), slack.into());
    numbers(&whole.into())
}

/// All numbers in a value, each by its path.
pub(super) fn numbers(value: &Value) -> BTreeMap<String, f64> {
    let mut found = BTreeMap::new();
    gather("", value, &mut found);
    found
}

fn gather(path: &str, value: &Value, found: &mut BTreeMap<String, f64>) {
    let inside = |name: &str| match path {
        "" => name.to_owned(),
        _ => format!("{path}.{name}"),
    };
    match value {
        Value::Number(number) => {
            found.extend(number.as_f64().map(|number| (path.to_owned(), number)));
        }
        Value::Object(entries) => {
            entries
                .iter()
                .for_each(|(name, value)| gather(&inside(name), value, found));
        }
        Value::Array(items) => {
            for (number, item) in items.iter().enumerate() {
                let name = item.get("name").and_then(Value::as_str);
                let name = name.map_or_else(|| number.to_string(), str::to_owned);
                gather(&inside(&name), item, found);
            }
        }
        _ => {}
    }
}

/// A word as one cell (RFC 4180).
pub(super) fn quoted(word: &str) -> String {
    match word.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", word.replace('"', "\"\"")),
        false => word.to_owned(),
    }
}
