//! The text of a plan as repairs with their lists and ranges, every fault with its line.

use coapt::plan::Criterion;
use coapt::scene::{Fault, Repair};
use serde::Deserialize;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

use super::super::document::{is_json, parse_json, toml_table, typed};
use super::super::limited;
use super::super::locate::located;
use super::BEFORE;
use super::asked::{Asked, SamplingKeys, SearchKeys, sampling};
use super::sweep::{KIND, Sweeps, alone, repair, sweeps};

/// A plan as it stands in its file, before alternatives are made of it.
#[derive(Clone, Debug)]
pub(super) struct Document {
    pub(super) name: String,
    /// What every alternative begins with.
    pub(super) common: Block,
    /// What is done after that, one for each `[[alternative]]`; where there is none, one with nothing in it.
    pub(super) blocks: Vec<Block>,
    /// What ranks; none where the default does.
    pub(super) criteria: Option<Vec<Criterion>>,
    /// What is asked for, but for the search.
    pub(super) asked: Asked,
    /// Whether the plan leaves it to us to compute the open valve: it neither says so nor what ranks.
    pub(super) leaves_diastole: bool,
    pub(super) search: Option<SearchKeys>,
    /// What is done otherwise than the file says, each with its key there.
    pub(super) warnings: Vec<(String, String)>,
}

/// Repairs one after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) name: Option<String>,
    pub(super) repairs: Vec<Place>,
}

/// A repair in the file.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// Where it stands: `alternative[2].repair[0]`.
    pub(super) key: String,
    /// As written, with the first value of each list and range.
    pub(super) table: Table,
    pub(super) sweeps: Sweeps,
    /// What its lists and ranges make of it; empty until they are counted.
    pub(super) variants: Vec<Repair>,
}

impl Block {
    fn count(&self) -> u64 {
        let counts = self.repairs.iter().map(|place| place.sweeps.count());
        counts.fold(1, u64::saturating_mul)
    }
}

impl Document {
    /// How many alternatives it makes; the largest number there is stands for more as well.
    pub(super) fn count(&self) -> u64 {
        let common = self.common.count();
        let counts = self
            .blocks
            .iter()
            .map(|block| common.saturating_mul(block.count()));
        counts.fold(0, u64::saturating_add)
    }

    fn places(&mut self) -> impl Iterator<Item = &mut Place> {
        let blocks = std::iter::once(&mut self.common).chain(&mut self.blocks);
        blocks.flat_map(|block| &mut block.repairs)
    }
}

