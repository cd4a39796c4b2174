//! `coapt generate`: writes a parametric valve as a scene.

use std::path::{Path, PathBuf};

use clap::Args;
use coapt::mesh::parametric::{self, Preset, ValveParameters};
use coapt::model::doubts;
use coapt::scene::Fault;
use coapt_io::escape::escaped;
use coapt_io::scene::{nearest, sentence, with_parameter, write_scene};
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

/// The parameters with one of them replaced, as the option says it.
fn set(parameters: &ValveParameters, setting: &str) -> Result<ValveParameters, String> {
    let (key, value) = setting.split_once('=').ok_or("expected KEY=VALUE")?;
    // Words need no quotes: whatever is no TOML value is text.
    let word = value.trim();
    let value = match word.parse::<Toml>() {
        Ok(value) => value,
        Err(_) => Toml::String(word.to_owned()),
    };
    with_parameter(parameters, key.trim(), value, word)
}
