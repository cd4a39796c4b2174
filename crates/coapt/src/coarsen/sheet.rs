//! Where a point lies on the coarse mesh.

use crate::Vec3;
use crate::contact::nearest::point_triangle;

/// The coarse mesh with the faces around each vertex.
pub(super) struct Sheet<'a> {
    faces: &'a [[u32; 3]],
    points: &'a [Vec3],
    offsets: Vec<usize>,
    around: Vec<u32>,
}

impl<'a> Sheet<'a> {
    pub(super) fn new(faces: &'a [[u32; 3]], points: &'a [Vec3]) -> Self {
        let mut offsets = vec![0; points.len() + 2];
        faces.iter().flatten().for_each(|&v| offsets[v as usize + 2] += 1);
        (2..offsets.len()).for_each(|v| offsets[v] += offsets[v - 1]);
        let mut around = vec![0; 3 * faces.len()];
        for (number, face) in faces.iter().enumerate() {
            for &vertex in face {
                let slot: &mut usize = &mut offsets[vertex as usize + 1];
                around[*slot] = number as u32;
                *slot += 1;
            }
        }
        Self {
            faces,
            points,
            offsets,
            around,
        }
    }

    /// The corners of the nearest face, and the weights of the foot of the perpendicular on its plane. Goes
    /// from face to face, beginning around `start`, as long as it gets nearer and the foot lies beyond the
    /// face: a surface that passes close by is not taken.
    pub(super) fn locate(&self, point: Vec3, start: u32) -> ([u32; 3], [f64; 3]) {
        let mut best = (f64::INFINITY, [start; 3]);
        let mut weights = [1.0, 0.0, 0.0];
        let mut seen = Vec::with_capacity(8);
        let mut ahead = [start; 3];
        loop {
            let before = best.0;
            for vertex in ahead {
                if !seen.contains(&vertex) {
                    seen.push(vertex);
                    best = self.nearest_around(vertex, point, best);
                }
            }
            if best.0 == before {
                return (best.1, weights);
            }
            weights = self.weights(point, best.1);
            if weights.iter().all(|&weight| weight >= 0.0) {
                return (best.1, weights);
            }
            ahead = best.1;
        }
    }

    /// The face nearer than the best so far, with its squared distance [mm²].
    fn nearest_around(&self, vertex: u32, point: Vec3, mut best: (f64, [u32; 3])) -> (f64, [u32; 3]) {
        for &number in &self.around[self.offsets[vertex as usize]..self.offsets[vertex as usize + 1]] {
            let face = self.faces[number as usize];
            let [a, b, c] = face.map(|v| self.points[v as usize]);
            let distance_squared = point_triangle(&point, &a, &b, &c).separation_mm.norm_squared();
            if distance_squared < best.0 {
                best = (distance_squared, face);
            }
        }
        best
    }

    fn weights(&self, point: Vec3, face: [u32; 3]) -> [f64; 3] {
        let [a, b, c] = face.map(|v| self.points[v as usize]);
        let normal = (b - a).cross(&(c - a));
        let scale = 1.0 / normal.norm_squared();
        let second = (point - a).cross(&(c - a)).dot(&normal) * scale;
        let third = (b - a).cross(&(point - a)).dot(&normal) * scale;
        if second.is_finite() && third.is_finite() {
            [1.0 - second - third, second, third]
        } else {
            [1.0, 0.0, 0.0]
        }
    }
}
