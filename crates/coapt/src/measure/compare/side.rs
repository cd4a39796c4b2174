//! On which side of a surface a point is.

use super::indexed::{Foot, IndexedSurface};
use crate::Vec3;
use crate::measure::plane::vector_area;
use crate::mesh::topology::{edges, orient};

/// The distance of each place to its foot, negative on the ventricular side of the surface; none where its faces do not
/// wind alike, so that they have no sides. Without a direction to the atrium they are taken to look there.
///
/// The side is that of the normal of the face; where the foot lies on a side or a corner of it, that of the sum of the
/// normals about it, weighed by their angle there: with any other weight a point before the surface can seem to be
/// behind (Bærentzen & Aanæs 2005). Beyond a rim the surface is taken to go on.
pub(super) fn signed(
    surface: &IndexedSurface,
    to_atrium: Option<Vec3>,
    places: &[Vec3],
    feet: &[Foot],
) -> Option<Vec<f64>> {
    let mut faces = surface.faces.to_vec();
    let edges = edges(surface.faces);
    if !orient(&mut faces, &edges).is_ok_and(|turned| turned.is_empty()) {
        return None;
    }
    let normals: Vec<Vec3> = (0..faces.len()).map(|f| unit_normal(surface, f)).collect();
    let at_points = point_normals(surface, &normals);
    let across = |a: u32, b: u32| -> Vec3 {
        let edge = edges.ends.binary_search(&[a.min(b), a.max(b)]);
        edge.map_or(Vec3::zeros(), |e| {
            edges.faces_of(e).iter().map(|&f| normals[f as usize]).sum()
        })
    };
    let normal = |foot: &Foot| {
        let face = surface.faces[foot.face];
        let on: Vec<u32> = (0..3)
            .filter(|&k| foot.weights[k] != 0.0)
            .map(|k| face[k])
            .collect();
        match on[..] {
            [v] => at_points[v as usize],
            [a, b] => across(a, b),
            _ => normals[foot.face],
        }
    };
    let turned = to_atrium.is_some_and(|direction| surface.looks_mm2().dot(&direction) < 0.0);
    let one = |(&place, foot): (&Vec3, &Foot)| {
        let height = (place - foot.place).dot(&normal(foot));
        if if turned { height <= 0.0 } else { height >= 0.0 } {
            foot.distance_mm
        } else {
            -foot.distance_mm
        }
    };
    Some(places.iter().zip(feet).map(one).collect())
}

/// Zero for a face without area, which has no side.
fn unit_normal(surface: &IndexedSurface, face: usize) -> Vec3 {
    vector_area(&surface.corners(face))
        .try_normalize(0.0)
        .unwrap_or_default()
}

fn point_normals(surface: &IndexedSurface, normals: &[Vec3]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::zeros(); surface.points_mm.len()];
    for (f, face) in surface.faces.iter().enumerate() {
        let corners = surface.corners(f);
        for k in 0..3 {
            let [here, next, last] = [0, 1, 2].map(|step| corners[(k + step) % 3]);
            sums[face[k] as usize] += normals[f] * (next - here).angle(&(last - here));
        }
    }
    sums
}
