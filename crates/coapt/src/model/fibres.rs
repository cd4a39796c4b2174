//! Which way fibres run: around the valve.

use crate::Vec3;

/// Unit vectors along the annulus where it is nearest to each face (our choice; collagen of both leaflets runs mainly so).
/// `annulus` holds vertices in order around the orifice, or along a part of it. Without two of them: zeros.
pub(super) fn circumferential(rest_mm: &[Vec3], faces: &[[u32; 3]], annulus: &[u32]) -> Vec<Vec3> {
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

#[cfg(test)]
mod tests {
    use super::super::fixtures::{built, skirt};
    use super::circumferential;
    use crate::Vec3;

    /// A skirt of half axes 19 and 14 mm, all rows alike: fibres run as its ellipses do, (−19 sin θ, 14 cos θ). 0.96: the nearest
    /// annulus point is up to half a column of 15° away, and where the ellipse is sharp it turns by twice that.
    #[test]
    fn fibres_run_around_the_valve() {
        let model = built(&skirt()).model;
        let directions = circumferential(&model.rest_mm, &model.faces, &model.annulus);
        for (face, direction) in model.faces.iter().zip(directions) {
            let centre = face.iter().map(|&v| model.rest_mm[v as usize]).sum::<Vec3>() / 3.0;
            let along = Vec3::new(-19.0 / 14.0 * centre.y, 14.0 / 19.0 * centre.x, 0.0).normalize();
            assert!((direction.norm() - 1.0).abs() < 1e-12);
            assert!(direction.dot(&along) > 0.96, "{direction} {along}");
        }
    }
}
