//! Sparse factorisation A + diag(σ) = L D Lᵀ in 3×3 blocks, L with unit diagonal, D positive definite.
//!
//! Written here because the general libraries are several times slower on this size and shape of matrix, or
//! cost minutes of build. The fill-reducing order comes from a library (AMD); the rest is the up-looking
//! algorithm of Davis, "Direct Methods for Sparse Linear Systems", 2006, chapter 4, on blocks.

use super::block_matrix::BlockMatrix;
use crate::{Mat3, Vec3};

/// What depends on the pattern alone.
#[derive(Clone, Debug, Default)]
pub struct Symbolic {
    /// Original index of each permuted one.
    order: Vec<u32>,
    /// Elimination tree; `NONE` at a root.
    parent: Vec<u32>,
    /// Where each column of L starts.
    column_starts: Vec<usize>,
    /// For each permuted row, the blocks of A left of the diagonal: permuted column, slot, whether transposed.
    left: Vec<Vec<(u32, u32, bool)>>,
}

const NONE: u32 = u32::MAX;

/// A factorisation.
#[derive(Clone, Debug, Default)]
pub struct Factor {
    rows: Vec<u32>,
    blocks: Vec<Mat3>,
    /// Inverses of the diagonal blocks of D.
    pivot_inverses: Vec<Mat3>,
}

/// The matrix is not positive definite: the first block row that shows it, as an original index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotPositiveDefinite {
    /// Block row.
    pub row: u32,
}

impl Symbolic {
    /// Orders the pattern and finds where L fills in.
    pub fn new(matrix: &BlockMatrix) -> Self {
        let order = fill_reducing_order(matrix);
        let mut place = vec![0_u32; order.len()];
        for (new, &old) in order.iter().enumerate() {
            place[old as usize] = new as u32;
        }
        let left = left_blocks(matrix, &place);
        let parent = elimination_tree(&left);
        let mut counts = vec![0_usize; order.len()];
        let mut reach = Reach::new(order.len());
        for row in 0..order.len() {
            for &column in reach.of_row(row, &left, &parent) {
                counts[column as usize] += 1;
            }
        }
        let mut column_starts = vec![0];
        column_starts.extend(counts.iter().scan(0, |sum, count| {
            *sum += count;
            Some(*sum)
        }));
        Self {
            order,
            parent,
            column_starts,
            left,
        }
    }

    /// Factorises; `shift` is added to the diagonal, shape `[size]`.
    pub fn factor(&self, matrix: &BlockMatrix, shift: &[f64]) -> Result<Factor, NotPositiveDefinite> {
        let size = self.order.len();
        let fill = self.column_starts[size];
        let mut factor = Factor {
            rows: vec![0; fill],
            blocks: vec![Mat3::zeros(); fill],
            pivot_inverses: vec![Mat3::zeros(); size],
        };
        let mut ends = self.column_starts.clone();
        let mut work = vec![Mat3::zeros(); size];
        let mut reach = Reach::new(size);
        for row in 0..size {
            let old = self.order[row] as usize;
            let mut pivot =
                matrix.blocks[matrix.column_starts[old]] + Mat3::from_diagonal_element(shift[old]);
            for &(column, slot, transposed) in &self.left[row] {
                let block = matrix.blocks[slot as usize];
                work[column as usize] = if transposed { block.transpose() } else { block };
            }
            for &column in reach.of_row(row, &self.left, &self.parent) {
                let column = column as usize;
                // Y = A_kj − Σ L_ki D_i L_jiᵀ so far; L_kj = Y D_j⁻¹.
                let y = std::mem::replace(&mut work[column], Mat3::zeros());
                for slot in self.column_starts[column]..ends[column] {
                    let target = &mut work[factor.rows[slot] as usize];
                    subtract_product_transposed(target, &y, &factor.blocks[slot]);
                }
                let entry = y * factor.pivot_inverses[column];
                subtract_product_transposed(&mut pivot, &entry, &y);
                factor.rows[ends[column]] = row as u32;
                factor.blocks[ends[column]] = entry;
                ends[column] += 1;
            }
            factor.pivot_inverses[row] =
                invert_positive(&pivot).ok_or(NotPositiveDefinite { row: self.order[row] })?;
        }
        Ok(factor)
    }

