//! Curves as point lists: arc length, points at an arc length, nearest points, resampling, vector area.
//!
//! A closed polyline does not repeat its first point; its last segment leads back there.

use crate::Vec3;

/// A place on a polyline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Arc length from the first point [mm].
    pub arc_mm: f64,
    /// The point [mm].
    pub point_mm: Vec3,
    /// Distance of the point asked for [mm].
    pub distance_mm: f64,
}

/// Arc length at every point [mm]; for a closed curve one more entry, the whole length. Empty for no points.
pub fn arc_lengths(points: &[Vec3], closed: bool) -> Vec<f64> {
    let mut arcs = Vec::with_capacity(points.len() + 1);
    let mut sum = 0.0;
    for (i, point) in points.iter().enumerate() {
        if i > 0 {
            sum += (point - points[i - 1]).norm();
        }
        arcs.push(sum);
    }
    if let (true, [first, .., last]) = (closed, points) {
        arcs.push(sum + (first - last).norm());
    }
    arcs
}

/// The whole length [mm].
pub fn length(points: &[Vec3], closed: bool) -> f64 {
    arc_lengths(points, closed).last().copied().unwrap_or(0.0)
}

/// The point at an arc length [mm]. Closed curves wrap round, open ones stop at their ends. No points: the origin.
pub fn point_at(points: &[Vec3], closed: bool, arc_mm: f64) -> Vec3 {
    point_at_arc(points, closed, &arc_lengths(points, closed), arc_mm)
}

/// [`point_at`] with the arc lengths already known, for many points on one curve.
pub fn point_at_arc(points: &[Vec3], closed: bool, arcs: &[f64], arc_mm: f64) -> Vec3 {
    let (Some(&first), Some(&total)) = (points.first(), arcs.last()) else {
        return Vec3::zeros();
    };
    if !(total.is_finite() && total > 0.0 && arc_mm.is_finite()) {
        return first;
    }
    let arc = if closed {
        arc_mm.rem_euclid(total)
    } else {
        arc_mm.clamp(0.0, total)
    };
    let segment = arcs.partition_point(|&a| a <= arc).clamp(1, arcs.len() - 1) - 1;
    let (a, b) = (points[segment], points[(segment + 1) % points.len()]);
    let span = arcs[segment + 1] - arcs[segment];
    if span > 0.0 {
        a + (b - a) * ((arc - arcs[segment]) / span)
    } else {
        a
    }
}

/// The nearest place on a polyline; the first of several equally near. Nothing for no points.
pub fn nearest(points: &[Vec3], closed: bool, to: Vec3) -> Option<CurvePoint> {
    let first = *points.first()?;
    let arcs = arc_lengths(points, closed);
    let mut best = CurvePoint {
        arc_mm: 0.0,
        point_mm: first,
        distance_mm: (first - to).norm(),
    };
    for segment in 0..arcs.len().saturating_sub(1) {
        let a = points[segment];
        let along = points[(segment + 1) % points.len()] - a;
        let square = along.norm_squared();
        let t = if square > 0.0 {
            ((to - a).dot(&along) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let point_mm = a + along * t;
        let distance_mm = (point_mm - to).norm();
        if distance_mm < best.distance_mm {
            let arc_mm = arcs[segment] + t * (arcs[segment + 1] - arcs[segment]);
            best = CurvePoint {
                arc_mm,
                point_mm,
                distance_mm,
            };
        }
    }
    Some(best)
}

/// So many points evenly spaced by arc length; an open curve keeps both ends.
pub fn resample(points: &[Vec3], closed: bool, count: usize) -> Vec<Vec3> {
    let arcs = arc_lengths(points, closed);
    let total = arcs.last().copied().unwrap_or(0.0);
    let intervals = if closed { count } else { count.saturating_sub(1) }.max(1);
    let step = total / intervals as f64;
    (0..count)
        .map(|i| point_at_arc(points, closed, &arcs, step * i as f64))
        .collect()
}

/// The mean of the curve along its arc [mm], which does not depend on how densely it is sampled.
pub fn centroid(points: &[Vec3], closed: bool) -> Vec3 {
    let segments = if closed {
        points.len()
    } else {
        points.len().saturating_sub(1)
    };
    let mut sum = Vec3::zeros();
    let mut weight = 0.0;
    for i in 0..segments {
        let (a, b) = (points[i], points[(i + 1) % points.len()]);
        let length = (b - a).norm();
        sum += (a + b) * (0.5 * length);
        weight += length;
    }
    if weight > 0.0 {
        sum / weight
    } else {
        points.first().copied().unwrap_or_else(Vec3::zeros)
    }
}

/// The vector area of the closed polygon [mm²]: along the normal from which it runs counter-clockwise, as long as
/// the area projected on that normal.
pub fn vector_area(points: &[Vec3]) -> Vec3 {
    let Some(&origin) = points.first() else {
        return Vec3::zeros();
    };
    let mut sum = Vec3::zeros();
    for pair in points.windows(2) {
        sum += (pair[0] - origin).cross(&(pair[1] - origin));
    }
    sum * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Vec3> {
        [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]
            .map(|[x, y]| Vec3::new(x, y, 0.0))
            .to_vec()
    }

    #[test]
    fn lengths_of_a_square() {
        assert_eq!(length(&square(), true), 8.0);
        assert_eq!(length(&square(), false), 6.0);
        assert_eq!(length(&[], true), 0.0);
        assert_eq!(length(&square()[..1], true), 0.0);
    }

    #[test]
    fn closed_curves_wrap_and_open_ones_stop() {
        assert_eq!(point_at(&square(), true, 7.0), Vec3::new(0.0, 1.0, 0.0));
        assert_eq!(point_at(&square(), true, -1.0), Vec3::new(0.0, 1.0, 0.0));
        assert_eq!(point_at(&square(), false, 9.0), Vec3::new(0.0, 2.0, 0.0));
        assert_eq!(point_at(&[], false, 1.0), Vec3::zeros());
        assert_eq!(point_at(&square(), true, f64::NAN), Vec3::zeros());
    }

    #[test]
    fn nearest_point_lies_on_the_closing_segment() {
        let found = nearest(&square(), true, Vec3::new(-1.0, 0.5, 0.0)).unwrap();
        assert_eq!(found.point_mm, Vec3::new(0.0, 0.5, 0.0));
        assert_eq!((found.arc_mm, found.distance_mm), (7.5, 1.0));
        assert!(nearest(&[], true, Vec3::zeros()).is_none());
    }

    #[test]
    fn resampling_is_even_and_keeps_open_ends() {
        let points = resample(&square(), false, 4);
        assert_eq!((points[0], points[3]), (square()[0], square()[3]));
        assert_eq!(points[1], Vec3::new(2.0, 0.0, 0.0));
        assert_eq!(resample(&square(), true, 8)[7], Vec3::new(0.0, 1.0, 0.0));
    }

    #[test]
    fn area_and_centroid_do_not_depend_on_sampling() {
        let mut dense = square();
        dense.insert(1, Vec3::new(0.5, 0.0, 0.0));
        assert_eq!(vector_area(&dense), Vec3::new(0.0, 0.0, 4.0));
        assert_eq!(centroid(&dense, true), Vec3::new(1.0, 1.0, 0.0));
    }
}
