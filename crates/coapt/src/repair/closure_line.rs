//! Where the leaflets will meet: a guess from the open valve and the closed annulus.

use super::leaflet::{LeafletMargin, leaflet_named};
use super::ring::annulus_targets;
use super::ring_shape::normal_of;
use crate::Vec3;
use crate::mesh::polyline;
use crate::model::Model;
use crate::scene::Fault;

/// The place at a share of the line of closure that lies so far below the plane of the closed annulus [mm]. The leaflets are
/// taken to share the gap between their hinges in proportion to their heights, which puts the middle of the line at 0.61 of the
/// way in the healthy preset, where 0.64 is published; the hinges are at the same share of either half of the annulus.
///
/// # Errors
/// No leaflets `anterior` and `posterior` with margins, or no closed annulus, with `place`.
pub(super) fn closing_place_mm(model: &Model, share: f64, depth_mm: f64, place: &str) -> Result<Vec3, Fault> {
    let mut height_mm = [0.0; 2];
    for (height, name) in height_mm.iter_mut().zip(["anterior", "posterior"]) {
        let margin = LeafletMargin::new(model, leaflet_named(model, name, place)?, place)?;
        let arc_mm = share * margin.length_mm();
        *height = margin
            .height_line(arc_mm, margin.tangent(arc_mm, 4.0), 0.0)
            .length_mm();
    }
    let annulus = annulus_targets(model);
    let landmarks = &model.landmarks;
    let half = |through: usize| {
        half_annulus(
            &annulus,
            landmarks.commissure_anterolateral,
            through,
            landmarks.commissure_posteromedial,
        )
    };
    let [anterior, posterior] = [landmarks.mid_anterior, landmarks.mid_posterior].map(|through| {
        let curve = half(through);
        polyline::point_at(&curve, false, share * polyline::length(&curve, false))
    });
    let [a, p] = height_mm;
    if a + p <= 0.0 {
        return Err(Fault::of_shape(place, "the leaflets have no height there"));
    }
    let between = anterior + (posterior - anterior) * (a / (a + p));
    let normal = normal_of(&annulus);
    let centre = polyline::centroid(&annulus, true);
    Ok(between - normal * (normal.dot(&(between - centre)) + depth_mm))
}

/// The annulus from one of its points to another by way of a third.
fn half_annulus(annulus: &[Vec3], from: usize, through: usize, to: usize) -> Vec<Vec3> {
    let count = annulus.len();
    let steps = |a: usize, b: usize| (b + count - a) % count;
    let forward = steps(from, through) <= steps(from, to);
    let length = if forward { steps(from, to) } else { steps(to, from) };
    let at = |i: usize| {
        if forward {
            (from + i) % count
        } else {
            (from + count - i) % count
        }
    };
    (0..=length).map(|i| annulus[at(i)]).collect()
}
