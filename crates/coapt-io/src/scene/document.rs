//! The text of a scene or a plan, TOML or JSON, into its type; what is wrong with line and column.

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::Path;

use coapt::scene::{Fault, SCHEMA_VERSION};
use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::json_text::blank_entry;
use super::nearest::nearest;
use super::{missing_key, wrong_type};
use crate::encoding;
use crate::mesh::{looks_binary, mesh_format};

/// Larger texts are refused: a scene with a mesh of half a million faces written into it takes less.
const SIZE_LIMIT_BYTES: u64 = 64 << 20;

/// What stands where something else was given.
const EXPECTED: &str = "a scene or a plan is a TOML or JSON file";

/// Faults after which reading stops: enough to see the pattern.
const FAULT_LIMIT: usize = 20;

/// A text file of acceptable size.
///
/// # Errors
/// No regular file, too large, not UTF-8, empty, or what the file system says.
pub fn read_text(path: &Path) -> Result<String, Fault> {
    let fault = |message: String| Fault::error(path.display().to_string(), message);
    // Asked before opening: to open a FIFO is to wait for its writer.
    let metadata = std::fs::metadata(path).map_err(|error| fault(error.to_string()))?;
    if metadata.is_dir() {
        return Err(fault("is a folder, not a file".into()));
    }
    if !metadata.is_file() {
        return Err(fault("is not a regular file".into()));
    }
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(SIZE_LIMIT_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|error| fault(error.to_string()))?;
    if bytes.len() as u64 > SIZE_LIMIT_BYTES {
        return Err(fault(format!(
            "is larger than {} MiB; put meshes into files of their own and name them by `mesh_file`",
            SIZE_LIMIT_BYTES >> 20
        )));
    }
    // First: a mesh of binary numbers may begin like anything.
    if let Some(format) = mesh_format(&bytes) {
        return Err(fault(format!("is a mesh ({format}); {EXPECTED}")));
    }
    if let Some(message) = encoding::refusal(&bytes) {
        return Err(fault(message.into()));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        if looks_binary(error.as_bytes()) {
            return fault(format!("is no text; {EXPECTED}"));
        }
        let line = error.as_bytes()[..error.utf8_error().valid_up_to()]
            .iter()
            .filter(|&&byte| byte == b'\n')
            .count();
        Fault::error(
            format!("{}:{}", path.display(), line + 1),
            "is not UTF-8 text; save it as UTF-8",
        )
    })?;
    if text.trim().is_empty() {
        return Err(fault("is empty".into()));
    }
    // Some editors begin a file with a byte order mark.
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Whether a text is JSON; no TOML document begins with a brace, but one may begin with a header, `[load]`.
pub(super) fn is_json(text: &str) -> bool {
    let text = text.trim_start();
    let inside = text.trim_start_matches('[').trim_start();
    let is_header = inside.starts_with(|letter: char| letter.is_alphabetic() || letter == '_');
    text.starts_with('{') || (text.starts_with('[') && !is_header)
}

/// Reads a document. Of TOML, all syntax faults, or all unknown keys and wrong types are told; of JSON, all unknown keys up to
/// the first other fault.
///
/// # Errors
/// Faults with their place as `file:line:column`.
pub(super) fn parse<T: DeserializeOwned>(file: &str, text: &str) -> Result<T, Vec<Fault>> {
    if is_json(text) {
        parse_json(file, text)
    } else {
        parse_toml(file, text)
    }
}

