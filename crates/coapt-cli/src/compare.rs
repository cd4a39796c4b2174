//! `coapt compare`: how far apart two surfaces lie, under every published definition.

use std::path::PathBuf;

use clap::Args;
use coapt::Vec3;
use coapt::measure::compare::CompareSettings;
use coapt::scene::{Fault, Settings};
use coapt_io::compare::{ComparisonReport, read_surface, text, write_comparison};

use crate::closure::Format;
use crate::output::{Failure, Verdict, print, say};
use crate::whole_number::whole_number;

/// What `coapt compare` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The surface in question: a surface file (.vtp, .vtk, .ply, .stl, .obj), or a folder that `coapt closure --out`
    /// wrote
    result: PathBuf,
    /// The surface that it is held against, likewise; both in one frame, in mm
    reference: PathBuf,
    /// Folder for comparison.json and error.vtp (the result with its error at each point), made if need be; files of
    /// these names are replaced
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How the comparison is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Towards the atrium, in LPS, of any length [default: from the rim of each surface that is its annulus]
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    atrial_direction: Option<Vec3>,
    /// Distance of mid-surfaces in contact [mm]: slits up to twice as wide hide what is in them from the atrium
    /// [default: 1]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    thickness: Option<f64>,
    /// The point array that is above 0.5 where tissue touches tissue
    #[arg(long, value_name = "NAME", default_value = "contact")]
    contact_array: String,
    /// Refuse surfaces of more triangles [default: 250000]
    #[arg(long, value_name = "N", value_parser = whole_number(1..=u32::MAX), allow_negative_numbers = true)]
    max_faces: Option<u32>,
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let face_limit = arguments.max_faces.unwrap_or(Settings::default().face_limit);
    let read = |path| read_surface(path, &arguments.contact_array, face_limit);
    // Both before any of them is refused: two wrong names are told at once.
    let (result, reference) = (read(&arguments.result), read(&arguments.reference));
    let ((result, mut warnings), (reference, more)) = match (result, reference) {
        (Ok(result), Ok(reference)) => (result, reference),
        (result, reference) => {
            let faults = result.err().into_iter().chain(reference.err());
            return Err(faults.flatten().collect::<Vec<Fault>>().into());
        }
    };
    warnings.extend(more);
    let defaults = CompareSettings::default();
    let settings = CompareSettings {
        atrial_direction: arguments.atrial_direction,
        contact_thickness_mm: arguments.thickness.unwrap_or(defaults.contact_thickness_mm),
    };
    let report = ComparisonReport::new(&result, &reference, &settings, &arguments.contact_array, warnings)
        .map_err(by_option)?;
    if let Some(folder) = &arguments.out {
        write_comparison(folder, &result.mesh, &report).map_err(Failure::Outside)?;
    }
    print(&match arguments.format {
        Format::Text => text(&report),
        Format::Json => report.json().map_err(Failure::Outside)?,
    })?;
    if let Some(folder) = &arguments.out {
        say(&format!("results are in {}", folder.display()));
    }
    Ok(Verdict::Done)
}

/// Faults of settings by the options that set them.
fn by_option(faults: Vec<Fault>) -> Vec<Fault> {
    let named = |fault: Fault| {
        let place = match fault.place.as_str() {
            "contact_thickness_mm" => "--thickness".to_owned(),
            "atrial_direction" => "--atrial-direction".to_owned(),
            _ => fault.place,
        };
        Fault { place, ..fault }
    };
    faults.into_iter().map(named).collect()
}

fn direction(word: &str) -> Result<Vec3, String> {
    let numbers: Option<Vec<f64>> = word.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(Vec3::new(x, y, z)),
        _ => Err("expected three numbers, as in 0,0,1".to_owned()),
    }
}
