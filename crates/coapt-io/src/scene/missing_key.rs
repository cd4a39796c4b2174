//! Keys that a document lacks: which table it is that lacks one.

use std::ops::Range;

use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Of more tables than this it is not sought which one is meant: each costs a reading of the whole document.
const MOST_CANDIDATES: usize = 100;

/// Where the table stands that an error of a missing key speaks of; nothing for other errors, nor where the reader knows. In
/// lists of tables that a tag tells apart it has lost track and names the first: there the table is sought in which the key is
/// known and changes the error.
pub(super) fn lacking<T: DeserializeOwned>(
    table: &Spanned<DeTable<'_>>,
    error: &toml::de::Error,
) -> Option<Range<usize>> {
    let key = error
        .message()
        .strip_prefix("missing field `")?
        .split('`')
        .next()?;
    let document = format!("{key} = \"\"");
    let entry = DeTable::parse(&document).ok()?;
    let mut without = Vec::new();
    items_without(table.get_ref(), key, error.span()?.start, &mut without);
    let unknown = format!("unknown field `{key}`");
    without.into_iter().take(MOST_CANDIDATES).find(|at| {
        let mut tried = table.clone();
        put(tried.get_mut(), at, entry.get_ref());
        let again = T::deserialize(toml::Deserializer::from(tried)).err();
        again.is_none_or(|again| again.message() != error.message() && !again.message().starts_with(&unknown))
    })
}

/// Tables that lack a key, in the list that begins where the reader says.
fn items_without(table: &DeTable<'_>, key: &str, start: usize, found: &mut Vec<Range<usize>>) {
    for (_, value) in table {
        let DeValue::Array(items) = value.get_ref() else {
            continue;
        };
        let begins_there = items.first().is_some_and(|first| first.span().start == start);
        for item in items.iter() {
            if let DeValue::Table(table) = item.get_ref() {
                if begins_there && table.get(key).is_none() {
                    found.push(item.span());
                }
                items_without(table, key, start, found);
            }
        }
    }
}

/// Puts entries into the table that stands at `span`.
fn put<'i>(table: &mut DeTable<'i>, span: &Range<usize>, entries: &DeTable<'i>) {
    table
        .iter_mut()
        .for_each(|(_, value)| put_in(value, span, entries));
}

fn put_in<'i>(value: &mut Spanned<DeValue<'i>>, span: &Range<usize>, entries: &DeTable<'i>) {
    let here = value.span() == *span;
    match value.get_mut() {
        DeValue::Table(table) if here => {
            let new = entries.iter().map(|(key, value)| (key.clone(), value.clone()));
            table.extend(new);
        }
        DeValue::Table(table) => put(table, span, entries),
        DeValue::Array(items) => items.iter_mut().for_each(|item| put_in(item, span, entries)),
        _ => {}
    }
}
