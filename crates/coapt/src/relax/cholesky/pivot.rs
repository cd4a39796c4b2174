//! The pivots of the factorisation: blocks on the diagonal.

use super::dense::{Lane, ROWS};
use crate::simd::multiply_add;

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

    /// As [`Self::store`] has left it.
    #[inline(always)]
    pub(super) fn load(tile: &[Lane; 3], first: usize) -> Self {
        assert!(first <= ROWS - 3);
        let [a, b, c] = tile;
        Self {
            lower: [a[first + 1], a[first + 2], b[first + 2]],
            inverse: [a[first], b[first + 1], c[first + 2]],
        }
    }

    /// tile L⁻ᵀ.
    #[inline(always)]
    pub(super) fn divide<const FUSED: bool>(&self, tile: [Lane; 3]) -> [Lane; 3] {
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
