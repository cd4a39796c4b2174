//! Plans: repairs that every alternative has, alternatives, and lists and ranges of values that make many of one.

mod asked;
mod names;
mod numbers;
mod read;
mod sweep;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::Path;

use coapt::model::size::grouped;
use coapt::plan::{Alternative, Criterion};
use coapt::scene::{Fault, Plan, Repair, SCHEMA_VERSION, Space};

use super::files::Files;
use super::locate::located;
use super::{finish, folder_of, read_text};
pub use asked::{Asked, Bound, SAMPLE_LIMIT, Search};
pub use numbers::{number_keys, with_number};
use read::{Block, Document};

/// The alternatives of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternatives {
    /// What the plan is called.
    pub name: String,
    /// In the order of the file; of lists of values, the first key in the order of letters changes most slowly.
    pub alternatives: Vec<Alternative>,
    /// Where each repair stands in the file, `repair[0]` or `alternative[2].repair[0]`, shape `[alternative][repair]`.
    pub keys: Vec<Vec<String>>,
    /// What ranks them; none where the plan does not say.
    pub criteria: Option<Vec<Criterion>>,
    /// What else is asked for.
    pub asked: Asked,
    /// Which of the alternatives is the answer of the search; none before it was made, and where it has none.
    pub found_by_search: Option<usize>,
}

impl Alternatives {
    /// What ranks them: what the plan says, else the default.
    pub fn ranked_by(&self) -> Vec<Criterion> {
        let criteria = self.criteria.clone();
        criteria.unwrap_or_else(|| Criterion::default_with(self.asked.diastole))
    }
}

/// More alternatives are refused unless more are asked for: half an hour of closures of small valves (our choice).
pub const ALTERNATIVE_LIMIT: u64 = 10_000;

/// Reads a plan of one alternative and the ring curves that it names; the second part are the warnings.
///
/// # Errors
/// All faults found, errors and warnings, up to twenty of each, if one of them is an error.
pub fn read_plan(path: &Path) -> Result<(Plan, Vec<Fault>), Vec<Fault>> {
    let text = read_text(path).map_err(|fault| vec![fault])?;
    plan_from_text(path, &text)
}

/// The same with the text at hand.
///
/// # Errors
/// As [`read_plan`].
pub fn plan_from_text(path: &Path, text: &str) -> Result<(Plan, Vec<Fault>), Vec<Fault>> {
    let (mut only, warnings) = alternative_from_text(path, text)?;
    let plan = Plan {
        schema_version: SCHEMA_VERSION,
        name: only.name,
        repair: only.alternatives.remove(0).repairs,
    };
    Ok((plan, warnings))
}

/// The same with where the repairs stand.
///
/// # Errors
/// As [`read_plan`].
pub fn alternative_from_text(path: &Path, text: &str) -> Result<(Alternatives, Vec<Fault>), Vec<Fault>> {
    read(path, text, 1, |count| {
        format!("has {count} alternatives; expected one (`coapt plan SCENE PLAN` compares several)")
    })
}

/// All alternatives of a plan with the ring curves that they name, `limit` at most; the second part are the warnings.
///
/// # Errors
/// As [`read_plan`]; more alternatives than the limit, which are counted before they are made.
pub fn alternatives_from_text(
    path: &Path,
    text: &str,
    limit: u64,
) -> Result<(Alternatives, Vec<Fault>), Vec<Fault>> {
    alternatives_up_to(path, text, limit, "--max-alternatives")
}

/// The same for a caller whose users call the limit something else.
///
/// # Errors
/// As [`alternatives_from_text`].
pub fn alternatives_up_to(
    path: &Path,
    text: &str,
    limit: u64,
    limit_name: &str,
) -> Result<(Alternatives, Vec<Fault>), Vec<Fault>> {
    read(path, text, limit, |count| {
        let most = told(limit);
        format!(
            "has {count} alternatives, the product of its lists and ranges; expected {most} at most ({limit_name})"
        )
    })
}

fn read(
    path: &Path,
    text: &str,
    limit: u64,
    too_many: impl FnOnce(&str) -> String,
) -> Result<(Alternatives, Vec<Fault>), Vec<Fault>> {
    let name = path.display().to_string();
    let mut document = read::document(&name, text)?;
    let count = document.count();
    if count > limit {
        let told = told(count);
        return Err(vec![Fault::error(name, too_many(&told))]);
    }
    if count > MOST_ALTERNATIVES {
        let [told, most] = [count, MOST_ALTERNATIVES].map(told);
        let message = format!(
            "has {told} alternatives; expected {most} at most, whatever the limit: they are all held in memory"
        );
        return Err(vec![Fault::error(name, message)]);
    }
    document.expand(&name, text)?;
    let mut files = Files::new("plan", folder_of(path), Space::LPS, u32::MAX);
    let search = document.search.take();
    for (key, message) in &document.warnings {
        files.warning(key, message);
    }
    let mut made = alternatives(document, &mut files);
    files.judge_frames();
    // Among all alternatives, for it counts them as they stand in the file.
    let search = search.map(|keys| asked::search(keys, &made)).transpose();
    for (key, message) in fold(&mut made) {
        files.warning(&key, message);
    }
    let (mut made, warnings) = finish(made, &name, text, files)?;
    let told = |faults: Vec<Fault>| {
        let located = |fault: &Fault| located(&name, text, fault);
        faults.iter().map(located).collect::<Vec<_>>()
    };
    made.asked.search = search.map_err(told)?;
    Ok((made, warnings))
}

