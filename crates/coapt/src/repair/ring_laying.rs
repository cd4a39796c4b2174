//! A ring on the annulus: where it lies, and where annulus points are drawn.

use crate::Vec3;
use crate::mesh::polyline;
use crate::repair::placement;
use crate::repair::ring_attachment::{self, AnnulusCurve, Sutures};
use crate::repair::ring_shape::RingCurve;
use crate::repair::ring_sutures::Pulls;
use crate::scene::{Attachment, Fault, Ring};

/// Beyond the ends of an open ring the annulus takes so much arc to come back to its own place [mm] (our choice:
/// about one suture bite).
const BLEND_MM: f64 = 5.0;

/// A ring on the annulus.
pub(crate) struct Laid {
    pub(crate) curve: RingCurve,
    pub(crate) sutures: Sutures,
    /// Where annulus points end up.
    pub(crate) moved: Vec<Vec3>,
    /// Mean and largest distance by which sewn points move.
    pub(crate) warp_mm: [f64; 2],
    /// Mean warp if the ring were as long as the annulus: how well its shape lies, whatever its size.
    pub(crate) misfit_mm: f64,
}

/// Lays a ring on the annulus and sews it.
pub(crate) fn lay(candidate: &RingCurve, ring: &Ring, annulus: &AnnulusCurve) -> Laid {
    let laid = lay_as_it_is(candidate, ring, annulus);
    if ring.placed {
        return laid;
    }
    let [from, to] = laid.sutures.span_mm;
    let scale = (to - from) / polyline::length(&candidate.points_mm, candidate.closed).max(f64::EPSILON);
    let alike = lay_as_it_is(&candidate.moved(|point| point * scale), ring, annulus);
    Laid {
        misfit_mm: alike.misfit_mm,
        ..laid
    }
}

fn lay_as_it_is(candidate: &RingCurve, ring: &Ring, annulus: &AnnulusCurve) -> Laid {
    let curve = place(candidate, ring.placed, annulus);
    let sutures = match ring.attachment {
        Attachment::ArcLength | Attachment::Sutures => ring_attachment::by_arc_length(annulus, &curve),
        Attachment::NearestPoint => ring_attachment::by_nearest_point(annulus, &curve),
    };
    let pulls = match ring.attachment {
        Attachment::Sutures => Some(Pulls::new(annulus, &curve, ring.suture_count())),
        _ => None,
    };
    let moved = sew(annulus, &curve, &sutures, pulls.as_ref());
    let warp_mm = warp(annulus, &sutures, &moved);
    Laid {
        warp_mm,
        misfit_mm: warp_mm[0],
        curve,
        sutures,
        moved,
    }
}

/// Tells when a measured curve would fit almost as well the other way round.
pub(crate) fn doubt_side(best: &Laid, laid: &[Laid]) -> Option<Fault> {
    let differs = |other: &&Laid| {
        let off = other
            .moved
            .iter()
            .zip(&best.moved)
            .map(|(a, b)| (a - b).norm())
            .sum::<f64>();
        off > 0.5 * best.moved.len() as f64
    };
    // A twentieth of a millimetre is within the landmarks' own uncertainty (our choice).
    let close = |other: &&Laid| other.misfit_mm <= best.misfit_mm + 0.05;
    let other = laid.iter().filter(differs).find(close)?;
    let message = format!(
        "which side of the curve is up, or anterior, is unclear: shapes differ by {:.2} mm as taken, {:.2} mm turned; place \
         the curve to be sure",
        best.misfit_mm, other.misfit_mm
    );
    Some(Fault::warning("ring.curve_mm", message))
}

/// Fits the ring to the annulus; a placed one stays and takes its landmarks from the annulus.
fn place(candidate: &RingCurve, placed: bool, annulus: &AnnulusCurve) -> RingCurve {
    let [first, second] = annulus.trigones.map(|i| annulus.points_mm[i]);
    let posterior = annulus.points_mm[annulus.mid_posterior];
    if !placed {
        return placement::fit(candidate, &annulus.points_mm, [first, second, posterior]);
    }
    let mut curve = candidate.clone();
    let near =
        |point: Vec3| polyline::nearest(&curve.points_mm, curve.closed, point).map_or(point, |n| n.point_mm);
    curve.marks.mid_anterior = near(annulus.points_mm[0]);
    curve.marks.mid_posterior = near(posterior);
    if curve.closed {
        curve.marks.trigones = [near(first), near(second)];
    }
    curve
}

/// Where all annulus points end up, in the order of the curve: on the ring, or as single sutures pull.
pub(super) fn sew(
    annulus: &AnnulusCurve,
    curve: &RingCurve,
    sutures: &Sutures,
    pulls: Option<&Pulls>,
) -> Vec<Vec3> {
    let arcs = polyline::arc_lengths(&curve.points_mm, curve.closed);
    let on_ring = |arc: f64| polyline::point_at_arc(&curve.points_mm, curve.closed, &arcs, arc);
    let [start, end] = sutures.span_mm;
    let pull = |at: f64, arc: f64| {
        on_ring(arc) - polyline::point_at_arc(&annulus.points_mm, true, &annulus.arcs_mm, at)
    };
    let total = annulus.length_mm();
    let fade = |distance: f64| {
        let x = (1.0 - distance / BLEND_MM).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    };
    let place = |(i, suture): (usize, &Option<f64>)| match *suture {
        Some(arc) => match pulls {
            Some(pulls) => annulus.points_mm[i] + pulls.at(annulus.arcs_mm[i]),
            None => on_ring(arc),
        },
        None => {
            let at = annulus.arcs_mm[i];
            let near_start = fade((start - at).rem_euclid(total));
            let near_end = fade((at - end).rem_euclid(total));
            let share = (near_start + near_end).max(1.0);
            let ring_end = arcs.last().copied().unwrap_or(0.0);
            annulus.points_mm[i] + (pull(start, 0.0) * near_start + pull(end, ring_end) * near_end) / share
        }
    };
    sutures.ring_arc_mm.iter().enumerate().map(place).collect()
}