pub(super) fn parse_json<T: DeserializeOwned>(file: &str, text: &str) -> Result<T, Vec<Fault>> {
    #[derive(serde::Deserialize)]
    struct Version {
        schema_version: Option<u64>,
    }
    // A newer layout is told before the keys that are unknown for that reason.
    if let Ok(Version {
        schema_version: Some(version),
    }) = serde_json::from_str(text)
        && let Some(message) = wrong_version(version)
    {
        return Err(vec![Fault::error(format!("{file}: schema_version"), message)]);
    }
    let mut bytes = text.as_bytes().to_vec();
    let mut found = Vec::new();
    loop {
        let error = match serde_json::from_slice::<T>(&bytes) {
            Ok(value) if found.is_empty() => return Ok(value),
            Ok(_) => return Err(found),
            Err(error) => error,
        };
        let told = error.to_string();
        let (message, unknown) = plain(told.split(" at line ").next().unwrap_or(&told));
        let [line, column] = [error.line(), error.column()].map(|number| number.max(1));
        // Whatever begins with a brace lands here.
        let message = match error.is_syntax() && (line, found.len()) == (1, 0) && column <= 2 {
            true => {
                format!("{message}; the text is read as JSON since it begins with a bracket, but {EXPECTED}")
            }
            false => message,
        };
        found.push(Fault::error(format!("{file}:{line}:{column}"), message));
        let line_start = text
            .split_inclusive('\n')
            .take(line - 1)
            .map(str::len)
            .sum::<usize>();
        let blank = |key: String| blank_entry(&mut bytes, &key, line_start + column - 1);
        if found.len() >= FAULT_LIMIT || unknown.and_then(blank).is_none() {
            return Err(found);
        }
    }
}

fn wrong_version(version: u64) -> Option<String> {
    let supported = u64::from(SCHEMA_VERSION);
    (version != supported).then(|| match version > supported {
        true => {
            format!("is {version}, this version reads {supported}; install a newer coapt to read this file")
        }
        false => format!("is {version}, this version reads {supported}"),
    })
}

fn parse_toml<T: DeserializeOwned>(file: &str, text: &str) -> Result<T, Vec<Fault>> {
    typed(file, text, toml_table(file, text)?)
}

/// A TOML document of our version as a table that knows where everything stands.
pub(super) fn toml_table<'t>(file: &str, text: &'t str) -> Result<Spanned<DeTable<'t>>, Vec<Fault>> {
    let (table, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        return Err(syntax_faults(file, text, &errors));
    }
    if let Some(version) = table.get_ref().get("schema_version")
        && let DeValue::Integer(number) = version.get_ref()
        && let Ok(number) = number.as_str().parse()
        && let Some(message) = wrong_version(number)
    {
        return Err(vec![Fault::error(
            place(file, text, version.span().start),
            format!("schema_version {message}"),
        )]);
    }
    Ok(table)
}

/// A table as its type.
pub(super) fn typed<T: DeserializeOwned>(
    file: &str,
    text: &str,
    table: Spanned<DeTable<'_>>,
) -> Result<T, Vec<Fault>> {
    deserialize(table).map_err(|mut found| {
        found.sort_by_key(|(byte, _)| *byte);
        found
            .into_iter()
            .map(|(byte, message)| {
                Fault::error(place(file, text, byte), syntax(text, &(byte..byte), &message))
            })
            .collect()
    })
}

/// Syntax faults in our words. After a bracket that nobody closes every line looks wrong, and only the first is told.
fn syntax_faults(file: &str, text: &str, errors: &[toml::de::Error]) -> Vec<Fault> {
    let start = |error: &toml::de::Error| error.span().map_or(0, |span| span.start);
    if let Some(unclosed) = errors
        .iter()
        .find(|error| error.message().starts_with("unclosed"))
    {
        let first = errors.iter().map(start).min().unwrap_or(0);
        let message = format!("{}; it begins before this", unclosed.message());
        return vec![Fault::error(place(file, text, first), message)];
    }
    let told = errors.iter().take(FAULT_LIMIT).map(|error| {
        let span = error.span().unwrap_or(0..0);
        Fault::error(
            place(file, text, span.start),
            syntax(text, &span, error.message()),
        )
    });
    told.collect()
}

