//! Two parts that may touch, a point and a triangle or two edges, and where that begins.

use super::nearest::{Nearest, Parameters, edge_edge, edge_parameters, point_triangle, triangle_parameters};
use super::surface::Surface;
use crate::Vec3;

/// A point with a triangle, or an edge with an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PairKind {
    /// Vertices: the point, then the triangle.
    PointTriangle,
    /// Vertices: the first edge, then the second.
    EdgeEdge,
}

/// Two parts of the surface that share no vertex, and where they belong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// What meets what.
    pub kind: PairKind,
    /// The four vertices.
    pub vertices: [u32; 4],
    /// The area that the pair stands for [mm²].
    pub area_mm2: f64,
    /// The face of each part.
    pub faces: [u32; 2],
}

/// Two parts, and where they begin to touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// What meets what.
    pub kind: PairKind,
    /// The four vertices.
    pub vertices: [u32; 4],
    /// Contact begins at this distance [mm].
    pub activation_mm: f64,
    /// Contact is rigid, nearly, at this distance [mm]; less than the activation distance.
    pub rigid_mm: f64,
    /// The area that this pair stands for [mm²].
    pub area_mm2: f64,
    /// Two edges fade out where the square of their cross product falls below this [mm⁴]; 0 for a point.
    pub parallel_limit_mm4: f64,
}

/// Where each vertex stands in a pair.
#[inline]
pub fn corners(vertices: &[u32; 4], positions_mm: &[Vec3]) -> [Vec3; 4] {
    vertices.map(|vertex| positions_mm[vertex as usize])
}

impl Pair {
    /// The closest points of the pair.
    #[inline]
    pub fn nearest(&self, positions_mm: &[Vec3]) -> Nearest {
        nearest_at(self.kind, &self.vertices, positions_mm)
    }

    /// How the weights of its closest points change as these slide.
    pub fn parameters(&self, nearest: &Nearest) -> Parameters {
        match self.kind {
            PairKind::PointTriangle => triangle_parameters(&nearest.weights),
            PairKind::EdgeEdge => edge_parameters(&nearest.weights),
        }
    }
}

/// The closest points of two parts.
#[inline]
pub(super) fn nearest_at(kind: PairKind, vertices: &[u32; 4], positions_mm: &[Vec3]) -> Nearest {
    let [a, b, c, d] = vertices.map(|vertex| &positions_mm[vertex as usize]);
    match kind {
        PairKind::PointTriangle => point_triangle(a, b, c, d),
        PairKind::EdgeEdge => edge_edge(a, b, c, d),
    }
}

impl PairKind {
    /// The corners of one part and of the other, each with each.
    #[inline(always)]
    pub(super) fn across(self) -> &'static [[usize; 2]] {
        match self {
            Self::PointTriangle => &[[0, 1], [0, 2], [0, 3]],
            Self::EdgeEdge => &[[0, 2], [0, 3], [1, 2], [1, 3]],
        }
    }
}

/// The square of how much nearer two parts come by these motions, at most [mm²].
///
/// Closest points are averages of their part's vertices: the largest difference between the motions of a vertex of one
/// part and one of the other.
#[inline]
pub(super) fn approach_squared_mm2(kind: PairKind, vertices: &[u32; 4], motion_mm: &[Vec3]) -> f64 {
    let m = vertices.map(|vertex| &motion_mm[vertex as usize]);
    let against = |&[i, j]: &[usize; 2]| (m[i] - m[j]).norm_squared();
    kind.across().iter().map(against).fold(0.0, f64::max)
}

/// Where contact is looked for.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a> {
    /// The triangles.
    pub surface: &'a Surface,
    /// Unloaded positions [mm], shape `[vertex]`.
    pub rest_mm: &'a [Vec3],
    /// Present positions [mm], shape `[vertex]`.
    pub positions_mm: &'a [Vec3],
    /// Distance at which parts begin to touch [mm].
    pub thickness_mm: f64,
    /// The part of it at which they hardly come nearer [1]; see [`rigid_fraction`].
    pub rigid_fraction: f64,
    /// The part of the distance at which two parts begin to touch that steps leave between them [1]; 0: hardly anything.
    pub kept_fraction: f64,
}

