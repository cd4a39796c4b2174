//! The shortest ways along edges.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::Vec3;

/// The shortest way from each point to the nearest of some others.
pub(crate) struct Ways {
    /// Points with the next one on their way, nearest first. Where ways end points are their own next.
    pub(crate) nearest_first: Vec<(usize, usize)>,
    /// Length of the way [mm], shape `[point]`; infinite where there is none.
    pub(crate) length_mm: Vec<f64>,
}

/// Dijkstra's algorithm from where ways end.
pub(crate) fn ways_to<'a>(ends: &[u32], points_mm: &[Vec3], neighbours: impl Fn(usize) -> &'a [u32]) -> Ways {
    let mut done = vec![false; points_mm.len()];
    let mut length_mm = vec![f64::INFINITY; points_mm.len()];
    let mut nearest_first = Vec::with_capacity(points_mm.len());
    let mut queue = BinaryHeap::new();
    for &v in ends {
        length_mm[v as usize] = 0.0;
        queue.push(Reverse((0, v as usize, v as usize)));
    }
    while let Some(Reverse((bits, v, next))) = queue.pop() {
        if std::mem::replace(&mut done[v], true) {
            continue;
        }
        nearest_first.push((v, next));
        for &n in neighbours(v) {
            let n = n as usize;
            let longer = f64::from_bits(bits) + (points_mm[v] - points_mm[n]).norm();
            if longer < length_mm[n] {
                length_mm[n] = longer;
                // Bits of non-negative numbers are in the order of the numbers; ties go to the lower vertex.
                queue.push(Reverse((longer.to_bits(), n, v)));
            }
        }
    }
    Ways {
        nearest_first,
        length_mm,
    }
}
