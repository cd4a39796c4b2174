//! Parts of scenes and plans that a program makes as tables, without a text that has lines: faults are told by their keys.

use coapt::scene::Fault;
use serde::de::DeserializeOwned;
use toml::{Table, Value};

use super::in_plain_words;

/// A table as its type. `place` is what the part is called, such as `ring`; empty for a whole scene, whose keys need no more.
///
/// # Errors
/// Unknown keys, wrong types and wrong words, all of them, each with its key (`ring.size_mm`), else what is missing.
pub fn part_from_table<T: DeserializeOwned>(place: &str, table: Table) -> Result<T, Vec<Fault>> {
    let mut faults = Vec::new();
    let mut value = Value::Table(table);
    loop {
        let told = match T::deserialize(value.clone()) {
            Ok(value) if faults.is_empty() => return Ok(value),
            Ok(_) => return Err(faults),
            Err(error) => error.message().to_owned(),
        };
        let path = culprit::<T>(&value, &told);
        if path.is_empty() {
            // What is missing may be what was taken out as wrong.
            if faults.is_empty() {
                faults.push(Fault::error(place, in_plain_words(&told)));
            }
            return Err(faults);
        }
        let removed = remove(&mut value, &path);
        faults.push(match (told.starts_with("unknown field"), path.split_last()) {
            (true, Some((_, inside))) => Fault::error(key(place, inside), in_plain_words(&told)),
            _ => Fault::error(key(place, &path), wrong(removed, &told)),
        });
    }
}

/// A step into a value.
#[derive(Clone, Debug)]
enum Step {
    Key(String),
    Number(usize),
}

/// `ring.curve_mm`, `leaflets[0].tissue`
fn key(place: &str, path: &[Step]) -> String {
    path.iter().fold(place.to_owned(), |place, step| match step {
        Step::Key(key) if place.is_empty() => key.clone(),
        Step::Key(key) => format!("{place}.{key}"),
        Step::Number(number) => format!("{place}[{number}]"),
    })
}

/// What is wrong with a value.
fn wrong(value: Option<Value>, told: &str) -> String {
    let words = in_plain_words(told);
    let expected = words
        .strip_prefix("invalid ")
        .and_then(|rest| rest.rsplit_once(", expected "));
    match (value, expected) {
        (Some(value), Some((_, expected))) => format!("is {}; expected {expected}", short(&value)),
        _ => words,
    }
}

/// Keys that tell kinds of tables apart: without them nothing is read, whatever else is wrong.
const TAGS: [&str; 2] = ["kind", "law"];

/// The entry without which another error is told or none: that one is at fault. The innermost such entry; nothing where none is.
fn culprit<T: DeserializeOwned>(whole: &Value, told: &str) -> Vec<Step> {
    let without = |path: &[Step]| {
        let mut value = whole.clone();
        remove(&mut value, path);
        T::deserialize(value).err()
    };
    let mut path: Vec<Step> = Vec::new();
    let mut inside = whole;
    while let Some((step, deeper)) = at_fault(inside, told, |step| {
        let longer: Vec<Step> = path.iter().chain([step]).cloned().collect();
        without(&longer)
    }) {
        path.push(step);
        inside = deeper;
    }
    path
}

/// The entry of a table, or of a list of tables, that an error is about, if it is about one; `without` reads the whole without
/// an entry.
fn at_fault<'v>(
    inside: &'v Value,
    told: &str,
    without: impl Fn(&Step) -> Option<toml::de::Error>,
) -> Option<(Step, &'v Value)> {
    let mends = |(step, _): &&(Step, &Value)| {
        without(step).is_none_or(|error| error.message() != told && !is_missed(step, error.message()))
    };
    // A part that must be there is missed once it is taken out; that says little of a tag.
    let is_it = |(step, _): &&(Step, &Value)| without(step).is_some_and(|error| error.message() != told);
    let mut entries = entries(inside);
    // What is missing can be so in a table only.
    entries.retain(|(_, value)| !told.starts_with("missing field") || value.is_table() || value.is_array());
    entries.sort_by_key(|(step, _)| matches!(step, Step::Key(key) if TAGS.contains(&key.as_str())));
    let found = entries.iter().find(mends).or_else(|| entries.iter().find(is_it));
    found.cloned()
}

