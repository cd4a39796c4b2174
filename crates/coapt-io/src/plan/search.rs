//! The gentlest value that reaches a goal: what is sought by keys, found by the library, told in a sentence.

use std::fmt::Write;
use std::ops::ControlFlow;

use coapt::measure::{Measures, measure};
use coapt::model::Model;
use coapt::plan::{Criterion, apply_all};
use coapt::relax::Moment;
use coapt::scene::{Fault, Repair};
use coapt::search::{Goal, Tried, search_watched};
use serde::{Deserialize, Serialize};

use super::in_plan;
use super::table::numbers;
use super::words::{measure_words, rounded};
use crate::report::{NOT_CERTIFIED, line, number};
use crate::scene::{Bound, Search, nearest, sentence as said, with_number};

/// What was sought and what was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SearchReport {
    /// Where the repair stands whose number was sought.
    pub place: String,
    /// The number's key.
    pub key: String,
    /// The gentlest value of the range.
    pub from: f64,
    /// The most drastic value.
    pub to: f64,
    /// How exactly the answer was wanted.
    pub tolerance: f64,
    /// The measure that matters.
    pub measure: String,
    /// The least that it should be, in its unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
    /// The most that it should be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
    /// The gentlest value found that reaches the goal, with a certificate; none where no value tried does.
    pub answer: Option<Tried>,
    /// The gentlest value beyond the answer, among those tried, at which the goal is lost again; absent where it is kept to the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_again: Option<Tried>,
    /// The repairs with the answer; empty where there is none.
    pub repairs: Vec<Repair>,
    /// All values tried, from the gentlest to the most drastic.
    pub tried: Vec<Tried>,
}

/// The value of a measure by its name: a criterion's, or the path of a number in `plan.json`, with `/` or `.` between its steps.
pub fn measured(name: &str, measures: &Measures) -> Option<f64> {
    let by_name = |criterion: &Criterion| criterion.name() == name;
    if let Some(criterion) = Criterion::ALL.into_iter().find(by_name) {
        return criterion.value(measures, None);
    }
    let all = numbers(&serde_json::to_value(measures).ok()?);
    all.get(&name.replace('/', ".")).copied()
}

/// Seeks.
///
/// # Errors
/// A measure that there is not, with its key in the plan; the faults of a value for which the repairs cannot be carried out.
pub fn found(
    model: &Model,
    search: &Search,
    watch: &(dyn Fn(&Moment) -> ControlFlow<()> + Sync),
) -> Result<SearchReport, Vec<Fault>> {
    check(model, search)?;
    let (sign, least) = match search.bound {
        Bound::AtLeast(least) => (1.0, least),
        Bound::AtMost(most) => (-1.0, -most),
    };
    let goal = Goal {
        gentlest: search.from,
        most_drastic: search.to,
        tolerance: search.tolerance,
        at_least: least,
        measure: |measures: &Measures| sign * measured(&search.measure, measures).unwrap_or(f64::NAN),
    };
    let found = search_watched(&goal, |value| model_at(model, search, value), watch)?;
    let signed = |tried: Tried| Tried {
        measured: sign * tried.measured,
        ..tried
    };
    let answer = found.answer.map(signed);
    let lost_again = found.lost_again(least).map(signed);
    Ok(SearchReport {
        place: search.place.clone(),
        key: search.key.clone(),
        from: search.from,
        to: search.to,
        tolerance: search.tolerance,
        measure: search.measure.clone(),
        at_least: (sign > 0.0).then_some(least),
        at_most: (sign < 0.0).then_some(-least),
        repairs: match answer {
            Some(answer) => repairs_at(search, answer.value)?,
            None => Vec::new(),
        },
        answer,
        lost_again,
        tried: found.tried.into_iter().map(signed).collect(),
    })
}

/// What can be said against a search before minutes of work.
///
/// # Errors
/// As [`found`], but for what the values between the ends of the range bring up.
pub(super) fn check(model: &Model, search: &Search) -> Result<(), Vec<Fault>> {
    check_measure(model, search).map_err(|fault| vec![fault])?;
    check_ends(model, search)
}

/// Whether there is such a measure.
fn check_measure(model: &Model, search: &Search) -> Result<(), Fault> {
    let open = measure(model, &model.rest_mm, &[]);
    if measured(&search.measure, &open).is_some() {
        return Ok(());
    }
    let paths = numbers(&serde_json::to_value(&open).unwrap_or_default());
    let names = Criterion::ALL.map(Criterion::name).into_iter();
    let known: Vec<&str> = names.chain(paths.keys().map(String::as_str)).collect();
    let hint = match nearest(&search.measure.replace('/', "."), known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => {
            "expected a criterion or a measure of plan.json, such as `coaptation/length_a2p2_mm`".to_owned()
        }
    };
    Err(Fault::error(
        "search.measure",
        format!("is `{}`, which is not measured; {hint}", search.measure),
    ))
}

