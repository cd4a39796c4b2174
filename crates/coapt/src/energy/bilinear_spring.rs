//! Edge springs with a bilinear law (paper 003, section 2.2).

/// Leaflet springs: one per mesh edge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Springs {
    /// The two vertices of each spring, shape `[spring]`.
    pub ends: Vec<[u32; 2]>,
    /// Unloaded length [mm], shape `[spring]`.
    pub rest_length_mm: Vec<f64>,
    /// Length at which the stiff branch begins [mm], shape `[spring]`.
    pub transition_length_mm: Vec<f64>,
    /// Stiffness below the transition [N/mm], shape `[spring]`.
    pub soft_n_per_mm: Vec<f64>,
    /// Stiffness above the transition [N/mm], shape `[spring]`.
    pub stiff_n_per_mm: Vec<f64>,
    /// Stiffness in compression [N/mm], shape `[spring]`.
    pub compression_n_per_mm: Vec<f64>,
}