/// What a syntax fault at these bytes is, where its words alone do not help.
fn syntax(text: &str, span: &Range<usize>, message: &str) -> String {
    let digit = |byte: Option<&u8>| byte.is_some_and(u8::is_ascii_digit);
    let bytes = text.as_bytes();
    let comma = span.start.min(bytes.len())..bytes.len().min(span.start.saturating_add(2));
    let after_digit = span.start > 0 && digit(bytes.get(span.start - 1));
    match bytes.get(comma) {
        Some([b',', next]) if after_digit && digit(Some(next)) => {
            "decimal comma; write numbers with \".\"".to_owned()
        }
        _ if message.starts_with("cannot recurse further") => "brackets are nested too deeply".to_owned(),
        _ if message.contains("number overflowed") => {
            let word: String = text.get(span.start..).unwrap_or("").chars().take(40).collect();
            let end = word.find(|c: char| !(c.is_ascii_alphanumeric() || "+-._".contains(c)));
            format!(
                "`{}` is too large for a number",
                &word[..end.unwrap_or(word.len())]
            )
        }
        _ => message.to_owned(),
    }
}

/// The value, or what is wrong and at which byte. An unknown key is told and taken out, and a value of a wrong type is told
/// and replaced by one of the right type, so that the next fault is found as well.
fn deserialize<T: DeserializeOwned>(mut table: Spanned<DeTable<'_>>) -> Result<T, Vec<(usize, String)>> {
    let mut found = Vec::new();
    loop {
        let error = match T::deserialize(toml::Deserializer::from(table.clone())) {
            Ok(value) if found.is_empty() => return Ok(value),
            Ok(_) => return Err(found),
            Err(error) => error,
        };
        let (mut message, unknown) = plain(error.message());
        let whole = table.span();
        let span = error.span().unwrap_or(whole.clone());
        let mut mended = unknown.and_then(|key| take_out(table.get_mut(), &whole, &key, span.clone()));
        if let Some((key, at)) = wrong_type::replace::<T>(&mut table, &error) {
            message = format!("{key}: {message}");
            mended = Some(at);
        }
        let told =
            value_in(&table, &span, error.message()).or_else(|| missing_key::lacking::<T>(&table, &error));
        let span = told.unwrap_or(span);
        let go_on = mended.is_some() && found.len() + 1 < FAULT_LIMIT;
        found.push((mended.unwrap_or(span).start, message));
        if !go_on {
            return Err(found);
        }
    }
}

/// Where a wrong value stands, if the reader lost track of it: in tables that a tag tells apart, it names the table.
fn value_in(table: &Spanned<DeTable<'_>>, span: &Range<usize>, message: &str) -> Option<Range<usize>> {
    let word = message.strip_prefix("unknown variant `")?.split('`').next()?;
    fn find(table: &DeTable<'_>, inside: bool, span: &Range<usize>, word: &str) -> Option<Range<usize>> {
        table
            .iter()
            .find_map(|(_, value)| find_value(value, inside, span, word))
    }
    fn find_value(
        value: &Spanned<DeValue<'_>>,
        inside: bool,
        span: &Range<usize>,
        word: &str,
    ) -> Option<Range<usize>> {
        let here = inside || value.span() == *span;
        match value.get_ref() {
            DeValue::String(text) if here && text == word => Some(value.span()),
            DeValue::Table(table) => find(table, here, span, word),
            DeValue::Array(items) => items.iter().find_map(|item| find_value(item, here, span, word)),
            _ => None,
        }
    }
    find(table.get_ref(), table.span() == *span, span, word)
}

/// Removes the key that an error at `span` speaks of and gives its place: the key itself stands there, or, where
/// the reader lost track (in tables that a tag tells apart), the table that holds it.
fn take_out(
    table: &mut DeTable<'_>,
    of_table: &Range<usize>,
    key: &str,
    span: Range<usize>,
) -> Option<Range<usize>> {
    if let Some((found, _)) = table.get_key_value(key)
        && (found.span() == span || *of_table == span)
    {
        let place = found.span();
        table.remove(key);
        return Some(place);
    }
    table
        .iter_mut()
        .find_map(|(_, value)| take_out_of_value(value, key, &span))
}

