//! Isotropic tissue that stiffens exponentially with I₁, under plane stress:
//! w = C₀/2 (I₁ − 3) + C₁/2 (e^{C₂ (I₁ − 3)²} − 1) (tricuspid leaflets: Mathur 2022, Engineering with Computers,
//! doi 10.1007/s00366-022-01659-w). With C₁ = 0 it is neo-Hookean with shear modulus C₀.
//!
//! Incompressible, I₁ = c₁₁ + c₂₂ + 1 / det C. Compressible tissue has I₁ J^(−2/3) in its place and (J − 1)² / D besides, and
//! its thickness is what leaves it without stress across: c₃₃ minimises w, and the plane's tangent is what is left when
//! c₃₃ gives way.

use super::{Metric, Response, bounded_exponential};
use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};

/// Constants of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constants {
    /// C₀ [MPa].
    pub c0_mpa: f64,
    /// C₁ [MPa].
    pub c1_mpa: f64,
    /// C₂ [1].
    pub c2: f64,
    /// D, twice the inverse of the bulk modulus [1/MPa]; 0: incompressible.
    pub compressibility_per_mpa: f64,
}

/// Energy, stress and tangent at a metric.
#[inline(always)]
pub fn response(constants: &Constants, metric: &Metric) -> Response {
    if constants.compressibility_per_mpa > 0.0 {
        compressible(constants, metric)
    } else {
        let (invariant, slope, curvature) = first_invariant(metric);
        let [energy, first, second] = of_excess(constants, invariant - 3.0);
        Response {
            energy_mpa: energy,
            slope_mpa: slope * first,
            curvature_mpa: slope * slope.transpose() * second + curvature * first,
        }
    }
}

/// I₁ of incompressible tissue with its first and second derivatives by c₁₁, c₂₂, c₁₂ [1].
#[inline(always)]
pub(super) fn first_invariant(metric: &Metric) -> (f64, Vector3<f64>, Matrix3<f64>) {
    let (determinant, slope) = determinant(metric);
    let [inverse, first, second] = bounded_inverse(determinant);
    let twice = Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -2.0);
    (
        metric[0] + metric[1] + inverse,
        Vector3::new(1.0, 1.0, 0.0) + slope * first,
        slope * slope.transpose() * second + twice * first,
    )
}

/// Tissue squeezed to less than half of its area is not what any of these laws was made for, but a solver on its way comes
/// by: below this square of that the inverse of det C is the parabola that fits it there, and stays finite.
const LEAST_DETERMINANT: f64 = 0.25;

/// 1/d, or its parabola: value, slope, curvature.
#[inline(always)]
fn bounded_inverse(determinant: f64) -> [f64; 3] {
    let below = (determinant - LEAST_DETERMINANT).min(0.0);
    let inverse = 1.0 / determinant.max(LEAST_DETERMINANT);
    let [slope, curvature] = [-inverse * inverse, 2.0 * inverse * inverse * inverse];
    [
        inverse + below * (slope + 0.5 * below * curvature),
        slope + below * curvature,
        curvature,
    ]
}

/// det C and its slope. What has collapsed to a line keeps a little area: 1e-6 of the unloaded.
#[inline(always)]
fn determinant(metric: &Metric) -> (f64, Vector3<f64>) {
    let determinant = metric[0] * metric[1] - metric[2] * metric[2];
    (
        determinant.max(1e-12),
        Vector3::new(metric[1], metric[0], -2.0 * metric[2]),
    )
}

/// w as a function of I₁ − 3: value, slope, curvature [MPa].
#[inline(always)]
fn of_excess(constants: &Constants, excess: f64) -> [f64; 3] {
    let &Constants {
        c0_mpa, c1_mpa, c2, ..
    } = constants;
    let [value, first, second] = bounded_exponential(c2 * excess * excess);
    let slope = 2.0 * c2 * excess;
    [
        0.5 * c0_mpa * excess + 0.5 * c1_mpa * (value - 1.0),
        0.5 * c0_mpa + 0.5 * c1_mpa * first * slope,
        0.5 * c1_mpa * (second * slope * slope + first * 2.0 * c2),
    ]
}

/// With y = (c₁₁, c₂₂, c₁₂, c₃₃): w(y) at the c₃₃ that minimises it, and w′ and w″ by the first three:
/// wₖ, wₖₗ − wₖ₄ wₗ₄ / w₄₄.
#[inline(always)]
fn compressible(constants: &Constants, metric: &Metric) -> Response {
    let (energy_mpa, slope, curvature) = solid(constants, metric, thickness_metric(constants, metric));
    let across: Vector3<f64> = curvature.fixed_view::<3, 1>(0, 3).into_owned();
    let in_plane: Matrix3<f64> = curvature.fixed_view::<3, 3>(0, 0).into_owned();
    Response {
        energy_mpa,
        slope_mpa: slope.xyz(),
        curvature_mpa: in_plane - across * across.transpose() / curvature[(3, 3)],
    }
}

/// Newton's iterations for c₃₃ are so many at most; from the incompressible thickness 3 to 6 are enough.
const ITERATIONS: u32 = 40;
/// Longest change of ln c₃₃ in one of them: e^½ in thickness squared.
const LONGEST_STEP: f64 = 0.5;
/// After a change of ln c₃₃ by less than this the next would be less than its square, which is rounding.
const SOLVED: f64 = 1e-10;

