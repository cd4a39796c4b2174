//! The open leaflets as a smooth surface: leaflet height along the annulus, and where the tissue hangs.

use super::annulus::{AnnulusCurve, Side, half_depths_mm};
use super::parameters::ValveParameters;
use crate::Vec3;

/// Middles of A1, A2, A3 along the anterior hinge. Our choice.
const ANTERIOR_KNOTS: [f64; 5] = [0.0, 0.2, 0.5, 0.8, 1.0];
/// Middles of P3, P2, P1 along the posterior hinge. Our choice: P2 is as wide as the trigones are apart, 19
/// of 71 mm; its neighbours share the rest.
const POSTERIOR_KNOTS: [f64; 5] = [0.0, 0.17, 0.5, 0.83, 1.0];
/// Borders of P2 along the posterior hinge.
const SCALLOP_BORDERS: [f64; 2] = [0.36, 0.64];
/// Columns lean towards the transverse axis' points at this share of their own x. Our choice: keeps the skirt
/// from folding where the annulus is narrowest.
const FOCUS_SHARE: f64 = 0.5;

/// The open leaflets over arc length along the annulus and depth along the leaflet.
pub(super) struct Surface {
    pub(super) annulus: AnnulusCurve,
    anterior: [f64; 5],
    posterior: [f64; 5],
    indentation_depth: f64,
    /// Of the Gaussian, as a fraction of the posterior hinge.
    indentation_width: f64,
    focus_y_mm: f64,
    /// Angle from the vertical at the annulus [rad].
    annular_angle: f64,
    /// How much of it is lost down to the margin [rad].
    turn: f64,
}

impl Surface {
    pub(super) fn new(parameters: &ValveParameters) -> Self {
        let leaflets = &parameters.leaflets;
        let annulus = AnnulusCurve::new(&parameters.annulus);
        let posterior_length = annulus.length_mm - annulus.anterior_length_mm;
        let scale = leaflets.height_scale;
        let [a1, a2, a3] = leaflets.anterior_heights_mm.map(|height| scale * height);
        let [p1, p2, p3] = leaflets.posterior_heights_mm.map(|height| scale * height);
        let commissure = scale * leaflets.commissure_height_mm;
        let fraction = parameters.closed_shape.closure_line_fraction;
        let half_to_deviation = 0.5 / (2.0 * f64::ln(2.0)).sqrt();
        Self {
            anterior: [commissure, a1, a2, a3, commissure],
            posterior: [commissure, p3, p2, p1, commissure],
            indentation_depth: leaflets.indentation_depth,
            indentation_width: half_to_deviation * leaflets.indentation_width_mm / posterior_length,
            focus_y_mm: fraction * parameters.annulus.anteroposterior_mm
                - half_depths_mm(&parameters.annulus)[0],
            annular_angle: (leaflets.opening_angle_deg + leaflets.annular_turn_deg).to_radians(),
            turn: leaflets.annular_turn_deg.to_radians(),
            annulus,
        }
    }

    /// Which leaflet an arc length belongs to, and the fraction of its hinge.
    pub(super) fn locate(&self, arc_mm: f64) -> (Side, f64) {
        let arc_mm = arc_mm.rem_euclid(self.annulus.length_mm);
        let anterior = self.annulus.anterior_length_mm;
        if arc_mm <= anterior {
            (Side::Anterior, arc_mm / anterior)
        } else {
            (
                Side::Posterior,
                (arc_mm - anterior) / (self.annulus.length_mm - anterior),
            )
        }
    }

    /// Leaflet height [mm] at an arc length.
    pub(super) fn height_mm(&self, arc_mm: f64) -> f64 {
        match self.locate(arc_mm) {
            (Side::Anterior, across) => monotone_cubic(&ANTERIOR_KNOTS, &self.anterior, across),
            (Side::Posterior, across) => {
                let dent: f64 = SCALLOP_BORDERS
                    .iter()
                    .map(|border| (-0.5 * ((across - border) / self.indentation_width).powi(2)).exp())
                    .sum();
                monotone_cubic(&POSTERIOR_KNOTS, &self.posterior, across)
                    * (1.0 - self.indentation_depth * dent)
            }
        }
    }

    /// Point at an arc length along the annulus and a depth along the leaflet [mm]. Each column is a circular
    /// arc in a vertical plane, so that depth is true length.
    pub(super) fn at(&self, arc_mm: f64, depth_mm: f64) -> Vec3 {
        let hinge = self.annulus.at_arc(arc_mm);
        let to_focus = self.to_focus(hinge);
        let turned = self.turn * depth_mm / self.height_mm(arc_mm);
        let chord = depth_mm * sinc(0.5 * turned);
        let (inward, down) = (self.annular_angle - 0.5 * turned).sin_cos();
        hinge + to_focus.normalize() * (chord * inward) - Vec3::z() * (chord * down)
    }

    /// Share of the way to the focus that the margin has gone inward; beyond 1 the skirt crosses itself.
    pub(super) fn inward_share(&self, arc_mm: f64) -> f64 {
        let hinge = self.annulus.at_arc(arc_mm);
        let margin = self.at(arc_mm, self.height_mm(arc_mm));
        (margin - hinge).xy().norm() / self.to_focus(hinge).norm()
    }

    fn to_focus(&self, hinge: Vec3) -> Vec3 {
        Vec3::new(FOCUS_SHARE * hinge.x - hinge.x, self.focus_y_mm - hinge.y, 0.0)
    }
}

fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-6 { 1.0 } else { x.sin() / x }
}

/// Monotone piecewise cubic (Fritsch & Butland 1984) with level ends, so that leaflets join smoothly.
fn monotone_cubic(knots: &[f64; 5], values: &[f64; 5], x: f64) -> f64 {
    let secant = |i: usize| (values[i + 1] - values[i]) / (knots[i + 1] - knots[i]);
    let slope = |i: usize| {
        if i == 0 || i == 4 {
            return 0.0;
        }
        let (before, after) = (secant(i - 1), secant(i));
        if before * after <= 0.0 {
            return 0.0;
        }
        let (short, long) = (knots[i] - knots[i - 1], knots[i + 1] - knots[i]);
        let (w1, w2) = (2.0 * long + short, long + 2.0 * short);
        (w1 + w2) / (w1 / before + w2 / after)
    };
    let i = (1..4).filter(|&k| x >= knots[k]).count();
    let width = knots[i + 1] - knots[i];
    let t = ((x - knots[i]) / width).clamp(0.0, 1.0);
    let (u, t2) = (1.0 - t, t * t);
    values[i] * u * u * (1.0 + 2.0 * t) + slope(i) * width * t * u * u + values[i + 1] * t2 * (3.0 - 2.0 * t)
        - slope(i + 1) * width * t2 * u
}
