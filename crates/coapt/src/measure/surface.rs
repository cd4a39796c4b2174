//! The leaflet surface as the measures need it: edges, neighbours, which leaflet is where, local mesh size.

use crate::Vec3;
use crate::model::Model;

/// The leaflet mesh with its adjacency, in its measured position.
pub(super) struct Surface<'a> {
    /// Triangles.
    pub(super) faces: &'a [[u32; 3]],
    /// Which leaflet each face belongs to.
    pub(super) face_leaflet: &'a [u32],
    /// Unloaded positions [mm], shape `[vertex]`.
    pub(super) rest_mm: &'a [Vec3],
    /// Measured positions [mm], shape `[vertex]`.
    pub(super) positions_mm: &'a [Vec3],
    /// Edges, low vertex first, in ascending order.
    pub(super) edges: Vec<[u32; 2]>,
    /// Leaflets of the faces at each edge, one bit each.
    pub(super) edge_leaflets: Vec<u64>,
    /// Whether a face runs along the edge from its low to its high vertex.
    pub(super) edge_forward: Vec<bool>,
    /// The edges of each face: from its first to its second vertex, and on.
    pub(super) face_edges: Vec<[u32; 3]>,
    /// Leaflets of the faces at each vertex, one bit each.
    pub(super) vertex_leaflets: Vec<u64>,
    /// Mean length of the edges at each vertex, as measured [mm]; zero where there are none.
    pub(super) vertex_edge_mm: Vec<f64>,
    /// Mean length of all edges, as measured [mm].
    pub(super) mean_edge_mm: f64,
    neighbour_start: Vec<u32>,
    neighbour: Vec<u32>,
}

impl Surface<'_> {
    /// Vertices that share an edge with this one, ascending.
    pub(super) fn neighbours(&self, vertex: usize) -> &[u32] {
        &self.neighbour[self.neighbour_start[vertex] as usize..self.neighbour_start[vertex + 1] as usize]
    }

    /// The measured corners of a face.
    pub(super) fn corners(&self, face: usize) -> [Vec3; 3] {
        self.faces[face].map(|v| self.positions_mm[v as usize])
    }

    /// The unloaded corners of a face.
    pub(super) fn rest_corners(&self, face: usize) -> [Vec3; 3] {
        self.faces[face].map(|v| self.rest_mm[v as usize])
    }

    /// The number of an edge, if the mesh has it.
    pub(super) fn edge(&self, a: u32, b: u32) -> Option<usize> {
        self.edges.binary_search(&[a.min(b), a.max(b)]).ok()
    }
}

/// The bit of a leaflet in a set of leaflets; the 65th shares the first one's, which only more than 64 could notice.
pub(super) fn leaflet_bit(leaflet: u32) -> u64 {
    1 << (leaflet % 64)
}

/// Prepares the leaflet surface of a model in the given positions, shape `[vertex]`.
pub(super) fn surface<'a>(model: &'a Model, positions_mm: &'a [Vec3]) -> Surface<'a> {
    let mut surface = Surface {
        faces: &model.faces,
        face_leaflet: &model.face_leaflet,
        rest_mm: &model.rest_mm,
        positions_mm,
        edges: Vec::new(),
        edge_leaflets: Vec::new(),
        edge_forward: Vec::new(),
        face_edges: vec![[0; 3]; model.faces.len()],
        vertex_leaflets: vec![0; positions_mm.len()],
        vertex_edge_mm: vec![0.0; positions_mm.len()],
        mean_edge_mm: 0.0,
        neighbour_start: Vec::new(),
        neighbour: Vec::new(),
    };
    collect_edges(&mut surface);
    collect_neighbours(&mut surface);
    surface
}

fn collect_edges(s: &mut Surface) {
    let mut half_edges = Vec::with_capacity(3 * s.faces.len());
    for (f, (face, &leaflet)) in s.faces.iter().zip(s.face_leaflet).enumerate() {
        for k in 0..3 {
            let (a, b) = (face[k], face[(k + 1) % 3]);
            half_edges.push(([a.min(b), a.max(b)], f, k, a < b));
            s.vertex_leaflets[a as usize] |= leaflet_bit(leaflet);
        }
    }
    half_edges.sort_unstable();
    for (ends, f, k, forward) in half_edges {
        if s.edges.last() != Some(&ends) {
            s.edges.push(ends);
            s.edge_leaflets.push(0);
            s.edge_forward.push(false);
        }
        let e = s.edges.len() - 1;
        s.edge_leaflets[e] |= leaflet_bit(s.face_leaflet[f]);
        s.edge_forward[e] |= forward;
        s.face_edges[f][k] = e as u32;
    }
}

fn collect_neighbours(s: &mut Surface) {
    let mut start = vec![0u32; s.positions_mm.len() + 1];
    for &[a, b] in &s.edges {
        start[a as usize + 1] += 1;
        start[b as usize + 1] += 1;
    }
    for i in 1..start.len() {
        start[i] += start[i - 1];
    }
    let mut next = start.clone();
    s.neighbour = vec![0; 2 * s.edges.len()];
    let mut sum = 0.0;
    // Lower neighbours first: edges ascend by their low vertex, so each list comes out ascending in two passes.
    for pass in 0..2 {
        for &[a, b] in &s.edges {
            let (from, to) = if pass == 0 {
                (b as usize, a)
            } else {
                (a as usize, b)
            };
            s.neighbour[next[from] as usize] = to;
            next[from] += 1;
            let length = (s.positions_mm[a as usize] - s.positions_mm[b as usize]).norm();
            s.vertex_edge_mm[from] += length;
            sum += 0.5 * length;
        }
    }
    for (v, length) in s.vertex_edge_mm.iter_mut().enumerate() {
        *length /= f64::from((start[v + 1] - start[v]).max(1));
    }
    s.mean_edge_mm = sum / s.edges.len().max(1) as f64;
    s.neighbour_start = start;
}

#[cfg(test)]
mod tests {
    use super::super::test_models::model_of;
    use super::*;

    /// A square of two triangles with one leaflet each: five edges, the diagonal common to both leaflets.
    #[test]
    fn two_triangles() {
        let points = vec![Vec3::zeros(), Vec3::x(), Vec3::x() + Vec3::y(), Vec3::y()];
        let model = model_of(points, vec![[0, 1, 2], [0, 2, 3]], vec![0, 1], vec![], vec![]);
        let s = surface(&model, &model.rest_mm);
        assert_eq!(s.edges, [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]);
        assert_eq!(s.edge_leaflets, [1, 3, 2, 1, 2]);
        assert_eq!(s.vertex_leaflets, [3, 1, 3, 2]);
        assert_eq!(s.neighbours(0), [1, 2, 3]);
        assert_eq!(s.neighbours(2), [0, 1, 3]);
        assert_eq!(s.face_edges, [[0, 3, 1], [1, 4, 2]]);
        // Edge 0-3 is only ever run along from 3 to 0.
        assert_eq!(s.edge_forward, [true, true, false, true, true]);
        assert!((s.mean_edge_mm - (4.0 + 2f64.sqrt()) / 5.0).abs() < 1e-15);
        assert!((s.vertex_edge_mm[0] - (2.0 + 2f64.sqrt()) / 3.0).abs() < 1e-15);
        assert_eq!(s.edge(3, 0), Some(2));
        assert_eq!(s.edge(1, 3), None);
    }
}
