//! The annulus as a curve of arc length: two semi-ellipses with a saddle.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::parameters::AnnulusDimensions;
use crate::Vec3;

/// One of the two leaflets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// From the anterolateral commissure over A1, A2, A3 to the posteromedial one.
    Anterior,
    /// From the posteromedial commissure over P3, P2, P1 to the anterolateral one.
    Posterior,
}

/// Table steps along each piece between landmarks and joints. About 0.03 mm: interpolating the angle in
/// between errs by less than 1e-5 mm along the curve.
const STEPS: usize = 1024;

/// Annulus curve. Arc length runs from the anterolateral commissure clockwise seen from the atrium, first along the
/// anterior leaflet.
pub(super) struct AnnulusCurve {
    dimensions: AnnulusDimensions,
    /// Ellipse angle [rad] at each table entry.
    angle: Vec<f64>,
    /// Arc length [mm] at each table entry.
    arc: Vec<f64>,
    /// Length of the anterior annulus [mm].
    pub(super) anterior_length_mm: f64,
    /// Length of the whole annulus [mm].
    pub(super) length_mm: f64,
}

impl AnnulusCurve {
    pub(super) fn new(dimensions: &AnnulusDimensions) -> Self {
        let start = landmark_angle(dimensions, dimensions.commissure_half_angle_deg);
        let end_of_anterior = PI - start;
        // The angle's speed jumps where the semi-ellipses meet: no table step may run across.
        let mut breaks = vec![end_of_anterior, start + TAU];
        breaks.extend(
            [0.0, PI, TAU]
                .into_iter()
                .filter(|&joint| joint > start && joint < start + TAU),
        );
        breaks.sort_by(f64::total_cmp);
        let (mut angle, mut arc, mut anterior_length_mm) = (vec![start], vec![0.0], 0.0);
        let mut from = start;
        for to in breaks {
            for step in 1..=STEPS {
                let next = from + (to - from) * step as f64 / STEPS as f64;
                arc.push(arc[arc.len() - 1] + piece_length(dimensions, angle[angle.len() - 1], next));
                angle.push(next);
            }
            if to == end_of_anterior {
                anterior_length_mm = arc[arc.len() - 1];
            }
            from = to;
        }
        Self {
            dimensions: *dimensions,
            anterior_length_mm,
            length_mm: arc[arc.len() - 1],
            angle,
            arc,
        }
    }

    /// Point at an arc length [mm], which may lie outside one turn.
    pub(super) fn at_arc(&self, arc_mm: f64) -> Vec3 {
        let arc_mm = arc_mm.rem_euclid(self.length_mm);
        let after = self
            .arc
            .partition_point(|&a| a <= arc_mm)
            .clamp(1, self.arc.len() - 1);
        let step = self.arc[after] - self.arc[after - 1];
        let fraction = if step > 0.0 {
            (arc_mm - self.arc[after - 1]) / step
        } else {
            0.0
        };
        let angle = self.angle[after - 1] + fraction * (self.angle[after] - self.angle[after - 1]);
        at_angle(&self.dimensions, angle)
    }

    /// Arc length at a fraction of a leaflet's hinge.
    pub(super) fn arc_of(&self, side: Side, across: f64) -> f64 {
        match side {
            Side::Anterior => across * self.anterior_length_mm,
            Side::Posterior => self.anterior_length_mm + across * (self.length_mm - self.anterior_length_mm),
        }
    }

    /// Point at a fraction of a leaflet's hinge.
    pub(super) fn at(&self, side: Side, across: f64) -> Vec3 {
        self.at_arc(self.arc_of(side, across))
    }

    /// Trigone on the anterolateral (left) and on the posteromedial (right) side.
    pub(super) fn trigones(&self) -> [Vec3; 2] {
        let angle = landmark_angle(&self.dimensions, self.dimensions.trigone_half_angle_deg);
        [
            at_angle(&self.dimensions, angle),
            at_angle(&self.dimensions, PI - angle),
        ]
    }

    /// Mean height along the curve [mm].
    pub(super) fn mean_height_mm(&self) -> f64 {
        let weighted: f64 = (1..self.arc.len())
            .map(|i| {
                let middle = 0.5 * (self.angle[i - 1] + self.angle[i]);
                at_angle(&self.dimensions, middle).z * (self.arc[i] - self.arc[i - 1])
            })
            .sum();
        weighted / self.length_mm
    }
}

/// Distances of the anterior and the posterior annulus from the transverse axis [mm].
pub(super) fn half_depths_mm(dimensions: &AnnulusDimensions) -> [f64; 2] {
    let anterior = dimensions.anterior_fraction * dimensions.anteroposterior_mm;
    [anterior, dimensions.anteroposterior_mm - anterior]
}

/// Point at an ellipse angle: 0 at +x, 90° mid-anterior, that is at -y.
fn at_angle(dimensions: &AnnulusDimensions, angle: f64) -> Vec3 {
    let (sine, cosine) = angle.sin_cos();
    let [anterior, posterior] = half_depths_mm(dimensions);
    let (depth, height) = if sine >= 0.0 {
        (anterior, dimensions.anterior_height_mm)
    } else {
        (posterior, dimensions.posterior_height_mm)
    };
    Vec3::new(
        0.5 * dimensions.transverse_mm * cosine,
        -depth * sine,
        height * sine * sine,
    )
}

/// Length of a short piece [mm] by Gauss's rule of three points.
fn piece_length(dimensions: &AnnulusDimensions, from: f64, to: f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let outer = 0.6_f64.sqrt() * half;
    let speeds = 5.0 * (speed(dimensions, middle - outer) + speed(dimensions, middle + outer))
        + 8.0 * speed(dimensions, middle);
    half * speeds / 9.0
}

