//! Bending of leaflets about mesh edges, quadratic in the positions (Bergou et al. 2006, "A quadratic bending model for
//! inextensible surfaces").
//!
//! At an edge inside the surface, b = Σ cᵢ xᵢ over its two ends and the two vertices across, with cotangents of the
//! unloaded triangles as weights, is as long as the edge times the angle between the faces. The edge stores ½ k b·b with
//! k = D / (A₁ + A₂), D the plate stiffness: on equilateral triangles exactly a plate's energy (Seung & Nelson 1988), a
//! third of what that paper's non-conforming elements would make it.
//!
//! Flat sheets of any outline store nothing, whatever their place. Leaflets are taken to be flat where nothing bends
//! them: which shape unloaded tissue would take is not known, and the moment that bends it to the open shape is small.

use super::BlockSink;
use crate::{Mat3, Vec3};

/// Edges that resist bending.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hinges {
    /// The ends of each edge, then the two vertices across, shape `[hinge]`.
    pub vertices: Vec<[u32; 4]>,
    /// c of each vertex [1], adding up to nothing, shape `[hinge]`.
    pub weights: Vec<[f64; 4]>,
    /// k of each edge [N/mm], shape `[hinge]`.
    pub stiffness_n_per_mm: Vec<f64>,
}

/// Bending energy [N·mm].
pub fn energy(hinges: &Hinges, positions_mm: &[Vec3]) -> f64 {
    (0..hinges.vertices.len())
        .map(|index| {
            0.5 * hinges.stiffness_n_per_mm[index] * bend_mm(hinges, index, positions_mm).norm_squared()
        })
        .sum()
}

/// Adds the gradient of the energy [N], shape `[vertex]`.
pub fn add_gradient(hinges: &Hinges, positions_mm: &[Vec3], gradient_n: &mut [Vec3]) {
    for (index, vertices) in hinges.vertices.iter().enumerate() {
        let moment = bend_mm(hinges, index, positions_mm) * hinges.stiffness_n_per_mm[index];
        for (&vertex, weight) in vertices.iter().zip(hinges.weights[index]) {
            gradient_n[vertex as usize] += moment * weight;
        }
    }
}

/// Adds the Hessian of the energy, which is constant and positive semidefinite.
pub fn add_hessian(hinges: &Hinges, sink: &mut impl BlockSink) {
    for (index, vertices) in hinges.vertices.iter().enumerate() {
        let weights = hinges.weights[index];
        for i in 0..4 {
            for j in i..4 {
                let stiffness = hinges.stiffness_n_per_mm[index] * weights[i] * weights[j];
                sink.add(vertices[i], vertices[j], &Mat3::from_diagonal_element(stiffness));
            }
        }
    }
}

#[inline]
fn bend_mm(hinges: &Hinges, index: usize, positions_mm: &[Vec3]) -> Vec3 {
    let [a, b, c, d] = hinges.vertices[index].map(|vertex| &positions_mm[vertex as usize]);
    let weights = &hinges.weights[index];
    a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3]
}
