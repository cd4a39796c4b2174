//! Parts of scenes and plans that a program makes as tables, without a text that has lines: faults are told by their keys.

use coapt::scene::Fault;
use serde::de::DeserializeOwned;
use toml::{Table, Value};

use super::in_plain_words;

/// A table as its type. `place` is what the part is called, such as `ring`.
///
/// # Errors
/// Unknown keys, wrong types and wrong words, all of them, each with its key (`ring.size_mm`), else what is missing.
pub fn part_from_table<T: DeserializeOwned>(place: &str, mut table: Table) -> Result<T, Vec<Fault>> {
    let mut faults = Vec::new();
    loop {
        let told = match T::deserialize(Value::Table(table.clone())) {
            Ok(value) if faults.is_empty() => return Ok(value),
            Ok(_) => return Err(faults),
            Err(error) => error.message().to_owned(),
        };
        let Some(path) = culprit::<T>(&table, &told) else {
            // What is missing may be what was taken out as wrong.
            if faults.is_empty() {
                faults.push(Fault::error(place, in_plain_words(&told)));
            }
            return Err(faults);
        };
        let value = remove(&mut table, &path);
        faults.push(match told.starts_with("unknown field") {
            true => Fault::error(place, in_plain_words(&told)),
            false => Fault::error(format!("{place}.{}", path.join(".")), wrong(value, &told)),
        });
    }
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

/// The entry without which another error is told or none: that one is at fault. The innermost such entry.
fn culprit<T: DeserializeOwned>(table: &Table, told: &str) -> Option<Vec<String>> {
    let without = |path: &[String]| {
        let mut table = table.clone();
        remove(&mut table, path);
        T::deserialize(Value::Table(table)).err()
    };
    let mut path: Vec<String> = Vec::new();
    let mut inside = table;
    loop {
        let longer = |key: &String| path.iter().chain([key]).cloned().collect::<Vec<_>>();
        let mends = |key: &&String| {
            let error = without(&longer(key));
            error.is_none_or(|error| error.message() != told && !is_missed(key, error.message()))
        };
        // A part that must be there is missed once it is taken out; that says little of a tag.
        let is_it = |key: &&String| {
            let error = without(&longer(key));
            error.is_some_and(|error| error.message() != told)
        };
        // What is missing can be so in a table only.
        let may_be = |(_, value): &(&String, &Value)| !told.starts_with("missing field") || value.is_table();
        let keys = || inside.iter().filter(may_be).map(|(key, _)| key);
        let (tags, others): (Vec<&String>, Vec<&String>) =
            keys().partition(|key| TAGS.contains(&key.as_str()));
        let mut second = others.iter().copied().chain(tags);
        let next = keys().find(mends).or_else(|| second.find(is_it));
        let Some(next) = next.cloned() else { break };
        let deeper = inside.get(&next);
        path.push(next);
        match deeper {
            Some(Value::Table(deeper)) => inside = deeper,
            _ => break,
        }
    }
    (!path.is_empty()).then_some(path)
}

fn is_missed(key: &str, told: &str) -> bool {
    told.contains(&format!("missing field `{key}`"))
}

fn remove(table: &mut Table, path: &[String]) -> Option<Value> {
    match path {
        [] => None,
        [key] => table.remove(key),
        [key, rest @ ..] => remove(table.get_mut(key)?.as_table_mut()?, rest),
    }
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
    use coapt::scene::{Leaflet, Repair};

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
        let missing = "name = \"a\"\n[tissue]\nlaw = \"st-venant-kirchhoff\"";
        assert_eq!(
            told::<Leaflet>(missing),
            ["part.tissue: the key `modulus_mpa` is missing"]
        );
    }
}
