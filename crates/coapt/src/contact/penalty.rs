//! Energy, gradient and Hessian of the near pairs.

use super::nearest::Nearest;
use super::pairs::{Pair, PairKind, corners};
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

/// Contact energy of all pairs [N·mm].
pub fn energy(pairs: &[Pair], stiffness_mpa: f64, positions_mm: &[Vec3]) -> f64 {
    let touches = pairs.iter().filter_map(|pair| active(pair, positions_mm));
    touches
        .map(|touch| share_of(touch.fade().as_ref()) * touch.penalty(stiffness_mpa)[0])
        .sum()
}

/// Adds the gradient of the contact energy [N], shape `[vertex]`.
pub fn add_gradient(pairs: &[Pair], stiffness_mpa: f64, positions_mm: &[Vec3], gradient_n: &mut [Vec3]) {
    for pair in pairs {
        let Some(touch) = active(pair, positions_mm) else {
            continue;
        };
        let [value, slope, _] = touch.penalty(stiffness_mpa);
        let fade = touch.fade();
        let along = touch.direction * (share_of(fade.as_ref()) * slope);
        for (&vertex, weight) in pair.vertices.iter().zip(touch.nearest.weights) {
            gradient_n[vertex as usize] += along * weight;
        }
        if let Some(fade) = fade {
            for (k, &vertex) in pair.vertices.iter().enumerate() {
                gradient_n[vertex as usize] += fade.gradient(k) * (value * fade.slope);
            }
        }
    }
}

/// Adds the Hessian of the contact energy. Blocks of vertices that do not share the closest points are zero and left out.
pub fn add_hessian(
    pairs: &[Pair],
    stiffness_mpa: f64,
    positions_mm: &[Vec3],
    curvature: Curvature,
    sink: &mut impl BlockSink,
) {
    let mut blocks = [Mat3::zeros(); PLACES.len()];
    for pair in pairs {
        let Some(touch) = active(pair, positions_mm) else {
            continue;
        };
        let moves = match curvature {
            Curvature::Exact => exact_blocks(&touch, stiffness_mpa, &mut blocks),
            Curvature::Projected => projected_blocks(&touch, stiffness_mpa, &mut blocks),
        };
        for (block, [i, j]) in blocks.iter().zip(PLACES) {
            if moves[i] && moves[j] {
                sink.add(pair.vertices[i], pair.vertices[j], block);
            }
        }
    }
}

/// The blocks of a pair: row, column.
const PLACES: [[usize; 2]; 10] = [
    [0, 0],
    [0, 1],
    [0, 2],
    [0, 3],
    [1, 1],
    [1, 2],
    [1, 3],
    [2, 2],
    [2, 3],
    [3, 3],
];

/// A block for each of [`PLACES`].
type Blocks = [Mat3; PLACES.len()];

/// A pair within its activation distance.
struct Touch<'a> {
    pair: &'a Pair,
    positions_mm: &'a [Vec3],
    nearest: Nearest,
    distance_mm: f64,
    /// n = r / d, from the second part to the first.
    direction: Vec3,
}

#[inline]
fn active<'a>(pair: &'a Pair, positions_mm: &'a [Vec3]) -> Option<Touch<'a>> {
    let nearest = pair.nearest(positions_mm);
    let squared = nearest.separation_mm.norm_squared();
    if squared >= pair.activation_mm * pair.activation_mm {
        return None;
    }
    let distance_mm = squared.sqrt();
    Some(Touch {
        pair,
        positions_mm,
        nearest,
        distance_mm,
        direction: nearest.separation_mm * (1.0 / distance_mm),
    })
}

/// The factor m(c) that fades near-parallel edges out, with its first two derivatives in c = |u × v|².
struct Fade {
    value: f64,
    slope: f64,
    curvature: f64,
    /// The edges u and v [mm].
    edges: [Vec3; 2],
    /// Derivatives of c by u and by v [mm³].
    by_edges: [Vec3; 2],
}

