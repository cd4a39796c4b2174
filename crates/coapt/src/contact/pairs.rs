//! The list of near pairs and how long it stays valid.

use super::broad::SweepAndPrune;
use super::nearest::{Nearest, edge_edge, point_triangle};
use super::step_bound::GAP_FRACTION;
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

/// All pairs that may touch until the vertices have moved by a given budget, and where the vertices stood when
/// the list was made.
#[derive(Clone, Debug, Default)]
pub struct PairList {
    /// The pairs with their distances then, in a fixed order.
    listed: Vec<(Pair, f64)>,
    budget_mm: f64,
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
    /// Whether every pair that touches while each vertex moves from `positions_mm` by up to `step_mm` is surely
    /// listed.
    pub fn covers(&self, positions_mm: &[Vec3], step_mm: f64) -> bool {
        self.listed_at_mm.len() == positions_mm.len()
            && self.moved_mm(positions_mm) + step_mm <= self.budget_mm
    }

    /// The pairs that may touch anywhere on the straight ways of all vertices from one place to another.
    ///
    /// Closest points are averages of their part's vertices, so a pair comes nearer by no more than the largest
    /// difference between the motions of a vertex of one part and one of the other.
    pub fn touching(&self, from_mm: &[Vec3], to_mm: &[Vec3]) -> Vec<Pair> {
        let motion = |positions: &[Vec3]| -> Vec<Vec3> {
            positions
                .iter()
                .zip(&self.listed_at_mm)
                .map(|(here, then)| here - then)
                .collect()
        };
        let (before, after) = (motion(from_mm), motion(to_mm));
        let may_touch = |pair: &Pair, distance_mm: f64| {
            let room = (distance_mm - pair.activation_mm).max(0.0);
            let nearer = approach_squared(pair, &before).max(approach_squared(pair, &after));
            room * room <= nearer
        };
        self.listed
            .iter()
            .filter(|(pair, distance)| may_touch(pair, *distance))
            .map(|(pair, _)| *pair)
            .collect()
    }

    /// The pairs that may meet when each vertex goes any part of its step, each its own part.
    pub fn meeting(&self, positions_mm: &[Vec3], step_mm: &[Vec3]) -> Vec<Pair> {
        let motion: Vec<Vec3> = positions_mm
            .iter()
            .zip(&self.listed_at_mm)
            .map(|(here, then)| here - then)
            .collect();
        let lengths: Vec<f64> = step_mm.iter().map(|step| step.norm()).collect();
        let may_meet = |pair: &Pair, distance_mm: f64| {
            let longest = pair
                .vertices
                .map(|vertex| lengths[vertex as usize])
                .into_iter()
                .fold(0.0, f64::max);
            let now_mm = distance_mm - approach_squared(pair, &motion).sqrt();
            2.0 * longest > GAP_FRACTION * now_mm
        };
        self.listed
            .iter()
            .filter(|(pair, distance)| may_meet(pair, *distance))
            .map(|(pair, _)| *pair)
            .collect()
    }

    fn moved_mm(&self, positions_mm: &[Vec3]) -> f64 {
        largest_distance(positions_mm, &self.listed_at_mm)
    }

    /// Lists all pairs that may touch before a vertex has moved by `budget_mm`.
    pub fn rebuild(
        &mut self,
        surface: &Surface,
        rest_mm: &[Vec3],
        positions_mm: &[Vec3],
        thickness_mm: f64,
        budget_mm: f64,
    ) {
        // Two parts come at most twice as much nearer as their vertices move.
        let reach_mm = thickness_mm + 2.0 * budget_mm;
        let candidates = candidates(&mut self.sweep, surface, positions_mm, reach_mm);
        let list = |candidate: &Candidate| list(candidate, rest_mm, positions_mm, thickness_mm, budget_mm);
        self.listed = if candidates.len() < PARALLEL_FROM {
            candidates.iter().filter_map(list).collect()
        } else {
            candidates.par_iter().filter_map(list).collect()
        };
        self.budget_mm = budget_mm;
        self.listed_at_mm.clear();
        self.listed_at_mm.extend_from_slice(positions_mm);
    }
}

