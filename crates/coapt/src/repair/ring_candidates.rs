//! What shape a ring has, and the ways in which it may lie; everything wrong with it is told here.

use crate::Vec3;
use crate::mesh::polyline;
use crate::model::Model;
use crate::repair::ring_faults::variant_faults;
use crate::repair::ring_shape::{self, RingCurve, normal_of};
use crate::scene::{Fault, Readable, Ring, RingFamily};

/// Measured curves: enough points for a shape, few enough to test each pair of segments for crossing.
const CURVE_POINTS: std::ops::RangeInclusive<usize> = 8..=5000;

/// Points farther from the origin of the frame are no anatomy [mm]; the bound keeps arithmetic finite (our choice).
const FARTHEST_MM: f64 = 1e6;

/// Every way in which the ring may lie, in its own frame.
pub(crate) fn candidates(model: &Model, ring: &Ring) -> Result<Vec<RingCurve>, Vec<Fault>> {
    let mut faults = Vec::new();
    if model.annulus.len() < 3 || model.margins.iter().any(|margin| !margin.closed) {
        faults.push(Fault::of_shape(
            "ring",
            "the annulus is no closed loop: there is nothing to sew a ring to",
        ));
    }
    faults.extend(variant_faults(ring));
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
            return vec![ring_shape::shaped_curve(
                family,
                size,
                ring.ap_mm,
                ring.saddle_height_mm,
            )];
        }
        Some(size) => faults.push(Fault::error(
            "ring.size_mm",
            format!("{} mm {}", Readable(size), ring_shape::size_range()),
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
        .position(|p| p.iter().any(|c| !c.is_finite() || c.abs() > FARTHEST_MM))
    {
        let [x, y, z] = points[bad].map(Readable);
        faults.push(Fault::error(
            format!("{place} point {bad}"),
            format!("is ({x}, {y}, {z}), expected numbers from -{FARTHEST_MM} to {FARTHEST_MM} mm"),
        ));
        return Vec::new();
    }
    let mut curve: Vec<Vec3> = points.iter().map(|&p| Vec3::from(p)).collect();
    let mean = polyline::length(&curve, false) / (curve.len() - 1) as f64;
    if !(mean.is_finite() && mean > 1e-6) {
        faults.push(Fault::error(place, "has no length"));
        return Vec::new();
    }
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

#[cfg(test)]
mod tests {
    use super::super::ring::tests::{curve, skirt_model};
    use super::*;
    use crate::repair::apply;
    use crate::repair::ring_shape::{family_curve, parse_ring_spec};
    use crate::scene::{Repair, Severity};

    fn refused(ring: &Ring, words: &str) {
        let faults = apply(&skirt_model(), &Repair::Ring(ring.clone()))
            .err()
            .unwrap_or_default();
        let found = faults
            .iter()
            .any(|f| f.severity == Severity::Error && f.message.contains(words));
        assert!(found, "no `{words}` in {faults:#?}");
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
        refused(&curve(&bad), "expected numbers from -1000000 to 1000000 mm");
    }

    #[test]
    fn odd_curves_are_survived() {
        let model = skirt_model();
        let line: Vec<Vec3> = (0..20).map(|i| Vec3::new(f64::from(i) * 4.0, 0.0, 0.0)).collect();
        let point = vec![Vec3::zeros(); 20];
        let zigzag: Vec<Vec3> = (0..20)
            .map(|i| Vec3::new(f64::from(i % 2) * 9.0, 0.0, f64::from(i % 3)))
            .collect();
        let round = family_curve(RingFamily::Saddle, 30.0).points_mm;
        let far: Vec<Vec3> = round.iter().map(|p| p + Vec3::new(300.0, 0.0, 0.0)).collect();
        for points in [line, point, zigzag, far] {
            for placed in [false, true] {
                for attachment in [Default::default(), crate::scene::Attachment::NearestPoint] {
                    for closed in [None, Some(true), Some(false)] {
                        let ring = Ring {
                            placed,
                            attachment,
                            closed,
                            ..curve(&points)
                        };
                        if let Ok(done) = apply(&model, &Repair::Ring(ring)) {
                            let targets = done
                                .model
                                .prescribed
                                .iter()
                                .flat_map(|p| p.target_mm.iter().copied());
                            assert!(targets.into_iter().all(f64::is_finite));
                        }
                    }
                }
            }
        }
    }
}
