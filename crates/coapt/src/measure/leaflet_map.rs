//! The leaflets laid flat: where each point lies between the commissures, and how far from the free margin.

use super::surface::surface;
use crate::mesh::ways::ways_to;
use crate::model::Model;

/// Flat coordinates of the leaflets, for maps of what happens on them. They are of the open valve, so that a point has the same
/// place on all maps of one mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LeafletMap {
    /// Share of the way from the anterolateral (0) to the posteromedial commissure (1), shape `[leaflet vertex]`: the way to the
    /// one over the sum of the ways to both, along edges; -1 where none leads to both.
    pub along: Vec<f64>,
    /// Way to the free margin along edges [mm], shape `[leaflet vertex]`; -1 where none leads there. Along edges a way is longer than the straight
    /// one, by some 8 % on an irregular mesh.
    pub from_margin_mm: Vec<f64>,
}

/// Lays the leaflets of a model flat.
pub fn leaflet_map(model: &Model) -> LeafletMap {
    let s = surface(model, &model.rest_mm);
    let rest_mm = &model.rest_mm[..model.leaflet_vertex_count];
    let lengths = |ends: &[u32]| ways_to(ends, rest_mm, |v| s.neighbours(v)).length_mm;
    let commissure = |index: usize| model.annulus.get(index).copied();
    let marks = &model.landmarks;
    let ends = [marks.commissure_anterolateral, marks.commissure_posteromedial];
    let ways = ends.map(|index| lengths(commissure(index).as_slice()));
    let along = ways[0].iter().zip(&ways[1]).map(|(&lateral, &medial)| {
        let share = lateral / (lateral + medial);
        if share.is_finite() { share } else { -1.0 }
    });
    let margin: Vec<u32> = model
        .margins
        .iter()
        .flat_map(|margin| margin.vertices.iter().copied())
        .collect();
    let reached = |way: f64| if way.is_finite() { way } else { -1.0 };
    LeafletMap {
        along: along.collect(),
        from_margin_mm: lengths(&margin).into_iter().map(reached).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_models::commissure_valve;
    use super::*;

    /// Nothing at the one commissure, all at the other, a half at the middles of the annulus of a symmetric valve (to a hundredth: ways
    /// go along edges); nothing at the margin; and all between.
    #[test]
    fn runs_from_commissure_to_commissure_and_up_from_the_margin() {
        let model = commissure_valve(12, 6);
        let map = leaflet_map(&model);
        let marks = &model.landmarks;
        let along = |index: usize| map.along[model.annulus[index] as usize];
        assert_eq!(along(marks.commissure_anterolateral), 0.0);
        assert_eq!(along(marks.commissure_posteromedial), 1.0);
        for middle in [marks.mid_anterior, marks.mid_posterior] {
            assert!((along(middle) - 0.5).abs() < 0.01, "{}", along(middle));
        }
        for margin in &model.margins {
            for &vertex in &margin.vertices {
                assert_eq!(map.from_margin_mm[vertex as usize], 0.0);
            }
        }
        assert!(map.along.iter().all(|share| (0.0..=1.0).contains(share)));
        assert!(map.from_margin_mm.iter().all(|&way| (0.0..100.0).contains(&way)));
    }

    /// Leaflets in two pieces with the commissures on one of them have no place on the map.
    #[test]
    fn pieces_apart_have_no_place() {
        let mut model = commissure_valve(12, 6);
        let own = model.rest_mm.len() as u32;
        let corner = model.rest_mm[0];
        let piece = [0.0, 1.0, 2.0].map(|x| corner + crate::Vec3::new(x, x * x, 50.0));
        model.rest_mm.splice(own as usize.., piece);
        model.faces.push([own, own + 1, own + 2]);
        model.face_leaflet.push(0);
        model.leaflet_vertex_count += 3;
        let map = leaflet_map(&model);
        assert_eq!(&map.along[own as usize..], [-1.0; 3]);
        assert_eq!(&map.from_margin_mm[own as usize..], [-1.0; 3]);
    }
}
