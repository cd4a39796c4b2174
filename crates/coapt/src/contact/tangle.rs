//! Where surfaces cross, or are so near that the solver could not move them.

use super::broad::{Box3, SweepAndPrune};
use super::crossing::crossings;
use super::nearest::{edge_edge, point_triangle};
use super::step_bound::LEAST_GAP_MM;
use super::surface::Surface;
use crate::Vec3;

/// A place where two parts of the surface cross or touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Tangle {
    /// A vertex there, of the one part.
    pub vertex: u32,
    /// The face of the other, as an index into the faces.
    pub face: u32,
}

/// All places where faces that share no vertex cross, or are nearer than steps ever let them come, in ascending order. Faces
/// in one plane, one on the other, are among them, though they do not cross.
pub fn tangles(surface: &Surface, positions_mm: &[Vec3]) -> Vec<Tangle> {
    let crossed = crossings(surface, positions_mm);
    let mut found: Vec<Tangle> = crossed
        .iter()
        .map(|crossing| Tangle {
            vertex: crossing.edge[0],
            face: crossing.face,
        })
        .collect();
    let at = |vertex: u32| positions_mm[vertex as usize];
    let touch = |separation_mm: Vec3| separation_mm.norm() <= LEAST_GAP_MM;
    let point_boxes: Vec<Box3> = surface
        .points
        .iter()
        .map(|&point| Box3::around([at(point)], LEAST_GAP_MM))
        .collect();
    let face_boxes: Vec<Box3> = surface
        .faces
        .iter()
        .map(|face| Box3::around(face.map(at), 0.0))
        .collect();
    let edge_boxes: Vec<Box3> = surface
        .edges
        .iter()
        .map(|edge| Box3::around(edge.map(at), 0.5 * LEAST_GAP_MM))
        .collect();
    let mut sweep = SweepAndPrune::default();
    for &pair in &*sweep.between(&point_boxes, &face_boxes) {
        let [p, a, b, c] = surface.point_and_face(pair);
        if surface.are_apart(surface.faces_of_point(pair))
            && touch(point_triangle(&at(p), &at(a), &at(b), &at(c)).separation_mm)
        {
            found.push(Tangle {
                vertex: p,
                face: pair[1],
            });
        }
    }
    for &pair in &*sweep.among(&edge_boxes) {
        let [a, b, c, d] = surface.ends(pair);
        if surface.are_apart(surface.faces_of_edges(pair))
            && touch(edge_edge(&at(a), &at(b), &at(c), &at(d)).separation_mm)
        {
            found.push(Tangle {
                vertex: a,
                face: surface.edge_face[pair[1] as usize],
            });
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}
