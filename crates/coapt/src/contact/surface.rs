//! The triangles that can touch each other, with their edges, constant while relaxing.

use super::pairs::{PairKind, Parts};
use super::patches::Patches;
use crate::Vec3;

/// A triangle mesh prepared for contact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Triangles, shape `[face]`.
    pub faces: Vec<[u32; 3]>,
    /// Edges, lower vertex first, in ascending order, shape `[edge]`.
    pub edges: Vec<[u32; 2]>,
    /// Rest area around each vertex, a third of its faces [mm²], shape `[vertex]`.
    pub vertex_area_mm2: Vec<f64>,
    /// Rest area around each edge, a third of its faces [mm²], shape `[edge]`.
    pub edge_area_mm2: Vec<f64>,
    /// Mean edge length at rest [mm].
    pub mean_edge_mm: f64,
    /// A ball around each face at rest: centre [mm] and radius [mm], shape `[face]`.
    pub rest_balls: Vec<(Vec3, f64)>,
    /// Pairs without a common vertex whose faces (the point's, the triangle; the two edges') share one.
    pub neighbour_pairs: Vec<Parts>,
    /// The vertices of faces, each once.
    pub points: Vec<u32>,
    /// Those vertices, edges and faces, each kind in patches of neighbours at rest.
    pub point_patches: Patches,
    /// See [`Self::point_patches`].
    pub edge_patches: Patches,
    /// See [`Self::point_patches`].
    pub face_patches: Patches,
    /// The first face of each vertex, [`NO_FACE`] without one, shape `[vertex]`.
    pub vertex_face: Vec<u32>,
    /// The first face of each edge, shape `[edge]`.
    pub edge_face: Vec<u32>,
}

/// In place of a face, where there is none.
pub const NO_FACE: u32 = u32::MAX;

impl Surface {
    /// Prepares a mesh; areas come from the rest positions.
    pub fn new(faces: &[[u32; 3]], rest_mm: &[Vec3]) -> Self {
        let mut edges: Vec<[u32; 2]> = faces.iter().flat_map(sides).collect();
        edges.sort_unstable();
        edges.dedup();
        let mut surface = Self {
            faces: faces.to_vec(),
            vertex_area_mm2: vec![0.0; rest_mm.len()],
            edge_area_mm2: vec![0.0; edges.len()],
            vertex_face: vec![NO_FACE; rest_mm.len()],
            edge_face: vec![NO_FACE; edges.len()],
            edges,
            ..Self::default()
        };
        let mut face_edges = Vec::with_capacity(faces.len());
        for (index, face) in faces.iter().enumerate() {
            let third = face_area_mm2(face, rest_mm) / 3.0;
            for &vertex in face {
                surface.vertex_area_mm2[vertex as usize] += third;
                if surface.vertex_face[vertex as usize] == NO_FACE {
                    surface.vertex_face[vertex as usize] = index as u32;
                    surface.points.push(vertex);
                }
            }
            let edges = sides(face).map(|side| surface.edge_index(side));
            for edge in edges {
                surface.edge_area_mm2[edge] += third;
                if surface.edge_face[edge] == NO_FACE {
                    surface.edge_face[edge] = index as u32;
                }
            }
            face_edges.push(edges);
        }
        let length = |&[a, b]: &[u32; 2]| (rest_mm[a as usize] - rest_mm[b as usize]).norm();
        surface.mean_edge_mm =
            surface.edges.iter().map(length).sum::<f64>() / surface.edges.len().max(1) as f64;
        surface.rest_balls = faces.iter().map(|face| ball(face, rest_mm)).collect();
        let places = |places: &mut dyn Iterator<Item = Vec3>| Patches::new(&places.collect::<Vec<Vec3>>());
        let at = |vertex: u32| rest_mm[vertex as usize];
        surface.point_patches = places(&mut surface.points.iter().map(|&point| at(point)));
        surface.edge_patches = places(&mut surface.edges.iter().map(|&[a, b]| (at(a) + at(b)) / 2.0));
        surface.face_patches = places(&mut surface.rest_balls.iter().map(|(centre, _)| *centre));
        surface.find_neighbours(&face_edges, rest_mm.len());
        surface
    }

    /// The area that a point stands for against each triangle [mm²].
    ///
    /// Weights: over two facing sheets the point-triangle pairs of both sides stand for half of the sheet's area and
    /// the edge-edge pairs, of which about two cross each edge, for the other half.
    #[inline]
    pub fn point_area_mm2(&self, vertex: u32) -> f64 {
        0.25 * self.vertex_area_mm2[vertex as usize]
    }

    /// The area that two edges stand for [mm²], by the same weights.
    #[inline]
    pub fn edge_pair_area_mm2(&self, edges: [u32; 2]) -> f64 {
        let [first, second] = edges.map(|edge| self.edge_area_mm2[edge as usize]);
        0.125 * (first + second)
    }

