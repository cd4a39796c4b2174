//! `coapt generate`: writes a parametric valve as a scene.

use std::path::{Path, PathBuf};

use clap::Args;
use coapt::mesh::parametric::{self, Preset, ValveParameters};
use coapt::model::doubts;
use coapt::scene::Fault;
use coapt_io::escape::escaped;
use coapt_io::scene::{in_plain_words, nearest, sentence, write_scene};
use serde_json::Value;
use toml::Value as Toml;

use crate::output::{Failure, Verdict, print, tell};

/// What `coapt generate` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// healthy, dilated, flail, barlow or restricted
    #[arg(default_value = "healthy")]
    preset: String,
    /// A parameter by its dotted key; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE", help = SET_HELP)]
    settings: Vec<String>,
    /// Folder for scene.toml and its meshes, made if need be
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Write into a folder that is not empty
    #[arg(long)]
    force: bool,
}

const SET_HELP: &str = "A parameter of the valve, such as annulus.transverse_mm=42, \
                        leaflets.anterior_heights_mm=[16,23,16] or faces=2600; may be given several times";

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let mut parameters = ValveParameters::preset(preset(&arguments.preset)?);
    for setting in &arguments.settings {
        parameters = set(&parameters, setting)
            .map_err(|message| vec![Fault::error(format!("--set {setting}"), message)])?;
    }
    let scene = parametric::generate(&parameters).map_err(|faults| -> Vec<Fault> {
        let named = |fault: &Fault| Fault::error("generate", sentence(fault));
        faults.iter().map(named).collect()
    })?;
    tell(&doubts(&scene));
    refuse_full(&arguments.out, arguments.force)?;
    write_scene(&arguments.out, &scene).map_err(Failure::Outside)?;
    let written = arguments.out.join("scene.toml").display().to_string();
    print(&(escaped(&written) + "\n"))?;
    Ok(Verdict::Done)
}

fn preset(name: &str) -> Result<Preset, Vec<Fault>> {
    let names = Preset::ALL.map(Preset::name);
    Preset::from_name(name).ok_or_else(|| {
        let advice = match nearest(name, names) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("there are {}", names.join(", ")),
        };
        vec![Fault::error("PRESET", format!("`{name}` is unknown; {advice}"))]
    })
}

/// A folder with something in it is overwritten only when asked for.
fn refuse_full(folder: &Path, force: bool) -> Result<(), Failure> {
    let place = folder.display().to_string();
    if folder.exists() && !folder.is_dir() {
        return Err(vec![Fault::error(place, "is a file; expected a folder to write to")].into());
    }
    let mut entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(Failure::Outside(Fault::error(place, error.to_string()))),
    };
    if entries.next().is_some() && !force {
        let message = "is not empty; give another folder, or --force to write into it";
        return Err(vec![Fault::error(place, message)].into());
    }
    Ok(())
}

/// The parameters with one of them replaced; keys are dotted as in TOML, `faces` is short for `face_count_target`.
fn set(parameters: &ValveParameters, setting: &str) -> Result<ValveParameters, String> {
    let (key, value) = setting.split_once('=').ok_or("expected KEY=VALUE")?;
    let key = match key.trim() {
        "faces" => "face_count_target",
        key => key,
    };
    // Words need no quotes: whatever is no TOML value is text.
    let word = value.trim();
    let value = match word.parse::<Toml>() {
        Ok(value) => value,
        Err(_) => Toml::String(word.to_owned()),
    };
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
        let known: Vec<&str> = entries.keys().map(String::as_str).collect();
        let advice = match nearest(step, known.iter().copied()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("there are {}", known.join(", ")),
        };
        return Err(format!("unknown key `{step}`; {advice}"));
    }
    put(entries.entry(*step).or_insert(Value::Null), rest, value)
}
