//! What a closed valve is judged by: coaptation, orifice, annulus, tenting, forces, strain. One file per measure.
//!
//! All measures are pure functions of the model and the positions. They never look at how the positions were
//! found, so that an imaged closed valve can be measured like a computed one.

pub mod agreement;
pub mod annulus;
pub mod coaptation;
pub mod compare;
pub mod diastole;
pub mod flow;
pub mod forces;
pub mod gap;
pub mod leaflet;
pub mod leaflet_map;
pub mod orifice;
pub mod passage;
pub mod tenting;
pub mod valve_frame;
pub mod visible;

pub(crate) mod atrial_view;
mod distance;
pub(crate) mod indexed_surface;
mod plane;
mod raster;
mod seal;
mod sewn;
pub(crate) mod side;
mod slack;
mod spanning;
pub(crate) mod statistics;
mod surface;
#[cfg(test)]
mod test_models;
mod tree;
mod ways;

use serde::{Deserialize, Serialize};

use crate::Vec3;
use crate::model::Model;

pub use agreement::Agreement;
pub use annulus::AnnulusMeasures;
pub use coaptation::CoaptationMeasures;
pub use diastole::{DiastolicOrifice, diastolic_orifice};
pub use forces::{ChordGroupMeasures, ChordMeasures, PapillaryMeasures, SutureMeasures, chord_forces};
pub use gap::{gap_mm, in_contact};
pub use leaflet::{LeafletMeasures, vertex_strain};
pub use leaflet_map::{LeafletMap, leaflet_map};
pub use orifice::OrificeMeasures;
pub use passage::passage_mm2;
pub use slack::{SLACK_BELOW_N, SlackNeochord, slack_neochordae};
pub use statistics::DistanceStatistics;
pub use tenting::{BillowMeasures, TentingMeasures};
pub use valve_frame::{ValveFrame, annulus_distance_mm, valve_frame};
pub use visible::{VisibleDistance, visible_distance};

/// Everything that is reported of one closed state; the narrowest passage is among it where `measure_with_passage` found it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// Size and shape of the annulus.
    pub annulus: AnnulusMeasures,
    /// How far the leaflets lie on each other.
    pub coaptation: CoaptationMeasures,
    /// What is left open.
    pub orifice: OrificeMeasures,
    /// The closed leaflets below the annular surface.
    pub tenting: TentingMeasures,
    /// The closed leaflets above the annular surface.
    pub billow: BillowMeasures,
    /// Areas and strains, shape `[leaflet]`.
    pub leaflets: Vec<LeafletMeasures>,
    /// Chordal tensions.
    pub chords: ChordMeasures,
    /// Tensions of what holds the leaflets together, shape `[repair that sews]`.
    pub sutures: Vec<SutureMeasures>,
    /// Forces on the papillary muscles, shape `[papillary muscle]`.
    pub papillary: Vec<PapillaryMeasures>,
    /// Force of the valve on the whole annulus [N].
    pub annulus_force_n: [f64; 3],
}

/// Measures the valve in the given positions.
///
/// `positions_mm` is the closed state, shape `[vertex]`. `nodal_reaction_n` is the force that the valve exerts on its
/// support at each prescribed vertex, zero elsewhere, shape `[vertex]`; missing and non-finite entries count as zero.
///
/// No number in the result is ever infinite or undefined: positions of the wrong shape, not finite, or farther out
/// than a kilometre are not measured, and the open valve is measured in their stead. Whether they are a closed valve's is the
/// certificate's to say, which no such positions have.
pub fn measure(model: &Model, positions_mm: &[Vec3], nodal_reaction_n: &[Vec3]) -> Measures {
    let positions_mm = usable_positions(model, positions_mm);
    let surface = surface::surface(model, positions_mm);
    let gaps = gap::gaps(model, &surface);
    let seal = seal::seal(model, &surface, &gaps);
    let (tenting, billow) = tenting::tenting_and_billow(model, &surface);
    Measures {
        annulus: annulus::annulus(model, positions_mm),
        coaptation: coaptation::coaptation(model, &surface, &gaps, &seal),
        orifice: orifice::orifice(model, &surface, &gaps, &seal),
        tenting,
        billow,
        leaflets: leaflet::leaflets(model, &surface),
        chords: forces::chords(model, positions_mm),
        sutures: forces::sutures(model, positions_mm),
        papillary: forces::papillary(model, nodal_reaction_n),
        annulus_force_n: forces::annulus_force_n(model, nodal_reaction_n),
    }
}

/// The same with the narrowest passage ([`passage_mm2`]), which takes once or twice as long again where a valve of 650 triangles is
/// sealed, four to seven times where it leaks.
pub fn measure_with_passage(model: &Model, positions_mm: &[Vec3], nodal_reaction_n: &[Vec3]) -> Measures {
    let mut measures = measure(model, positions_mm, nodal_reaction_n);
    measures.orifice.passage_mm2 = passage_mm2(model, positions_mm);
    measures
}

