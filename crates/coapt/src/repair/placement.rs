//! Where a ring comes to lie: a rigid motion that fits its landmarks to the annulus'.

use crate::repair::ring_shape::{RingCurve, normal_of};
use crate::{Mat3, Vec3};

/// Weights of the two trigones, where the annulus is fibrous and holds a ring, and of the posterior middle (our choice).
const WEIGHTS: [f64; 3] = [2.0, 2.0, 1.0];

/// Moves a ring onto an annulus: normals made equal, then the least squares of the distances between trigones
/// (first, second) and posterior middles, each trigone weighted 2 to 1 (Kabsch 1976).
pub fn fit(ring: &RingCurve, annulus_mm: &[Vec3], to: [Vec3; 3]) -> RingCurve {
    let [first, second] = ring.marks.trigones;
    let from = [first, second, ring.marks.mid_posterior];
    let (turn, from_centre, to_centre) = motion(from, to, normal_of(&outline(ring)), normal_of(annulus_mm));
    ring.moved(|point| turn * (point - from_centre) + to_centre)
}

/// A ring's points, an open one's with its anterior middle, for its plane.
pub fn outline(ring: &RingCurve) -> Vec<Vec3> {
    let mut points = ring.points_mm.clone();
    if !ring.closed {
        points.push(ring.marks.mid_anterior);
    }
    points
}

/// The rotation between two weighted point sets with given normals, and the sets' centres.
///
/// Only what lies across the normals counts; with the normals themselves as one more, matching pair the singular
/// value decomposition of the covariance turns one onto the other exactly.
fn motion(from: [Vec3; 3], to: [Vec3; 3], from_normal: Vec3, to_normal: Vec3) -> (Mat3, Vec3, Vec3) {
    let total: f64 = WEIGHTS.iter().sum();
    let centre = |points: [Vec3; 3]| (0..3).map(|i| points[i] * WEIGHTS[i]).sum::<Vec3>() / total;
    let (from_centre, to_centre) = (centre(from), centre(to));
    let across = |v: Vec3, normal: Vec3| v - normal * normal.dot(&v);
    let mut covariance = Mat3::zeros();
    let mut scale = 0.0;
    for i in 0..3 {
        let a = across(from[i] - from_centre, from_normal);
        let b = across(to[i] - to_centre, to_normal);
        covariance += b * a.transpose() * WEIGHTS[i];
        scale += WEIGHTS[i] * a.norm() * b.norm();
    }
    covariance += to_normal * from_normal.transpose() * scale.max(1.0);
    let svd = covariance.svd(true, true);
    let (Some(u), Some(vt)) = (svd.u, svd.v_t) else {
        return (Mat3::identity(), from_centre, to_centre);
    };
    // A reflection is undone in the weakest direction.
    let weakest = svd.singular_values.imin();
    let mut sign = Vec3::repeat(1.0);
    sign[weakest] = (u * vt).determinant().signum();
    (u * Mat3::from_diagonal(&sign) * vt, from_centre, to_centre)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::polyline;
    use crate::repair::ring_shape::family_curve;
    use crate::scene::RingFamily;

    #[test]
    fn a_moved_ring_finds_its_way_back() {
        for family in [
            RingFamily::Saddle,
            RingFamily::ClassicLike,
            RingFamily::PosteriorBand,
        ] {
            let ring = family_curve(family, 32.0);
            let turn = nalgebra::Rotation3::from_euler_angles(2.0, -1.0, 0.5);
            let moved = ring.moved(|p| turn * p + Vec3::new(30.0, -80.0, 10.0));
            let to = [
                ring.marks.trigones[0],
                ring.marks.trigones[1],
                ring.marks.mid_posterior,
            ];
            let back = fit(&moved, &outline(&ring), to);
            let off = back
                .points_mm
                .iter()
                .zip(&ring.points_mm)
                .map(|(a, b)| (a - b).norm())
                .fold(0.0, f64::max);
            // Rounding of coordinates near 100 through a rotation: some 1e-13.
            assert!(off < 1e-11, "{family:?}: {off}");
        }
    }

    #[test]
    fn a_smaller_ring_lies_flat_in_the_middle() {
        let annulus = family_curve(RingFamily::PhysioLike, 40.0);
        let ring = family_curve(RingFamily::ClassicLike, 30.0);
        let to = [
            annulus.marks.trigones[0],
            annulus.marks.trigones[1],
            annulus.marks.mid_posterior,
        ];
        let fitted = fit(&ring, &annulus.points_mm, to);
        assert!((normal_of(&outline(&fitted)) - normal_of(&annulus.points_mm)).norm() < 1e-12);
        assert!(
            polyline::centroid(&fitted.points_mm, false).x.abs() < 1e-9,
            "left and right are equal"
        );
    }
}
