//! Contact: the broad phase misses nothing, steps tunnel through nothing, the crossing test is right where
//! rounding would decide.

use coapt::Vec3;
use coapt::contact::broad::{Box3, SweepAndPrune};
use coapt::contact::crossing::crossings;
use coapt::contact::gather::PairList;
use coapt::contact::nearest::{Nearest, edge_edge, point_triangle, triangle_parameters};
use coapt::contact::pairs::{Pair, PairKind, Place};
use coapt::contact::step_bound::bound_steps;
use coapt::contact::surface::Surface;
use coapt_tests::Random;
use parry3d_f64::glamx::DVec3;
use parry3d_f64::query::PointQuery;
use parry3d_f64::query::details::closest_points_segment_segment_with_locations_nD;
use parry3d_f64::shape::{Segment, SegmentPointLocation, Triangle};
use std::collections::BTreeSet;

/// Triangles of edge length about `size` scattered in a cube of side 2, sharing vertices in places.
fn scattered_triangles(count: u32, size: f64, random: &mut Random) -> (Vec<[u32; 3]>, Vec<Vec3>) {
    let mut positions = Vec::new();
    for _ in 0..count {
        let centre = random.vector();
        positions.extend((0..3).map(|_| centre + random.vector() * size));
    }
    let mut faces: Vec<[u32; 3]> = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    // A tenth of the faces takes over a vertex of the one before.
    for k in (10..count as usize).step_by(10) {
        faces[k][0] = faces[k - 1][2];
    }
    (faces, positions)
}

fn overlap(one: &Box3, other: &Box3) -> bool {
    (0..3).all(|axis| one.low[axis] <= other.high[axis] && other.low[axis] <= one.high[axis])
}

/// Two boxes that overlap are told of once; of others only those that come to it when each grows by what single precision
/// rounds off a scene some 3 wide, 2⁻²³ of it twice.
#[test]
fn sweep_and_prune_finds_what_brute_force_finds_on_a_million_pairs_and_more() {
    let mut random = Random(11);
    let mut compared = 0_u64;
    for (count, size, margin) in [
        (800, 0.02, 0.0),
        (800, 0.02, 0.1),
        (800, 0.1, 0.05),
        (800, 0.6, 0.0),
        (1, 1.0, 0.0),
    ] {
        let (faces, positions) = scattered_triangles(count, size, &mut random);
        let boxes = |margin: f64| -> Vec<Box3> {
            let corners = faces
                .iter()
                .map(|face| face.map(|vertex| positions[vertex as usize]));
            corners.map(|corners| Box3::around(corners, margin)).collect()
        };
        let (exact, rounded) = (boxes(margin), boxes(margin + 1e-6));
        let mut sweep = SweepAndPrune::default();
        let compare = |found: &BTreeSet<[u32; 2]>, i: usize, j: usize| {
            let is_found = found.contains(&[i as u32, j as u32]);
            assert!(is_found || !overlap(&exact[i], &exact[j]), "{i} and {j} missed");
            assert!(
                !is_found || overlap(&rounded[i], &rounded[j]),
                "{i} and {j} far apart"
            );
        };
        // Among all, and between the first third and the rest, as seen from either.
        let count = exact.len();
        let among = each_once(sweep.among(&exact).iter().map(|&[i, j]| [i.min(j), i.max(j)]));
        let third = count / 3;
        let (ones, others) = exact.split_at(third);
        let shifted = |&[i, j]: &[u32; 2]| [i, j + third as u32];
        let between = each_once(sweep.between(ones, others).iter().map(shifted));
        for i in 0..count {
            for j in i + 1..count {
                compare(&among, i, j);
                if i < third && j >= third {
                    compare(&between, i, j);
                }
                compared += 1;
            }
        }
        let back = sweep.between(others, ones).iter().map(|&[j, i]| shifted(&[i, j]));
        assert_eq!(each_once(back), between);
    }
    assert!(compared > 1_000_000, "{compared}");
}

fn each_once(pairs: impl ExactSizeIterator<Item = [u32; 2]>) -> BTreeSet<[u32; 2]> {
    let count = pairs.len();
    let set: BTreeSet<[u32; 2]> = pairs.collect();
    assert_eq!(set.len(), count, "each pair once");
    set
}

