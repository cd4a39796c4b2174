//! Energy, gradient and Hessian of the pairs that touch.

use super::pairs::Pair;
use super::touch::{EDGE_SIGNS, Fade, Slide, Touch};
use crate::energy::{BlockSink, Curvature};
use crate::{Mat3, Vec3};

/// Below this s the law goes on as a parabola [1]: the force is then 840 times the systolic pressure, and a steeper one
/// would only cost iterations.
const PARABOLA_BELOW: f64 = 0.2;

/// The penalty per unit of area at distance d and its first two derivatives in d: [N/mm], [MPa], [MPa/mm].
///
/// ```text
/// s   =  (d − d₀)/δ,  δ = d̂ − d₀
/// ψ   =  κ δ (1−s)³/s
/// ψ'  = −κ [3(1−s)²/s + (1−s)³/s²]
/// ψ'' =  κ/δ [6(1−s)/s + 6(1−s)²/s² + 2(1−s)³/s³]
/// ```
pub fn penalty(distance_mm: f64, activation_mm: f64, rigid_mm: f64, stiffness_mpa: f64) -> [f64; 3] {
    let band_mm = activation_mm - rigid_mm;
    let s = (distance_mm - rigid_mm) / band_mm;
    if s >= 1.0 {
        return [0.0; 3];
    }
    let at = s.max(PARABOLA_BELOW);
    let (gap, ratio) = (1.0 - at, (1.0 - at) / at);
    let value = stiffness_mpa * band_mm * gap * gap * ratio;
    let slope = -stiffness_mpa * (3.0 * gap * ratio + gap * ratio * ratio);
    let curvature =
        stiffness_mpa / band_mm * (6.0 * ratio + 6.0 * ratio * ratio + 2.0 * ratio * ratio * ratio);
    let beyond_mm = (s - at) * band_mm;
    [
        value + (slope + 0.5 * curvature * beyond_mm) * beyond_mm,
        slope + curvature * beyond_mm,
        curvature,
    ]
}

/// Contact energy of the pairs that touch [N·mm].
pub fn energy(touches: &[Touch], stiffness_mpa: f64, positions_mm: &[Vec3]) -> f64 {
    let share = |touch: &Touch| share_of(touch.fade(positions_mm).as_ref());
    touches
        .iter()
        .map(|touch| share(touch) * penalty_of(touch, stiffness_mpa)[0])
        .sum()
}

/// Adds the gradient of the contact energy [N], shape `[vertex]`.
pub fn add_gradient(touches: &[Touch], stiffness_mpa: f64, positions_mm: &[Vec3], gradient_n: &mut [Vec3]) {
    for touch in touches {
        let [value, slope, _] = penalty_of(touch, stiffness_mpa);
        let fade = touch.fade(positions_mm);
        let along = touch.direction * (share_of(fade.as_ref()) * slope);
        for (&vertex, weight) in touch.pair.vertices.iter().zip(touch.nearest.weights) {
            gradient_n[vertex as usize] += along * weight;
        }
        if let Some(fade) = fade {
            for (k, &vertex) in touch.pair.vertices.iter().enumerate() {
                gradient_n[vertex as usize] += fade.gradient(k) * (value * fade.slope);
            }
        }
    }
}

/// Adds the Hessian of the contact energy. Blocks of vertices that do not share the closest points are zero and left out.
pub fn add_hessian(
    touches: &[Touch],
    stiffness_mpa: f64,
    positions_mm: &[Vec3],
    curvature: Curvature,
    sink: &mut impl BlockSink,
) {
    for touch in touches {
        match curvature {
            Curvature::Exact => add_exact(touch, stiffness_mpa, positions_mm, sink),
            Curvature::Projected => add_projected(touch, stiffness_mpa, positions_mm, sink),
        }
    }
}

/// [`penalty`] on the area that a pair stands for, without fading: [N·mm], [N], [N/mm].
#[inline]
fn penalty_of(touch: &Touch, stiffness_mpa: f64) -> [f64; 3] {
    let Pair {
        activation_mm,
        rigid_mm,
        area_mm2,
        ..
    } = touch.pair;
    penalty(touch.distance_mm, activation_mm, rigid_mm, stiffness_mpa).map(|value| value * area_mm2)
}

/// What is left of a pair after fading [1].
fn share_of(fade: Option<&Fade>) -> f64 {
    fade.map_or(1.0, |fade| fade.value)
}

