//! The posterior annulus drawn together: a stretch of it is gathered, and all of it is so much shorter.
//!
//! Trigones and anterior annulus are fibrous and stay. The posterior annulus comes nearer to the line between the trigones, in
//! proportion, until it is as short as it must be; points outside the gathered stretch keep their distances along it.

use super::ring::annulus_targets;
use super::ring_attachment::AnnulusCurve;
use super::ring_shape::normal_of;
use crate::Vec3;
use crate::mesh::polyline;
use crate::model::Model;
use crate::scene::Fault;

/// How much of its length a gathered stretch keeps [1]: tissue that hangs on it lies in a pleat, which needs room. Our choice;
/// with less, neighbouring annulus points come nearer than leaflets are thick.
const KEPT: f64 = 0.4;

/// The posterior annulus is brought no nearer to the trigones' line than to this part of its depth [1] (our choice).
const LEAST_DEPTH: f64 = 0.3;

/// Draws the posterior annulus together between two places of the open valve; gives the length of the whole annulus before and
/// after [mm].
///
/// # Errors
/// The stretch is not on the posterior annulus, or too long for it, with `place`.
pub(super) fn plicate(model: &mut Model, ends_mm: [Vec3; 2], place: &str) -> Result<[f64; 2], Fault> {
    let rest: Vec<Vec3> = model.annulus.iter().map(|&v| model.rest_mm[v as usize]).collect();
    let targets = annulus_targets(model);
    let annulus = AnnulusCurve::new(&targets, &model.landmarks);
    let open: Vec<Vec3> = annulus.order.iter().map(|&i| rest[i]).collect();
    let [first, last] = annulus.trigones;
    let posterior = first..=last;
    let open_arcs = polyline::arc_lengths(&open[posterior.clone()], false);
    let arcs = polyline::arc_lengths(&annulus.points_mm[posterior.clone()], false);
    let at = |end: Vec3| {
        let foot = polyline::nearest(&open[posterior.clone()], false, end).map_or(0.0, |foot| foot.arc_mm);
        let after = open_arcs
            .partition_point(|&arc| arc <= foot)
            .clamp(1, arcs.len() - 1);
        let share = (foot - open_arcs[after - 1]) / (open_arcs[after] - open_arcs[after - 1]);
        arcs[after - 1] + share * (arcs[after] - arcs[after - 1])
    };
    let [one, other] = ends_mm.map(at);
    let [from, to] = [one.min(other), one.max(other)];
    let length_mm = arcs[arcs.len() - 1];
    let taken_mm = (1.0 - KEPT) * (to - from);
    let points = &annulus.points_mm[posterior];
    let Some(curve) = shortened(points, normal_of(&annulus.points_mm), length_mm - taken_mm) else {
        let message = format!(
            "gathers {:.1} of the {length_mm:.1} mm of posterior annulus; expected a narrower piece",
            to - from
        );
        return Err(Fault::of_shape(place, message));
    };
    let gathered = |arc: f64| arc - (1.0 - KEPT) * (arc.clamp(from, to) - from);
    let curve_arcs = polyline::arc_lengths(&curve, false);
    let moved = arcs
        .iter()
        .map(|&arc| polyline::point_at_arc(&curve, false, &curve_arcs, gathered(arc)));
    let mut drawn = targets.clone();
    for (&index, target) in annulus.order[first..=last].iter().zip(moved) {
        drawn[index] = target;
    }
    set_targets(model, &drawn);
    Ok([&targets, &drawn].map(|curve| polyline::length(curve, true)))
}

/// Sets where annulus points end up, shape `[annulus vertex]`.
fn set_targets(model: &mut Model, targets_mm: &[Vec3]) {
    for (index, &target_mm) in targets_mm.iter().enumerate() {
        if let Some(target) = model.target_mut(model.annulus[index]) {
            *target = target_mm;
        }
    }
}

/// A curve brought nearer to the line between its ends, in the plane with this normal, until it is so long; nothing where that
/// would leave less than [`LEAST_DEPTH`] of its depth.
fn shortened(points: &[Vec3], normal: Vec3, length_mm: f64) -> Option<Vec<Vec3>> {
    let origin = points[0];
    let deep = normal
        .cross(&(points[points.len() - 1] - origin))
        .try_normalize(0.0)?;
    let nearer = |part: f64| -> Vec<Vec3> {
        let moved = points
            .iter()
            .map(|p| p - deep * ((1.0 - part) * deep.dot(&(p - origin))));
        moved.collect()
    };
    let [mut short, mut long] = [LEAST_DEPTH, 1.0];
    let length = |part: f64| polyline::length(&nearer(part), false);
    if length(short) > length_mm {
        return None;
    }
    // Sixty halvings are more than a number has digits.
    for _ in 0..60 {
        let middle = 0.5 * (short + long);
        if length(middle) > length_mm {
            long = middle;
        } else {
            short = middle;
        }
    }
    Some(nearer(short))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::fixtures::{built, skirt};

    /// Ten millimetres about the posterior middle: the annulus is six shorter; trigones and what is anterior of them stay.
    #[test]
    fn the_posterior_annulus_is_shorter_by_what_is_gathered() {
        let mut model = built(&skirt()).model;
        let before = annulus_targets(&model);
        let middle = before[model.landmarks.mid_posterior];
        let ends = [-5.0, 5.0].map(|aside| {
            let foot = polyline::nearest(&before, true, middle).unwrap().arc_mm;
            polyline::point_at(&before, true, foot + aside)
        });
        let [long, short] = plicate(&mut model, ends, "test").unwrap();
        // The new points are joined by chords of the shortened curve, which cut its corners off: sides are 4 mm here, and half a
        // millimetre goes. With sides of 1 mm it is 0.1 mm, see `the_piece_has_the_area_of_its_shape`.
        assert!((long - short - 6.0).abs() < 0.8, "{long} {short}");
        let after = annulus_targets(&model);
        let annulus = AnnulusCurve::new(&before, &model.landmarks);
        for (i, &index) in annulus.order.iter().enumerate() {
            let stays = i <= annulus.trigones[0] || i >= annulus.trigones[1];
            assert_eq!(stays, (after[index] - before[index]).norm() < 1e-9, "{i}");
        }
        let wide = [
            before[model.landmarks.trigone_left],
            before[model.landmarks.trigone_right],
        ];
        let fault = plicate(&mut model, wide, "test").unwrap_err();
        assert!(fault.message.contains("expected a narrower piece"), "{fault:?}");
    }
}
