//! Closest points of point-triangle and edge-edge pairs: the innermost loop of the solver, and therefore written
//! here. `tests/it/distances` holds them against exact arithmetic and against parry's.

mod doubled;
mod undecided;

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
/// The regions of the triangle's plane one after another (Ericson, Real-Time Collision Detection, 2005, 5.1.5); in
/// `undecided` where these are lost in rounding. The distance is right to 1e-15 of the largest difference of coordinates.
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
    let decided = |nearest: Nearest, of_b: f64, of_a: f64| {
        let sine = of_a + of_b + of_c;
        if is_decided(&nearest, sine, d1 - d3, d2 - d6) {
            return nearest;
        }
        undecided::point_triangle(p, [a, b, c], Some(nearest))
    };
    // A side without length has no point between its ends.
    if of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        let v = d1 / (d1 - d3);
        let nearest = of_triangle([1.0 - v, v, 0.0], ap * (1.0 - v) + bp * v);
        return decided(nearest, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4);
    }
    let of_b = d5 * d2 - d1 * d6;
    if of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        let w = d2 / (d2 - d6);
        let nearest = of_triangle([1.0 - w, 0.0, w], ap * (1.0 - w) + cp * w);
        return decided(nearest, of_b, d3 * d6 - d5 * d4);
    }
    let of_a = d3 * d6 - d5 * d4;
    if of_a <= 0.0 && d4 >= d3 && d5 >= d6 && d4 - d3 > d6 - d5 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        let nearest = of_triangle([0.0, 1.0 - w, w], bp * (1.0 - w) + cp * w);
        return decided(nearest, of_b, of_a);
    }
    if of_a > 0.0 && of_b > 0.0 && of_c > 0.0 {
        let sum = of_a + of_b + of_c;
        let (v, w) = (of_b / sum, of_c / sum);
        // What rounding leaves of nothing must not lie beyond the border.
        let u = (1.0 - v - w).max(0.0);
        let nearest = of_triangle([u, v, w], ap * u + bp * v + cp * w);
        return decided(nearest, of_b, of_a);
    }
    undecided::point_triangle(p, [a, b, c], None)
}

/// Whether rounding leaves the distance of two parts alone: of the point to a triangle, or of two edges, of these squared
/// lengths; `sine` is the square of the sine between them times both.
///
/// Rounding moves closest points by some ε L / sin², their distance d by the square of that over 2 d, which must be less than
/// ε L: d sin⁴ > ε L. (Edges: d sin².) Written with squares, and false where they leave the range of numbers.
#[inline]
fn is_decided(nearest: &Nearest, sine: f64, first: f64, second: f64) -> bool {
    let both = first * second;
    nearest.separation_mm.norm_squared() * (sine * sine) > LOST * (both * both) * (first + second)
}

/// Roundings of one number that fit into what is [decided](is_decided) [1], ten. Of a million random pairs on the brink of the
/// degenerate, errors exceed 1e-15 where this is a tenth, and nowhere at one. A hundred times more would send pairs ten times
/// as far apart the long way, which takes thirty times as long.
const LOST: f64 = 10.0 * f64::EPSILON;

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
/// The closest points of the lines, then clamped to one edge after the other (Ericson 2005, 5.1.9); in `undecided` where
/// these are lost in rounding. The distance is right to 1e-15 of the largest difference of coordinates.
#[inline]
pub fn edge_edge(a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3) -> Nearest {
    let (u, v, r) = (b - a, d - c, a - c);
    let (uu, vv) = (u.norm_squared(), v.norm_squared());
    let (uv, ur, vr) = (u.dot(&v), u.dot(&r), v.dot(&r));
    // Of parallel edges any s will do at first; of edges without length zero is the only one.
    let sine = uu * vv - uv * uv;
    let s = part(uv * vr - ur * vv, sine);
    let t = part(uv * s + vr, vv);
    // Nearest to that place on the second edge: the same s unless t was clamped. Always computed, which is faster than to
    // branch where nothing tells beforehand which way.
    let s = part(uv * t - ur, uu);
    let nearest = Nearest {
        separation_mm: r + u * s - v * t,
        weights: [1.0 - s, s, t - 1.0, -t],
    };
    if nearest.separation_mm.norm_squared() * sine > LOST * (uu * vv) * (uu + vv) {
        return nearest;
    }
    undecided::edge_edge([a, b, c, d], nearest)
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