/// The part of the contact thickness d̂ at which leaflets hardly come nearer [1]: 1 − (h/d̂)² for edges of length h.
///
/// A vertex touches every triangle within d̂, on fine meshes (d̂/h)² of them, a cost that grows as the square of the number
/// of faces. If contact begins at d̂ but is all but rigid d̂ − δ away, a vertex at rest in between reaches sideways only
/// √(2 d̂ δ): with δ = h²/d̂ a length or two of an edge, whatever the mesh. Leaflets stay apart by the same d̂.
pub fn rigid_fraction(surface: &Surface, thickness_mm: f64) -> f64 {
    (1.0 - (surface.mean_edge_mm / thickness_mm).powi(2)).clamp(0.0, MOST_RIGID)
}

impl Place<'_> {
    /// Whether some parts of two faces are nearer at rest than the distance at which neighbours could touch at the full
    /// thickness.
    pub(super) fn are_near_at_rest(&self, faces: [u32; 2]) -> bool {
        let [(centre, radius), (other, other_radius)] =
            faces.map(|face| self.surface.rest_balls[face as usize]);
        let limit_mm = self.thickness_mm / NEIGHBOUR_FRACTION + radius + other_radius;
        (centre - other).norm_squared() < limit_mm * limit_mm
    }

    /// Parts of two faces begin to touch at this distance at most [mm].
    #[inline]
    pub(super) fn farthest_mm(&self, faces: [u32; 2]) -> f64 {
        match self.are_near_at_rest(faces) {
            true => self.longest_of_neighbours_mm(),
            false => self.thickness_mm,
        }
    }

    /// Neighbours begin to touch at this distance at most [mm].
    pub(super) fn longest_of_neighbours_mm(&self) -> f64 {
        self.thickness_mm
            .min(NEIGHBOUR_FRACTION * self.surface.mean_edge_mm)
    }

    /// A pair that is far apart at rest.
    #[inline]
    pub(super) fn pair_of_strangers(&self, parts: &Parts) -> Pair {
        self.pair(parts, self.thickness_mm)
    }

    /// A pair whose faces are near at rest: where it begins to touch is decided by its unloaded shape.
    pub(super) fn pair_at_rest(&self, parts: &Parts) -> Pair {
        let rest_distance = nearest_at(parts.kind, &parts.vertices, self.rest_mm)
            .separation_mm
            .norm();
        // Never zero, which marks pairs of which it is not known yet.
        let activation_mm = self
            .longest_of_neighbours_mm()
            .min(NEIGHBOUR_FRACTION * rest_distance)
            .max(f64::MIN_POSITIVE);
        self.pair(parts, activation_mm)
    }

    #[inline]
    fn pair(&self, parts: &Parts, activation_mm: f64) -> Pair {
        Pair {
            kind: parts.kind,
            vertices: parts.vertices,
            activation_mm,
            rigid_mm: self.rigid_fraction * activation_mm,
            area_mm2: parts.area_mm2,
            parallel_limit_mm4: parallel_limit_mm4(parts.kind, &corners(&parts.vertices, self.rest_mm)),
        }
    }
}

/// The band in which contact goes from nothing to rigid is never narrower than 1 − this part of the thickness [1]: at
/// 100,000 faces the rule would make it a fiftieth of a millimetre.
const MOST_RIGID: f64 = 0.95;
/// Part of the rest distance at which neighbours in the mesh begin to touch [1]. Mesh neighbours are nearer than
/// the thickness at rest and must not repel each other then; at one half an unloaded sheet is free, a shear or a
/// compression of the tissue by a third still is, and a fold is stopped before it closes.
const NEIGHBOUR_FRACTION: f64 = 0.5;
/// A pair of which it is not known yet where it begins to touch.
pub(super) fn unseen(parts: &Parts) -> Pair {
    Pair {
        kind: parts.kind,
        vertices: parts.vertices,
        activation_mm: 0.0,
        rigid_mm: 0.0,
        area_mm2: parts.area_mm2,
        parallel_limit_mm4: 0.0,
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