    /// The vertices of a point (an index into `points`) and a face.
    #[inline]
    pub fn point_and_face(&self, [point, face]: [u32; 2]) -> [u32; 4] {
        let [a, b, c] = self.faces[face as usize];
        [self.points[point as usize], a, b, c]
    }

    /// The ends of two edges.
    #[inline]
    pub fn ends(&self, edges: [u32; 2]) -> [u32; 4] {
        let [[a, b], [c, d]] = edges.map(|edge| self.edges[edge as usize]);
        [a, b, c, d]
    }

    /// The first face of a point, an index into `points`, and a face.
    #[inline]
    pub fn faces_of_point(&self, [point, face]: [u32; 2]) -> [u32; 2] {
        [self.vertex_face[self.points[point as usize] as usize], face]
    }

    /// The first faces of two edges.
    #[inline]
    pub fn faces_of_edges(&self, edges: [u32; 2]) -> [u32; 2] {
        edges.map(|edge| self.edge_face[edge as usize])
    }

    /// Whether two faces share no vertex; all comparisons are made, since none is likelier than others to tell.
    #[inline]
    pub fn are_apart(&self, faces: [u32; 2]) -> bool {
        let [one, [a, b, c]] = faces.map(|face| self.faces[face as usize]);
        !one.iter().fold(false, |shared, &vertex| {
            shared | (vertex == a) | (vertex == b) | (vertex == c)
        })
    }

    fn edge_index(&self, side: [u32; 2]) -> usize {
        // Every side of every face was put in the list above.
        self.edges.binary_search(&side).unwrap_or(0)
    }

    fn find_neighbours(&mut self, face_edges: &[[usize; 3]], vertex_count: usize) {
        let (starts, around) = faces_around_vertices(&self.faces, vertex_count);
        let (mut pairs, mut near) = (Vec::new(), Vec::new());
        for (f, face) in self.faces.iter().enumerate() {
            near.clear();
            for &vertex in face {
                near.extend_from_slice(run(&around, &starts, vertex));
            }
            near.sort_unstable();
            near.dedup();
            for &g in near.iter().filter(|&&g| g as usize > f) {
                self.pairs_of_faces(f as u32, g, face_edges, &mut pairs);
            }
        }
        self.neighbour_pairs = pairs;
    }

    /// Pairs of which one part has the first of two faces for its own, the other the second.
    fn pairs_of_faces(&self, f: u32, g: u32, face_edges: &[[usize; 3]], found: &mut Vec<Parts>) {
        let mut push = |kind: PairKind, vertices: [u32; 4], area_mm2: f64| {
            found.push(Parts {
                kind,
                vertices,
                area_mm2,
                faces: [f, g],
            });
        };
        for (one, other) in [(f, g), (g, f)] {
            let [a, b, c] = self.faces[other as usize];
            for vertex in self.faces[one as usize] {
                if self.vertex_face[vertex as usize] == one && ![a, b, c].contains(&vertex) {
                    push(
                        PairKind::PointTriangle,
                        [vertex, a, b, c],
                        self.point_area_mm2(vertex),
                    );
                }
            }
        }
        let own = |face: u32| {
            let edges = face_edges[face as usize].into_iter();
            edges.filter(move |&edge| self.edge_face[edge] == face)
        };
        for first in own(f) {
            for second in own(g) {
                let ([a, b], [c, d]) = (self.edges[first], self.edges[second]);
                if a != c && a != d && b != c && b != d {
                    let area_mm2 = self.edge_pair_area_mm2([first as u32, second as u32]);
                    push(PairKind::EdgeEdge, [a, b, c, d], area_mm2);
                }
            }
        }
    }
}

fn ball(face: &[u32; 3], rest_mm: &[Vec3]) -> (Vec3, f64) {
    let corners = face.map(|vertex| rest_mm[vertex as usize]);
    let centre = corners.iter().sum::<Vec3>() / 3.0;
    let squared = corners.iter().map(|corner| (corner - centre).norm_squared());
    (centre, squared.fold(0.0, f64::max).sqrt())
}

#[inline]
fn run<'a>(values: &'a [u32], starts: &[u32], index: u32) -> &'a [u32] {
    &values[starts[index as usize] as usize..starts[index as usize + 1] as usize]
}

/// The faces around each vertex: runs of the second list between the starts of the first.
fn faces_around_vertices(faces: &[[u32; 3]], vertex_count: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0_u32; vertex_count + 1];
    for &vertex in faces.iter().flatten() {
        starts[vertex as usize + 1] += 1;
    }
    for vertex in 0..vertex_count {
        starts[vertex + 1] += starts[vertex];
    }
    let mut next = starts.clone();
    let mut around = vec![0; 3 * faces.len()];
    for (index, face) in faces.iter().enumerate() {
        for &vertex in face {
            around[next[vertex as usize] as usize] = index as u32;
            next[vertex as usize] += 1;
        }
    }
    (starts, around)
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
