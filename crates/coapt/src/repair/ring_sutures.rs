//! A ring held by single sutures.
//!
//! Between two sutures nothing holds the annulus to the ring, and nothing in the model resists its bending either: annulus points
//! are held where they end up. So they are moved by what the sutures move, interpolated along the annulus, and whatever the
//! annulus was between them, bulge or dent, it still is beside that. Interpolated is the motion and not the place, for between
//! sutures a smooth curve of places would lose just that; smoothly, by cubic pieces (Catmull & Rom 1974), for straight pieces
//! would put a kink into the hinge at each suture.

use crate::Vec3;
use crate::mesh::polyline;
use crate::repair::ring_attachment::{AnnulusCurve, knots, ring_arc_mm};
use crate::repair::ring_shape::RingCurve;
use crate::scene::Ring;

/// How many sutures there are if nobody says; 10 to 14 are usual.
const SUTURES: u32 = 12;

impl Ring {
    /// How many sutures hold it, where single ones do.
    pub fn suture_count(&self) -> u32 {
        self.sutures.unwrap_or(SUTURES)
    }
}

/// What each suture does.
pub(super) struct Pulls {
    /// Motion of the annulus at each suture [mm], shape `[suture]`.
    pulls_mm: Vec<Vec3>,
    /// Arc length of the first suture on the annulus, and from one to the next [mm].
    first_mm: f64,
    step_mm: f64,
    closed: bool,
}

impl Pulls {
    /// Sutures evenly along the annulus under the ring: from the anterior middle on, or from end to end of an open ring.
    pub(super) fn new(annulus: &AnnulusCurve, ring: &RingCurve, count: u32) -> Self {
        let knots = knots(annulus, ring);
        let [from, to] = [knots[0][0], knots[knots.len() - 1][0]];
        let steps = if ring.closed { count } else { count - 1 };
        let step_mm = (to - from) / f64::from(steps);
        let arcs = polyline::arc_lengths(&ring.points_mm, ring.closed);
        let pull = |suture: u32| {
            let at = from + step_mm * f64::from(suture);
            let here = polyline::point_at_arc(&annulus.points_mm, true, &annulus.arcs_mm, at);
            polyline::point_at_arc(&ring.points_mm, ring.closed, &arcs, ring_arc_mm(&knots, at)) - here
        };
        Self {
            pulls_mm: (0..count).map(pull).collect(),
            first_mm: from,
            step_mm,
            closed: ring.closed,
        }
    }

    /// Motion of the annulus at an arc length [mm].
    pub(super) fn at(&self, arc_mm: f64) -> Vec3 {
        let count = self.pulls_mm.len() as i64;
        let place = (arc_mm - self.first_mm) / self.step_mm;
        let last = if self.closed { count - 1 } else { count - 2 };
        let before = (place.floor() as i64).clamp(0, last);
        let x = place - before as f64;
        let pull = |i: i64| {
            let i = if self.closed {
                i.rem_euclid(count)
            } else {
                i.clamp(0, count - 1)
            };
            self.pulls_mm[i as usize]
        };
        let [p0, p1, p2, p3] = [-1, 0, 1, 2].map(|next| pull(before + next));
        let (leaving, arriving) = ((p2 - p0) * 0.5, (p3 - p1) * 0.5);
        let (square, cube) = (x * x, x * x * x);
        p1 * (2.0 * cube - 3.0 * square + 1.0)
            + leaving * (cube - 2.0 * square + x)
            + p2 * (3.0 * square - 2.0 * cube)
            + arriving * (cube - square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repair::ring::annulus_targets;
    use crate::repair::ring::tests::{done, skirt_model};
    use crate::repair::ring_shape::parse_ring_spec;
    use crate::scene::Attachment;

    fn sewn(spec: &str, sutures: u32) -> Ring {
        Ring {
            attachment: Attachment::Sutures,
            sutures: Some(sutures),
            ..parse_ring_spec(spec).unwrap()
        }
    }

    /// A closed ring has a suture at the anterior middle, which is on the ring to rounding; between sutures the annulus is near it,
    /// not on it.
    #[test]
    fn the_annulus_is_on_the_ring_where_sutures_are() {
        let model = skirt_model();
        for spec in ["physio-like:30", "classic-like:30"] {
            let (after, report, _) = done(&model, &sewn(spec, 12));
            assert_eq!(report.sutures, Some(12));
            let away = |target: Vec3| {
                polyline::nearest(&report.curve_mm, report.closed, target)
                    .map_or(0.0, |foot| foot.distance_mm)
            };
            let before = annulus_targets(&model);
            let annulus = AnnulusCurve::new(&before, &model.landmarks);
            let targets = annulus_targets(&after);
            if report.closed {
                assert!(away(targets[model.landmarks.mid_anterior]) < 1e-9);
            }
            // Ring and annulus are of like shape, so that a tenth of the motion is all that is left between sutures.
            let sewn = annulus.order[annulus.trigones[0]..=annulus.trigones[1]].iter();
            let farthest = sewn.map(|&i| away(targets[i])).fold(0.0, f64::max);
            assert!(
                farthest > 1e-3 && farthest < 0.1 * report.warp_max_mm,
                "{spec}: {farthest} {report:?}"
            );
        }
    }

    /// A bulge of the annulus between two sutures is there afterwards; by arc length the ring takes it.
    #[test]
    fn a_bulge_between_sutures_stays() {
        let model = skirt_model();
        let mut bulged = model.clone();
        let annulus = AnnulusCurve::new(&annulus_targets(&model), &model.landmarks);
        // Of eight sutures the posterior middle has one; the next is an eighth of the annulus away, beyond this point.
        let index = annulus.order[(annulus.trigones[0] + annulus.mid_posterior) / 2];
        let vertex = model.annulus[index];
        let fixed = bulged
            .prescribed
            .iter_mut()
            .find(|fixed| fixed.vertex == vertex)
            .unwrap();
        fixed.target_mm.z += 1.0;
        let rise = |ring: &Ring| {
            let [with, without] =
                [&bulged, &model].map(|model| annulus_targets(&done(model, ring).0)[index].z);
            with - without
        };
        // The bulge makes the annulus a little longer, which moves the sutures along it.
        let kept = rise(&sewn("physio-like:30", 8));
        assert!((kept - 1.0).abs() < 0.15, "{kept}");
        let flat = rise(&parse_ring_spec("physio-like:30").unwrap());
        assert!(flat.abs() < 0.3, "{flat}");
    }
}
