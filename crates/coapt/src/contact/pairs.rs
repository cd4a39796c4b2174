//! The list of near pairs and how long it stays valid.

use super::broad::SweepAndPrune;
use super::nearest::{Nearest, edge_edge, point_triangle};
use super::surface::Surface;
use crate::Vec3;
use rayon::prelude::*;

/// A point with a triangle, or an edge with an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PairKind {
    /// Vertices: the point, then the triangle.
    PointTriangle,
    /// Vertices: the first edge, then the second.
    EdgeEdge,
}

/// Two parts of the surface that share no vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// What meets what.
    pub kind: PairKind,
    /// The four vertices.
    pub vertices: [u32; 4],
    /// Contact begins at this distance [mm].
    pub activation_mm: f64,
    /// The area that this pair stands for [mm²].
    pub area_mm2: f64,
    /// Two edges fade out where the square of their cross product falls below this [mm⁴]; 0 for a point.
    pub parallel_limit_mm4: f64,
}

/// Where each vertex stands in a pair.
pub fn corners(vertices: &[u32; 4], positions_mm: &[Vec3]) -> [Vec3; 4] {
    vertices.map(|vertex| positions_mm[vertex as usize])
}

impl Pair {
    /// The closest points of the pair.
    pub fn nearest(&self, positions_mm: &[Vec3]) -> Nearest {
        nearest_of(self.kind, &corners(&self.vertices, positions_mm))
    }
}

fn nearest_of(kind: PairKind, corners: &[Vec3; 4]) -> Nearest {
    let [a, b, c, d] = corners;
    match kind {
        PairKind::PointTriangle => point_triangle(a, b, c, d),
        PairKind::EdgeEdge => edge_edge(a, b, c, d),
    }
}

/// All pairs within a reach of each other, and where the vertices stood then.
#[derive(Clone, Debug, Default)]
pub struct PairList {
    /// The pairs, in a fixed order.
    pub pairs: Vec<Pair>,
    reach_mm: f64,
    listed_at_mm: Vec<Vec3>,
    sweep: SweepAndPrune,
}

/// Below this many candidates the narrow phase runs on one thread: handing work out costs more than it saves.
const PARALLEL_FROM: usize = 20_000;

/// Part of the rest distance at which neighbours in the mesh begin to touch [1]. Mesh neighbours are nearer than
/// the thickness at rest and must not repel each other then; at one half an unloaded sheet is free, a shear or a
/// compression of the tissue by a third still is, and a fold is stopped before it closes.
const NEIGHBOUR_FRACTION: f64 = 0.5;

impl PairList {
    /// Whether every pair that comes within `distance_mm` while each vertex moves from `positions_mm` by up to
    /// `step_mm` is surely listed.
    pub fn covers(&self, positions_mm: &[Vec3], step_mm: f64, distance_mm: f64) -> bool {
        if self.listed_at_mm.len() != positions_mm.len() {
            return false;
        }
        // Two parts come at most twice as much nearer as their vertices have moved.
        let moved = largest_distance(positions_mm, &self.listed_at_mm) + step_mm;
        distance_mm + 2.0 * moved <= self.reach_mm
    }

    /// Lists all pairs within `reach_mm`.
    pub fn rebuild(
        &mut self,
        surface: &Surface,
        rest_mm: &[Vec3],
        positions_mm: &[Vec3],
        thickness_mm: f64,
        reach_mm: f64,
    ) {
        let candidates = candidates(&mut self.sweep, surface, positions_mm, reach_mm);
        let near = |&(kind, vertices, area_mm2): &Candidate| {
            let here = nearest_of(kind, &corners(&vertices, positions_mm)).separation_mm;
            (here.norm_squared() <= reach_mm * reach_mm).then(|| {
                let at_rest = corners(&vertices, rest_mm);
                let rest_distance_mm = nearest_of(kind, &at_rest).separation_mm.norm();
                Pair {
                    kind,
                    vertices,
                    activation_mm: thickness_mm.min(NEIGHBOUR_FRACTION * rest_distance_mm),
                    area_mm2,
                    parallel_limit_mm4: parallel_limit_mm4(kind, &at_rest),
                }
            })
        };
        self.pairs = if candidates.len() < PARALLEL_FROM {
            candidates.iter().filter_map(near).collect()
        } else {
            candidates.par_iter().filter_map(near).collect()
        };
        self.reach_mm = reach_mm;
        self.listed_at_mm.clear();
        self.listed_at_mm.extend_from_slice(positions_mm);
    }
}

/// The closest points of parallel edges jump, so their penalty must vanish there (Li et al. 2020, section 5.2:
/// sin² below 1e-3, an angle of 1.8°). Wider, and crossing edges would slip; narrower, and the force would jolt.
fn parallel_limit_mm4(kind: PairKind, rest: &[Vec3; 4]) -> f64 {
    match kind {
        PairKind::PointTriangle => 0.0,
        PairKind::EdgeEdge => 1e-3 * (rest[1] - rest[0]).norm_squared() * (rest[3] - rest[2]).norm_squared(),
    }
}

type Candidate = (PairKind, [u32; 4], f64);

/// Every point-triangle and edge-edge pair without a common vertex whose face boxes overlap.
///
/// Weights: over two facing sheets the point-triangle pairs of both sides stand for half of the sheet's area and
/// the edge-edge pairs, of which about two cross each edge, for the other half.
fn candidates(
    sweep: &mut SweepAndPrune,
    surface: &Surface,
    positions_mm: &[Vec3],
    reach_mm: f64,
) -> Vec<Candidate> {
    let mut found = Vec::new();
    sweep.overlapping_faces(&surface.faces, positions_mm, reach_mm, |f, g| {
        for (one, other) in [(f, g), (g, f)] {
            let face = surface.faces[other as usize];
            for &vertex in &surface.owned_vertices[one as usize] {
                if !face.contains(&vertex) {
                    let vertices = [vertex, face[0], face[1], face[2]];
                    let area = 0.25 * surface.vertex_area_mm2[vertex as usize];
                    found.push((PairKind::PointTriangle, vertices, area));
                }
            }
        }
        for &first in &surface.owned_edges[f as usize] {
            for &second in &surface.owned_edges[g as usize] {
                let ([a, b], [c, d]) = (surface.edges[first as usize], surface.edges[second as usize]);
                if a != c && a != d && b != c && b != d {
                    let area = surface.edge_area_mm2[first as usize] + surface.edge_area_mm2[second as usize];
                    found.push((PairKind::EdgeEdge, [a, b, c, d], 0.125 * area));
                }
            }
        }
    });
    found
}

/// The farthest that any vertex lies from its other position [mm].
pub fn largest_distance(positions_mm: &[Vec3], others_mm: &[Vec3]) -> f64 {
    let squared = positions_mm
        .iter()
        .zip(others_mm)
        .map(|(a, b)| (a - b).norm_squared());
    squared.fold(0.0, f64::max).sqrt()
}
