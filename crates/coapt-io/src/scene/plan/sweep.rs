//! Lists and ranges in the place of one value.
//!
//! Which keys take a list by nature is not written down anywhere: the type of repairs is asked. A list is a sweep where its
//! key does not take the list but takes what is in it. So keys of repairs to come can be swept without a word here.

use coapt::scene::Repair;
use serde::Deserialize;
use toml::{Table, Value};

use super::super::document::plain;

/// The lists and ranges of a repair, in the order of their keys.
#[derive(Clone, Debug, Default)]
pub(super) struct Sweeps(pub(super) Vec<Sweep>);

/// A key with several values.
#[derive(Clone, Debug)]
pub(super) struct Sweep {
    pub(super) key: String,
    pub(super) values: Values,
}

/// What a key goes through.
#[derive(Clone, Debug)]
pub(super) enum Values {
    /// One after the other.
    List(Vec<Value>),
    /// `count` values from `from` in steps of `step`; whole numbers stay whole.
    Range { from: Value, step: Value, count: u64 },
}

impl Values {
    pub(super) fn count(&self) -> u64 {
        match self {
            Self::List(values) => values.len() as u64,
            Self::Range { count, .. } => *count,
        }
    }

    /// The value of a number below the count.
    fn at(&self, number: u64) -> Value {
        match self {
            Self::List(values) => values[number as usize].clone(),
            Self::Range { from, step, .. } => match (from, step) {
                (Value::Integer(from), Value::Integer(step)) => {
                    // Between two whole numbers that fit, though the product alone may not.
                    let value = i128::from(*from) + i128::from(*step) * i128::from(number);
                    Value::Integer(i64::try_from(value).unwrap_or(i64::MAX))
                }
                _ => Value::Float(rounded(float(from) + float(step) * number as f64)),
            },
        }
    }
}

/// To twelve digits: 0.1 + 2 · 0.1 is meant to be 0.3.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// Whether two values are one, though one of them may be written as 28 and the other as 28.0.
fn is_same(one: &Value, other: &Value) -> bool {
    one == other || float(one) == float(other)
}

fn float(value: &Value) -> f64 {
    match value {
        Value::Integer(whole) => *whole as f64,
        Value::Float(number) => *number,
        _ => f64::NAN,
    }
}

impl Sweeps {
    /// How many repairs these make of one.
    pub(super) fn count(&self) -> u64 {
        let counts = self.0.iter().map(|sweep| sweep.values.count());
        counts.fold(1, u64::saturating_mul)
    }

    /// The table with each combination of values; the last key changes fastest.
    pub(super) fn tables(&self, table: &Table) -> impl Iterator<Item = Table> {
        (0..self.count()).map(|number| {
            let mut rest = number;
            let mut table = table.clone();
            for sweep in self.0.iter().rev() {
                let count = sweep.values.count();
                table.insert(sweep.key.clone(), sweep.values.at(rest % count));
                rest /= count;
            }
            table
        })
    }

    /// Takes values out that a list has already had, and tells them, each with its key: closed again they would be the same valve.
    pub(super) fn fold(&mut self) -> Vec<(String, String)> {
        let mut repeated = Vec::new();
        for Sweep { key, values } in &mut self.0 {
            // The values of a range differ.
            let Values::List(values) = values else {
                continue;
            };
            let mut once: Vec<Value> = Vec::new();
            for value in values.drain(..) {
                match once.iter().any(|earlier| is_same(earlier, &value)) {
                    true => repeated.push((key.clone(), format!("has {value} again; it is closed once"))),
                    false => once.push(value),
                }
            }
            *values = once;
        }
        repeated
    }

    /// Puts the first value of each into the table and takes what is wrong with the others, each with its key.
    pub(super) fn settle(&self, table: &mut Table) -> Vec<(String, String)> {
        for sweep in &self.0 {
            table.insert(sweep.key.clone(), sweep.values.at(0));
        }
        let mut faults = Vec::new();
        for sweep in &self.0 {
            // The first is told of with the other keys; of a range all are alike.
            let count = match sweep.values {
                Values::List(_) => sweep.values.count(),
                Values::Range { .. } => 1,
            };
            for number in 1..count {
                let tried = alone(table, &sweep.key, sweep.values.at(number));
                if let Err(message) = tried {
                    faults.push((format!("{}[{number}]", sweep.key), message));
                }
            }
        }
        faults
    }
}

