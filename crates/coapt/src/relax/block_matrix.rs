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
    pub fn with_pattern(size: usize, places: &[[u32; 2]]) -> Self {
        let mut matrix = Self::without_blocks(size, places);
        matrix.make_blocks(Vec::new());
        matrix
    }

    /// As [`Self::with_pattern`], without room for the numbers.
    pub fn without_blocks(size: usize, places: &[[u32; 2]]) -> Self {
        // Sorted by row and then, stably, by column: two counting sorts.
        let diagonal = (0..size as u32).map(|index| [index, index]);
        let lower = places.iter().map(|&[i, j]| [i.max(j), i.min(j)]);
        let mut by_row = Vec::new();
        counting_sort(size, lower.chain(diagonal), |&[row, _]| row, &mut by_row);
        let mut sorted = Vec::new();
        counting_sort(size, by_row.iter().copied(), |&[_, column]| column, &mut sorted);
        sorted.dedup();
        let mut column_starts = vec![0; size + 1];
        for [_, column] in &sorted {
            column_starts[*column as usize + 1] += 1;
        }
        for column in 0..size {
            column_starts[column + 1] += column_starts[column];
        }
        let rows: Vec<u32> = sorted.iter().map(|&[row, _]| row).collect();
        Self {
            column_starts,
            rows,
            blocks: Vec::new(),
        }
    }

    /// Adds the places of another pattern to a matrix without blocks, unless there were more than `limit` then.
    pub fn unite(&mut self, other: &Self, limit: usize) {
        let mut united = Self {
            column_starts: vec![0],
            rows: Vec::with_capacity(self.rows.len() + other.rows.len()),
            blocks: Vec::new(),
        };
        for (mine, theirs) in self.column_starts.windows(2).zip(other.column_starts.windows(2)) {
            let [mine, theirs] =
                [(mine, &self.rows), (theirs, &other.rows)].map(|(ends, rows)| &rows[ends[0]..ends[1]]);
            merge_into(mine, theirs, &mut united.rows);
            united.column_starts.push(united.rows.len());
        }
        if united.rows.len() <= limit {
            *self = united;
        }
    }

    /// Makes all blocks, zero, in the room of others.
    pub fn make_blocks(&mut self, mut room: Vec<Mat3>) {
        room.clear();
        room.resize(self.rows.len(), Mat3::zeros());
        self.blocks = room;
    }

    /// The off-diagonal places of the pattern, each once: row, column.
    pub fn places(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        (0..self.size()).flat_map(move |column| {
            let below = self.column_starts[column] + 1..self.column_starts[column + 1];
            below.map(move |slot| [self.rows[slot], column as u32])
        })
    }

    /// Where each block is kept in a matrix whose pattern has all places of this one, shape `[block]`.
    pub fn slots_in(&self, wider: &Self) -> Vec<u32> {
        let mut slots = Vec::with_capacity(self.rows.len());
        for (ends, wide_ends) in self.column_starts.windows(2).zip(wider.column_starts.windows(2)) {
            let wide = (wide_ends[0]..wide_ends[1]).zip(&wider.rows[wide_ends[0]..wide_ends[1]]);
            let mut rows = self.rows[ends[0]..ends[1]].iter().peekable();
            let kept = wide.filter(|(_, row)| rows.next_if_eq(row).is_some());
            slots.extend(kept.map(|(slot, _)| slot as u32));
        }
        slots
    }

    /// Number of block rows.
    pub fn size(&self) -> usize {
        self.column_starts.len() - 1
    }

    /// Sets all blocks to zero.
    pub fn clear(&mut self) {
        self.blocks.fill(Mat3::zeros());
    }

    /// Where the block of `(row, column)` and `(column, row)` is kept; nothing if the pattern has no such place.
    #[inline]
    pub fn slot(&self, row: u32, column: u32) -> Option<usize> {
        let (low, high) = (row.min(column), row.max(column));
        let start = self.column_starts[low as usize];
        if low == high {
            return Some(start);
        }
        let end = self.column_starts[low as usize + 1];
        // Halving takes a fifth less time than looking at each of two dozen rows, a third less than at each of forty.
        let found = self.rows[start..end].binary_search(&high).ok();
        found.map(|offset| start + offset)
    }

    /// Adds a block to a slot, or its transpose where the block lies above the diagonal.
    #[inline]
    pub fn add_at(&mut self, slot: usize, above: bool, block: &Mat3) {
        if above {
            self.blocks[slot] += block.transpose();
        } else {
            self.blocks[slot] += block;
        }
    }

    /// Adds a block at `(row, column)` and, by symmetry, its transpose at `(column, row)`. False if the pattern has no
    /// such place.
    pub fn add(&mut self, row: u32, column: u32, block: &Mat3) -> bool {
        let slot = self.slot(row, column);
        if let Some(slot) = slot {
            self.add_at(slot, row < column, block);
        }
        slot.is_some()
    }

    /// The product with a vector, shape `[size]`.
    pub fn multiply_into(&self, vector: &[Vec3], product: &mut [Vec3]) {
        product.fill(Vec3::zeros());
        for (column, ends) in self.column_starts.windows(2).enumerate() {
            let (rows, blocks) = (&self.rows[ends[0]..ends[1]], &self.blocks[ends[0]..ends[1]]);
            let value = vector[column];
            let mut sum = blocks[0] * value;
            for (&row, block) in rows.iter().zip(blocks).skip(1) {
                product[row as usize] += block * value;
                sum += block.tr_mul(&vector[row as usize]);
            }
            product[column] += sum;
        }
    }
}

/// Appends the rows of two ascending lists, each once.
fn merge_into(mut one: &[u32], mut other: &[u32], merged: &mut Vec<u32>) {
    while let (&[x, ref after_x @ ..], &[y, ref after_y @ ..]) = (one, other) {
        merged.push(x.min(y));
        one = if x <= y { after_x } else { one };
        other = if y <= x { after_y } else { other };
    }
    merged.extend_from_slice(one);
    merged.extend_from_slice(other);
}

/// Sorts places by one of their indices, all below `size`; those with the same stay in order.
fn counting_sort(
    size: usize,
    places: impl Iterator<Item = [u32; 2]> + Clone,
    index: impl Fn(&[u32; 2]) -> u32,
    sorted: &mut Vec<[u32; 2]>,
) {
    let mut next = vec![0_usize; size + 1];
    for place in places.clone() {
        next[index(&place) as usize + 1] += 1;
    }
    for k in 0..size {
        next[k + 1] += next[k];
    }
    sorted.resize(next[size], [0; 2]);
    for place in places {
        let next = &mut next[index(&place) as usize];
        sorted[*next] = place;
        *next += 1;
    }
}
