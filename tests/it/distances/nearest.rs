//! Closest points against exact arithmetic, and in general position against parry's.

use coapt::Vec3;
use coapt::contact::nearest::{Nearest, edge_edge, point_triangle, triangle_parameters};
use coapt::contact::pairs::PairKind;
use coapt_tests::Random;
use nalgebra::Rotation3;
use num_bigint::BigInt;
use parry3d_f64::glamx::DVec3;
use parry3d_f64::query::PointQuery;
use parry3d_f64::query::details::closest_points_segment_segment_with_locations_nD;
use parry3d_f64::shape::{Segment, SegmentPointLocation, Triangle};
use std::collections::BTreeMap;

use super::configurations::{self, Configuration};
use super::exact::{self, Fraction, Whole, dot, exponent_of, minus, whole, whole_number};

fn nearest_of(kind: PairKind, [a, b, c, d]: &[Vec3; 4]) -> Nearest {
    match kind {
        PairKind::PointTriangle => point_triangle(a, b, c, d),
        PairKind::EdgeEdge => edge_edge(a, b, c, d),
    }
}

/// What errors are measured by: the largest difference of coordinates between corners. Where a configuration is does not
/// count: corners are what their numbers say, also a million kilometres off, and their distance is exact as theirs.
fn size(corners: &[Vec3; 4]) -> f64 {
    let [low, high] = [Vec3::inf, Vec3::sup].map(|of| corners[1..].iter().fold(corners[0], |a, b| of(&a, b)));
    (high - low).max()
}

/// How far a result is from the truth, in sizes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Errors {
    /// Of the length of the separation.
    distance: f64,
    /// Of the distance between the places that the weights say.
    weighted: f64,
    /// Of the separation from the one that the weights say.
    separation: f64,
    /// Of the sums of weights over both parts.
    sums: f64,
}

impl Errors {
    fn max(self, other: Self) -> Self {
        Self {
            distance: self.distance.max(other.distance),
            weighted: self.weighted.max(other.weighted),
            separation: self.separation.max(other.separation),
            sums: self.sums.max(other.sums),
        }
    }

    pub(super) fn largest(&self) -> f64 {
        self.distance
            .max(self.weighted)
            .max(self.separation)
            .max(self.sums)
    }
}

/// Lengths in whole numbers: of 2⁻¹²⁰ of the size or so.
struct Measure {
    /// Of the corners' numbers.
    exponent: i32,
    bits: i32,
    size: BigInt,
}

impl Measure {
    fn new(corners: &[Vec3; 4], size: f64) -> Self {
        let exponent = exponent_of(corners);
        let bits = 120 - (size.log2() as i32 - exponent);
        let size = whole_number(size, exponent);
        let size = if bits < 0 { size >> -bits } else { size << bits };
        Self { exponent, bits, size }
    }

    /// Of a squared length in units of 2 to twice an exponent.
    fn length(&self, squared: &Fraction, exponent: i32) -> BigInt {
        squared.root(self.bits + exponent - self.exponent)
    }

    fn in_sizes(&self, length: &BigInt) -> f64 {
        let parts: BigInt = (length << 100) / &self.size;
        i128::try_from(parts).map_or(f64::INFINITY, |parts| parts as f64 / 100_f64.exp2())
    }
}