fn take_out_of_value(
    value: &mut Spanned<DeValue<'_>>,
    key: &str,
    span: &Range<usize>,
) -> Option<Range<usize>> {
    let of_value = value.span();
    match value.get_mut() {
        DeValue::Table(table) => take_out(table, &of_value, key, span.clone()),
        // Of several tables that a tag tells apart, the reader names them all.
        DeValue::Array(items) => items.iter_mut().find_map(|item| {
            let of_item = item.span();
            take_out_of_value(item, key, if of_value == *span { &of_item } else { span })
        }),
        _ => None,
    }
}

/// What a reader of TOML or JSON says of a value, in words for those who write no programs: `expected a whole number` for
/// `expected u32`.
pub fn in_plain_words(message: &str) -> String {
    plain(message).0
}

/// The reader's words in ours, and the key if it is an unknown one.
pub(super) fn plain(message: &str) -> (String, Option<String>) {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let (noun, is_key) = match message {
        _ if message.starts_with("unknown field") => ("key", true),
        _ if message.starts_with("unknown variant") => ("value", false),
        _ if message.starts_with("missing field") && quoted.len() == 1 => {
            return (format!("the key `{}` is missing", quoted[0]), None);
        }
        _ if message == "expected value" => {
            return (
                "expected a value; JSON has no NaN and no Infinity".to_owned(),
                None,
            );
        }
        _ if message.starts_with("duplicate field") && quoted.len() == 1 => {
            return (format!("duplicate key `{}`", quoted[0]), None);
        }
        _ if message == "key must be a string" => {
            let ours = "expected a key in double quotes; JSON has neither comments nor other quotes";
            return (ours.to_owned(), None);
        }
        _ if message.starts_with("EOF while parsing") => {
            return (message.replace("EOF while parsing", "the file ends within"), None);
        }
        _ if message == "trailing characters" => {
            return ("more follows after the end of the document".to_owned(), None);
        }
        _ if message.starts_with("invalid ") => return (in_plain_types(message), None),
        _ => return (message.to_owned(), None),
    };
    let [word, known @ ..] = &quoted[..] else {
        return (message.to_owned(), None);
    };
    let advice = match nearest(word, known.iter().copied()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!("there are {}", known.join(", ")),
    };
    (
        format!("unknown {noun} `{word}`; {advice}"),
        is_key.then(|| (*word).to_owned()),
    )
}

/// `invalid type: sequence, expected f64` says little to who does not write programs.
fn in_plain_types(message: &str) -> String {
    let words = [
        ("expected f64", "expected a number"),
        ("expected u32", "expected a whole number, 0 or above"),
        ("expected u64", "expected a whole number, 0 or above"),
        ("expected usize", "expected a whole number, 0 or above"),
        ("expected i64", "expected a whole number"),
        ("expected struct ", "expected a table: "),
        ("type: sequence", "type: list"),
        ("type: map", "type: table"),
        ("expected a sequence", "expected a list"),
        ("an array of length", "a list of length"),
        ("floating point", "number"),
    ];
    let plain = |told: String, (theirs, ours): (&str, &str)| told.replacen(theirs, ours, 1);
    words.into_iter().fold(message.to_owned(), plain)
}

/// Line and column of a byte, both from 1; columns count letters.
fn place(file: &str, text: &str, byte: usize) -> String {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |end| end + 1);
    let column = before[line_start..].chars().count() + 1;
    format!("{file}:{}:{column}", line_of(text, byte))
}

