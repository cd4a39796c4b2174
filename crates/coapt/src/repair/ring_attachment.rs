//! Which point of a ring each annulus point is sewn to.

use crate::Vec3;
use crate::mesh::landmarks::AnnulusLandmarks;
use crate::mesh::polyline;
use crate::repair::ring_shape::RingCurve;

/// A landmark of an open ring belongs to the ring, and not to its gap, within this distance [mm].
const ON_RING_MM: f64 = 0.5;

/// Neighbours closer on the ring than this part of their due distance count as folded.
const FOLD: f64 = 0.3;

/// Folded stretches are widened until neighbours have this part of their due distance.
const UNFOLDED: f64 = 0.5;

/// The annulus as a curve from its anterior middle on, counter-clockwise seen from the atrium.
#[derive(Clone, Debug)]
pub struct AnnulusCurve {
    /// Where vertices stand in the model's annulus, shape `[point]`.
    pub order: Vec<usize>,
    /// Points [mm].
    pub points_mm: Vec<Vec3>,
    /// Arc lengths [mm], one more than points.
    pub arcs_mm: Vec<f64>,
    /// Points of the trigones: the first counter-clockwise from the anterior middle, the second.
    pub trigones: [usize; 2],
    /// Point of the posterior middle.
    pub mid_posterior: usize,
}

impl AnnulusCurve {
    /// Starts the annulus (in the model's order) at its anterior middle.
    pub fn new(annulus_mm: &[Vec3], marks: &AnnulusLandmarks) -> Self {
        let count = annulus_mm.len();
        let order: Vec<usize> = (0..count).map(|i| (i + marks.mid_anterior) % count).collect();
        let points_mm: Vec<Vec3> = order.iter().map(|&i| annulus_mm[i]).collect();
        let place = |index: usize| (index + count - marks.mid_anterior) % count;
        let (left, right) = (place(marks.trigone_left), place(marks.trigone_right));
        Self {
            arcs_mm: polyline::arc_lengths(&points_mm, true),
            order,
            points_mm,
            trigones: [left.min(right), left.max(right)],
            mid_posterior: place(marks.mid_posterior),
        }
    }

    /// The whole length [mm].
    pub fn length_mm(&self) -> f64 {
        self.arcs_mm.last().copied().unwrap_or(0.0)
    }
}

/// Where on the ring the annulus points go.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sutures {
    /// Arc length on the ring [mm], none for points in the gap of an open ring; shape `[annulus point]`.
    pub ring_arc_mm: Vec<Option<f64>>,
    /// The stretch of the annulus that is sewn, from and to [mm of arc]; the whole for a closed ring.
    pub span_mm: [f64; 2],
    /// Points that were moved along the ring because they had folded.
    pub unfolded: Vec<usize>,
    /// Nearest points did not go once around the ring; arc length was used instead.
    pub gave_up: bool,
}

/// Matching places: arc length on the annulus, arc length on the ring; ascending in both.
pub(super) type Knots = Vec<[f64; 2]>;

/// Sews in proportion to arc length between matching landmarks: trigones, posterior and anterior middle.
/// Commissures are left to proportion, for most rings do not mark them and their angle varies most.
pub fn by_arc_length(annulus: &AnnulusCurve, ring: &RingCurve) -> Sutures {
    let knots = knots(annulus, ring);
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    let arc = |&a: &f64| (first[0] <= a && a <= last[0]).then(|| ring_arc_mm(&knots, a));
    let count = annulus.points_mm.len();
    Sutures {
        ring_arc_mm: annulus.arcs_mm[..count].iter().map(arc).collect(),
        span_mm: [first[0], last[0]],
        ..Sutures::default()
    }
}

/// The arc length on the ring that belongs to one on the annulus, between matching places.
pub(super) fn ring_arc_mm(knots: &Knots, annulus_arc_mm: f64) -> f64 {
    let next = knots
        .partition_point(|k| k[0] <= annulus_arc_mm)
        .clamp(1, knots.len() - 1);
    let ([a0, r0], [a1, r1]) = (knots[next - 1], knots[next]);
    r0 + (annulus_arc_mm - a0) / (a1 - a0) * (r1 - r0)
}

