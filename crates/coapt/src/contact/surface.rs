//! The triangles that can touch each other, with their edges, constant while relaxing.

use crate::Vec3;

/// A triangle mesh prepared for contact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Triangles, shape `[face]`.
    pub faces: Vec<[u32; 3]>,
    /// Edges, lower vertex first, in ascending order, shape `[edge]`.
    pub edges: Vec<[u32; 2]>,
    /// Vertices that face `f` stands for, and edges likewise: each belongs to exactly one face, so that pairs of
    /// faces yield every pair of their parts once. Shape `[face]`.
    pub owned_vertices: Vec<Vec<u32>>,
    /// Edges that face `f` stands for, as indices into `edges`, shape `[face]`.
    pub owned_edges: Vec<Vec<u32>>,
    /// Rest area around each vertex, a third of its faces [mm²], shape `[vertex]`.
    pub vertex_area_mm2: Vec<f64>,
    /// Rest area around each edge, a third of its faces [mm²], shape `[edge]`.
    pub edge_area_mm2: Vec<f64>,
}

impl Surface {
    /// Prepares a mesh; areas come from the rest positions.
    pub fn new(faces: &[[u32; 3]], rest_mm: &[Vec3]) -> Self {
        let mut edges: Vec<[u32; 2]> = faces.iter().flat_map(sides).collect();
        edges.sort_unstable();
        edges.dedup();
        let mut surface = Self {
            faces: faces.to_vec(),
            owned_vertices: vec![Vec::new(); faces.len()],
            owned_edges: vec![Vec::new(); faces.len()],
            vertex_area_mm2: vec![0.0; rest_mm.len()],
            edge_area_mm2: vec![0.0; edges.len()],
            edges,
        };
        let mut vertex_has_owner = vec![false; rest_mm.len()];
        let mut edge_has_owner = vec![false; surface.edges.len()];
        for (index, face) in faces.iter().enumerate() {
            let third = face_area_mm2(face, rest_mm) / 3.0;
            for &vertex in face {
                surface.vertex_area_mm2[vertex as usize] += third;
                if !std::mem::replace(&mut vertex_has_owner[vertex as usize], true) {
                    surface.owned_vertices[index].push(vertex);
                }
            }
            for side in sides(face) {
                let edge = surface.edge_index(side);
                surface.edge_area_mm2[edge] += third;
                if !std::mem::replace(&mut edge_has_owner[edge], true) {
                    surface.owned_edges[index].push(edge as u32);
                }
            }
        }
        surface
    }

    fn edge_index(&self, side: [u32; 2]) -> usize {
        // Every side of every face was put in the list above.
        self.edges.binary_search(&side).unwrap_or(0)
    }
}

/// The three sides of a face, lower vertex first.
pub fn sides(face: &[u32; 3]) -> [[u32; 2]; 3] {
    let [a, b, c] = *face;
    [[a.min(b), a.max(b)], [b.min(c), b.max(c)], [c.min(a), c.max(a)]]
}

/// Area of a face [mm²].
pub fn face_area_mm2(face: &[u32; 3], positions_mm: &[Vec3]) -> f64 {
    let [a, b, c] = face.map(|vertex| positions_mm[vertex as usize]);
    0.5 * (b - a).cross(&(c - a)).norm()
}