    /// Solves (A + diag(σ)) x = b, shape `[size]`.
    pub fn solve(&self, factor: &Factor, right: &[Vec3]) -> Vec<Vec3> {
        let size = self.order.len();
        let mut x: Vec<Vec3> = self.order.iter().map(|&old| right[old as usize]).collect();
        for column in 0..size {
            let value = x[column];
            for slot in self.column_starts[column]..self.column_starts[column + 1] {
                x[factor.rows[slot] as usize] -= factor.blocks[slot] * value;
            }
        }
        for column in (0..size).rev() {
            let mut value = factor.pivot_inverses[column] * x[column];
            for slot in self.column_starts[column]..self.column_starts[column + 1] {
                value -= factor.blocks[slot].tr_mul(&x[factor.rows[slot] as usize]);
            }
            x[column] = value;
        }
        let mut solution = vec![Vec3::zeros(); size];
        for (new, &old) in self.order.iter().enumerate() {
            solution[old as usize] = x[new];
        }
        solution
    }
}

fn fill_reducing_order(matrix: &BlockMatrix) -> Vec<u32> {
    let size = matrix.size();
    let starts: Vec<i64> = matrix.column_starts.iter().map(|&start| start as i64).collect();
    let rows: Vec<i64> = matrix.rows.iter().map(|&row| i64::from(row)).collect();
    match amd::order(size as i64, &starts, &rows, &amd::Control::default()) {
        Ok((order, _, _)) => order.into_iter().map(|index| index as u32).collect(),
        // The pattern is valid by construction; the natural order is right in any case, only slower.
        Err(_) => (0..size as u32).collect(),
    }
}

fn left_blocks(matrix: &BlockMatrix, place: &[u32]) -> Vec<Vec<(u32, u32, bool)>> {
    let mut left = vec![Vec::new(); place.len()];
    for column in 0..matrix.size() {
        for slot in matrix.column_starts[column] + 1..matrix.column_starts[column + 1] {
            let (i, j) = (place[matrix.rows[slot] as usize], place[column]);
            // The stored block is (row, column) = (i, j); row i of the permuted matrix wants columns below i.
            let (row, other, transposed) = if i > j { (i, j, false) } else { (j, i, true) };
            left[row as usize].push((other, slot as u32, transposed));
        }
    }
    left
}

/// Davis 2006, section 4.1: the parent of a column is the first row below it in L.
fn elimination_tree(left: &[Vec<(u32, u32, bool)>]) -> Vec<u32> {
    let mut parent = vec![NONE; left.len()];
    let mut ancestor = vec![NONE; left.len()];
    for (row, entries) in left.iter().enumerate() {
        for &(column, _, _) in entries {
            let mut node = column;
            while node != NONE && node as usize != row {
                let next = std::mem::replace(&mut ancestor[node as usize], row as u32);
                if next == NONE {
                    parent[node as usize] = row as u32;
                }
                node = next;
            }
        }
    }
    parent
}

/// Finds the columns of L that a row has entries in, in an order in which they can be eliminated.
struct Reach {
    mark: Vec<u32>,
    path: Vec<u32>,
    columns: Vec<u32>,
}

impl Reach {
    fn new(size: usize) -> Self {
        Self {
            mark: vec![NONE; size],
            path: Vec::new(),
            columns: Vec::new(),
        }
    }

    fn of_row(&mut self, row: usize, left: &[Vec<(u32, u32, bool)>], parent: &[u32]) -> &[u32] {
        self.columns.clear();
        self.mark[row] = row as u32;
        for &(column, _, _) in &left[row] {
            let mut node = column;
            self.path.clear();
            while node != NONE && self.mark[node as usize] != row as u32 {
                self.mark[node as usize] = row as u32;
                self.path.push(node);
                node = parent[node as usize];
            }
            self.columns.append(&mut self.path);
        }
        // A column comes before its ancestors in the tree: ascending order does that.
        self.columns.sort_unstable();
        &self.columns
    }
}

/// target −= a bᵀ, written out: this is where the factorisation spends its time.
#[inline]
fn subtract_product_transposed(target: &mut Mat3, a: &Mat3, b: &Mat3) {
    for column in 0..3 {
        for k in 0..3 {
            let factor = b[(column, k)];
            for row in 0..3 {
                target[(row, column)] -= a[(row, k)] * factor;
            }
        }
    }
}

/// The inverse of a symmetric 3×3 matrix if it is positive definite.
fn invert_positive(matrix: &Mat3) -> Option<Mat3> {
    let symmetric = (matrix + matrix.transpose()) * 0.5;
    nalgebra::Cholesky::new(symmetric).map(|cholesky| cholesky.inverse())
}
