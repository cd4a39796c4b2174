//! `coapt check`: reads and validates a scene, lists every fault.

use std::path::PathBuf;

use clap::Args;
use coapt::model::mesh_quality::SpringQuality;
use coapt::model::{Model, mesh_quality};
use coapt::scene::{Fault, Severity};
use coapt_io::escape::escaped;
use serde_json::json;

use crate::case::{self, SizeLimit};
use crate::closure::Format;
use crate::output::{Failure, Verdict, fault_line, print};

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
    let (model, faults) =
        match case::open(Some(&arguments.scene), arguments.limit).and_then(|case| case::build(&case)) {
            Ok(built) => (Some(built.model), built.warnings),
            Err(faults) => (None, faults),
        };
    let count = |severity| faults.iter().filter(|fault| fault.severity == severity).count();
    let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
    let size = model.as_ref().map(|model| {
        (
            model.rest_mm.len(),
            model.faces.len(),
            model.chords.ends.len(),
            model.name.clone(),
        )
    });
    let springs = model.as_ref().map(springs).unwrap_or_default();
    print(&match arguments.format {
        Format::Text => {
            let mut text: String = faults.iter().map(|fault| fault_line(fault) + "\n").collect();
            if let Some((vertices, faces, chords, name)) = size {
                text += &format!(
                    "{}: {faces} triangles, {vertices} vertices, {chords} chord segments\n",
                    escaped(&name)
                );
            }
            for (leaflet, quality) in &springs {
                text += &format!(
                    "{}: springs are {:.1} % too soft for their mesh, {:.0} % off in the strain they render worst\n",
                    escaped(leaflet),
                    100.0 * quality.softening,
                    100.0 * quality.stiffness_error
                );
            }
            let judged = if errors == 0 {
                "ready to be closed"
            } else {
                "cannot be closed"
            };
            text += &format!(
                "{}: {judged}: {}, {}\n",
                escaped(&arguments.scene.display().to_string()),
                counted(errors, "error"),
                counted(warnings, "warning")
            );
            text
        }
        Format::Json => {
            let list: Vec<_> = faults.iter().map(entry).collect();
            let mesh = size.map(|(vertices, faces, chords, _)| {
                json!({"vertices": vertices, "faces": faces, "chords": chords})
            });
            let whole = json!({
                "schema": "coapt-check/1", "scene": arguments.scene.display().to_string(),
                "errors": errors, "warnings": warnings, "mesh": mesh, "faults": list,
                "springs": springs.iter().map(|(leaflet, quality)| json!({
                    "leaflet": leaflet, "softening": quality.softening, "stiffness_error": quality.stiffness_error,
                    "worst_error": quality.worst_error, "worst_vertex": quality.worst_vertex,
                })).collect::<Vec<_>>(),
            });
            format!("{whole:#}\n")
        }
    })?;
    match errors {
        0 => Ok(Verdict::Done),
        // Everything is said already.
        _ => Err(Failure::Input(Vec::new())),
    }
}

fn counted(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

fn entry(fault: &Fault) -> serde_json::Value {
    let severity = match fault.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    json!({"severity": severity, "place": fault.place, "message": fault.message})
}

/// How well the mesh of each leaflet made of springs renders the sheet that they stand for, by its name.
fn springs(model: &Model) -> Vec<(String, SpringQuality)> {
    let named = |quality: SpringQuality| (model.leaflets[quality.leaflet as usize].name.clone(), quality);
    mesh_quality::of_model(model).into_iter().map(named).collect()
}
