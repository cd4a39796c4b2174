//! The broad phase against brute force: nothing is missed, whatever the boxes.

use coapt::Vec3;
use coapt::contact::broad::{Box3, SweepAndPrune};
use coapt::contact::patches::Patches;
use coapt_tests::Random;
use std::collections::BTreeSet;

use crate::contact::scattered_triangles;
use crate::shapes::sphere;

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
        let among = each_once(
            told_among(&mut sweep, &exact)
                .iter()
                .map(|&[i, j]| [i.min(j), i.max(j)]),
        );
        let third = count / 3;
        let (ones, others) = exact.split_at(third);
        let shifted = |&[i, j]: &[u32; 2]| [i, j + third as u32];
        let between = each_once(told_between(&mut sweep, ones, others).iter().map(shifted));
        for i in 0..count {
            for j in i + 1..count {
                compare(&among, i, j);
                if i < third && j >= third {
                    compare(&between, i, j);
                }
                compared += 1;
            }
        }
        let back = told_between(&mut sweep, others, ones)
            .iter()
            .map(|&[j, i]| shifted(&[i, j]));
        assert_eq!(each_once(back), between);
    }
    assert!(compared > 1_000_000, "{compared}");
}

fn patches(boxes: &[Box3]) -> Patches {
    // A half of each first: the ends of some are as large as numbers are.
    let middles = boxes.iter().map(|one| one.low * 0.5 + one.high * 0.5);
    Patches::new(&middles.collect::<Vec<Vec3>>())
}

fn told_among<'a>(sweep: &'a mut SweepAndPrune, boxes: &[Box3]) -> &'a [[u32; 2]] {
    sweep.among(boxes, &patches(boxes))
}

fn told_between<'a>(sweep: &'a mut SweepAndPrune, ones: &[Box3], others: &[Box3]) -> &'a [[u32; 2]] {
    sweep.between([ones, others], [&patches(ones), &patches(others)])
}

fn each_once(pairs: impl ExactSizeIterator<Item = [u32; 2]>) -> BTreeSet<[u32; 2]> {
    let count = pairs.len();
    let set: BTreeSet<[u32; 2]> = pairs.collect();
    assert_eq!(set.len(), count, "each pair once");
    set
}

