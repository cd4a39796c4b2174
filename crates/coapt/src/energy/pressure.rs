//! Pressure on the faces: along the current normal, on the current area, a third to each vertex (paper 003,
//! section 2.2).
//!
//! The load follows the surface. With a closed or fixed rim it is the gradient of p·V; at a free margin it is
//! not, so there is no energy. What the solver needs instead: the force, the symmetric and the antisymmetric part
//! of its tangent, and the potential −p·V as the conservative part.

use super::BlockSink;
use crate::Vec3;

/// Adds minus the pressure force [N], shape `[vertex]`.
///
/// Face (a, b, c): ½ (b − a) × (c − a) is its vector area, so each vertex gets p/6 (b − a) × (c − a).
pub fn add_gradient(faces: &[[u32; 3]], pressure_mpa: f64, positions_mm: &[Vec3], gradient_n: &mut [Vec3]) {
    if pressure_mpa == 0.0 {
        return;
    }
    for face in faces {
        let [a, b, c] = face.map(|vertex| positions_mm[vertex as usize]);
        let force = (b - a).cross(&(c - a)) * (pressure_mpa / 6.0);
        for &vertex in face {
            gradient_n[vertex as usize] -= force;
        }
    }
}

/// The potential −p·V of the cone from `apex` over the faces [N·mm].
pub fn potential(faces: &[[u32; 3]], pressure_mpa: f64, apex: Vec3, positions_mm: &[Vec3]) -> f64 {
    let volume: f64 = faces
        .iter()
        .map(|face| {
            let [a, b, c] = face.map(|vertex| positions_mm[vertex as usize] - apex);
            a.dot(&b.cross(&c)) / 6.0
        })
        .sum();
    -pressure_mpa * volume
}

/// Adds the gradient of [`potential`] [N], shape `[vertex]`.
pub fn add_potential_gradient(
    faces: &[[u32; 3]],
    pressure_mpa: f64,
    apex: Vec3,
    positions_mm: &[Vec3],
    gradient_n: &mut [Vec3],
) {
    if pressure_mpa == 0.0 {
        return;
    }
    let scale = pressure_mpa / 6.0;
    for face in faces {
        let [a, b, c] = face.map(|vertex| positions_mm[vertex as usize] - apex);
        gradient_n[face[0] as usize] -= b.cross(&c) * scale;
        gradient_n[face[1] as usize] -= c.cross(&a) * scale;
        gradient_n[face[2] as usize] -= a.cross(&b) * scale;
    }
}

/// Adds the symmetric part of the tangent of minus the force.
///
/// With N = (b − a) × (c − a): ∂N/∂a = [c − b]ₓ and so on round, and every vertex carries −p/6 N. The block
/// (a, b) is −p/6 [a − c]ₓ; the mean of it and of the transpose of (b, a) is p/6 [c − (a + b)/2]ₓ. Diagonal blocks
/// are antisymmetric: they have no symmetric part.
pub fn add_symmetric_tangent(
    faces: &[[u32; 3]],
    pressure_mpa: f64,
    positions_mm: &[Vec3],
    sink: &mut impl BlockSink,
) {
    if pressure_mpa == 0.0 {
        return;
    }
    for face in faces {
        let corners = face.map(|vertex| positions_mm[vertex as usize]);
        for k in 0..3 {
            let (a, b, c) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let block = ((c - (a + b) * 0.5) * (pressure_mpa / 6.0)).cross_matrix();
            sink.add(face[k], face[(k + 1) % 3], &block);
        }
    }
}

/// The sides of faces that no other face shares, in the direction in which their face runs round.
pub fn rim(faces: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut sides: Vec<[u32; 2]> = faces
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .collect();
    sides.sort_unstable();
    let lonely = |&[a, b]: &[u32; 2]| sides.binary_search(&[b, a]).is_err();
    sides.iter().copied().filter(lonely).collect()
}

/// Adds the antisymmetric part of the tangent of minus the force times `direction` [N for mm], shape `[vertex]`.
///
/// What [`add_symmetric_tangent`] leaves of K is, for a and b, −p/12 [a − b]ₓ from each face, which cancels
/// between the two faces of an inner side, and −p/6 [c − b]ₓ on the diagonal, which sums to nothing around an
/// inner vertex. Only sides on the rim keep anything; with e = a − b, a side (a, b) gives a the share
/// −p/6 e × d(a) − p/12 e × d(b), and b the same with d(a) and d(b) exchanged.
pub fn add_antisymmetric_product(
    rim: &[[u32; 2]],
    pressure_mpa: f64,
    positions_mm: &[Vec3],
    direction: &[Vec3],
    product: &mut [Vec3],
) {
    for &[a, b] in rim {
        let (a, b) = (a as usize, b as usize);
        let e = (positions_mm[a] - positions_mm[b]) * (pressure_mpa / 12.0);
        let (from_a, from_b) = (e.cross(&direction[a]), e.cross(&direction[b]));
        product[a] -= from_a * 2.0 + from_b;
        product[b] -= from_b * 2.0 + from_a;
    }
}