/// c₃₃ without stress across, by Newton's method on its logarithm l. With r = d^(−1/3) and the trace t, both of which go with l,
/// ∂Ī₁/∂l = r (c₃₃ − t/3), ∂²Ī₁/∂l² = r (c₃₃/3 + t/9), and of (J − 1)² / D the slope is J (J − 1) / D, the curvature
/// J (J − ½) / D.
fn thickness_metric(constants: &Constants, metric: &Metric) -> f64 {
    let plane = determinant(metric).0;
    let per_d = 1.0 / constants.compressibility_per_mpa;
    let mut across = 1.0 / plane;
    for _ in 0..ITERATIONS {
        let d = plane * across;
        let (root, volume_ratio) = (1.0 / d.cbrt(), d.sqrt());
        let trace = metric[0] + metric[1] + across;
        let by_logarithm = root * (across - trace / 3.0);
        let [_, first, second] = of_excess(constants, trace * root - 3.0);
        let slope = first * by_logarithm + volume_ratio * (volume_ratio - 1.0) * per_d;
        let curvature = second * by_logarithm * by_logarithm
            + first * root * (across / 3.0 + trace / 9.0)
            + volume_ratio * (volume_ratio - 0.5) * per_d;
        let downhill = -slope / curvature.abs().max(f64::MIN_POSITIVE);
        let step = downhill.clamp(-LONGEST_STEP, LONGEST_STEP);
        // e to the step, to its third power, which does not slow Newton's method down.
        across *= 1.0 + step * (1.0 + 0.5 * step);
        if downhill.abs() < SOLVED {
            break;
        }
    }
    across
}

/// w of a solid and its derivatives by c₁₁, c₂₂, c₁₂, c₃₃.
///
/// d = det C c₃₃ = J²; Ī₁ = (c₁₁ + c₂₂ + c₃₃) d^(−1/3); (J − 1)² / D has the slope (1 − 1/J) / D and the curvature
/// 1 / (2 D J³) by d.
#[inline(always)]
fn solid(constants: &Constants, metric: &Metric, across: f64) -> (f64, Vector4<f64>, Matrix4<f64>) {
    let (plane, by_plane) = determinant(metric);
    let d = plane * across;
    let d_slope = Vector4::new(
        by_plane[0] * across,
        by_plane[1] * across,
        by_plane[2] * across,
        plane,
    );
    #[rustfmt::skip]
    let d_curvature = Matrix4::new(
        0.0, across, 0.0, by_plane[0],
        across, 0.0, 0.0, by_plane[1],
        0.0, 0.0, -2.0 * across, by_plane[2],
        by_plane[0], by_plane[1], by_plane[2], 0.0,
    );
    let trace = metric[0] + metric[1] + across;
    let trace_slope = Vector4::new(1.0, 1.0, 0.0, 1.0);
    let root = 1.0 / d.cbrt();
    let mixed = trace_slope * d_slope.transpose();
    let invariant_slope = trace_slope * root - d_slope * (trace * root / (3.0 * d));
    let invariant_curvature = (mixed + mixed.transpose()) * (-root / (3.0 * d))
        + d_slope * d_slope.transpose() * (4.0 / 9.0 * trace * root / (d * d))
        - d_curvature * (trace * root / (3.0 * d));
    let [energy, first, second] = of_excess(constants, trace * root - 3.0);
    let (volume_ratio, per_d) = (d.sqrt(), 1.0 / constants.compressibility_per_mpa);
    let by_d = (1.0 - 1.0 / volume_ratio) * per_d;
    let twice_by_d = per_d / (2.0 * volume_ratio * d);
    (
        energy + (volume_ratio - 1.0).powi(2) * per_d,
        invariant_slope * first + d_slope * by_d,
        invariant_slope * invariant_slope.transpose() * second
            + invariant_curvature * first
            + d_slope * d_slope.transpose() * twice_by_d
            + d_curvature * by_d,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding is all that the thickness is off, for tissue whose shear modulus is 5e-7 to a quarter of its bulk modulus,
    /// stretched and squeezed.
    #[test]
    fn thickness_leaves_no_stress_across() {
        for compressibility_per_mpa in [1e-3, 20.0, 500.0] {
            let constants = Constants {
                c0_mpa: 0.001,
                c1_mpa: 0.000_124,
                c2: 4.568_202,
                compressibility_per_mpa,
            };
            for metric in [
                Metric::new(1.0, 1.0, 0.0),
                Metric::new(2.4, 0.76, 0.2),
                Metric::new(0.5, 0.6, -0.1),
                Metric::new(4.0, 3.0, 0.0),
            ] {
                let across = thickness_metric(&constants, &metric);
                let (_, slope, curvature) = solid(&constants, &metric, across);
                // How far the thickness itself is off, as a part of it.
                let off = slope[3] / (across * curvature[(3, 3)]);
                assert!(off.abs() < 1e-12, "{compressibility_per_mpa} {metric}: {off:e}");
            }
        }
    }
}