/// Line of a byte, from 1.
pub(super) fn line_of(text: &str, byte: usize) -> usize {
    let before = text.get(..byte).unwrap_or(text);
    before.bytes().filter(|&letter| letter == b'\n').count() + 1
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use coapt::scene::{Plan, Scene};

    /// The faults of a text, each as place and message.
    pub(in super::super) fn told<T: DeserializeOwned>(text: &str) -> Vec<String> {
        let faults = parse::<T>("f", text).err().unwrap_or_default();
        faults
            .iter()
            .map(|fault| format!("{}: {}", fault.place, fault.message))
            .collect()
    }

    #[test]
    fn every_unknown_key_is_told_with_its_place() {
        let text = "schema_version = 1\nname = \"a\"\ncolour = 1\n[load]\npressure_mmgh = 100\n[[leaflets]]\n\
                    name = \"x\"\n[leaflets.tissue]\nlaw = \"bilinear-springs\"\n  transition_strian = 0.2\n";
        let told = told::<Scene>(text);
        assert_eq!(told.len(), 3, "{told:#?}");
        assert!(told[0].starts_with("f:3:1: unknown key `colour`; there are schema_version"));
        let has = |words: &str| assert!(told.iter().any(|line| line == words), "{told:#?}");
        has("f:5:1: unknown key `pressure_mmgh`; did you mean `pressure_mmhg`?");
        has("f:10:3: unknown key `transition_strian`; did you mean `transition_strain`?");
    }

    #[test]
    fn every_unknown_key_of_json_is_told() {
        let text = "{\"schema_version\": 1, \"colour\": [1, {\"a\": 2}],\n \"repair\": [{\"kind\": \"ring\", \"size\": 3}],\n \"repiar\": []}";
        let told = told::<Plan>(text);
        // Where a tag tells tables apart, the reader loses track: what comes after stays untold.
        assert_eq!(
            told,
            [
                "f:1:30: unknown key `colour`; there are schema_version, name, repair",
                "f:2:40: unknown key `size`; did you mean `size_mm`?",
            ]
        );
        let told = self::told::<Plan>("{\"nmae\": 1,\n \"repiar\": [],\"schema_version\": 1}");
        assert_eq!(
            told,
            [
                "f:1:7: unknown key `nmae`; did you mean `name`?",
                "f:2:9: unknown key `repiar`; did you mean `repair`?"
            ]
        );
    }

    #[test]
    fn syntax_and_type_faults_have_line_and_column() {
        for (text, start) in [
            ("schema_version = 1\nname = 5\n", "f:2:8: name: invalid type"),
            (
                "schema_version = 1\nname = \"a\"\nname = \"b\"",
                "f:3:1: duplicate key",
            ),
            ("schema_version = \n", "f:1:18: "),
            ("schema_version = 1,5\n", "f:1:19: decimal comma"),
            (
                "schema_version = 1\nrepair = [{ size_mm = 3\nname = \"a\"\n",
                "f:3:1: unclosed",
            ),
            ("name = \"a\"", "f:1:1: the key `schema_version` is missing"),
            ("{\"schema_version\": 1, \"name\": \"a\",}", "f:1:35: "),
            (
                "{\"schema_version\": 1, \"repiar\": []}",
                "f:1:30: unknown key `repiar`; did you mean `repair`?",
            ),
            (
                "{\"schema_version\": 9, \"future\": 0}",
                "f: schema_version: is 9, this version reads 1; install a newer coapt",
            ),
            ("future = 0\nschema_version = 9", "f:2:18: schema_version is 9"),
            (
                "schema_version = 1\n[[repair]]\nkind = \"rign\"",
                "f:3:8: unknown value `rign`; did you mean `ring`?",
            ),
        ] {
            let told = told::<Plan>(text);
            assert!(!told.is_empty() && told[0].starts_with(start), "{text}: {told:?}");
        }
    }

    #[test]
    fn deep_nesting_is_refused_without_overflow() {
        // 1e5 levels would overflow any stack if they were followed.
        let deep = "[".repeat(100_000);
        assert!(!told::<Plan>(&format!("{{\"schema_version\":1,\"name\":{deep}")).is_empty());
        assert!(!told::<Plan>(&deep).is_empty());
        assert!(!told::<Plan>(&format!("name = {deep}")).is_empty());
        assert!(!told::<Plan>(&format!("name = {}", "{a=".repeat(100_000))).is_empty());
        assert!(!told::<Plan>(&format!("{}b = 1", "a.".repeat(100_000))).is_empty());
    }
}