fn speed(dimensions: &AnnulusDimensions, angle: f64) -> f64 {
    let (sine, cosine) = angle.sin_cos();
    let [anterior, posterior] = half_depths_mm(dimensions);
    let (depth, height) = if sine >= 0.0 {
        (anterior, dimensions.anterior_height_mm)
    } else {
        (posterior, dimensions.posterior_height_mm)
    };
    Vec3::new(
        -0.5 * dimensions.transverse_mm * sine,
        -depth * cosine,
        2.0 * height * sine * cosine,
    )
    .norm()
}

/// Ellipse angle, on the anterolateral side, of the point seen at an angle from mid-anterior. Seen from the
/// middle of the anteroposterior diameter: from there the published 121° make the anterior hinge a third of
/// the annulus and the published 76° make the intertrigonal distance 19 mm (18 ± 2), as they should.
fn landmark_angle(dimensions: &AnnulusDimensions, half_angle_deg: f64) -> f64 {
    let (sine, cosine) = half_angle_deg.to_radians().sin_cos();
    let [anterior, posterior] = half_depths_mm(dimensions);
    let centre_y = 0.5 * (posterior - anterior);
    // Positive on the far side of the ray; it falls from mid-posterior to mid-anterior.
    let beyond = |angle: f64| {
        let point = at_angle(dimensions, angle);
        point.x * cosine + (point.y - centre_y) * sine
    };
    let (mut low, mut high) = (-FRAC_PI_2, FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if beyond(middle) > 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polyline(curve: &AnnulusCurve) -> Vec<Vec3> {
        (0..2000)
            .map(|i| curve.at_arc(curve.length_mm * i as f64 / 2000.0))
            .collect()
    }

    /// Non-planarity angle [°] seen from the middle of the transverse axis.
    fn non_planarity_deg(d: &AnnulusDimensions) -> f64 {
        let [anterior, posterior] = half_depths_mm(d);
        (anterior / d.anterior_height_mm).atan().to_degrees()
            + (posterior / d.posterior_height_mm).atan().to_degrees()
    }

    /// The closed formulas: area pi·CC·AP/4, and perimeters and angles computed once by independent
    /// quadrature, printed to whole numbers; hence the tolerance of one half and a little.
    #[test]
    fn agrees_with_the_check_values() {
        let rows = [
            ([38.0, 28.0, 0.40, 6.9, 2.2], 107.0, 836.0, 141.0),
            ([43.0, 34.0, 0.45, 5.9, 1.2], 123.0, 1148.0, 155.0),
            ([44.0, 36.0, 0.42, 8.0, 2.5], 129.0, 1244.0, 145.0),
            ([46.0, 40.0, 0.45, 4.5, 0.8], 136.0, 1445.0, 164.0),
            ([30.0, 22.0, 0.42, 4.5, 1.5], 84.0, 518.0, 147.0),
        ];
        for ([cc, ap, f, ha, hp], perimeter, area, angle) in rows {
            let dimensions = AnnulusDimensions {
                transverse_mm: cc,
                anteroposterior_mm: ap,
                anterior_fraction: f,
                anterior_height_mm: ha,
                posterior_height_mm: hp,
                ..Default::default()
            };
            let curve = AnnulusCurve::new(&dimensions);
            let points = polyline(&curve);
            let doubled: f64 = (0..points.len())
                .map(|i| (points[i], points[(i + 1) % points.len()]))
                .map(|(p, q)| p.x * q.y - q.x * p.y)
                .sum();
            assert!(
                (curve.length_mm - perimeter).abs() < 0.6,
                "{cc} {}",
                curve.length_mm
            );
            // Negative: clockwise seen from the atrium.
            assert!((0.5 * doubled + area).abs() < 0.6, "{cc} {doubled}");
            assert!((non_planarity_deg(&dimensions) - angle).abs() < 0.6);
        }
    }

    /// A chord of 0.05 mm is shorter than its arc by 1e-5 at the sharpest bend (radius 6.6 mm) at most, and
    /// the table errs by less than 1e-5 mm.
    #[test]
    fn runs_at_unit_speed() {
        let curve = AnnulusCurve::new(&AnnulusDimensions::default());
        let points = polyline(&curve);
        let step = curve.length_mm / 2000.0;
        for i in 0..2000 {
            let length = (points[(i + 1) % 2000] - points[i]).norm();
            assert!((length / step - 1.0).abs() < 3e-4, "{i}: {length} {step}");
        }
    }

    /// Published: commissures 121° apart, trigones 18 ± 2 mm apart, anterior share 30 to 36.6 %.
    #[test]
    fn landmarks_lie_where_hearts_have_them() {
        let curve = AnnulusCurve::new(&AnnulusDimensions::default());
        let share = curve.anterior_length_mm / curve.length_mm;
        assert!((0.30..0.366).contains(&share), "{share}");
        let [left, right] = curve.trigones();
        assert!((16.0..20.0).contains(&(left - right).norm()));
        let commissure = curve.at(Side::Anterior, 0.0);
        let seen = commissure.x.atan2(2.8 - commissure.y).to_degrees();
        assert!((seen - 60.5).abs() < 1e-9, "{seen}");
        let middle = curve.at(Side::Anterior, 0.5);
        assert!(middle.x.abs() < 1e-9 && (middle.y + 11.2).abs() < 1e-9);
        let back = curve.at(Side::Posterior, 0.5);
        assert!(back.x.abs() < 1e-9 && (back.y - 16.8).abs() < 1e-9);
    }
}
