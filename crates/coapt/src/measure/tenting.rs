//! The closed leaflets against the annular surface: tenting below it, billow above.

use serde::{Deserialize, Serialize};

use super::annulus::{annulus_curve, plane_of};
use super::plane::{AnnularPlane, edges_closed};
use super::raster::Raster;
use super::sewn::has_seams;
use super::surface::Surface;
use crate::Vec3;
use crate::model::Model;

/// The closed leaflets on the ventricular side of the annular surface.
///
/// The leaflets are seen from the atrium: of what lies above each other the uppermost counts, so that the coaptation
/// zone, which hangs below the line of closure, does not. The annular surface is the fan of triangles from the
/// centre of the annulus to its edges, not the plane. A gap between the leaflets is bridged at the height of its rim.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TentingMeasures {
    /// Greatest depth below the annular surface [mm].
    pub height_mm: f64,
    /// In the section through mid-anterior and mid-posterior annulus, normal to the annular plane: the area between
    /// the line that joins the two and the leaflets below it [mm²]. A seam in it is closed.
    pub area_mm2: f64,
    /// Volume between the annular surface and the leaflets below it [mL].
    pub volume_ml: f64,
}

/// The closed leaflets on the atrial side of the annular surface, defined as in [`TentingMeasures`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BillowMeasures {
    /// Greatest height above the annular surface [mm].
    pub height_mm: f64,
    /// Volume between the annular surface and the leaflets above it [mL].
    pub volume_ml: f64,
}

/// Smallest pixel of the height field [mm]. Our choice: volumes are then good to a few parts in a thousand.
const PIXEL_MM: f64 = 0.25;

/// Pixels are not smaller than this part of a mesh edge: the mesh holds nothing finer.
const PIXELS_PER_EDGE: f64 = 4.0;

/// Columns of the mid-section.
const SECTION_COLUMNS: usize = 512;

/// A seam is closed in the mid-section up to so many contact thicknesses [1], our choice: its edges lie one apart, and bend down. Closed
/// up to one, the section along a quadrangle's seam still fell in, 119 instead of 114 mm²; wider, and it would bridge leaks.
const SEAM_THICKNESSES: f64 = 2.0;

/// Cubic millimetres in a millilitre.
const ML_MM3: f64 = 1000.0;

/// Measures tenting and billow; all zero without an annulus.
pub(super) fn tenting_and_billow(model: &Model, s: &Surface) -> (TentingMeasures, BillowMeasures) {
    at_pixel(model, s, PIXEL_MM.max(s.mean_edge_mm / PIXELS_PER_EDGE))
}

fn at_pixel(model: &Model, s: &Surface, pixel_mm: f64) -> (TentingMeasures, BillowMeasures) {
    let (mut tenting, mut billow) = Default::default();
    let Some(plane) = plane_of(model, s.positions_mm) else {
        return (tenting, billow);
    };
    let curve: Vec<Vec3> = annulus_curve(model, s.positions_mm)
        .iter()
        .map(|&p| plane.local(p))
        .collect();
    let local: Vec<Vec3> = s.positions_mm.iter().map(|&p| plane.local(p)).collect();
    let (fan, top) = fields(&curve, s, &local, pixel_mm, model.contact.thickness_mm);
    let pixel_ml = fan.pixel_mm * fan.pixel_mm / ML_MM3;
    let heights = fan
        .height_mm
        .iter()
        .zip(&top.height_mm)
        .filter(|(f, t)| f.is_finite() && t.is_finite());
    for above in heights.map(|(fan, top)| top - fan) {
        tenting.height_mm = f64::max(tenting.height_mm, -above);
        tenting.volume_ml += (-above).max(0.0) * pixel_ml;
        billow.height_mm = f64::max(billow.height_mm, above);
        billow.volume_ml += above.max(0.0) * pixel_ml;
    }
    let seen = has_seams(model, s).then(|| {
        let mut seen = top;
        seen.close_slits(SEAM_THICKNESSES * model.contact.thickness_mm);
        seen
    });
    tenting.area_mm2 = section_area(model, s, &plane, &local, seen.as_ref());
    (tenting, billow)
}

/// The annular surface and the uppermost leaflet over it, slits narrower than `slit_mm` closed.
fn fields(curve: &[Vec3], s: &Surface, local: &[Vec3], pixel_mm: f64, slit_mm: f64) -> (Raster, Raster) {
    let mut fan = Raster::over(curve, pixel_mm);
    let mut top = fan.clone();
    for [a, b] in edges_closed(curve) {
        fan.paint([Vec3::zeros(), a, b]);
    }
    for face in s.faces {
        top.paint(face.map(|v| local[v as usize]));
    }
    top.close_slits(slit_mm);
    top.bridge(&fan);
    (fan, top)
}

