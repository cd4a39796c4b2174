//! How far each vertex may move so that nothing passes through anything.
//!
//! For two parts at distance d > 0 the plane through the closest points' connection, perpendicular to it,
//! separates them. If every vertex stays on its own side of one such plane during a straight step, the parts
//! cannot meet. The gap is shared out in proportion to how fast each side approaches; sliding along the plane
//! is free. Pairs that are not listed are farther apart than the step can bridge
//! ([`super::pairs::PairList::covers`]).

use super::pairs::{Pair, corners};
use crate::Vec3;

/// Part of a gap that one step may use up [1]. At 1 parts would touch; a smaller part only costs steps.
pub const GAP_FRACTION: f64 = 0.9;

/// Shortens the step of each vertex as far as needed; a shortened step keeps its direction.
pub fn shorten(pairs: &[Pair], positions_mm: &[Vec3], step_mm: &mut [Vec3]) {
    let mut allowed = vec![1.0_f64; step_mm.len()];
    for pair in pairs {
        bound_pair(pair, positions_mm, step_mm, &mut allowed);
    }
    for (step, allowed) in step_mm.iter_mut().zip(allowed) {
        *step *= allowed;
    }
}

fn bound_pair(pair: &Pair, positions_mm: &[Vec3], step_mm: &[Vec3], allowed: &mut [f64]) {
    let steps = corners(&pair.vertices, step_mm);
    let nearest = pair.nearest(positions_mm);
    let distance = nearest.separation_mm.norm();
    let longest = |range: &[usize]| range.iter().map(|&k| steps[k].norm()).fold(0.0, f64::max);
    let (first, second): (&[usize], &[usize]) = sides(pair);
    if longest(first) + longest(second) <= GAP_FRACTION * distance {
        return;
    }
    if distance == 0.0 {
        pair.vertices
            .iter()
            .for_each(|&vertex| allowed[vertex as usize] = 0.0);
        return;
    }
    let normal = nearest.separation_mm / distance;
    let corners = corners(&pair.vertices, positions_mm);
    // How far a vertex stands behind its side's closest point, and how far its step goes towards the other side.
    let closest = |range: &[usize]| {
        range
            .iter()
            .map(|&k| corners[k] * nearest.weights[k].abs())
            .sum::<Vec3>()
    };
    let (from_first, from_second) = (closest(first), closest(second));
    let spare_first = |k: usize| (corners[k] - from_first).dot(&normal).max(0.0);
    let spare_second = |k: usize| (from_second - corners[k]).dot(&normal).max(0.0);
    let towards_second = |k: usize| -steps[k].dot(&normal);
    let towards_first = |k: usize| steps[k].dot(&normal);
    let need = |range: &[usize], towards: &dyn Fn(usize) -> f64, spare: &dyn Fn(usize) -> f64| {
        range.iter().map(|&k| towards(k) - spare(k)).fold(0.0, f64::max)
    };
    let need_first = need(first, &towards_second, &spare_first);
    let need_second = need(second, &towards_first, &spare_second);
    let gap = GAP_FRACTION * distance;
    if need_first + need_second <= gap {
        return;
    }
    let share = gap / (need_first + need_second);
    for &k in first {
        limit(
            &mut allowed[pair.vertices[k] as usize],
            towards_second(k),
            spare_first(k) + need_first * share,
        );
    }
    for &k in second {
        limit(
            &mut allowed[pair.vertices[k] as usize],
            towards_first(k),
            spare_second(k) + need_second * share,
        );
    }
}

fn sides(pair: &Pair) -> (&'static [usize], &'static [usize]) {
    match pair.kind {
        super::pairs::PairKind::PointTriangle => (&[0], &[1, 2, 3]),
        super::pairs::PairKind::EdgeEdge => (&[0, 1], &[2, 3]),
    }
}

fn limit(allowed: &mut f64, towards_mm: f64, room_mm: f64) {
    if towards_mm > room_mm {
        *allowed = allowed.min(room_mm / towards_mm);
    }
}
