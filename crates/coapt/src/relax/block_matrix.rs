//! A sparse symmetric matrix of 3×3 blocks, one block row per free vertex.

use crate::{Mat3, Vec3};

/// Lower triangle by block columns.
#[derive(Clone, Debug, Default)]
pub struct BlockMatrix {
    /// Where each column starts in `rows` and `blocks`, shape `[size + 1]`.
    pub column_starts: Vec<usize>,
    /// Row of each block, ascending within a column; the first of a column is its diagonal block.
    pub rows: Vec<u32>,
    /// The blocks.
    pub blocks: Vec<Mat3>,
}

impl BlockMatrix {
    /// A zero matrix with a full diagonal and room for the given off-diagonal places.
    pub fn with_pattern(size: usize, mut places: Vec<[u32; 2]>) -> Self {
        for place in &mut places {
            // (column, row) with column <= row.
            place.sort_unstable();
        }
        places.extend((0..size as u32).map(|index| [index, index]));
        places.sort_unstable();
        places.dedup();
        let mut column_starts = vec![0; size + 1];
        for [column, _] in &places {
            column_starts[*column as usize + 1] += 1;
        }
        for column in 0..size {
            column_starts[column + 1] += column_starts[column];
        }
        let rows: Vec<u32> = places.iter().map(|&[_, row]| row).collect();
        Self {
            column_starts,
            blocks: vec![Mat3::zeros(); rows.len()],
            rows,
        }
    }

    /// Number of block rows.
    pub fn size(&self) -> usize {
        self.column_starts.len() - 1
    }

    /// Sets all blocks to zero.
    pub fn clear(&mut self) {
        self.blocks.fill(Mat3::zeros());
    }

    /// Adds a block at `(row, column)` and, by symmetry, its transpose at `(column, row)`. False if the pattern
    /// has no such place.
    pub fn add(&mut self, row: u32, column: u32, block: &Mat3) -> bool {
        let (low, high) = (row.min(column), row.max(column));
        let start = self.column_starts[low as usize];
        let end = self.column_starts[low as usize + 1];
        let slot = if low == high {
            Ok(0)
        } else {
            self.rows[start..end].binary_search(&high)
        };
        match slot {
            Ok(slot) if row >= column => self.blocks[start + slot] += block,
            Ok(slot) => self.blocks[start + slot] += block.transpose(),
            Err(_) => return false,
        }
        true
    }

    /// The product with a vector, shape `[size]`.
    pub fn multiply(&self, vector: &[Vec3]) -> Vec<Vec3> {
        let mut product = vec![Vec3::zeros(); self.size()];
        for column in 0..self.size() {
            for slot in self.column_starts[column]..self.column_starts[column + 1] {
                let row = self.rows[slot] as usize;
                product[row] += self.blocks[slot] * vector[column];
                if row != column {
                    product[column] += self.blocks[slot].tr_mul(&vector[row]);
                }
            }
        }
        product
    }
}