/// Where a leaflet is sewn to itself, the section may run between the edges of the seam, past all of that leaflet: what lies deeper by
/// more than the contact thickness than what is `seen` from the atrium, slits closed, is not the uppermost there.
fn section_area(
    model: &Model,
    s: &Surface,
    plane: &AnnularPlane,
    local: &[Vec3],
    seen: Option<&Raster>,
) -> f64 {
    let mark = |index: usize| {
        model
            .annulus
            .get(index)
            .map(|&v| plane.local(s.positions_mm[v as usize]))
    };
    let ends = (
        mark(model.landmarks.mid_posterior),
        mark(model.landmarks.mid_anterior),
    );
    let (Some(from), Some(to)) = ends else {
        return 0.0;
    };
    let chord = (to - from).xy();
    let length = chord.norm();
    if length.is_nan() || length <= 0.0 {
        return 0.0;
    }
    let width = length / SECTION_COLUMNS as f64;
    let mut top = section_heights(s, local, from, to);
    if let Some(seen) = seen {
        for (column, top) in top.iter_mut().enumerate() {
            let place = from.lerp(&to, (column as f64 + 0.5) / SECTION_COLUMNS as f64);
            let seen = seen.height_at(place.x, place.y);
            *top = seen
                .filter(|seen| seen - *top > model.contact.thickness_mm)
                .unwrap_or(*top);
        }
    }
    let depth = |(i, top): (usize, f64)| {
        let line = from.z + (to.z - from.z) * (i as f64 + 0.5) / SECTION_COLUMNS as f64;
        (line - top).max(0.0)
    };
    bridged(top).into_iter().enumerate().map(depth).sum::<f64>() * width
}

/// The uppermost leaflet at the middle of each column of the section.
fn section_heights(s: &Surface, local: &[Vec3], from: Vec3, to: Vec3) -> Vec<f64> {
    let along = (to - from).xy().normalize();
    let width = (to - from).xy().norm() / SECTION_COLUMNS as f64;
    // Along the section, across it, up.
    let place = |p: Vec3| {
        let r = (p - from).xy();
        Vec3::new(r.dot(&along), along.perp(&r), p.z)
    };
    let mut top = vec![f64::NEG_INFINITY; SECTION_COLUMNS];
    for face in s.faces {
        let corners = face.map(|v| place(local[v as usize]));
        let cut: Vec<Vec3> = (0..3)
            .map(|k| (corners[k], corners[(k + 1) % 3]))
            .filter(|(a, b)| (a.y >= 0.0) != (b.y >= 0.0))
            .map(|(a, b)| a.lerp(&b, a.y / (a.y - b.y)))
            .collect();
        if let &[a, b] = &cut[..] {
            let (a, b) = if a.x <= b.x { (a, b) } else { (b, a) };
            let first = (a.x / width - 0.5).ceil().max(0.0) as usize;
            for (i, height) in top.iter_mut().enumerate().skip(first) {
                let x = (i as f64 + 0.5) * width;
                if x > b.x {
                    break;
                }
                let t = if b.x > a.x { (x - a.x) / (b.x - a.x) } else { 0.0 };
                *height = height.max(a.z + t * (b.z - a.z));
            }
        }
    }
    top
}