#[test]
fn the_pair_list_holds_every_pair_in_reach() {
    let mut random = Random(12);
    let (faces, positions) = scattered_triangles(150, 0.15, &mut random);
    // Far apart at rest, so that every pair has the full thickness.
    let rest: Vec<Vec3> = (0..positions.len())
        .map(|k| Vec3::new(100.0 * k as f64, 0.0, 0.0))
        .collect();
    let surface = Surface::new(&faces, &rest);
    let mut list = PairList::default();
    let thickness = 0.1;
    // A step of many thicknesses, then some that a list outlasts: whatever is within the thickness at the end of any of
    // them must be found.
    let mut here = positions;
    for longest in [0.5, 0.005, 0.005, 0.01, 0.005, 0.05] {
        let step: Vec<Vec3> = here.iter().map(|_| random.vector() * longest).collect();
        let place = Place {
            surface: &surface,
            rest_mm: &rest,
            positions_mm: &here,
            thickness_mm: thickness,
            rigid_fraction: 0.5,
            kept_fraction: 0.0,
        };
        let mut found = Vec::new();
        list.gather(&place, &step, &mut found);
        let moved: Vec<Vec3> = here.iter().zip(&step).map(|(x, s)| x + s).collect();
        assert_holds_every_pair_in_reach(&found, &surface, &moved, thickness);
        here = moved;
    }
}

/// Every pair of parts that share no vertex and are nearer than the thickness is among those found.
fn assert_holds_every_pair_in_reach(found: &[Pair], surface: &Surface, moved: &[Vec3], thickness: f64) {
    let listed: BTreeSet<(PairKind, [u32; 4])> =
        found.iter().map(|pair| (pair.kind, pair.vertices)).collect();
    assert_eq!(listed.len(), found.len(), "each pair once");
    let mut near = 0;
    let used: BTreeSet<u32> = surface.faces.iter().flatten().copied().collect();
    for &[a, b, c] in &surface.faces {
        for &vertex in used.iter().filter(|vertex| ![a, b, c].contains(vertex)) {
            let at = |v: u32| &moved[v as usize];
            if point_triangle(at(vertex), at(a), at(b), at(c))
                .separation_mm
                .norm()
                < thickness
            {
                assert!(listed.contains(&(PairKind::PointTriangle, [vertex, a, b, c])));
                near += 1;
            }
        }
    }
    for (index, &[a, b]) in surface.edges.iter().enumerate() {
        for &[c, d] in &surface.edges[index + 1..] {
            let apart = a != c && a != d && b != c && b != d;
            let at = |v: u32| &moved[v as usize];
            if apart && edge_edge(at(a), at(b), at(c), at(d)).separation_mm.norm() < thickness {
                let edges = [[a, b, c, d], [c, d, a, b]];
                assert!(
                    edges
                        .iter()
                        .any(|&edges| listed.contains(&(PairKind::EdgeEdge, edges)))
                );
                near += 1;
            }
        }
    }
    assert!(near > 500, "the test must have something to find: {near}");
}

#[test]
fn bounded_steps_never_tunnel() {
    // Two wavy sheets are thrown at and through each other, with steps of many gaps, again and again.
    for seed in 0..4 {
        let mut random = Random(seed);
        let (faces, mut positions) = two_sheets(6, 0.3, &mut random);
        let surface = Surface::new(&faces, &positions);
        let rest = positions.clone();
        let (mut list, mut found, mut allowances) = (PairList::default(), Vec::new(), Vec::new());
        for _ in 0..20 {
            let mut step: Vec<Vec3> = positions
                .iter()
                .map(|x| Vec3::new(0.0, 0.0, if x.z > 0.0 { -1.0 } else { 1.0 }) + random.vector() * 0.5)
                .collect();
            let place = Place {
                surface: &surface,
                rest_mm: &rest,
                positions_mm: &positions,
                thickness_mm: 0.1,
                rigid_fraction: 0.5,
                kept_fraction: 0.0,
            };
            bound_steps(&mut list, &place, &mut step, &mut found, &mut allowances);
            // Wherever each vertex stops on its way, nothing crosses.
            let partway: Vec<Vec3> = positions.iter().zip(&step).map(|(x, s)| x + s * 0.5).collect();
            assert_eq!(crossings(&surface, &partway), []);
            positions.iter_mut().zip(&step).for_each(|(x, s)| *x += s);
            assert_eq!(crossings(&surface, &positions), []);
        }
    }
}

/// Two sheets of `cells`² squares over [-1, 1]², `gap` apart, slightly rumpled.
fn two_sheets(cells: u32, gap: f64, random: &mut Random) -> (Vec<[u32; 3]>, Vec<Vec3>) {
    let (mut faces, mut positions) = (Vec::new(), Vec::new());
    for height in [-0.5 * gap, 0.5 * gap] {
        let first = positions.len() as u32;
        let row = cells + 1;
        for j in 0..row {
            for i in 0..row {
                let place = |k: u32| 2.0 * f64::from(k) / f64::from(cells) - 1.0;
                positions.push(Vec3::new(place(i), place(j), height) + random.vector() * 0.03);
            }
        }
        for j in 0..cells {
            for i in 0..cells {
                let corner = first + j * row + i;
                faces.push([corner, corner + 1, corner + row]);
                faces.push([corner + 1, corner + row + 1, corner + row]);
            }
        }
    }
    (faces, positions)
}

