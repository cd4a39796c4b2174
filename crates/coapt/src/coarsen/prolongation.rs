//! From coarse positions to fine ones.

use crate::{Mat3, Vec3};

/// Where each fine vertex lies on the coarse mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Prolongation {
    /// The coarse face below each fine vertex, as coarse vertices; three times the same one where the vertex was
    /// kept. Shape `[fine vertex]`.
    pub corners: Vec<[u32; 3]>,
    /// Weights of the three in the open valve [1]; they sum to 1. A vertex beyond a border has a negative one.
    /// Shape `[fine vertex]`.
    pub weights: Vec<[f64; 3]>,
    /// Faces of the coarse mesh, shape `[coarse face]`.
    pub faces: Vec<[u32; 3]>,
}

impl Prolongation {
    /// Fine positions [mm], shape `[fine vertex]`, for coarse positions [mm]: exact for rigid motions
    /// everywhere, for linear ones of a plane sheet within its plane, and at kept vertices always.
    ///
    /// A fine vertex keeps its place on its coarse face, and what it lies off the face turns as the mesh does
    /// there. Bulging the faces to a smooth surface lies nearer the fine equilibrium by a few per cent, but
    /// leaflets in contact then cross; flat faces that do not cross rarely make fine ones that do. Nothing
    /// ensures it, though. Prescribed fine vertices are interpolated as all others.
    pub fn prolong(&self, coarse_rest_mm: &[Vec3], coarse_mm: &[Vec3], fine_rest_mm: &[Vec3]) -> Vec<Vec3> {
        let turns = vertex_turns(&self.faces, coarse_rest_mm, coarse_mm);
        let places = self.corners.iter().zip(&self.weights).zip(fine_rest_mm);
        let move_one = |((corners, weights), rest): ((&[u32; 3], &[f64; 3]), &Vec3)| {
            let off = rest - mix(weights, corners.map(|v| coarse_rest_mm[v as usize]));
            let turned = corners.map(|v| turns[v as usize] * off);
            mix(weights, corners.map(|v| coarse_mm[v as usize])) + mix(weights, turned)
        };
        places.map(move_one).collect()
    }
}

fn mix(weights: &[f64; 3], vectors: [Vec3; 3]) -> Vec3 {
    vectors[0] * weights[0] + vectors[1] * weights[1] + vectors[2] * weights[2]
}

/// How the mesh has turned around each vertex: the mean of the rotations of its faces, weighted by their areas.
/// Where faces turn apart the mean shortens what it turns, and never fails. Zero for a vertex without faces.
fn vertex_turns(faces: &[[u32; 3]], rest_mm: &[Vec3], moved_mm: &[Vec3]) -> Vec<Mat3> {
    let mut turns = vec![Mat3::zeros(); rest_mm.len()];
    let mut areas = vec![0.0; rest_mm.len()];
    for face in faces {
        let before = face.map(|v| rest_mm[v as usize]);
        let turn = rotation(before, face.map(|v| moved_mm[v as usize]));
        let area = (before[1] - before[0]).cross(&(before[2] - before[0])).norm();
        for &vertex in face {
            turns[vertex as usize] += turn * area;
            areas[vertex as usize] += area;
        }
    }
    for (turn, area) in turns.iter_mut().zip(areas).filter(|(_, area)| *area > 0.0) {
        *turn /= area;
    }
    turns
}

/// The rotation of a triangle, shear and stretch removed (polar decomposition). None for one without area is the
/// identity.
fn rotation(before: [Vec3; 3], after: [Vec3; 3]) -> Mat3 {
    let (Some(old), Some(new)) = (frame(before), frame(after)) else {
        return Mat3::identity();
    };
    // In-plane coordinates of the sides from the first vertex, as columns.
    let sides = |frame: &Mat3, [a, b, c]: [Vec3; 3]| {
        let [p, q] = [b - a, c - a];
        let along = |x: Vec3, axis: usize| x.dot(&frame.column(axis));
        [[along(p, 0), along(p, 1)], [along(q, 0), along(q, 1)]]
    };
    let [[px, _], [qx, qy]] = sides(&old, before);
    let [[sx, _], [tx, ty]] = sides(&new, after);
    // The first side is the first axis in both frames: the map is upper triangular, and its rotation has the angle
    // whose sine and cosine are as the difference of its off-diagonal to the sum of its diagonal elements.
    let (xx, yy) = (sx / px, ty / qy);
    let xy = (tx - xx * qx) / qy;
    let length = (xx + yy).hypot(xy);
    let (cosine, sine) = ((xx + yy) / length, -xy / length);
    let in_plane = Mat3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0);
    new * in_plane * old.transpose()
}

/// Axes of a triangle as columns: along its first side, across it, normal.
fn frame([a, b, c]: [Vec3; 3]) -> Option<Mat3> {
    let along = (b - a).try_normalize(0.0)?;
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
    Some(Mat3::from_columns(&[along, normal.cross(&along), normal]))
}
