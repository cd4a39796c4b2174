//! Chordae: linear elastic rods that carry tension only (paper 003, section 2.2): T = E·A (l / L − 1), 0 when slack.

use super::{BlockSink, Curvature, add_line_hessian};
use crate::Vec3;

/// Chord segments.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chords {
    /// The two vertices of each segment, shape `[segment]`.
    pub ends: Vec<[u32; 2]>,
    /// Unloaded length L [mm], shape `[segment]`.
    pub rest_length_mm: Vec<f64>,
    /// Force per strain, E·A [N], shape `[segment]`.
    pub axial_stiffness_n: Vec<f64>,
    /// Which group each segment belongs to, shape `[segment]`.
    pub group: Vec<u32>,
}

impl Chords {
    /// Tension of each segment [N], shape `[segment]`.
    pub fn tensions_n(&self, positions_mm: &[Vec3]) -> Vec<f64> {
        (0..self.ends.len())
            .map(|index| self.tension(index, offset(self, index, positions_mm).norm()))
            .collect()
    }

    fn tension(&self, index: usize, length_mm: f64) -> f64 {
        self.axial_stiffness_n[index] * (length_mm / self.rest_length_mm[index] - 1.0).max(0.0)
    }
}

/// Elastic energy of all chordae [N·mm]: ½ E·A·L ε² where taut.
pub fn energy(chords: &Chords, positions_mm: &[Vec3]) -> f64 {
    (0..chords.ends.len())
        .map(|index| {
            let strain = offset(chords, index, positions_mm).norm() / chords.rest_length_mm[index] - 1.0;
            0.5 * chords.axial_stiffness_n[index] * chords.rest_length_mm[index] * strain.max(0.0).powi(2)
        })
        .sum()
}

/// Adds the gradient of the energy [N], shape `[vertex]`.
pub fn add_gradient(chords: &Chords, positions_mm: &[Vec3], gradient_n: &mut [Vec3]) {
    for (index, &[a, b]) in chords.ends.iter().enumerate() {
        let offset = offset(chords, index, positions_mm);
        let length = offset.norm();
        let tension = chords.tension(index, length);
        if tension == 0.0 {
            continue;
        }
        let pull = offset * (tension / length);
        gradient_n[a as usize] -= pull;
        gradient_n[b as usize] += pull;
    }
}

/// Adds the Hessian of the energy; a slack segment has none.
pub fn add_hessian(chords: &Chords, positions_mm: &[Vec3], curvature: Curvature, sink: &mut impl BlockSink) {
    for (index, &ends) in chords.ends.iter().enumerate() {
        let offset = offset(chords, index, positions_mm);
        let length = offset.norm();
        if length > chords.rest_length_mm[index] {
            let tangent = chords.axial_stiffness_n[index] / chords.rest_length_mm[index];
            add_line_hessian(
                ends,
                offset,
                chords.tension(index, length),
                tangent,
                curvature,
                sink,
            );
        }
    }
}

fn offset(chords: &Chords, index: usize, positions_mm: &[Vec3]) -> Vec3 {
    let [a, b] = chords.ends[index];
    positions_mm[b as usize] - positions_mm[a as usize]
}
