//! Sparse factorisation A + diag(σ) = L Lᵀ of a matrix of 3×3 blocks.
//!
//! Written here because the general libraries are several times slower on this size and shape of matrix, or cost
//! minutes of build. The method is multifrontal (Duff & Reid 1983; Liu 1992): columns with nearly the same rows form
//! a node of a tree; a node gathers what its children leave, factorises a dense panel of its columns and leaves a dense
//! square to its parent. All arithmetic is dense, in strips of rows that fill vector registers.

mod dense;
pub mod order;
mod solve;
mod symbolic;
mod tree;

use super::block_matrix::BlockMatrix;
use crate::Mat3;
use crate::simd::{Kernel, dispatch};
use dense::{Lane, ROWS, SLOTS};
pub use symbolic::Symbolic;
use symbolic::{Node, Source, triangle_strips};

/// A factorisation; room for one, to be filled again and again.
#[derive(Clone, Debug, Default)]
pub struct Factor {
    /// The panels of L, one after the other.
    panels: Vec<Lane>,
    /// What nodes leave to their parents, until those take it: a stack for even and one for odd depths, so that a node
    /// takes from the end of one and leaves at the end of the other.
    updates: [Vec<Lane>; 2],
}

/// The matrix is not positive definite: a block row that shows it, as an original index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotPositiveDefinite {
    /// Block row.
    pub row: u32,
}

impl Symbolic {
    /// Factorises; `shift` is added to the diagonal [N/mm], shape `[size]`.
    pub fn factor(&self, matrix: &BlockMatrix, shift: &[f64]) -> Result<Factor, NotPositiveDefinite> {
        let mut factor = Factor::default();
        self.factor_into(matrix, shift, &mut factor)?;
        Ok(factor)
    }

    /// Factorises into a factor that is used again: it allocates only where an earlier pattern was smaller. After an
    /// error the factor holds nothing to solve with.
    pub fn factor_into(
        &self,
        matrix: &BlockMatrix,
        shift: &[f64],
        factor: &mut Factor,
    ) -> Result<(), NotPositiveDefinite> {
        factor.panels.resize(self.panel_size, [0.0; ROWS]);
        for (stack, &size) in factor.updates.iter_mut().zip(&self.stack_sizes) {
            stack.resize(size, [0.0; ROWS]);
        }
        dispatch(Factorisation {
            symbolic: self,
            matrix,
            shift,
            factor,
        })
    }
}

struct Factorisation<'a> {
    symbolic: &'a Symbolic,
    matrix: &'a BlockMatrix,
    shift: &'a [f64],
    factor: &'a mut Factor,
}

impl Kernel for Factorisation<'_> {
    type Output = Result<(), NotPositiveDefinite>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Self::Output {
        let [even, odd] = &mut self.factor.updates;
        for node in &self.symbolic.nodes {
            let (mine, theirs) = if node.deep {
                (&mut *odd, &*even)
            } else {
                (&mut *even, &*odd)
            };
            let panel = &mut self.factor.panels[node.panel.clone()];
            let update = &mut mine[node.update.clone()];
            let width = 3 * node.width();
            panel.fill([0.0; ROWS]);
            self.symbolic.add_sources(node, self.matrix, self.shift, panel);
            for child in self.symbolic.children(node) {
                let places = &self.symbolic.places_in_parent[child.rows.clone()];
                add_to_panel(&theirs[child.update.clone()], places, width, panel);
            }
            dense::factor_panel::<FUSED>(panel, width).map_err(|column| NotPositiveDefinite {
                row: self.symbolic.order[node.columns.start + column],
            })?;
            let below = &panel[triangle_strips(node.width()) * width..];
            dense::negative_square::<FUSED>(update, below, width, 3 * node.rows.len());
            for child in self.symbolic.children(node) {
                let places = &self.symbolic.places_in_parent[child.rows.clone()];
                add_to_update(&theirs[child.update.clone()], places, width, update);
            }
        }
        Ok(())
    }
}

impl Symbolic {
    #[inline(always)]
    fn add_sources(&self, node: &Node, matrix: &BlockMatrix, shift: &[f64], panel: &mut [Lane]) {
        for source in &self.sources[node.sources.clone()] {
            let Source {
                slot,
                lane,
                first,
                transposed,
            } = *source;
            let block = &matrix.blocks[slot as usize];
            let block = if transposed { block.transpose() } else { *block };
            store_block(&mut panel[lane as usize..], first as usize, &block);
        }
        let width = node.width();
        for (column, &old) in self.order[node.columns.clone()].iter().enumerate() {
            let lanes = &mut panel[column / SLOTS * 3 * width + 3 * column..][..3];
            for (axis, lane) in lanes.iter_mut().enumerate() {
                lane[3 * (column % SLOTS) + axis] += shift[old as usize];
            }
        }
    }
}

#[inline(always)]
fn store_block(lanes: &mut [Lane], first: usize, block: &Mat3) {
    for (lane, column) in lanes.iter_mut().zip(block.column_iter()) {
        lane[first..first + 3].copy_from_slice(column.as_slice());
    }
}

/// Adds to a panel of `width` columns what a child leaves there; `places` says where the child's rows are in the front.
#[inline(always)]
fn add_to_panel(child: &[Lane], places: &[u32], width: usize, panel: &mut [Lane]) {
    let inside = places.partition_point(|&place| 3 * (place as usize) < width);
    for (column, &place) in places[..inside].iter().enumerate() {
        for (row, &target) in places.iter().enumerate().skip(column) {
            let from = &child[update_lane(row / SLOTS, column)..][..3];
            let target = target as usize;
            let to = &mut panel[target / SLOTS * width + 3 * place as usize..][..3];
            add_block(from, row % SLOTS, to, target % SLOTS);
        }
    }
}

/// Adds to an update what a child leaves there.
#[inline(always)]
fn add_to_update(child: &[Lane], places: &[u32], width: usize, update: &mut [Lane]) {
    let inside = places.partition_point(|&place| 3 * (place as usize) < width);
    let above = triangle_strips(width / 3) * SLOTS;
    for (column, &place) in places.iter().enumerate().skip(inside) {
        for (row, &target) in places.iter().enumerate().skip(column) {
            let from = &child[update_lane(row / SLOTS, column)..][..3];
            let target = target as usize - above;
            let to = &mut update[update_lane(target / SLOTS, place as usize - above)..][..3];
            add_block(from, row % SLOTS, to, target % SLOTS);
        }
    }
}

/// First lane of a block column in a strip of an update: strip k has the columns of strips 0..=k.
#[inline(always)]
fn update_lane(strip: usize, column: usize) -> usize {
    ROWS * strip * (strip + 1) / 2 + 3 * column
}

#[inline(always)]
fn add_block(from: &[Lane], from_slot: usize, to: &mut [Lane], to_slot: usize) {
    let (from_row, to_row) = (3 * from_slot, 3 * to_slot);
    // Sums first, then stores: the compiler does not know that they lie apart.
    let mut sums = [[0.0; 3]; 3];
    for column in 0..3 {
        for row in 0..3 {
            sums[column][row] = to[column][to_row + row] + from[column][from_row + row];
        }
    }
    for column in 0..3 {
        to[column][to_row..to_row + 3].copy_from_slice(&sums[column]);
    }
}

#[cfg(test)]
mod tests;
