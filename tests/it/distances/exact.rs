//! Exact geometry of points that are given in floating point: coordinates as whole multiples of one power of two, distances
//! squared as fractions of whole numbers.

use coapt::Vec3;
use num_bigint::BigInt;

/// A vector of whole numbers.
pub(super) type Whole = [BigInt; 3];

/// A number m 2ᵉ with m odd or zero.
fn parts(value: f64) -> (i64, i32) {
    let bits = value.to_bits();
    let biased = ((bits >> 52) & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (mantissa, exponent) = match biased {
        0 => (fraction, -1074),
        _ => (fraction | 1 << 52, biased - 1075),
    };
    let zeros = if mantissa == 0 {
        0
    } else {
        mantissa.trailing_zeros()
    };
    let sign = if value.is_sign_negative() { -1 } else { 1 };
    (sign * (mantissa >> zeros), exponent + zeros as i32)
}

/// The least exponent of two that some coordinates need.
pub(super) fn exponent_of(points: &[Vec3]) -> i32 {
    let of = |&value: &f64| (value != 0.0).then(|| parts(value).1);
    points.iter().flatten().filter_map(of).min().unwrap_or(0)
}

/// A point as multiples of 2 to an exponent, which must not be larger than the point needs.
pub(super) fn whole(point: &Vec3, exponent: i32) -> Whole {
    [0, 1, 2].map(|axis| whole_number(point[axis], exponent))
}

pub(super) fn whole_number(value: f64, exponent: i32) -> BigInt {
    let (mantissa, own) = parts(value);
    if mantissa == 0 {
        BigInt::ZERO
    } else {
        BigInt::from(mantissa) << (own - exponent)
    }
}

pub(super) fn minus(a: &Whole, b: &Whole) -> Whole {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

pub(super) fn dot(a: &Whole, b: &Whole) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

pub(super) fn cross(a: &Whole, b: &Whole) -> Whole {
    let of = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    [of(1, 2), of(2, 0), of(0, 1)]
}

/// A number that is not negative: numerator and denominator.
#[derive(Clone, Debug)]
pub(super) struct Fraction(pub(super) BigInt, pub(super) BigInt);

impl Fraction {
    fn is_less(&self, other: &Self) -> bool {
        &self.0 * &other.1 < &other.0 * &self.1
    }

    /// ⌊2ᵏ √⌋ of it.
    pub(super) fn root(&self, bits: i32) -> BigInt {
        let shifted = match bits >= 0 {
            true => (&self.0 << (2 * bits)) / &self.1,
            false => &self.0 / (&self.1 << (-2 * bits)),
        };
        shifted.sqrt()
    }
}

/// Collects how near two parts are, each candidate being a distance between two places of theirs.
struct Least(Fraction);

impl Least {
    fn offer(&mut self, numerator: BigInt, denominator: BigInt) {
        let candidate = Fraction(numerator, denominator);
        if candidate.is_less(&self.0) {
            self.0 = candidate;
        }
    }

    fn offer_point(&mut self, p: &Whole, a: &Whole) {
        let way = minus(p, a);
        self.offer(dot(&way, &way), BigInt::from(1));
    }

    /// The foot on a side, where it lies between the ends.
    fn offer_side(&mut self, p: &Whole, a: &Whole, b: &Whole) {
        let (along, way) = (minus(b, a), minus(p, a));
        let (product, squared) = (dot(&along, &way), dot(&along, &along));
        if BigInt::ZERO < product && product < squared {
            let area = cross(&along, &way);
            self.offer(dot(&area, &area), squared);
        }
    }

    /// The foot within a triangle.
    fn offer_face(&mut self, p: &Whole, corners: [&Whole; 3]) {
        let [a, b, c] = corners;
        let normal = cross(&minus(b, a), &minus(c, a));
        let squared = dot(&normal, &normal);
        let inside = |from: &Whole, to: &Whole| {
            let area = cross(&minus(to, from), &minus(p, from));
            dot(&area, &normal) >= BigInt::ZERO
        };
        if squared > BigInt::ZERO && inside(a, b) && inside(b, c) && inside(c, a) {
            let height = dot(&minus(p, a), &normal);
            self.offer(&height * &height, squared);
        }
    }

    /// The feet of the common perpendicular of two lines, where both lie within the edges.
    fn offer_lines(&mut self, [a, b]: [&Whole; 2], [c, d]: [&Whole; 2]) {
        let (u, v, way) = (minus(b, a), minus(d, c), minus(c, a));
        let normal = cross(&u, &v);
        let squared = dot(&normal, &normal);
        let within = |part: BigInt| BigInt::ZERO <= part && part <= squared;
        if squared > BigInt::ZERO
            && within(dot(&cross(&way, &v), &normal))
            && within(dot(&cross(&way, &u), &normal))
        {
            let height = dot(&way, &normal);
            self.offer(&height * &height, squared.clone());
        }
    }
}

fn between(p: &Whole, q: &Whole) -> Least {
    let way = minus(p, q);
    Least(Fraction(dot(&way, &way), BigInt::from(1)))
}

/// Squared distance of the first corner from the triangle of the others, in the unit of the corners.
pub(super) fn point_triangle([p, a, b, c]: &[Whole; 4]) -> Fraction {
    let mut least = between(p, a);
    least.offer_point(p, b);
    least.offer_point(p, c);
    least.offer_side(p, a, b);
    least.offer_side(p, b, c);
    least.offer_side(p, c, a);
    least.offer_face(p, [a, b, c]);
    least.0
}

/// Squared distance of the edge between the first two corners from that between the others, in the unit of the corners.
pub(super) fn edge_edge([a, b, c, d]: &[Whole; 4]) -> Fraction {
    let mut least = between(a, c);
    least.offer_point(a, d);
    least.offer_point(b, c);
    least.offer_point(b, d);
    least.offer_side(a, c, d);
    least.offer_side(b, c, d);
    least.offer_side(c, a, b);
    least.offer_side(d, a, b);
    least.offer_lines([a, b], [c, d]);
    least.0
}

/// Of a squared distance as it is worked out by hand.
#[test]
fn exact_distances_are_those_worked_out_by_hand() {
    let v = Vec3::new;
    let squared = |distance: fn(&[Whole; 4]) -> Fraction, corners: [Vec3; 4]| {
        let Fraction(numerator, denominator) = distance(&corners.map(|corner| whole(&corner, -4)));
        (numerator, denominator)
    };
    // Over the middle of a triangle, a quarter of a unit above it: 4² in sixteenths.
    let triangle = [v(0.0, 0.0, 0.0), v(3.0, 0.0, 0.0), v(0.0, 3.0, 0.0)];
    let [a, b, c] = triangle;
    let (numerator, denominator) = squared(point_triangle, [v(1.0, 1.0, 0.25), a, b, c]);
    assert_eq!(numerator, BigInt::from(16) * denominator);
    // Before its long side: at (2, 2) half of 1² + 1² from x + y = 3.
    let (numerator, denominator) = squared(point_triangle, [v(2.0, 2.0, 0.0), a, b, c]);
    assert_eq!(numerator * 2, BigInt::from(256) * denominator);
    // Beyond a corner: 3-4-5.
    let (numerator, denominator) = squared(point_triangle, [v(6.0, -4.0, 0.0), a, b, c]);
    assert_eq!(numerator, BigInt::from(25 * 256) * denominator);
    // Crossed at right angles at half a unit, and beside each other end to end.
    let (low, high) = ([v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0)], v(0.0, -1.0, 0.5));
    let (numerator, denominator) = squared(edge_edge, [low[0], low[1], high, v(0.0, 1.0, 0.5)]);
    assert_eq!(numerator, BigInt::from(64) * denominator);
    let (numerator, denominator) = squared(edge_edge, [low[0], low[1], v(4.0, 4.0, 0.0), v(5.0, 4.0, 0.0)]);
    assert_eq!(numerator, BigInt::from(25 * 256) * denominator);
}