/// Matching places of annulus and ring: landmarks, and the ends.
pub(super) fn knots(annulus: &AnnulusCurve, ring: &RingCurve) -> Knots {
    let length = polyline::length(&ring.points_mm, ring.closed);
    let on_ring = |mark: Vec3| polyline::nearest(&ring.points_mm, ring.closed, mark);
    let start = if ring.closed {
        on_ring(ring.marks.mid_anterior).map_or(0.0, |found| found.arc_mm)
    } else {
        0.0
    };
    let annulus_end =
        |end: Vec3| polyline::nearest(&annulus.points_mm, true, end).map_or(0.0, |found| found.arc_mm);
    let [mut first, mut last] = [[0.0, start], [annulus.length_mm(), start + length]];
    if let (false, [one, .., other]) = (ring.closed, &ring.points_mm[..]) {
        [first[0], last[0]] = [annulus_end(*one), annulus_end(*other)];
    }
    let marks = [
        (annulus.trigones[0], ring.marks.trigones[0]),
        (annulus.mid_posterior, ring.marks.mid_posterior),
        (annulus.trigones[1], ring.marks.trigones[1]),
    ];
    let mut between = Knots::new();
    for (point, mark) in marks {
        let Some(found) = on_ring(mark).filter(|found| found.distance_mm <= ON_RING_MM) else {
            continue;
        };
        let at = annulus.arcs_mm[point];
        let arc = if found.arc_mm < start {
            found.arc_mm + length
        } else {
            found.arc_mm
        };
        // An open ring that ends at a trigone is sewn there, wherever the annulus comes nearest.
        match arc {
            arc if !ring.closed && arc < ON_RING_MM => first[0] = at,
            arc if !ring.closed && arc > length - ON_RING_MM => last[0] = at,
            _ => between.push([at, arc]),
        }
    }
    ascending(first, between, last)
}

/// Leaves out landmarks that come in another order on the ring than on the annulus.
fn ascending(first: [f64; 2], between: Knots, last: [f64; 2]) -> Knots {
    if first[0] >= last[0] {
        return vec![[0.0, first[1]], [first[0].max(f64::MIN_POSITIVE), last[1]]];
    }
    let mut knots = vec![first];
    for knot in between {
        let previous = knots[knots.len() - 1];
        if (0..2).all(|i| previous[i] < knot[i] && knot[i] < last[i]) {
            knots.push(knot);
        }
    }
    knots.push(last);
    knots
}

/// Sews each point to the nearest point of the ring (paper 003), in order: where neighbours come to lie on one
/// point or swap, the stretch around them is spread in proportion to the annulus.
pub fn by_nearest_point(annulus: &AnnulusCurve, ring: &RingCurve) -> Sutures {
    let even = by_arc_length(annulus, ring);
    let sewn: Vec<usize> = (0..annulus.points_mm.len())
        .filter(|&i| even.ring_arc_mm[i].is_some())
        .collect();
    let nearest = |&i: &usize| polyline::nearest(&ring.points_mm, ring.closed, annulus.points_mm[i]);
    let found: Vec<f64> = sewn
        .iter()
        .filter_map(nearest)
        .map(|found| found.arc_mm)
        .collect();
    let length = polyline::length(&ring.points_mm, ring.closed);
    let along: Vec<f64> = sewn.iter().map(|&i| annulus.arcs_mm[i]).collect();
    let unfolded = if ring.closed {
        unwrap(&found, length).and_then(|arcs| unfold(&along, arcs, Some([annulus.length_mm(), length])))
    } else {
        unfold(&along, found, None)
    };
    let Some((arcs, moved)) = unfolded else {
        return Sutures {
            gave_up: true,
            ..even
        };
    };
    let mut sutures = even;
    sewn.iter()
        .zip(arcs)
        .for_each(|(&i, arc)| sutures.ring_arc_mm[i] = Some(arc));
    sutures.unfolded = moved.into_iter().map(|i| sewn[i]).collect();
    sutures
}

/// Arc lengths that go on past the seam of a closed ring; nothing unless they go around once.
fn unwrap(arcs: &[f64], length: f64) -> Option<Vec<f64>> {
    let step = |from: f64, to: f64| (to - from + 0.5 * length).rem_euclid(length) - 0.5 * length;
    let mut unwrapped = vec![*arcs.first()?];
    for pair in arcs.windows(2) {
        unwrapped.push(unwrapped[unwrapped.len() - 1] + step(pair[0], pair[1]));
    }
    let around = unwrapped[arcs.len() - 1] + step(arcs[arcs.len() - 1], arcs[0]) - unwrapped[0];
    // Any other number of turns is off by a whole length.
    ((around - length).abs() < 0.5 * length).then_some(unwrapped)
}

