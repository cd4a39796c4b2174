//! Leaflet areas and strains.

use serde::{Deserialize, Serialize};

use super::distance::triangle_area;
use super::statistics::percentile;
use super::surface::{Surface, leaflet_bit, surface};
use crate::Vec3;
use crate::model::Model;

/// One leaflet's area and strain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeafletMeasures {
    /// Name.
    pub name: String,
    /// Area in the open, unloaded valve [mm²].
    pub area_rest_mm2: f64,
    /// Area as measured [mm²].
    pub area_mm2: f64,
    /// 95th percentile of the strain `l/L₀ - 1` of the edges of this leaflet's faces [mm/mm], interpolated linearly between
    /// ranks.
    pub strain_p95: f64,
}

/// Measures each leaflet.
pub(super) fn leaflets(model: &Model, s: &Surface) -> Vec<LeafletMeasures> {
    let mut area = vec![[0.0; 2]; model.leaflets.len()];
    for (f, &leaflet) in s.face_leaflet.iter().enumerate() {
        if let Some([rest, measured]) = area.get_mut(leaflet as usize) {
            *rest += triangle_area(s.rest_corners(f));
            *measured += triangle_area(s.corners(f));
        }
    }
    let strain = edge_strain(s);
    let on_leaflet = |leaflet: usize| -> Vec<f64> {
        let bit = leaflet_bit(leaflet as u32);
        let edges = s.edge_leaflets.iter().zip(&strain);
        edges
            .filter(|(leaflets, _)| *leaflets & bit != 0)
            .map(|(_, &strain)| strain)
            .collect()
    };
    let measured = model.leaflets.iter().zip(area).enumerate();
    measured
        .map(|(i, (leaflet, [area_rest_mm2, area_mm2]))| LeafletMeasures {
            name: leaflet.name.clone(),
            area_rest_mm2,
            area_mm2,
            strain_p95: percentile(on_leaflet(i), 0.95),
        })
        .collect()
}

/// Mean strain of the leaflet edges at each vertex [mm/mm], shape `[vertex]`; zero where there are none. The mean, not the
/// largest, because a single short edge says little of the tissue about it.
pub fn vertex_strain(model: &Model, positions_mm: &[Vec3]) -> Vec<f64> {
    let positions_mm = super::usable_positions(model, positions_mm);
    let mut sum = vec![0.0; positions_mm.len()];
    let mut count = vec![0u32; positions_mm.len()];
    let s = surface(model, positions_mm);
    for (ends, strain) in s.edges.iter().zip(edge_strain(&s)) {
        for &v in ends {
            sum[v as usize] += strain;
            count[v as usize] += 1;
        }
    }
    sum.iter()
        .zip(count)
        .map(|(sum, count)| sum / f64::from(count.max(1)))
        .collect()
}

/// Strain of each edge of the mesh; one of no unloaded length has none.
fn edge_strain(s: &Surface) -> Vec<f64> {
    let rest_mm = |[a, b]: [u32; 2]| (s.rest_mm[a as usize] - s.rest_mm[b as usize]).norm();
    let edges = s.edges.iter();
    edges
        .map(|&ends| strain(s.positions_mm, ends, rest_mm(ends)))
        .collect()
}

/// Strain of a straight element; zero where it has no rest length.
pub(super) fn strain(positions_mm: &[Vec3], [a, b]: [u32; 2], rest_length_mm: f64) -> f64 {
    let length = (positions_mm[a as usize] - positions_mm[b as usize]).norm();
    if rest_length_mm > 0.0 {
        length / rest_length_mm - 1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_models::sheet;
    use super::*;

    /// A sheet of two leaflets stretched by 20 % in x on the one, 10 % on the other: the diagonals strain less than
    /// the edges along x, which are a third of all, so the percentile is that of x. Areas are exact.
    #[test]
    fn stretched_sheet() {
        let model = sheet(8, 8.0, 2);
        let stretch = |p: &Vec3| {
            Vec3::new(
                if p.x < 4.0 {
                    1.2 * p.x
                } else {
                    4.8 + 1.1 * (p.x - 4.0)
                },
                p.y,
                p.z,
            )
        };
        let positions: Vec<Vec3> = model.rest_mm.iter().map(stretch).collect();
        let m = leaflets(&model, &surface(&model, &positions));
        for (leaflet, factor) in m.iter().zip([1.2, 1.1]) {
            assert!((leaflet.area_rest_mm2 - 32.0).abs() < 1e-12);
            assert!((leaflet.area_mm2 - 32.0 * factor).abs() < 1e-12);
            assert!((leaflet.strain_p95 - (factor - 1.0)).abs() < 1e-12, "{leaflet:?}");
        }
        let strain = vertex_strain(&model, &positions);
        // A corner where only an edge along x, strained 0.2, and one along y, not strained, meet.
        let corner = model
            .rest_mm
            .iter()
            .position(|p| p.x == 0.0 && p.y == 8.0)
            .unwrap();
        assert!((strain[corner] - 0.1).abs() < 1e-12, "{}", strain[corner]);
        assert!(
            vertex_strain(&model, &model.rest_mm)
                .iter()
                .all(|e| e.abs() < 1e-15)
        );
    }
}
