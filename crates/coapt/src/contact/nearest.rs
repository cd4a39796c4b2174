//! Closest points of point-triangle and edge-edge pairs: the innermost loop of the solver, and therefore written
//! here. `tests/it/contact.rs` holds them against parry's.

use crate::Vec3;

/// How near two parts are. The separation is r = Σ wᵢ xᵢ over the four vertices of the pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Separation, from the second part to the first [mm].
    pub separation_mm: Vec3,
    /// Weights w of the four vertices [1]: positive on the first part, negative on the second. A weight that is
    /// exactly zero says that the closest point lies on the border of its part.
    pub weights: [f64; 4],
}

/// Directions in weight space along which the closest points can slide: none, one or two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// The directions; only the first `count` count.
    pub directions: [[f64; 4]; 2],
    /// How many.
    pub count: usize,
}

/// Point `p` against triangle `(a, b, c)`; vertex order of the weights: p, a, b, c.
///
/// The regions of the triangle's plane one after another (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
#[inline]
pub fn point_triangle(p: &Vec3, a: &Vec3, b: &Vec3, c: &Vec3) -> Nearest {
    // Everything is measured to p: small numbers, whatever the frame.
    let (ap, bp, cp) = (p - a, p - b, p - c);
    let (ab, ac) = (ap - bp, ap - cp);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return of_triangle([1.0, 0.0, 0.0], ap);
    }
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return of_triangle([0.0, 1.0, 0.0], bp);
    }
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return of_triangle([0.0, 0.0, 1.0], cp);
    }
    let of_c = d1 * d4 - d3 * d2;
    // A side without length has no point between its ends.
    if of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        let v = d1 / (d1 - d3);
        return of_triangle([1.0 - v, v, 0.0], ap * (1.0 - v) + bp * v);
    }
    let of_b = d5 * d2 - d1 * d6;
    if of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        let w = d2 / (d2 - d6);
        return of_triangle([1.0 - w, 0.0, w], ap * (1.0 - w) + cp * w);
    }
    let of_a = d3 * d6 - d5 * d4;
    if of_a <= 0.0 && d4 >= d3 && d5 >= d6 && d4 - d3 > d6 - d5 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return of_triangle([0.0, 1.0 - w, w], bp * (1.0 - w) + cp * w);
    }
    let sum = of_a + of_b + of_c;
    let is_needle = sum <= NEEDLE * ab.norm_squared() * ac.norm_squared();
    if of_a > 0.0 && of_b > 0.0 && of_c > 0.0 && !is_needle {
        let (v, w) = (of_b / sum, of_c / sum);
        let u = 1.0 - v - w;
        return of_triangle([u, v, w], ap * u + bp * v + cp * w);
    }
    nearest_side(p, [a, b, c])
}

/// Below this squared sine of its first angle a triangle counts as its sides [1]: its inside is lost in rounding, and it
/// is a millionth as high as long.
const NEEDLE: f64 = 1e-12;

/// A triangle without area, where rounding leaves no region: its nearest side.
#[cold]
fn nearest_side(p: &Vec3, corners: [&Vec3; 3]) -> Nearest {
    let to_point = corners.map(|corner| p - corner);
    let on_side = |i: usize, j: usize| {
        let along = to_point[i] - to_point[j];
        let t = part(to_point[i].dot(&along), along.norm_squared());
        let mut barycentric = [0.0; 3];
        (barycentric[i], barycentric[j]) = (1.0 - t, t);
        of_triangle(barycentric, to_point[i] * (1.0 - t) + to_point[j] * t)
    };
    let squared = |nearest: &Nearest| nearest.separation_mm.norm_squared();
    let nearer = |one, other| {
        if squared(&other) < squared(&one) {
            other
        } else {
            one
        }
    };
    nearer(nearer(on_side(0, 1), on_side(1, 2)), on_side(0, 2))
}

#[inline]
fn of_triangle([u, v, w]: [f64; 3], separation_mm: Vec3) -> Nearest {
    Nearest {
        separation_mm,
        weights: [1.0, -u, -v, -w],
    }
}

/// How far along a segment, given the product with it and its squared length; 0 for one without length.
#[inline]
fn part(product: f64, squared: f64) -> f64 {
    if squared > 0.0 {
        (product / squared).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// Edge `(a, b)` against edge `(c, d)`; vertex order of the weights: a, b, c, d.
///
/// The closest points of the lines, then clamped to one edge after the other (Ericson 2005, 5.1.9).
#[inline]
pub fn edge_edge(a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3) -> Nearest {
    let (u, v, r) = (b - a, d - c, a - c);
    let (uu, vv) = (u.norm_squared(), v.norm_squared());
    let (uv, ur, vr) = (u.dot(&v), u.dot(&r), v.dot(&r));
    // Of parallel edges any s will do at first; of edges without length zero is the only one.
    let s = part(uv * vr - ur * vv, uu * vv - uv * uv);
    let t = part(uv * s + vr, vv);
    // Nearest to that place on the second edge: the same s unless t was clamped. Always computed, which is faster than to
    // branch where nothing tells beforehand which way.
    let s = part(uv * t - ur, uu);
    Nearest {
        separation_mm: r + u * s - v * t,
        weights: [1.0 - s, s, t - 1.0, -t],
    }
}

/// How the weights of a point over a triangle change as the closest point slides.
pub fn triangle_parameters(weights: &[f64; 4]) -> Parameters {
    let mut parameters = Parameters {
        directions: [[0.0; 4]; 2],
        count: 0,
    };
    let inside: [bool; 3] = std::array::from_fn(|k| weights[k + 1] != 0.0);
    let first = inside.iter().position(|&inside| inside).unwrap_or(0);
    for other in first + 1..3 {
        if inside[other] {
            let direction = &mut parameters.directions[parameters.count];
            direction[first + 1] = 1.0;
            direction[other + 1] = -1.0;
            parameters.count += 1;
        }
    }
    parameters
}

/// How the weights of two edges change as the closest points slide.
pub fn edge_parameters(weights: &[f64; 4]) -> Parameters {
    let mut parameters = Parameters {
        directions: [[0.0; 4]; 2],
        count: 0,
    };
    for (k, direction) in [[-1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]]
        .into_iter()
        .enumerate()
    {
        if weights[2 * k] != 0.0 && weights[2 * k + 1] != 0.0 {
            parameters.directions[parameters.count] = direction;
            parameters.count += 1;
        }
    }
    parameters
}
