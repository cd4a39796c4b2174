//! Pairs of parts that move at, past and through each other, as queries of continuous collision detection ask of them: a
//! bounded step passes through nothing, and distances at both ends are right, by exact arithmetic.
//!
//! The queries are made here, of the kinds of published ones (Wang et al. 2021, "A large-scale benchmark and an
//! inclusion-based algorithm for continuous collision detection").

use coapt::Vec3;
use coapt::contact::gather::PairList;
use coapt::contact::pairs::PairKind::{self, EdgeEdge, PointTriangle};
use coapt::contact::pairs::Place;
use coapt::contact::step_bound::bound_steps;
use coapt::contact::surface::Surface;
use coapt_tests::Random;
use num_bigint::BigInt;

use super::exact::{self, Fraction, Whole, cross, dot, exponent_of, minus, whole};
use super::nearest::{TOLERANCE, errors};

/// Where the corners of two parts are, and how far each goes [mm].
type Query = [[Vec3; 4]; 2];

/// A family of queries, and how one of it is made.
type Family = (&'static str, fn(PairKind, &mut Random) -> Query);

const FAMILIES: [Family; 10] = [
    ("anywhere", |_, random| {
        [four(random), four(random).map(|x| x * 3.0)]
    }),
    ("turning round", |_, random| {
        let corners = four(random);
        [corners, corners.map(|x| random.vector() * 0.5 - x * 2.0)]
    }),
    // Half of them degenerate; many touch where they begin.
    ("on a grid", |_, random| [grid(random), grid(random)]),
    ("from 1e-4 away", |kind, random| {
        let (corners, across) = apart(kind, 1e-4, random);
        let steps = first_goes(kind, across * (1.0 + random.signed()));
        [corners, steps.map(|step| step + random.vector())]
    }),
    ("to a corner or the middle of a side", |kind, random| {
        let (corners, _) = apart(kind, 0.5, random);
        let goal = match random.signed() < 0.0 {
            true => corners[3],
            false => (corners[2] + corners[3]) * 0.5,
        };
        [corners, first_goes(kind, goal - corners[0])]
    }),
    ("by a hair", |kind, random| {
        let (mut corners, across) = apart(kind, 0.5, random);
        let hair = random.vector() * 10_f64.powf(4.0 * random.signed() - 5.0);
        let aside = corners[2] + hair - corners[0] - across;
        let first = first_goes(kind, aside);
        (0..4).for_each(|k| corners[k] += first[k]);
        [corners, first_goes(kind, across * 2.0)]
    }),
    // Of quarters, so that they meet exactly, all along or nowhere.
    ("parallel edges, and along a face", |kind, random| {
        let [start, along, other, _] = grid(random);
        let across = along.cross(&other);
        match kind {
            EdgeEdge => {
                let over = start - across + along * 0.5;
                [
                    [over, over + along, start, start + along],
                    first_goes(kind, across * 2.0),
                ]
            }
            PointTriangle => {
                let over = start - along + across * 0.25;
                [
                    [over, start, start + along, start + other],
                    first_goes(kind, along * 3.0),
                ]
            }
        }
    }),
    ("in one plane", |_, random| {
        let flat = |x: Vec3| Vec3::new(x.x, x.y, 0.0);
        [four(random).map(flat), four(random).map(|x| flat(x) * 3.0)]
    }),
    ("a thousand sizes far", |kind, random| {
        let (corners, across) = apart(kind, 0.1, random);
        let steps = first_goes(kind, across * 1e4);
        [corners, steps.map(|step| step + random.vector() * 300.0)]
    }),
    ("all together, and a millionth of that apart", |kind, random| {
        let (corners, across) = apart(kind, 1e-4, random);
        let (place, all) = (random.vector() * 1e3, random.vector() * 100.0);
        let steps = first_goes(kind, across * 10_f64.powf(2.0 * random.signed()));
        [corners.map(|x| x + place), steps.map(|step| step + all)]
    }),
];

/// Queries of each family, half of each kind.
const QUERIES: usize = 730;

fn four(random: &mut Random) -> [Vec3; 4] {
    std::array::from_fn(|_| random.vector())
}

fn grid(random: &mut Random) -> [Vec3; 4] {
    four(random).map(|x| (x * 2.5).map(f64::round) * 0.5)
}

/// Two parts with the middle of the first over that of the second, and the way across the gap between.
fn apart(kind: PairKind, gap: f64, random: &mut Random) -> ([Vec3; 4], Vec3) {
    let [mut a, mut b, c, d] = four(random);
    let normal = match kind {
        PointTriangle => {
            let normal = (c - b).cross(&(d - b)).normalize();
            a = (b + c + d) / 3.0 + normal * gap;
            normal
        }
        EdgeEdge => {
            let normal = (b - a).cross(&(d - c)).normalize();
            let to_middle = (c + d - a - b) * 0.5 + normal * gap;
            (a, b) = (a + to_middle, b + to_middle);
            normal
        }
    };
    ([a, b, c, d], -normal * gap)
}

/// The first part goes a way, the second none.
fn first_goes(kind: PairKind, way: Vec3) -> [Vec3; 4] {
    let none = Vec3::zeros();
    match kind {
        PointTriangle => [way, none, none, none],
        EdgeEdge => [way, way, none, none],
    }
}

/// The same query on a surface: corners that a face needs besides are where another one is. At rest all is far apart, so
/// that contact begins at the full thickness.
fn bounded(kind: PairKind, [corners, steps]: &Query) -> [Vec3; 4] {
    let (faces, doubles) = match kind {
        PointTriangle => ([[0, 4, 5], [1, 2, 3]], [0, 0]),
        EdgeEdge => ([[0, 1, 4], [2, 3, 5]], [1, 3]),
    };
    let with_doubles = |of: &[Vec3; 4]| [of.as_slice(), &doubles.map(|corner: usize| of[corner])].concat();
    let rest: Vec<Vec3> = (0..6)
        .map(|k: i32| Vec3::new(1e3 * f64::from(k), 0.0, 0.0))
        .collect();
    let surface = Surface::new(&faces, &rest);
    let (positions, mut steps) = (with_doubles(corners), with_doubles(steps));
    let place = Place {
        surface: &surface,
        rest_mm: &rest,
        positions_mm: &positions,
        thickness_mm: 0.1,
        rigid_fraction: 0.5,
        kept_fraction: 0.0,
    };
    let (mut list, mut found, mut allowances) = (PairList::default(), Vec::new(), Vec::new());
    bound_steps(&mut list, &place, &mut steps, &mut found, &mut allowances);
    std::array::from_fn(|k| steps[k])
}

fn distance_squared(kind: PairKind, corners: &[Whole; 4]) -> Fraction {
    match kind {
        PointTriangle => exact::point_triangle(corners),
        EdgeEdge => exact::edge_edge(corners),
    }
}

/// How often the way is halved before two parts that are not shown to be apart count as meeting: to 1e-12 of it.
const HALVINGS: u32 = 40;

/// Whether the parts stay apart while every corner goes straight from one place to another, all at the same rate. What is
/// said to stay apart does, exactly.
///
/// They do where the four corners are in one plane at no time: the volume between them, of degree three in time, has
/// Bernstein coefficients of one sign. They do, too, where they are farther from each other halfway than they come nearer
/// before or after. Where neither is so, each half of the way is looked at.
fn stay_apart(kind: PairKind, from: &[Whole; 4], to: &[Whole; 4], halvings: u32) -> bool {
    if has_one_sign(from, to) {
        return true;
    }
    // In half the unit, so that halfway is a whole number.
    let twice = |corners: &[Whole; 4]| corners.each_ref().map(|corner| corner.each_ref().map(|x| x << 1));
    let halfway: [Whole; 4] =
        std::array::from_fn(|k| std::array::from_fn(|axis| &from[k][axis] + &to[k][axis]));
    let (from, to) = (twice(from), twice(to));
    let moved: [Whole; 4] = std::array::from_fn(|k| minus(&to[k], &halfway[k]));
    let first_count = match kind {
        PointTriangle => 1,
        EdgeEdge => 2,
    };
    let (first, second) = moved.split_at(first_count);
    let approaches = first.iter().flat_map(|a| second.iter().map(move |b| minus(a, b)));
    let nearer_squared = approaches.map(|way| dot(&way, &way)).max().unwrap_or_default();
    let Fraction(numerator, denominator) = distance_squared(kind, &halfway);
    if numerator > nearer_squared * denominator {
        return true;
    }
    halvings > 0
        && stay_apart(kind, &from, &halfway, halvings - 1)
        && stay_apart(kind, &halfway, &to, halvings - 1)
}

fn has_one_sign(from: &[Whole; 4], to: &[Whole; 4]) -> bool {
    let ways = |corners: &[Whole; 4]| [1, 2, 3].map(|k| minus(&corners[k], &corners[0]));
    let ([u, v, w], [x, y, z]) = (ways(from), ways(to));
    let volume = |a: &Whole, b: &Whole, c: &Whole| dot(&cross(a, b), c);
    let coefficients = [
        volume(&u, &v, &w),
        volume(&x, &v, &w) + volume(&u, &y, &w) + volume(&u, &v, &z),
        volume(&u, &y, &z) + volume(&x, &v, &z) + volume(&x, &y, &w),
        volume(&x, &y, &z),
    ];
    let none = BigInt::ZERO;
    coefficients.iter().all(|x| *x > none) || coefficients.iter().all(|x| *x < none)
}

/// What a query is in truth, and what a bounded step makes of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Truth {
    TouchesAtFirst,
    Meets,
    StaysApart,
}