pub(super) fn errors(kind: PairKind, corners: &[Vec3; 4]) -> Errors {
    let nearest = nearest_of(kind, corners);
    let sums = error_of_sums(kind, &nearest);
    let size = size(corners);
    if size == 0.0 {
        assert_eq!(nearest.separation_mm, Vec3::zeros());
        return Errors {
            sums,
            ..Errors::default()
        };
    }
    let measure = Measure::new(corners, size);
    let whole_corners = corners.map(|corner| whole(&corner, measure.exponent));
    let due = match kind {
        PairKind::PointTriangle => exact::point_triangle(&whole_corners),
        PairKind::EdgeEdge => exact::edge_edge(&whole_corners),
    };
    let due = measure.length(&due, measure.exponent);
    // The separation that the weights say, from the first corner on: what their sum lacks must not count by the distance
    // from the origin.
    let of_weights = nearest.weights.map(|weight| Vec3::new(weight, 0.0, 0.0));
    let of_weights = exponent_of(&of_weights);
    let separation = exponent_of(&[nearest.separation_mm]);
    let exponent = separation.min(of_weights + measure.exponent);
    let mut weighted = [0, 1, 2].map(|_| BigInt::ZERO);
    for (weight, corner) in nearest.weights.iter().zip(&whole_corners) {
        let weight = whole_number(*weight, of_weights) << (of_weights + measure.exponent - exponent);
        let way = minus(corner, &whole_corners[0]);
        (0..3).for_each(|k| weighted[k] += &weight * &way[k]);
    }
    let reported = whole(&nearest.separation_mm, exponent);
    let length = |vector: &Whole| measure.length(&Fraction(dot(vector, vector), BigInt::from(1)), exponent);
    let error = |length: BigInt| measure.in_sizes(&length).abs();
    Errors {
        distance: error(length(&reported) - &due),
        weighted: error(length(&weighted) - &due),
        separation: error(length(&minus(&reported, &weighted))),
        sums,
    }
}

/// Weights are means over each part: between nothing and all, and together one.
fn error_of_sums(kind: PairKind, nearest: &Nearest) -> f64 {
    let first_count = match kind {
        PairKind::PointTriangle => 1,
        PairKind::EdgeEdge => 2,
    };
    let (first, second) = nearest.weights.split_at(first_count);
    assert!(
        first.iter().all(|weight| (0.0..=1.0).contains(weight)),
        "{nearest:?}"
    );
    assert!(
        second.iter().all(|weight| (-1.0..=0.0).contains(weight)),
        "{nearest:?}"
    );
    let [first, second] = [first.iter().sum::<f64>() - 1.0, second.iter().sum::<f64>() + 1.0];
    first.abs().max(second.abs())
}

/// The same parts with their corners in another order, the first on being those of the same part.
fn reordered(kind: PairKind, [a, b, c, d]: [Vec3; 4]) -> [[Vec3; 4]; 4] {
    match kind {
        PairKind::PointTriangle => [[a, b, c, d], [a, c, d, b], [a, d, c, b], [a, b, d, c]],
        PairKind::EdgeEdge => [[a, b, c, d], [b, a, c, d], [c, d, a, b], [d, c, b, a]],
    }
}

/// As it is written, with its corners in every order that matters, and turned any way, each of which rounds its corners
/// anew.
fn errors_of_all_kinds(configuration: &Configuration, random: &mut Random) -> Errors {
    let Configuration { kind, corners, .. } = *configuration;
    let mut worst = Errors::default();
    for turn in 0..6 {
        let rotation = match turn {
            0 => Rotation3::identity(),
            _ => Rotation3::new(random.vector() * 3.0),
        };
        for corners in reordered(kind, corners.map(|corner| rotation * corner)) {
            worst = worst.max(errors(kind, &corners));
        }
    }
    worst
}

/// Largest error in sizes: of four roundings at 1, each half of 2.2e-16, in each component of a separation.
pub(super) const TOLERANCE: f64 = 1e-15;

#[test]
#[allow(
    clippy::print_stderr,
    reason = "the worst error of each family is a figure to be quoted"
)]
fn degenerate_configurations_have_the_exact_distance() {
    let all = configurations::all();
    assert_eq!(all.len(), 172);
    let mut random = Random(172);
    let mut families: BTreeMap<&str, Errors> = BTreeMap::new();
    for configuration in &all {
        let errors = errors_of_all_kinds(configuration, &mut random);
        let family = families.entry(configuration.family).or_default();
        *family = family.max(errors);
    }
    for (family, errors) in &families {
        let Errors {
            distance,
            weighted,
            separation,
            sums,
        } = errors;
        eprintln!(
            "{family}: {distance:.1e}, by weights {weighted:.1e}, apart {separation:.1e}, sums {sums:.1e}"
        );
    }
    for (family, errors) in &families {
        assert!(errors.largest() <= TOLERANCE, "{family}: {errors:?}");
    }
}

