//! What a plan asks for beside its alternatives: the open valve, rates, ensembles, a search.

use coapt::plan::ensemble::Uncertainty;
use coapt::plan::{Criterion, Sampling};
use coapt::scene::{Fault, Readable, Repair};
use serde::Deserialize;

use super::Alternatives;
use super::numbers::{number_keys, with_number};

/// What a plan asks for beside its alternatives.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Asked {
    /// The orifice of each valve without pressure.
    pub diastole: bool,
    /// Rates of the criteria with the numbers in the repairs.
    pub sensitivities: bool,
    /// Whether alternatives may begin at each other's closed shapes ([`coapt::plan::Settings::warm`]).
    pub warm: bool,
    /// Ensembles of valves like the given one.
    pub sampling: Option<Sampling>,
    /// The gentlest value that reaches a goal.
    pub search: Option<Search>,
}

/// Which value of a number in a repair is the gentlest that reaches a goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Where the number's repair stands in the file: `repair[0]`.
    pub place: String,
    /// All repairs, of which the number is one's.
    pub repairs: Vec<Repair>,
    /// Where each of them stands, shape `[repair]`.
    pub places: Vec<String>,
    /// Which of these, from 0.
    pub repair: usize,
    /// The key of the number.
    pub key: String,
    /// The gentlest value.
    pub from: f64,
    /// The most drastic value.
    pub to: f64,
    /// How exactly the answer is wanted.
    pub tolerance: f64,
    /// The measure that matters: a criterion, or a column of `plan.csv`.
    pub measure: String,
    /// What it should reach.
    pub bound: Bound,
}

/// What a measure should reach, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// So much or more.
    AtLeast(f64),
    /// So much or less.
    AtMost(f64),
}

/// `[uncertainty]` as it is written.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct SamplingKeys {
    samples: u32,
    seed: u64,
    alternatives: usize,
    chord_length: f64,
    chord_length_common: f64,
    transition_strain: f64,
    annulus_mm: f64,
    papillary_mm: f64,
    pressure: f64,
}

impl Default for SamplingKeys {
    fn default() -> Self {
        let Sampling {
            samples,
            seed,
            alternatives,
            uncertainty,
        } = Sampling::default();
        Self {
            samples,
            seed,
            alternatives,
            chord_length: uncertainty.chord_length,
            chord_length_common: uncertainty.chord_length_common,
            transition_strain: uncertainty.transition_strain,
            annulus_mm: uncertainty.annulus_mm,
            papillary_mm: uncertainty.papillary_mm,
            pressure: uncertainty.pressure,
        }
    }
}

/// `[search]` as it is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SearchKeys {
    #[serde(default)]
    alternative: Option<usize>,
    #[serde(default)]
    repair: usize,
    key: String,
    from: f64,
    to: f64,
    tolerance: f64,
    measure: String,
    #[serde(default)]
    at_least: Option<f64>,
    #[serde(default)]
    at_most: Option<f64>,
}

/// Closures tell no finer values apart than this part of a range that is searched (our choice): they are exact to a millionth of
/// the load.
const FINEST_TOLERANCE: f64 = 1e-6;

/// More samples than these tell nothing more than how exact the standard deviations would have to be (our choice).
pub const SAMPLE_LIMIT: u32 = 100_000;

/// The ensembles that the keys ask for, with what is wrong in them.
pub(super) fn sampling(keys: &SamplingKeys) -> (Sampling, Vec<Fault>) {
    let uncertainty = Uncertainty {
        chord_length: keys.chord_length,
        chord_length_common: keys.chord_length_common,
        transition_strain: keys.transition_strain,
        annulus_mm: keys.annulus_mm,
        papillary_mm: keys.papillary_mm,
        pressure: keys.pressure,
    };
    let mut faults = uncertainty.check().err().unwrap_or_default();
    if !(1..=SAMPLE_LIMIT).contains(&keys.samples) {
        let message = format!("is {}; expected 1 to {SAMPLE_LIMIT}", keys.samples);
        faults.push(Fault::error("uncertainty.samples", message));
    }
    let sampling = Sampling {
        samples: keys.samples,
        seed: keys.seed,
        alternatives: keys.alternatives,
        uncertainty,
    };
    (sampling, faults)
}