/// Boxes as nobody's valve has them. Each family of them, and how it is made.
type Family = (&'static str, fn(&mut Random) -> Box3);

const FAMILIES: [Family; 9] = [
    // Ends on a grid: most that meet only touch, and many are equal.
    ("on a coarse grid", |random| grid_box(4.0, 1.0, random)),
    ("points on a grid", |random| {
        let point = (random.vector() * 2.5).map(f64::round);
        Box3 {
            low: point,
            high: point,
        }
    }),
    ("denormal", |random| grid_box(8.0, f64::from_bits(1), random)),
    ("smaller than single precision", |random| {
        grid_box(8.0, 1e-300, random)
    }),
    ("larger than single precision", |random| {
        grid_box(8.0, 1e300, random)
    }),
    ("larger than their differences", |random| {
        grid_box(8.0, f64::MAX / 16.0, random)
    }),
    // Ends an ulp or two of double precision about halfway between numbers of single precision, of one sign and of both.
    ("within rounding to single", |random| rounded_box(1.0, random)),
    ("within rounding of a far place", |random| {
        rounded_box(1e9, random)
    }),
    // Sizes over six hundred powers of ten side by side.
    ("of every size", |random| {
        let place = |random: &mut Random| random.vector().map(|x| x * 10_f64.powf(300.0 * random.signed()));
        spanned(place(random), place(random))
    }),
];

fn spanned(one: Vec3, other: Vec3) -> Box3 {
    Box3 {
        low: one.inf(&other),
        high: one.sup(&other),
    }
}

fn grid_box(reach: f64, step: f64, random: &mut Random) -> Box3 {
    let mut place = || (random.vector() * reach).map(f64::round);
    let (corner, length) = (place(), place() * 0.25);
    spanned(corner * step, (corner + length.map(f64::round)) * step)
}

fn rounded_box(far: f64, random: &mut Random) -> Box3 {
    let end = |random: &mut Random| {
        let single = (f64::from(f32::EPSILON) * (4.0 * random.signed()).round()).mul_add(0.5, far);
        let ulps = (2.0 * random.signed()).round() as i64;
        f64::from_bits(single.to_bits().wrapping_add_signed(ulps))
    };
    let corner = |random: &mut Random| Vec3::new(end(random), end(random), end(random));
    spanned(corner(random), corner(random))
}

/// A cloth of 20,000 faces laid over a ball of as many, and a step in which it slides over it: every two boxes that overlap are
/// told of, each once, as by brute force over all of 800 million pairs.
#[test]
fn sweep_and_prune_finds_what_brute_force_finds_of_a_cloth_over_a_ball() {
    const CELLS: u32 = 100;
    let ball = sphere(32, 1.0);
    let cloth_at = |i: u32, j: u32| {
        let [x, y] = [i, j].map(|k| 4.0 * f64::from(k) / f64::from(CELLS) - 2.0);
        // A hundredth over the ball, and down from there like a bell.
        let height = if x.hypot(y) < 0.8 {
            (1.01 - x * x - y * y).sqrt()
        } else {
            0.61 * (-4.0 * (x.hypot(y) - 0.8)).exp()
        };
        Vec3::new(x, y, height)
    };
    let (mut positions, mut faces) = (ball.points_mm, ball.faces);
    let first = positions.len() as u32;
    let at = |i: u32, j: u32| first + j * (CELLS + 1) + i;
    for j in 0..=CELLS {
        positions.extend((0..=CELLS).map(|i| cloth_at(i, j)));
    }
    for (i, j) in (0..CELLS).flat_map(|j| (0..CELLS).map(move |i| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
        faces.extend([[a, b, d], [a, d, c]]);
    }
    for way in [Vec3::zeros(), Vec3::new(0.05, 0.02, -0.03)] {
        let step = |vertex: u32| if vertex < first { Vec3::zeros() } else { way };
        let box_of = |face: &[u32; 3]| {
            let ends =
                face.map(|vertex| [0.0, 1.0].map(|part| positions[vertex as usize] + step(vertex) * part));
            let corners = ends.as_flattened();
            Box3 {
                low: corners.iter().fold(corners[0], |low, x| low.inf(x)),
                high: corners.iter().fold(corners[0], |high, x| high.sup(x)),
            }
        };
        let boxes: Vec<Box3> = faces.iter().map(box_of).collect();
        let mut sweep = SweepAndPrune::default();
        let found = each_once(
            told_among(&mut sweep, &boxes)
                .iter()
                .map(|&[i, j]| [i.min(j), i.max(j)]),
        );
        let mut overlaps = 0;
        for i in 0..boxes.len() {
            for j in i + 1..boxes.len() {
                if overlap(&boxes[i], &boxes[j]) {
                    overlaps += 1;
                    assert!(found.contains(&[i as u32, j as u32]), "{i} and {j} missed");
                }
            }
        }
        // Single precision rounds boxes outwards, by 1e-7 of the scene: few more overlap by that.
        assert!(
            overlaps > 250_000 && found.len() < overlaps + overlaps / 100,
            "{overlaps} of {}",
            found.len()
        );
    }
}

/// 1.2 million pairs, by both forms: every two boxes that overlap are told of, each once. More may be, by what single
/// precision rounds off the scene.
#[test]
fn sweep_and_prune_misses_nothing_whatever_the_boxes() {
    let mut compared = 0;
    for (name, make) in FAMILIES {
        let mut random = Random(41);
        let boxes: Vec<Box3> = (0..520).map(|_| make(&mut random)).collect();
        let (ones, others) = boxes.split_at(170);
        let mut sweep = SweepAndPrune::default();
        let among = each_once(
            told_among(&mut sweep, &boxes)
                .iter()
                .map(|&[i, j]| [i.min(j), i.max(j)]),
        );
        let between = each_once(
            told_between(&mut sweep, ones, others)
                .iter()
                .map(|&[i, j]| [i, j + 170]),
        );
        let mut overlaps = 0;
        for i in 0..boxes.len() {
            for j in i + 1..boxes.len() {
                compared += 1;
                if !overlap(&boxes[i], &boxes[j]) {
                    continue;
                }
                overlaps += 1;
                let pair = [i as u32, j as u32];
                assert!(among.contains(&pair), "{name}: {:?} {:?}", boxes[i], boxes[j]);
                let is_between = i < ones.len() && j >= ones.len();
                assert!(
                    !is_between || between.contains(&pair),
                    "{name}: {:?} {:?}",
                    boxes[i],
                    boxes[j]
                );
            }
        }
        assert!(overlaps > 500, "{name}: {overlaps} overlap");
    }
    assert!(compared > 1_200_000, "{compared}");
}
