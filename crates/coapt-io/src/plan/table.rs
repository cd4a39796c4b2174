//! A comparison as a table for machines: a line per alternative, a column per measure.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use serde_json::Value;

use super::text::doubt;
use super::{Closed, PlanReport};
use crate::study::status_name;

const COLUMNS: &str = "number,rank,name,certified,status,reason,residual,iterations,crossings,max_penetration_mm,\
                       discretisation_mm,begun_at";

/// A line per alternative, the best first, after one of number 0 for the valve as it is; columns with their names in the first
/// line. A measure is called by its path in `plan.json`; what an alternative lacks is empty.
pub fn csv(report: &PlanReport) -> String {
    let before = (0, None, "before", Some(&report.before), &[][..]);
    let rows = report.alternatives.iter().map(|row| {
        (
            row.number,
            row.rank,
            row.name.as_str(),
            row.closed.as_ref(),
            &row.faults[..],
        )
    });
    let rows: Vec<_> = std::iter::once(before).chain(rows).collect();
    let measures: Vec<BTreeMap<String, f64>> =
        rows.iter().map(|(_, _, _, closed, _)| flat(*closed)).collect();
    let names: BTreeSet<&String> = measures.iter().flat_map(BTreeMap::keys).collect();
    let mut out = COLUMNS.to_owned();
    for name in &names {
        out.push(',');
        out += &quoted(name);
    }
    out.push('\n');
    for ((number, rank, name, closed, faults), measures) in rows.iter().zip(&measures) {
        let rank = rank.map_or(String::new(), |rank| rank.to_string());
        // Writing to a string cannot fail.
        let _ = write!(out, "{number},{rank},{},", quoted(name));
        out += &trust(*closed, faults);
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

fn trust(closed: Option<&Closed>, faults: &[String]) -> String {
    let Some(Closed { solve, .. }) = closed else {
        return format!("false,refused,{},,,,,,", quoted(&faults.join("; ")));
    };
    format!(
        "{},{},{},{:e},{},{},{},{},{}",
        solve.certified,
        status_name(solve.status),
        quoted(&doubt(solve).unwrap_or_default()),
        solve.residual,
        solve.iterations,
        solve.crossings,
        solve.max_penetration_mm,
        solve.discretisation_mm,
        solve.begun_at.map_or(String::new(), |number| number.to_string())
    )
}

/// All numbers of a closed state, each by its path: `annulus.ap_mm`, `leaflets.anterior.strain_p95`.
fn flat(closed: Option<&Closed>) -> BTreeMap<String, f64> {
    let Some(Ok(Value::Object(mut whole))) = closed.map(serde_json::to_value) else {
        return BTreeMap::new();
    };
    // Has columns of its own.
    whole.remove("solve");
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
