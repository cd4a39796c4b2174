//! Degenerate pairs of parts, by families: 172 in all, where the closest points jump, coincide or are lost in rounding.

use coapt::Vec3;
use coapt::contact::pairs::PairKind::{self, EdgeEdge, PointTriangle};
use coapt_tests::Random;

/// Two parts: a point and a triangle, or two edges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Configuration {
    pub(super) family: &'static str,
    pub(super) kind: PairKind,
    pub(super) corners: [Vec3; 4],
}

pub(super) fn all() -> Vec<Configuration> {
    let families: [(&str, PairKind, Vec<[Vec3; 4]>); 11] = [
        ("edges that cross at small angles", EdgeEdge, crossing_edges()),
        (
            "edges side by side at small angles",
            EdgeEdge,
            edges_side_by_side(),
        ),
        ("parallel edges", EdgeEdge, parallel_edges()),
        (
            "coplanar edges 3 nm off collinear",
            EdgeEdge,
            nearly_collinear_edges(),
        ),
        ("edges without length", EdgeEdge, edges_without_length()),
        ("edges far off, large and small", EdgeEdge, carried(&some_edges())),
        ("point on a triangle", PointTriangle, points_on_triangle()),
        ("point 1e-12 off a side", PointTriangle, points_off_side()),
        ("slivers", PointTriangle, slivers()),
        ("triangles without area", PointTriangle, triangles_without_area()),
        (
            "triangles far off, large and small",
            PointTriangle,
            carried(&some_triangles()),
        ),
    ];
    let of = |(family, kind, all): (&'static str, PairKind, Vec<[Vec3; 4]>)| {
        all.into_iter().map(move |corners| Configuration {
            family,
            kind,
            corners,
        })
    };
    families.into_iter().flat_map(of).collect()
}

const ANGLES_DEG: [f64; 12] = [
    1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 45.0, 89.9, 90.0, 100.0,
];

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A direction in the horizontal plane.
fn towards(angle_deg: f64) -> Vec3 {
    let (sine, cosine) = angle_deg.to_radians().sin_cos();
    v(cosine, sine, 0.0)
}

/// At 0.3 of the one and 0.6 of the other; in one plane, a nanometre and a tenth apart.
fn crossing_edges() -> Vec<[Vec3; 4]> {
    let at_height = |height: f64| {
        ANGLES_DEG.map(|angle_deg| {
            let (along, meet) = (towards(angle_deg), v(0.3, 0.0, height));
            [
                Vec3::zeros(),
                v(1.0, 0.0, 0.0),
                meet - along * 0.9,
                meet + along * 0.6,
            ]
        })
    };
    [0.0, 1e-9, 0.1].into_iter().flat_map(at_height).collect()
}

/// Nearest at an end, or all along but for the angle.
fn edges_side_by_side() -> Vec<[Vec3; 4]> {
    let beside = |angle_deg: f64| {
        let start = v(0.2, 0.1, 0.0);
        [Vec3::zeros(), v(1.0, 0.0, 0.0), start, start + towards(angle_deg)]
    };
    ANGLES_DEG.map(beside).into()
}

fn parallel_edges() -> Vec<[Vec3; 4]> {
    let (start, along, aside) = (v(0.1, 0.2, 0.3), v(0.75, -0.5, 0.25), v(0.0, 0.25, 0.5));
    let from_to = |from: f64, to: f64, off: f64| {
        let at = |part: f64| start + along * part + aside * off;
        [at(0.0) - aside * off, at(1.0) - aside * off, at(from), at(to)]
    };
    vec![
        from_to(0.0, 1.0, 0.0),
        from_to(1.0, 0.0, 0.0),
        from_to(0.25, 0.75, 0.0),
        from_to(0.5, 1.5, 0.0),
        from_to(1.0, 2.0, 0.0),
        from_to(1.5, 3.0, 0.0),
        from_to(0.0, 1.0, 1.0),
        from_to(0.75, -0.25, 1.0),
        from_to(1.0, 2.0, 1.0),
        from_to(-3.0, -2.0, 1.0),
    ]
}