/// Holds one query against what bounded steps promise.
fn assert_passes_through_nothing(name: &str, kind: PairKind, query: &Query) -> Truth {
    let [corners, steps] = query;
    let ends = |steps: &[Vec3; 4]| -> [Vec3; 4] { std::array::from_fn(|k| corners[k] + steps[k]) };
    for place in [*corners, ends(steps)] {
        let errors = errors(kind, &place);
        assert!(errors.largest() <= TOLERANCE, "{name}: {place:?}: {errors:?}");
    }
    let bounded = bounded(kind, query);
    let end = ends(&bounded);
    let all = [*corners, ends(steps), end].concat();
    let exponent = exponent_of(&all);
    let exactly = |corners: &[Vec3; 4]| corners.map(|corner| whole(&corner, exponent));
    let from = exactly(corners);
    let is_apart = |corners: &[Whole; 4]| distance_squared(kind, corners).0 != BigInt::ZERO;
    // No step begins so: what touches is drawn apart before.
    if !is_apart(&from) {
        return Truth::TouchesAtFirst;
    }
    let bounded_end = exactly(&end);
    assert!(
        stay_apart(kind, &from, &bounded_end, HALVINGS),
        "{name}: {query:?} bounded to {bounded:?}"
    );
    // Wherever each of them stops: all at once at either end of its way.
    for who in 0..16 {
        let stopped = std::array::from_fn(|k| match who >> k & 1 {
            0 => from[k].clone(),
            _ => bounded_end[k].clone(),
        });
        assert!(
            is_apart(&stopped),
            "{name}: {query:?} bounded to {bounded:?}, {who:b}"
        );
    }
    match stay_apart(kind, &from, &exactly(&ends(steps)), HALVINGS) {
        true => Truth::StaysApart,
        false => Truth::Meets,
    }
}

