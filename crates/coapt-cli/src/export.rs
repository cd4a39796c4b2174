//! `coapt export`: a valve as input of another engine, and that engine's result as a surface.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use coapt::model::{Built, Model};
use coapt::scene::Fault;
use coapt_io::export::{calculix, febio, read_positions, write_export};
use coapt_io::report::write_closed_surface;

use crate::case::{self, Case, SizeLimit};
use crate::output::{Failure, Verdict, tell};

/// What `coapt export` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A scene file, a folder with a scene.toml, or a preset
    scene: PathBuf,
    /// Write the valve as input of this engine
    #[arg(
        long,
        value_enum,
        required_unless_present = "results",
        conflicts_with = "results"
    )]
    format: Option<Engine>,
    /// Write the closed leaflets (.vtp) as this result of an engine places them: .dat or .frd of CalculiX, FEBio's log of
    /// nodes, or a table with commas
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    limit: SizeLimit,
}

/// An engine that reads what we write.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Engine {
    /// CalculiX 2.20 (.inp), without contact.
    Calculix,
    /// FEBio, format 4.0 (.feb), with FEBio's own contact.
    Febio,
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let case = case::open(Some(&arguments.scene), arguments.limit)?;
    let Built { model, warnings, .. } = case::build(&case)?;
    tell(&warnings);
    match (arguments.format, &arguments.results) {
        (Some(engine), _) => write_input(&case, &model, engine, &arguments.out),
        (None, Some(results)) => write_surface(&model, results, &arguments.out),
        // One of the two is required.
        (None, None) => Ok(Verdict::Done),
    }
}

fn write_input(case: &Case, model: &Model, engine: Engine, out: &Path) -> Result<Verdict, Failure> {
    let text = match engine {
        Engine::Calculix => calculix(model),
        Engine::Febio => febio(model),
    };
    let text = text.map_err(|faults: Vec<Fault>| case.source.locate(&faults))?;
    write_export(out, &text).map_err(Failure::Outside)?;
    Ok(Verdict::Done)
}

fn write_surface(model: &Model, results: &Path, out: &Path) -> Result<Verdict, Failure> {
    let (positions, warnings) = read_positions(results, model)?;
    tell(&warnings);
    write_closed_surface(out, model, &positions).map_err(Failure::Outside)?;
    Ok(Verdict::Done)
}
