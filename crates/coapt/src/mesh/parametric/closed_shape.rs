//! The closed shape that chordae are cut for: where every leaflet point is meant to be at peak systole.
//!
//! Both margins hang below one closure line, which runs from commissure to commissure parallel to the
//! posterior annulus. It is a target for rest lengths, not a result.

use super::annulus::{AnnulusCurve, Side};
use super::parameters::{AnnulusDimensions, ClosedShapeTarget, ValveParameters};
use super::surface::Surface;
use crate::Vec3;

/// Table steps along the margins and the closure line.
const STEPS: usize = 400;
/// Share of the closure line over which it leaves the commissure inward. Our choice.
const COMMISSURAL_SHARE: f64 = 0.25;

/// A target closed shape.
pub(super) struct ClosedShape {
    annulus: AnnulusCurve,
    target: ClosedShapeTarget,
    /// Length of the closure line up to each table step [mm].
    line_arc_mm: Vec<f64>,
    /// Fraction of the margin's length up to each fraction of the hinge, for anterior and posterior.
    margin_fraction: [Vec<f64>; 2],
    /// Height of the middle of the closure line [mm].
    middle_z_mm: f64,
    /// How far the line begins inward of and below the commissures [mm].
    commissural_drop_mm: f64,
}

impl ClosedShape {
    /// The closed shape of leaflets whose open shape is `surface`, in an annulus that may be another.
    pub(super) fn new(
        parameters: &ValveParameters,
        dimensions: &AnnulusDimensions,
        surface: &Surface,
    ) -> Self {
        let annulus = AnnulusCurve::new(dimensions);
        let target = parameters.closed_shape;
        // What of the commissural height does not hang runs inward and down at 45°.
        let rest = surface.height_mm(0.0) - target.commissural_coaptation_length_mm;
        let mut closed = Self {
            middle_z_mm: annulus.mean_height_mm() - target.tenting_height_mm,
            commissural_drop_mm: rest.max(0.0) * 0.5_f64.sqrt(),
            margin_fraction: [Side::Anterior, Side::Posterior].map(|side| margin_fractions(surface, side)),
            line_arc_mm: vec![0.0],
            annulus,
            target,
        };
        for i in 1..=STEPS {
            let piece = closed.line(i as f64 / STEPS as f64) - closed.line((i - 1) as f64 / STEPS as f64);
            closed.line_arc_mm.push(closed.line_arc_mm[i - 1] + piece.norm());
        }
        closed
    }

    /// Point at a fraction across the leaflet's hinge and a share of the way down to the margin.
    pub(super) fn at(&self, side: Side, across: f64, down: f64) -> Vec3 {
        let hinge = self.annulus.at(side, across);
        let parameter = self.line_parameter(side, across);
        let line = self.line(parameter);
        let span = (line - hinge).norm();
        let hang = self.hang_mm(parameter);
        let length = down * (span + hang);
        if length > span {
            return line - Vec3::z() * (length - span);
        }
        let share = if span > 0.0 { length / span } else { 0.0 };
        let belly = 4.0 * self.target.belly_fraction * span * share * (1.0 - share);
        hinge + (line - hinge) * share + Vec3::z() * belly
    }

    /// Length from hinge to margin along the closed leaflet, belly aside [mm].
    #[cfg(test)]
    pub(super) fn column_length_mm(&self, side: Side, across: f64) -> f64 {
        let parameter = self.line_parameter(side, across);
        (self.line(parameter) - self.annulus.at(side, across)).norm() + self.hang_mm(parameter)
    }

    /// Where on the closure line a leaflet column meets it: margins and closure line match in proportion to
    /// length.
    fn line_parameter(&self, side: Side, across: f64) -> f64 {
        let fraction = match side {
            Side::Anterior => interpolate(&self.margin_fraction[0], across),
            Side::Posterior => 1.0 - interpolate(&self.margin_fraction[1], across),
        };
        let length = fraction * self.line_arc_mm[STEPS];
        let after = self.line_arc_mm.partition_point(|&l| l <= length).clamp(1, STEPS);
        let (before_mm, after_mm) = (self.line_arc_mm[after - 1], self.line_arc_mm[after]);
        let share = if after_mm > before_mm {
            (length - before_mm) / (after_mm - before_mm)
        } else {
            0.0
        };
        (after as f64 - 1.0 + share) / STEPS as f64
    }

    /// Closure line from the anterolateral (0) to the posteromedial commissure (1).
    fn line(&self, parameter: f64) -> Vec3 {
        let anterior = self.annulus.at(Side::Anterior, parameter);
        let posterior = self.annulus.at(Side::Posterior, 1.0 - parameter);
        let mut point = anterior + (posterior - anterior) * self.target.closure_line_fraction;
        let ends = [
            self.annulus.at(Side::Anterior, 0.0),
            self.annulus.at(Side::Anterior, 1.0),
        ];
        let front = self.annulus.at(Side::Anterior, 0.5);
        let back = self.annulus.at(Side::Posterior, 0.5);
        let middle_y = front.y + (back.y - front.y) * self.target.closure_line_fraction;
        for (end, distance) in ends.iter().zip([parameter, 1.0 - parameter]) {
            let weight = (1.0 - distance / COMMISSURAL_SHARE).max(0.0).powi(2);
            let inward = Vec3::new(-0.5 * end.x, middle_y - end.y, 0.0).normalize();
            point += inward * (self.commissural_drop_mm * weight);
        }
        let end_z = ends[0].z - self.commissural_drop_mm;
        point.z = end_z + (self.middle_z_mm - end_z) * bow(parameter);
        point
    }

    /// How far the margins hang below the closure line [mm].
    fn hang_mm(&self, parameter: f64) -> f64 {
        let end = self.target.commissural_coaptation_length_mm;
        end + (self.target.coaptation_length_mm - end) * bow(parameter)
    }
}

/// 0 at both ends, 1 in the middle.
fn bow(parameter: f64) -> f64 {
    4.0 * parameter * (1.0 - parameter)
}

/// Fraction of the open margin's length at equal steps along the hinge.
pub(super) fn margin_fractions(surface: &Surface, side: Side) -> Vec<f64> {
    let point = |i: usize| {
        let arc = surface.annulus.arc_of(side, i as f64 / STEPS as f64);
        surface.at(arc, surface.height_mm(arc))
    };
    let mut lengths = vec![0.0];
    for i in 1..=STEPS {
        lengths.push(lengths[i - 1] + (point(i) - point(i - 1)).norm());
    }
    let total = lengths[STEPS];
    lengths.iter().map(|length| length / total).collect()
}

/// Linear interpolation in a table over [0, 1].
pub(super) fn interpolate(table: &[f64], x: f64) -> f64 {
    let position = x.clamp(0.0, 1.0) * (table.len() - 1) as f64;
    let i = (position as usize).min(table.len() - 2);
    table[i] + (table[i + 1] - table[i]) * (position - i as f64)
}