/// What is in a table, or in a list of tables. Lists of numbers are long, and as one at fault.
fn entries(value: &Value) -> Vec<(Step, &Value)> {
    match value {
        Value::Table(table) => {
            let keys = table.keys().map(|key| Step::Key(key.clone()));
            keys.zip(table.values()).collect()
        }
        Value::Array(items) if items.iter().all(Value::is_table) => {
            let numbered = items.iter().enumerate();
            numbered
                .map(|(number, item)| (Step::Number(number), item))
                .collect()
        }
        _ => Vec::new(),
    }
}

fn is_missed(step: &Step, told: &str) -> bool {
    matches!(step, Step::Key(key) if told.contains(&format!("missing field `{key}`")))
}

fn remove(value: &mut Value, path: &[Step]) -> Option<Value> {
    let inside = match (path, value) {
        ([Step::Key(key)], Value::Table(table)) => return table.remove(key),
        ([Step::Number(number)], Value::Array(items)) => return Some(items.remove(*number)),
        ([Step::Key(key), ..], Value::Table(table)) => table.get_mut(key),
        ([Step::Number(number), ..], Value::Array(items)) => items.get_mut(*number),
        _ => None,
    };
    remove(inside?, &path[1..])
}

/// A value as a message quotes it.
fn short(value: &Value) -> String {
    match value {
        Value::Table(_) => "a table".to_owned(),
        Value::Array(_) => "a list".to_owned(),
        scalar => scalar.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use coapt::scene::{Leaflet, Repair, Scene};

    use super::*;

    fn told<T: DeserializeOwned>(text: &str) -> Vec<String> {
        let table: Table = text.parse().unwrap_or_default();
        let faults = part_from_table::<T>("part", table).err().unwrap_or_default();
        let line = |fault: &Fault| format!("{}: {}", fault.place, fault.message);
        faults.iter().map(line).collect()
    }

    #[test]
    fn what_is_right_is_read() {
        assert_eq!(
            told::<Repair>("kind = \"ring\"\nfamily = \"saddle\"\nsize_mm = 28"),
            [""; 0]
        );
    }

    #[test]
    fn every_wrong_key_is_told_by_its_name() {
        let two = "kind = \"ring\"\nfamily = \"sadle\"\nsize_mm = \"28\"";
        assert_eq!(
            told::<Repair>(two),
            [
                "part.family: unknown value `sadle`; did you mean `saddle`?",
                "part.size_mm: is \"28\"; expected a number",
            ]
        );
        assert_eq!(
            told::<Repair>("kind = \"ring\"\nsize = 28"),
            ["part: unknown key `size`; did you mean `size_mm`?"]
        );
        assert_eq!(
            told::<Repair>("kind = \"neochord\""),
            ["part: the key `leaflet` is missing"]
        );
        assert_eq!(
            told::<Repair>("kind = \"rign\""),
            ["part.kind: unknown value `rign`; did you mean `ring`?"]
        );
    }

    #[test]
    fn keys_of_inner_tables_are_told_with_their_way() {
        let inner = "name = \"a\"\n[tissue]\nlaw = \"bilinear-springs\"\ntransition_strain = true";
        assert_eq!(
            told::<Leaflet>(inner),
            ["part.tissue.transition_strain: is true; expected a number"]
        );
        let list = "schema_version = 1\nname = \"a\"\nload = {}\n[[leaflets]]\nname = \"a\"\n[[leaflets]]\nname = \"b\"\n\
                    thickness_mm = \"thick\"\ncolour = 1";
        assert_eq!(
            told::<Scene>(list),
            [
                "part.leaflets[1]: unknown key `colour`; there are name, mesh_file, region, mesh, thickness_mm, tissue",
                "part.leaflets[1].thickness_mm: is \"thick\"; expected a number",
            ]
        );
        let missing = "name = \"a\"\n[tissue]\nlaw = \"st-venant-kirchhoff\"";
        assert_eq!(
            told::<Leaflet>(missing),
            ["part.tissue: the key `modulus_mpa` is missing"]
        );
    }
}
