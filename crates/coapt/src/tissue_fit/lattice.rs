//! What a lattice of springs bears when it is stretched along two axes.
//!
//! In an equilateral lattice of rest edge L and thickness t three families of springs run at 60 degrees to each other. A
//! spring at φ to the first axis is stretched by λ(φ) = √(λ₁² cos²φ + λ₂² sin²φ) and pulls with t w σ(φ, λ − 1),
//! w = √3/2 L. There is one spring of each family to each vertex, which has the area √3/2 L². So the energy per area has the
//! derivative by λ₁
//!
//! ```text
//! t P₁ = Σ t w σ L ∂λ/∂λ₁ / (√3/2 L²) = t Σ σ(φ, λ − 1) λ₁ cos²φ / λ       over the three families
//! ```
//!
//! which is the force per unloaded length of cut. Stretched alike in both directions this is P = 3/2 σ, as Σ cos²φ = 3/2: the
//! tension per current length is N = 3/2 t σ / (1 + e). A mesh has no direction of its own, so that the mean over all ways in
//! which the lattice may lie is taken: 3 times the mean over φ.

use crate::scene::SpringBranches;

/// Directions over half a turn: four lattices, 15 degrees apart. With twice as many stresses change by less than 1e-5.
const DIRECTIONS: u32 = 24;

/// Force per unloaded section along both axes [MPa], of springs that have these constants along the first and along the
/// second axis, at a stretch [1].
pub fn nominal_stress_mpa(
    branches: &[SpringBranches; 2],
    compression_modulus_ratio: f64,
    stretch: [f64; 2],
) -> [f64; 2] {
    sum(stretch, |cosine_squared, strain| {
        let between = SpringBranches::between(&branches[0], &branches[1], cosine_squared);
        let (soft, stiff) = parts(strain, between.transition_strain, compression_modulus_ratio);
        between.pre_transition_modulus_mpa * soft + between.post_transition_modulus_mpa * stiff
    })
}

/// The strain of a spring that its soft modulus bears, and that its stiff one does [1].
pub(super) fn parts(strain: f64, knee: f64, compression_modulus_ratio: f64) -> (f64, f64) {
    if strain < 0.0 {
        return (compression_modulus_ratio * strain, 0.0);
    }
    (strain.min(knee), (strain - knee).max(0.0))
}

/// Σ σ λᵢ cᵢ² / λ over the lattice, σ given by the squared cosine of the direction and the strain.
pub(super) fn sum(stretch: [f64; 2], stress: impl Fn(f64, f64) -> f64) -> [f64; 2] {
    let mut total = [0.0; 2];
    for direction in 0..DIRECTIONS {
        let angle = std::f64::consts::PI * (f64::from(direction) + 0.5) / f64::from(DIRECTIONS);
        let squares = [angle.cos().powi(2), angle.sin().powi(2)];
        let along = (stretch[0].powi(2) * squares[0] + stretch[1].powi(2) * squares[1]).sqrt();
        let stress = 3.0 / f64::from(DIRECTIONS) * stress(squares[0], along - 1.0);
        for axis in 0..2 {
            total[axis] += stress * stretch[axis] * squares[axis] / along;
        }
    }
    total
}