/// A plan in which each list and range has been replaced by its first value.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlanOfOne {
    #[allow(dead_code, reason = "checked with the text; it must be there")]
    schema_version: u32,
    #[serde(default)]
    name: String,
    #[serde(default)]
    repair: Vec<Repair>,
    #[serde(default)]
    alternative: Vec<AlternativeOfOne>,
    #[serde(default)]
    ranking: Option<Ranking>,
    #[serde(default)]
    diastole: Option<bool>,
    #[serde(default)]
    sensitivities: bool,
    #[serde(default)]
    warm: bool,
    #[serde(default)]
    uncertainty: Option<SamplingKeys>,
    #[serde(default)]
    search: Option<SearchKeys>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AlternativeOfOne {
    #[serde(default)]
    name: Option<String>,
    #[serde(default)]
    repair: Vec<Repair>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Ranking {
    criteria: Vec<Criterion>,
}

/// Reads a plan.
///
/// # Errors
/// All faults of one kind: of the syntax, else of the lists and ranges, else of keys and types.
pub(super) fn document(file: &str, text: &str) -> Result<Document, Vec<Fault>> {
    let (mut places, read) = match is_json(text) {
        true => from_json(file, text)?,
        false => from_toml(file, text)?,
    };
    let mut faults = Vec::new();
    let mut fault = |key: String, message: String| faults.push(Fault::error(key, message));
    for place in &mut places {
        for (key, message) in place.sweeps.settle(&mut place.table) {
            fault(format!("{}.{key}", place.key), message);
        }
    }
    let criteria = read.ranking.as_ref().map(|ranking| &ranking.criteria[..]);
    if let Some(message) = criteria.and_then(doubt) {
        fault("ranking.criteria".to_owned(), message);
    }
    for wrong in read.uncertainty.iter().flat_map(|keys| sampling(keys).1) {
        fault(wrong.place, wrong.message);
    }
    faults.extend(unusable(&read));
    if !faults.is_empty() {
        return Err(refused(file, text, &faults));
    }
    let mut warnings = Vec::from_iter(contradiction(&read));
    for place in &mut places {
        let of = place.sweeps.fold().into_iter();
        warnings.extend(of.map(|(key, message)| (format!("{}.{key}", place.key), message)));
    }
    Ok(Document {
        warnings,
        ..grouped(read, places)
    })
}

/// Errors with their lines.
fn refused(file: &str, text: &str, errors: &[Fault]) -> Vec<Fault> {
    limited(file, errors, Fault::error, |fault| located(file, text, fault))
}

/// Alternatives that do nothing, or whose names would be taken for something else.
fn unusable(read: &PlanOfOne) -> Vec<Fault> {
    let mut faults = Vec::new();
    let lacks_common = read.repair.is_empty();
    if lacks_common && read.alternative.is_empty() {
        let message = "is missing; expected at least one [[repair]] or [[alternative.repair]]";
        faults.push(Fault::error("repair", message));
    }
    for (number, alternative) in read.alternative.iter().enumerate() {
        let key = format!("alternative[{number}]");
        if lacks_common && alternative.repair.is_empty() {
            let message = "has no repair; expected at least one [[alternative.repair]] (the valve as it is stands first in any case)";
            faults.push(Fault::error(key.clone(), message));
        }
        let name = alternative.name.as_deref().map(str::trim);
        if let Some("" | BEFORE) = name {
            let message = format!(
                "is `{}`; expected a name that tells it from others, `{BEFORE}` being that of the valve as it is",
                name.unwrap_or_default()
            );
            faults.push(Fault::error(format!("{key}.name"), message));
        }
    }
    faults
}

/// Whether it refuses open valves and ranks by them: key and message.
fn contradiction(read: &PlanOfOne) -> Option<(String, String)> {
    let message = || {
        format!(
            "is false, but `ranking.criteria` has `{}`, for which a comparison computes open valves",
            Criterion::DiastolicOrifice.name()
        )
    };
    (read.diastole == Some(false) && ranks_open(read)).then(|| ("diastole".to_owned(), message()))
}

fn ranks_open(read: &PlanOfOne) -> bool {
    let criteria = read.ranking.as_ref().map(|ranking| &ranking.criteria);
    criteria.is_some_and(|criteria| criteria.contains(&Criterion::DiastolicOrifice))
}

/// What is wrong with criteria.
fn doubt(criteria: &[Criterion]) -> Option<String> {
    let twice = (1..criteria.len()).find(|&i| criteria[..i].contains(&criteria[i]));
    match (criteria, twice) {
        ([], _) => {
            let all = Criterion::ALL.map(Criterion::name).join(", ");
            Some(format!("is an empty list; expected some of {all}"))
        }
        (_, Some(twice)) => Some(format!(
            "has `{}` twice; expected each once",
            criteria[twice].name()
        )),
        _ => None,
    }
}

fn grouped(read: PlanOfOne, places: Vec<Place>) -> Document {
    let ranks_open = ranks_open(&read);
    let mut places = places.into_iter();
    let mut block = |name: Option<String>, count: usize| Block {
        name,
        repairs: places.by_ref().take(count).collect(),
    };
    let common = block(None, read.repair.len());
    let named = read.alternative.into_iter();
    let mut blocks: Vec<Block> = named.map(|it| block(it.name, it.repair.len())).collect();
    if blocks.is_empty() {
        blocks.push(Block::default());
    }
    let criteria = read.ranking.map(|ranking| ranking.criteria);
    Document {
        name: read.name,
        common,
        blocks,
        asked: Asked {
            // What ranks is computed.
            diastole: read.diastole == Some(true) || ranks_open,
            sensitivities: read.sensitivities,
            warm: read.warm,
            sampling: read.uncertainty.map(|keys| sampling(&keys).0),
            search: None,
        },
        leaves_diastole: read.diastole.is_none() && criteria.is_none(),
        search: read.search,
        warnings: Vec::new(),
        criteria,
    }
}

impl Document {
    /// Makes the repairs of all values; for who has counted them.
    pub(super) fn expand(&mut self, file: &str, text: &str) -> Result<(), Vec<Fault>> {
        for place in self.places() {
            let made = place
                .sweeps
                .tables(&place.table)
                .map(repair)
                .collect::<Result<_, _>>();
            place.variants =
                made.map_err(|message| vec![located(file, text, &Fault::error(place.key.clone(), message))])?;
        }
        Ok(())
    }
}

/// The repairs of a document, common ones first, with what is wrong in their lists and ranges.
fn places(file: &str, text: &str, document: &Table) -> Result<Vec<Place>, Vec<Fault>> {
    let (mut places, mut faults) = (Vec::new(), Vec::new());
    for (key, table) in tables(document) {
        let (sweeps, wrong) = sweeps(&table);
        faults.extend(
            wrong
                .into_iter()
                .map(|(of, message)| Fault::error(format!("{key}.{of}"), message)),
        );
        places.push(Place {
            key,
            table,
            sweeps,
            variants: Vec::new(),
        });
    }
    match faults.is_empty() {
        true => Ok(places),
        false => Err(refused(file, text, &faults)),
    }
}

/// All repairs, each with its key. What is no table is left for the types to complain of.
fn tables(document: &Table) -> Vec<(String, Table)> {
    let of = |start: &str, block: &Table| -> Vec<(String, Table)> {
        let repairs = list_of(block, "repair").iter().enumerate();
        let table = |(number, value): (usize, &Value)| {
            Some((format!("{start}repair[{number}]"), value.as_table()?.clone()))
        };
        repairs.filter_map(table).collect()
    };
    let mut all = of("", document);
    for (number, block) in list_of(document, "alternative").iter().enumerate() {
        let repairs = block
            .as_table()
            .map(|block| of(&format!("alternative[{number}]."), block));
        all.extend(repairs.unwrap_or_default());
    }
    all
}

fn list_of<'a>(table: &'a Table, key: &str) -> &'a [Value] {
    table
        .get(key)
        .and_then(Value::as_array)
        .map_or(&[], Vec::as_slice)
}

