//! `coapt check`: reads and validates a scene, lists every fault.

use std::path::PathBuf;

use clap::Args;
use coapt_io::check::{BuiltValve, CheckReport};

use crate::case::{self, SizeLimit};
use crate::closure::Format;
use crate::output::{Failure, Verdict, print};

/// What `coapt check` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A scene file, a folder with a scene.toml, or a preset
    scene: PathBuf,
    /// How the faults are printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    #[command(flatten)]
    limit: SizeLimit,
}

/// Runs the verb. The faults are its result, so they go to standard output; errors also make it fail.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let (valve, faults) =
        match case::open(Some(&arguments.scene), arguments.limit).and_then(|case| case::build(&case)) {
            Ok(built) => (Some(BuiltValve::from(&built.model)), built.warnings),
            Err(faults) => (None, faults),
        };
    let report = CheckReport {
        scene: arguments.scene.display().to_string(),
        faults,
        valve,
    };
    print(&match arguments.format {
        Format::Text => report.text(),
        Format::Json => report.json(),
    })?;
    match report.errors() {
        0 => Ok(Verdict::Done),
        // Everything is said already.
        _ => Err(Failure::Input(Vec::new())),
    }
}
