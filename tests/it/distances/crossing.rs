//! The crossing test against exact whole numbers: every edge with every face, in general position, on coarse grids where
//! most meet in a corner, a side or a plane, within rounding of each other, and where squares leave the range of numbers.

use coapt::Vec3;
use coapt::contact::crossing::{Crossing, crossings};
use coapt::contact::surface::Surface;
use coapt_tests::Random;
use num_bigint::BigInt;
use std::cmp::Ordering;

use super::exact::{Whole, cross, dot, exponent_of, minus, whole};

/// Whole numbers small enough that the volumes of tetrahedra fit into 128 bits.
type Small = [i128; 3];

fn between(a: &Small, b: &Small) -> Small {
    [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
}

fn cross_of(a: &Small, b: &Small) -> Small {
    let of = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [of(1, 2), of(2, 0), of(0, 1)]
}

fn inner(a: &Small, b: &Small) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// On which side of the plane of the first three the last is; exact below 2⁴⁰.
fn side_of_small([a, b, c, p]: [&Small; 4]) -> Ordering {
    inner(&cross_of(&between(a, b), &between(a, c)), &between(a, p)).cmp(&0)
}

fn side_of_whole([a, b, c, p]: [&Whole; 4]) -> Ordering {
    dot(&cross(&minus(b, a), &minus(c, a)), &minus(p, a)).cmp(&BigInt::ZERO)
}

/// What counts: an edge whose ends are not both in the plane of the face, not both strictly on one side of it, and whose line
/// passes all sides of the face on one hand or through them. A touch counts; an edge within the plane does not, and so neither
/// does any with a face without area, which has every plane.
fn meets<Point>(side: impl Fn([&Point; 4]) -> Ordering, [p, q]: [&Point; 2], [a, b, c]: [&Point; 3]) -> bool {
    let ends = [side([a, b, c, p]), side([a, b, c, q])];
    if ends[0] == ends[1] {
        return false;
    }
    let hands = [side([p, q, a, b]), side([p, q, b, c]), side([p, q, c, a])];
    !(hands.contains(&Ordering::Less) && hands.contains(&Ordering::Greater))
}

/// The same by the place where the line meets the plane, which lies in the face; exact below 2¹⁵.
fn meets_in_a_place([p, q]: [&Small; 2], [a, b, c]: [&Small; 3]) -> bool {
    let (ab, ac) = (between(a, b), between(a, c));
    let normal = cross_of(&ab, &ac);
    let heights = [p, q].map(|end| inner(&normal, &between(a, end)));
    let [high, low] = heights;
    if high == low || (high > 0 && low > 0) || (high < 0 && low < 0) {
        return false;
    }
    // From a, as many times too long as the heights differ.
    let (times, to_p, to_q) = (high - low, between(a, p), between(a, q));
    let place = [0, 1, 2].map(|k| (high * to_q[k] - low * to_p[k]) * times.signum());
    let is_within = |from: &Small, to: &Small| {
        let from_start = [0, 1, 2].map(|k| place[k] - times.abs() * (from[k] - a[k]));
        inner(&cross_of(&between(from, to), &from_start), &normal) >= 0
    };
    is_within(a, b) && is_within(b, c) && is_within(c, a)
}

/// All crossings as brute force and exact arithmetic find them, and how many pairs were tried.
fn due<Point>(
    surface: &Surface,
    points: &[Point],
    meets: impl Fn([&Point; 2], [&Point; 3]) -> bool,
) -> (Vec<Crossing>, usize) {
    let (mut due, mut pairs) = (Vec::new(), 0);
    for &edge in &surface.edges {
        for (index, corners) in surface.faces.iter().enumerate() {
            if corners.contains(&edge[0]) || corners.contains(&edge[1]) {
                continue;
            }
            pairs += 1;
            let at = |vertex: u32| &points[vertex as usize];
            if meets(edge.map(at), corners.map(at)) {
                let face = index as u32;
                due.push(Crossing { edge, face });
            }
        }
    }
    due.sort_unstable();
    (due, pairs)
}

fn assert_same(found: &[Crossing], due: &[Crossing], name: &str) {
    let missed = due.iter().find(|crossing| !found.contains(crossing));
    assert_eq!(missed, None, "{name}: missed");
    let made_up = found.iter().find(|crossing| !due.contains(crossing));
    assert_eq!(made_up, None, "{name}: made up");
}

/// So many triangles, each with corners of its own.
fn triangles(count: u32) -> Vec<[u32; 3]> {
    (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect()
}

/// Corners anywhere on a grid that reaches so far from its middle.
fn on_grid(count: u32, reach: f64, random: &mut Random) -> Vec<Vec3> {
    let corner = |_| (random.vector() * (reach + 0.5)).map(f64::round);
    (0..3 * count).map(corner).collect()
}

/// Of every other triangle a corner is moved to a grid point by the plane of the one before, within half a step or on it: on
/// the inside, on a side or on a corner.
fn all_but_touching(count: u32, reach: f64, random: &mut Random) -> Vec<Vec3> {
    let mut corners = on_grid(count, reach, random);
    for k in (3..corners.len()).step_by(6) {
        let part = [0.0, 0.5 * (random.signed() + 1.0), 1.0][(1.5 * (random.signed() + 1.0)) as usize];
        let other = (1.0 - part) * 0.5 * (random.signed() + 1.0).floor();
        let [a, b, c] = [corners[k - 3], corners[k - 2], corners[k - 1]];
        corners[k] = (a + (b - a) * part + (c - a) * other).map(f64::round);
    }
    corners
}

/// Powers of two that sizes are of: at the outer ones cubes and squares are no numbers, or zero; the least are denormal.
const SIZES: [i32; 6] = [0, -30, 30, -430, 430, -1070];

/// None is missed, and none is made up.
#[test]
#[allow(
    clippy::print_stderr,
    reason = "how many pairs there were is a figure to be quoted"
)]
fn a_million_pairs_cross_as_exact_arithmetic_says() {
    let mut random = Random(31);
    let (mut all, mut crossed) = (0, 0);
    let by_sides = |edge: [&Small; 2], face: [&Small; 3]| meets(side_of_small, edge, face);
    for round in 0..150 {
        let count = 50;
        let corners = match round % 7 {
            // Two, three and nine places a side: nearly all coincide, touch or lie in one plane.
            0 => on_grid(count, 1.0, &mut random),
            1 => on_grid(count, 2.0, &mut random),
            2 => on_grid(count, 8.0, &mut random),
            3 => on_grid(count, 1e4, &mut random),
            4 => all_but_touching(count, 1e3, &mut random),
            _ => all_but_touching(count, 5e11, &mut random),
        };
        let whole: Vec<Small> = corners
            .iter()
            .map(|x| [x.x as i128, x.y as i128, x.z as i128])
            .collect();
        let size = SIZES[round % SIZES.len()];
        let positions: Vec<Vec3> = corners.iter().map(|x| x * f64::from(size).exp2()).collect();
        let surface = Surface::new(&triangles(count), &positions);
        let (due, pairs) = match round % 7 {
            0..=4 => due(&surface, &whole, meets_in_a_place),
            _ => due(&surface, &whole, by_sides),
        };
        assert_same(
            &crossings(&surface, &positions),
            &due,
            &format!("round {round}, size 2^{size}"),
        );
        all += pairs;
        crossed += due.len();
    }
    eprintln!("{crossed} of {all} pairs cross");
    assert!(all > 1_000_000 && crossed > 50_000);
}

