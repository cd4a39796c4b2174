//! The narrowest passage: the smallest surface that parts the atrium from the ventricle, through what the tissue leaves free.
//!
//! Leaflets are as thick as contact makes them, so that what touches is closed; outside the annulus there is a wall. Of all
//! surfaces that span what is left, the smallest is what blood must pass. It needs neither margins nor a way to pair them, and grows
//! evenly with what opens a valve (`VALIDATION.md`). That it is found in cubes of half a millimetre costs 2 to 4 mm², in steps: it has
//! no rate with a parameter.
//!
//! * `voxels`: the space around the valve in cubes, those of tissue walled.
//! * `throat`: whether there is a way through, and where about it is narrowest.
//! * `minimal_cut`: the smallest surface near there.

mod minimal_cut;
mod throat;
mod voxels;

use super::annulus::{annulus_curve, plane_of};
use super::gap::threshold_mm;
use super::surface::surface;
use super::usable_positions;
use crate::Vec3;
use crate::model::Model;
use minimal_cut::minimal_cut_mm2;
use throat::throat;
use voxels::walled;

/// Area of the narrowest passage between atrium and ventricle in the given positions, shape `[vertex]`, between the surfaces of the
/// tissue [mm²]; zero where there is no way through. Nothing where the annulus has no plane, or leaflets do not hang from it all round,
/// so that nothing parts both sides beside them.
///
/// Slits have less of it than of `OrificeMeasures::area_mm2`, which is between middle surfaces, by their
/// length times the thickness. Tissue so thin that it would take more than two million cubes counts as thicker.
pub fn passage_mm2(model: &Model, positions_mm: &[Vec3]) -> Option<f64> {
    let s = &surface(model, usable_positions(model, positions_mm));
    let plane = plane_of(model, s.positions_mm)?;
    let annulus = &model.annulus;
    let is_joined = |i: usize| s.edge(annulus[i], annulus[(i + 1) % annulus.len()]).is_some();
    if !(0..annulus.len()).all(is_joined) {
        return None;
    }
    let leaflets: Vec<[Vec3; 3]> = (0..s.faces.len())
        .map(|face| s.corners(face).map(|p| plane.local(p)))
        .collect();
    let curve = annulus_curve(model, s.positions_mm);
    let curve: Vec<Vec3> = curve.into_iter().map(|p| plane.local(p)).collect();
    narrowest_mm2(&leaflets, &curve, 0.5 * threshold_mm(model, s.mean_edge_mm))
}

/// The same of triangles and an annulus given with z towards the atrium [mm], surfaces so far from their middle [mm].
fn narrowest_mm2(leaflets: &[[Vec3; 3]], annulus: &[Vec3], reach_mm: f64) -> Option<f64> {
    let voxels = walled(leaflets, annulus, reach_mm)?;
    Some(throat(&voxels).map_or(0.0, |sides| minimal_cut_mm2(&voxels, sides)))
}

#[cfg(test)]
mod tests;
