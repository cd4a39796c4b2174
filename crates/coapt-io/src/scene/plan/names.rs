//! Names for alternatives that have none: what is done, and in what they differ. `ring 28 + clip A2P2`

use std::collections::{BTreeMap, BTreeSet};

use toml::{Table, Value};

use super::read::{Block, Document, Place};
use super::sweep::KIND;

/// A repair in words: its kind, and its keys with their values.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Called {
    kind: String,
    values: Vec<(String, Word)>,
}

/// A value in a name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Word {
    /// Says by itself what it is: `A2P2`.
    Plain(String),
    /// Needs its key, as `neochord length_mm 22`; but for the size of a ring among no other numbers.
    Number(String),
    /// Needs its key.
    Switch(bool),
    /// Too long for a name.
    Other(String),
}

/// What tells alternatives of a plan apart, and the names given so far.
pub(super) struct Names {
    /// Kinds and keys of repairs that every alternative has, where these are swept.
    common: BTreeSet<(String, String)>,
    /// Kinds and keys that differ between the other repairs.
    own: BTreeSet<(String, String)>,
    /// Of these, kinds with several numbers.
    many_numbers: BTreeSet<String>,
    given: BTreeMap<String, usize>,
}

/// A repair in words.
pub(super) fn called(table: &Table) -> Called {
    let word = |value: &Value| match value {
        Value::String(text) => Word::Plain(text.clone()),
        Value::Integer(number) => Word::Number(number.to_string()),
        Value::Float(number) => Word::Number(number.to_string()),
        Value::Boolean(is_so) => Word::Switch(*is_so),
        other => Word::Other(other.to_string()),
    };
    let values = table.iter().filter(|(key, _)| *key != KIND);
    Called {
        kind: table
            .get(KIND)
            .and_then(Value::as_str)
            .unwrap_or("repair")
            .to_owned(),
        values: values.map(|(key, value)| (key.clone(), word(value))).collect(),
    }
}

impl Names {
    pub(super) fn new(document: &Document) -> Self {
        let common = swept(&document.common);
        let own = differing(&document.blocks);
        let mut numbers: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        let of = |place: &Place| called(&place.table);
        let blocks = std::iter::once(&document.common).chain(&document.blocks);
        let all: Vec<Called> = blocks.flat_map(|block| &block.repairs).map(of).collect();
        for called in &all {
            for (key, word) in &called.values {
                let place = (called.kind.clone(), key.clone());
                if matches!(word, Word::Number(_)) && (common.contains(&place) || own.contains(&place)) {
                    numbers.entry(&called.kind).or_default().insert(key);
                }
            }
        }
        let many = numbers.iter().filter(|(_, keys)| keys.len() > 1);
        Self {
            many_numbers: many.map(|(kind, _)| (*kind).to_owned()).collect(),
            common,
            own,
            given: BTreeMap::new(),
        }
    }

