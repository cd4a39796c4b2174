//! Given forces on vertices, which keep their size and direction.

use crate::Vec3;

/// Forces on vertices.
pub type DeadLoads = Vec<(u32, Vec3)>;

/// Their potential −f·x [N·mm].
pub fn energy(loads_n: &DeadLoads, positions_mm: &[Vec3]) -> f64 {
    let works = loads_n
        .iter()
        .map(|(vertex, force)| force.dot(&positions_mm[*vertex as usize]));
    -works.sum::<f64>()
}

/// Adds minus the forces [N], shape `[vertex]`.
pub fn add_gradient(loads_n: &DeadLoads, gradient_n: &mut [Vec3]) {
    for (vertex, force) in loads_n {
        gradient_n[*vertex as usize] -= force;
    }
}
