//! Dense arithmetic on strips of twelve rows: what the factorisation spends its time on.
//!
//! Twelve rows are four blocks and three AVX registers. A tile of twelve by three keeps nine sums in registers, just
//! enough to hide the latency of a multiply-add on two units; wider tiles spill, lower ones wait.

use super::pivot::Pivot;
use super::shared::{self, Shared};
use crate::simd::{Kernel, multiply_add};
use std::ops::Range;

/// Rows of a strip.
pub(super) const ROWS: usize = 12;
/// Blocks of a strip.
pub(super) const SLOTS: usize = 4;
/// Columns that are brought to others at once: in a strip, 9 kB of the first-level cache. With half as many sums are
/// loaded and stored more often than need be; with twice as many two strips fill the cache: 2 and 5 % slower at 10 000
/// faces.
const CHUNK: usize = 96;
/// One column of a strip.
pub(super) type Lane = [f64; ROWS];

/// tile − a bᵀ, with three rows of b from `first` on; one lane of a and of b for each column of the product.
#[inline(always)]
fn minus_product<const FUSED: bool>(tile: [Lane; 3], a: &[Lane], b: &[Lane], first: usize) -> [Lane; 3] {
    assert!(first <= ROWS - 3);
    let mut sums = tile;
    for (a, b) in a.iter().zip(b) {
        for (column, sum) in sums.iter_mut().enumerate() {
            for (sum, a) in sum.iter_mut().zip(a) {
                *sum = multiply_add::<FUSED>(-b[first + column], *a, *sum);
            }
        }
    }
    sums
}

/// Factorises a panel of `width` columns in strips, those of its triangle first; says which pivot is not positive.
#[inline(always)]
pub(super) fn factor_panel<const FUSED: bool>(panel: &mut [Lane], width: usize) -> Result<(), usize> {
    for start in (0..width).step_by(CHUNK) {
        let columns = start..width.min(start + CHUNK);
        let strips = &mut panel[start / ROWS * width..];
        let (own, below) = strips.split_at_mut(columns.len().div_ceil(ROWS) * width);
        for chunk in (0..start).step_by(CHUNK) {
            subtract_own::<FUSED>(own, width, chunk, columns.clone());
        }
        factor_own::<FUSED>(own, width, columns.clone())?;
        shared::run::<FUSED, _>(Below {
            own,
            strips: below,
            width,
            columns,
        });
    }
    Ok(())
}

/// Takes from the strips of some columns what a chunk of columns before them brings.
#[inline(always)]
fn subtract_own<const FUSED: bool>(own: &mut [Lane], width: usize, chunk: usize, columns: Range<usize>) {
    for (index, start) in columns.clone().step_by(ROWS).enumerate() {
        let (above, rest) = own.split_at_mut(index * width);
        let strip = &mut rest[..width];
        subtract_chunk::<FUSED>(above, strip, width, chunk, columns.start..start);
        let (left, right) = strip.split_at_mut(start);
        let a = &left[chunk..chunk + CHUNK];
        let tiles = right[..ROWS.min(columns.end - start)].as_chunks_mut::<3>();
        for (tile, first) in tiles.0.iter_mut().zip((0..ROWS).step_by(3)) {
            *tile = minus_product::<FUSED>(*tile, a, a, first);
        }
    }
}

/// Takes from some columns of a strip what a chunk of columns before them brings; `own` are those columns' strips.
#[inline(always)]
fn subtract_chunk<const FUSED: bool>(
    own: &[Lane],
    strip: &mut [Lane],
    width: usize,
    chunk: usize,
    columns: Range<usize>,
) {
    let (left, right) = strip.split_at_mut(columns.start);
    let a = &left[chunk..chunk + CHUNK];
    let tiles = right.as_chunks_mut::<3>().0.iter_mut();
    for (tile, column) in tiles.zip((0..columns.len()).step_by(3)) {
        let b = &own[column / ROWS * width + chunk..][..CHUNK];
        *tile = minus_product::<FUSED>(*tile, a, b, column % ROWS);
    }
}

/// Factorises the strips of some columns, to which nothing is left to be brought by columns before them.
#[inline(always)]
fn factor_own<const FUSED: bool>(own: &mut [Lane], width: usize, columns: Range<usize>) -> Result<(), usize> {
    for column in (0..columns.len()).step_by(3) {
        let (strip, first) = (column / ROWS, column % ROWS);
        let (head, below) = own.split_at_mut((strip + 1) * width);
        let (left, tile) = split_tile(&mut head[strip * width + columns.start..], column);
        let sums = minus_product::<FUSED>(*tile, left, left, first);
        let pivot = Pivot::new(&sums, first).ok_or((columns.start + column) / 3)?;
        *tile = pivot.divide::<FUSED>(sums);
        pivot.store(tile, first);
        for strip in below.chunks_exact_mut(width) {
            let (a, tile) = split_tile(&mut strip[columns.start..], column);
            *tile = pivot.divide::<FUSED>(minus_product::<FUSED>(*tile, a, left, first));
        }
    }
    Ok(())
}

