//! Annuloplasty: the annulus is drawn onto a ring. Only where annulus points end up changes; rest lengths stay,
//! so that leaflets feel the change of their hinge.

use crate::Vec3;
use crate::mesh::polyline;
use crate::model::Model;
use crate::repair::placement;
use crate::repair::ring_attachment::{self, AnnulusCurve, Sutures};
use crate::repair::ring_shape::{self, RingCurve, normal_of};
use crate::repair::{Repaired, Report};
use crate::scene::{Attachment, Fault, Ring, RingFamily};

/// Beyond the ends of an open ring the annulus takes so much arc to come back to its own place [mm] (our choice:
/// about one suture bite).
const BLEND_MM: f64 = 5.0;

/// Rings this much longer or shorter than what they are sewn to do not belong to this valve.
const LARGEST_SCALE: f64 = 2.0;

/// Planes of annulus and placed ring that differ by more are doubted [degree].
const DOUBTFUL_TILT_DEGREES: f64 = 30.0;

/// Measured curves: enough points for a shape, few enough to test each pair of segments for crossing.
const CURVE_POINTS: std::ops::RangeInclusive<usize> = 8..=5000;

/// What a ring did to the annulus.
#[derive(Clone, Debug, PartialEq)]
pub struct RingReport {
    /// Family; none for a measured curve.
    pub family: Option<RingFamily>,
    /// Size [mm]; none for a measured curve.
    pub size_mm: Option<f64>,
    /// The ring where it lies [mm], shape `[point]`.
    pub curve_mm: Vec<Vec3>,
    /// Whether the ring is closed.
    pub closed: bool,
    /// Length of the ring [mm].
    pub ring_length_mm: f64,
    /// Length of the stretch of annulus that is sewn to it, before [mm].
    pub annulus_length_mm: f64,
    /// Mean distance by which sewn annulus points move [mm].
    pub warp_mean_mm: f64,
    /// Largest of these distances [mm].
    pub warp_max_mm: f64,
    /// Least length of an annulus edge after over before [1].
    pub edge_stretch_min: f64,
    /// Largest of these ratios [1].
    pub edge_stretch_max: f64,
    /// Angle between the planes of ring and annulus [degree].
    pub tilt_degrees: f64,
}

/// Draws the annulus onto a ring.
///
/// The ring is fitted to trigones and posterior middle, unless it is `placed`; of the ways a measured curve
/// may sit, the one is taken whose shape, brought to the annulus' length, differs least from it. Points in the gap of an open ring stay, but for 5 mm next to
/// its ends, over which the motion fades.
///
/// # Errors
/// A ring without shape or size, out of range, self-crossing, or over twice or below half the length of the
/// annulus; a model whose annulus is no closed loop.
pub fn implant(model: &Model, ring: &Ring) -> Result<Repaired, Vec<Fault>> {
    let candidates = candidates(model, ring)?;
    let targets = annulus_targets(model);
    let annulus = AnnulusCurve::new(&targets, &model.landmarks);
    let laid: Vec<Laid> = candidates
        .iter()
        .map(|candidate| lay(candidate, ring, &annulus))
        .collect();
    let best = laid.iter().min_by(|a, b| a.misfit_mm.total_cmp(&b.misfit_mm));
    let best = best.ok_or_else(|| vec![Fault::error("ring.curve_mm", "has no extent")])?;
    let report = report(ring, &annulus, best);
    let mut warnings = judge(model, &report, &annulus, &best.sutures)?;
    warnings.extend(doubt_side(best, &laid));
    Ok(Repaired {
        model: with_targets(model, &annulus, &best.moved),
        report: Report::Ring(report),
        warnings,
    })
}

/// A ring on the annulus.
struct Laid {
    curve: RingCurve,
    sutures: Sutures,
    /// Where annulus points end up.
    moved: Vec<Vec3>,
    /// Mean and largest distance by which sewn points move.
    warp_mm: [f64; 2],
    /// Mean warp if the ring were as long as the annulus: how well its shape lies, whatever its size.
    misfit_mm: f64,
}

