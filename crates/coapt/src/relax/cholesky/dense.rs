//! Dense arithmetic on strips of twelve rows: what the factorisation spends its time on.
//!
//! Twelve rows are four blocks and three AVX registers. A tile of twelve by three keeps nine sums in registers, just
//! enough to hide the latency of a multiply-add on two units; wider tiles spill, lower ones wait.

use crate::simd::multiply_add;
use std::cmp::Ordering;
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

/// The Cholesky factor of a 3×3 block, with the inverses of its diagonal.
#[derive(Clone, Copy)]
pub(super) struct Pivot {
    lower: [f64; 3],
    inverse: [f64; 3],
}

impl Pivot {
    /// Factorises rows `first..first + 3` of a tile; nothing unless they are positive definite.
    #[inline(always)]
    pub(super) fn new(tile: &[Lane; 3], first: usize) -> Option<Self> {
        assert!(first <= ROWS - 3);
        let inverse_root = |square: f64| (square > 0.0 && square.is_finite()).then(|| 1.0 / square.sqrt());
        let a = |row: usize, column: usize| tile[column][first + row];
        let x = inverse_root(a(0, 0))?;
        let (l10, l20) = (a(1, 0) * x, a(2, 0) * x);
        let y = inverse_root(a(1, 1) - l10 * l10)?;
        let l21 = (a(2, 1) - l20 * l10) * y;
        let z = inverse_root(a(2, 2) - l20 * l20 - l21 * l21)?;
        Some(Self {
            lower: [l10, l20, l21],
            inverse: [x, y, z],
        })
    }

    /// tile L⁻ᵀ.
    #[inline(always)]
    fn divide<const FUSED: bool>(&self, tile: [Lane; 3]) -> [Lane; 3] {
        let ([l10, l20, l21], [x, y, z]) = (self.lower, self.inverse);
        let [mut first, mut second, mut third] = tile;
        for row in 0..ROWS {
            let a = first[row] * x;
            let b = multiply_add::<FUSED>(-l10, a, second[row]) * y;
            let c = multiply_add::<FUSED>(-l21, b, multiply_add::<FUSED>(-l20, a, third[row])) * z;
            (first[row], second[row], third[row]) = (a, b, c);
        }
        [first, second, third]
    }

    /// Stores the factor in rows `first..first + 3` of its tile, the diagonal inverted, and zeros above.
    #[inline(always)]
    pub(super) fn store(&self, tile: &mut [Lane; 3], first: usize) {
        let ([l10, l20, l21], [x, y, z]) = (self.lower, self.inverse);
        for (lane, column) in tile.iter_mut().zip([[x, l10, l20], [0.0, y, l21], [0.0, 0.0, z]]) {
            lane[..first].fill(0.0);
            lane[first..first + 3].copy_from_slice(&column);
        }
    }
}

/// Factorises a panel of `width` columns in strips, those of its triangle first; says which pivot is not positive.
#[inline(always)]
pub(super) fn factor_panel<const FUSED: bool>(panel: &mut [Lane], width: usize) -> Result<(), usize> {
    for start in (0..width).step_by(CHUNK) {
        let end = width.min(start + CHUNK);
        let below = &mut panel[start / ROWS * width..];
        for chunk in (0..start).step_by(CHUNK) {
            subtract_chunk::<FUSED>(below, width, chunk, start..end);
        }
        factor_chunk::<FUSED>(below, width, start..end)?;
    }
    Ok(())
}

/// Takes from some columns of strips what a chunk of columns before them brings; the first strips are those columns'.
#[inline(always)]
fn subtract_chunk<const FUSED: bool>(strips: &mut [Lane], width: usize, chunk: usize, columns: Range<usize>) {
    for strip in 0..strips.len() / width {
        let (head, rest) = strips.split_at_mut(strip * width);
        let (left, right) = rest[..width].split_at_mut(columns.start);
        let a = &left[chunk..chunk + CHUNK];
        let tiles = right.as_chunks_mut::<3>().0.iter_mut();
        for (tile, column) in tiles.zip((0..columns.len()).step_by(3)) {
            let own = column / ROWS;
            let b = match own.cmp(&strip) {
                Ordering::Less => &head[own * width + chunk..][..CHUNK],
                Ordering::Equal => a,
                // Above the diagonal.
                Ordering::Greater => break,
            };
            *tile = minus_product::<FUSED>(*tile, a, b, column % ROWS);
        }
    }
}

/// Factorises some columns of strips, to which nothing is left to be brought by columns before them.
#[inline(always)]
fn factor_chunk<const FUSED: bool>(
    strips: &mut [Lane],
    width: usize,
    columns: Range<usize>,
) -> Result<(), usize> {
    for column in (0..columns.len()).step_by(3) {
        let (strip, first) = (column / ROWS, column % ROWS);
        let (head, below) = strips.split_at_mut((strip + 1) * width);
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

/// update ← −P Pᵀ, in the lower triangle, for the rows P of a panel below its triangle.
#[inline(always)]
pub(super) fn negative_square<const FUSED: bool>(
    update: &mut [Lane],
    below: &[Lane],
    width: usize,
    rows: usize,
) {
    for start in (0..width).step_by(CHUNK) {
        let chunk = start..width.min(start + CHUNK);
        let mut rest = &mut *update;
        for (strip, a) in below.chunks_exact(width).enumerate() {
            let (target, next) = rest.split_at_mut((strip + 1) * ROWS);
            rest = next;
            let a = &a[chunk.clone()];
            for (tile, column) in target.as_chunks_mut::<3>().0.iter_mut().zip((0..rows).step_by(3)) {
                let b = &below[column / ROWS * width..][chunk.clone()];
                let before = if start == 0 { [[0.0; ROWS]; 3] } else { *tile };
                *tile = minus_product::<FUSED>(before, a, b, column % ROWS);
            }
        }
    }
}
