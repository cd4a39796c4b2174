//! The forces, one file per law: value, gradient and Hessian blocks.
//!
//! Every law of tissue offers the same three functions: `energy` [N·mm], `add_gradient` (minus the force, [N]) and
//! `add_hessian`, which hands its 3×3 blocks [N/mm] to a sink. A block `(i, j)` with `i != j` stands for itself
//! and for its transpose at `(j, i)`. Which blocks come, and in which order, does not depend on the positions: a slack
//! chord hands out zeros. So their places are looked up once.

pub mod bending;
pub mod bilinear_spring;
pub mod chord;
pub mod chord_law;
pub mod dead_load;
pub mod membrane;
pub mod pressure;

use crate::{Mat3, Vec3};

/// Which second derivative is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// The true one: fast near the equilibrium, but possibly indefinite.
    Exact,
    /// Without pressure, and with the positive semidefinite part of contact: far from the equilibrium these two make the true
    /// one indefinite nearly always. Tissue in compression does so too, but there the damping makes up for it, and leaving
    /// that part out would make the tissue too stiff, and steps too short.
    Projected,
}

/// Receives Hessian blocks: row vertex, column vertex, block [N/mm].
pub trait BlockSink {
    /// Adds a block.
    fn add(&mut self, row: u32, column: u32, block: &Mat3);
}

impl<F: FnMut(u32, u32, &Mat3)> BlockSink for F {
    fn add(&mut self, row: u32, column: u32, block: &Mat3) {
        self(row, column, block);
    }
}

/// The Hessian of a two-point element: with direction n, length l, tension f(l) and tangent k = df/dl,
/// K = k n nᵀ + (f / l)(I − n nᵀ) on the diagonal and −K off it.
fn add_line_hessian(
    ends: [u32; 2],
    offset: Vec3,
    tension_n: f64,
    tangent_n_per_mm: f64,
    sink: &mut impl BlockSink,
) {
    let block = line_block(offset, tension_n, tangent_n_per_mm);
    sink.add(ends[0], ends[0], &block);
    sink.add(ends[1], ends[1], &block);
    sink.add(ends[0], ends[1], &-block);
}

/// K of [`add_line_hessian`]. A compressed element (f < 0) pushes sideways, which makes K indefinite. Two points in one
/// place have no direction, hence no stiffness; contact keeps that from happening.
fn line_block(offset: Vec3, tension_n: f64, tangent_n_per_mm: f64) -> Mat3 {
    let length = offset.norm();
    let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
    let direction = offset * inverse;
    let sideways = tension_n * inverse;
    direction * direction.transpose() * (tangent_n_per_mm - sideways) + Mat3::from_diagonal_element(sideways)
}
