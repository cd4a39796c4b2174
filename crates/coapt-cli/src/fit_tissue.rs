//! `coapt fit-tissue`: springs that follow a biaxial curve, as the block to paste into a scene.

use std::path::PathBuf;

use clap::Args;
use coapt::scene::{SpringBranches, default_bending_modulus_mpa, default_compression_modulus_ratio};
use coapt::tissue_fit::{BilinearFit, anisotropic_from_curve, area_equivalent, bilinear_from_curve};
use coapt_io::biaxial::read_biaxial;
use coapt_io::escape::escaped;
use coapt_io::report::NOTICE;
use serde_json::json;

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
    #[arg(long = "up-to", value_name = "KPA", default_value_t = 100.0)]
    up_to_kpa: f64,
    /// Thickness of the tissue [mm], for a table of tensions
    #[arg(long = "thickness", value_name = "MM")]
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
    let points = read_biaxial(&arguments.curve, arguments.thickness_mm)?;
    let range_mpa = [0.0, 1e-3 * arguments.up_to_kpa];
    let fit = match arguments.anisotropic {
        true => anisotropic_from_curve(&points, range_mpa, default_compression_modulus_ratio()),
        false => bilinear_from_curve(
            &area_equivalent(&points),
            range_mpa,
            default_compression_modulus_ratio(),
        ),
    };
    let name = arguments.curve.display().to_string();
    let fit = fit.map_err(|mut faults| {
        faults
            .iter_mut()
            .for_each(|fault| fault.place = format!("{name} {}", fault.place));
        faults
    })?;
    print(&match arguments.format {
        Format::Text => text(&name, arguments.anisotropic, &fit),
        Format::Json => {
            let law = if arguments.anisotropic {
                "anisotropic-springs"
            } else {
                "bilinear-springs"
            };
            let whole = json!({
                "schema": "coapt-fit-tissue/1", "notice": NOTICE, "curve": name, "law": law, "fit": fit,
            });
            format!("{whole:#}\n")
        }
    })?;
    Ok(Verdict::Done)
}

/// The block of a scene, with what was fitted and how well as comments.
fn text(name: &str, anisotropic: bool, fit: &BilinearFit) -> String {
    let what = if anisotropic {
        "both directions"
    } else {
        "gain of area"
    };
    let percent = 100.0 * fit.rms_error_mpa / fit.rms_stress_mpa;
    let head = format!(
        "# Fitted to {}, {what}, Cauchy stress {} to {} MPa, {} points. Nominal stress: root mean square of the\n\
         # error {:.3e} MPa ({percent:.1} % of the stress), largest {:.3e} MPa. {NOTICE}\n[leaflets.tissue]\n",
        escaped(name),
        fit.working_range_mpa[0],
        fit.working_range_mpa[1],
        fit.points,
        fit.rms_error_mpa,
        fit.worst_error_mpa
    );
    match anisotropic {
        // As much as the other laws bend by default.
        false => format!(
            "{head}law = \"bilinear-springs\"\n{}bending_modulus_ratio = {}\n",
            keys(&fit.circumferential),
            number(default_bending_modulus_mpa() / fit.circumferential.pre_transition_modulus_mpa)
        ),
        true => format!(
            "{head}law = \"anisotropic-springs\"\n\n[leaflets.tissue.circumferential]\n{}\n[leaflets.tissue.radial]\n{}",
            keys(&fit.circumferential),
            keys(&fit.radial)
        ),
    }
}

/// Six digits, more than any tissue is known to.
fn number(value: f64) -> String {
    match format!("{value:.5e}").parse::<f64>() {
        Ok(rounded) => format!("{rounded:?}"),
        Err(_) => format!("{value:?}"),
    }
}

fn keys(branches: &SpringBranches) -> String {
    format!(
        "pre_transition_modulus_mpa = {}\ntransition_strain = {}\npost_transition_modulus_mpa = {}\n",
        number(branches.pre_transition_modulus_mpa),
        number(branches.transition_strain),
        number(branches.post_transition_modulus_mpa)
    )
}
