//! Which way fibres run: around the valve.

use crate::Vec3;
use crate::model::Model;

/// The circumferential direction at each face of a model [1], shape `[face]`; see `circumferential`.
pub fn directions(model: &Model) -> Vec<Vec3> {
    circumferential(&model.rest_mm, &model.faces, &model.annulus)
}

/// Unit vectors along the annulus where it is nearest to each face (our choice; collagen of both leaflets runs mainly so).
/// `annulus` holds vertices in order around the orifice, or along a part of it. Without two of them: zeros.
pub(crate) fn circumferential(rest_mm: &[Vec3], faces: &[[u32; 3]], annulus: &[u32]) -> Vec<Vec3> {
    let places: Vec<Vec3> = annulus.iter().map(|&vertex| rest_mm[vertex as usize]).collect();
    let count = places.len();
    if count < 2 {
        return vec![Vec3::zeros(); faces.len()];
    }
    let tangents: Vec<Vec3> = (0..count)
        .map(|at| places[(at + 1) % count] - places[(at + count - 1) % count])
        .map(|chord| chord.try_normalize(0.0).unwrap_or_default())
        .collect();
    let at_face = |face: &[u32; 3]| {
        let centre = face.iter().map(|&vertex| rest_mm[vertex as usize]).sum::<Vec3>() / 3.0;
        let distance_squared = |at: &usize| (places[*at] - centre).norm_squared();
        let nearest = (0..count).min_by(|a, b| distance_squared(a).total_cmp(&distance_squared(b)));
        nearest.map_or_else(Vec3::zeros, |at| tangents[at])
    };
    faces.iter().map(at_face).collect()
}
