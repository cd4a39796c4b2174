//! A comparison of two surfaces: read from files, told as a table and as an object, drawn as a map of the error.
//!
//! | file | holds |
//! |---|---|
//! | `comparison.json` | the report |
//! | `error.vtp` | the result; points `distance_mm`, `aligned_distance_mm`, and where known `signed_distance_mm`, `visible`, `contact` |

mod read;
#[cfg(test)]
mod tests;
mod text;

use std::borrow::Cow;
use std::path::Path;

use coapt::measure::compare::{CompareSettings, Comparison, ErrorMap, compare};
use coapt::scene::{Fault, Space};
use serde::{Deserialize, Serialize};

use crate::atomic::{Batch, make_folder};
use crate::mesh::{Array, PolyData, stage_vtp};
use crate::report::NOTICE;
use crate::scene::sentence;

pub use read::{ReadSurface, read_surface};
pub use text::text;

/// The layout of `comparison.json`.
pub const COMPARISON_SCHEMA: &str = "coapt-comparison/1";

/// A comparison and what it is of. Units are in the names; see [`Comparison`] for the definitions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ComparisonReport {
    /// [`COMPARISON_SCHEMA`].
    pub schema: Cow<'static, str>,
    /// Version of the program.
    pub version: Cow<'static, str>,
    /// [`NOTICE`].
    pub notice: Cow<'static, str>,
    /// Where the result was read from.
    pub result_file: FileOf,
    /// Where the reference was read from.
    pub reference_file: FileOf,
    /// The point array that tells contact.
    pub contact_array: String,
    /// Distance of mid-surfaces in contact that tells slits from gaps [mm].
    pub contact_thickness_mm: f64,
    /// The distances.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// What had to be repaired or assumed, and what may make the figures mean less than they seem to.
    pub warnings: Vec<String>,
}

/// A file and the frame that it was in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FileOf {
    /// As given, with the file in a folder.
    pub path: String,
    /// The frame that the file was marked with; none: no mark, taken as LPS.
    pub space: Option<Space>,
}

impl ComparisonReport {
    /// Compares two surfaces that were read; `contact_array` and `warnings` are those of reading.
    ///
    /// # Errors
    /// As of [`compare`].
    pub fn new(
        result: &ReadSurface,
        reference: &ReadSurface,
        settings: &CompareSettings,
        contact_array: &str,
        mut warnings: Vec<Fault>,
    ) -> Result<Self, Vec<Fault>> {
        let comparison = compare(&result.surface, &reference.surface, settings)?;
        warnings.extend(comparison.warnings.iter().cloned());
        let file_of = |read: &ReadSurface| FileOf {
            path: read.surface.name.clone(),
            space: read.mesh.space,
        };
        Ok(Self {
            schema: COMPARISON_SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            notice: NOTICE.into(),
            result_file: file_of(result),
            reference_file: file_of(reference),
            contact_array: contact_array.to_owned(),
            contact_thickness_mm: settings.contact_thickness_mm,
            comparison,
            warnings: warnings.iter().map(sentence).collect(),
        })
    }

    /// As one JSON object, indented, with a line break at its end.
    ///
    /// # Errors
    /// None that the types allow.
    pub fn json(&self) -> Result<String, Fault> {
        let text = serde_json::to_string_pretty(self);
        text.map(|text| text + "\n")
            .map_err(|error| Fault::error("comparison", error.to_string()))
    }
}

/// Writes the report and the error map, on the mesh of the result, into a folder, which is made if need be; files of the same names are replaced.
/// The same surfaces give the same bytes.
///
/// # Errors
/// What the file system says.
pub fn write_comparison(folder: &Path, result: &PolyData, report: &ComparisonReport) -> Result<(), Fault> {
    make_folder(folder)?;
    let mut batch = Batch::default();
    batch.write(&folder.join("comparison.json"), report.json()?.as_bytes())?;
    stage_vtp(
        &mut batch,
        &folder.join("error.vtp"),
        &error_map(result, &report.comparison.map),
    )?;
    batch.finish_listed(folder)
}

/// The surface of the result with the error at each of its points.
fn error_map(mesh: &PolyData, map: &ErrorMap) -> PolyData {
    let array = |name: &str, values: Vec<f64>| Array {
        name: name.into(),
        components: 1,
        values,
    };
    let marks = |name: &str, marks: &Option<Vec<bool>>| {
        let marks = marks.as_ref()?;
        Some(array(name, marks.iter().map(|&mark| f64::from(mark)).collect()))
    };
    let arrays = [
        Some(array("distance_mm", map.distance_mm.clone())),
        Some(array("aligned_distance_mm", map.aligned_distance_mm.clone())),
        (map.signed_distance_mm.clone()).map(|values| array("signed_distance_mm", values)),
        marks("visible", &map.visible),
        marks("contact", &map.contact),
    ];
    PolyData {
        points: mesh.points.clone(),
        triangles: mesh.triangles.clone(),
        point_arrays: arrays.into_iter().flatten().collect(),
        ..PolyData::default()
    }
}