/// No limit lets more alternatives pass, our choice: a machine would be busy with them for days.
const MOST_ALTERNATIVES: u64 = 10_000_000;

/// What the valve as it is is called beside alternatives.
pub(crate) const BEFORE: &str = "before";

/// Takes alternatives out whose repairs are those of an earlier one, and tells them: closed again they would be the same valve, and share
/// its rank. Keys and messages of warnings.
fn fold(made: &mut Alternatives) -> Vec<(String, String)> {
    let mut repeated = Vec::new();
    let mut known: BTreeMap<String, String> = BTreeMap::new();
    let mut keys = std::mem::take(&mut made.keys).into_iter();
    for alternative in std::mem::take(&mut made.alternatives) {
        let keys = keys.next().unwrap_or_default();
        // Repairs are numbers and words, which can be written.
        let repairs = serde_json::to_string(&alternative.repairs).unwrap_or_default();
        if let Some(first) = known.get(&repairs) {
            let place = keys.last().cloned().unwrap_or_else(|| "alternative".to_owned());
            let message = format!("is done by `{first}` already; the alternative is closed once");
            repeated.push((place, message));
            continue;
        }
        known.insert(repairs, alternative.name.clone());
        made.alternatives.push(alternative);
        made.keys.push(keys);
    }
    repeated
}

fn told(count: u64) -> String {
    match count {
        u64::MAX => "more than 10^19".to_owned(),
        _ => grouped(usize::try_from(count).unwrap_or(usize::MAX)),
    }
}

/// All combinations.
fn alternatives(document: Document, files: &mut Files) -> Alternatives {
    let mut called = names::Names::new(&document);
    let mut made = Alternatives {
        name: document.name,
        alternatives: Vec::new(),
        keys: Vec::new(),
        criteria: document.criteria,
        asked: document.asked,
        found_by_search: None,
    };
    let common = combinations(document.common, files);
    for (number, block) in document.blocks.into_iter().enumerate() {
        let name = block.name.clone();
        let own = combinations(block, files);
        let is_one = common.len() * own.len() == 1;
        for first in &common {
            for then in &own {
                let parts = || first.iter().chain(then);
                let (title, is_taken) = called.name(
                    name.as_deref(),
                    is_one,
                    first.iter().map(|part| &part.called),
                    then.iter().map(|part| &part.called),
                );
                if let (Some(name), true) = (&name, is_taken) {
                    let message = format!("is `{name}`, as that of another; one of them is called `{title}`");
                    files.warning(&format!("alternative[{number}].name"), &message);
                }
                made.alternatives.push(Alternative {
                    name: title,
                    repairs: parts().map(|part| part.repair.clone()).collect(),
                });
                made.keys.push(parts().map(|part| part.key.clone()).collect());
            }
        }
    }
    // Clips and stitches close the valve in diastole too: a ranking that did not know would put the tightest first.
    made.asked.diastole |= document.leaves_diastole && made.alternatives.iter().any(Alternative::joins_edges);
    made
}

/// A repair with all its values.
#[derive(Clone)]
struct Part {
    key: String,
    repair: Repair,
    called: names::Called,
}

/// The product of what each repair of a block may be; of none, one combination with nothing in it.
fn combinations(block: Block, files: &mut Files) -> Vec<Vec<Part>> {
    let mut all = vec![Vec::new()];
    for place in block.repairs {
        let called: Vec<_> = place
            .sweeps
            .tables(&place.table)
            .map(|table| names::called(&table))
            .collect();
        let mut variants: Vec<Part> = Vec::new();
        for (mut repair, called) in place.variants.into_iter().zip(called) {
            fill(&place.key, &mut repair, files);
            variants.push(Part {
                key: place.key.clone(),
                repair,
                called,
            });
        }
        let with = |so_far: &Vec<Part>| -> Vec<Vec<Part>> {
            let and = |next: &Part| so_far.iter().chain([next]).cloned().collect();
            variants.iter().map(and).collect()
        };
        all = all.iter().flat_map(with).collect();
    }
    all
}

/// Reads the files that a repair names; only rings do.
fn fill(key: &str, repair: &mut Repair, files: &mut Files) {
    let Repair::Ring(ring) = repair else {
        return;
    };
    let key = format!("{key}.curve_file");
    let Some(file) = ring.curve_file.take() else {
        return;
    };
    if ring.curve_mm.is_some() {
        files.error(&key, "is given beside `curve_mm`; expected one of the two");
    } else if let Some(curve) = files.curve(&key, &file) {
        ring.closed.get_or_insert(curve.closed);
        ring.curve_mm = Some(curve.points_mm);
    }
}
