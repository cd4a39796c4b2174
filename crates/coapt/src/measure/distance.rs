//! Distances from a point to a segment, a triangle and a box.

use crate::Vec3;
use crate::contact::nearest;

/// Distance from a point to a segment; a segment of no length is a point.
pub(super) fn point_segment(p: Vec3, [a, b]: [Vec3; 2]) -> f64 {
    let along = b - a;
    let squared = along.norm_squared();
    let t = if squared > 0.0 {
        ((p - a).dot(&along) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (p - (a + along * t)).norm()
}

/// Distance from a point to a triangle; one of no area is its edges.
pub(super) fn point_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> f64 {
    nearest::point_triangle(&p, &a, &b, &c).separation_mm.norm()
}

/// Distance from a point to the bounding box of a triangle: never more than to the triangle.
pub(super) fn point_box(p: Vec3, [a, b, c]: [Vec3; 3]) -> f64 {
    let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
    (low - p).sup(&(p - high)).sup(&Vec3::zeros()).norm()
}

/// Area of a triangle.
pub(super) fn triangle_area([a, b, c]: [Vec3; 3]) -> f64 {
    0.5 * (b - a).cross(&(c - a)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points above each kind of feature, with distances known by hand; 1e-15 is one rounding.
    #[test]
    fn distance_to_face_edge_and_corner() {
        let t = [Vec3::zeros(), Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 0.0)];
        let cases = [
            (Vec3::new(1.0, 1.0, -2.0), 2.0),
            (Vec3::new(2.0, -3.0, 4.0), 5.0),
            (Vec3::new(-3.0, 0.0, 4.0), 5.0),
            (Vec3::new(5.0, 0.0, 0.0), 1.0),
            // The hypotenuse 3x + 4y = 12 seen from (4, 3): (12 + 12 - 12) / 5.
            (Vec3::new(4.0, 3.0, 0.0), 2.4),
        ];
        for (p, expected) in cases {
            assert!((point_triangle(p, t) - expected).abs() < 1e-15, "{p}");
        }
    }

    /// A needle and a point count as what they are.
    #[test]
    fn degenerate_triangles_have_a_distance() {
        let (a, b) = (Vec3::zeros(), Vec3::new(2.0, 0.0, 0.0));
        let p = Vec3::new(1.0, 1.0, 0.0);
        assert_eq!(point_triangle(p, [a, b, b]), 1.0);
        assert_eq!(point_triangle(p, [a, a, a]), 2f64.sqrt());
    }
}