/// Numbers of all digits and of very different sizes: around a common place, far from it and within rounding of a plane.
#[test]
fn pairs_of_all_digits_cross_as_exact_arithmetic_says() {
    let mut random = Random(32);
    let count = 12;
    for round in 0..24 {
        let far = [0.0, 1.0, 1e9][round % 3];
        let spread = [1.0, 1e-6, 1e3, 1e-12][round % 4];
        let mut positions: Vec<Vec3> = Vec::new();
        for _ in 0..count {
            let [a, b] = [random.vector(), random.vector()];
            let on_plane = a * random.signed() + b * random.signed();
            positions.extend([a, b, on_plane].map(|x| (x * spread).add_scalar(far)));
        }
        // Needles from a corner to the planes of others, where only exact arithmetic knows the side.
        for k in (5..positions.len()).step_by(3) {
            let [a, b, c] = [positions[k - 5], positions[k - 4], positions[k - 3]];
            positions[k] = a + (b - a) * 0.3 + (c - a) * 0.3;
        }
        let surface = Surface::new(&triangles(count), &positions);
        let exponent = exponent_of(&positions);
        let points: Vec<Whole> = positions.iter().map(|x| whole(x, exponent)).collect();
        let (due, _) = due(&surface, &points, |edge, face| meets(side_of_whole, edge, face));
        assert_same(&crossings(&surface, &positions), &due, &format!("round {round}"));
    }
}

/// Two cubes: far from each other, a millionth from each other, touching, and in each other.
#[test]
fn two_cubes_cross_only_where_they_do() {
    let corner = |k: u32| Vec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2));
    let sides = [
        [0, 2, 1, 3],
        [4, 5, 6, 7],
        [0, 1, 4, 5],
        [2, 6, 3, 7],
        [0, 4, 2, 6],
        [1, 3, 5, 7],
    ];
    let faces_from = |first: u32| {
        let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [b, d, c]];
        sides
            .into_iter()
            .flat_map(halves)
            .map(move |face| face.map(|v| first + v))
    };
    let faces: Vec<[u32; 3]> = faces_from(0).chain(faces_from(8)).collect();
    for (way, crosses) in [(3.0, false), (1.0 + 1e-6, false), (1.0, true), (0.75, true)] {
        let aside = Vec3::new(0.25, 0.375, way);
        let positions: Vec<Vec3> = (0..8)
            .map(corner)
            .chain((0..8).map(|k| corner(k) + aside))
            .collect();
        let found = crossings(&Surface::new(&faces, &positions), &positions);
        assert_eq!(!found.is_empty(), crosses, "{way}: {found:?}");
    }
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
