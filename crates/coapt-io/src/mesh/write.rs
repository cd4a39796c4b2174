//! Writes meshes as VTK XML (.vtp), and the list of them (.pvd) that `ParaView` plays as an animation.
//!
//! Arrays are appended raw behind 64-bit sizes: exact, fast, read by every VTK since 5.10. The same mesh gives
//! the same bytes.

use std::fmt::Write;
use std::path::Path;

use coapt::scene::Fault;
use quick_xml::escape::escape;

use super::{Array, PolyData};
use crate::atomic::{Batch, file_fault};

/// Writes a mesh, marked `SPACE=LPS` as Slicer does. Each segment and each triangle becomes a cell with the
/// values of the cell it is a part of.
///
/// # Errors
/// A number that is not finite, a point that does not exist, an array of the wrong size, or what the file system
/// says. The old file is then untouched.
pub fn write_vtp(path: &Path, mesh: &PolyData) -> Result<(), Fault> {
    let mut batch = Batch::default();
    stage_vtp(&mut batch, path, mesh)?;
    batch.finish()
}

/// The same as part of a batch.
pub(crate) fn stage_vtp(batch: &mut Batch, path: &Path, mesh: &PolyData) -> Result<(), Fault> {
    let bytes = vtp_bytes(mesh).map_err(|message| file_fault(path, &message))?;
    batch.write(path, &bytes)
}

/// Writes the list of mesh files and their times [s]; files are named relative to the list.
///
/// # Errors
/// A time that is not finite, or what the file system says.
pub fn write_pvd(path: &Path, frames: &[(f64, String)]) -> Result<(), Fault> {
    let mut batch = Batch::default();
    stage_pvd(&mut batch, path, frames)?;
    batch.finish()
}

/// The same as part of a batch.
pub(crate) fn stage_pvd(batch: &mut Batch, path: &Path, frames: &[(f64, String)]) -> Result<(), Fault> {
    let fault = |message: String| Fault::error(path.display().to_string(), message);
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  \
         <Collection>\n",
    );
    for (time, file) in frames {
        if !time.is_finite() {
            return Err(fault(format!("the time of `{file}` is not finite")));
        }
        let file = escape(file.as_str());
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "    <DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{file}\"/>"
        );
    }
    text.push_str("  </Collection>\n</VTKFile>\n");
    batch.write(path, text.as_bytes())
}

/// The XML and the data that are appended to it.
#[derive(Debug, Default)]
struct Draft {
    xml: String,
    data: Vec<u8>,
}

impl Draft {
    fn line(&mut self, text: &str) {
        self.xml.push_str(text);
        self.xml.push('\n');
    }

    fn array(&mut self, attributes: &str, bytes: &[u8]) {
        let _ = writeln!(
            self.xml,
            "<DataArray {attributes} format=\"appended\" offset=\"{}\"/>",
            self.data.len()
        );
        self.data.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.data.extend_from_slice(bytes);
    }

    fn floats(&mut self, array: &Array) {
        let name = escape(array.name.as_str());
        let attributes = format!(
            "type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{}\"",
            array.components
        );
        let bytes: Vec<u8> = array
            .values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        self.array(&attributes, &bytes);
    }

    fn cells<const N: usize>(&mut self, section: &str, cells: &[[u32; N]]) {
        let connectivity: Vec<u8> = cells
            .iter()
            .flatten()
            .flat_map(|&point| i64::from(point).to_le_bytes())
            .collect();
        let offsets: Vec<u8> = (1..=cells.len())
            .flat_map(|end| ((N * end) as i64).to_le_bytes())
            .collect();
        self.line(&format!("<{section}>"));
        self.array("type=\"Int64\" Name=\"connectivity\"", &connectivity);
        self.array("type=\"Int64\" Name=\"offsets\"", &offsets);
        self.line(&format!("</{section}>"));
    }
}

