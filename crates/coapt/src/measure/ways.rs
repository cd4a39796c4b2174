//! The shortest way along the leaflets from each vertex to the annulus, in the unloaded mesh.

use super::surface::Surface;
use crate::Vec3;
use crate::mesh;
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

/// The ways of an unloaded mesh.
pub(super) fn ways_from_annulus(model: &Model, s: &Surface) -> Ways {
    let rest_mm = &s.rest_mm[..s.vertex_leaflets.len()];
    let mesh::ways::Ways {
        nearest_first,
        length_mm,
    } = mesh::ways::ways_to(&model.annulus, rest_mm, |v| s.neighbours(v));
    let mut hinge_mm = rest_mm.to_vec();
    for &(v, next) in &nearest_first {
        hinge_mm[v] = hinge_mm[next];
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
