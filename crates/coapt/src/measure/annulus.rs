//! Size and shape of the annulus.

use serde::Serialize;

use super::distance::triangle_area;
use super::plane::{AnnularPlane, annular_plane, edges_closed, length_closed, vector_area};
use crate::Vec3;
use crate::model::Model;

/// Size and shape of the annulus. Diameters are straight distances in space between landmarks.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AnnulusMeasures {
    /// Anteroposterior (septolateral) diameter: mid-anterior to mid-posterior [mm].
    pub ap_mm: f64,
    /// Commissural width: anterolateral to posteromedial commissure [mm].
    pub commissural_mm: f64,
    /// Left to right trigone [mm].
    pub intertrigonal_mm: f64,
    /// Length of the annulus curve [mm].
    pub circumference_mm: f64,
    /// Area enclosed by the annulus' projection on the annular plane [mm²]. The plane is the least-squares plane
    /// of the annulus resampled evenly along its length.
    pub area_2d_mm2: f64,
    /// Area of the fan of triangles from the centre of the annulus to its edges [mm²].
    pub area_3d_mm2: f64,
    /// Highest minus lowest point over the annular plane [mm], as `SlicerHeart` defines it. The height of the
    /// anterior horn above the commissures is larger (6.9 against 5.5 mm on a normal human saddle).
    pub height_mm: f64,
    /// Annular height to commissural width ratio [1]: `height_mm / commissural_mm` (Salgo 2002).
    pub ahcwr: f64,
    /// Angle mid-anterior, midpoint of the commissures, mid-posterior [degree]; 180 is flat.
    pub nonplanarity_angle_deg: f64,
    /// Anteroposterior over commissural diameter [1].
    pub sphericity: f64,
}

/// The annulus curve in the given positions.
pub(super) fn annulus_curve(model: &Model, positions_mm: &[Vec3]) -> Vec<Vec3> {
    model.annulus.iter().map(|&v| positions_mm[v as usize]).collect()
}

/// The annular plane, with its first axis towards the middle of the anterior annulus.
pub(super) fn plane_of(model: &Model, positions_mm: &[Vec3]) -> Option<AnnularPlane> {
    let curve = annulus_curve(model, positions_mm);
    let toward = curve.get(model.landmarks.mid_anterior).copied().unwrap_or_default();
    annular_plane(&curve, toward)
}

/// Measures the annulus; all zero when there is none.
pub(super) fn annulus(model: &Model, positions_mm: &[Vec3]) -> AnnulusMeasures {
    let curve = annulus_curve(model, positions_mm);
    let Some(plane) = plane_of(model, positions_mm) else {
        return AnnulusMeasures::default();
    };
    let at = |index: usize| curve.get(index).copied().unwrap_or(plane.origin);
    let marks = &model.landmarks;
    let (anterior, posterior) = (at(marks.mid_anterior), at(marks.mid_posterior));
    let (lateral, medial) = (at(marks.commissure_anterolateral), at(marks.commissure_posteromedial));
    let ap_mm = (anterior - posterior).norm();
    let commissural_mm = (lateral - medial).norm();
    let height_mm = height(&curve, &plane);
    AnnulusMeasures {
        ap_mm,
        commissural_mm,
        intertrigonal_mm: (at(marks.trigone_left) - at(marks.trigone_right)).norm(),
        circumference_mm: length_closed(&curve),
        area_2d_mm2: vector_area(&curve).dot(&plane.normal).abs(),
        area_3d_mm2: edges_closed(&curve).map(|[a, b]| triangle_area([plane.origin, a, b])).sum(),
        height_mm,
        ahcwr: ratio(height_mm, commissural_mm),
        nonplanarity_angle_deg: angle_deg(anterior, (lateral + medial) / 2.0, posterior),
        sphericity: ratio(ap_mm, commissural_mm),
    }
}

fn height(curve: &[Vec3], plane: &AnnularPlane) -> f64 {
    let (low, high) = curve.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &p| {
        let z = plane.local(p).z;
        (low.min(z), high.max(z))
    });
    high - low
}