/// Beyond a kilometre, squares of coordinates no longer leave room for cancellation; no valve is there.
const FARTHEST_MM: f64 = 1e6;

/// The given positions where they can be measured, else the open ones.
fn usable_positions<'a>(model: &'a Model, positions_mm: &'a [Vec3]) -> &'a [Vec3] {
    let usable = positions_mm.len() == model.rest_mm.len()
        && positions_mm
            .iter()
            .all(|p| p.iter().all(|x| x.is_finite() && x.abs() <= FARTHEST_MM));
    if usable { positions_mm } else { &model.rest_mm }
}

#[cfg(test)]
mod tests {
    use super::test_models::{commissure_valve, fold_state, lens_state};
    use super::*;

    fn all_finite(m: &Measures) -> bool {
        let a = &m.annulus;
        let numbers = [
            a.ap_mm,
            a.commissural_mm,
            a.circumference_mm,
            a.area_2d_mm2,
            a.area_3d_mm2,
            a.height_mm,
            a.ahcwr,
            m.coaptation.area_mm2,
            m.coaptation.closure_line_mm,
            m.coaptation.length_mean_mm,
            m.coaptation.length_a2p2_mm,
            m.orifice.area_mm2,
            m.orifice.max_gap_mm,
            m.tenting.volume_ml,
            m.tenting.height_mm,
            m.tenting.area_mm2,
            m.billow.volume_ml,
            m.billow.height_mm,
            m.chords.total_force_n,
        ];
        numbers.iter().all(|x| x.is_finite()) && m.leaflets.iter().all(|l| l.area_mm2.is_finite())
    }

    /// The same input gives the same bytes; this could only fail through iteration order or uninitialised state.
    #[test]
    fn is_deterministic() {
        let model = commissure_valve(12, 6);
        let positions = fold_state(&model, 0.4);
        let first = measure(&model, &positions, &[]);
        assert_eq!(first, measure(&model, &positions, &[]));
        assert!(all_finite(&first));
        assert!(first.coaptation.area_mm2 > 0.0);
    }

    /// Wrong shapes and undefined numbers are measured as the open valve, exactly.
    #[test]
    fn bad_positions_are_measured_as_the_open_valve() {
        let model = commissure_valve(12, 6);
        let open = measure(&model, &model.rest_mm, &[]);
        let mut undefined = fold_state(&model, 0.4);
        undefined[3].x = f64::NAN;
        let mut far = fold_state(&model, 0.4);
        far[3].x = 1e300;
        for bad in [&undefined[..], &far[..], &far[..5], &[]] {
            assert_eq!(measure(&model, bad, &[Vec3::repeat(f64::INFINITY)]), open);
        }
        assert!(open.orifice.area_mm2 > 0.0);
    }

    /// A moved and turned valve has the same measures; 1e-9 of sizes of some 10 mm is rounding. The raster
    /// turns along with the annulus, but pixels on edges may change sides by rounding: 1e-3 of the volume.
    #[test]
    fn rigid_motion_changes_nothing() {
        let model = commissure_valve(12, 6);
        let positions = lens_state(&model, &[(-5.0, 3.0, 2.0)]);
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -0.7, 1.1);
        let move_all = |points: &[Vec3]| -> Vec<Vec3> {
            points
                .iter()
                .map(|p| turn * p + Vec3::new(30.0, -20.0, 5.0))
                .collect()
        };
        let mut moved = model.clone();
        moved.rest_mm = move_all(&model.rest_mm);
        let a = measure(&model, &positions, &[]);
        let b = measure(&moved, &move_all(&positions), &[]);
        assert!((a.coaptation.area_mm2 - b.coaptation.area_mm2).abs() < 1e-9);
        assert!((a.coaptation.length_mean_mm - b.coaptation.length_mean_mm).abs() < 1e-9);
        assert!((a.coaptation.length_a2p2_mm - b.coaptation.length_a2p2_mm).abs() < 1e-9);
        assert!(a.orifice.area_mm2 > 1.0);
        assert!((a.orifice.area_mm2 - b.orifice.area_mm2).abs() < 1e-9);
        assert!((a.orifice.max_gap_mm - b.orifice.max_gap_mm).abs() < 1e-9);
        for (a, b) in a.leaflets.iter().zip(&b.leaflets) {
            assert!((a.area_mm2 - b.area_mm2).abs() < 1e-9);
            assert!((a.strain_p95 - b.strain_p95).abs() < 1e-9);
        }
        assert!((a.annulus.area_3d_mm2 - b.annulus.area_3d_mm2).abs() < 1e-9);
        assert!((a.tenting.volume_ml - b.tenting.volume_ml).abs() < 1e-3 * a.tenting.volume_ml);
    }
}