/// ∇²(m ψ) = m (ψ'' ∇d∇dᵀ + ψ' ∇²d) + ψ' m' (∇d∇cᵀ + ∇c∇dᵀ) + ψ (m'' ∇c∇cᵀ + m' ∇²c), times the area.
///
/// ∇d = wᵢ n. With D = ½ r·r and r = Σ wᵢ(b) xᵢ minimised over the free parameters b:
///
/// ```text
/// e_k = ∂r/∂b_k,  u_k = ∂w/∂b_k, chosen so that the e_k are orthogonal
/// ∇²D = wᵢ wⱼ I − Σ_k (wᵢ e_k + u_ki r) (wⱼ e_k + u_kj r)ᵀ / (e_k·e_k)
/// ∇²d = (∇²D − wᵢ wⱼ n nᵀ) / d
/// ```
fn add_exact(touch: &Touch, stiffness_mpa: f64, positions_mm: &[Vec3], sink: &mut impl BlockSink) {
    let penalty = penalty_of(touch, stiffness_mpa);
    let fade = touch.fade(positions_mm);
    let [_, slope, curvature] = penalty.map(|value| value * share_of(fade.as_ref()));
    let (n, across) = (&touch.direction, slope / touch.distance_mm);
    let base = n * n.transpose() * (curvature - across) + Mat3::from_diagonal_element(across);
    let parameters = touch.pair.parameters(&touch.nearest);
    let [first, mut second] = parameters.directions;
    match parameters.count {
        0 => add_blocks(touch, &base, across, [], sink),
        1 => {
            let slide = touch.slide(&first, &touch.sliding(&first, positions_mm));
            add_blocks(touch, &base, across, [slide], sink);
        }
        _ => {
            let (e, mut f) = (
                touch.sliding(&first, positions_mm),
                touch.sliding(&second, positions_mm),
            );
            let (squared, part) = (f.norm_squared(), e.dot(&f) / e.norm_squared());
            f -= e * part;
            (0..4).for_each(|i| second[i] -= first[i] * part);
            let slide = touch.slide(&first, &e);
            // Parallel slides are one; a pair of edges has faded out there.
            if f.norm_squared() > 1e-12 * squared {
                let slides = [slide, touch.slide(&second, &f)];
                add_blocks(touch, &base, across, slides, sink);
            } else {
                add_blocks(touch, &base, across, [slide], sink);
            }
        }
    }
    if let Some(fade) = fade {
        add_fading(touch, &fade, penalty, sink);
    }
}

/// wᵢ wⱼ times the base, less what sliding takes off; u is zero where w is.
#[inline]
fn add_blocks<const COUNT: usize>(
    touch: &Touch,
    base: &Mat3,
    across: f64,
    slides: [Slide; COUNT],
    sink: &mut impl BlockSink,
) {
    let (w, vertices) = (&touch.nearest.weights, &touch.pair.vertices);
    let scaled = slides
        .each_ref()
        .map(|slide| slide.mixed.map(|b| b * (across * slide.inverse)));
    for i in (0..4).filter(|&i| w[i] != 0.0) {
        let row = base * w[i];
        for j in (i..4).filter(|&j| w[j] != 0.0) {
            let mut block = row * w[j];
            for (slide, scaled) in slides.iter().zip(&scaled) {
                block -= slide.mixed[i] * scaled[j].transpose();
            }
            sink.add(vertices[i], vertices[j], &block);
        }
    }
}

/// What the derivatives of m add to the Hessian of a pair that fades.
#[cold]
fn add_fading(touch: &Touch, fade: &Fade, [value, slope, _]: [f64; 3], sink: &mut impl BlockSink) {
    let [g, h] = &fade.by_edges;
    let [uu, uv, vv] = fade.cross_hessian().map(|block| block * (value * fade.slope));
    let twice = value * fade.curvature;
    let of_edges = [
        uu + g * g.transpose() * twice,
        uv + g * h.transpose() * twice,
        vv + h * h.transpose() * twice,
    ];
    let (w, vertices) = (&touch.nearest.weights, &touch.pair.vertices);
    let n = touch.direction * (slope * fade.slope);
    for i in 0..4 {
        for j in i..4 {
            let block = of_edges[i / 2 + j / 2] * (EDGE_SIGNS[i] * EDGE_SIGNS[j])
                + n * fade.gradient(j).transpose() * w[i]
                + fade.gradient(i) * n.transpose() * w[j];
            sink.add(vertices[i], vertices[j], &block);
        }
    }
}

/// The part that resists approach: m ψ'' ∇d∇dᵀ, never negative.
fn add_projected(touch: &Touch, stiffness_mpa: f64, positions_mm: &[Vec3], sink: &mut impl BlockSink) {
    let [_, _, curvature] = penalty_of(touch, stiffness_mpa);
    let n = &touch.direction;
    let base = n * n.transpose() * (share_of(touch.fade(positions_mm).as_ref()) * curvature);
    add_blocks(touch, &base, 0.0, [], sink);
}

#[cfg(test)]
mod tests;