/// Beyond each other's end in one plane, 3 nm of a metre from one line. Naively clamped such edges touch; the truth is the
/// distance of two ends.
fn nearly_collinear_edges() -> Vec<[Vec3; 4]> {
    let (a, b) = (v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0));
    vec![
        [a, b, v(1.1818, 3e-9, 0.0), v(2.0, 0.0, 0.0)],
        [a, b, v(1.1818, 0.0, 0.0), v(2.0, 3e-9, 0.0)],
        [a, b, v(2.0, -3e-9, 0.0), v(1.1818, 3e-9, 0.0)],
        [b, a, v(-0.1818, 3e-9, 0.0), v(-1.0, 6e-9, 0.0)],
        [a, b, v(0.5, 3e-9, 0.0), v(2.0, 0.0, 0.0)],
        [a, b, v(0.5, 3e-9, 0.0), v(2.0, -3e-9, 0.0)],
    ]
}

fn edges_without_length() -> Vec<[Vec3; 4]> {
    let (a, b, middle) = (v(0.0, 0.0, 0.0), v(1.0, 0.5, 0.25), v(0.5, 0.25, 0.125));
    let (off, near) = (v(0.3, 0.9, -0.2), middle + v(0.0, 0.0, 1e-12));
    vec![
        [a, b, off, off],
        [a, b, middle, middle],
        [a, b, b, b],
        [a, b, near, near],
        [off, off, a, b],
        [near, near, a, b],
        [a, a, off, off],
        [a, a, a, a],
    ]
}

/// Ways to carry a configuration: a factor, and how far.
const CARRIED: [(f64, f64); 4] = [(1.0, 1e9), (1e9, 0.0), (1e9, 1e9), (1e-9, 1e9)];

fn carried(all: &[[Vec3; 4]]) -> Vec<[Vec3; 4]> {
    let carry = |(factor, way): (f64, f64)| {
        let place = v(way, -way, 0.5 * way);
        all.iter()
            .map(move |corners| corners.map(|corner| corner * factor + place))
    };
    CARRIED.into_iter().flat_map(carry).collect()
}

fn some_edges() -> [[Vec3; 4]; 6] {
    let (a, b) = (v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0));
    [
        [a, b, v(0.3, -0.4, 0.1), v(0.5, 0.7, 0.2)],
        [a, b, v(0.3, -0.4, 0.0), v(0.5, 0.7, 0.0)],
        [a, b, v(0.0, 1e-3, 0.0), v(1.0, -1e-3, 1e-6)],
        [a, b, v(0.2, 0.1, 0.0), v(0.9, 0.1, 0.0)],
        [a, b, v(1.0, 0.0, 0.0), v(2.0, 3.0, 1.0)],
        [a, b, v(0.5, 0.5, 0.5), v(0.5, 0.5, 0.5)],
    ]
}

const CORNERS: [Vec3; 3] = [
    Vec3::new(0.125, 0.25, 0.5),
    Vec3::new(1.125, 0.5, 0.75),
    Vec3::new(0.375, 1.25, -0.25),
];

fn at([u, v, w]: [f64; 3]) -> Vec3 {
    CORNERS[0] * u + CORNERS[1] * v + CORNERS[2] * w
}

fn with_triangle(point: Vec3) -> [Vec3; 4] {
    [point, CORNERS[0], CORNERS[1], CORNERS[2]]
}

/// On each corner, in the middle of each side, and inside; of quarters and eighths, so that they are there exactly.
fn points_on_triangle() -> Vec<[Vec3; 4]> {
    let parts = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.5, 0.5, 0.0],
        [0.0, 0.5, 0.5],
        [0.5, 0.0, 0.5],
        [0.5, 0.25, 0.25],
        [0.125, 0.125, 0.75],
        [0.25, 0.625, 0.125],
    ];
    parts.map(|parts| with_triangle(at(parts))).into()
}