/// Between general position and those, where it is decided which digits are enough; sizes over four hundred powers of two.
#[test]
#[allow(clippy::print_stderr, reason = "the worst error is a figure to be quoted")]
fn random_degenerate_pairs_have_the_exact_distance() {
    for kind in [PairKind::PointTriangle, PairKind::EdgeEdge] {
        let mut random = Random(173);
        let mut worst = Errors::default();
        for _ in 0..20_000 {
            let corners = configurations::random_pair(kind, &mut random);
            let errors = errors(kind, &corners);
            assert!(errors.largest() <= TOLERANCE, "{kind:?} {corners:?}: {errors:?}");
            worst = worst.max(errors);
        }
        eprintln!("{kind:?}: {worst:?}");
    }
}

#[test]
fn nearest_points_of_simple_configurations() {
    let v = Vec3::new;
    let (a, b, c) = (v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0));
    let over_face = point_triangle(&v(0.25, 0.25, 2.0), &a, &b, &c);
    assert!((over_face.separation_mm - v(0.0, 0.0, 2.0)).norm() < 1e-15);
    assert_eq!(triangle_parameters(&over_face.weights).count, 2);
    let off_corner = point_triangle(&v(-3.0, -4.0, 0.0), &a, &b, &c);
    assert!((off_corner.separation_mm.norm() - 5.0).abs() < 1e-15);
    let crossing = edge_edge(
        &v(-1.0, 0.0, 0.0),
        &v(1.0, 0.0, 0.0),
        &v(0.0, -1.0, 0.5),
        &v(0.0, 1.0, 0.5),
    );
    assert!((crossing.separation_mm.norm() - 0.5).abs() < 1e-15);
    assert_eq!(crossing.weights, [0.5, 0.5, -0.5, -0.5]);
}

/// Parts of which corners coincide or lie on a line or a plane with others, and parts in general position, against parry.
///
/// Distances are compared: of degenerate parts several points may be nearest. Corners are of order one, so that rounding
/// leaves 1e-15, and its square root where parry's own barycentric coordinates of needles cancel.
#[test]
fn nearest_points_are_those_of_parry() {
    let mut random = Random(13);
    let mut worst = 0.0_f64;
    for round in 0..40_000 {
        let corners: [Vec3; 4] = match round % 4 {
            0 => std::array::from_fn(|_| random.vector()),
            // On a grid of five places a side: half of them degenerate.
            1 | 2 => std::array::from_fn(|_| (random.vector() * 2.5).map(f64::round) * 0.5),
            // On a line.
            _ => {
                let (start, along) = (random.vector(), random.vector());
                std::array::from_fn(|_| start + along * random.signed())
            }
        };
        let [a, b, c, d] = &corners;
        let point: DVec3 = (*a).into();
        let triangle = Triangle::new((*b).into(), (*c).into(), (*d).into());
        let of_parry = triangle.distance_to_local_point(point, false);
        let ours = point_triangle(a, b, c, d);
        worst = worst.max(assert_consistent(&ours, &corners) - of_parry);
        let [first, second] =
            [(a, b), (c, d)].map(|(start, end)| Segment::new((*start).into(), (*end).into()));
        let (s, t) =
            closest_points_segment_segment_with_locations_nD((&first.a, &first.b), (&second.a, &second.b));
        let of_parry = on(&first, s).distance(on(&second, t));
        let ours = edge_edge(a, b, c, d);
        worst = worst.max(assert_consistent(&ours, &corners) - of_parry);
    }
    assert!(worst < 1e-12, "farther than parry by {worst:e}");
}

fn on(segment: &Segment, location: SegmentPointLocation) -> DVec3 {
    segment.point_at(&location)
}

/// The separation is what the weights say, and they are means over each part: then no distance can be below the true one.
/// Returns the distance.
fn assert_consistent(nearest: &Nearest, corners: &[Vec3; 4]) -> f64 {
    let separation: Vec3 = corners
        .iter()
        .zip(nearest.weights)
        .map(|(x, weight)| x * weight)
        .sum();
    assert!((separation - nearest.separation_mm).norm() < 1e-14);
    let positive: f64 = nearest.weights.iter().filter(|weight| **weight > 0.0).sum();
    assert!((positive - 1.0).abs() < 1e-14 && nearest.weights.iter().sum::<f64>().abs() < 1e-14);
    nearest.separation_mm.norm()
}
