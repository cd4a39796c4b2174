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
    let near = sweep.between(&edge_boxes, &face_boxes);
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
fn edge_meets_face(edge: [u32; 2], face: [u32; 3], positions_mm: &[Vec3]) -> bool {
    let at = |vertex: u32| {
        let point = positions_mm[vertex as usize];
        Coord3D {
            x: point.x,
            y: point.y,
            z: point.z,
        }
    };
    let [p, q] = edge.map(at);
    let [a, b, c] = face.map(at);
    // What is not a number is nowhere; the exact signs would take forever to find that out.
    if [p, q, a, b, c]
        .iter()
        .any(|point| !(point.x + point.y + point.z).is_finite())
    {
        return false;
    }
    let (above, below) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    let one_side = (above > 0.0 && below > 0.0) || (above < 0.0 && below < 0.0);
    if one_side || (above == 0.0 && below == 0.0) {
        // An edge in the face's plane: if the faces cross, their other edges tell.
        return false;
    }
    let turns = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
}
