//! Which of many pairs of parts are in reach of each other: told by a plane between them, many at once.

use super::pairs::{PairKind, corners};
use crate::Vec3;
use crate::simd::{Kernel, dispatch};

/// Pairs that are told of at once: some kilobytes of the first-level cache.
const COUNT: usize = 64;

/// Four vectors for each of some pairs, one array a coordinate.
type Vectors = [[[f64; COUNT]; 3]; 4];

/// Room for some pairs; kept from call to call.
#[derive(Clone, Debug)]
pub(super) struct Batch {
    pairs: [[u32; 2]; COUNT],
    corners_mm: Vectors,
    /// How the corners move, where pairs are sought for a step.
    motions_mm: Vectors,
    /// Within this distance, before they move, they are in reach [mm].
    reach_mm: [f64; COUNT],
    are_beyond: [bool; COUNT],
    filled: usize,
}

impl Default for Batch {
    fn default() -> Self {
        Self {
            pairs: [[0; 2]; COUNT],
            corners_mm: [[[0.0; COUNT]; 3]; 4],
            motions_mm: [[[0.0; COUNT]; 3]; 4],
            reach_mm: [0.0; COUNT],
            are_beyond: [false; COUNT],
            filled: 0,
        }
    }
}

impl Batch {
    /// Takes out the pairs that a plane shows to be out of reach, which is nine of ten that are. `of` tells of each its vertices and the
    /// distance at which it is in reach [mm], or nothing where it is not wanted; with `motion_mm` two parts are also in reach that may
    /// come so near during that motion.
    pub(super) fn thin_out(
        &mut self,
        pairs: &mut Vec<[u32; 2]>,
        kind: PairKind,
        positions_mm: &[Vec3],
        motion_mm: Option<&[Vec3]>,
        of: impl Fn([u32; 2]) -> Option<([u32; 4], f64)>,
    ) {
        let mut kept = 0;
        self.filled = 0;
        for index in 0..pairs.len() {
            let pair = pairs[index];
            if let Some((vertices, reach_mm)) = of(pair) {
                self.pairs[self.filled] = pair;
                self.reach_mm[self.filled] = reach_mm;
                put(&mut self.corners_mm, self.filled, &vertices, positions_mm);
                if let Some(motion_mm) = motion_mm {
                    put(&mut self.motions_mm, self.filled, &vertices, motion_mm);
                }
                self.filled += 1;
            }
            if self.filled == COUNT {
                self.pass_on(kind, motion_mm.is_some(), pairs, &mut kept);
            }
        }
        self.pass_on(kind, motion_mm.is_some(), pairs, &mut kept);
        pairs.truncate(kept);
    }

    /// Puts the pairs in reach in front of the others; there are never fewer places than pairs that have been looked at.
    fn pass_on(&mut self, kind: PairKind, is_moving: bool, pairs: &mut [[u32; 2]], kept: &mut usize) {
        let filled = std::mem::take(&mut self.filled);
        dispatch(Planes {
            kind,
            is_moving,
            batch: self,
        });
        for (pair, is_beyond) in self.pairs[..filled].iter().zip(&self.are_beyond) {
            pairs[*kept] = *pair;
            *kept += usize::from(!is_beyond);
        }
    }
}

#[inline]
fn put(vectors: &mut Vectors, index: usize, vertices: &[u32; 4], values: &[Vec3]) {
    for (vector, value) in vectors.iter_mut().zip(corners(vertices, values)) {
        for axis in 0..3 {
            vector[axis][index] = value[axis];
        }
    }
}

struct Planes<'a> {
    kind: PairKind,
    is_moving: bool,
    batch: &'a mut Batch,
}

impl Kernel for Planes<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Batch {
            corners_mm,
            motions_mm,
            reach_mm,
            are_beyond,
            ..
        } = self.batch;
        if self.is_moving {
            add_approach(motions_mm, self.kind.across(), reach_mm);
        }
        match self.kind {
            PairKind::PointTriangle => tell::<true>(corners_mm, reach_mm, are_beyond),
            PairKind::EdgeEdge => tell::<false>(corners_mm, reach_mm, are_beyond),
        }
    }
}

/// Adds how much nearer the parts come at most, as [`approach_squared_mm2`](super::pairs::approach_squared_mm2) has it.
#[inline(always)]
fn add_approach(motions_mm: &Vectors, across: &[[usize; 2]], reach_mm: &mut [f64; COUNT]) {
    let mut squared = [0.0_f64; COUNT];
    for &[one, other] in across {
        let ([x, y, z], [u, v, w]) = (&motions_mm[one], &motions_mm[other]);
        for k in 0..COUNT {
            let (x, y, z) = (x[k] - u[k], y[k] - v[k], z[k] - w[k]);
            squared[k] = larger(squared[k], x * x + y * y + z * z);
        }
    }
    for (reach, squared) in reach_mm.iter_mut().zip(&squared) {
        *reach += squared.sqrt();
    }
}

