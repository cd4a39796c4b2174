//! Rings that are no frames: fully flexible ones take length from the annulus and leave it its shape.
//!
//! What lies under the ring becomes smaller, alike in all directions: under a closed one about the annulus' centroid, under an open
//! one about the middle between its ends. In the gap of an open one the motion fades, as with frames.

use super::ring_attachment::AnnulusCurve;
use super::ring_laying::{Laid, sew, warp};
use crate::Vec3;
use crate::mesh::polyline;

/// The ring laid into the annulus, which is gathered to its length; one that is longer changes nothing.
pub(super) fn gather(annulus: &AnnulusCurve, laid: &Laid) -> Laid {
    let [from, to] = laid.sutures.span_mm;
    let mut curve = laid.curve.clone();
    let length_mm = polyline::length(&curve.points_mm, curve.closed);
    let scale = (length_mm / (to - from)).min(1.0);
    let end = |arc: f64| polyline::point_at_arc(&annulus.points_mm, true, &annulus.arcs_mm, arc);
    let points = &annulus.points_mm;
    let (under, centre) = if curve.closed {
        (points.clone(), polyline::centroid(points, true))
    } else {
        let within = (0..points.len()).filter(|&i| from < annulus.arcs_mm[i] && annulus.arcs_mm[i] < to);
        let mut under: Vec<Vec3> = vec![end(from)];
        under.extend(within.map(|i| points[i]));
        under.push(end(to));
        (under, (end(from) + end(to)) * 0.5)
    };
    curve.points_mm = under.iter().map(|p| centre + (p - centre) * scale).collect();
    let mut sutures = laid.sutures.clone();
    for (arc, &at) in sutures.ring_arc_mm.iter_mut().zip(&annulus.arcs_mm) {
        *arc = arc.map(|_| (at - from) * scale);
    }
    let moved = sew(annulus, &curve, &sutures, None);
    Laid {
        warp_mm: warp(annulus, &sutures, &moved),
        misfit_mm: laid.misfit_mm,
        sutures,
        curve,
        moved,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repair::ring::annulus_targets;
    use crate::repair::ring::tests::{done, skirt_model};
    use crate::repair::ring_shape::parse_ring_spec;
    use crate::scene::Ring;

    fn flexible(spec: &str) -> Ring {
        Ring {
            flexible: true,
            ..parse_ring_spec(spec).unwrap()
        }
    }

    /// The annulus is as long as the ring, to rounding, and similar to what it was: every edge in the same ratio.
    #[test]
    fn a_closed_one_makes_the_annulus_smaller_and_no_other() {
        let model = skirt_model();
        let rigid = done(&model, &parse_ring_spec("physio-like:30").unwrap())
            .1
            .ring_length_mm;
        let (after, report, warnings) = done(&model, &flexible("physio-like:30"));
        let [old, new] = [&model, &after].map(annulus_targets);
        let length = polyline::length(&new, true);
        assert!(
            (length - rigid).abs() < 1e-9 && warnings.is_empty(),
            "{length} {rigid} {warnings:?}"
        );
        assert!((report.edge_stretch_max - report.edge_stretch_min).abs() < 1e-9);
        assert!((length / polyline::length(&old, true) - report.edge_stretch_min).abs() < 1e-9);
        let (same, _, _) = done(&model, &flexible("physio-like:44"));
        assert_eq!(annulus_targets(&same).len(), old.len());
        for (a, b) in annulus_targets(&same).iter().zip(&old) {
            assert!((a - b).norm() < 1e-9, "a longer ring widens nothing");
        }
    }

    /// Under an open one the annulus is as long as the ring; what lies in its gap stays.
    #[test]
    fn an_open_one_gathers_what_lies_under_it() {
        let model = skirt_model();
        let (after, report, _) = done(&model, &flexible("classic-like:34"));
        let before = annulus_targets(&model);
        let targets = annulus_targets(&after);
        let under = polyline::length(&report.curve_mm, false);
        let rigid = done(&model, &parse_ring_spec("classic-like:34").unwrap())
            .1
            .ring_length_mm;
        // The ring lies in the annulus, scaled: as long to rounding.
        assert!((under - rigid).abs() < 1e-9, "{under} {rigid}");
        let anterior = model.landmarks.mid_anterior;
        assert!((targets[anterior] - before[anterior]).norm() < 1e-12);
        let posterior = model.landmarks.mid_posterior;
        assert!((targets[posterior] - before[posterior]).norm() > 0.5);
    }
}
