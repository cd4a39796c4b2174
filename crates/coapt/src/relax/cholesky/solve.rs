//! Solution with a factor: once up the tree with L, once down with Lᵀ.

use super::dense::{Lane, ROWS, SLOTS};
use super::symbolic::{Node, triangle_strips};
use super::{Factor, Symbolic};
use crate::Vec3;
use crate::simd::{Kernel, dispatch, multiply_add};

impl Symbolic {
    /// Solves (A + diag(σ)) x = b, shape `[size]`.
    pub fn solve(&self, factor: &Factor, right: &[Vec3]) -> Vec<Vec3> {
        let mut x = right.to_vec();
        self.solve_in_place(factor, &mut x);
        x
    }

    /// Solves (A + diag(σ)) x = b, shape `[size]`: takes b and leaves x.
    pub fn solve_in_place(&self, factor: &Factor, x: &mut [Vec3]) {
        dispatch(Solution {
            symbolic: self,
            factor,
            x,
        });
    }
}

struct Solution<'a> {
    symbolic: &'a Symbolic,
    factor: &'a Factor,
    x: &'a mut [Vec3],
}

impl Kernel for Solution<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Self { symbolic, factor, x } = self;
        let mut work = Work {
            known: vec![[0.0; ROWS]; symbolic.widest_strips],
            sums: vec![[0.0; 4]; symbolic.widest_strips * ROWS],
        };
        for node in &symbolic.nodes {
            symbolic.solve_lower::<FUSED>(node, &factor.panels[node.panel.clone()], x, &mut work);
        }
        for node in symbolic.nodes.iter().rev() {
            symbolic.solve_upper::<FUSED>(node, &factor.panels[node.panel.clone()], x, &mut work);
        }
    }
}

/// Room for what belongs to the columns of one node.
struct Work {
    /// The part of the solution that is known.
    known: Vec<Lane>,
    /// What later rows take from each column, in four parts.
    sums: Vec<[f64; 4]>,
}

impl Symbolic {
    #[inline(always)]
    fn solve_lower<const FUSED: bool>(&self, node: &Node, panel: &[Lane], x: &mut [Vec3], work: &mut Work) {
        let width = 3 * node.width();
        let (triangle, below) = panel.split_at(triangle_strips(node.width()) * width);
        let columns = self.order[node.columns.clone()].chunks(SLOTS);
        for (strip, (lanes, columns)) in triangle.chunks_exact(width).zip(columns).enumerate() {
            let (left, own) = lanes.split_at(strip * ROWS);
            let mut lane = gather(columns, x);
            subtract_product::<FUSED>(left, work.known.as_flattened(), &mut lane);
            divide_lower::<FUSED>(own, &mut lane);
            work.known[strip] = lane;
            scatter(&lane, columns, x);
        }
        let rows = self.rows[node.rows.clone()].chunks(SLOTS);
        for (lanes, rows) in below.chunks_exact(width).zip(rows) {
            let mut lane = gather(rows, x);
            subtract_product::<FUSED>(lanes, work.known.as_flattened(), &mut lane);
            scatter(&lane, rows, x);
        }
    }

    #[inline(always)]
    fn solve_upper<const FUSED: bool>(&self, node: &Node, panel: &[Lane], x: &mut [Vec3], work: &mut Work) {
        let width = 3 * node.width();
        let (triangle, below) = panel.split_at(triangle_strips(node.width()) * width);
        let sums = &mut work.sums[..width];
        sums.fill([0.0; 4]);
        let rows = self.rows[node.rows.clone()].chunks(SLOTS);
        for (lanes, rows) in below.chunks_exact(width).zip(rows) {
            add_transposed_product::<FUSED>(lanes, &gather(rows, x), sums);
        }
        let columns = self.order[node.columns.clone()].chunks(SLOTS);
        for (strip, (lanes, columns)) in triangle.chunks_exact(width).zip(columns).enumerate().rev() {
            let (left, own) = lanes.split_at(strip * ROWS);
            let lane = divide_upper::<FUSED>(own, &gather(columns, x), &sums[strip * ROWS..]);
            add_transposed_product::<FUSED>(left, &lane, sums);
            scatter(&lane, columns, x);
        }
    }
}

