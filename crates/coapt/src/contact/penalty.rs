//! Energy, gradient and Hessian of the near pairs.

use super::nearest::Nearest;
use super::pairs::{Pair, PairKind, corners};
use crate::energy::{BlockSink, Curvature};
use crate::{Mat3, Vec3};

/// The penalty per unit of area at distance d and its first two derivatives in d: [N/mm], [MPa], [MPa/mm].
///
/// ```text
/// s   =  d/d̂
/// ψ   =  κ d̂ (1−s)³/s
/// ψ'  = −κ [3(1−s)²/s + (1−s)³/s²]
/// ψ'' =  κ/d̂ [6(1−s)/s + 6(1−s)²/s² + 2(1−s)³/s³]
/// ```
pub fn penalty(distance_mm: f64, activation_mm: f64, stiffness_mpa: f64) -> [f64; 3] {
    let s = distance_mm / activation_mm;
    if s >= 1.0 {
        return [0.0; 3];
    }
    let (gap, ratio) = (1.0 - s, (1.0 - s) / s);
    [
        stiffness_mpa * activation_mm * gap * gap * ratio,
        -stiffness_mpa * (3.0 * gap * ratio + gap * ratio * ratio),
        stiffness_mpa / activation_mm * (6.0 * ratio + 6.0 * ratio * ratio + 2.0 * ratio * ratio * ratio),
    ]
}

/// Contact energy of all pairs [N·mm].
pub fn energy(pairs: &[Pair], stiffness_mpa: f64, positions_mm: &[Vec3]) -> f64 {
    pairs
        .iter()
        .filter_map(|pair| active(pair, positions_mm))
        .map(|touch| {
            let fade = touch.fade();
            touch.pair.area_mm2
                * fade.value
                * penalty(touch.distance_mm, touch.pair.activation_mm, stiffness_mpa)[0]
        })
        .sum()
}

/// Adds the gradient of the contact energy [N], shape `[vertex]`.
pub fn add_gradient(pairs: &[Pair], stiffness_mpa: f64, positions_mm: &[Vec3], gradient_n: &mut [Vec3]) {
    for touch in pairs.iter().filter_map(|pair| active(pair, positions_mm)) {
        let [value, slope, _] = penalty(touch.distance_mm, touch.pair.activation_mm, stiffness_mpa);
        let fade = touch.fade();
        let area = touch.pair.area_mm2;
        let along = touch.direction() * (area * fade.value * slope);
        for (k, &vertex) in touch.pair.vertices.iter().enumerate() {
            gradient_n[vertex as usize] +=
                along * touch.nearest.weights[k] + fade.gradient[k] * (area * value * fade.slope);
        }
    }
}

/// Adds the Hessian of the contact energy.
pub fn add_hessian(
    pairs: &[Pair],
    stiffness_mpa: f64,
    positions_mm: &[Vec3],
    curvature: Curvature,
    sink: &mut impl BlockSink,
) {
    for touch in pairs.iter().filter_map(|pair| active(pair, positions_mm)) {
        let blocks = match curvature {
            Curvature::Exact => exact_blocks(&touch, stiffness_mpa),
            Curvature::Projected => projected_blocks(&touch, stiffness_mpa),
        };
        for (i, row) in blocks.iter().enumerate() {
            for (j, block) in row.iter().enumerate().skip(i) {
                sink.add(touch.pair.vertices[i], touch.pair.vertices[j], block);
            }
        }
    }
}

/// A pair within its activation distance.
struct Touch<'a> {
    pair: &'a Pair,
    corners: [Vec3; 4],
    nearest: Nearest,
    distance_mm: f64,
}

fn active<'a>(pair: &'a Pair, positions_mm: &[Vec3]) -> Option<Touch<'a>> {
    let corners = corners(&pair.vertices, positions_mm);
    // Boxes first: most listed pairs are apart.
    let nearest = pair.nearest(positions_mm);
    let distance_mm = nearest.separation_mm.norm();
    (distance_mm < pair.activation_mm).then_some(Touch {
        pair,
        corners,
        nearest,
        distance_mm,
    })
}

/// The factor that fades near-parallel edges out, with its slope in c = |u × v|² and the gradient of c.
struct Fade {
    value: f64,
    slope: f64,
    curvature: f64,
    gradient: [Vec3; 4],
}

