//! A study of speed against error: its results, as tables for people and machines and as a picture.
//!
//! | file | holds |
//! |---|---|
//! | `study.csv` | a line per closure |
//! | `study.json` | the same, with the reference and what the columns mean |
//! | `study.svg` | error against time, with the knee |
//! | `laws.csv`, `laws.json` | of a study of laws: a line per closure; the same with the constants of each law |

mod asked;
mod axis;
mod carry_out;
mod carry_out_laws;
mod front;
mod laws;
mod plot;
mod table;

use std::borrow::Cow;
use std::path::Path;

use coapt::measure::VisibleDistance;
use coapt::relax::Status;
use coapt::scene::Fault;
use serde::{Deserialize, Serialize};

use crate::atomic::{file_fault, write_files};

pub use asked::{FACES_ALLOWED, REPEATS_ALLOWED, Sizes, expect_no_sizes, repeats, thickness_mm, tolerance};
pub use carry_out::{
    Close, FACES, FACES_OF_LAWS, REFERENCE, REFERENCE_FINER, REPEATS, THICKNESSES_MM, TOLERANCES, Tried,
    carry_out, closure_count, median_time,
};
pub use carry_out_laws::{Laws, MeshOfLaws, carry_out_laws};
pub use front::{front, knee, mark};
pub use laws::{
    ERROR_OF_LAWS_MEANS, LAWS_SCHEMA, LawRow, LawStudy, MODEL_ERROR_MEANS, csv as csv_of_laws,
    text as text_of_laws, write_laws,
};
pub use plot::svg;
pub(crate) use table::status_name;
pub use table::{csv, text};

/// The layout of `study.json`.
pub const STUDY_SCHEMA: &str = "coapt-study/1";

/// What `rms_mm` and the other errors are.
pub const ERROR_MEANS: &str = "distance to the reference where the valve is seen from the atrium";

/// What they are where the reference has no finer mesh, as with a scene, which has but its own.
pub const OWN_MESH_ERROR_MEANS: &str = "distance to the same mesh solved tightest where the valve is seen from the atrium: what the mesh costs is not in it";

/// How the knee is found.
pub const KNEE_MEANS: &str = "of the closures that none beats in both time and error, the one farthest below the \
                              straight line from the fastest to the most exact, in decades of time and error";

/// All closures of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// [`STUDY_SCHEMA`].
    pub schema: Cow<'static, str>,
    /// Version of the program.
    pub version: Cow<'static, str>,
    /// [`crate::report::NOTICE`].
    pub notice: Cow<'static, str>,
    /// [`ERROR_MEANS`] or [`OWN_MESH_ERROR_MEANS`].
    pub error: Cow<'static, str>,
    /// [`KNEE_MEANS`].
    pub knee: Cow<'static, str>,
    /// Name of the case.
    pub case: String,
    /// Closures of each setting; times are their medians.
    pub repeats: u16,
    /// What errors are measured against.
    pub reference: Reference,
    /// The closures.
    pub rows: Vec<Row>,
}

impl Study {
    /// Whether what the mesh costs is not in the errors, since the reference has the mesh of every closure.
    pub fn is_without_mesh_error(&self) -> bool {
        self.error == OWN_MESH_ERROR_MEANS
    }
}

/// The closure that errors are measured against.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Triangles.
    pub faces: usize,
    /// Residual asked for [1].
    pub residual_tolerance: f64,
    /// Residual reached [1].
    pub residual: f64,
    /// Contact thickness [mm].
    pub contact_thickness_mm: f64,
}

/// What a closure differs in from the default one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Factor {
    /// Size of the mesh and residual tolerance.
    MeshAndTolerance,
    /// Contact thickness: another valve, strictly, so that it competes for no knee.
    ContactThickness,
}

impl Factor {
    /// As written in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::MeshAndTolerance => "mesh-and-tolerance",
            Self::ContactThickness => "contact-thickness",
        }
    }
}

/// One closure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Why it is in the study.
    pub varied: Factor,
    /// Triangles.
    pub faces: usize,
    /// Residual asked for [1].
    pub residual_tolerance: f64,
    /// Contact thickness [mm].
    pub contact_thickness_mm: f64,
    /// Why the solver stopped.
    pub status: Status,
    /// Whether the result may be used: converged, stable, nothing crosses.
    pub certified: bool,
    /// Residual reached [1].
    pub residual: f64,
    /// Solver iterations.
    pub iterations: usize,
    /// Edges that pass through faces.
    pub crossings: usize,
    /// Wall-clock time of the closure, certificate included, median [ms].
    pub wall_ms: f64,
    /// Distance to the reference; absent where nothing is visible.
    pub error: Option<VisibleDistance>,
    /// Distance, as the error's root mean square, to the closure of the same mesh at the tightest residual tried and
    /// the default thickness [mm]: what is not the mesh's fault.
    pub own_mesh_rms_mm: Option<f64>,
    /// Whether no other closure beats this one in both time and error.
    pub on_front: bool,
    /// Whether it is the knee of the front.
    pub knee: bool,
}

impl Study {
    /// The closure at the knee.
    pub fn knee_row(&self) -> Option<&Row> {
        self.rows.iter().find(|row| row.knee)
    }
}

/// Writes table, object and picture into a folder, which is made if need be; files of the same names are replaced.
///
/// # Errors
/// What the file system says.
pub fn write_study(folder: &Path, study: &Study) -> Result<(), Fault> {
    let json = json(folder, study)?;
    write_files(
        folder,
        &[
            ("study.csv", csv(study)),
            ("study.json", json),
            ("study.svg", svg(study)),
        ],
    )
}

fn json(folder: &Path, study: &impl Serialize) -> Result<String, Fault> {
    let text = serde_json::to_string_pretty(study).map_err(|error| file_fault(folder, &error))?;
    Ok(text + "\n")
}

#[cfg(test)]
mod tests;
