//! Incompressible tissue with one family of fibres (May-Newman & Yin 1998, J Biomech Eng 120:38):
//! w = c₀ (e^Q − 1), Q = c₁ (I₁ − 3)² + c₂ (α − 1)⁴, α = √c₁₁ the stretch of the fibres, which lie along the first axis,
//! I₁ = c₁₁ + c₂₂ + 1 / det C.
//!
//! Its stiffness in the plane vanishes in the unloaded state, where only contact, bending and the solver's damping hold it.

use super::exponential::first_invariant;
use super::{Metric, Response, bounded_exponential};
use nalgebra::{Matrix3, Vector3};

/// Constants of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constants {
    /// c₀ [MPa].
    pub c0_mpa: f64,
    /// c₁, of all directions [1].
    pub c1: f64,
    /// c₂, of the fibres [1].
    pub c2: f64,
}

/// Porcine anterior mitral leaflet (May-Newman & Yin 1998), as often quoted; not checked by us against the paper.
pub const ANTERIOR: Constants = Constants {
    c0_mpa: 0.399e-3,
    c1: 4.325,
    c2: 1446.5,
};

/// Porcine posterior mitral leaflet, likewise.
pub const POSTERIOR: Constants = Constants {
    c0_mpa: 0.414e-3,
    c1: 4.848,
    c2: 305.4,
};

/// Energy, stress and tangent at a metric.
#[inline(always)]
pub fn response(constants: &Constants, metric: &Metric) -> Response {
    let (invariant, invariant_slope, invariant_curvature) = first_invariant(metric);
    let excess = invariant - 3.0;
    let stretch = metric[0].sqrt();
    let longer = stretch - 1.0;
    let [c1, c2] = [constants.c1, constants.c2];
    let exponent = c1 * excess * excess + c2 * longer.powi(4);
    // ∂α/∂c₁₁ = 1 / 2α, ∂²α/∂c₁₁² = −1 / 4α³.
    let fibre_slope = 4.0 * c2 * longer.powi(3);
    let fibre_curvature =
        12.0 * c2 * longer.powi(2) / (4.0 * metric[0]) - fibre_slope / (4.0 * stretch * metric[0]);
    let mut slope = invariant_slope * (2.0 * c1 * excess);
    slope[0] += fibre_slope / (2.0 * stretch);
    let mut curvature: Matrix3<f64> = invariant_slope * invariant_slope.transpose() * (2.0 * c1)
        + invariant_curvature * (2.0 * c1 * excess);
    curvature[(0, 0)] += fibre_curvature;
    let [value, first, second] = bounded_exponential(exponent);
    let slope_of_energy: Vector3<f64> = slope * (constants.c0_mpa * first);
    Response {
        energy_mpa: constants.c0_mpa * (value - 1.0),
        slope_mpa: slope_of_energy,
        curvature_mpa: (slope * slope.transpose() * second + curvature * first) * constants.c0_mpa,
    }
}