fn from_toml(file: &str, text: &str) -> Result<(Vec<Place>, PlanOfOne), Vec<Fault>> {
    let mut document = toml_table(file, text)?;
    // What cannot be read without types cannot be read with them, which tells why.
    let plain = Table::deserialize(toml::Deserializer::from(document.clone())).unwrap_or_default();
    let places = places(file, text, &plain)?;
    for place in &places {
        let Some(table) = follow(document.get_mut(), &place.key) else {
            continue;
        };
        for sweep in &place.sweeps.0 {
            if let Some(value) = table.get_mut(sweep.key.as_str()) {
                put_first(value);
            }
        }
    }
    Ok((places, typed(file, text, document)?))
}

/// The table at a key such as `alternative[2].repair[0]`.
fn follow<'a, 'i>(table: &'a mut DeTable<'i>, key: &str) -> Option<&'a mut DeTable<'i>> {
    let mut table = table;
    for step in key.split('.') {
        let (name, number) = step.strip_suffix(']')?.split_once('[')?;
        let DeValue::Array(items) = table.get_mut(name)?.get_mut() else {
            return None;
        };
        match items.get_mut(number.parse::<usize>().ok()?)?.get_mut() {
            DeValue::Table(inner) => table = inner,
            _ => return None,
        }
    }
    Some(table)
}

/// The first value of a list or range in its place, which knows where it stood.
fn put_first(value: &mut Spanned<DeValue<'_>>) {
    let first = match value.get_ref() {
        DeValue::Array(items) => items.iter().next().cloned(),
        DeValue::Table(range) => range.get("from").cloned(),
        _ => None,
    };
    if let Some(first) = first {
        *value = first;
    }
}

/// Of JSON with lists or ranges, faults are told by their keys, without lines.
fn from_json(file: &str, text: &str) -> Result<(Vec<Place>, PlanOfOne), Vec<Fault>> {
    let whole = serde_json::from_str(text).ok().and_then(without_null);
    let Some(Value::Table(mut document)) = whole else {
        return Ok((Vec::new(), parse_json(file, text)?));
    };
    let mut places = places(file, text, &document)?;
    if places.iter().all(|place| place.sweeps.0.is_empty()) {
        return Ok((places, parse_json(file, text)?));
    }
    let mut faults = Vec::new();
    for place in &mut places {
        place.sweeps.settle(&mut place.table);
        if let Some((key, message)) = wrong_key(&place.table) {
            faults.push(Fault::error(format!("{}{key}", place.key), message));
        }
        put(&mut document, &place.key, &place.table);
    }
    if !faults.is_empty() {
        return Err(refused(file, text, &faults));
    }
    let document =
        serde_json::to_string(&document).map_err(|error| vec![Fault::error(file, error.to_string())])?;
    // Lines of this text are not those of the file.
    let unplaced = |fault: Fault| Fault {
        place: file.to_owned(),
        ..fault
    };
    let read = parse_json(file, &document);
    Ok((
        places,
        read.map_err(|faults: Vec<Fault>| faults.into_iter().map(unplaced).collect::<Vec<_>>())?,
    ))
}

/// A JSON value as one that has no null: null in a table is as good as nothing.
fn without_null(value: serde_json::Value) -> Option<Value> {
    use serde_json::Value as Json;
    Some(match value {
        Json::Null => return None,
        Json::Array(items) => Value::Array(items.into_iter().filter_map(without_null).collect()),
        Json::Object(entries) => Value::Table(
            entries
                .into_iter()
                .filter_map(|(key, value)| Some((key, without_null(value)?)))
                .collect(),
        ),
        scalar => Value::try_from(scalar).ok()?,
    })
}

/// What is wrong with a repair, and the key at fault where it is one.
fn wrong_key(table: &Table) -> Option<(String, String)> {
    let message = repair(table.clone()).err()?;
    let of_key = |(key, value): (&String, &Value)| {
        let message = alone(table, key, value.clone()).err()?;
        Some((format!(".{key}"), message))
    };
    let found = table.iter().filter(|(key, _)| *key != KIND).find_map(of_key);
    Some(found.unwrap_or((String::new(), message)))
}

/// Puts a repair back where it stood.
fn put(document: &mut Table, key: &str, table: &Table) {
    let mut inside = document;
    let mut steps = key.split('.').peekable();
    while let Some(step) = steps.next() {
        let Some((name, number)) = step.trim_end_matches(']').split_once('[') else {
            return;
        };
        let number: usize = number.parse().unwrap_or(usize::MAX);
        let item = inside
            .get_mut(name)
            .and_then(Value::as_array_mut)
            .and_then(|items| items.get_mut(number));
        match (item, steps.peek()) {
            (Some(item), None) => return *item = Value::Table(table.clone()),
            (Some(Value::Table(next)), Some(_)) => inside = next,
            _ => return,
        }
    }
}
