//! Annuloplasty: the annulus is drawn onto a ring. Only where annulus points end up changes; rest lengths stay,
//! so that leaflets feel the change of their hinge.

use crate::Vec3;
use crate::mesh::polyline;
use crate::model::Model;
use crate::repair::placement;
use crate::repair::ring_attachment::{AnnulusCurve, Sutures};
use crate::repair::ring_candidates::candidates;
use crate::repair::ring_flexible::gather;
use crate::repair::ring_laying::{Laid, doubt_side, lay};
use crate::repair::ring_shape::{RingCurve, normal_of};
use crate::repair::{Repaired, Report};
use crate::scene::{Attachment, Fault, Ring, RingFamily};

/// Rings this much longer or shorter than what they are sewn to do not belong to this valve.
const LARGEST_SCALE: f64 = 2.0;

/// Planes of annulus and placed ring that differ by more are doubted [degree].
const DOUBTFUL_TILT_DEGREES: f64 = 30.0;

/// What a ring did to the annulus.
#[derive(Clone, Debug, PartialEq)]
pub struct RingReport {
    /// Family; none for a measured curve.
    pub family: Option<RingFamily>,
    /// Size [mm]; none for a measured curve.
    pub size_mm: Option<f64>,
    /// How many sutures hold it; none where it holds the annulus everywhere.
    pub sutures: Option<u32>,
    /// Whether it takes the annulus' length only.
    pub flexible: bool,
    /// The ring where it lies [mm], shape `[point]`; a flexible one lies in the annulus.
    pub curve_mm: Vec<Vec3>,
    /// Whether the ring is closed.
    pub closed: bool,
    /// How large it is where it lies.
    pub laid: RingExtent,
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

/// The curve of a ring, measured along its own axes: a family's is its inner border. What is told of the annulus beside it is another
/// thing, the commissures for one do not lie where a ring is widest.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RingExtent {
    /// Transverse diameter [mm]: the extent across the line from its posterior to its anterior middle; a family's size.
    pub width_mm: f64,
    /// Anteroposterior diameter [mm]: the extent along that line, in the ring's best plane; of an open ring to where its anterior middle
    /// would be. Not a saddle's `ap_mm`: one of 30 mm with an `ap_mm` of 22.5 mm is 23.1 mm deep here.
    pub depth_mm: f64,
    /// Height [mm]: the extent along the normal of its best plane; nothing in a planar ring. Not a saddle's `saddle_height_mm`, which is
    /// measured from its widest line: a saddle of 30 mm for which that is 6 mm is 4.6 mm high here.
    pub height_mm: f64,
    /// Whether it goes all the way round. Where an open one does not, it does not settle how deep the annulus becomes.
    pub closed: bool,
}

/// How large a ring is along its own axes; nothing where these are not told apart.
fn extent(curve: &RingCurve) -> RingExtent {
    let points = placement::outline(curve);
    let normal = normal_of(&points);
    let to_front = curve.marks.mid_anterior - curve.marks.mid_posterior;
    let Some(front) = (to_front - normal * normal.dot(&to_front)).try_normalize(1e-9) else {
        return RingExtent::default();
    };
    let along = |axis: Vec3| {
        let places = points.iter().map(|point| point.dot(&axis));
        let ends = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
            [low.min(at), high.max(at)]
        });
        ends[1] - ends[0]
    };
    RingExtent {
        width_mm: along(normal.cross(&front)),
        depth_mm: along(front),
        height_mm: along(normal),
        closed: curve.closed,
    }
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
    let gathered = ring.flexible.then(|| gather(&annulus, best));
    let best = gathered.as_ref().unwrap_or(best);
    let report = report(ring, &annulus, best);
    let mut warnings = judge(model, &report, &annulus, &best.sutures)?;
    if !ring.flexible {
        warnings.extend(doubt_side(best, &laid));
    }
    Ok(Repaired {
        model: with_targets(model, &annulus, &best.moved),
        report: Report::Ring(report),
        warnings,
    })
}