#[test]
fn crossing_test_sees_a_needle_through_a_sheet_and_decides_exactly() {
    let v = Vec3::new;
    let faces = [[0, 1, 2], [3, 4, 5]];
    let sheet = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)];
    let with_needle = |low: f64, high: f64, x: f64| {
        let mut positions = sheet.to_vec();
        positions.extend([v(x, 0.2, low), v(x, 0.2, high), v(x + 1e-9, 0.2, 3.0)]);
        positions
    };
    let count = |positions: &[Vec3]| crossings(&Surface::new(&faces, positions), positions).len();
    assert!(count(&with_needle(-1.0, 1.0, 0.2)) > 0);
    assert_eq!(count(&with_needle(0.5, 1.0, 0.2)), 0);
    // The tip just above, just in and just below the sheet.
    assert_eq!(count(&with_needle(f64::MIN_POSITIVE, 1.0, 0.2)), 0);
    assert!(count(&with_needle(-f64::MIN_POSITIVE, 1.0, 0.2)) > 0);
    assert!(count(&with_needle(0.0, 1.0, 0.2)) > 0, "a touch counts");
    // Beside the sheet.
    assert_eq!(count(&with_needle(-1.0, 1.0, 1.2)), 0);
}

#[test]
fn nearest_points_of_simple_configurations() {
    let v = Vec3::new;
    let (a, b, c) = (v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0));
    let over_face = point_triangle(&v(0.25, 0.25, 2.0), &a, &b, &c);
    assert!((over_face.separation_mm - v(0.0, 0.0, 2.0)).norm() < 1e-15);
    assert_eq!(triangle_parameters(&over_face.weights).count, 2);
    let off_corner = point_triangle(&v(-3.0, -4.0, 0.0), &a, &b, &c);
    assert!((off_corner.separation_mm.norm() - 5.0).abs() < 1e-15);
    let crossing = edge_edge(
        &v(-1.0, 0.0, 0.0),
        &v(1.0, 0.0, 0.0),
        &v(0.0, -1.0, 0.5),
        &v(0.0, 1.0, 0.5),
    );
    assert!((crossing.separation_mm.norm() - 0.5).abs() < 1e-15);
    assert_eq!(crossing.weights, [0.5, 0.5, -0.5, -0.5]);
}

/// Parts of which corners coincide or lie on a line or a plane with others, and parts in general position, against parry.
///
/// Distances are compared: of degenerate parts several points may be nearest. Corners are of order one, so that rounding
/// leaves 1e-15, and its square root where parry's own barycentric coordinates of needles cancel.
#[test]
fn nearest_points_are_those_of_parry() {
    let mut random = Random(13);
    let mut worst = 0.0_f64;
    for round in 0..40_000 {
        let corners: [Vec3; 4] = match round % 4 {
            0 => std::array::from_fn(|_| random.vector()),
            // On a grid of five places a side: half of them degenerate.
            1 | 2 => std::array::from_fn(|_| (random.vector() * 2.5).map(f64::round) * 0.5),
            // On a line.
            _ => {
                let (start, along) = (random.vector(), random.vector());
                std::array::from_fn(|_| start + along * random.signed())
            }
        };
        let [a, b, c, d] = &corners;
        let point: DVec3 = (*a).into();
        let triangle = Triangle::new((*b).into(), (*c).into(), (*d).into());
        let of_parry = triangle.distance_to_local_point(point, false);
        let ours = point_triangle(a, b, c, d);
        worst = worst.max(assert_consistent(&ours, &corners) - of_parry);
        let [first, second] =
            [(a, b), (c, d)].map(|(start, end)| Segment::new((*start).into(), (*end).into()));
        let (s, t) =
            closest_points_segment_segment_with_locations_nD((&first.a, &first.b), (&second.a, &second.b));
        let of_parry = on(&first, s).distance(on(&second, t));
        let ours = edge_edge(a, b, c, d);
        worst = worst.max(assert_consistent(&ours, &corners) - of_parry);
    }
    assert!(worst < 1e-12, "farther than parry by {worst:e}");
}

fn on(segment: &Segment, location: SegmentPointLocation) -> DVec3 {
    segment.point_at(&location)
}

/// The separation is what the weights say, and they are means over each part: then no distance can be below the true one.
/// Returns the distance.
fn assert_consistent(nearest: &Nearest, corners: &[Vec3; 4]) -> f64 {
    let separation: Vec3 = corners
        .iter()
        .zip(nearest.weights)
        .map(|(x, weight)| x * weight)
        .sum();
    assert!((separation - nearest.separation_mm).norm() < 1e-14);
    let positive: f64 = nearest.weights.iter().filter(|weight| **weight > 0.0).sum();
    assert!((positive - 1.0).abs() < 1e-14 && nearest.weights.iter().sum::<f64>().abs() < 1e-14);
    nearest.separation_mm.norm()
}