fn vtp_bytes(mesh: &PolyData) -> Result<Vec<u8>, String> {
    check_numbers(mesh)?;
    let cell_arrays = arrays_of_parts(mesh)?;
    let mut draft = Draft::default();
    draft.line("<?xml version=\"1.0\"?>");
    draft.line(
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">",
    );
    draft.line("<PolyData>\n<FieldData>");
    // The letters L, P, S and a closing zero; a text array is the mark that Slicer looks for.
    draft.line(
        "<Array type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">76 80 83 0</Array>",
    );
    draft.line("</FieldData>");
    draft.line(&format!(
        "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" \
         NumberOfPolys=\"{}\">",
        mesh.points.len(),
        mesh.lines.len(),
        mesh.triangles.len()
    ));
    draft.line("<PointData>");
    mesh.point_arrays.iter().for_each(|array| draft.floats(array));
    draft.line("</PointData>\n<CellData>");
    cell_arrays.iter().for_each(|array| draft.floats(array));
    draft.line("</CellData>\n<Points>");
    let values = mesh.points.concat();
    draft.floats(&Array {
        name: "Points".to_owned(),
        components: 3,
        values,
    });
    draft.line("</Points>");
    draft.cells("Lines", &mesh.lines);
    draft.cells("Polys", &mesh.triangles);
    draft.line("</Piece>\n</PolyData>");
    let mut bytes = draft.xml.into_bytes();
    bytes.extend_from_slice(b"<AppendedData encoding=\"raw\">\n_");
    bytes.extend_from_slice(&draft.data);
    bytes.extend_from_slice(b"\n</AppendedData>\n</VTKFile>\n");
    Ok(bytes)
}

/// Refuses what no reader could use: numbers that are not finite, points that do not exist, arrays of the wrong size.
pub(crate) fn check_numbers(mesh: &PolyData) -> Result<(), String> {
    let count = mesh.points.len();
    if let Some(number) = mesh
        .points
        .iter()
        .position(|point| !point.iter().all(|value| value.is_finite()))
    {
        return Err(format!("point {number} is not finite"));
    }
    let exists = |points: &[u32]| points.iter().all(|&point| (point as usize) < count);
    if let Some(number) = mesh.triangles.iter().position(|triangle| !exists(triangle)) {
        return Err(format!(
            "triangle {number} has a point that does not exist: there are {count}"
        ));
    }
    if let Some(number) = mesh.lines.iter().position(|line| !exists(line)) {
        return Err(format!(
            "segment {number} has a point that does not exist: there are {count}"
        ));
    }
    for array in &mesh.point_arrays {
        if array.components == 0 || Some(array.values.len()) != count.checked_mul(array.components) {
            let Array {
                name,
                components,
                values,
            } = array;
            return Err(format!(
                "point array `{name}`: {} values, not {components} for {count} points",
                values.len()
            ));
        }
    }
    for array in mesh.point_arrays.iter().chain(&mesh.cell_arrays) {
        if let Some(at) = array.values.iter().position(|value| !value.is_finite()) {
            let tuple = at / array.components.max(1);
            return Err(format!("array `{}` is not finite at {tuple}", array.name));
        }
    }
    Ok(())
}

/// The cell arrays for the cells that are written: segments, then triangles.
fn arrays_of_parts(mesh: &PolyData) -> Result<Vec<Array>, String> {
    let lines = (0..mesh.lines.len()).map(|line| mesh.line_cell(line));
    let triangles = (0..mesh.triangles.len()).map(|triangle| mesh.triangle_cell(triangle));
    let cells: Vec<usize> = lines.chain(triangles).collect();
    let of_parts = |array: &Array| {
        let Array { name, components, .. } = array;
        let mut values = Vec::with_capacity(cells.len() * components);
        for &cell in &cells {
            let tuple = array.tuple(cell).filter(|tuple| !tuple.is_empty());
            values.extend_from_slice(
                tuple.ok_or_else(|| format!("cell array `{name}` has no value for cell {cell}"))?,
            );
        }
        Ok(Array {
            name: name.clone(),
            components: *components,
            values,
        })
    };
    mesh.cell_arrays.iter().map(of_parts).collect()
}