/// Where the annulus is when the valve is closed [mm], shape `[annulus vertex]`.
pub(super) fn annulus_targets(model: &Model) -> Vec<Vec3> {
    model
        .annulus
        .iter()
        .map(|&vertex| model.target_mm(vertex))
        .collect()
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
        sutures: (ring.attachment == Attachment::Sutures).then(|| ring.suture_count()),
        flexible: ring.flexible,
        laid: extent(curve),
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
        return Err(vec![Fault::of_shape(
            "ring",
            format!("{lengths}; expected lengths within a factor of {LARGEST_SCALE} of each other"),
        )]);
    }
    // Half of the annulus' mean diameter: no ring that is sewn in moves it as far.
    let farthest_mm = 0.5 * report.annulus_length_mm / std::f64::consts::PI;
    if report.warp_mean_mm > farthest_mm {
        return Err(vec![Fault::of_shape(
            "ring",
            format!(
                "{lengths}; expected a ring that stands at the annulus, within {farthest_mm:.1} mm on average"
            ),
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
        if let Some(target) = model.target_mut(model.annulus[index]) {
            *target = target_mm;
        }
    }
    model
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::model::fixtures::{built, skirt};
    use crate::repair::apply;
    use crate::repair::ring_shape::parse_ring_spec;
    use crate::scene::Repair;

    pub(in super::super) fn skirt_model() -> Model {
        built(&skirt()).model
    }

    pub(in super::super) fn done(model: &Model, ring: &Ring) -> (Model, RingReport, Vec<Fault>) {
        let repaired =
            apply(model, &Repair::Ring(ring.clone())).unwrap_or_else(|faults| panic!("{faults:#?}"));
        let Report::Ring(report) = repaired.report else {
            panic!("{:?}", repaired.report);
        };
        (repaired.model, report, repaired.warnings)
    }

    pub(in super::super) fn curve(points: &[Vec3]) -> Ring {
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

    /// A family's ring is as wide as its size says and three quarters as deep, one of reduced depth 0.84 of that, whatever the annulus;
    /// a planar one has no height, and a measured curve is told as it was given. The curve is a polyline, and loses a tenth of a
    /// millimetre at most between its points.
    #[test]
    fn a_ring_is_told_as_large_as_it_is() {
        let model = skirt_model();
        let laid = |ring: &Ring| done(&model, ring).1.laid;
        for (family, depth) in [
            ("classic-like", 0.75),
            ("posterior-band", 0.75),
            ("physio-like", 0.75),
            ("reduced-ap", 0.63),
        ] {
            for size in [28.0, 32.0] {
                let laid = laid(&parse_ring_spec(&format!("{family}:{size}")).unwrap());
                assert!((laid.width_mm - size).abs() < 0.1, "{family} {size}: {laid:?}");
                assert!(
                    (laid.depth_mm - depth * size).abs() < 0.1,
                    "{family} {size}: {laid:?}"
                );
                let is_planar = matches!(family, "classic-like" | "posterior-band");
                assert_eq!(laid.closed, !is_planar, "{family}");
                assert_eq!(laid.height_mm < 1e-9, is_planar, "{family} {size}: {laid:?}");
            }
        }
        let saddle = laid(&parse_ring_spec("saddle:30").unwrap());
        // The ratio of height to width that the family was made for, across its best plane.
        assert!(
            (saddle.height_mm / saddle.width_mm - 0.2).abs() < 0.01,
            "{saddle:?}"
        );
        assert!((saddle.width_mm - 30.0).abs() < 0.1, "{saddle:?}");
        // The best plane leans with the line from the posterior middle, which is 1.8 mm high, to the anterior one.
        let lower = laid(&Ring {
            saddle_height_mm: Some(6.0),
            ..parse_ring_spec("saddle:30").unwrap()
        });
        assert!((lower.height_mm - 4.6).abs() < 0.05, "{lower:?}");
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
