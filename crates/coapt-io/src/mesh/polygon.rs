//! How quads and larger polygons divide into triangles.

use super::PolyData;

/// Points may stand this far out of a polygon's plane, over its diameter. Our choice: far above the rounding of
/// single precision, far below any bend that one sees.
const PLANAR_TOLERANCE: f64 = 1e-3;

/// A quad in two triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Halves {
    /// On both sides of the diagonal.
    pub(super) triangles: [[u32; 3]; 2],
    /// Distance of the two diagonals [mm]: 0 for a planar quad.
    pub(super) warp_mm: f64,
    /// The triangles meet at less than a right angle.
    pub(super) folded: bool,
}

/// Splits a quad along its shorter diagonal, or along the longer one where only that does not fold it. A quad that
/// folds along both is a creased cell of a deformed mesh, unless it is planar: then its sides cross, and it has no
/// halves.
pub(super) fn split_quad(mesh: &PolyData, corners: [u32; 4]) -> Option<Halves> {
    let [a, b, c, d] = corners;
    if a == c || b == d {
        return None;
    }
    let point = |corner: u32| mesh.points[corner as usize];
    let [ac, bd] = [subtract(point(c), point(a)), subtract(point(d), point(b))];
    let [along_ac, along_bd] = [[[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]];
    let [ac_squared, bd_squared] = [dot(ac, ac), dot(bd, bd)];
    let ac_is_shorter = ac_squared <= bd_squared;
    let [shorter, longer] = if ac_is_shorter {
        [along_ac, along_bd]
    } else {
        [along_bd, along_ac]
    };
    let folded = |halves: [[u32; 3]; 2]| {
        let [first, second] = halves.map(|half| area_vector(half.map(point)));
        dot(first, second) < 0.0
    };
    let across = cross(ac, bd);
    let length = dot(across, across).sqrt();
    let warp_mm = if length > 0.0 {
        (dot(subtract(point(b), point(a)), across) / length).abs()
    } else {
        0.0
    };
    let halves = |triangles, folded| {
        Some(Halves {
            triangles,
            warp_mm,
            folded,
        })
    };
    // Not by the warp: of a quad whose sides cross the diagonals may be parallel, and their distance means nothing.
    let volume = dot(subtract(point(b), point(a)), across).abs();
    let is_planar = volume <= PLANAR_TOLERANCE * ac_squared.max(bd_squared).powf(1.5);
    match (folded(shorter), folded(longer)) {
        (false, _) => halves(shorter, false),
        (true, false) => halves(longer, false),
        (true, true) if is_planar => None,
        (true, true) => halves(shorter, true),
    }
}

/// Whether a polygon may be divided from its first corner.
pub(super) fn is_planar_and_convex(mesh: &PolyData, corners: &[u32]) -> bool {
    let point = |i: usize| mesh.points[corners[i % corners.len()] as usize];
    let origin = point(0);
    let mut normal = [0.0; 3];
    let mut diameter = 0.0_f64;
    for i in 1..corners.len() - 1 {
        let part = area_vector([origin, point(i), point(i + 1)]);
        normal = [0, 1, 2].map(|k| normal[k] + part[k]);
        let edge = subtract(point(i), origin);
        diameter = diameter.max(dot(edge, edge).sqrt());
    }
    let length = dot(normal, normal).sqrt();
    if !(length.is_finite() && length > 0.0) {
        return false;
    }
    // All corners turn left: a star that turns left everywhere winds twice, so each fan triangle must too.
    let turns_left = |triangle| dot(area_vector(triangle), normal) >= -1e-12 * length * length;
    (0..corners.len()).all(|i| {
        let height = dot(subtract(point(i), origin), normal) / length;
        height.abs() <= PLANAR_TOLERANCE * diameter
            && turns_left([point(i), point(i + 1), point(i + 2)])
            && turns_left([origin, point(i), point(i + 1)])
    })
}

/// Twice the area, along the normal.
fn area_vector([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    cross(subtract(b, a), subtract(c, a))
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
