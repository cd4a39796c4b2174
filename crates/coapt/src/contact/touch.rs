//! Pairs that touch: where, and how their closest points slide and fade.

use super::nearest::Nearest;
use super::pairs::{Pair, PairKind, corners};
use crate::{Mat3, Vec3};

/// A pair within its activation distance.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// The pair.
    pub pair: Pair,
    /// Its closest points.
    pub nearest: Nearest,
    /// d = |r| [mm].
    pub distance_mm: f64,
    /// n = r / d, from the second part to the first [1].
    pub direction: Vec3,
}

/// The pairs that touch.
pub fn touches(pairs: &[Pair], positions_mm: &[Vec3]) -> Vec<Touch> {
    let mut touches = Vec::new();
    touches_into(pairs, positions_mm, &mut touches);
    touches
}

/// As [`touches`], into a vector that is there already.
pub fn touches_into(pairs: &[Pair], positions_mm: &[Vec3], touches: &mut Vec<Touch>) {
    touches.clear();
    for pair in pairs {
        let nearest = pair.nearest(positions_mm);
        let squared = nearest.separation_mm.norm_squared();
        if squared < pair.activation_mm * pair.activation_mm {
            let distance_mm = squared.sqrt();
            touches.push(Touch {
                pair: *pair,
                nearest,
                distance_mm,
                direction: nearest.separation_mm * (1.0 / distance_mm),
            });
        }
    }
}

/// The factor m(c) that fades near-parallel edges out, with its first two derivatives in c = |u × v|².
pub(super) struct Fade {
    pub(super) value: f64,
    pub(super) slope: f64,
    pub(super) curvature: f64,
    /// The edges u and v [mm].
    edges: [Vec3; 2],
    /// Derivatives of c by u and by v [mm³].
    pub(super) by_edges: [Vec3; 2],
}

/// Whether an edge comes from its vertex or goes to it: the derivative of u and v by the four vertices [1].
pub(super) const EDGE_SIGNS: [f64; 4] = [-1.0, 1.0, -1.0, 1.0];

impl Fade {
    /// Derivative of c by vertex k [mm³].
    pub(super) fn gradient(&self, k: usize) -> Vec3 {
        self.by_edges[k / 2] * EDGE_SIGNS[k]
    }

    /// Second derivatives of c: by u twice, by u and v, by v twice [mm²].
    pub(super) fn cross_hessian(&self) -> [Mat3; 3] {
        let [u, v] = self.edges;
        let twice = |w: Vec3| (Mat3::from_diagonal_element(w.norm_squared()) - w * w.transpose()) * 2.0;
        let mixed = u * v.transpose() * 2.0 - v * u.transpose() - Mat3::from_diagonal_element(u.dot(&v));
        [twice(v), mixed * 2.0, twice(u)]
    }
}

/// A way in which the closest points can slide, orthogonal to the others: what it does to D = ½ d², by the four vertices.
pub(super) struct Slide {
    /// b = w e + u r, the second derivative of D by a vertex and the slide [mm].
    pub(super) mixed: [Vec3; 4],
    /// 1 / (e·e) [1/mm²].
    pub(super) inverse: f64,
}

impl Touch {
    /// m(c) = (c/ε)(2 − c/ε) below the limit ε; nothing above, where it is 1 (Li et al. 2020, eq. 24).
    #[inline]
    pub(super) fn fade(&self, positions_mm: &[Vec3]) -> Option<Fade> {
        if self.pair.kind == PairKind::PointTriangle {
            return None;
        }
        let [a, b, c, d] = corners(&self.pair.vertices, positions_mm);
        let limit = self.pair.parallel_limit_mm4;
        let (u, v) = (b - a, d - c);
        let c = u.cross(&v).norm_squared();
        (c < limit).then(|| Fade {
            value: c / limit * (2.0 - c / limit),
            slope: 2.0 / limit * (1.0 - c / limit),
            curvature: -2.0 / (limit * limit),
            edges: [u, v],
            by_edges: [
                (u * v.norm_squared() - v * u.dot(&v)) * 2.0,
                (v * u.norm_squared() - u * u.dot(&v)) * 2.0,
            ],
        })
    }

    /// How r = Σ wᵢ xᵢ slides: e = Σ uᵢ xᵢ for a direction u in weight space.
    #[inline]
    pub(super) fn sliding(&self, u: &[f64; 4], positions_mm: &[Vec3]) -> Vec3 {
        let [a, b, c, d] = corners(&self.pair.vertices, positions_mm);
        (b - a) * u[1] + (c - a) * u[2] + (d - a) * u[3]
    }

    #[inline]
    pub(super) fn slide(&self, u: &[f64; 4], e: &Vec3) -> Slide {
        let (w, r) = (&self.nearest.weights, &self.nearest.separation_mm);
        let squared = e.norm_squared();
        Slide {
            mixed: std::array::from_fn(|i| e * w[i] + r * u[i]),
            inverse: if squared > 0.0 { 1.0 / squared } else { 0.0 },
        }
    }
}
