//! What can be compared, and what should not be.

use super::{CompareSettings, ComparedSurface};
use crate::Vec3;
use crate::measure::FARTHEST_MM;
use crate::measure::distance::triangle_area;
use crate::measure::indexed_surface::IndexedSurface;
use crate::scene::{Fault, Readable};

/// All that stands against a comparison.
pub(super) fn check(
    result: &ComparedSurface,
    reference: &ComparedSurface,
    settings: &CompareSettings,
) -> Result<(), Vec<Fault>> {
    let mut faults: Vec<Fault> = [result, reference].into_iter().filter_map(fault_of).collect();
    let thickness_mm = settings.contact_thickness_mm;
    if !(thickness_mm.is_finite() && thickness_mm > 0.0) {
        let message = format!("is {} mm, expected more than 0", Readable(thickness_mm));
        faults.push(Fault::error("contact_thickness_mm", message));
    }
    let has_length = |d: &Vec3| d.iter().all(|x| x.is_finite()) && d.try_normalize(0.0).is_some();
    if let Some(direction) = settings.atrial_direction.filter(|d| !has_length(d)) {
        let [x, y, z] = <[f64; 3]>::from(direction).map(Readable);
        let message = format!("is ({x}, {y}, {z}), expected a vector that is finite and not zero");
        faults.push(Fault::error("atrial_direction", message));
    }
    match faults.is_empty() {
        true => Ok(()),
        false => Err(faults),
    }
}

/// The first thing that is wrong with a surface: what follows would be guesses.
fn fault_of(surface: &ComparedSurface) -> Option<Fault> {
    let error = |message: String| Some(Fault::error(&surface.name, message));
    let count = surface.points_mm.len();
    if surface.faces.is_empty() {
        return error(format!("has no faces, only {count} points; expected a surface"));
    }
    let exists = |face: &[u32; 3]| face.iter().all(|&v| (v as usize) < count);
    if let Some(face) = surface.faces.iter().position(|face| !exists(face)) {
        let corners = surface.faces[face];
        return error(format!(
            "face {face} is {corners:?}, expected points below {count}"
        ));
    }
    let measurable = |p: &Vec3| p.iter().all(|x| x.is_finite() && x.abs() <= FARTHEST_MM);
    if let Some(point) = surface.points_mm.iter().position(|p| !measurable(p)) {
        let [x, y, z] = <[f64; 3]>::from(surface.points_mm[point]).map(Readable);
        return error(format!(
            "point {point} is ({x}, {y}, {z}) mm, expected finite numbers within a kilometre"
        ));
    }
    let marks = [("contact", &surface.contact), ("annulus", &surface.annulus)];
    for (name, values) in marks {
        if let Some(length) = values.as_ref().map(Vec::len).filter(|&length| length != count) {
            return error(format!(
                "{length} values of `{name}`, expected one for each of {count} points"
            ));
        }
    }
    let cells = surface.face_cell.len();
    if cells != 0 && cells != surface.faces.len() {
        let faces = surface.faces.len();
        return error(format!(
            "{cells} cells of faces, expected none or one for each of {faces} faces"
        ));
    }
    let corners = |face: &[u32; 3]| face.map(|v| surface.points_mm[v as usize]);
    let area: f64 = surface
        .faces
        .iter()
        .map(|face| triangle_area(corners(face)))
        .sum();
    if area.is_nan() || area <= 0.0 {
        return error(format!(
            "its {} faces have no area; expected a surface",
            surface.faces.len()
        ));
    }
    None
}

/// A warning if the boxes about both surfaces have nothing in common.
pub(super) fn apart(
    result: &ComparedSurface,
    here: &IndexedSurface,
    reference: &ComparedSurface,
    there: &IndexedSurface,
) -> Option<Fault> {
    let ([low, high], [other_low, other_high]) = (here.bounds_mm(), there.bounds_mm());
    let overlap = (0..3).all(|k| low[k] <= other_high[k] && other_low[k] <= high[k]);
    let text = |p: Vec3| format!("({:.1}, {:.1}, {:.1})", p.x, p.y, p.z);
    (!overlap).then(|| {
        let message = format!(
            "lies within {} to {} mm, `{}` within {} to {}; expected boxes that overlap: are both in one frame \
             (LPS or RAS) and in mm?",
            text(low),
            text(high),
            reference.name,
            text(other_low),
            text(other_high)
        );
        Fault::warning(&result.name, message)
    })
}

/// Whether both surfaces are one mesh in two positions: the same used points make up the same cells in the same order.
/// Cells and not triangles, because a quadrilateral is split along the diagonal that is shorter where it is.
pub(super) fn same_mesh(
    result: &ComparedSurface,
    here: &IndexedSurface,
    reference: &ComparedSurface,
    there: &IndexedSurface,
) -> bool {
    here.used == there.used && cells(result) == cells(reference)
}

/// The points of each cell, ascending.
fn cells(surface: &ComparedSurface) -> Vec<Vec<u32>> {
    let cell = |face: usize| surface.face_cell.get(face).map_or(face as u32, |&cell| cell);
    let numbered: Vec<(u32, [u32; 3])> = (0..).map(cell).zip(surface.faces.iter().copied()).collect();
    let corners = |part: &[(u32, [u32; 3])]| {
        let mut points: Vec<u32> = part.iter().flat_map(|face| face.1).collect();
        points.sort_unstable();
        points.dedup();
        points
    };
    numbered.chunk_by(|a, b| a.0 == b.0).map(corners).collect()
}
