//! The line of a key in a scene: the library names keys (`leaflets[0].thickness_mm`), a person looks for lines.

use coapt::scene::Fault;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::document::{is_json, line_of};

/// The line, from 1, of the key path that `place` begins with, such as `leaflets[0].mesh face 12`. Where a key is
/// not written out, the line of what it belongs to, or of the file that it is read from. None for JSON.
pub fn locate(text: &str, place: &str) -> Option<usize> {
    if is_json(text) {
        return None;
    }
    let document = DeTable::parse(text).ok()?;
    let path = place.split_whitespace().next()?;
    let mut table = document.get_ref();
    let mut found = None;
    for step in path.split('.') {
        let (key, number) = match step.split_once('[') {
            Some((key, rest)) => (key, rest.trim_end_matches(']').parse::<usize>().ok()),
            None => (step, None),
        };
        let Some((at, value)) = entry(table, key) else {
            break;
        };
        found = Some(at);
        let Some((at, inner)) = inside(value, number) else {
            break;
        };
        found = at.or(found);
        let Some(inner) = inner else { break };
        table = inner;
    }
    Some(line_of(text, found?))
}

/// Where a key stands and its value; geometry may come from the file named beside it.
fn entry<'a, 'i>(table: &'a DeTable<'i>, key: &str) -> Option<(usize, &'a Spanned<DeValue<'i>>)> {
    let from_file = match key {
        "mesh" => "mesh_file",
        "curve_mm" => "curve_file",
        "tips_mm" => "tips_file",
        _ => key,
    };
    let (name, value) = table
        .get_key_value(key)
        .or_else(|| table.get_key_value(from_file))?;
    Some((name.span().start, value))
}

/// The item of that number, or the value itself: where it stands, and its table if it is one.
fn inside<'a, 'i>(
    value: &'a Spanned<DeValue<'i>>,
    number: Option<usize>,
) -> Option<(Option<usize>, Option<&'a DeTable<'i>>)> {
    let table_of = |value: &'a Spanned<DeValue<'i>>| match value.get_ref() {
        DeValue::Table(table) => Some(table),
        _ => None,
    };
    match (value.get_ref(), number) {
        (DeValue::Array(items), Some(number)) => {
            let item = items.get(number)?;
            Some((Some(item.span().start), table_of(item)))
        }
        _ => Some((None, table_of(value))),
    }
}

/// A fault of the library, whose place is a key, as a fault of the file that the key stands in: place
/// `scene.toml:12`, message `leaflets[0].thickness_mm is -1 mm, expected ...`.
pub fn located(file: &str, text: &str, fault: &Fault) -> Fault {
    let place = match locate(text, &fault.place) {
        Some(line) => format!("{file}:{line}"),
        None => file.to_owned(),
    };
    Fault {
        place,
        message: sentence(fault),
        ..fault.clone()
    }
}

/// Place and message as one sentence: `leaflets[0].thickness_mm is -1 mm` but `leaflets: no support`.
pub fn sentence(fault: &Fault) -> String {
    if fault.message.starts_with(&fault.place) {
        return fault.message.clone();
    }
    let goes_on = ["is ", "are ", "has ", "lacks ", "`"]
        .iter()
        .any(|word| fault.message.starts_with(word));
    let colon = if goes_on { "" } else { ":" };
    format!("{}{colon} {}", fault.place, fault.message)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "schema_version = 1\nload = { pressure_mmhg = 100 }\n\n[[leaflets]]\nname = \"a\"\n\n\
                        [[leaflets]]\nname = \"b\"\nmesh_file = \"b.vtp\"\nthickness_mm = -1\n[leaflets.tissue]\n\
                        law = \"bilinear-springs\"\n";

    #[test]
    fn keys_are_found_and_absent_ones_by_what_they_belong_to() {
        for (place, line) in [
            ("schema_version", Some(1)),
            ("load.pressure_mmhg", Some(2)),
            ("leaflets[1].thickness_mm", Some(10)),
            ("leaflets[1].mesh face 12", Some(9)),
            ("leaflets[1].tissue.law", Some(12)),
            ("leaflets[0].thickness_mm", Some(4)),
            ("leaflets[7].name", Some(4)),
            ("annulus", None),
            ("", None),
            ("leaflets[].mesh.annulus_points", Some(4)),
        ] {
            assert_eq!(locate(TEXT, place), line, "{place}");
        }
        assert_eq!(locate("{\"a\": 1}", "a"), None);
        assert_eq!(locate("a = ", "a"), None);
    }

    #[test]
    fn a_fault_becomes_a_sentence_at_a_line() {
        let fault = Fault::error("leaflets[1].thickness_mm", "is -1 mm");
        let there = located("scene.toml", TEXT, &fault);
        assert_eq!(
            (there.place.as_str(), there.message.as_str()),
            ("scene.toml:10", "leaflets[1].thickness_mm is -1 mm")
        );
        assert_eq!(
            sentence(&Fault::error("leaflets", "no support")),
            "leaflets: no support"
        );
    }
}
