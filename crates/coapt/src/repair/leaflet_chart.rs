//! Where on a leaflet each vertex is: how high, and how far along.

use crate::Vec3;
use crate::mesh::polyline;
use crate::model::Model;
use crate::repair::leaflet::LeafletMargin;

/// Places on a leaflet. Not numbers for vertices of no face of it.
pub(super) struct Chart {
    /// Distance from the annulus over the sum of those from annulus and margin [1], shape `[leaflet vertex]`.
    pub(super) heights: Vec<f64>,
    /// Place between the commissures [1], as a site is: by the nearest place of the annulus near that, of the margin near that,
    /// and in proportion between; shape `[leaflet vertex]`.
    pub(super) shares: Vec<f64>,
}

/// The chart of a leaflet.
pub(super) fn chart(model: &Model, margin: &LeafletMargin) -> Chart {
    let mut of_leaflet = vec![false; model.leaflet_vertex_count];
    let faces = model.faces.iter().zip(&model.face_leaflet);
    let own = faces.filter(|(_, leaflet)| **leaflet == margin.leaflet);
    own.flat_map(|(face, _)| face)
        .for_each(|&v| of_leaflet[v as usize] = true);
    let hinge = hinge(model, margin, &of_leaflet);
    let hinge_mm = polyline::length(&hinge, false);
    let place = |v: usize| {
        let at = model.rest_mm[v];
        let near = |line: &[Vec3]| polyline::nearest(line, false, at);
        let (Some(up), Some(down), true) = (near(&hinge), near(&margin.points_mm), of_leaflet[v]) else {
            return (f64::NAN, f64::NAN);
        };
        let sum = up.distance_mm + down.distance_mm;
        let height = if sum > 0.0 { up.distance_mm / sum } else { 0.0 };
        let shares = [up.arc_mm / hinge_mm, down.arc_mm / margin.length_mm()];
        (height, shares[0] * (1.0 - height) + shares[1] * height)
    };
    let (heights, shares) = (0..model.leaflet_vertex_count).map(place).unzip();
    Chart { heights, shares }
}

/// The annulus of a leaflet from the anterolateral side to the other.
fn hinge(model: &Model, margin: &LeafletMargin, of_leaflet: &[bool]) -> Vec<Vec3> {
    let count = model.annulus.len();
    let is_own = |i: usize| {
        of_leaflet
            .get(model.annulus[i % count] as usize)
            .copied()
            .unwrap_or(false)
    };
    let start = (0..count)
        .find(|&i| is_own(i) && !is_own(i + count - 1))
        .unwrap_or(0);
    let own = (start..start + count).take_while(|&i| is_own(i));
    let mut points: Vec<Vec3> = own
        .map(|i| model.rest_mm[model.annulus[i % count] as usize])
        .collect();
    let (first, last) = (margin.points_mm[0], margin.points_mm[margin.points_mm.len() - 1]);
    if (points[points.len() - 1] - points[0]).dot(&(last - first)) < 0.0 {
        points.reverse();
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::fixtures::{built, skirt};

    /// On the skirt's anterior leaflet heights are 0 on the annulus and 1 on the margin, the middle column has the share of one
    /// half; the posterior annulus has none.
    #[test]
    fn a_leaflet_is_charted() {
        let model = built(&skirt()).model;
        let margin = LeafletMargin::new(&model, 0, "test").unwrap();
        let chart = chart(&model, &margin);
        let middle = model.annulus[model.landmarks.mid_anterior] as usize;
        assert!((chart.heights[middle], (chart.shares[middle] - 0.5).abs() < 1e-9) == (0.0, true));
        for &v in &margin.vertices {
            assert!((chart.heights[v as usize] - 1.0).abs() < 1e-9);
        }
        let posterior = model.annulus[model.landmarks.mid_posterior] as usize;
        assert!(chart.heights[posterior].is_nan());
    }
}
