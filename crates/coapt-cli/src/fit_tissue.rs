//! `coapt fit-tissue`: springs that follow a biaxial curve, as the block to paste into a scene.

use std::path::PathBuf;

use clap::Args;
use coapt_io::tissue::{UP_TO_KPA, fit_tissue};

use crate::closure::Format;
use crate::output::{Failure, Verdict, print};

/// What `coapt fit-tissue` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A table of stretches and stresses or tensions.
    #[arg(help = CURVE_HELP)]
    curve: PathBuf,
    /// Springs with a direction instead of isotropic ones, which follow the gain of area
    #[arg(long)]
    anisotropic: bool,
    /// Largest Cauchy stress that is followed [kPa]: that at which closed leaflets work, some 50 to 150
    #[arg(long = "up-to", value_name = "KPA", default_value_t = UP_TO_KPA, allow_negative_numbers = true)]
    up_to_kpa: f64,
    /// Thickness of the tissue [mm], for a table of tensions
    #[arg(long = "thickness", value_name = "MM", allow_negative_numbers = true)]
    thickness_mm: Option<f64>,
    /// How the result is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

const CURVE_HELP: &str = "A table with the columns stretch_circ, stretch_rad and, for both directions, \
                          cauchy_stress_circ_kpa (or _mpa), nominal_stress_circ_kpa (or _mpa) or \
                          tension_circ_n_per_m (or _n_per_mm)";

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let fit = fit_tissue(
        &arguments.curve,
        arguments.anisotropic,
        arguments.up_to_kpa,
        arguments.thickness_mm,
    )?;
    print(&match arguments.format {
        Format::Text => fit.text(),
        Format::Json => fit.json(),
    })?;
    Ok(Verdict::Done)
}
