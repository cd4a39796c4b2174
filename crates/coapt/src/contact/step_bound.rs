//! How far each vertex may move so that nothing passes through anything.
//!
//! For two parts at distance d > 0 the plane through the closest points' connection, perpendicular to it,
//! separates them. If every vertex stays on its own side of one such plane during a straight step, the parts
//! cannot meet. The gap is shared out in proportion to how fast each side approaches; sliding along the plane
//! is free; in needles a vertex slides before it is shortened. Pairs that are not listed are farther apart than the step can bridge ([`super::gather::PairList`]).

use super::gather::PairList;
use super::pairs::{Pair, PairKind, Place, corners};
use crate::Vec3;

/// Part of a gap that one step may use up [1]. At 1 parts would touch; a smaller part only costs steps.
pub const GAP_FRACTION: f64 = 0.9;

/// No step uses up more of a gap than leaves this [mm]. Where parts are nearer than some 1e-8 mm rounding moves closest
/// points by as much as the gap, and what separates them does so no more.
pub(super) const LEAST_GAP_MM: f64 = 1e-5;

/// Parts that are nearer than this do not move at all [mm]: the half that steps leave for rounding, which turns a separating plane
/// by 1e-16 of the parts' size over the gap. At 1e6 mmHg, between edges of 20 and 30 mm, it took 1e-9 mm off a gap in each of
/// thousands of steps, and the more the narrower the gap, until an edge had passed through. Nothing else comes so near.
const HELD_GAP_MM: f64 = 0.5 * LEAST_GAP_MM;

/// A step that may go this part of its way counts as allowed whole [1]: rounding alone must not shorten steps that have
/// been shortened before. What it then uses of a gap beyond its share is far less than what is left.
const SHORTENED_BELOW: f64 = 1.0 - 1e-6;

/// In needles, where parts are so much nearer at rest than elsewhere [1], what goes too far is at first taken off a step at
/// right angles to the plane, so that a vertex in the way of its own neighbours still goes along them. Shortened as a whole
/// it went by a hundredth of its way each time: a valve with needles of 1e-4 mm took 562 iterations, and takes 33. Between
/// all parts, Barlow valves under small rings take a third more iterations, and one does not come to rest. At 0.1 the needles
/// of that valve are not among them.
const NEEDLE: f64 = 0.2;

/// How far a vertex may go by the pair that bounds it most.
#[derive(Clone, Copy, Debug)]
pub struct Allowance {
    /// The part of its step [1].
    part: f64,
    /// What must be taken off its step at first [mm].
    excess_mm: Vec3,
}

const UNBOUNDED: Allowance = Allowance {
    part: 1.0,
    excess_mm: Vec3::new(0.0, 0.0, 0.0),
};

/// Bounds the step of each vertex and gathers the pairs that may touch along it. Then nothing passes through anything,
/// whatever part of the steps is taken.
///
/// Pairs are gathered as if all vertices went at the same rate. Bounded ones do not: whom they may meet then is looked for
/// again, until nobody needs to be bounded. What was shortened once stays so, since a separating plane holds for any part
/// of a step; sliding, which turns steps, is done once, before. `allowances` is room to work in.
pub fn bound_steps(
    list: &mut PairList,
    place: &Place,
    step_mm: &mut [Vec3],
    near: &mut Vec<Pair>,
    allowances: &mut Vec<Allowance>,
) {
    list.gather(place, step_mm, near);
    if !find_allowances(near, place, step_mm, allowances) {
        return;
    }
    for (step, allowance) in step_mm.iter_mut().zip(&*allowances) {
        *step -= allowance.excess_mm;
    }
    list.gather(place, step_mm, near);
    while find_allowances(near, place, step_mm, allowances) {
        for (step, allowance) in step_mm.iter_mut().zip(&*allowances) {
            if allowance.part < SHORTENED_BELOW {
                *step *= allowance.part;
            }
        }
        list.gather(place, step_mm, near);
    }
}

/// Finds how far each vertex may go; whether any must be bounded.
fn find_allowances(pairs: &[Pair], place: &Place, step_mm: &[Vec3], allowances: &mut Vec<Allowance>) -> bool {
    allowances.clear();
    allowances.resize(step_mm.len(), UNBOUNDED);
    for pair in pairs {
        bound_pair(pair, place, step_mm, allowances);
    }
    allowances
        .iter()
        .any(|allowance| allowance.part < SHORTENED_BELOW)
}

fn bound_pair(pair: &Pair, place: &Place, step_mm: &[Vec3], allowances: &mut [Allowance]) {
    let positions_mm = place.positions_mm;
    let corners = corners(&pair.vertices, positions_mm);
    let steps = pair.vertices.map(|vertex| step_mm[vertex as usize]);
    let nearest = pair.nearest(positions_mm);
    let squared = steps.map(|step| step.norm_squared());
    let longest_squared = squared[0].max(squared[1]).max(squared[2].max(squared[3]));
    let distance_squared = nearest.separation_mm.norm_squared();
    let distance = distance_squared.sqrt();
    let kept_mm = LEAST_GAP_MM.max(place.kept_fraction * pair.activation_mm);
    let gap = (GAP_FRACTION * distance).min(distance - kept_mm).max(0.0);
    if 4.0 * longest_squared <= gap * gap {
        return;
    }
    if distance < HELD_GAP_MM {
        for (&vertex, &excess_mm) in pair.vertices.iter().zip(&steps) {
            allowances[vertex as usize] = Allowance { part: 0.0, excess_mm };
        }
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
    let in_needle = pair.activation_mm < NEEDLE * place.longest_of_neighbours_mm();
    let share = gap / (need[0] + need[1]);
    for k in 0..4 {
        let room = spare[k] + need[usize::from(k >= first_count)] * share;
        let allowance = &mut allowances[pair.vertices[k] as usize];
        let part = room / towards[k];
        if towards[k] > room && part < allowance.part {
            *allowance = Allowance {
                part,
                excess_mm: match in_needle {
                    true => normal * (-side(k) * (towards[k] - room)),
                    false => steps[k] * (1.0 - part),
                },
            };
        }
    }
}