fn angle_deg(a: Vec3, corner: Vec3, b: Vec3) -> f64 {
    (a - corner).angle(&(b - corner)).to_degrees()
}

fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::test_models::{model_of, saddle};
    use super::*;

    fn measured(n: usize, cc: f64, ap: f64, fraction: f64, horns: [f64; 2]) -> AnnulusMeasures {
        let curve = saddle(n, cc, ap, fraction, horns);
        let mut model = model_of(curve.clone(), vec![], vec![], (0..n as u32).collect(), vec![]);
        model.landmarks.commissure_anterolateral = 0;
        model.landmarks.mid_anterior = n / 4;
        model.landmarks.commissure_posteromedial = n / 2;
        model.landmarks.mid_posterior = 3 * n / 4;
        annulus(&model, &curve)
    }

    /// The D-shaped saddle of two half ellipses with horns 6.9 and 2.2 mm: independently computed figures, given
    /// to the digits below, so half a unit of the last digit is the tolerance. The projected area has a closed form,
    /// π·CC·AP/4 = 835.7, on the commissural plane; the fitted plane is tilted by a few degrees, hence 1 mm².
    #[test]
    fn healthy_human_saddle() {
        let m = measured(720, 38.0, 28.0, 0.40, [6.9, 2.2]);
        assert!((m.circumference_mm - 107.0).abs() < 0.5, "{m:?}");
        assert!((m.area_3d_mm2 - 869.0).abs() < 0.5, "{m:?}");
        assert!((m.height_mm - 5.5).abs() < 0.05, "{m:?}");
        assert!((m.nonplanarity_angle_deg - 141.0).abs() < 0.5, "{m:?}");
        assert!((m.commissural_mm - 38.0).abs() < 1e-9);
        // Straight in space: the horns differ by 4.7 mm over 28 mm.
        assert!((m.ap_mm - (28f64.powi(2) + 4.7f64.powi(2)).sqrt()).abs() < 1e-9);
        assert!((m.ahcwr - m.height_mm / 38.0).abs() < 1e-15);
    }

    /// The other shapes of the same family, against the same independent figures.
    #[test]
    fn diseased_saddles() {
        for (cc, ap, f, horns, perimeter, area, height, angle) in [
            (43.0, 34.0, 0.45, [5.9, 1.2], 123.0, 1171.0, 4.3, 155.0),
            (46.0, 40.0, 0.45, [4.5, 0.8], 136.0, 1458.0, 3.2, 164.0),
            (30.0, 22.0, 0.42, [4.5, 1.5], 84.0, 532.0, 3.5, 147.0),
        ] {
            let m = measured(720, cc, ap, f, horns);
            assert!((m.circumference_mm - perimeter).abs() < 0.6, "{m:?}");
            assert!((m.area_3d_mm2 - area).abs() < 1.0, "{m:?}");
            assert!((m.height_mm - height).abs() < 0.06, "{m:?}");
            assert!((m.nonplanarity_angle_deg - angle).abs() < 0.6, "{m:?}");
        }
    }

    /// A flat ellipse has no height, a straight angle and the area π·a·b; the polygon of 720 points is smaller by
    /// (2π/720)²/6 = 1.3e-5 of it.
    #[test]
    fn flat_ellipse() {
        let m = measured(720, 40.0, 30.0, 0.5, [0.0, 0.0]);
        let exact = std::f64::consts::PI * 300.0;
        assert!(m.height_mm < 1e-12 && (m.nonplanarity_angle_deg - 180.0).abs() < 1e-5);
        assert!((m.area_2d_mm2 / exact - 1.0).abs() < 1.4e-5 && (m.area_3d_mm2 - m.area_2d_mm2).abs() < 1e-9);
        assert!((m.sphericity - 0.75).abs() < 1e-12);
    }

    /// No annulus, no numbers.
    #[test]
    fn none_is_all_zero() {
        let model = model_of(vec![], vec![], vec![], vec![], vec![]);
        assert_eq!(annulus(&model, &[]), AnnulusMeasures::default());
    }
}