/// What is left of a pair after fading [1].
fn share_of(fade: Option<&Fade>) -> f64 {
    fade.map_or(1.0, |fade| fade.value)
}

/// Whether an edge comes from its vertex or goes to it: the derivative of u and v by the four vertices [1].
const EDGE_SIGNS: [f64; 4] = [-1.0, 1.0, -1.0, 1.0];

impl Fade {
    /// Derivative of c by vertex k [mm³].
    fn gradient(&self, k: usize) -> Vec3 {
        self.by_edges[k / 2] * EDGE_SIGNS[k]
    }

    /// Second derivatives of c: by u twice, by u and v, by v twice [mm²].
    fn cross_hessian(&self) -> [Mat3; 3] {
        let [u, v] = self.edges;
        let twice = |w: Vec3| (Mat3::from_diagonal_element(w.norm_squared()) - w * w.transpose()) * 2.0;
        let mixed = u * v.transpose() * 2.0 - v * u.transpose() - Mat3::from_diagonal_element(u.dot(&v));
        [twice(v), mixed * 2.0, twice(u)]
    }
}

/// A way in which the closest points can slide, orthogonal to the others: what it does to D = ½ d², by the four vertices.
struct Slide {
    /// b = w e + u r, the second derivative of D by a vertex and the slide [mm].
    mixed: [Vec3; 4],
    /// 1 / (e·e) [1/mm²].
    inverse: f64,
}

impl Touch<'_> {
    #[inline]
    fn corners(&self) -> [Vec3; 4] {
        corners(&self.pair.vertices, self.positions_mm)
    }

    /// Which vertices share the closest points.
    #[inline]
    fn shares(&self) -> [bool; 4] {
        self.nearest.weights.map(|weight| weight != 0.0)
    }

    /// [`penalty`] on the area that the pair stands for, without fading: [N·mm], [N], [N/mm].
    #[inline]
    fn penalty(&self, stiffness_mpa: f64) -> [f64; 3] {
        let &Pair {
            activation_mm,
            rigid_mm,
            area_mm2,
            ..
        } = self.pair;
        penalty(self.distance_mm, activation_mm, rigid_mm, stiffness_mpa).map(|value| value * area_mm2)
    }

    /// m(c) = (c/ε)(2 − c/ε) below the limit ε; nothing above, where it is 1 (Li et al. 2020, eq. 24).
    #[inline]
    fn fade(&self) -> Option<Fade> {
        if self.pair.kind == PairKind::PointTriangle {
            return None;
        }
        let [a, b, c, d] = self.corners();
        let limit = self.pair.parallel_limit_mm4;
        let (u, v) = (b - a, d - c);
        let c = u.cross(&v).norm_squared();
        (c < limit).then(|| Fade {
            value: c / limit * (2.0 - c / limit),
            slope: 2.0 / limit * (1.0 - c / limit),
            curvature: -2.0 / (limit * limit),
            edges: [u, v],
            by_edges: [
                (u * v.norm_squared() - v * u.dot(&v)) * 2.0,
                (v * u.norm_squared() - u * u.dot(&v)) * 2.0,
            ],
        })
    }

    /// How r = Σ wᵢ xᵢ slides: e = Σ uᵢ xᵢ for a direction u in weight space.
    #[inline]
    fn sliding(&self, u: &[f64; 4]) -> Vec3 {
        let [a, b, c, d] = self.corners();
        (b - a) * u[1] + (c - a) * u[2] + (d - a) * u[3]
    }

    #[inline]
    fn slide(&self, u: &[f64; 4], e: &Vec3) -> Slide {
        let (w, r) = (&self.nearest.weights, &self.nearest.separation_mm);
        let squared = e.norm_squared();
        Slide {
            mixed: std::array::from_fn(|i| e * w[i] + r * u[i]),
            inverse: if squared > 0.0 { 1.0 / squared } else { 0.0 },
        }
    }
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
///
/// Returns which vertices count: u is zero where w is, so that only fading moves the others.
fn exact_blocks(touch: &Touch, stiffness_mpa: f64, blocks: &mut Blocks) -> [bool; 4] {
    let penalty = touch.penalty(stiffness_mpa);
    let fade = touch.fade();
    let [_, slope, curvature] = penalty.map(|value| value * share_of(fade.as_ref()));
    let (n, across) = (&touch.direction, slope / touch.distance_mm);
    let base = n * n.transpose() * (curvature - across) + Mat3::from_diagonal_element(across);
    let parameters = touch.pair.parameters(&touch.nearest);
    let [first, mut second] = parameters.directions;
    match parameters.count {
        0 => write_blocks(touch, &base, across, [], blocks),
        1 => {
            let slide = touch.slide(&first, &touch.sliding(&first));
            write_blocks(touch, &base, across, [slide], blocks);
        }
        _ => {
            let (e, mut f) = (touch.sliding(&first), touch.sliding(&second));
            let (squared, part) = (f.norm_squared(), e.dot(&f) / e.norm_squared());
            f -= e * part;
            (0..4).for_each(|i| second[i] -= first[i] * part);
            let slide = touch.slide(&first, &e);
            // Parallel slides are one; a pair of edges has faded out there.
            if f.norm_squared() > 1e-12 * squared {
                let slides = [slide, touch.slide(&second, &f)];
                write_blocks(touch, &base, across, slides, blocks);
            } else {
                write_blocks(touch, &base, across, [slide], blocks);
            }
        }
    }
    match fade {
        Some(fade) => {
            add_fading(touch, &fade, penalty, blocks);
            [true; 4]
        }
        None => touch.shares(),
    }
}

