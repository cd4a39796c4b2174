//! Leaflets as membranes: triangles of constant strain under a hyperelastic law, exact for their mesh.
//!
//! With F the deformation gradient of a triangle (two columns in space, one for each axis of its unloaded plane), all that
//! a law sees is the metric `C = FᵀF`: c₁₁, c₂₂, c₁₂. It answers with the energy per unloaded volume and its first and second
//! derivatives by these three ([`Response`]); the rest is the same for all laws. One file per law:
//!
//! * [`st_venant_kirchhoff`]: linear in Green's strain (paper 002). On triangles it is the same as Delingette's triangular
//!   biquadratic springs, to rounding.
//! * [`exponential`]: soft, then stiffening with I₁; neo-Hookean where its exponential is left out.
//! * [`may_newman`]: the same for tissue with fibres.
//!
//! [`tension_field`] makes a law of any of them that carries no compression: the tissue wrinkles finer than the mesh.
//!
//! Laws are `#[inline(always)]`: where only energy or stress is wanted the compiler then leaves out the second derivatives,
//! and each law is written once. Without it a gradient costs as much as three quarters of a Hessian.

pub mod exponential;
pub mod may_newman;
pub mod st_venant_kirchhoff;
pub mod tension_field;

use super::BlockSink;
use crate::{Mat3, Vec3};
use nalgebra::{Matrix2, Matrix3, Vector3};

/// The metric of the stretched tissue over the unloaded one: c₁₁, c₂₂, c₁₂ [1].
pub type Metric = Vector3<f64>;

/// The metric of unloaded tissue.
pub const UNLOADED: Metric = Metric::new(1.0, 1.0, 0.0);

/// What a law answers to a metric.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// Energy per unloaded volume [MPa].
    pub energy_mpa: f64,
    /// Its derivatives by c₁₁, c₂₂ and c₁₂ [MPa]: half the second Piola-Kirchhoff stresses S₁₁ and S₂₂, and S₁₂ (c₁₂ stands
    /// for c₂₁ too).
    pub slope_mpa: Vector3<f64>,
    /// Its second derivatives [MPa].
    pub curvature_mpa: Matrix3<f64>,
}

/// A stress-strain law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// See [`st_venant_kirchhoff`].
    StVenantKirchhoff(st_venant_kirchhoff::Constants),
    /// See [`exponential`].
    Exponential(exponential::Constants),
    /// See [`may_newman`]; fibres lie along the first axis.
    MayNewman(may_newman::Constants),
}

impl Law {
    /// Energy, stress and tangent at a metric.
    #[inline(always)]
    pub fn response(&self, metric: &Metric) -> Response {
        match self {
            Self::StVenantKirchhoff(constants) => st_venant_kirchhoff::response(constants, metric),
            Self::Exponential(constants) => exponential::response(constants, metric),
            Self::MayNewman(constants) => may_newman::response(constants, metric),
        }
    }
}

/// Tissue of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tissue {
    /// Its law.
    pub law: Law,
    /// Whether it wrinkles finer than the mesh instead of carrying compression.
    pub wrinkles: bool,
}

impl Tissue {
    /// Energy, stress and tangent at a metric.
    #[inline(always)]
    pub fn response(&self, metric: &Metric) -> Response {
        if self.wrinkles {
            tension_field::response(&self.law, metric)
        } else {
            self.law.response(metric)
        }
    }
}

/// Triangles of membrane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Membranes {
    /// Corners, shape `[triangle]`.
    pub corners: Vec<[u32; 3]>,
    /// Which of `tissues` each is made of, shape `[triangle]`.
    pub tissue: Vec<u32>,
    /// The kinds of tissue.
    pub tissues: Vec<Tissue>,
    /// Unloaded volume: area times thickness [mm³], shape `[triangle]`.
    pub volume_mm3: Vec<f64>,
    /// How the axes of the unloaded plane go with the sides from the first corner to the second and third [1/mm], the first
    /// axis along the fibres where the law has any: F = [x₂ − x₁, x₃ − x₁] times this. Shape `[triangle]`.
    pub inverse_rest_per_mm: Vec<Matrix2<f64>>,
}

impl Membranes {
    /// Adds a triangle; `fibre` points about along its first axis, any length, and is laid into its plane.
    ///
    /// Where the fibre stands on the triangle its first side is the axis; one without area takes the fibre as it is.
    pub fn push(&mut self, corners: [u32; 3], tissue: u32, thickness_mm: f64, rest_mm: &[Vec3], fibre: Vec3) {
        let [a, b, c] = corners.map(|corner| rest_mm[corner as usize]);
        let (side, other) = (b - a, c - a);
        let normal = side.cross(&other);
        let unit = normal.try_normalize(0.0).unwrap_or_default();
        let laid = fibre - unit * fibre.dot(&unit);
        let first = laid
            .try_normalize(1e-6 * fibre.norm())
            .unwrap_or_else(|| side.normalize());
        let second = unit.cross(&first);
        let rest = Matrix2::new(
            side.dot(&first),
            other.dot(&first),
            side.dot(&second),
            other.dot(&second),
        );
        self.corners.push(corners);
        self.tissue.push(tissue);
        self.volume_mm3.push(0.5 * normal.norm() * thickness_mm);
        self.inverse_rest_per_mm
            .push(rest.try_inverse().unwrap_or_default());
    }

