//! Edge springs with a bilinear law (paper 003, section 2.2).
//!
//! f(l) = k₁ (l − L) up to the transition length l*, f(l*) + k₂ (l − l*) beyond it, k₀ (l − L) in compression.

use super::{BlockSink, add_line_hessian};
use crate::Vec3;

/// Leaflet springs: one per mesh edge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Springs {
    /// The two vertices of each spring, shape `[spring]`.
    pub ends: Vec<[u32; 2]>,
    /// Unloaded length L [mm], shape `[spring]`.
    pub rest_length_mm: Vec<f64>,
    /// Length l* at which the stiff branch begins [mm], shape `[spring]`.
    pub transition_length_mm: Vec<f64>,
    /// Stiffness k₁ below the transition [N/mm], shape `[spring]`.
    pub soft_n_per_mm: Vec<f64>,
    /// Stiffness k₂ above the transition [N/mm], shape `[spring]`.
    pub stiff_n_per_mm: Vec<f64>,
    /// Stiffness k₀ in compression [N/mm], shape `[spring]`.
    pub compression_n_per_mm: Vec<f64>,
}

impl Springs {
    /// Tension of spring `index` at a length [mm], and its slope: [N], [N/mm].
    pub fn tension_and_tangent(&self, index: usize, length_mm: f64) -> (f64, f64) {
        let elongation = length_mm - self.rest_length_mm[index];
        if elongation < 0.0 {
            let stiffness = self.compression_n_per_mm[index];
            return (stiffness * elongation, stiffness);
        }
        let beyond = length_mm - self.transition_length_mm[index];
        let soft = self.soft_n_per_mm[index];
        if beyond <= 0.0 {
            (soft * elongation, soft)
        } else {
            let stiff = self.stiff_n_per_mm[index];
            (soft * (elongation - beyond) + stiff * beyond, stiff)
        }
    }

    /// Elastic energy of spring `index` at a length [N·mm].
    pub fn energy_at(&self, index: usize, length_mm: f64) -> f64 {
        let elongation = length_mm - self.rest_length_mm[index];
        if elongation < 0.0 {
            return 0.5 * self.compression_n_per_mm[index] * elongation * elongation;
        }
        let soft = self.soft_n_per_mm[index];
        // U = ½ k₁ e² below; beyond l*, the branch k₁ goes on and (k₂ − k₁) is added from l*.
        let beyond = (length_mm - self.transition_length_mm[index]).max(0.0);
        0.5 * soft * elongation * elongation + 0.5 * (self.stiff_n_per_mm[index] - soft) * beyond * beyond
    }
}

/// Elastic energy of all springs [N·mm].
pub fn energy(springs: &Springs, positions_mm: &[Vec3]) -> f64 {
    (0..springs.ends.len())
        .map(|index| springs.energy_at(index, offset(springs, index, positions_mm).norm()))
        .sum()
}

/// Adds the gradient of the energy [N], shape `[vertex]`.
pub fn add_gradient(springs: &Springs, positions_mm: &[Vec3], gradient_n: &mut [Vec3]) {
    for (index, &[a, b]) in springs.ends.iter().enumerate() {
        let offset = offset(springs, index, positions_mm);
        let length = offset.norm();
        // Two vertices in one place have no direction; contact keeps that from happening.
        if length == 0.0 {
            continue;
        }
        let pull = offset * (springs.tension_and_tangent(index, length).0 / length);
        gradient_n[a as usize] -= pull;
        gradient_n[b as usize] += pull;
    }
}

/// Adds the Hessian of the energy.
pub fn add_hessian(springs: &Springs, positions_mm: &[Vec3], sink: &mut impl BlockSink) {
    for (index, &ends) in springs.ends.iter().enumerate() {
        let offset = offset(springs, index, positions_mm);
        let (tension, tangent) = springs.tension_and_tangent(index, offset.norm());
        add_line_hessian(ends, offset, tension, tangent, sink);
    }
}

fn offset(springs: &Springs, index: usize, positions_mm: &[Vec3]) -> Vec3 {
    let [a, b] = springs.ends[index];
    positions_mm[b as usize] - positions_mm[a as usize]
}