/// Takes the sweeps out of a repair, and what is wrong with them, each with its key.
pub(super) fn sweeps(table: &Table) -> (Sweeps, Vec<(String, String)>) {
    let (mut found, mut faults) = (Sweeps::default(), Vec::new());
    for (key, value) in table {
        let values = match value {
            Value::Array(items) if key != KIND && is_swept(table, key, items) => list(items),
            // A list by nature, which the type of the whole would complain of without its key. Complaints that name it are of the key
            // itself, and told with what else is wrong with keys.
            Value::Array(_) if key != KIND => match alone(table, key, value.clone()) {
                Err(message) if !message.contains(key) => Err(message),
                _ => continue,
            },
            Value::Table(range) if key != KIND && is_range(table, key, range) => self::range(range),
            _ => continue,
        };
        match values {
            Ok(values) => found.0.push(Sweep {
                key: key.clone(),
                values,
            }),
            Err(message) => faults.push((key.clone(), message)),
        }
    }
    (found, faults)
}

/// The key that says what kind of repair it is.
pub(super) const KIND: &str = "kind";

fn is_swept(table: &Table, key: &str, items: &[Value]) -> bool {
    let takes = |value: &Value| alone(table, key, value.clone()).is_ok();
    if takes(&Value::Array(items.to_vec())) {
        return false;
    }
    // What takes no list at all is swept by whatever is in it, to be told of one by one.
    let no_list = alone(table, key, Value::Array(Vec::new()));
    items.iter().any(takes) || no_list.is_err_and(|message| message.starts_with("invalid type: list"))
}

fn is_range(table: &Table, key: &str, range: &Table) -> bool {
    ["from", "to", "step"]
        .iter()
        .any(|word| range.contains_key(*word))
        && alone(table, key, Value::Table(range.clone())).is_err()
}

fn list(items: &[Value]) -> Result<Values, String> {
    match items {
        [] => Err("is an empty list; expected one value at least".to_owned()),
        _ => Ok(Values::List(items.to_vec())),
    }
}

fn range(range: &Table) -> Result<Values, String> {
    if let Some(other) = range
        .keys()
        .find(|key| !matches!(key.as_str(), "from" | "to" | "step"))
    {
        return Err(format!("has the key `{other}`; a range has from, to and step"));
    }
    let [from, to, step] = ["from", "to", "step"].map(|key| {
        let number = range.get(key).filter(|value| float(value).is_finite());
        number.ok_or_else(|| format!("is a range without a number as `{key}`; expected from, to and step"))
    });
    let (from, to, step) = (from?, to?, step?);
    let [first, last, by] = [from, to, step].map(float);
    if !(by > 0.0 && last >= first) {
        return Err(format!(
            "is a range from {first} to {last} in steps of {by}; expected a step above 0 and an end not below the start"
        ));
    }
    // So much may be missing to a last step through rounding.
    let count = ((last - first) / by * (1.0 + 1e-12) + 1e-9).floor() + 1.0;
    Ok(Values::Range {
        from: from.clone(),
        step: step.clone(),
        // Saturates.
        count: count as u64,
    })
}

/// Whether a repair of the table's kind takes this value at this key, whatever else it needs.
pub(super) fn alone(table: &Table, key: &str, value: Value) -> Result<(), String> {
    let mut asked = Table::new();
    if let Some(kind) = table.get(KIND) {
        asked.insert(KIND.to_owned(), kind.clone());
    }
    asked.insert(key.to_owned(), value);
    match repair(asked) {
        Err(message) if message.contains("` is missing") => Ok(()),
        answer => answer.map(|_| ()),
    }
}

/// A table as a repair, or what is wrong in our words.
pub(super) fn repair(table: Table) -> Result<Repair, String> {
    Repair::deserialize(Value::Table(table)).map_err(|error| plain(error.message()).0)
}
