//! Sparse factorisation A + diag(σ) = L Lᵀ of a matrix of 3×3 blocks.
//!
//! Written here because the general libraries are several times slower on this size and shape of matrix, or cost
//! minutes of build. The method is multifrontal (Duff & Reid 1983; Liu 1992): columns with nearly the same rows form
//! a node of a tree; a node gathers what its children leave, factorises a dense panel of its columns and leaves a dense
//! square to its parent. All arithmetic is dense, in strips of rows that fill vector registers.

mod dense;
pub mod order;
mod pivot;
mod shared;
mod solve;
mod symbolic;
mod tree;

use super::block_matrix::BlockMatrix;
use crate::Mat3;
use crate::simd::{Kernel, dispatch};
use dense::{Lane, ROWS, SLOTS};
use std::ops::Range;
pub use symbolic::Symbolic;
use symbolic::{Node, Source, triangle_strips};

/// A factorisation; room for one, to be filled again and again.
#[derive(Clone, Debug, Default)]
pub struct Factor {
    /// The panels of L, one after the other, and a lane as margin.
    panels: Vec<Lane>,
    /// What nodes leave to their parents, until those take it: a stack for even and one for odd depths, so that a node
    /// takes from the end of one and leaves at the end of the other. Each has a lane as margin.
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
        factor.panels.resize(self.panel_size + 1, [0.0; ROWS]);
        for (stack, &size) in factor.updates.iter_mut().zip(&self.stack_sizes) {
            stack.resize(size + 1, [0.0; ROWS]);
        }
        let work = Factorisation {
            symbolic: self,
            matrix,
            shift,
            factor,
        };
        if self.is_shared {
            // On a thread of the pool: every hand-over from another thread would make that one wait and wake.
            rayon::scope(|_| dispatch(work))
        } else {
            dispatch(work)
        }
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
        let symbolic = self.symbolic;
        let [even, odd] = &mut self.factor.updates;
        for node in &symbolic.nodes {
            let (mine, theirs) = if node.deep {
                (&mut *odd, &*even)
            } else {
                (&mut *even, &*odd)
            };
            let panel = &mut self.factor.panels[with_margin(&node.panel)];
            let update = &mut mine[with_margin(&node.update)];
            symbolic.assemble_panel(node, self.matrix, self.shift, theirs, panel);
            symbolic.eliminate::<FUSED>(node, &mut panel[..node.panel.len()], update)?;
            symbolic.assemble_update(node, theirs, update);
        }
        Ok(())
    }
}

/// Some lanes and one more, whose numbers [`add_blocks`] reads and writes back.
#[inline(always)]
fn with_margin(lanes: &Range<usize>) -> Range<usize> {
    lanes.start..lanes.end + 1
}

impl Symbolic {
    /// The nodes that leave something to a node, and where in its front.
    #[inline(always)]
    fn children_with_places<'a>(&'a self, node: &Node) -> impl Iterator<Item = (&'a Node, &'a [u32])> {
        let with_places = |child: &'a Node| (child, &self.places_in_parent[child.rows.clone()]);
        self.children(node).map(with_places)
    }

    #[inline(always)]
    fn assemble_panel(
        &self,
        node: &Node,
        matrix: &BlockMatrix,
        shift: &[f64],
        updates: &[Lane],
        panel: &mut [Lane],
    ) {
        panel[..node.panel.len()].fill([0.0; ROWS]);
        self.add_sources(node, matrix, shift, panel);
        for (child, places) in self.children_with_places(node) {
            let child = updates[with_margin(&child.update)].as_flattened();
            add_to_panel(child, places, 3 * node.width(), panel.as_flattened_mut());
        }
    }

    /// Factorises the panel and begins the update.
    #[inline(always)]
    fn eliminate<const FUSED: bool>(
        &self,
        node: &Node,
        panel: &mut [Lane],
        update: &mut [Lane],
    ) -> Result<(), NotPositiveDefinite> {
        let width = 3 * node.width();
        dense::factor_panel::<FUSED>(panel, width).map_err(|column| NotPositiveDefinite {
            row: self.order[node.columns.start + column],
        })?;
        let below = &panel[triangle_strips(node.width()) * width..];
        dense::negative_square::<FUSED>(update, below, width, 3 * node.rows.len());
        Ok(())
    }

    #[inline(always)]
    fn assemble_update(&self, node: &Node, updates: &[Lane], update: &mut [Lane]) {
        for (child, places) in self.children_with_places(node) {
            let child = updates[with_margin(&child.update)].as_flattened();
            add_to_update(child, places, 3 * node.width(), update.as_flattened_mut());
        }
    }

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
fn add_to_panel(child: &[f64], places: &[u32], width: usize, panel: &mut [f64]) {
    let inside = places.partition_point(|&place| 3 * (place as usize) < width);
    for (row, &target) in places.iter().enumerate() {
        let from = &child[first_number(update_lane(row / SLOTS, 0), row)..];
        let to = &mut panel[first_number(target as usize / SLOTS * width, target as usize)..];
        add_blocks(from, to, &places[..inside.min(row + 1)], 0);
    }
}

/// Adds to an update what a child leaves there.
#[inline(always)]
fn add_to_update(child: &[f64], places: &[u32], width: usize, update: &mut [f64]) {
    let inside = places.partition_point(|&place| 3 * (place as usize) < width);
    let above = triangle_strips(width / 3) * SLOTS;
    for (row, &target) in places.iter().enumerate().skip(inside) {
        let target = target as usize - above;
        let from = &child[first_number(update_lane(row / SLOTS, inside), row)..];
        let to = &mut update[first_number(update_lane(target / SLOTS, 0), target)..];
        add_blocks(from, to, &places[inside..=row], above);
    }
}

/// Where a block row begins in the lane that its strip begins with.
#[inline(always)]
fn first_number(lane: usize, row: usize) -> usize {
    ROWS * lane + row % SLOTS * 3
}

/// Adds the blocks of one row to those of another, one after the other to those at `places`, counted from `origin`.
#[inline(always)]
fn add_blocks(from: &[f64], to: &mut [f64], places: &[u32], origin: usize) {
    const BLOCK: usize = 3 * ROWS;
    // A fourth number, of another row, goes along unchanged: one instruction then does for all.
    const REACH: usize = 2 * ROWS + 4;
    for (column, &place) in places.iter().enumerate() {
        let from = &from[BLOCK * column..][..REACH];
        let to = &mut to[BLOCK * (place as usize - origin)..][..REACH];
        // Sums first, then stores: the compiler does not know that they lie apart.
        let mut sums = [[0.0; 4]; 3];
        for (axis, sums) in sums.iter_mut().enumerate() {
            for (row, sum) in sums.iter_mut().enumerate() {
                let added = if row < 3 { from[ROWS * axis + row] } else { 0.0 };
                *sum = to[ROWS * axis + row] + added;
            }
        }
        for (axis, sums) in sums.iter().enumerate() {
            to[ROWS * axis..][..4].copy_from_slice(sums);
        }
    }
}

/// First lane of a block column in a strip of an update: strip k has the columns of strips 0..=k.
#[inline(always)]
fn update_lane(strip: usize, column: usize) -> usize {
    ROWS * strip * (strip + 1) / 2 + 3 * column
}

#[cfg(test)]
mod tests;