/// 7,300 queries, of which two in five meet on their way.
#[test]
#[allow(clippy::print_stderr, reason = "how many meet is a figure to be quoted")]
fn bounded_steps_pass_through_nothing_by_exact_arithmetic() {
    let mut all = [0; 3];
    for (name, make) in FAMILIES {
        let mut random = Random(51);
        let mut counts = [0; 3];
        for number in 0..QUERIES {
            let kind = [PointTriangle, EdgeEdge][number % 2];
            let truth = assert_passes_through_nothing(name, kind, &make(kind, &mut random));
            counts[truth as usize] += 1;
        }
        let [touch, meet, apart] = counts;
        eprintln!("{name}: {touch} touch at first, {meet} meet, {apart} stay apart");
        (0..3).for_each(|k| all[k] += counts[k]);
    }
    assert!(
        all.iter().sum::<usize>() == 7300 && all[Truth::Meets as usize] > 2000,
        "{all:?}"
    );
}

/// Parts that do not move, or nowhere near each other, go all their way, to the last bit.
#[test]
fn steps_that_lead_nowhere_near_anything_are_left_alone() {
    let mut random = Random(52);
    for number in 0..400 {
        let kind = [PointTriangle, EdgeEdge][number % 2];
        let (corners, across) = apart(kind, 0.5, &mut random);
        let still = [Vec3::zeros(); 4];
        assert_eq!(bounded(kind, &[corners, still]), still);
        // Each by less than half of the nine tenths of a gap that a step may use up; middles lie within their parts.
        let short = four(&mut random).map(|x| x.normalize() * (0.44 * across.norm()));
        assert_eq!(bounded(kind, &[corners, short]), short);
    }
}
