//! Which way the atrium is.

use super::annulus::{Found, positions};
use super::faults::Faults;
use super::surface::Surface;
use crate::Vec3;
use crate::mesh::polyline;
use crate::mesh::topology::Chain;

/// Turns all faces so that normals point to the atrium: away from the papillary tips, or, without any, away from
/// the free margin. With normals to the atrium the annulus runs counter-clockwise seen from there.
pub(crate) fn face_atrium(
    surface: &mut Surface,
    found: &mut Found,
    loops: &mut [Chain],
    tips: &[Vec3],
    faults: &mut Faults,
) {
    let ring = positions(surface, &found.ring);
    let area = polyline::vector_area(&ring);
    let centre = polyline::centroid(&ring, true);
    let mut on_ring = vec![false; surface.points.len()];
    found.ring.iter().for_each(|&v| on_ring[v as usize] = true);
    let others: Vec<u32> = (0..surface.points.len() as u32)
        .filter(|&v| !on_ring[v as usize])
        .collect();
    let leaflets = positions(surface, &others);
    let below = if tips.is_empty() { &leaflets[..] } else { tips };
    let mean = |points: &[Vec3]| points.iter().sum::<Vec3>() / points.len().max(1) as f64;
    let up = centre - mean(below);
    let size = area.norm().sqrt();
    let normal = area / size.max(f64::MIN_POSITIVE).powi(2);
    let rise = normal.dot(&up);
    // A fiftieth of the annulus' size, half a millimetre, is what tells up from down (our choice).
    if below.is_empty() || !rise.is_finite() || rise.abs() <= 0.02 * size {
        let message = "cannot tell the atrial from the ventricular side: the leaflets lie in the annulus plane and \
                       no papillary tip lies off it; give papillary tips";
        return faults.error("leaflets", message);
    }
    let hang = (mean(&leaflets) - centre).dot(&normal) * rise.signum();
    if !tips.is_empty() && !leaflets.is_empty() && hang > 0.02 * size {
        let message = "the tips and the leaflets lie on opposite sides of the annulus; check axes (LPS/RAS?)";
        faults.warning("papillary", message);
    }
    if rise < 0.0 {
        faults.warning(
            "leaflets",
            "all triangles faced the ventricle and are turned to face the atrium",
        );
        surface.faces.iter_mut().for_each(|face| face.swap(1, 2));
        found.ring.reverse();
        found.annulus.vertices.reverse();
        loops.iter_mut().for_each(|chain| chain.vertices.reverse());
    }
}

#[cfg(test)]
mod tests {
    use super::super::annulus::tests::{mark, patch};
    use super::super::fixtures::{built, faults, mesh, skirt, told};
    use super::*;

    #[test]
    fn everything_upside_down_is_turned() {
        let mut scene = skirt();
        let upright = built(&scene).model;
        for leaflet in 0..2 {
            mesh(&mut scene, leaflet)
                .faces
                .iter_mut()
                .for_each(|face| face.swap(1, 2));
        }
        let turned = built(&scene);
        assert!(told(&turned.warnings, "leaflets", "faced the ventricle"));
        assert_eq!(turned.model.springs, upright.springs);
        let ring: Vec<Vec3> = turned
            .model
            .annulus
            .iter()
            .map(|&v| turned.model.rest_mm[v as usize])
            .collect();
        assert!(polyline::vector_area(&ring).z > 0.0);
        assert_eq!(
            turned.model.annulus[turned.model.landmarks.mid_anterior],
            upright.annulus[upright.landmarks.mid_anterior]
        );
    }

    #[test]
    fn leaflets_and_tips_on_opposite_sides_are_doubted() {
        let mut scene = skirt();
        // Unmarked, the other end of the funnel would be annulus, being farther from the tips.
        mark(&mut scene);
        scene.chordae.clear();
        scene
            .papillary
            .iter_mut()
            .for_each(|muscle| muscle.tips_mm[0][2] = 20.0);
        assert!(told(&built(&scene).warnings, "papillary", "LPS/RAS"));
    }

    #[test]
    fn a_flat_patch_needs_tips_to_tell_its_sides() {
        let mut scene = patch(5);
        assert!(
            built(&scene)
                .warnings
                .iter()
                .any(|w| w.message.contains("no free margin"))
        );
        scene.papillary.clear();
        assert!(told(&faults(&scene), "leaflets", "cannot tell the atrial"));
    }
}
