//! Which way is which in a valve: what views, sections and heights are taken along.

use serde::{Deserialize, Serialize};

use super::annulus::plane_of;
use super::usable_positions;
use crate::Vec3;
use crate::model::Model;

/// Where the annulus lies and how it is turned; directions are of length one and at right angles to each other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ValveFrame {
    /// Centre of the annulus by arc length [mm].
    pub centre_mm: [f64; 3],
    /// Normal of the plane that fits the annulus best, to the atrium.
    pub to_atrium: [f64; 3],
    /// In that plane, to the middle of the anterior annulus.
    pub to_anterior: [f64; 3],
}

/// The frame of a valve in the given positions, shape `[vertex]`; none where the annulus has no plane.
pub fn valve_frame(model: &Model, positions_mm: &[Vec3]) -> Option<ValveFrame> {
    let plane = plane_of(model, usable_positions(model, positions_mm))?;
    Some(ValveFrame {
        centre_mm: plane.origin.into(),
        to_atrium: plane.normal.into(),
        to_anterior: plane.u.into(),
    })
}

/// Height of each leaflet vertex above the annular plane [mm], negative towards the ventricle, shape `[leaflet vertex]`; zero
/// where the annulus has no plane.
pub fn annulus_distance_mm(model: &Model, positions_mm: &[Vec3]) -> Vec<f64> {
    let positions_mm = usable_positions(model, positions_mm);
    let plane = plane_of(model, positions_mm);
    let leaflets = positions_mm.iter().take(model.leaflet_vertex_count);
    leaflets
        .map(|&p| plane.map_or(0.0, |plane| plane.local(p).z))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::test_models::{commissure_valve, fold_state};
    use super::*;

    /// The frame turns and moves with the valve, and heights stay: 1e-9 of sizes of some 10 mm is rounding.
    #[test]
    fn moves_with_the_valve() {
        let model = commissure_valve(12, 6);
        let positions = fold_state(&model, 0.4);
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -0.7, 1.1);
        let moved: Vec<Vec3> = positions
            .iter()
            .map(|p| turn * p + Vec3::new(30.0, -20.0, 5.0))
            .collect();
        let (frame, turned) = (
            valve_frame(&model, &positions).unwrap(),
            valve_frame(&model, &moved).unwrap(),
        );
        for (before, after) in [
            (frame.to_atrium, turned.to_atrium),
            (frame.to_anterior, turned.to_anterior),
        ] {
            assert!((turn * Vec3::from(before) - Vec3::from(after)).norm() < 1e-9);
            assert!((Vec3::from(after).norm() - 1.0).abs() < 1e-12);
        }
        let heights = annulus_distance_mm(&model, &positions);
        let after = annulus_distance_mm(&model, &moved);
        assert!(heights.iter().zip(&after).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    /// Leaflets that hang down into the ventricle are below the plane, their annulus in it: that of this valve is flat.
    #[test]
    fn ventricle_is_below() {
        let model = commissure_valve(12, 6);
        let heights = annulus_distance_mm(&model, &fold_state(&model, 0.4));
        for &vertex in &model.annulus {
            assert!(heights[vertex as usize].abs() < 1e-9);
        }
        let lowest = heights.iter().copied().fold(0.0, f64::min);
        assert!(lowest < -1.0 && heights.iter().all(|&h| h < 1e-9), "{lowest}");
    }
}