/// The search that the keys ask for, among the alternatives that were made; of lists and ranges in other keys, the first values count.
///
/// # Errors
/// All that is wrong with it.
pub(super) fn search(keys: SearchKeys, made: &Alternatives) -> Result<Search, Vec<Fault>> {
    let mut faults = Vec::new();
    let mut fault = |key: &str, message: String| faults.push(Fault::error(format!("search{key}"), message));
    let bound = match (keys.at_least, keys.at_most) {
        (Some(least), None) => Some(Bound::AtLeast(least)),
        (None, Some(most)) => Some(Bound::AtMost(most)),
        (None, None) => {
            fault("", "has no goal; expected `at_least` or `at_most`".into());
            None
        }
        (Some(_), Some(_)) => {
            fault(
                ".at_most",
                "is given beside `at_least`; expected one of the two".into(),
            );
            None
        }
    };
    for (key, number) in [
        (".from", Some(keys.from)),
        (".to", Some(keys.to)),
        (".at_least", keys.at_least),
        (".at_most", keys.at_most),
    ] {
        if number.is_some_and(|number| !number.is_finite()) {
            fault(
                key,
                format!("is {}; expected a number", number.unwrap_or_default()),
            );
        }
    }
    if keys.from == keys.to {
        fault(
            ".to",
            format!("is {}, as is `from`; expected another number", keys.to),
        );
    }
    let least = FINEST_TOLERANCE * (keys.to - keys.from).abs();
    if !(keys.tolerance > 0.0 && keys.tolerance.is_finite()) || keys.tolerance < least {
        let least = match least > 0.0 && least.is_finite() {
            true => format!("{} or more, a millionth of the range", Readable(least)),
            false => "more than 0".to_owned(),
        };
        let message = format!("is {}; expected {least}", Readable(keys.tolerance));
        fault(".tolerance", message);
    }
    if keys.measure == Criterion::DiastolicOrifice.name() {
        let message = format!("is `{}`; expected a measure of the closed valve", keys.measure);
        fault(".measure", message);
    }
    let found = repairs_of(&keys, made);
    match &found {
        Ok((repairs, _, repair)) => {
            if let Err(message) = takes(&repairs[*repair], &keys) {
                fault(".key", message);
            }
        }
        Err((key, message)) => fault(key, message.clone()),
    }
    let (Ok((repairs, places, repair)), Some(bound), true) = (found, bound, faults.is_empty()) else {
        return Err(faults);
    };
    Ok(Search {
        place: places[repair].clone(),
        repairs,
        places,
        repair,
        key: keys.key,
        from: keys.from,
        to: keys.to,
        tolerance: keys.tolerance,
        measure: keys.measure,
        bound,
    })
}

/// Repairs, where each stands, and which of them is meant.
type Meant = (Vec<Repair>, Vec<String>, usize);

/// What is done in a search: all of the first alternative that has the repair, or, where the repair is one that every alternative
/// begins with, these alone.
fn repairs_of(keys: &SearchKeys, made: &Alternatives) -> Result<Meant, (&'static str, String)> {
    let start = match keys.alternative {
        Some(number) => format!("alternative[{number}]."),
        None => String::new(),
    };
    let place = format!("{start}repair[{}]", keys.repair);
    let is_own = |at: &&String| keys.alternative.is_some() || !at.starts_with("alternative");
    let found = made.keys.iter().position(|places| places.contains(&place));
    let Some(found) = found else {
        let is_there = |places: &Vec<String>| places.iter().any(|at| at.starts_with(&start));
        return Err(match (keys.alternative, made.keys.iter().any(is_there)) {
            (Some(number), false) => (
                ".alternative",
                format!("is {number}; expected the number of an alternative with repairs, from 0"),
            ),
            (Some(_), true) => (
                ".repair",
                format!(
                    "is {}; expected the number of one of that alternative's repairs, from 0",
                    keys.repair
                ),
            ),
            (None, _) => (
                ".repair",
                format!(
                    "is {}; expected the number of a repair that every alternative begins with, from 0, or `alternative` beside it",
                    keys.repair
                ),
            ),
        });
    };
    let places: Vec<String> = made.keys[found].iter().filter(is_own).cloned().collect();
    let repairs = made.alternatives[found].repairs[..places.len()].to_vec();
    let repair = places.iter().position(|at| *at == place).unwrap_or(0);
    Ok((repairs, places, repair))
}

/// Whether a repair takes numbers at the key.
fn takes(repair: &Repair, keys: &SearchKeys) -> Result<(), String> {
    let middle = f64::midpoint(keys.from, keys.to);
    for number in [keys.from, keys.to, middle] {
        if let Err(message) = with_number(repair, &keys.key, number) {
            let known: Vec<String> = number_keys(repair)
                .iter()
                .map(|(key, _)| format!("`{key}`"))
                .collect();
            let known = match known.is_empty() {
                true => "a key that takes a number".to_owned(),
                false => format!("a key that takes a number, such as {}", known.join(", ")),
            };
            let key = &keys.key;
            return Err(match message.starts_with("invalid type") {
                true => format!("is `{key}`, which takes no number; expected {known}"),
                false => format!("is `{key}`: {message}; expected {known}"),
            });
        }
    }
    Ok(())
}
