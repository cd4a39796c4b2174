//! Meshes and curves: read from the formats of Slicer, VTK and CAD into one type, written as VTK XML.
//!
//! | file | reads |
//! |---|---|
//! | `.vtk` | VTK legacy 1.0 to 5.1, ASCII and binary: polydata, and grids of vertices, lines, triangles and quads |
//! | `.vtp` | VTK XML polydata: ASCII, inline and appended, raw and base64, plain and zlib, either byte order |
//! | `.ply` `.stl` `.obj` | ASCII and, for the first two, binary |
//! | `.mrk.json` | Slicer markups: curves and points |
//!
//! The content decides, not the extension. Points come out in LPS: a file marked RAS is turned. A wrong file
//! gives all its faults, up to twenty, each with its line, byte or element; what had to be repaired or assumed
//! comes with the result as warnings.
//!
//! The readers are our own. Of the published crates, `vtkio` 0.6 loses the polygons of VTK 5.1 files silently.
//! `stl_io`, `ply-rs-bw` and `tobj` stop at the first fault and mostly without its line, want UTF-8 where
//! Slicer and scanners write names in Latin-1, and `stl_io` and `tobj` read coordinates in single precision.

mod announced;
mod cells;
mod curve;
mod faults;
mod frame;
mod legacy;
mod legacy_arrays;
mod markups;
mod number;
mod obj;
mod payload;
mod ply;
mod polydata;
mod polygon;
mod scanner;
mod sniff;
mod stl;
mod vtp;
mod vtp_document;
mod write;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use coapt::scene::Fault;

pub(crate) use announced::announced_triangles;
pub use curve::{Curve, read_curve};
pub use markups::{MarkupPoints, read_points, write_markups_curve};
pub use polydata::{Array, PolyData};
pub(crate) use write::{check_numbers, stage_pvd, stage_vtp};
pub use write::{write_pvd, write_vtp};

use faults::{Faults, Place, Stop};
use sniff::Format;
pub(crate) use sniff::{looks_binary, mesh_format};

/// Larger files are refused: ten million triangles take less.
const SIZE_LIMIT_BYTES: u64 = 2 << 30;

/// Reads a mesh file; the second part are the warnings.
///
/// A missing frame mark is not among the warnings: `space` is then `None`, and the caller knows whether that
/// matters. Neither are faults of the surface as such (holes, slivers, winding), which only a whole valve shows.
///
/// # Errors
/// All faults found, errors and warnings, if one of them is an error: the file cannot be read, is no mesh, breaks
/// its format, has a coordinate that is not finite, or has neither triangles nor lines.
pub fn read_mesh(path: &Path) -> Result<(PolyData, Vec<Fault>), Vec<Fault>> {
    let mut faults = Faults::new(path.display().to_string());
    let mesh = read_file(path, &mut faults).and_then(|bytes| {
        let extension = path.extension().and_then(|extension| extension.to_str());
        parse_mesh(&bytes, extension, &mut faults)
    });
    faults.finish(mesh)
}

/// The bytes of a regular file of acceptable size.
fn read_file(path: &Path, faults: &mut Faults) -> Result<Vec<u8>, Stop> {
    // Asked before opening: to open a FIFO is to wait for its writer.
    let metadata = std::fs::metadata(path).map_err(|error| faults.fatal(Place::File, error.to_string()))?;
    if !metadata.is_file() {
        let what = if metadata.is_dir() {
            "is a folder, not a file"
        } else {
            "is not a regular file"
        };
        return Err(faults.fatal(Place::File, what));
    }
    let mut bytes = Vec::new();
    // The size may be wrong or change meanwhile, so that the reading itself is bounded.
    let read = File::open(path).and_then(|file| file.take(SIZE_LIMIT_BYTES + 1).read_to_end(&mut bytes));
    match read {
        Err(error) => Err(faults.fatal(Place::File, error.to_string())),
        Ok(0) => Err(faults.fatal(Place::File, "the file is empty")),
        Ok(size) if size as u64 > SIZE_LIMIT_BYTES => Err(faults.fatal(
            Place::File,
            format!("more than {SIZE_LIMIT_BYTES} bytes; coarsen the mesh"),
        )),
        Ok(_) => Ok(bytes),
    }
}

/// The mesh in a file's bytes.
fn parse_mesh(bytes: &[u8], extension: Option<&str>, faults: &mut Faults) -> Result<PolyData, Stop> {
    let bytes = sniff::without_byte_order_mark(bytes, faults)?;
    let format = sniff::format(bytes, extension, faults)?;
    let mut mesh = match format {
        Format::Legacy => legacy::read(bytes, faults)?,
        Format::Vtp => vtp::read(bytes, faults)?,
        Format::Ply => ply::read(bytes, faults)?,
        Format::StlText => stl::read_text(bytes, faults)?,
        Format::StlBinary => stl::read_binary(bytes, faults)?,
        Format::Obj => obj::read(bytes, faults)?,
        Format::Json => {
            return Err(faults.fatal(
                Place::File,
                "is JSON, not a mesh; Slicer markups hold curves and points only",
            ));
        }
    };
    if faults.error_count() > 0 {
        return Err(Stop);
    }
    check(&mut mesh, faults)?;
    Ok(mesh)
}

/// What all formats have in common: finite points, something to use, arrays that fit, LPS.
fn check(mesh: &mut PolyData, faults: &mut Faults) -> Result<(), Stop> {
    for (number, point) in mesh.points.iter().enumerate() {
        if let Some(value) = point.iter().find(|value| !value.is_finite()) {
            faults.error(Place::Element("point", number), format!("not finite ({value})"))?;
        }
    }
    if mesh.points.is_empty() {
        return Err(faults.fatal(Place::File, "no points"));
    }
    if mesh.triangles.is_empty() && mesh.lines.is_empty() {
        let message = format!("no triangles and no lines, only {} points", mesh.points.len());
        return Err(faults.fatal(Place::File, message));
    }
    check_array_sizes(mesh, faults)?;
    for array in mesh.point_arrays.iter().chain(&mesh.cell_arrays) {
        if let Some(first) = array.values.iter().position(|value| !value.is_finite()) {
            let tuple = first / array.components.max(1);
            let count = array.values.iter().filter(|value| !value.is_finite()).count();
            let message = format!(
                "array `{}`: {count} values are not finite, the first at {tuple}",
                array.name
            );
            faults.warning(Place::File, message);
        }
    }
    Ok(())
}

/// A file may give its points or its cells a second time, after their arrays.
fn check_array_sizes(mesh: &PolyData, faults: &mut Faults) -> Result<(), Stop> {
    let points = mesh.points.len();
    for array in mesh
        .point_arrays
        .iter()
        .filter(|array| array.tuple_count() != points)
    {
        let message = format!(
            "array `{}` is for {} points, but there are {points}",
            array.name,
            array.tuple_count()
        );
        faults.error(Place::File, message)?;
    }
    let triangles = (0..mesh.triangles.len()).map(|triangle| mesh.triangle_cell(triangle));
    let lines = (0..mesh.lines.len()).map(|line| mesh.line_cell(line));
    let cells = triangles.chain(lines).max().map_or(0, |last| last + 1);
    for array in mesh
        .cell_arrays
        .iter()
        .filter(|array| array.tuple_count() < cells)
    {
        let message = format!(
            "array `{}` is for {} cells, but there are {cells}",
            array.name,
            array.tuple_count()
        );
        faults.error(Place::File, message)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
