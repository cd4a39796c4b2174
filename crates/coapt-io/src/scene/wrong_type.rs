//! Values of a wrong type in a document: which one it is, and one of the right type in its place.

use std::ops::Range;

use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Of tables with more values than this, such as a ring's curve, it is not sought which one is wrong: each costs a reading of
/// the whole document.
const MOST_CANDIDATES: usize = 100;

/// What an error of a wrong type speaks of, its key and where it stands, and puts a value of the right type there; nothing for
/// other errors. In tables that a tag tells apart the reader has lost track and names the table: there the value is sought
/// whose replacement changes the error.
pub(super) fn replace<T: DeserializeOwned>(
    table: &mut Spanned<DeTable<'_>>,
    error: &toml::de::Error,
) -> Option<(String, Range<usize>)> {
    let (found_there, value) = stand_in(error.message())?;
    let span = error.span()?;
    let mut candidates = Vec::new();
    within(table.get_ref(), false, (&span, found_there), &mut candidates);
    let mends = |(_, at): &&(String, Range<usize>)| {
        let mut tried = table.clone();
        put(tried.get_mut(), at, &value);
        let again = T::deserialize(toml::Deserializer::from(tried)).err();
        again.is_none_or(|again| again.message() != error.message() || again.span() != error.span())
    };
    // Where two are wrong in the same way, to mend one changes nothing: they come one after the other.
    let found = candidates.iter().take(MOST_CANDIDATES).find(mends);
    let found = found.or(candidates.first())?.clone();
    put(table.get_mut(), &found.1, &value);
    Some(found)
}

/// What an error found, in its words, and a value of the type that it expects.
fn stand_in(message: &str) -> Option<(&str, DeValue<'static>)> {
    let (found, expected) = message.strip_prefix("invalid ")?.rsplit_once(", expected ")?;
    let (_, found) = found.split_once(": ")?;
    let document = match expected {
        "f64" => "value = 0.0",
        "u16" | "u32" | "u64" | "usize" | "i64" => "value = 0",
        "a boolean" => "value = false",
        "a string" => "value = \"\"",
        "a sequence" => "value = []",
        "an array of length 3" => "value = [0.0, 0.0, 0.0]",
        "an array of length 2" => "value = [0, 0]",
        _ => return None,
    };
    let table = DeTable::parse(document).ok()?;
    Some((found, table.get_ref().get("value")?.get_ref().clone()))
}

/// All values that an error could have found, at its place or in what stands there, each with its key.
fn within(
    table: &DeTable<'_>,
    inside: bool,
    error: (&Range<usize>, &str),
    found: &mut Vec<(String, Range<usize>)>,
) {
    for (key, value) in table {
        within_value(key.get_ref(), value, inside, error, found);
    }
}

fn within_value(
    key: &str,
    value: &Spanned<DeValue<'_>>,
    inside: bool,
    error: (&Range<usize>, &str),
    found: &mut Vec<(String, Range<usize>)>,
) {
    let (span, words) = error;
    let inside = inside || value.span() == *span;
    if inside && is_told(value.get_ref(), words) {
        found.push((key.to_owned(), value.span()));
    }
    match value.get_ref() {
        DeValue::Table(table) => within(table, inside, error, found),
        DeValue::Array(items) => {
            items
                .iter()
                .for_each(|item| within_value(key, item, inside, error, found));
        }
        _ => {}
    }
}

/// Whether this is what an error tells of: a string with its text, a number by its kind, a sequence.
fn is_told(value: &DeValue<'_>, words: &str) -> bool {
    match value {
        DeValue::String(text) => words == format!("string {text:?}"),
        DeValue::Integer(_) => words.starts_with("integer"),
        DeValue::Float(_) => words.starts_with("floating point"),
        DeValue::Boolean(_) => words.starts_with("boolean"),
        DeValue::Array(_) => words == "sequence",
        DeValue::Table(_) => words == "map",
        DeValue::Datetime(_) => false,
    }
}

/// Replaces the value that stands at `span`.
fn put(table: &mut DeTable<'_>, span: &Range<usize>, new: &DeValue<'static>) {
    table
        .iter_mut()
        .for_each(|(_, value)| put_value(value, span, new));
}

fn put_value(value: &mut Spanned<DeValue<'_>>, span: &Range<usize>, new: &DeValue<'static>) {
    let here = value.span() == *span;
    match value.get_mut() {
        old if here => *old = new.clone(),
        DeValue::Table(table) => put(table, span, new),
        DeValue::Array(items) => items.iter_mut().for_each(|item| put_value(item, span, new)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::super::document::tests::told;
    use coapt::scene::{Plan, Scene};

    #[test]
    fn every_wrong_type_is_told_with_its_key() {
        let text = "schema_version = 1\nname = 5\nleaflets = []\n[load]\npressure_mmhg = \"100\"\n[[papillary]]\n\
                    name = \"a\"\ntips_mm = [[1, 2, 3], [4, true, 6]]\n";
        assert_eq!(
            told::<Scene>(text),
            [
                "f:2:8: name: invalid type: integer `5`, expected a string",
                "f:5:17: pressure_mmhg: invalid type: string \"100\", expected a number",
                "f:8:27: tips_mm: invalid type: boolean `true`, expected a number",
            ]
        );
    }

    #[test]
    fn tables_with_a_tag_do_not_hide_which_value_is_wrong() {
        let text = "schema_version = 1\nname = \"a\"\n[load]\npressure_mmhg = 100\n[[leaflets]]\nname = \"x\"\n\
                    [leaflets.tissue]\nlaw = \"bilinear-springs\"\npre_transition_modulus_mpa = 0.1\n\
                    transition_strain = \"0.2\"\npost_transition_modulus_mpa = [4]\n";
        assert_eq!(
            told::<Scene>(text),
            [
                "f:10:21: transition_strain: invalid type: string \"0.2\", expected a number",
                "f:11:31: post_transition_modulus_mpa: invalid type: list, expected a number",
            ]
        );
        let twice = text.replace("[4]", "\"0.2\"");
        assert_eq!(told::<Scene>(&twice).len(), 2);
        let plan = "schema_version = 1\n[[repair]]\nkind = \"ring\"\nfamily = \"saddle\"\nsize_mm = \"30\"\n";
        assert_eq!(
            told::<Plan>(plan),
            ["f:5:11: size_mm: invalid type: string \"30\", expected a number"]
        );
    }
}