/// Spreads folded stretches; gives the new arcs and the points moved, or nothing if no stretch is long enough.
///
/// `around`: lengths of annulus and ring where both are closed.
fn unfold(along: &[f64], mut arcs: Vec<f64>, around: Option<[f64; 2]>) -> Option<(Vec<f64>, Vec<usize>)> {
    let count = along.len() as isize;
    if count < 2 {
        return Some((arcs, Vec::new()));
    }
    let turn = |i: isize| i.div_euclid(count) as f64;
    let [whole, ring] = around.unwrap_or([0.0, 0.0]);
    let at = |i: isize| along[i.rem_euclid(count) as usize] + turn(i) * whole;
    let scale = match around {
        Some([annulus, ring]) => ring / annulus,
        None => (arcs[arcs.len() - 1] - arcs[0]) / (along[along.len() - 1] - along[0]),
    };
    let edges = if around.is_some() { count } else { count - 1 };
    let mut moved = Vec::new();
    for _ in 0..=count {
        let arc = |i: isize| arcs[i.rem_euclid(count) as usize] + turn(i) * ring;
        let part = |lo: isize, hi: isize| (arc(hi) - arc(lo)) / (scale * (at(hi) - at(lo)));
        let Some(fold) = (0..edges).find(|&e| part(e, e + 1) < FOLD) else {
            moved.sort_unstable();
            moved.dedup();
            return Some((arcs, moved));
        };
        let (mut lo, mut hi) = (fold, fold + 1);
        while part(lo, hi) < UNFOLDED {
            let (low, high) = if around.is_some() {
                (hi - count + 1, lo + count - 1)
            } else {
                (0, count - 1)
            };
            let before = (lo, hi);
            lo = (lo - 1).max(low);
            hi = if hi - lo < count - 1 {
                (hi + 1).min(high)
            } else {
                hi
            };
            if (lo, hi) == before {
                return None;
            }
        }
        let spread: Vec<(usize, f64)> = (lo + 1..hi)
            .map(|i| {
                let to = arc(lo) + (at(i) - at(lo)) / (at(hi) - at(lo)) * (arc(hi) - arc(lo));
                (i.rem_euclid(count) as usize, to - turn(i) * ring)
            })
            .collect();
        for (i, to) in spread {
            arcs[i] = to;
            moved.push(i);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repair::ring_shape::family_curve;
    use crate::scene::RingFamily;

    fn circle(radius: f64, count: usize) -> Vec<Vec3> {
        let point = |i: usize| {
            let (sin, cos) = (std::f64::consts::TAU * (0.25 + i as f64 / count as f64)).sin_cos();
            Vec3::new(radius * cos, radius * sin, 0.0)
        };
        (0..count).map(point).collect()
    }

    fn annulus(count: usize) -> AnnulusCurve {
        let marks = AnnulusLandmarks {
            mid_anterior: 0,
            trigone_left: count / 9,
            mid_posterior: count / 2,
            trigone_right: count - count / 9,
            ..AnnulusLandmarks::default()
        };
        AnnulusCurve::new(&circle(15.0, count), &marks)
    }

    #[test]
    fn landmarks_meet_and_order_is_kept() {
        let annulus = annulus(90);
        let ring = family_curve(RingFamily::PhysioLike, 28.0);
        let sutures = by_arc_length(&annulus, &ring);
        let point = |i: usize| polyline::point_at(&ring.points_mm, true, sutures.ring_arc_mm[i].unwrap());
        // Ring landmarks are found again as nearest points on the polyline, to rounding.
        assert!((point(0) - ring.marks.mid_anterior).norm() < 1e-9);
        assert!((point(annulus.trigones[0]) - ring.marks.trigones[0]).norm() < 1e-9);
        assert!((point(annulus.mid_posterior) - ring.marks.mid_posterior).norm() < 1e-9);
        assert!(sutures.ring_arc_mm.is_sorted());
    }

    #[test]
    fn the_gap_of_an_open_ring_is_not_sewn() {
        let annulus = annulus(90);
        let ring = family_curve(RingFamily::ClassicLike, 28.0);
        let sutures = by_arc_length(&annulus, &ring);
        let sewn: Vec<usize> = (0..90).filter(|&i| sutures.ring_arc_mm[i].is_some()).collect();
        assert_eq!(
            (sewn[0], sewn[sewn.len() - 1]),
            (annulus.trigones[0], annulus.trigones[1])
        );
        assert_eq!(sutures.ring_arc_mm[sewn[0]], Some(0.0));
    }

    #[test]
    fn folds_are_spread_in_order() {
        // Points 3, 4, 5 of ten come to one place and 6 before them.
        let along: Vec<f64> = (0..10).map(f64::from).collect();
        let arcs = vec![0.0, 1.0, 2.0, 4.0, 4.0, 4.0, 3.5, 7.0, 8.0, 9.0];
        let (arcs, moved) = unfold(&along, arcs, None).unwrap();
        assert!(arcs.windows(2).all(|pair| pair[1] - pair[0] >= FOLD), "{arcs:?}");
        assert_eq!((arcs[0], arcs[9]), (0.0, 9.0));
        assert!(moved.contains(&4) && moved.contains(&6) && !moved.contains(&9));
    }

    #[test]
    fn a_fold_across_the_seam_is_spread_too() {
        let along: Vec<f64> = (0..10).map(f64::from).collect();
        let found = vec![9.5, 9.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.5];
        let arcs = unwrap(&found, 10.0).unwrap();
        let (arcs, moved) = unfold(&along, arcs, Some([10.0, 10.0])).unwrap();
        let gap = |i: usize| arcs[(i + 1) % 10] + if i == 9 { 10.0 } else { 0.0 } - arcs[i];
        assert!((0..10).all(|i| gap(i) >= FOLD), "{arcs:?}");
        assert!(!moved.is_empty());
    }

    #[test]
    fn nearest_points_that_go_nowhere_are_given_up() {
        let far = family_curve(RingFamily::Saddle, 28.0).moved(|p| p + Vec3::new(200.0, 0.0, 0.0));
        let sutures = by_nearest_point(&annulus(90), &far);
        assert!(sutures.gave_up && sutures.ring_arc_mm.iter().all(Option::is_some));
    }
}