    /// The metric of each triangle [1], shape `[triangle]`.
    pub fn metrics(&self, positions_mm: &[Vec3]) -> Vec<Metric> {
        let all = 0..self.corners.len();
        all.map(|index| self.stretched(index, positions_mm).metric())
            .collect()
    }

    #[inline(always)]
    fn stretched(&self, index: usize, positions_mm: &[Vec3]) -> Stretched {
        let [a, b, c] = self.corners[index].map(|corner| positions_mm[corner as usize]);
        let inverse = &self.inverse_rest_per_mm[index];
        let (side, other) = (b - a, c - a);
        let [second, third] = [0, 1].map(|row| [inverse[(row, 0)], inverse[(row, 1)]]);
        Stretched {
            columns: [0, 1].map(|axis| side * second[axis] + other * third[axis]),
            shares: [[-second[0] - third[0], -second[1] - third[1]], second, third],
        }
    }

    #[inline(always)]
    fn response(&self, index: usize, metric: &Metric) -> Response {
        self.tissues[self.tissue[index] as usize].response(metric)
    }
}

/// A triangle's deformation gradient.
struct Stretched {
    /// f₁ and f₂, the columns of F [1].
    columns: [Vec3; 2],
    /// ∂fᵢ/∂x of each corner: a multiple of the identity [1/mm].
    shares: [[f64; 2]; 3],
}

impl Stretched {
    fn metric(&self) -> Metric {
        let [first, second] = &self.columns;
        Metric::new(first.norm_squared(), second.norm_squared(), first.dot(second))
    }

    /// ∂(c₁₁, c₂₂, c₁₂)/∂x of a corner [1/mm]: 2 b₁ f₁, 2 b₂ f₂, b₂ f₁ + b₁ f₂.
    fn metric_slopes(&self, corner: usize) -> [Vec3; 3] {
        let [first, second] = &self.columns;
        let [b1, b2] = self.shares[corner];
        [first * (2.0 * b1), second * (2.0 * b2), first * b2 + second * b1]
    }
}

/// Elastic energy of all triangles [N·mm].
pub fn energy(membranes: &Membranes, positions_mm: &[Vec3]) -> f64 {
    (0..membranes.corners.len())
        .map(|index| {
            let metric = membranes.stretched(index, positions_mm).metric();
            membranes.volume_mm3[index] * membranes.response(index, &metric).energy_mpa
        })
        .sum()
}

/// Adds the gradient of the energy [N], shape `[vertex]`.
pub fn add_gradient(membranes: &Membranes, positions_mm: &[Vec3], gradient_n: &mut [Vec3]) {
    for (index, corners) in membranes.corners.iter().enumerate() {
        let stretched = membranes.stretched(index, positions_mm);
        let response = membranes.response(index, &stretched.metric());
        let slope = response.slope_mpa * membranes.volume_mm3[index];
        for (corner, &vertex) in corners.iter().enumerate() {
            let [by_11, by_22, by_12] = stretched.metric_slopes(corner);
            gradient_n[vertex as usize] += by_11 * slope[0] + by_22 * slope[1] + by_12 * slope[2];
        }
    }
}

/// Adds the Hessian of the energy: for corners with metric slopes g and shares b,
/// Σ wₖₗ gₖ gₗᵀ + (2 w₁ b₁ b₁ + 2 w₂ b₂ b₂ + w₃ (b₁ b₂ + b₂ b₁)) I.
pub fn add_hessian(membranes: &Membranes, positions_mm: &[Vec3], sink: &mut impl BlockSink) {
    for (index, corners) in membranes.corners.iter().enumerate() {
        let stretched = membranes.stretched(index, positions_mm);
        let response = membranes.response(index, &stretched.metric());
        let slope = response.slope_mpa * membranes.volume_mm3[index];
        let curvature = response.curvature_mpa * membranes.volume_mm3[index];
        let slopes = [0, 1, 2].map(|corner| Mat3::from_columns(&stretched.metric_slopes(corner)));
        for i in 0..3 {
            let by_metric = slopes[i] * curvature;
            for j in i..3 {
                let ([a1, a2], [b1, b2]) = (stretched.shares[i], stretched.shares[j]);
                let sideways =
                    2.0 * (slope[0] * a1 * b1 + slope[1] * a2 * b2) + slope[2] * (a1 * b2 + a2 * b1);
                let block = by_metric * slopes[j].transpose() + Mat3::from_diagonal_element(sideways);
                sink.add(corners[i], corners[j], &block);
            }
        }
    }
}

/// The exponential function up to [`MOST_EXPONENT`], and from there on the parabola that fits its value, slope and
/// curvature: value, slope, curvature [1]. Convex, and smooth to the second derivative.
#[inline(always)]
pub(crate) fn bounded_exponential(exponent: f64) -> [f64; 3] {
    let beyond = (exponent - MOST_EXPONENT).max(0.0);
    let value = exponent.min(MOST_EXPONENT).exp();
    [
        value * (1.0 + beyond + 0.5 * beyond * beyond),
        value * (1.0 + beyond),
        value,
    ]
}

/// Tissue at work reaches exponents of 2 to 5. A solver on its way strays beyond, where e^Q makes walls that it cannot see
/// over; at 8 the stresses are ten times those at work. At 5 the parabola would begin to be seen.
pub(crate) const MOST_EXPONENT: f64 = 8.0;
