//! How far each vertex may move so that nothing passes through anything.
//!
//! For two parts at distance d > 0 the plane through the closest points' connection, perpendicular to it,
//! separates them. If every vertex stays on its own side of one such plane during a straight step, the parts
//! cannot meet. The gap is shared out in proportion to how fast each side approaches; sliding along the plane
//! is free. Pairs that are not listed are farther apart than the step can bridge ([`super::gather::PairList`]).

use super::pairs::{Pair, PairKind, corners};
use crate::Vec3;

/// Part of a gap that one step may use up [1]. At 1 parts would touch; a smaller part only costs steps.
pub const GAP_FRACTION: f64 = 0.9;

/// No step uses up more of a gap than leaves this [mm]. Where parts are nearer than some 1e-8 mm rounding moves closest
/// points by as much as the gap, and what separates them does so no more.
const LEAST_GAP_MM: f64 = 1e-5;

/// A step that may go this part of its way counts as allowed whole [1]: rounding alone must not shorten steps that have
/// been shortened before. What it then uses of a gap beyond its share is far less than what is left.
const SHORTENED_BELOW: f64 = 1.0 - 1e-6;

/// Shortens the step of each vertex as far as needed, keeping its direction; whether any was. `allowed`, the part of its
/// step that each vertex may go [1], is room to work in.
pub fn shorten(pairs: &[Pair], positions_mm: &[Vec3], step_mm: &mut [Vec3], allowed: &mut Vec<f64>) -> bool {
    allowed.clear();
    allowed.resize(step_mm.len(), 1.0);
    for pair in pairs {
        bound_pair(pair, positions_mm, step_mm, allowed);
    }
    let mut shortened = false;
    for (step, &allowed) in step_mm.iter_mut().zip(&*allowed) {
        if allowed < SHORTENED_BELOW {
            *step *= allowed;
            shortened = true;
        }
    }
    shortened
}

fn bound_pair(pair: &Pair, positions_mm: &[Vec3], step_mm: &[Vec3], allowed: &mut [f64]) {
    let corners = corners(&pair.vertices, positions_mm);
    let steps = pair.vertices.map(|vertex| step_mm[vertex as usize]);
    let nearest = pair.nearest(positions_mm);
    let squared = steps.map(|step| step.norm_squared());
    let longest_squared = squared[0].max(squared[1]).max(squared[2].max(squared[3]));
    let distance_squared = nearest.separation_mm.norm_squared();
    let distance = distance_squared.sqrt();
    let gap = (GAP_FRACTION * distance).min(distance - LEAST_GAP_MM).max(0.0);
    if 4.0 * longest_squared <= gap * gap {
        return;
    }
    if distance == 0.0 {
        pair.vertices
            .iter()
            .for_each(|&vertex| allowed[vertex as usize] = 0.0);
        return;
    }
    let normal = nearest.separation_mm / distance;
    let first_count = match pair.kind {
        PairKind::PointTriangle => 1,
        PairKind::EdgeEdge => 2,
    };
    // Heights over the plane, away from the other side: of the closest point, and of each vertex behind it. How far
    // a vertex stands behind its side's closest point, and how far its step goes towards the other side.
    let side = |k: usize| if k < first_count { 1.0 } else { -1.0 };
    let height = |k: usize| side(k) * corners[k].dot(&normal);
    let mut closest = [0.0; 2];
    for k in 0..4 {
        closest[usize::from(k >= first_count)] += nearest.weights[k].abs() * height(k);
    }
    let spare: [f64; 4] =
        std::array::from_fn(|k| (height(k) - closest[usize::from(k >= first_count)]).max(0.0));
    let towards: [f64; 4] = std::array::from_fn(|k| -side(k) * steps[k].dot(&normal));
    let mut need = [0.0_f64; 2];
    for k in 0..4 {
        let need = &mut need[usize::from(k >= first_count)];
        *need = need.max(towards[k] - spare[k]);
    }
    if need[0] + need[1] <= gap {
        return;
    }
    let share = gap / (need[0] + need[1]);
    for k in 0..4 {
        let room = spare[k] + need[usize::from(k >= first_count)] * share;
        if towards[k] > room {
            let allowed = &mut allowed[pair.vertices[k] as usize];
            *allowed = allowed.min(room / towards[k]);
        }
    }
}
