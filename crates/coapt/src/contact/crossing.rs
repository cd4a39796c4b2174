//! The exact test whether mid-surfaces cross.

use super::broad::{Box3, SweepAndPrune, keep};
use super::surface::Surface;
use crate::Vec3;
use robust::{Coord3D, orient3d};

/// An edge that passes through a face with which it shares no vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Crossing {
    /// The edge.
    pub edge: [u32; 2],
    /// The face, as an index into the faces.
    pub face: u32,
}

/// All crossings, in ascending order. Two triangles cross if and only if an edge of one passes through the
/// other, so an empty list means that no two faces cross. A touch counts as a crossing; but faces that lie in one plane, one
/// on the other, do not pass through each other, and are not told of.
pub fn crossings(surface: &Surface, positions_mm: &[Vec3]) -> Vec<Crossing> {
    let at = |vertex: u32| positions_mm[vertex as usize];
    let Surface { faces, edges, .. } = surface;
    let edge_boxes: Vec<Box3> = edges.iter().map(|edge| Box3::around(edge.map(at), 0.0)).collect();
    let face_boxes: Vec<Box3> = faces.iter().map(|face| Box3::around(face.map(at), 0.0)).collect();
    let mut sweep = SweepAndPrune::default();
    let are_apart = |[edge, face]: [u32; 2]| {
        let [p, q] = edges[edge as usize];
        let face = &faces[face as usize];
        !face.contains(&p) && !face.contains(&q)
    };
    let near = sweep.between(
        [&edge_boxes, &face_boxes],
        [&surface.edge_patches, &surface.face_patches],
    );
    keep(near, are_apart);
    let mut found: Vec<Crossing> = near
        .iter()
        .map(|&[edge, face]| Crossing {
            edge: edges[edge as usize],
            face,
        })
        .filter(|&Crossing { edge, face }| edge_meets_face(edge, faces[face as usize], positions_mm))
        .collect();
    found.sort_unstable();
    found
}

/// Whether a segment meets a triangle, decided by the exact signs of tetrahedron volumes.
///
/// A segment in the triangle's plane does not, and so neither does any with a triangle without area: if faces cross there,
/// their other edges tell.
fn edge_meets_face(edge: [u32; 2], face: [u32; 3], positions_mm: &[Vec3]) -> bool {
    let corners = [edge[0], edge[1], face[0], face[1], face[2]].map(|vertex| positions_mm[vertex as usize]);
    let Some([p, q, a, b, c]) = at_sizes_of_which_volumes_are_numbers(corners) else {
        return false;
    };
    let (above, below) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    let one_side = (above > 0.0 && below > 0.0) || (above < 0.0 && below < 0.0);
    if one_side || (above == 0.0 && below == 0.0) {
        return false;
    }
    let turns = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
}

/// Binary exponent of the largest coordinate at which volumes are worked out: its cube is a number with some room above, and
/// of products that are smaller by 2⁻⁶⁰⁰ of their coordinates each no bit is lost below.
const EXPONENT: f64 = 300.0;

/// The points times a power of two, which rounds nothing and leaves the signs of volumes alone; none if any is not finite:
/// what is not a number is nowhere, and the exact signs would take forever to find that out.
fn at_sizes_of_which_volumes_are_numbers(points: [Vec3; 5]) -> Option<[Coord3D<f64>; 5]> {
    let coordinates = points.iter().flatten();
    if coordinates.clone().any(|coordinate| !coordinate.is_finite()) {
        return None;
    }
    let size = coordinates.fold(0.0_f64, |size, coordinate| size.max(coordinate.abs()));
    let power = (EXPONENT - size.log2().floor()).clamp(-1000.0, 1000.0);
    let scale = 2_f64.powi(power as i32);
    Some(points.map(|point| Coord3D {
        x: point.x * scale,
        y: point.y * scale,
        z: point.z * scale,
    }))
}