impl Touch<'_> {
    fn direction(&self) -> Vec3 {
        self.nearest.separation_mm / self.distance_mm
    }

    fn edges(&self) -> (Vec3, Vec3) {
        (
            self.corners[1] - self.corners[0],
            self.corners[3] - self.corners[2],
        )
    }

    /// m(c) = (c/ε)(2 − c/ε) below the limit ε, 1 above (Li et al. 2020, eq. 24).
    fn fade(&self) -> Fade {
        let full = Fade {
            value: 1.0,
            slope: 0.0,
            curvature: 0.0,
            gradient: [Vec3::zeros(); 4],
        };
        if self.pair.kind == PairKind::PointTriangle {
            return full;
        }
        let limit = self.pair.parallel_limit_mm4;
        let (u, v) = self.edges();
        let c = u.cross(&v).norm_squared();
        if c >= limit {
            return full;
        }
        let by_u = (u * v.norm_squared() - v * u.dot(&v)) * 2.0;
        let by_v = (v * u.norm_squared() - u * u.dot(&v)) * 2.0;
        Fade {
            value: c / limit * (2.0 - c / limit),
            slope: 2.0 / limit * (1.0 - c / limit),
            curvature: -2.0 / (limit * limit),
            gradient: [-by_u, by_u, -by_v, by_v],
        }
    }

    /// Second derivative of c = |u × v|² by the four vertices [mm²].
    fn cross_hessian(&self, i: usize, j: usize) -> Mat3 {
        let (u, v) = self.edges();
        let sign = if (i + j).is_multiple_of(2) { 2.0 } else { -2.0 };
        let block = match (i / 2, j / 2) {
            (0, 0) => Mat3::from_diagonal_element(v.norm_squared()) - v * v.transpose(),
            (1, 1) => Mat3::from_diagonal_element(u.norm_squared()) - u * u.transpose(),
            (0, _) => u * v.transpose() * 2.0 - v * u.transpose() - Mat3::from_diagonal_element(u.dot(&v)),
            _ => v * u.transpose() * 2.0 - u * v.transpose() - Mat3::from_diagonal_element(u.dot(&v)),
        };
        block * sign
    }

    /// Second derivative of the distance d by the four vertices [1/mm].
    ///
    /// With D = ½ r·r and r = Σ wᵢ(b) xᵢ minimised over the free parameters b:
    ///
    /// ```text
    /// e_k = ∂r/∂b_k,  u_k = ∂w/∂b_k
    /// H_D = wᵢ wⱼ I − Σ_kl (wᵢ e_k + u_ki r) (e·e)⁻¹_kl (wⱼ e_l + u_lj r)ᵀ
    /// H_d = (H_D − wᵢ wⱼ n nᵀ) / d
    /// ```
    fn distance_hessian(&self) -> [[Mat3; 4]; 4] {
        let (w, r, n) = (self.nearest.weights, self.nearest.separation_mm, self.direction());
        let parameters = &self.nearest.parameters;
        let count = parameters.count;
        let u = &parameters.directions;
        let mut e = [Vec3::zeros(); 2];
        for k in 0..count {
            e[k] = (1..4)
                .map(|i| (self.corners[i] - self.corners[0]) * u[k][i])
                .sum();
        }
        let inverse = inverse_gram(&e, count);
        let flat = Mat3::identity() - n * n.transpose();
        let mixed: [[Vec3; 4]; 2] =
            std::array::from_fn(|k| std::array::from_fn(|i| e[k] * w[i] + r * u[k][i]));
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let mut block = flat * (w[i] * w[j]);
                for k in 0..count {
                    for l in 0..count {
                        block -= mixed[k][i] * mixed[l][j].transpose() * inverse[k][l];
                    }
                }
                block / self.distance_mm
            })
        })
    }
}

/// Inverse of the 0×0, 1×1 or 2×2 matrix of scalar products; zero where the vectors are parallel, which is
/// where the pair has faded out.
fn inverse_gram(e: &[Vec3; 2], count: usize) -> [[f64; 2]; 2] {
    let (a, b, d) = (e[0].norm_squared(), e[0].dot(&e[1]), e[1].norm_squared());
    match count {
        1 if a > 0.0 => [[1.0 / a, 0.0], [0.0, 0.0]],
        2 if a * d - b * b > 1e-12 * a * d => {
            let determinant = a * d - b * b;
            [
                [d / determinant, -b / determinant],
                [-b / determinant, a / determinant],
            ]
        }
        _ => [[0.0; 2]; 2],
    }
}

/// ∇²(m ψ) = m (ψ'' ∇d∇dᵀ + ψ' ∇²d) + ψ' m' (∇d∇cᵀ + ∇c∇dᵀ) + ψ (m'' ∇c∇cᵀ + m' ∇²c), times the area.
fn exact_blocks(touch: &Touch, stiffness_mpa: f64) -> [[Mat3; 4]; 4] {
    let [value, slope, curvature] = penalty(touch.distance_mm, touch.pair.activation_mm, stiffness_mpa);
    let fade = touch.fade();
    let n = touch.direction();
    let by_d: [Vec3; 4] = touch.nearest.weights.map(|weight| n * weight);
    let of_d = touch.distance_hessian();
    let area = touch.pair.area_mm2;
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let mut block = (by_d[i] * by_d[j].transpose() * curvature + of_d[i][j] * slope) * fade.value;
            if fade.slope != 0.0 {
                let (ci, cj) = (fade.gradient[i], fade.gradient[j]);
                block += (by_d[i] * cj.transpose() + ci * by_d[j].transpose()) * (slope * fade.slope);
                block +=
                    (ci * cj.transpose() * fade.curvature + touch.cross_hessian(i, j) * fade.slope) * value;
            }
            block * area
        })
    })
}

/// The part that resists approach: m ψ'' ∇d∇dᵀ, never negative.
fn projected_blocks(touch: &Touch, stiffness_mpa: f64) -> [[Mat3; 4]; 4] {
    let [_, _, curvature] = penalty(touch.distance_mm, touch.pair.activation_mm, stiffness_mpa);
    let n = touch.direction();
    let stiffness = n * n.transpose() * (touch.pair.area_mm2 * touch.fade().value * curvature);
    let w = touch.nearest.weights;
    std::array::from_fn(|i| std::array::from_fn(|j| stiffness * (w[i] * w[j])))
}
