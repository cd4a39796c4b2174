//! Numbers in repairs, by their keys: the type of repairs is asked which keys take one, so that repairs to come have theirs without a
//! word here.

use coapt::scene::Repair;
use serde_json::Value;

use super::super::document::in_plain_words;

/// The repair with another number at a key.
///
/// # Errors
/// What is wrong with that number, or with the key.
pub fn with_number(repair: &Repair, key: &str, number: f64) -> Result<Repair, String> {
    let told = |error: serde_json::Error| in_plain_words(&error.to_string());
    let mut value = serde_json::to_value(repair).map_err(told)?;
    if let Value::Object(keys) = &mut value {
        keys.insert(key.to_owned(), number.into());
    }
    serde_json::from_value(value).map_err(told)
}

/// The keys of a repair that hold a number which may take any value, with it; whole numbers by nature are none of them.
pub fn number_keys(repair: &Repair) -> Vec<(String, f64)> {
    let Ok(Value::Object(keys)) = serde_json::to_value(repair) else {
        return Vec::new();
    };
    let numbers = keys
        .into_iter()
        .filter_map(|(key, value)| Some((key, value.as_f64()?)));
    numbers
        .filter(|(key, value)| with_number(repair, key, value + 0.5).is_ok())
        .collect()
}