/// wᵢ wⱼ times the base, less what sliding takes off.
#[inline]
fn write_blocks<const COUNT: usize>(
    touch: &Touch,
    base: &Mat3,
    across: f64,
    slides: [Slide; COUNT],
    blocks: &mut Blocks,
) {
    let w = &touch.nearest.weights;
    let scaled = slides
        .each_ref()
        .map(|slide| slide.mixed.map(|b| b * (across * slide.inverse)));
    for (block, [i, j]) in blocks.iter_mut().zip(PLACES) {
        *block = base * (w[i] * w[j]);
        for (slide, scaled) in slides.iter().zip(&scaled) {
            *block -= slide.mixed[i] * scaled[j].transpose();
        }
    }
}

/// What the derivatives of m add to the Hessian of a pair that fades.
#[cold]
fn add_fading(touch: &Touch, fade: &Fade, [value, slope, _]: [f64; 3], blocks: &mut Blocks) {
    let [g, h] = &fade.by_edges;
    let [uu, uv, vv] = fade.cross_hessian().map(|block| block * (value * fade.slope));
    let twice = value * fade.curvature;
    let of_edges = [
        uu + g * g.transpose() * twice,
        uv + g * h.transpose() * twice,
        vv + h * h.transpose() * twice,
    ];
    let w = touch.nearest.weights;
    let n = touch.direction * (slope * fade.slope);
    for (block, [i, j]) in blocks.iter_mut().zip(PLACES) {
        *block += of_edges[i / 2 + j / 2] * (EDGE_SIGNS[i] * EDGE_SIGNS[j]);
        *block += n * fade.gradient(j).transpose() * w[i] + fade.gradient(i) * n.transpose() * w[j];
    }
}

/// The part that resists approach: m ψ'' ∇d∇dᵀ, never negative.
fn projected_blocks(touch: &Touch, stiffness_mpa: f64, blocks: &mut Blocks) -> [bool; 4] {
    let [_, _, curvature] = touch.penalty(stiffness_mpa);
    let n = &touch.direction;
    let base = n * n.transpose() * (share_of(touch.fade().as_ref()) * curvature);
    write_blocks(touch, &base, 0.0, [], blocks);
    touch.shares()
}

#[cfg(test)]
mod tests;