/// lane ← L⁻¹ lane, for the triangle of one strip: diagonal inverted, zeros above.
#[inline(always)]
fn divide_lower<const FUSED: bool>(triangle: &[Lane], lane: &mut Lane) {
    for (block, first) in triangle.chunks_exact(3).zip([0, 3, 6, 9]) {
        let [a, b, c] = [&block[0], &block[1], &block[2]];
        let x = lane[first] * a[first];
        let y = multiply_add::<FUSED>(-a[first + 1], x, lane[first + 1]) * b[first + 1];
        let z = multiply_add::<FUSED>(-a[first + 2], x, lane[first + 2]);
        let z = multiply_add::<FUSED>(-b[first + 2], y, z) * c[first + 2];
        let mut rest = *lane;
        for row in 0..ROWS {
            let value = multiply_add::<FUSED>(-a[row], x, rest[row]);
            let value = multiply_add::<FUSED>(-b[row], y, value);
            rest[row] = multiply_add::<FUSED>(-c[row], z, value);
        }
        *lane = rest;
        lane[first..first + 3].copy_from_slice(&[x, y, z]);
    }
}

/// L⁻ᵀ (lane − sums), for the triangle of one strip.
#[inline(always)]
fn divide_upper<const FUSED: bool>(triangle: &[Lane], lane: &Lane, sums: &[[f64; 4]]) -> Lane {
    let mut known = [0.0; ROWS];
    for (block, first) in triangle.chunks_exact(3).zip([0, 3, 6, 9]).rev() {
        let mut sums = [sums[first], sums[first + 1], sums[first + 2]];
        // What is not known yet counts as zero.
        add_transposed_product::<FUSED>(block, &known, &mut sums);
        let mut right = [0.0; 3];
        for (axis, sum) in sums.iter().enumerate() {
            right[axis] = lane[first + axis] - ((sum[0] + sum[1]) + (sum[2] + sum[3]));
        }
        let [a, b, c] = [&block[0], &block[1], &block[2]];
        let z = right[2] * c[first + 2];
        let y = multiply_add::<FUSED>(-b[first + 2], z, right[1]) * b[first + 1];
        let x = multiply_add::<FUSED>(-a[first + 2], z, right[0]);
        let x = multiply_add::<FUSED>(-a[first + 1], y, x) * a[first];
        known[first..first + 3].copy_from_slice(&[x, y, z]);
    }
    known
}

/// target −= strip · vector.
#[inline(always)]
fn subtract_product<const FUSED: bool>(lanes: &[Lane], vector: &[f64], target: &mut Lane) {
    // Three sums in turn hide the latency of the multiply-add; widths are multiples of three.
    let mut sums = [[0.0; ROWS]; 3];
    for (lanes, values) in lanes.chunks_exact(3).zip(vector.chunks_exact(3)) {
        for (sum, (lane, value)) in sums.iter_mut().zip(lanes.iter().zip(values)) {
            for row in 0..ROWS {
                sum[row] = multiply_add::<FUSED>(lane[row], *value, sum[row]);
            }
        }
    }
    for row in 0..ROWS {
        target[row] -= (sums[0][row] + sums[1][row]) + sums[2][row];
    }
}

/// sums += stripᵀ vector, each sum in four parts.
#[inline(always)]
fn add_transposed_product<const FUSED: bool>(lanes: &[Lane], vector: &Lane, sums: &mut [[f64; 4]]) {
    for (lanes, sums) in lanes.as_chunks::<3>().0.iter().zip(sums.as_chunks_mut::<3>().0) {
        // In a copy, which the compiler knows to lie apart from the lanes.
        let mut parts = *sums;
        for third in 0..3 {
            for (lane, parts) in lanes.iter().zip(&mut parts) {
                for (part, sum) in parts.iter_mut().enumerate() {
                    let row = third * 4 + part;
                    *sum = multiply_add::<FUSED>(lane[row], vector[row], *sum);
                }
            }
        }
        *sums = parts;
    }
}

/// The values at up to four block rows, with zeros after them.
#[inline(always)]
fn gather(rows: &[u32], x: &[Vec3]) -> Lane {
    let mut lane = [0.0; ROWS];
    for (part, &row) in lane.as_chunks_mut::<3>().0.iter_mut().zip(rows) {
        *part = x[row as usize].into();
    }
    lane
}

#[inline(always)]
fn scatter(lane: &Lane, rows: &[u32], x: &mut [Vec3]) {
    for (part, &row) in lane.as_chunks::<3>().0.iter().zip(rows) {
        x[row as usize] = (*part).into();
    }
}