/// In the plane inwards and outwards, and above and beyond, of each side.
fn points_off_side() -> Vec<[Vec3; 4]> {
    let normal = (CORNERS[1] - CORNERS[0])
        .cross(&(CORNERS[2] - CORNERS[0]))
        .normalize();
    let off = |side: usize| {
        let (from, to) = (CORNERS[side], CORNERS[(side + 1) % 3]);
        let (foot, inwards) = (from * 0.7 + to * 0.3, normal.cross(&(to - from)).normalize());
        let offsets = [inwards, -inwards, normal, (normal - inwards).normalize()];
        offsets.map(|offset| with_triangle(foot + offset * 1e-12))
    };
    (0..3).flat_map(off).collect()
}

const SLIVER_HEIGHTS: [f64; 12] = [
    1e-3, 1e-6, 1e-8, 1e-10, 1e-12, 1e-15, 1e-20, 1e-30, 1e-60, 1e-100, 1e-200, 1e-300,
];

/// With a point inside, one over it by a tenth, and one by a thousandth of the height.
fn slivers() -> Vec<[Vec3; 4]> {
    let over = |height: f64, up: f64| {
        let triangle = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.4, height, 0.0)];
        let [a, b, c] = triangle;
        [v(0.45, 0.3 * height, up), a, b, c]
    };
    let of = |height: f64| [0.0, 0.1, 1e-3 * height].map(|up| over(height, up));
    SLIVER_HEIGHTS.into_iter().flat_map(of).collect()
}

fn triangles_without_area() -> Vec<[Vec3; 4]> {
    let (a, b, middle) = (v(0.0, 0.0, 0.0), v(1.0, 0.5, 0.25), v(0.5, 0.25, 0.125));
    let p = v(0.3, 0.7, 0.4);
    vec![
        [p, a, a, a],
        [p, a, a, b],
        [p, a, b, b],
        [p, a, b, middle],
        [middle, a, b, a],
        [b + b, a, b, middle],
        [a, a, a, a],
    ]
}

fn some_triangles() -> [[Vec3; 4]; 3] {
    [
        with_triangle(v(0.6, 0.7, 0.9)),
        with_triangle(at([0.5, 0.25, 0.25])),
        with_triangle(v(2.0, -1.0, 0.1)),
    ]
}

/// Anything between general position and the degenerate: needles and angles, gaps and parts of sides, each down to rounding
/// by powers of ten, or nothing.
pub(super) fn random_pair(kind: PairKind, random: &mut Random) -> [Vec3; 4] {
    let size = (200.0 * random.signed()).exp2();
    let (start, along) = (random.vector(), random.vector());
    let across = along.cross(&random.vector()).normalize() * along.norm();
    let normal = along.cross(&across).normalize() * along.norm();
    let (thinness, gap) = (down_to(16.0, random), down_to(18.0, random));
    // From a little before a corner to a little beyond the other, or all but at it.
    let part = |random: &mut Random| match random.signed() < 0.5 {
        true => 0.5 + 0.7 * random.signed(),
        false => down_to(17.0, random) * random.signed(),
    };
    let (s, t, shift) = (part(random), part(random), random.signed());
    let corners = match kind {
        PointTriangle => {
            let to_last = along * shift + across * thinness;
            let point = start + along * s + to_last * t + normal * gap;
            [point, start, start + along, start + to_last]
        }
        EdgeEdge => {
            let other = (along + across * thinness) * (1.1 + random.signed());
            let from = start + along * s - other * t + normal * gap;
            [start, start + along, from, from + other]
        }
    };
    corners.map(|corner| corner * size)
}

/// From one down to a power of ten, and every tenth time nothing.
fn down_to(powers: f64, random: &mut Random) -> f64 {
    match random.signed() < -0.8 {
        true => 0.0,
        false => 10_f64.powf(0.5 * powers * (random.signed() - 1.0)),
    }
}