/// The lanes left of a block column, and its own.
#[inline(always)]
fn split_tile(strip: &mut [Lane], column: usize) -> (&[Lane], &mut [Lane; 3]) {
    let (left, rest) = strip.split_at_mut(column);
    (left, &mut rest.as_chunks_mut::<3>().0[0])
}

/// Some columns of strips below those columns' own, which are factorised.
struct Below<'a> {
    own: &'a [Lane],
    strips: &'a mut [Lane],
    width: usize,
    columns: Range<usize>,
}

impl Kernel for Below<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Self {
            own, strips, width, ..
        } = self;
        for chunk in (0..self.columns.start).step_by(CHUNK) {
            for strip in strips.chunks_exact_mut(width) {
                subtract_chunk::<FUSED>(own, strip, width, chunk, self.columns.clone());
            }
        }
        for column in (0..self.columns.len()).step_by(3) {
            let own = &own[column / ROWS * width + self.columns.start..];
            let (left, first) = (&own[..column], column % ROWS);
            let pivot = Pivot::load(&own[column..].as_chunks().0[0], first);
            for strip in strips.chunks_exact_mut(width) {
                let (a, tile) = split_tile(&mut strip[self.columns.start..], column);
                *tile = pivot.divide::<FUSED>(minus_product::<FUSED>(*tile, a, left, first));
            }
        }
    }
}

impl Shared for Below<'_> {
    fn products(&self) -> usize {
        let before = self.columns.start + self.columns.len() / 2;
        products(self.strips() * self.columns.len(), before)
    }

    fn strips(&self) -> usize {
        self.strips.len() / self.width
    }

    fn halves(self) -> (Self, Self) {
        let middle = self.strips() / 2 * self.width;
        let (first, second) = self.strips.split_at_mut(middle);
        let columns = self.columns.clone();
        let first = Self {
            strips: first,
            columns,
            ..self
        };
        (
            first,
            Self {
                strips: second,
                ..self
            },
        )
    }
}

/// update ← −P Pᵀ, in the lower triangle, for the rows P of a panel below its triangle.
#[inline(always)]
pub(super) fn negative_square<const FUSED: bool>(
    update: &mut [Lane],
    below: &[Lane],
    width: usize,
    rows: usize,
) {
    shared::run::<FUSED, _>(Square {
        update,
        below,
        width,
        rows,
        strips: 0..rows.div_ceil(ROWS),
    });
}

/// Products of two numbers that so many lanes take, one for each of `columns` in every number.
pub(super) fn products(lanes: usize, columns: usize) -> usize {
    lanes * ROWS * columns
}

/// Some strips of the update.
struct Square<'a> {
    update: &'a mut [Lane],
    below: &'a [Lane],
    width: usize,
    rows: usize,
    strips: Range<usize>,
}

impl Kernel for Square<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Self {
            update, below, width, ..
        } = self;
        for start in (0..width).step_by(CHUNK) {
            let chunk = start..width.min(start + CHUNK);
            let mut rest = &mut *update;
            for strip in self.strips.clone() {
                let (target, next) = rest.split_at_mut((strip + 1) * ROWS);
                rest = next;
                let a = &below[strip * width..][chunk.clone()];
                for (tile, column) in target
                    .as_chunks_mut::<3>()
                    .0
                    .iter_mut()
                    .zip((0..self.rows).step_by(3))
                {
                    let b = &below[column / ROWS * width..][chunk.clone()];
                    let before = if start == 0 { [[0.0; ROWS]; 3] } else { *tile };
                    *tile = minus_product::<FUSED>(before, a, b, column % ROWS);
                }
            }
        }
    }
}

impl Shared for Square<'_> {
    fn products(&self) -> usize {
        products(self.update.len(), self.width)
    }

    fn strips(&self) -> usize {
        self.strips.len()
    }

    fn halves(self) -> (Self, Self) {
        let Range { start, end } = self.strips;
        // Half of the lanes: a strip has as many as its index says.
        let middle = ((start * start + end * end) as f64 / 2.0).sqrt() as usize;
        let middle = middle.clamp(start + 1, end - 1);
        let lanes = ROWS * (middle * (middle + 1) - start * (start + 1)) / 2;
        let (first, second) = self.update.split_at_mut(lanes);
        let first = Self {
            update: first,
            strips: start..middle,
            ..self
        };
        let second = Self {
            update: second,
            strips: middle..end,
            ..self
        };
        (first, second)
    }
}
