//! The annular plane and curves that close on themselves.

use nalgebra::SymmetricEigen;

use crate::{Mat3, Vec3};

/// A frame in the annular plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct AnnularPlane {
    /// Centre of the annulus curve by arc length.
    pub(super) origin: Vec3,
    /// In the plane, towards the middle of the anterior annulus.
    pub(super) u: Vec3,
    /// In the plane, completing the right-handed frame.
    pub(super) v: Vec3,
    /// To the atrium.
    pub(super) normal: Vec3,
}

impl AnnularPlane {
    /// Coordinates in this frame; the third is the height above the plane.
    pub(super) fn local(&self, p: Vec3) -> Vec3 {
        let r = p - self.origin;
        Vec3::new(r.dot(&self.u), r.dot(&self.v), r.dot(&self.normal))
    }
}

/// Points that the annulus is resampled to before a plane is fitted: enough that their number does not show.
const RESAMPLED: usize = 256;

/// The plane that fits a closed curve best, every piece of its length counting the same, so that dense points on one
/// side do not tilt it. The curve runs counter-clockwise seen from the atrium. Nothing for fewer than three points
/// or a curve without extent.
pub(super) fn annular_plane(curve: &[Vec3], toward: Vec3) -> Option<AnnularPlane> {
    if curve.len() < 3 {
        return None;
    }
    let points = resample_closed(curve, RESAMPLED);
    let origin = points.iter().sum::<Vec3>() / points.len() as f64;
    let spread: Mat3 = points
        .iter()
        .map(|p| (p - origin) * (p - origin).transpose())
        .sum();
    let eigen = SymmetricEigen::try_new(spread, f64::EPSILON, 1000)?;
    let smallest = eigen.eigenvalues.imin();
    let mut normal = eigen.eigenvectors.column(smallest).into_owned();
    if normal.dot(&vector_area(curve)) < 0.0 {
        normal = -normal;
    }
    let u = [toward - origin, curve[0] - origin, Vec3::x(), Vec3::y()]
        .into_iter()
        .map(|d| d - normal * normal.dot(&d))
        .find(|d| d.norm() > 1e-6)?
        .normalize();
    Some(AnnularPlane {
        origin,
        u,
        v: normal.cross(&u),
        normal,
    })
}

/// Evenly spaced points along a closed polyline, the first one kept.
pub(super) fn resample_closed(curve: &[Vec3], count: usize) -> Vec<Vec3> {
    let n = curve.len();
    let step = length_closed(curve) / count as f64;
    if n == 0 || step.is_nan() || step <= 0.0 {
        return curve.to_vec();
    }
    let mut points = Vec::with_capacity(count);
    let (mut edge, mut start) = (0, 0.0);
    for k in 0..count {
        let target = k as f64 * step;
        let mut length = (curve[(edge + 1) % n] - curve[edge]).norm();
        while start + length < target && edge + 1 < n {
            start += length;
            edge += 1;
            length = (curve[(edge + 1) % n] - curve[edge]).norm();
        }
        let t = if length > 0.0 {
            ((target - start) / length).min(1.0)
        } else {
            0.0
        };
        points.push(curve[edge].lerp(&curve[(edge + 1) % n], t));
    }
    points
}

/// Length of a closed polyline.
pub(super) fn length_closed(curve: &[Vec3]) -> f64 {
    edges_closed(curve).map(|[a, b]| (b - a).norm()).sum()
}

/// Area vector of a closed polyline: its projected area along each axis (Newell).
pub(super) fn vector_area(curve: &[Vec3]) -> Vec3 {
    let first = curve.first().copied().unwrap_or_default();
    edges_closed(curve)
        .map(|[a, b]| (a - first).cross(&(b - first)) * 0.5)
        .sum()
}

/// The edges of a closed polyline in order.
pub(super) fn edges_closed(curve: &[Vec3]) -> impl Iterator<Item = [Vec3; 2]> + '_ {
    (0..curve.len()).map(|i| [curve[i], curve[(i + 1) % curve.len()]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn circle(angles: impl Iterator<Item = f64>) -> Vec<Vec3> {
        angles
            .map(|a| Vec3::new(10.0 * a.cos(), 10.0 * a.sin(), 3.0))
            .collect()
    }

    /// A plane curve gives its plane exactly, up to rounding, and the orientation of its sense.
    #[test]
    fn plane_of_a_circle() {
        let ccw = circle((0..60).map(|i| TAU * f64::from(i) / 60.0));
        let plane = annular_plane(&ccw, Vec3::new(0.0, 10.0, 3.0)).unwrap();
        assert!((plane.normal - Vec3::z()).norm() < 1e-12);
        assert!((plane.u - Vec3::y()).norm() < 1e-12);
        assert!((plane.origin - Vec3::new(0.0, 0.0, 3.0)).norm() < 1e-12);
        let cw: Vec<Vec3> = ccw.iter().rev().copied().collect();
        assert!((annular_plane(&cw, Vec3::zeros()).unwrap().normal + Vec3::z()).norm() < 1e-12);
    }

    /// Ten times as many points on one half leave the centre where it was; without resampling it would move by
    /// 0.8 of 2r/π, over 5 mm. 0.05 mm is the sagitta of the coarse half's 6° chords and below.
    #[test]
    fn dense_points_do_not_pull_the_centre() {
        let coarse = (0..30).map(|i| TAU / 2.0 * f64::from(i) / 30.0);
        let fine = (0..300).map(|i| TAU / 2.0 * (1.0 + f64::from(i) / 300.0));
        let plane = annular_plane(&circle(coarse.chain(fine)), Vec3::x()).unwrap();
        assert!((plane.origin - Vec3::new(0.0, 0.0, 3.0)).norm() < 0.05);
    }

    /// Too few points, or points in one place, have no plane.
    #[test]
    fn no_plane_without_extent() {
        assert!(annular_plane(&[Vec3::zeros(), Vec3::x()], Vec3::y()).is_none());
        let plane = annular_plane(&[Vec3::zeros(); 5], Vec3::zeros());
        assert!(plane.is_none_or(|p| p.normal.iter().all(|x| x.is_finite())));
    }
}