    /// The name of an alternative: what it is called in the plan, if it is the only one of that block; what it does, if it is
    /// not called anything; both otherwise. No name is given twice: a number is put behind one that is taken, and that it is told.
    pub(super) fn name<'a>(
        &mut self,
        block: Option<&str>,
        is_only: bool,
        common: impl Iterator<Item = &'a Called>,
        own: impl Iterator<Item = &'a Called>,
    ) -> (String, bool) {
        let common: Vec<&Called> = common.collect();
        let mut words: Vec<String> = common.iter().filter_map(|it| self.common_words(it)).collect();
        words.extend(own.map(|it| self.words(it, &self.own)));
        if words.is_empty() {
            words.extend(common.iter().map(|it| self.words(it, &all_keys(it))));
        }
        let done = words.join(" + ");
        let name = match block {
            Some(name) if is_only => name.to_owned(),
            Some(name) => format!("{name}: {done}"),
            None => done,
        };
        // One line, whatever a file says.
        let name = name.replace(char::is_control, " ");
        let once = self.once(name.clone());
        let is_taken = once != name;
        (once, is_taken)
    }

    fn once(&mut self, name: String) -> String {
        let count = self.given.entry(name.clone()).or_insert(0);
        *count += 1;
        match *count {
            1 => name,
            number => self.once(format!("{name} ({number})")),
        }
    }

    fn common_words(&self, called: &Called) -> Option<String> {
        let mut keys = called
            .values
            .iter()
            .map(|(key, _)| (called.kind.clone(), key.clone()));
        let is_swept = keys.any(|place| self.common.contains(&place));
        is_swept.then(|| self.words(called, &self.common))
    }

    fn words(&self, called: &Called, telling: &BTreeSet<(String, String)>) -> String {
        let told = called.values.iter();
        let told: Vec<&(String, Word)> = told
            .filter(|(key, _)| telling.contains(&(called.kind.clone(), key.clone())))
            .collect();
        let numbers = told
            .iter()
            .filter(|(_, word)| matches!(word, Word::Number(_)))
            .count();
        let has_several = numbers > 1 || self.many_numbers.contains(&called.kind);
        let mut words = vec![called.kind.clone()];
        for (key, word) in told {
            words.push(match word {
                Word::Plain(text) => text.clone(),
                Word::Number(text) if key == SIZE && !has_several => text.clone(),
                Word::Number(text) => format!("{key} {text}"),
                Word::Switch(true) => key.clone(),
                Word::Switch(false) => format!("not {key}"),
                Word::Other(text) if text.len() <= LONGEST_LIST => text.clone(),
                Word::Other(_) => key.clone(),
            });
        }
        words.join(" ")
    }
}

/// Every key of a repair.
fn all_keys(called: &Called) -> BTreeSet<(String, String)> {
    let keys = called.values.iter();
    keys.map(|(key, _)| (called.kind.clone(), key.clone())).collect()
}

/// What a ring goes by, as on its box; a bare number of any other key could be a place, a length or a count.
const SIZE: &str = "size_mm";

/// A list of more letters, such as a curve, is no part of a name; a point is.
const LONGEST_LIST: usize = 30;

fn swept(block: &Block) -> BTreeSet<(String, String)> {
    let keys = block.repairs.iter().flat_map(|place| {
        let kind = called(&place.table).kind;
        place
            .sweeps
            .0
            .iter()
            .map(move |sweep| (kind.clone(), sweep.key.clone()))
    });
    keys.collect()
}

/// Keys that are swept, or that repairs of one kind do not share with one value; all keys of a repair that is alone of its kind and not
/// swept, whose kind by itself would not say what is done.
fn differing(blocks: &[Block]) -> BTreeSet<(String, String)> {
    let mut of_kind: BTreeMap<String, usize> = BTreeMap::new();
    let mut found: BTreeMap<(String, String), (usize, BTreeSet<Word>)> = BTreeMap::new();
    for place in blocks.iter().flat_map(|block| &block.repairs) {
        let called = called(&place.table);
        *of_kind.entry(called.kind.clone()).or_default() += 1;
        for (key, word) in called.values {
            let (count, words) = found.entry((called.kind.clone(), key)).or_default();
            *count += 1;
            words.insert(word);
        }
    }
    let swept: BTreeSet<_> = blocks.iter().flat_map(swept).collect();
    let tells = |(kind, _): &(String, String), (count, words): &(usize, BTreeSet<Word>)| {
        let is_alone = of_kind.get(kind) == Some(&1) && !swept.iter().any(|(of, _)| of == kind);
        is_alone || words.len() > 1 || of_kind.get(kind).is_some_and(|all| count < all)
    };
    let telling = found.iter().filter(|(place, it)| tells(place, it));
    let mut keys: BTreeSet<_> = telling.map(|(place, _)| place.clone()).collect();
    keys.extend(swept);
    keys
}
