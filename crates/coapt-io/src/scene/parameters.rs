//! Parameters of the parametric valve, set one by one by their keys.

use coapt::mesh::parametric::ValveParameters;
use serde_json::Value;

use super::{in_plain_words, nearest};

/// The parameters with one of them replaced. Keys are dotted as in TOML, `faces` is short for `face_count_target`; `word` is
/// the value as a message quotes it.
///
/// # Errors
/// A key that there is not, or a value of the wrong type, in words.
pub fn with_parameter(
    parameters: &ValveParameters,
    key: &str,
    value: toml::Value,
    word: &str,
) -> Result<ValveParameters, String> {
    let key = if key == SHORT.0 { SHORT.1 } else { key };
    let value = serde_json::to_value(value).map_err(|error| error.to_string())?;
    let mut table = serde_json::to_value(parameters).map_err(|error| error.to_string())?;
    let steps: Vec<&str> = key.split('.').collect();
    let before = table.pointer(&format!("/{}", steps.join("/"))).cloned();
    if word.is_empty() && !before.as_ref().is_some_and(Value::is_string) {
        let expected = before.and_then(|before| expected(&before, &value));
        let expected = expected.unwrap_or_else(|| "KEY=VALUE".to_owned());
        return Err(format!("`{key}` has no value, expected {expected}"));
    }
    let value = match before.as_ref().is_some_and(Value::is_u64) {
        true => whole(value),
        false => value,
    };
    put(&mut table, &steps, value.clone())?;
    serde_json::from_value(table).map_err(
        |error| match before.and_then(|before| expected(&before, &value)) {
            Some(expected) => format!("`{key}` is `{word}`, expected {expected}"),
            None => format!("`{key}` is `{word}`: {}", in_plain_words(&error.to_string())),
        },
    )
}

/// A short key and the one that it stands for.
const SHORT: (&str, &str) = ("faces", "face_count_target");

/// A whole number that was written with a point or a power of ten as one without.
fn whole(value: Value) -> Value {
    match value.as_f64() {
        Some(number) if value.is_f64() && number.fract() == 0.0 && (0.0..1e15).contains(&number) => {
            (number as u64).into()
        }
        _ => value,
    }
}

/// What may stand in the place of a value, where that value alone says it.
fn expected(before: &Value, given: &Value) -> Option<String> {
    match before {
        // Counts have this limit; a number that has none is not refused for its size.
        Value::Number(number) if number.is_u64() && given.is_u64() => {
            Some(format!("at most {}, such as {number}", u32::MAX))
        }
        Value::Number(number) if number.is_u64() => {
            Some(format!("a whole number, 0 or above, such as {number}"))
        }
        Value::Number(number) => Some(format!("a number, such as {number}")),
        Value::Bool(_) => Some("true or false".to_owned()),
        Value::Array(_) => Some(format!("a list of numbers, such as {before}")),
        Value::Null | Value::String(_) | Value::Object(_) => None,
    }
}

/// Replaces the value at a key path.
fn put(table: &mut Value, path: &[&str], value: Value) -> Result<(), String> {
    let [step, rest @ ..] = path else {
        *table = value;
        return Ok(());
    };
    // A table that is absent by default, such as `chordae.rest_annulus`, begins empty.
    if table.is_null() {
        *table = Value::Object(serde_json::Map::new());
    }
    let Value::Object(entries) = table else {
        return Err(format!("there is no key `{step}` below it: it holds a value"));
    };
    if !entries.is_empty() && !entries.contains_key(*step) {
        let mut known: Vec<&str> = entries.keys().map(String::as_str).collect();
        if entries.contains_key(SHORT.1) {
            known.push(SHORT.0);
        }
        let advice = match nearest(step, known.iter().copied()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("there are {}", known.join(", ")),
        };
        return Err(format!("unknown key `{step}`; {advice}"));
    }
    put(entries.entry(*step).or_insert(Value::Null), rest, value)
}

#[cfg(test)]
mod tests {
    use toml::Value as Toml;

    use super::*;

    fn with(key: &str, value: impl Into<Toml>) -> Result<ValveParameters, String> {
        let value = value.into();
        let word = value.to_string();
        with_parameter(&ValveParameters::default(), key, value, &word)
    }

    #[test]
    fn a_parameter_is_replaced_and_no_other() {
        let mut expected = ValveParameters::default();
        expected.annulus.transverse_mm = 42.0;
        assert_eq!(with("annulus.transverse_mm", 42.0), Ok(expected));
        let expected = ValveParameters {
            face_count_target: 900,
            ..ValveParameters::default()
        };
        assert_eq!(with("faces", 900.0), Ok(expected));
    }

    #[test]
    fn wrong_keys_and_values_are_told() {
        for (told, words) in [
            (
                with("anulus.transverse_mm", 42.0),
                "unknown key `anulus`; did you mean `annulus`?",
            ),
            (with("fces", 1), "unknown key `fces`; did you mean `faces`?"),
            (
                with("colour", 1),
                "jitter_mm, jitter_seed, leaflets, name, papillary, pressure_mmhg, faces",
            ),
            (
                with("annulus.faces", 1),
                "unknown key `faces`; there are anterior_fraction",
            ),
            (
                with("faces", 1.5),
                "`face_count_target` is `1.5`, expected a whole number",
            ),
            (
                with("annulus.transverse_mm", "wide"),
                "expected a number, such as 38",
            ),
        ] {
            let told = told.unwrap_err();
            assert!(told.contains(words), "{told}");
        }
    }
}
