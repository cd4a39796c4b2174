//! Chordae: linear elastic rods that carry tension only (paper 003, section 2.2).

/// Chord segments.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chords {
    /// The two vertices of each segment, shape `[segment]`.
    pub ends: Vec<[u32; 2]>,
    /// Unloaded length [mm], shape `[segment]`.
    pub rest_length_mm: Vec<f64>,
    /// Force per strain, E·A [N], shape `[segment]`.
    pub axial_stiffness_n: Vec<f64>,
    /// Which group each segment belongs to, shape `[segment]`.
    pub group: Vec<u32>,
}
