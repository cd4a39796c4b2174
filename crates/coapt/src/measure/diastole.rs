//! How much of the valve is left to be flowed through when it is open.

use serde::Serialize;

use super::annulus::{annulus_curve, plane_of};
use super::plane::edges_closed;
use super::raster::Raster;
use crate::Vec3;
use crate::model::Model;

/// The anatomic orifice of an open valve, by planimetry.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DiastolicOrifice {
    /// All of it [mm²].
    pub area_mm2: f64,
    /// Each opening of it [mm²], the largest first: one, or two beside a clip.
    pub openings_mm2: Vec<f64>,
}

/// Smallest pixel [mm], our choice: openings of 100 mm² are then good to one in a hundred.
const PIXEL_MM: f64 = 0.1;
/// Openings smaller than this [mm²] are left out: between pleats at a commissure, say. Our choice, a thousandth of a healthy valve's.
const LEAST_OPENING_MM2: f64 = 1.0;

/// Measures the orifice of a valve that no pressure closes, at the given positions [mm], shape `[vertex]`.
///
/// The valve is looked at along the normal of the annular plane, as a planimetric echo section is: what of the annulus' inside no
/// leaflet covers is open, however deep the leaflet that covers the rest. In a funnel that is its tightest section, where that is
/// parallel to the plane. Slits narrower than the contact thickness count as closed, the tissue having that thickness.
/// Nothing without an annulus.
pub fn diastolic_orifice(model: &Model, positions_mm: &[Vec3]) -> DiastolicOrifice {
    let positions_mm = super::usable_positions(model, positions_mm);
    let Some(plane) = plane_of(model, positions_mm) else {
        return DiastolicOrifice::default();
    };
    let curve = annulus_curve(model, positions_mm);
    let curve: Vec<Vec3> = curve.iter().map(|&point| plane.local(point)).collect();
    let mut inside = Raster::over(&curve, PIXEL_MM);
    let mut leaflets = inside.clone();
    for [a, b] in edges_closed(&curve) {
        inside.paint([Vec3::zeros(), a, b]);
    }
    for face in &model.faces {
        leaflets.paint(face.map(|vertex| plane.local(positions_mm[vertex as usize])));
    }
    leaflets.close_slits(model.contact.thickness_mm);
    let mut openings_mm2 = leaflets.gaps_mm2(&inside);
    openings_mm2.retain(|area_mm2| *area_mm2 >= LEAST_OPENING_MM2);
    DiastolicOrifice {
        // From zero, since the sum of nothing is minus zero.
        area_mm2: openings_mm2.iter().fold(0.0, |sum, area_mm2| sum + area_mm2),
        openings_mm2,
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_models::{commissure_valve, lens_state, tube};
    use super::*;

    /// A tube is open on its whole section: a polygon of 48 sides, to a pixel along its circumference.
    #[test]
    fn a_tube_is_open() {
        let model = tube(48, 4, 12.0);
        let orifice = diastolic_orifice(&model, &model.rest_mm);
        let side = std::f64::consts::TAU / 48.0;
        let polygon_mm2 = 24.0 * 144.0 * side.sin();
        let tolerance_mm2 = PIXEL_MM * std::f64::consts::TAU * 12.0;
        assert!(
            (orifice.area_mm2 - polygon_mm2).abs() < tolerance_mm2,
            "{orifice:?}"
        );
        assert_eq!(orifice.openings_mm2.len(), 1);
    }

    /// A valve pressed flat but for two lenses, 10 × 4.4 and 6 × 4.4 mm, as beside a clip: two openings. Between the parabolas
    /// y = ±(0.2 + 2 (1 − (x/a)²)) lie 4 a (0.2 + 4/3) mm²; where a lens is narrower than the thickness of 0.5 mm its ends are
    /// closed, some per cent of it, and the straight columns of the mesh cut as much off the parabolas.
    #[test]
    fn two_lenses_are_two_openings() {
        let model = commissure_valve(160, 40);
        assert!(model.contact.thickness_mm < 1.0);
        let state = lens_state(&model, &[(-5.0, 5.0, 2.0), (5.0, 3.0, 2.0)]);
        let orifice = diastolic_orifice(&model, &state);
        let expected_mm2 = [5.0, 3.0].map(|half_length: f64| 4.0 * half_length * (0.2 + 4.0 / 3.0));
        assert_eq!(orifice.openings_mm2.len(), 2, "{orifice:?}");
        for (found, expected) in orifice.openings_mm2.iter().zip(expected_mm2) {
            assert!(
                (found / expected - 1.0).abs() < 0.08,
                "{orifice:?} {expected_mm2:?}"
            );
        }
    }

    #[test]
    fn a_closed_valve_has_none() {
        let model = commissure_valve(40, 20);
        let state = lens_state(&model, &[]);
        let orifice = diastolic_orifice(&model, &state);
        assert_eq!(orifice, DiastolicOrifice::default());
        assert!(orifice.area_mm2.is_sign_positive());
    }
}