/// A candidate with its distance, if it may touch within the budget.
fn list(
    &(kind, vertices, area_mm2): &Candidate,
    rest_mm: &[Vec3],
    positions_mm: &[Vec3],
    thickness_mm: f64,
    budget_mm: f64,
) -> Option<(Pair, f64)> {
    let distance_mm = nearest_of(kind, &corners(&vertices, positions_mm))
        .separation_mm
        .norm();
    if distance_mm > thickness_mm + 2.0 * budget_mm {
        return None;
    }
    let split = if kind == PairKind::PointTriangle { 1 } else { 2 };
    let at_rest = corners(&vertices, rest_mm);
    // Most pairs are far apart at rest and need no closer look.
    let activation_mm = if boxes_overlap(&vertices, split, rest_mm, thickness_mm / NEIGHBOUR_FRACTION) {
        thickness_mm.min(NEIGHBOUR_FRACTION * nearest_of(kind, &at_rest).separation_mm.norm())
    } else {
        thickness_mm
    };
    let parallel_limit_mm4 = parallel_limit_mm4(kind, &at_rest);
    let pair = Pair {
        kind,
        vertices,
        activation_mm,
        area_mm2,
        parallel_limit_mm4,
    };
    (distance_mm - activation_mm <= 2.0 * budget_mm).then_some((pair, distance_mm))
}

/// The square of how much nearer the parts of a pair may have come by these motions, at most [mm²].
fn approach_squared(pair: &Pair, motion_mm: &[Vec3]) -> f64 {
    let m = corners(&pair.vertices, motion_mm);
    match pair.kind {
        PairKind::PointTriangle => (1..4).map(|k| (m[0] - m[k]).norm_squared()).fold(0.0, f64::max),
        PairKind::EdgeEdge => {
            let across = [m[0] - m[2], m[0] - m[3], m[1] - m[2], m[1] - m[3]];
            across.iter().map(Vec3::norm_squared).fold(0.0, f64::max)
        }
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
                let vertices = [vertex, face[0], face[1], face[2]];
                if !face.contains(&vertex) && boxes_overlap(&vertices, 1, positions_mm, reach_mm) {
                    let area = 0.25 * surface.vertex_area_mm2[vertex as usize];
                    found.push((PairKind::PointTriangle, vertices, area));
                }
            }
        }
        for &first in &surface.owned_edges[f as usize] {
            for &second in &surface.owned_edges[g as usize] {
                let ([a, b], [c, d]) = (surface.edges[first as usize], surface.edges[second as usize]);
                let vertices = [a, b, c, d];
                let apart = a != c && a != d && b != c && b != d;
                if apart && boxes_overlap(&vertices, 2, positions_mm, reach_mm) {
                    let area = surface.edge_area_mm2[first as usize] + surface.edge_area_mm2[second as usize];
                    found.push((PairKind::EdgeEdge, vertices, 0.125 * area));
                }
            }
        }
    });
    found
}

/// Whether the boxes of the first `split` vertices and of the others, grown by the reach, overlap.
fn boxes_overlap(vertices: &[u32; 4], split: usize, positions_mm: &[Vec3], reach_mm: f64) -> bool {
    let points = corners(vertices, positions_mm);
    (0..3).all(|axis| {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (k, point) in points.iter().enumerate() {
            let side = usize::from(k >= split);
            low[side] = low[side].min(point[axis]);
            high[side] = high[side].max(point[axis]);
        }
        low[0] <= high[1] + reach_mm && low[1] <= high[0] + reach_mm
    })
}

/// The farthest that any vertex lies from its other position [mm].
pub fn largest_distance(positions_mm: &[Vec3], others_mm: &[Vec3]) -> f64 {
    let squared = positions_mm
        .iter()
        .zip(others_mm)
        .map(|(a, b)| (a - b).norm_squared());
    squared.fold(0.0, f64::max).sqrt()
}