/// Fills undefined stretches linearly; at the ends with the nearest value. Nothing defined gives nothing.
fn bridged(mut heights: Vec<f64>) -> Vec<f64> {
    let known: Vec<usize> = (0..heights.len()).filter(|&i| heights[i].is_finite()).collect();
    let (Some(&first), Some(&last)) = (known.first(), known.last()) else {
        return Vec::new();
    };
    let (at_first, at_last) = (heights[first], heights[last]);
    heights[..first].fill(at_first);
    heights[last..].fill(at_last);
    for [a, b] in known.windows(2).map(|w| [w[0], w[1]]) {
        let (low, high) = (heights[a], heights[b]);
        for (i, height) in heights[a..b].iter_mut().enumerate() {
            *height = low + (high - low) * i as f64 / (b - a) as f64;
        }
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::super::surface::surface;
    use super::super::test_models::{commissure_valve, disc, fold_state};
    use super::*;
    use std::f64::consts::PI;

    const R: f64 = 15.0;
    const H: f64 = 5.0;

    fn paraboloid(sign: f64) -> Model {
        disc(48, 96, R, |p| sign * H * (1.0 - p.norm_squared() / (R * R)))
    }

    /// A tent z = -H (1 - r²/R²) holds πR²H/2 and its section 4RH/3. The mesh cuts 1/48² of it off in rings and
    /// (2π/96)²/6 in sectors, together about 1e-3; the raster adds as much. Height: pixel centres next to the apex.
    #[test]
    fn a_tent() {
        let model = paraboloid(-1.0);
        let (tenting, billow) = tenting_and_billow(&model, &surface(&model, &model.rest_mm));
        assert!(
            (tenting.volume_ml / (PI * R * R * H / 2000.0) - 1.0).abs() < 4e-3,
            "{tenting:?}"
        );
        assert!(
            (tenting.area_mm2 / (4.0 * R * H / 3.0) - 1.0).abs() < 2e-3,
            "{tenting:?}"
        );
        assert!((tenting.height_mm - H).abs() < 0.02, "{tenting:?}");
        // The annulus is flat to rounding.
        assert!(billow.height_mm < 1e-9 && billow.volume_ml < 1e-9, "{billow:?}");
    }

    /// The same upside down is all billow.
    #[test]
    fn a_dome() {
        let model = paraboloid(1.0);
        let (tenting, billow) = tenting_and_billow(&model, &surface(&model, &model.rest_mm));
        assert!(
            (billow.volume_ml / (PI * R * R * H / 2000.0) - 1.0).abs() < 4e-3,
            "{billow:?}"
        );
        assert!((billow.height_mm - H).abs() < 0.02, "{billow:?}");
        assert!(
            tenting.height_mm < 1e-9 && tenting.volume_ml < 1e-9 && tenting.area_mm2 < 1e-9,
            "{tenting:?}"
        );
    }

    /// What the pixel does: the volume's error stays below 0.4, 0.6 and 1 % at pixels of 0.25, 0.5 and 1 mm, all but
    /// the first of which are coarser than used on a mesh like this.
    #[test]
    fn pixel_size() {
        let model = paraboloid(-1.0);
        let s = surface(&model, &model.rest_mm);
        for (pixel, bound) in [(0.25, 4e-3), (0.5, 6e-3), (1.0, 1e-2)] {
            let volume = at_pixel(&model, &s, pixel).0.volume_ml;
            let error = (volume / (PI * R * R * H / 2000.0) - 1.0).abs();
            assert!(error < bound, "{pixel} {error}");
        }
    }

    /// Both signs at once: z = c x over a disc whose rim follows it is flat against its own annulus, and z = c x³ on a
    /// flat-rimmed disc, damped to zero at the rim, has equal parts above and below.
    #[test]
    fn both_sides_are_told_apart() {
        let tilted = disc(12, 48, R, |p| 0.2 * p.x);
        let (t, b) = tenting_and_billow(&tilted, &surface(&tilted, &tilted.rest_mm));
        assert!(t.volume_ml < 1e-9 && b.volume_ml < 1e-9);
        let wave = disc(24, 48, R, |p| 0.5 * p.x * (1.0 - p.norm_squared() / (R * R)));
        let (t, b) = tenting_and_billow(&wave, &surface(&wave, &wave.rest_mm));
        // Both halves hold 0.5 · ∫∫ x (1 - r²/R²) = 0.5 · 2 R³ (1/3 - 1/5) = 2/15 R³; 1 % for the coarse rings.
        let exact = 2.0 / 15.0 * R.powi(3) / 1000.0;
        assert!(
            (t.volume_ml / exact - 1.0).abs() < 0.01 && (b.volume_ml / exact - 1.0).abs() < 0.01,
            "{t:?} {b:?}"
        );
    }

    /// A closed valve hangs below its flat annulus, and no deeper than its lowest point, 10 mm.
    #[test]
    fn a_closed_valve_tents() {
        let model = commissure_valve(24, 12);
        let positions = fold_state(&model, 0.4);
        let (t, b) = tenting_and_billow(&model, &surface(&model, &positions));
        assert!(
            t.volume_ml > 0.5 && t.height_mm > 4.0 && t.height_mm <= 10.0,
            "{t:?}"
        );
        assert!(t.area_mm2 > 0.0 && b.volume_ml < 1e-9, "{t:?} {b:?}");
    }
}