/// Lays a ring on the annulus and sews it.
fn lay(candidate: &RingCurve, ring: &Ring, annulus: &AnnulusCurve) -> Laid {
    let laid = lay_as_it_is(candidate, ring, annulus);
    if ring.placed {
        return laid;
    }
    let [from, to] = laid.sutures.span_mm;
    let scale = (to - from) / polyline::length(&candidate.points_mm, candidate.closed);
    let alike = lay_as_it_is(&candidate.moved(|point| point * scale), ring, annulus);
    Laid {
        misfit_mm: alike.misfit_mm,
        ..laid
    }
}

fn lay_as_it_is(candidate: &RingCurve, ring: &Ring, annulus: &AnnulusCurve) -> Laid {
    let curve = place(candidate, ring.placed, annulus);
    let sutures = match ring.attachment {
        Attachment::ArcLength => ring_attachment::by_arc_length(annulus, &curve),
        Attachment::NearestPoint => ring_attachment::by_nearest_point(annulus, &curve),
    };
    let moved = sew(annulus, &curve, &sutures);
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
fn doubt_side(best: &Laid, laid: &[Laid]) -> Option<Fault> {
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

/// Every way in which the ring may lie, in its own frame.
fn candidates(model: &Model, ring: &Ring) -> Result<Vec<RingCurve>, Vec<Fault>> {
    let mut faults = Vec::new();
    if model.annulus.len() < 3 || model.margins.iter().any(|margin| !margin.closed) {
        faults.push(Fault::error(
            "ring",
            "the annulus is no closed loop: there is nothing to sew a ring to",
        ));
    }
    let found = match (ring.family, &ring.curve_mm) {
        (Some(family), None) => family_candidate(ring, family, &mut faults),
        (None, Some(points)) => measured_candidates(ring, points, &mut faults),
        (Some(_), Some(_)) => {
            faults.push(Fault::error(
                "ring",
                "has a family and a curve, expected one of them",
            ));
            Vec::new()
        }
        (None, None) => {
            let what = match &ring.curve_file {
                Some(file) => format!("`{file}` has not been read into the ring"),
                None => "has neither family nor curve".into(),
            };
            faults.push(Fault::error("ring", what));
            Vec::new()
        }
    };
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}

fn family_candidate(ring: &Ring, family: RingFamily, faults: &mut Vec<Fault>) -> Vec<RingCurve> {
    if ring.placed {
        faults.push(Fault::error(
            "ring.placed",
            "a family has no place of its own; give a curve, or leave this out",
        ));
    }
    match ring.size_mm {
        Some(size) if ring_shape::SIZES_MM.contains(&size) => {
            return vec![ring_shape::family_curve(family, size)];
        }
        Some(size) => faults.push(Fault::error(
            "ring.size_mm",
            format!("{size} mm {}", ring_shape::size_range()),
        )),
        None => faults.push(Fault::error("ring.size_mm", "is absent, and a family needs it")),
    }
    Vec::new()
}

fn measured_candidates(ring: &Ring, points: &[[f64; 3]], faults: &mut Vec<Fault>) -> Vec<RingCurve> {
    let place = "ring.curve_mm";
    if !CURVE_POINTS.contains(&points.len()) {
        let (least, most) = (CURVE_POINTS.start(), CURVE_POINTS.end());
        faults.push(Fault::error(
            place,
            format!("has {} points, expected {least} to {most}", points.len()),
        ));
        return Vec::new();
    }
    if let Some(bad) = points
        .iter()
        .position(|p| p.iter().any(|c| !c.is_finite() || c.abs() > 1e6))
    {
        faults.push(Fault::error(
            format!("{place} point {bad}"),
            "is not finite millimetres",
        ));
        return Vec::new();
    }
    let mut curve: Vec<Vec3> = points.iter().map(|&p| Vec3::from(p)).collect();
    let mean = polyline::length(&curve, false) / (curve.len() - 1) as f64;
    let gap = (curve[0] - curve[curve.len() - 1]).norm();
    if gap < 1e-3 * mean {
        curve.pop();
    }
    // Without a word on it, a curve is closed whose ends lie no farther apart than two of its points.
    let closed = ring.closed.unwrap_or(gap <= 2.0 * mean);
    if let Some([i, j]) = crossing(&curve, closed) {
        faults.push(Fault::error(
            place,
            format!("crosses itself: segments {i} and {j}, seen along its normal"),
        ));
    }
    ring_shape::curve_candidates(&curve, closed)
}

/// The first two segments that cross, projected along the curve's normal.
fn crossing(points: &[Vec3], closed: bool) -> Option<[usize; 2]> {
    let normal = normal_of(points);
    let count = points.len();
    let segments = if closed { count } else { count - 1 };
    let side = |a: Vec3, b: Vec3, c: Vec3| (b - a).cross(&(c - a)).dot(&normal);
    let ends = |i: usize| (points[i], points[(i + 1) % count]);
    let apart = |i: usize, j: usize| j > i + 1 && (j + 1) % count != i;
    let pairs = (0..segments).flat_map(|i| (i + 1..segments).map(move |j| (i, j)));
    let crosses = |&(i, j): &(usize, usize)| {
        let ((a, b), (c, d)) = (ends(i), ends(j));
        apart(i, j) && side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
    };
    pairs.into_iter().find(crosses).map(|(i, j)| [i, j])
}

fn annulus_targets(model: &Model) -> Vec<Vec3> {
    let target = |&vertex: &u32| match model.prescribed.binary_search_by_key(&vertex, |p| p.vertex) {
        Ok(found) => model.prescribed[found].target_mm,
        Err(_) => model.rest_mm[vertex as usize],
    };
    model.annulus.iter().map(target).collect()
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

/// Where all annulus points end up, in the order of the curve.
fn sew(annulus: &AnnulusCurve, curve: &RingCurve, sutures: &Sutures) -> Vec<Vec3> {
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
        Some(arc) => on_ring(arc),
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
fn warp(annulus: &AnnulusCurve, sutures: &Sutures, moved: &[Vec3]) -> [f64; 2] {
    let sewn = (0..moved.len()).filter(|&i| sutures.ring_arc_mm[i].is_some());
    let distances: Vec<f64> = sewn.map(|i| (moved[i] - annulus.points_mm[i]).norm()).collect();
    let mean = distances.iter().sum::<f64>() / distances.len().max(1) as f64;
    [mean, distances.into_iter().fold(0.0, f64::max)]
}

fn report(ring: &Ring, annulus: &AnnulusCurve, laid: &Laid) -> RingReport {
    let Laid {
        curve,
        sutures,
        moved,
        warp_mm,
        ..
    } = laid;
    let count = moved.len();
    let edge = |points: &[Vec3], i: usize| (points[(i + 1) % count] - points[i]).norm();
    let stretches = (0..count)
        .map(|i| edge(moved, i) / edge(&annulus.points_mm, i))
        .filter(|s| s.is_finite());
    let tilt = normal_of(&placement::outline(curve)).angle(&normal_of(&annulus.points_mm));
    RingReport {
        family: ring.family,
        size_mm: ring.family.and(ring.size_mm),
        ring_length_mm: polyline::length(&curve.points_mm, curve.closed),
        annulus_length_mm: sutures.span_mm[1] - sutures.span_mm[0],
        curve_mm: curve.points_mm.clone(),
        closed: curve.closed,
        warp_mean_mm: warp_mm[0],
        warp_max_mm: warp_mm[1],
        edge_stretch_min: stretches.clone().fold(f64::INFINITY, f64::min),
        edge_stretch_max: stretches.fold(0.0, f64::max),
        tilt_degrees: tilt.to_degrees(),
    }
}

/// Refuses rings that do not belong here; tells what is doubtful.
fn judge(
    model: &Model,
    report: &RingReport,
    annulus: &AnnulusCurve,
    sutures: &Sutures,
) -> Result<Vec<Fault>, Vec<Fault>> {
    let scale = report.ring_length_mm / report.annulus_length_mm;
    let lengths = format!(
        "the ring is {:.1} mm long, the annulus under it {:.1} mm; the annulus moves by {:.1} mm, at most {:.1} mm",
        report.ring_length_mm, report.annulus_length_mm, report.warp_mean_mm, report.warp_max_mm
    );
    if !(1.0 / LARGEST_SCALE..=LARGEST_SCALE).contains(&scale) {
        return Err(vec![Fault::error(
            "ring",
            format!("{lengths}; expected at most a factor of {LARGEST_SCALE}"),
        )]);
    }
    let mut warnings = Vec::new();
    // A hundredth longer is the same size.
    if scale > 1.01 {
        warnings.push(Fault::warning(
            "ring",
            format!("{lengths}: it widens the annulus"),
        ));
    }
    if report.tilt_degrees > DOUBTFUL_TILT_DEGREES {
        let tilt = report.tilt_degrees;
        let message = format!(
            "its plane is tilted {tilt:.0} degrees against the annulus, expected below {DOUBTFUL_TILT_DEGREES}"
        );
        warnings.push(Fault::warning("ring", message));
    }
    if !sutures.unfolded.is_empty() {
        let name = |&i: &usize| model.annulus[annulus.order[i]].to_string();
        let vertices: Vec<String> = sutures.unfolded.iter().map(name).collect();
        let message = format!(
            "nearest points fold; these vertices were spread along the ring in order: {}",
            vertices.join(", ")
        );
        warnings.push(Fault::warning("ring.attachment", message));
    }
    if sutures.gave_up {
        let message =
            "nearest points do not go around the ring; points were sewn in proportion to arc length instead";
        warnings.push(Fault::warning("ring.attachment", message));
    }
    Ok(warnings)
}

fn with_targets(model: &Model, annulus: &AnnulusCurve, moved: &[Vec3]) -> Model {
    let mut model = model.clone();
    for (&index, &target_mm) in annulus.order.iter().zip(moved) {
        let vertex = model.annulus[index];
        if let Ok(found) = model.prescribed.binary_search_by_key(&vertex, |p| p.vertex) {
            model.prescribed[found].target_mm = target_mm;
        }
    }
    model
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::fixtures::{built, skirt};
    use crate::repair::apply;
    use crate::repair::ring_shape::{family_curve, parse_ring_spec};
    use crate::scene::{Repair, Severity};

    fn skirt_model() -> Model {
        built(&skirt()).model
    }

    fn done(model: &Model, ring: &Ring) -> (Model, RingReport, Vec<Fault>) {
        let repaired =
            apply(model, &Repair::Ring(ring.clone())).unwrap_or_else(|faults| panic!("{faults:#?}"));
        let Report::Ring(report) = repaired.report;
        (repaired.model, report, repaired.warnings)
    }

    fn refused(ring: &Ring, words: &str) {
        let faults = apply(&skirt_model(), &Repair::Ring(ring.clone()))
            .err()
            .unwrap_or_default();
        let found = faults
            .iter()
            .any(|f| f.severity == Severity::Error && f.message.contains(words));
        assert!(found, "no `{words}` in {faults:#?}");
    }

    fn curve(points: &[Vec3]) -> Ring {
        Ring {
            family: None,
            size_mm: None,
            curve_mm: Some(points.iter().map(|&p| p.into()).collect()),
            ..parse_ring_spec("saddle:30").unwrap()
        }
    }

    #[test]
    fn only_targets_of_annulus_points_change() {
        let model = skirt_model();
        for spec in [
            "physio-like:32",
            "saddle:32",
            "reduced-ap:32",
            "classic-like:32",
            "posterior-band:32",
        ] {
            let (after, report, warnings) = done(&model, &parse_ring_spec(spec).unwrap());
            assert!(warnings.is_empty(), "{spec}: {warnings:?}");
            assert_eq!(
                (&after.rest_mm, &after.springs, &after.chords),
                (&model.rest_mm, &model.springs, &model.chords)
            );
            for (old, new) in model.prescribed.iter().zip(&after.prescribed) {
                assert_eq!(old.vertex, new.vertex);
                if !model.annulus.contains(&old.vertex) {
                    assert_eq!(old, new);
                }
            }
            assert!(
                report.warp_mean_mm > 0.5 && report.warp_mean_mm <= report.warp_max_mm,
                "{spec}: {report:?}"
            );
            assert!(
                report.edge_stretch_max < 1.0 || !report.closed,
                "{spec}: a smaller ring gathers: {report:?}"
            );
            assert!(report.edge_stretch_min > 0.3, "{spec}: {report:?}");
        }
    }

    #[test]
    fn closed_rings_hold_every_point() {
        let model = skirt_model();
        let (after, report, _) = done(&model, &parse_ring_spec("physio-like:30").unwrap());
        for target in annulus_targets(&after) {
            // Points on the polyline, to rounding.
            assert!(
                polyline::nearest(&report.curve_mm, true, target)
                    .unwrap()
                    .distance_mm
                    < 1e-9
            );
        }
        let at = |index: usize| annulus_targets(&after)[index];
        assert!(
            at(after.landmarks.mid_anterior).y > at(after.landmarks.mid_posterior).y,
            "front stays front"
        );
    }

    #[test]
    fn the_gap_of_an_open_ring_stays() {
        let model = skirt_model();
        let (after, _, _) = done(&model, &parse_ring_spec("classic-like:30").unwrap());
        let middle = model.landmarks.mid_anterior;
        // The anterior middle lies over 9 mm of arc from both trigones: beyond the blend.
        assert_eq!(annulus_targets(&after)[middle], annulus_targets(&model)[middle]);
        let posterior = model.landmarks.mid_posterior;
        assert_ne!(
            annulus_targets(&after)[posterior],
            annulus_targets(&model)[posterior]
        );
    }

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

    #[test]
    fn what_does_not_belong_is_refused() {
        let ring = parse_ring_spec("physio-like:28").unwrap();
        refused(
            &Ring {
                size_mm: Some(60.0),
                ..ring.clone()
            },
            "20 to 44 mm",
        );
        refused(
            &Ring {
                size_mm: None,
                ..ring.clone()
            },
            "absent",
        );
        refused(
            &Ring {
                family: None,
                ..ring.clone()
            },
            "neither family nor curve",
        );
        refused(
            &Ring {
                placed: true,
                ..ring.clone()
            },
            "no place of its own",
        );
        let round = family_curve(RingFamily::PhysioLike, 30.0).points_mm;
        refused(
            &Ring {
                family: ring.family,
                ..curve(&round)
            },
            "a family and a curve",
        );
        refused(&curve(&round[..5]), "has 5 points");
        let twice: Vec<Vec3> = round.iter().map(|p| p * 2.5).collect();
        refused(&curve(&twice), "factor of 2");
        let mut crossed = round.clone();
        crossed[100..300].reverse();
        refused(&curve(&crossed), "crosses itself");
        let mut bad = round;
        bad[7].x = f64::NAN;
        refused(&curve(&bad), "not finite");
    }

    #[test]
    fn wide_and_tilted_rings_are_told() {
        let model = skirt_model();
        let (_, _, warnings) = done(&model, &parse_ring_spec("saddle:44").unwrap());
        assert!(warnings.iter().any(|w| w.message.contains("widens")));
        let turn = nalgebra::Rotation3::from_euler_angles(0.8, 0.0, 0.0);
        let points: Vec<Vec3> = annulus_targets(&model).iter().map(|p| turn * p * 0.9).collect();
        let (_, report, warnings) = done(
            &model,
            &Ring {
                placed: true,
                ..curve(&points)
            },
        );
        assert!((report.tilt_degrees - 0.8_f64.to_degrees()).abs() < 1e-6);
        assert!(
            warnings.iter().any(|w| w.message.contains("tilted 46 degrees")),
            "{warnings:?}"
        );
    }

    #[test]
    fn a_patch_cannot_take_a_ring() {
        let mut model = skirt_model();
        model.margins[0].closed = false;
        let ring = Repair::Ring(parse_ring_spec("saddle:28").unwrap());
        assert!(apply(&model, &ring).is_err());
    }
}