/// Mean and largest distance by which sewn points move.
pub(super) fn warp(annulus: &AnnulusCurve, sutures: &Sutures, moved: &[Vec3]) -> [f64; 2] {
    let sewn = (0..moved.len()).filter(|&i| sutures.ring_arc_mm[i].is_some());
    let distances: Vec<f64> = sewn.map(|i| (moved[i] - annulus.points_mm[i]).norm()).collect();
    let mean = distances.iter().sum::<f64>() / distances.len().max(1) as f64;
    [mean, distances.into_iter().fold(0.0, f64::max)]
}

#[cfg(test)]
mod tests {
    use super::super::ring::annulus_targets;
    use super::super::ring::tests::{curve, done, skirt_model};
    use super::*;
    use crate::model::Model;
    use crate::repair::ring_shape::{family_curve, parse_ring_spec};
    use crate::scene::RingFamily;

    /// The skirt with an annulus of human shape in the closed phase: a saddle, flatter in front.
    fn human_model() -> Model {
        let mut model = skirt_model();
        for prescribed in model
            .prescribed
            .iter_mut()
            .filter(|p| model.annulus.contains(&p.vertex))
        {
            let target = &mut prescribed.target_mm;
            let sin = target.y / 14.0;
            target.z = if sin > 0.0 { 6.9 } else { 2.2 } * sin * sin;
            target.y *= if sin > 0.0 { 0.8 } else { 1.2 };
        }
        model
    }

    #[test]
    fn a_measured_curve_lies_like_the_family_it_was_taken_from() {
        let model = human_model();
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, 2.0, -1.0);
        for spec in ["physio-like:32", "classic-like:32"] {
            let ring = parse_ring_spec(spec).unwrap();
            let (family, report, _) = done(&model, &ring);
            let points = family_curve(ring.family.unwrap(), 32.0).points_mm;
            let mut away: Vec<Vec3> = points
                .iter()
                .map(|p| turn * p + Vec3::new(50.0, 0.0, 90.0))
                .collect();
            for _ in 0..2 {
                let (measured, found, warnings) = done(&model, &curve(&away));
                assert_eq!((found.closed, warnings.len()), (report.closed, 0), "{warnings:?}");
                for (a, b) in annulus_targets(&measured).iter().zip(annulus_targets(&family)) {
                    // The curve's landmarks are found on a resampling of about 0.2 mm, its plane from its area.
                    assert!((a - b).norm() < 0.3, "{spec}: {}", (a - b).norm());
                }
                away.reverse();
            }
        }
    }

    #[test]
    fn an_annulus_with_equal_halves_leaves_the_side_in_doubt() {
        let points = family_curve(RingFamily::PhysioLike, 32.0).points_mm;
        let (_, _, warnings) = done(&skirt_model(), &curve(&points));
        assert!(
            warnings.iter().any(|w| w.message.contains("is unclear")),
            "{warnings:?}"
        );
    }

    #[test]
    fn a_placed_curve_stays_whichever_way_it_runs() {
        let model = skirt_model();
        let mut points: Vec<Vec3> = annulus_targets(&model).iter().map(|p| p * 0.9).collect();
        for attachment in [Attachment::ArcLength, Attachment::NearestPoint] {
            points.reverse();
            let ring = Ring {
                placed: true,
                attachment,
                ..curve(&points)
            };
            let (after, report, warnings) = done(&model, &ring);
            assert!(warnings.is_empty(), "{warnings:?}");
            for (new, old) in annulus_targets(&after).iter().zip(annulus_targets(&model)) {
                // Radially in for the arc length; the nearest point of an ellipse lies a little beside that.
                assert!(
                    (new - old * 0.9).norm() < 1.0,
                    "{attachment:?} {}",
                    (new - old * 0.9).norm()
                );
            }
            assert!(report.tilt_degrees < 1e-3);
        }
    }

    #[test]
    fn folds_of_nearest_points_are_spread_and_told() {
        let model = skirt_model();
        let annulus = annulus_targets(&model);
        // A deep dent, into which no nearest point falls.
        let points: Vec<Vec3> = polyline::resample(&annulus, true, 200)
            .iter()
            .map(|p| {
                Vec3::new(
                    p.x,
                    if p.y < 0.0 && p.x.abs() < 4.0 {
                        0.1 * p.y
                    } else {
                        p.y
                    },
                    p.z,
                ) * 0.8
            })
            .collect();
        let ring = Ring {
            placed: true,
            attachment: Attachment::NearestPoint,
            ..curve(&points)
        };
        let (after, report, warnings) = done(&model, &ring);
        assert!(
            warnings.iter().any(|w| w.place == "ring.attachment"),
            "{warnings:?}"
        );
        assert!(report.edge_stretch_min > 0.0);
        let targets = annulus_targets(&after);
        let distinct =
            (0..targets.len()).all(|i| (targets[i] - targets[(i + 1) % targets.len()]).norm() > 0.3);
        assert!(distinct, "no two neighbours on one point");
    }
}
