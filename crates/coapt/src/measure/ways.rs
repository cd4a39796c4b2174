//! The shortest way along the leaflets from each vertex to the annulus, in the unloaded mesh.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::surface::Surface;
use crate::Vec3;
use crate::model::Model;

/// How each vertex hangs on the annulus.
pub(super) struct Ways {
    /// Vertices with the next one on their way, nearest first. Vertices of the annulus are their own next.
    pub(super) nearest_first: Vec<(usize, usize)>,
    /// Length of the way [mm], shape `[vertex]`; infinite where there is none.
    length_mm: Vec<f64>,
    /// Unloaded place of the annulus vertex at its end [mm], shape `[vertex]`.
    hinge_mm: Vec<Vec3>,
}

impl Ways {
    /// Whether two vertices lie side by side along the annulus rather than one above the other.
    pub(super) fn beside(&self, v: usize, other: usize) -> bool {
        (self.hinge_mm[v] - self.hinge_mm[other]).norm() > (self.length_mm[v] - self.length_mm[other]).abs()
    }
}

/// Dijkstra's algorithm from the annulus over the edges.
pub(super) fn ways_from_annulus(model: &Model, s: &Surface) -> Ways {
    let count = s.vertex_leaflets.len();
    let mut done = vec![false; count];
    let mut length_mm = vec![f64::INFINITY; count];
    let mut hinge_mm = s.rest_mm[..count].to_vec();
    let mut nearest_first = Vec::with_capacity(count);
    let mut queue = BinaryHeap::new();
    for &v in &model.annulus {
        length_mm[v as usize] = 0.0;
        queue.push(Reverse((0, v as usize, v as usize)));
    }
    while let Some(Reverse((bits, v, parent))) = queue.pop() {
        if std::mem::replace(&mut done[v], true) {
            continue;
        }
        nearest_first.push((v, parent));
        hinge_mm[v] = hinge_mm[parent];
        for &n in s.neighbours(v) {
            let n = n as usize;
            let longer = f64::from_bits(bits) + (s.rest_mm[v] - s.rest_mm[n]).norm();
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
        hinge_mm,
    }
}

#[cfg(test)]
mod tests {
    use super::super::surface::surface;
    use super::super::test_models::grid_model;
    use super::*;

    /// A sheet hanging from its upper row: neighbours in a row lie beside each other, in a column above.
    #[test]
    fn rows_lie_beside_and_columns_above() {
        let columns = 5;
        let mut model = grid_model(columns, 5, 4.0, 4.0);
        model.annulus = (0..columns as u32).collect();
        let s = surface(&model, &model.rest_mm);
        let ways = ways_from_annulus(&model, &s);
        assert!(ways.beside(3 * columns, 3 * columns + 4));
        assert!(!ways.beside(columns, 4 * columns));
    }
}