/// How much farther than in reach two parts must be, by the square [1], our choice: rounding changes a gap by some 1e-15 of the edges'
/// length, a millionth of this where edges are as long as the reach, and no pair in reach must be lost to it.
const BEYOND: f64 = 1.0 + 1e-9;

/// Whether two parts are farther apart than their reach along the line between their middles; then they are so altogether. False tells
/// nothing.
///
/// A plane across a direction m separates two parts by the gap between what they reach along m, over |m|.
#[inline(always)]
fn tell<const IS_POINT: bool>(corners_mm: &Vectors, reach_mm: &[f64; COUNT], are_beyond: &mut [bool; COUNT]) {
    let [a, b, c, d] = corners_mm;
    for k in 0..COUNT {
        let from_a = |corner: &[[f64; COUNT]; 3]| [0, 1, 2].map(|axis| corner[axis][k] - a[axis][k]);
        let (b, c, d) = (from_a(b), from_a(c), from_a(d));
        let middle = |axis: usize| match IS_POINT {
            true => (b[axis] + c[axis] + d[axis]) * (1.0 / 3.0),
            false => c[axis] + (d[axis] - b[axis]),
        };
        let m = [middle(0), middle(1), middle(2)];
        let height = |corner: [f64; 3]| m[0] * corner[0] + m[1] * corner[1] + m[2] * corner[2];
        let (b, c, d) = (height(b), height(c), height(d));
        let gap = match IS_POINT {
            true => smaller(b, smaller(c, d)),
            false => smaller(c, d) - larger(b, 0.0),
        };
        let reach = reach_mm[k];
        are_beyond[k] = (gap > 0.0) & (gap * gap > BEYOND * height(m) * (reach * reach));
    }
}

/// One instruction, as [`smaller`]; `f64::max` also minds what is not a number.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::pairs::{approach_squared_mm2, nearest_at};
    use crate::test_numbers::Numbers;

    /// No pair is lost that is in reach or comes into it; of 20,000 pairs some edges apart, which are beyond it with all they move, nine of
    /// ten are taken out.
    #[test]
    fn what_is_taken_out_is_beyond_reach() {
        let mut numbers = Numbers(1);
        const PAIRS: usize = 20_000;
        for (kind, first_count) in [(PairKind::PointTriangle, 1), (PairKind::EdgeEdge, 2)] {
            let mut positions_mm = numbers.vectors(4 * PAIRS);
            for (index, position) in positions_mm.iter_mut().enumerate() {
                position.x += if index % 4 < first_count { 0.0 } else { 2.0 };
            }
            let motion_mm: Vec<Vec3> = numbers.vectors(4 * PAIRS).iter().map(|x| x * 0.1).collect();
            let vertices = |pair: u32| [0, 1, 2, 3].map(|corner| 4 * pair + corner);
            for (motion, reach_factor) in [None, Some(&*motion_mm)].into_iter().flat_map(|motion| {
                // Just out of reach, just within, and one distance for all.
                [0.9999, 1.0001, 0.0].map(|factor| (motion, factor))
            }) {
                let nearest_mm = |pair: u32| {
                    let distance_mm = nearest_at(kind, &vertices(pair), &positions_mm)
                        .separation_mm
                        .norm();
                    let squared =
                        motion.map_or(0.0, |motion| approach_squared_mm2(kind, &vertices(pair), motion));
                    distance_mm - squared.sqrt()
                };
                let reach_mm = |pair: u32| match reach_factor {
                    0.0 => 0.5,
                    factor => factor * nearest_mm(pair),
                };
                let mut kept: Vec<[u32; 2]> = (0..PAIRS as u32).map(|pair| [pair, 0]).collect();
                Batch::default().thin_out(&mut kept, kind, &positions_mm, motion, |[pair, _]| {
                    (pair % 7 != 0).then(|| (vertices(pair), reach_mm(pair)))
                });
                assert!(kept.is_sorted());
                let is_kept = |pair: u32| kept.binary_search(&[pair, 0]).is_ok();
                let (mut taken_out, mut beyond) = (0, 0);
                for pair in 0..PAIRS as u32 {
                    if pair % 7 == 0 {
                        assert!(!is_kept(pair), "not wanted");
                        continue;
                    }
                    let is_beyond = nearest_mm(pair) > reach_mm(pair);
                    assert!(is_kept(pair) || is_beyond, "{kind:?} {pair} {reach_factor}");
                    taken_out += u32::from(!is_kept(pair));
                    beyond += u32::from(is_beyond);
                }
                if reach_factor == 0.0 {
                    assert!(10 * taken_out > 9 * beyond, "{kind:?}: {taken_out} of {beyond}");
                }
            }
        }
    }
}
