//! St. Venant-Kirchhoff under plane stress: stress linear in Green's strain G = (C − I) / 2,
//! w = λ/2 (tr G)² + μ tr G², λ = E ν / (1 − ν²), μ = E / (2 (1 + ν)) (paper 002: E 0.4 MPa anterior, 0.1 posterior, ν 0.5).
//!
//! The thickness, which the strain does not see, is taken as unloaded. Under strong compression the law softens and can
//! collapse; let such tissue wrinkle ([`super::tension_field`]).

use super::{Metric, Response};
use nalgebra::{Matrix3, Vector3};

/// Constants of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constants {
    /// Young's modulus E at small strain [MPa].
    pub modulus_mpa: f64,
    /// Poisson's ratio ν in the plane [1], above −1 and below 1.
    pub poisson_ratio: f64,
}

/// Energy, stress and tangent at a metric.
#[inline(always)]
pub fn response(constants: &Constants, metric: &Metric) -> Response {
    let &Constants {
        modulus_mpa,
        poisson_ratio,
    } = constants;
    let lambda = modulus_mpa * poisson_ratio / (1.0 - poisson_ratio * poisson_ratio);
    let mu = modulus_mpa / (2.0 * (1.0 + poisson_ratio));
    let [g11, g22, g12] = [(metric[0] - 1.0) / 2.0, (metric[1] - 1.0) / 2.0, metric[2] / 2.0];
    let trace = g11 + g22;
    let direct = lambda / 4.0 + mu / 2.0;
    Response {
        energy_mpa: 0.5 * lambda * trace * trace + mu * (g11 * g11 + g22 * g22 + 2.0 * g12 * g12),
        slope_mpa: Vector3::new(
            0.5 * lambda * trace + mu * g11,
            0.5 * lambda * trace + mu * g22,
            2.0 * mu * g12,
        ),
        curvature_mpa: Matrix3::new(direct, lambda / 4.0, 0.0, lambda / 4.0, direct, 0.0, 0.0, 0.0, mu),
    }
}
