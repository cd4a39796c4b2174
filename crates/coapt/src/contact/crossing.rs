//! The exact test whether mid-surfaces cross.

use super::broad::SweepAndPrune;
use super::surface::{Surface, sides};
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
/// other, so an empty list means that no two faces cross. A touch counts as a crossing.
pub fn crossings(surface: &Surface, positions_mm: &[Vec3]) -> Vec<Crossing> {
    let mut found = Vec::new();
    let faces = &surface.faces;
    SweepAndPrune::default().overlapping_faces(faces, positions_mm, 0.0, |f, g| {
        for (face, other) in [(f, g), (g, f)] {
            for edge in sides(&faces[other as usize]) {
                if !edge.iter().any(|vertex| faces[face as usize].contains(vertex))
                    && edge_meets_face(edge, faces[face as usize], positions_mm)
                {
                    found.push(Crossing { edge, face });
                }
            }
        }
    });
    found.sort_unstable();
    found.dedup();
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
    let (above, below) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    let one_side = (above > 0.0 && below > 0.0) || (above < 0.0 && below < 0.0);
    if one_side || (above == 0.0 && below == 0.0) {
        // An edge in the face's plane: if the faces cross, their other edges tell.
        return false;
    }
    let turns = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
}
