//! The rigid motion that lays one set of points on another best.

use nalgebra::{Isometry3, Rotation3, SVD, Translation3, UnitQuaternion};

use crate::{Mat3, Vec3};

/// The motion of least Σ w |M p - q|², of pairs (p, q, w): never a reflection (Kabsch 1976, 1978). The identity where
/// nothing has a weight.
pub(super) fn kabsch(pairs: &[(Vec3, Vec3, f64)]) -> Isometry3<f64> {
    let weight: f64 = pairs.iter().map(|pair| pair.2).sum();
    if weight.is_nan() || weight <= 0.0 {
        return Isometry3::identity();
    }
    let p_middle = pairs.iter().map(|(p, _, w)| p * *w).sum::<Vec3>() / weight;
    let q_middle = pairs.iter().map(|(_, q, w)| q * *w).sum::<Vec3>() / weight;
    let covariance: Mat3 = pairs
        .iter()
        .map(|(p, q, w)| (p - p_middle) * (q - q_middle).transpose() * *w)
        .sum();
    let rotation = rotation_of(covariance).unwrap_or_else(Rotation3::identity);
    let translation = Translation3::from(q_middle - rotation * p_middle);
    Isometry3::from_parts(translation, UnitQuaternion::from_rotation_matrix(&rotation))
}

/// R = V diag(1, 1, ±1) Uᵀ of H = U Σ Vᵀ, the sign that of a rotation, at the smallest singular value.
fn rotation_of(covariance: Mat3) -> Option<Rotation3<f64>> {
    let svd = SVD::try_new(covariance, true, true, f64::EPSILON, 1000)?;
    let (u, v) = (svd.u?, svd.v_t?.transpose());
    let mut signs = Vec3::repeat(1.0);
    signs[svd.singular_values.imin()] = (v * u.transpose()).determinant().signum();
    let rotation = v * Mat3::from_diagonal(&signs) * u.transpose();
    rotation
        .iter()
        .all(|x| x.is_finite())
        .then(|| Rotation3::from_matrix_unchecked(rotation))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> Vec<Vec3> {
        let place = |i: i32| Vec3::new(f64::from(i * i % 7), f64::from(i * 3 % 5), f64::from(i));
        (0..9).map(place).collect()
    }

    /// A motion is found again; 1e-12 mm is rounding of points some 10 mm out.
    #[test]
    fn finds_a_motion_again() {
        let motion = Isometry3::new(Vec3::new(4.0, -2.0, 7.0), Vec3::new(0.4, 1.1, -0.3));
        let pair = |p: Vec3| (p, motion.rotation * p + motion.translation.vector, 1.0 + p.z);
        let pairs: Vec<_> = points().into_iter().map(pair).collect();
        let found = kabsch(&pairs);
        for (p, q, _) in pairs {
            assert!((found.rotation * p + found.translation.vector - q).norm() < 1e-12);
        }
    }

    /// Of a mirror image the best rotation is returned, not the mirror; of points on a plane, a line and a place, some
    /// rotation that fits.
    #[test]
    fn never_reflects_and_needs_no_extent() {
        let mirrored: Vec<_> = points()
            .into_iter()
            .map(|p| (p, Vec3::new(-p.x, p.y, p.z), 1.0))
            .collect();
        let rotation = kabsch(&mirrored).rotation.to_rotation_matrix();
        assert!((rotation.matrix().determinant() - 1.0).abs() < 1e-12);
        for keep in [Vec3::new(1.0, 1.0, 0.0), Vec3::x(), Vec3::zeros()] {
            let turned = |p: Vec3| Vec3::new(-p.y, p.x, p.z) + Vec3::repeat(2.0);
            let flat = |p: Vec3| p.component_mul(&keep);
            let pairs: Vec<_> = points()
                .into_iter()
                .map(|p| (flat(p), turned(flat(p)), 1.0))
                .collect();
            let found = kabsch(&pairs);
            for (p, q, _) in pairs {
                assert!((found.rotation * p + found.translation.vector - q).norm() < 1e-12);
            }
        }
        assert_eq!(kabsch(&[]), Isometry3::identity());
    }
}
