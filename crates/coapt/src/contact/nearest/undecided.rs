//! Closest points where double precision leaves them undecided: needles, edges all but parallel, parts that meet, and sizes
//! whose powers it does not hold. The same with twice the digits, and only where that finds a nearer place.

use super::Nearest;
use super::doubled::Doubled;
use crate::Vec3;

/// The nearer of what was found for a point and a triangle, if anything was, and of what more digits find.
///
/// Of its sides and, where the foot of the point is within, of the inside. Each is a place of the triangle, so that none can
/// be nearer than the truth: of a needle as narrow as rounding the sides tell, of any other the inside is right.
#[cold]
pub(super) fn point_triangle(p: &Vec3, corners: [&Vec3; 3], found: Option<Nearest>) -> Nearest {
    let Some((scale, to_point)) = scaled(corners.map(|corner| [p, corner])) else {
        return coincident([1.0, -1.0, 0.0, 0.0]);
    };
    let candidate = |barycentric: [Doubled; 3]| {
        let parts: [Wide; 3] = std::array::from_fn(|k| to_point[k].times(barycentric[k]));
        let [u, v, w] = barycentric.map(|part| part.high);
        Candidate::new(parts[0].plus(parts[1]).plus(parts[2]), [1.0, -u, -v, -w])
    };
    let on_side = |i: usize, j: usize| {
        let along = to_point[i].minus(to_point[j]);
        let t = part(to_point[i].dot(&along), along.dot(&along));
        let mut barycentric = [Doubled::ZERO; 3];
        (barycentric[i], barycentric[j]) = (Doubled::ONE - t, t);
        candidate(barycentric)
    };
    let mut best = on_side(0, 1).nearer(on_side(1, 2)).nearer(on_side(0, 2));
    if let Some(barycentric) = inside(&to_point) {
        best = best.nearer(candidate(barycentric));
    }
    best.against(found, scale)
}

/// The same for edges: the closest points of the lines, then clamped to one edge after the other.
#[cold]
pub(super) fn edge_edge([a, b, c, d]: [&Vec3; 4], found: Nearest) -> Nearest {
    let Some((scale, [u, v, r])) = scaled([[b, a], [d, c], [a, c]]) else {
        return coincident([1.0, 0.0, -1.0, 0.0]);
    };
    let (uu, vv) = (u.dot(&u), v.dot(&v));
    let (uv, ur, vr) = (u.dot(&v), u.dot(&r), v.dot(&r));
    let s = part(uv * vr - ur * vv, uu * vv - uv * uv);
    let t = part(uv * s + vr, vv);
    let s = part(uv * t - ur, uu);
    let separation = r.plus(u.times(s)).minus(v.times(t));
    let weights = [Doubled::ONE - s, s, t - Doubled::ONE, -t].map(|weight| weight.high);
    Candidate::new(separation, weights).against(Some(found), scale)
}

/// All in one place: no part has any extent.
fn coincident(weights: [f64; 4]) -> Nearest {
    Nearest {
        separation_mm: Vec3::zeros(),
        weights,
    }
}

/// A vector to 32 digits.
#[derive(Clone, Copy)]
struct Wide([Doubled; 3]);

impl Wide {
    fn plus(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }

    fn minus(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }

    fn times(self, factor: Doubled) -> Self {
        Self(self.0.map(|value| value * factor))
    }

    fn dot(&self, other: &Self) -> Doubled {
        let [x, y, z]: [Doubled; 3] = std::array::from_fn(|k| self.0[k] * other.0[k]);
        x + y + z
    }

    fn cross(&self, other: &Self) -> Self {
        let of = |i: usize, j: usize| self.0[i] * other.0[j] - self.0[j] * other.0[i];
        Self([of(1, 2), of(2, 0), of(0, 1)])
    }
}

/// Differences of points times a power of two that makes the largest some one, and that power; none if all are zero.
fn scaled(ends: [[&Vec3; 2]; 3]) -> Option<(f64, [Wide; 3])> {
    let differences = ends.map(|[to, from]| [0, 1, 2].map(|k| Doubled::sum(to[k], -from[k])));
    let components = differences.iter().flatten();
    let size = components.fold(0.0_f64, |size, difference| size.max(difference.high.abs()));
    let scale = 2_f64.powi((-size.log2().floor()).clamp(-1000.0, 1000.0) as i32);
    (size > 0.0).then(|| (scale, differences.map(|of| Wide(of.map(|x| x.scaled(scale))))))
}

/// Parts of the corners in the foot of the point, where it is inside.
fn inside([a, b, c]: &[Wide; 3]) -> Option<[Doubled; 3]> {
    let normal = a.minus(*b).cross(&a.minus(*c));
    let sum = normal.dot(&normal);
    let opposite = [b.cross(c), c.cross(a), a.cross(b)].map(|area| area.dot(&normal));
    let is_inside = sum.high > 0.0 && opposite.iter().all(|part| part.high > 0.0);
    is_inside.then(|| opposite.map(|part| part / sum))
}

/// How far along a segment, given the product with it and its squared length; 0 for one without length.
fn part(product: Doubled, squared: Doubled) -> Doubled {
    if squared.high > 0.0 {
        (product / squared).clamp_to_one()
    } else {
        Doubled::ZERO
    }
}

/// A place, at the scale of this file.
struct Candidate {
    separation: Vec3,
    squared: f64,
    weights: [f64; 4],
}

impl Candidate {
    fn new(separation: Wide, weights: [f64; 4]) -> Self {
        let [x, y, z] = separation.0.map(|value| value.high);
        Self {
            separation: Vec3::new(x, y, z),
            squared: separation.dot(&separation).high,
            weights,
        }
    }

    fn nearer(self, other: Self) -> Self {
        if other.squared < self.squared { other } else { self }
    }

    /// What was found stays unless this is nearer by more than rounding: of places equally near the choice must not jump.
    fn against(self, found: Option<Nearest>, scale: f64) -> Nearest {
        let far = |nearest: &Nearest| (nearest.separation_mm * scale).norm();
        match found {
            Some(nearest) if far(&nearest) - self.squared.sqrt() <= f64::EPSILON => nearest,
            _ => Nearest {
                separation_mm: self.separation / scale,
                weights: self.weights,
            },
        }
    }
}