/// Whether the repairs can be carried out at both ends of the range, which are told by their own keys: else one of the values between
/// would be blamed, which nobody wrote.
fn check_ends(model: &Model, search: &Search) -> Result<(), Vec<Fault>> {
    let mut wrong = Vec::new();
    for (key, value) in [("search.from", search.from), ("search.to", search.to)] {
        let refused = match apply_all(model, &repairs_at(search, value)?) {
            Ok(_) => continue,
            Err(refusal) => refusal,
        };
        let place = &search.places[refused.repair];
        let faults = refused.faults.iter();
        let told: Vec<String> = faults.map(|fault| said(&in_plan(place, fault))).collect();
        let message = format!("is {value}, at which {}", told.join("; "));
        wrong.push(Fault::error(key, message));
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong) }
}

fn repairs_at(search: &Search, value: f64) -> Result<Vec<Repair>, Vec<Fault>> {
    let mut repairs = search.repairs.clone();
    let changed = with_number(&repairs[search.repair], &search.key, value);
    repairs[search.repair] =
        changed.map_err(|message| vec![Fault::error(format!("{}.{}", search.place, search.key), message)])?;
    Ok(repairs)
}

fn model_at(model: &Model, search: &Search, value: f64) -> Result<Model, Vec<Fault>> {
    let applied = apply_all(model, &repairs_at(search, value)?);
    let told = |fault: &Fault| Fault {
        message: format!("{} (at {} = {value})", fault.message, search.key),
        ..fault.clone()
    };
    match applied {
        Ok(applied) => Ok(applied.model),
        Err(refusal) => {
            let place = &search.places[refusal.repair];
            let faults = refusal.faults.iter();
            Err(faults.map(|fault| in_plan(place, &told(fault))).collect())
        }
    }
}

/// The answer as a sentence, and the values tried as a table.
pub(super) fn told(out: &mut String, report: &SearchReport) {
    out.push('\n');
    line(out, "search", &sentence(report));
    let width = report.key.len().max(COLUMN);
    // Writing to a string cannot fail.
    let _ = writeln!(out, "  {:>width$}  {}", report.key, heading(report));
    for [value, measured, mark] in tried(report) {
        let line = format!("  {value:>width$}  {measured:>COLUMN$}  {mark}");
        let _ = writeln!(out, "{}", line.trim_end());
    }
}

/// What stands over the measured values.
pub(crate) fn heading(report: &SearchReport) -> String {
    match measure_words(&report.measure) {
        (title, "", _) => title,
        (title, unit, _) => format!("{title} [{unit}]"),
    }
}

/// The values tried as cells: value, measure, and what it is.
pub(crate) fn tried(report: &SearchReport) -> impl Iterator<Item = [String; 3]> {
    let (_, _, factor) = measure_words(&report.measure);
    report.tried.iter().map(move |tried| {
        let mark = match (tried.certified, report.answer.as_ref() == Some(tried)) {
            (false, _) => NOT_CERTIFIED,
            (true, true) => "the answer",
            (true, false) => "",
        };
        [
            shown(tried.value),
            shown(factor * tried.measured),
            mark.to_owned(),
        ]
    })
}

const COLUMN: usize = 10;

/// A value to three digits behind the point.
pub(super) fn shown(value: f64) -> String {
    number(value, 3)
}

/// The answer in a sentence.
pub(crate) fn sentence(report: &SearchReport) -> String {
    let SearchReport {
        key, from, to, place, ..
    } = report;
    let (measure, unit, factor) = measure_words(&report.measure);
    let bound = |value: f64| {
        let told = format!("{measure} of {} {unit}", rounded(factor * value));
        told.trim_end().to_owned()
    };
    let goal = match (report.at_least, report.at_most) {
        (Some(least), _) => format!("{} or more", bound(least)),
        (_, most) => format!("{} or less", bound(most.unwrap_or_default())),
    };
    let measured = |tried: &Tried| shown(factor * tried.measured);
    let range = format!("`{key}` of {place} from {from} to {to}");
    let Some(answer) = report.answer else {
        return format!("no {range} that was tried gives {goal} with a certificate");
    };
    let before = report
        .tried
        .iter()
        .take_while(|tried| tried.value != answer.value)
        .last();
    let short = match before {
        None => "; it is the first of the range".to_owned(),
        Some(tried) if tried.certified => {
            format!("; {}, before it, gives {}", shown(tried.value), measured(tried))
        }
        Some(tried) => format!(
            "; {}, before it, did not close with a certificate",
            shown(tried.value)
        ),
    };
    let lost = match report.lost_again {
        None => String::new(),
        Some(tried) if tried.certified => format!(
            "; beyond it the goal is lost again: {} gives {}",
            shown(tried.value),
            measured(&tried)
        ),
        Some(tried) => format!(
            "; beyond it the goal is lost again: {} did not close with a certificate",
            shown(tried.value)
        ),
    };
    format!(
        "the first {range} that gives {goal} is {}: it gives {}, certified{short}{lost}",
        shown(answer.value),
        measured(&answer)
    )
}
