//! Surfaces with distances known by hand.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Rotation3};

use super::*;
use crate::measure::DistanceStatistics;
use crate::measure::test_models::{flared_strips, sheet};
use crate::model::Model;

/// A model's leaflets as they stand.
fn plain(model: &Model) -> ComparedSurface {
    ComparedSurface {
        name: "valve".into(),
        points_mm: model.rest_mm.clone(),
        faces: model.faces.clone(),
        ..ComparedSurface::default()
    }
}

/// A flat square, `n` squares a side, that looks up.
fn flat(n: usize, size_mm: f64) -> ComparedSurface {
    let mut surface = plain(&sheet(n, size_mm, 1));
    surface.faces.iter_mut().for_each(|face| face.swap(0, 1));
    surface
}

/// A flat square of 20 mm, `n` squares a side, at a height.
fn square(n: usize, height_mm: f64) -> ComparedSurface {
    let mut surface = flat(n, 20.0);
    surface.points_mm.iter_mut().for_each(|p| p.z = height_mm);
    surface
}

/// A bowl: the lower part of a sphere, `rings` deep and `6 · rings` around, turned about its axis by an angle, its
/// faces to the inside.
fn bowl(radius_mm: f64, rings: u32, angle: f64) -> ComparedSurface {
    let around = 6 * rings;
    let mut points_mm = vec![Vec3::new(0.0, 0.0, -radius_mm)];
    let mut faces = Vec::new();
    for ring in 1..=rings {
        let polar = TAU / 6.0 * f64::from(ring) / f64::from(rings);
        for k in 0..around {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(around) + angle).sin_cos();
            points_mm.push(Vec3::new(polar.sin() * cos, polar.sin() * sin, -polar.cos()) * radius_mm);
            let [a, b] = [k, (k + 1) % around].map(|k| 1 + (ring - 1) * around + k);
            match ring {
                1 => faces.push([0, a, b]),
                _ => faces.extend([[a - around, a, b], [a - around, b, b - around]]),
            }
        }
    }
    ComparedSurface {
        name: "bowl".into(),
        points_mm,
        faces,
        ..ComparedSurface::default()
    }
}

/// Hills that no rigid motion maps on themselves, 40 mm wide, over a grid of `n` squares a side.
pub(super) fn hills(n: usize) -> ComparedSurface {
    let mut surface = flat(n, 40.0);
    for p in &mut surface.points_mm {
        p.z = 3.0 * (0.21 * p.x).sin() + 2.0 * (0.17 * p.y + 0.05 * p.x).cos() - 0.01 * p.x * p.y;
    }
    surface
}

pub(super) fn moved(surface: &ComparedSurface, motion: &Isometry3<f64>) -> ComparedSurface {
    let place = |p: &Vec3| motion.rotation * p + motion.translation.vector;
    ComparedSurface {
        points_mm: surface.points_mm.iter().map(place).collect(),
        ..surface.clone()
    }
}

fn compared(result: &ComparedSurface, reference: &ComparedSurface) -> Comparison {
    compare(result, reference, &CompareSettings::default()).unwrap()
}

fn surface_rows(d: &Definitions) -> Vec<DistanceStatistics> {
    let rows = [
        d.result_to_reference,
        d.result_to_reference_by_area,
        d.reference_to_result,
        d.reference_to_result_by_area,
    ];
    rows.into_iter().flatten().collect()
}

/// Parallel planes of different meshes are 0.7 mm apart everywhere, both ways, whatever counts, and above; after
/// alignment not at all. 1e-12 is rounding.
#[test]
fn parallel_planes() {
    let found = compared(&square(8, 0.7), &square(13, 0.0));
    for regions in [found.as_given.whole, found.as_given.visible.unwrap()] {
        let rows = surface_rows(&regions);
        assert_eq!(rows.len(), 4);
        for d in rows {
            for value in [d.mean_mm, d.rms_mm, d.p05_mm, d.p95_mm, d.max_mm] {
                assert!((value - 0.7).abs() < 1e-12, "{d:?}");
            }
            assert!(d.sd_mm < 1e-12);
        }
    }
    assert!(!found.nodes_correspond && found.as_given.whole.node_to_node.is_none());
    assert!(
        surface_rows(&found.aligned.whole)
            .iter()
            .all(|d| d.max_mm < 1e-12)
    );
    assert!(
        (found.alignment.translation_mm[2] + 0.7).abs() < 1e-12,
        "{:?}",
        found.alignment
    );
    assert!(found.alignment.rotation_deg < 1e-9 && found.alignment.converged);
    let signed = found.map.signed_distance_mm.unwrap();
    assert!(signed.iter().all(|d| (d - 0.7).abs() < 1e-12));
    assert!(
        found.warnings.iter().all(|w| w.message.contains("overlap")),
        "{:?}",
        found.warnings
    );
}

/// Bowls of 20 and 21 mm: vertices of the larger stand 1 mm outside the smaller sphere. A facet whose corners lie on a
/// sphere of radius R within r of its axis sinks below it by R - √(R² - r²), here r < 20 mm · 0.06 and therefore less
/// than 0.036 mm, so distances lie between 1 and 1.036; back, vertices of the smaller find facets that sink towards
/// them: 0.963 to 1. But at the rim, where the larger one's lies higher than the smaller one's by 0.5 mm: not seen from
/// within 2 mm of it.
#[test]
fn concentric_spheres() {
    let (large, small) = (bowl(21.0, 15, 0.1), bowl(20.0, 15, 0.0));
    let found = compared(&large, &small);
    assert!(
        found
            .map
            .distance_mm
            .iter()
            .all(|&d| d < 1.036 && d > 1.0 - 1e-12)
    );
    let d = found.as_given.whole.result_to_reference_by_area.unwrap();
    assert!((d.mean_mm - 1.0).abs() < 0.036 && d.sd_mm < 0.02, "{d:?}");
    let back = found.as_given.whole.reference_to_result.unwrap();
    assert!(back.mean_mm > 0.963 && back.max_mm < 1.0 + 1e-12, "{back:?}");
    // The bowl's faces look inside, where the atrium is: the larger one lies behind.
    assert!(found.map.signed_distance_mm.unwrap().iter().all(|&d| d < 0.0));
}

/// A copy of one mesh, moved: each node by as much as it was, and after alignment nowhere. The motion found undoes the
/// one made.
#[test]
fn a_moved_copy() {
    let reference = hills(20);
    let shift = moved(&reference, &Isometry3::translation(0.3, 0.4, 1.2));
    let d = compared(&shift, &reference).as_given.whole.node_to_node.unwrap();
    assert!((d.mean_mm - 1.3).abs() < 1e-12 && d.sd_mm < 1e-12 && (d.max_mm - 1.3).abs() < 1e-12);
    let motion = Isometry3::new(Vec3::new(2.0, -1.0, 1.5), Vec3::new(0.05, -0.03, 0.08));
    let found = compared(&moved(&reference, &motion), &reference);
    assert!(found.nodes_correspond && found.alignment.method == AlignmentMethod::Nodes);
    assert!((found.alignment.rotation_deg - motion.rotation.angle().to_degrees()).abs() < 1e-9);
    assert!(found.aligned.whole.node_to_node.unwrap().max_mm < 1e-12);
    assert!(
        surface_rows(&found.aligned.whole)
            .iter()
            .all(|d| d.max_mm < 1e-12)
    );
    assert!(found.as_given.whole.result_to_reference.unwrap().mean_mm > 0.5);
}

/// The same, with the faces in another order, so that nothing says which node is which: the surfaces find each other
/// all the same, in few steps, from 3 mm and 6 degree away. What is left is the rounding of 40 mm, far below 1e-6.
#[test]
fn a_moved_copy_of_unknown_nodes() {
    let reference = hills(20);
    let motion = Isometry3::new(Vec3::new(2.0, -1.0, 1.5), Vec3::new(0.05, -0.03, 0.08));
    let mut result = moved(&reference, &motion);
    result.faces.reverse();
    let found = compared(&result, &reference);
    assert!(!found.nodes_correspond && found.alignment.method == AlignmentMethod::Surface);
    assert!(
        surface_rows(&found.aligned.whole).iter().all(|d| d.max_mm < 1e-9),
        "{:?}",
        found.alignment
    );
    assert!(
        found.alignment.converged && found.alignment.iterations <= 20,
        "{:?}",
        found.alignment
    );
    assert!((found.alignment.rotation_deg - motion.rotation.angle().to_degrees()).abs() < 1e-8);
}

/// Alignment ends where no small motion lowers the root mean square: of a surface that is no copy, at a minimum in all
/// six directions. Steps of 0.01 mm and 0.0005 rad raise it by more than rounding.
#[test]
fn alignment_ends_at_a_minimum() {
    let (mut result, reference) = (hills(17), hills(20));
    result
        .points_mm
        .iter_mut()
        .for_each(|p| p.z += 0.5 * (0.4 * p.x + 0.3 * p.y).sin());
    let motion = Isometry3::new(Vec3::new(1.0, 1.0, 0.5), Vec3::new(0.02, 0.03, -0.02));
    let result = moved(&result, &motion);
    let found = compared(&result, &reference);
    let best = found.aligned.whole.result_to_reference_by_area.unwrap().rms_mm;
    assert!((found.alignment.rms_mm[1] - best).abs() < 1e-12 && best < found.alignment.rms_mm[0]);
    let mut at_best = result.clone();
    at_best
        .points_mm
        .iter_mut()
        .for_each(|p| *p = found.alignment.moved(*p));
    let middle = Vec3::new(20.0, 20.0, 0.0);
    for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
        for sign in [-1.0, 1.0] {
            let shift = Isometry3::new(axis * 0.01 * sign, Vec3::zeros());
            let turn = Rotation3::new(axis * 0.0005 * sign);
            let turn = Isometry3::new(middle - turn * middle, axis * 0.0005 * sign);
            for step in [shift, turn] {
                let near = compared(&moved(&at_best, &step), &reference).as_given.whole;
                let rms = near.result_to_reference_by_area.unwrap().rms_mm;
                assert!(rms > best + 1e-9, "{axis} {sign}: {rms} {best}");
            }
        }
    }
}

/// One flat surface under two meshes has no distance, but between centroids there is one. In a mesh of equilateral
/// triangles of edge a the points nearest to a centroid are those of its triangle, so that the distances of points
/// scattered over it are those from the middle of a triangle: with its inner radius ρ = a / √12, over a sixth of it,
/// mean = 2ρ/3 · ∫sec³ / ∫sec² from 0 to 60° = 0.2657 a, root mean square = a / √12 = 0.2887 a. A mesh moved about on it
/// 200 times scatters its 200 centroids evenly enough for 0.5 %.
#[test]
fn centroids_are_inflated_by_a_quarter_of_an_edge() {
    let mut reference = flat(40, 40.0);
    for p in &mut reference.points_mm {
        // Squares sheared so that their diagonals, from low to high x and y, are as long as their sides.
        *p = Vec3::new(p.x - 0.5 * p.y, p.y * 0.75f64.sqrt(), 0.0);
    }
    let indexed = IndexedSurface::new(&reference, reference.points_mm.clone());
    assert!((indexed.mean_edge_mm() - 1.0).abs() < 1e-12);
    let result = flat(10, 8.1);
    let centroids = IndexedSurface::new(&result, result.points_mm.clone()).centroids_mm;
    let (mut mean, mut square) = (0.0, 0.0);
    for k in 0..200 {
        // An even scatter of shifts over one rhomb (Roberts' sequence).
        let [x, y] = [0.7548776662466927, 0.5698402909980532].map(|step| (step * f64::from(k)).fract());
        let shift = Vec3::new(5.0 + x - 0.5 * y, 10.0 + y * 0.75f64.sqrt(), 0.0);
        let places: Vec<Vec3> = centroids.iter().map(|p| p + shift).collect();
        assert!(indexed.feet(&places).iter().all(|foot| foot.distance_mm < 1e-12));
        let d = DistanceStatistics::of(&indexed.to_centroids(&places)).unwrap();
        mean += d.mean_mm / 200.0;
        square += d.rms_mm.powi(2) / 200.0;
    }
    assert!((mean / 0.2657 - 1.0).abs() < 0.005, "{mean}");
    assert!((square * 12.0 - 1.0).abs() < 0.01, "{square}");
}

/// Which surface is the result turns rows around, to the bit.
#[test]
fn swap_is_symmetric() {
    let (a, b) = (
        hills(14),
        moved(&hills(11), &Isometry3::translation(0.1, 0.2, 0.7)),
    );
    let (there, back) = (compared(&a, &b).as_given, compared(&b, &a).as_given);
    for (there, back) in [
        (there.whole, back.whole),
        (there.visible.unwrap(), back.visible.unwrap()),
    ] {
        assert_eq!(there.result_to_reference, back.reference_to_result);
        assert_eq!(
            there.result_to_reference_by_area,
            back.reference_to_result_by_area
        );
        assert_eq!(there.reference_to_result, back.result_to_reference);
        assert_eq!(
            there.reference_to_result_by_area,
            back.result_to_reference_by_area
        );
    }
}

/// One face of 200 mm² on the reference, beside 100 that have 0.02 mm² together, 1 mm above it, and share no point with
/// it. By points the mean is that of the many; by area that of the one.
#[test]
fn area_weighs_points() {
    let mut result = ComparedSurface {
        points_mm: vec![Vec3::zeros(), Vec3::x() * 20.0, Vec3::y() * 20.0],
        faces: vec![[0, 1, 2]],
        ..square(20, 0.0)
    };
    for k in 0..100 {
        let corner = Vec3::new(5.0 + 0.01 * f64::from(k), 5.0, 1.0);
        result.faces.push([0, 1, 2].map(|c| 3 + 3 * k + c));
        result
            .points_mm
            .extend([corner, corner + Vec3::x() * 0.02, corner + Vec3::y() * 0.02]);
    }
    let whole = compared(&result, &square(20, 0.0)).as_given.whole;
    let (by_point, by_area) = (
        whole.result_to_reference.unwrap(),
        whole.result_to_reference_by_area.unwrap(),
    );
    assert!((by_point.mean_mm - 300.0 / 303.0).abs() < 1e-12 && by_point.p95_mm == 1.0);
    assert!(
        (by_area.mean_mm - 0.02 / 200.02).abs() < 1e-12 && by_area.p95_mm == 0.0,
        "{by_area:?}"
    );
    assert_eq!(by_area.max_mm, 1.0);
}

/// Strips in contact under a flare that hang 6 and 2 mm deep: what is seen agrees, what is not does not. Half a
/// thickness below the flare tissue is still seen.
#[test]
fn what_is_hidden_is_apart() {
    let settings = CompareSettings {
        atrial_direction: Some(Vec3::z()),
        contact_thickness_mm: 0.5,
    };
    let strips = |depth: f64| plain(&flared_strips(20, 12, depth));
    let found = compare(&strips(6.0), &strips(2.0), &settings).unwrap();
    let visible = found.as_given.visible.unwrap();
    assert!(visible.result_to_reference.unwrap().max_mm < 0.3, "{visible:?}");
    assert!(found.as_given.whole.result_to_reference.unwrap().max_mm > 3.9);
    // The flare has 2 · 5√2 · 20 mm² of it, the strips 2 · 6 · 20; a row of faces at the corner counts as either.
    let share = 5.0 * 2f64.sqrt() / (5.0 * 2f64.sqrt() + 6.0);
    assert!(
        (found.result.visible_share.unwrap() - share).abs() < 0.05,
        "{:?}",
        found.result
    );
}

/// Contact is what the surfaces say, each of itself: without a word there is no row.
#[test]
fn contact_is_not_guessed() {
    let (mut result, reference) = (square(10, 0.0), square(10, 0.0));
    result
        .points_mm
        .iter_mut()
        .for_each(|p| p.z = if p.x > 9.9 { 0.5 } else { 0.1 });
    assert_eq!(compared(&result, &reference).as_given.in_contact, None);
    result.contact = Some(result.points_mm.iter().map(|p| p.x > 9.9).collect());
    let found = compared(&result, &reference);
    let (inside, outside) = (
        found.as_given.in_contact.unwrap(),
        found.as_given.not_in_contact.unwrap(),
    );
    assert!((inside.result_to_reference.unwrap().mean_mm - 0.5).abs() < 1e-12);
    assert!((outside.node_to_node.unwrap().mean_mm - 0.1).abs() < 1e-12);
    assert_eq!(inside.result_to_reference.unwrap().count, 6 * 11);
    assert_eq!(inside.reference_to_result, None);
    // The points from 10 mm on are in contact: faces there with all corners, half of those just before with two.
    assert_eq!(inside.centroid_to_centroid.unwrap().count, 100 + 10);
    assert_eq!(found.reference.contact_share, None);
}

/// Halves of a quadrilateral may meet along either diagonal, and points that no face uses count nowhere.
#[test]
fn quadrilaterals_correspond_whichever_way_they_are_split() {
    let mut result = square(1, 0.0);
    result.faces = vec![[0, 1, 3], [0, 3, 2]];
    result.face_cell = vec![4, 4];
    let mut reference = square(1, 1.0);
    reference.faces = vec![[0, 1, 2], [1, 3, 2]];
    reference.face_cell = vec![7, 7];
    for surface in [&mut result, &mut reference] {
        surface.points_mm.push(Vec3::repeat(900.0));
    }
    let found = compared(&result, &reference);
    let nodes = found.as_given.whole.node_to_node.unwrap();
    assert_eq!((nodes.count, nodes.max_mm), (4, 1.0));
    assert_eq!(found.as_given.whole.result_to_reference.unwrap().max_mm, 1.0);
    reference.face_cell = vec![];
    assert!(!compared(&result, &reference).nodes_correspond);
}

/// The atrium is where the annulus' rim says, be the faces of a bowl ever so many on one side; leaflets in pieces tell
/// by their faces; a closed surface by nothing, and is seen as the other one is.
#[test]
fn where_the_atrium_is() {
    let turn = Isometry3::new(Vec3::new(5.0, 6.0, 7.0), Vec3::new(0.4, -0.9, 0.2));
    let up = turn.rotation * Vec3::z();
    let bowl = moved(&bowl(20.0, 8, 0.0), &turn);
    let toward = |s: SurfaceSummary| s.atrial_direction.map(Vec3::from);
    let found = compared(&bowl, &bowl);
    assert!((toward(found.result).unwrap() - up).norm() < 1e-9 && found.warnings.is_empty());
    let pieces = moved(&plain(&flared_strips(20, 12, 6.0)), &turn);
    let mut turned = pieces.clone();
    // The two strips of this model wind alike as grids, so that one looks out where the other looks in.
    turned
        .faces
        .iter_mut()
        .take(pieces.faces.len() / 2)
        .for_each(|face| face.swap(0, 1));
    let looks = [&pieces, &turned].map(|s| toward(compared(s, s).result));
    let straight = |found: &Option<Vec3>| found.is_some_and(|n| n.dot(&up).abs() > 1.0 - 1e-9);
    assert_eq!(looks.iter().filter(|&n| straight(n)).count(), 1, "{looks:?}");
    let tetrahedron = ComparedSurface {
        points_mm: [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()]
            .map(|p| turn.rotation * p * 9.0 + up)
            .to_vec(),
        faces: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        ..bowl.clone()
    };
    let found = compared(&tetrahedron, &bowl);
    assert!((toward(found.result).unwrap() - up).norm() < 1e-9);
    assert!(
        found
            .warnings
            .iter()
            .any(|w| w.message.contains("seen as the other")),
        "{:?}",
        found.warnings
    );
    let found = compared(&tetrahedron, &tetrahedron);
    assert!(found.as_given.visible.is_none() && found.map.visible.is_none());
}

/// Faces turned the wrong way look to where a bowl hangs, and are taken for what they are; unless a direction is given,
/// against which nothing stands. Directions far apart, faces that do not wind alike and boxes far apart are told.
#[test]
fn wrong_sides_are_told() {
    let bowl = bowl(20.0, 8, 0.0);
    let mut turned = bowl.clone();
    turned.faces.iter_mut().for_each(|face| face.swap(0, 1));
    let found = compared(&turned, &bowl);
    let said = |found: &Comparison, what: &str| found.warnings.iter().any(|w| w.message.contains(what));
    assert!(
        said(&found, "taken to look to the ventricle"),
        "{:?}",
        found.warnings
    );
    assert_eq!(found.warnings.len(), 1);
    assert!(found.result.atrial_direction.unwrap()[2] > 1.0 - 1e-9);
    assert!(found.result.visible_share.unwrap() > 1.0 - 1e-9);
    // The sides of the reference are those of the atrium, not those of its faces: raised by 0.5 mm, walls of 60 degree
    // lie 0.25 mm inside, more than facets sink.
    let signs = [&bowl, &turned].map(|reference| {
        let raised = moved(&bowl, &Isometry3::translation(0.0, 0.0, 0.5));
        compared(&raised, reference).map.signed_distance_mm.unwrap()
    });
    assert!(signs.iter().flatten().all(|&d| d > 0.0), "{signs:?}");
    let down = CompareSettings {
        atrial_direction: Some(-Vec3::z()),
        ..CompareSettings::default()
    };
    let found = compare(&turned, &bowl, &down).unwrap();
    assert!(found.warnings.is_empty() && found.result.atrial_direction.unwrap()[2] < -1.0 + 1e-9);
    let tilted = moved(&bowl, &Isometry3::rotation(Vec3::x()));
    assert!(said(&compared(&tilted, &bowl), "57 degree away"));
    let mut mixed = bowl.clone();
    mixed.faces[7].swap(0, 1);
    assert_eq!(compared(&bowl, &mixed).map.signed_distance_mm, None);
    let far = moved(&bowl, &Isometry3::translation(500.0, 0.0, 0.0));
    assert!(
        compared(&far, &bowl)
            .warnings
            .iter()
            .any(|w| w.message.contains("one frame"))
    );
}

/// At a sharp ridge a point outside may lie behind the plane of the face that it is nearest to; it is outside all the
/// same. A spike over a square base, seen from all around its apex: nothing above it is behind.
#[test]
fn the_side_is_true_at_a_spike() {
    let spike = ComparedSurface {
        points_mm: vec![
            Vec3::new(-1.0, -1.0, 0.0),
            Vec3::new(1.0, -1.0, 0.0),
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::new(-1.0, 1.0, 0.0),
            Vec3::new(0.0, 0.0, 10.0),
        ],
        faces: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        ..ComparedSurface::default()
    };
    let ring = (0..24).map(|k| TAU * f64::from(k) / 24.0);
    let around: Vec<Vec3> = ring
        .map(|a| Vec3::new(0.3 * a.cos(), 0.3 * a.sin(), 10.1))
        .collect();
    let surface = IndexedSurface::new(&spike, spike.points_mm.clone());
    let outside = side::signed(&surface, None, &around, &surface.feet(&around)).unwrap();
    assert!(outside.iter().all(|&d| d > 0.0), "{outside:?}");
    let inside: Vec<Vec3> = around
        .iter()
        .map(|p| Vec3::new(p.x * 0.1, p.y * 0.1, 8.0))
        .collect();
    let inside = side::signed(&surface, None, &inside, &surface.feet(&inside)).unwrap();
    assert!(inside.iter().all(|&d| d < 0.0), "{inside:?}");
}

/// The number of threads changes no bit.
#[test]
fn threads_change_nothing() {
    let (a, b) = (
        hills(30),
        moved(&hills(41), &Isometry3::translation(0.1, 0.2, 0.7)),
    );
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| compared(&a, &b))
    };
    assert_eq!(with(1), with(3));
}

/// Everything that is no surface is refused with its name and what was found; nothing panics.
#[test]
fn what_is_no_surface_is_refused() {
    let good = square(2, 0.0);
    let spoilt = |change: fn(&mut ComparedSurface)| {
        let mut bad = good.clone();
        bad.name = "bad".into();
        change(&mut bad);
        bad
    };
    let cases: [(ComparedSurface, &str); 9] = [
        (ComparedSurface::default(), "no faces"),
        (spoilt(|s| s.faces.clear()), "no faces, only 9 points"),
        (spoilt(|s| s.faces[1] = [0, 1, 9]), "face 1 is [0, 1, 9]"),
        (spoilt(|s| s.points_mm[3].y = f64::NAN), "point 3 is (0, NaN, 0)"),
        (spoilt(|s| s.points_mm[3].y = 1e9), "within a kilometre"),
        (spoilt(|s| s.contact = Some(vec![true])), "1 values of `contact`"),
        (spoilt(|s| s.annulus = Some(vec![])), "0 values of `annulus`"),
        (spoilt(|s| s.face_cell = vec![1]), "1 cells of faces"),
        (
            spoilt(|s| s.points_mm.iter_mut().for_each(|p| p.x = 0.0)),
            "have no area",
        ),
    ];
    for (bad, expected) in &cases {
        for (a, b) in [(bad, &good), (&good, bad)] {
            let faults = compare(a, b, &CompareSettings::default()).unwrap_err();
            assert!(
                faults.len() == 1 && faults[0].message.contains(expected),
                "{faults:?}"
            );
            assert_eq!(faults[0].place, bad.name);
        }
    }
    let settings = CompareSettings {
        atrial_direction: Some(Vec3::zeros()),
        contact_thickness_mm: f64::NAN,
    };
    assert_eq!(compare(&cases[1].0, &good, &settings).unwrap_err().len(), 3);
}

/// Scattered faces of any size, folded, doubled, without area, anywhere within a kilometre: every number is finite, and
/// alignment makes nothing worse.
#[test]
fn odd_surfaces_have_finite_distances() {
    let mut seed = 7u64;
    let mut random = move || {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 33) as f64 / f64::from(1u32 << 31)
    };
    for (size, far) in [(1e-60, 0.0), (1e-6, 1e5), (10.0, 0.0), (10.0, 9e5), (9e5, 0.0)] {
        let mut scatter = |count: usize| {
            let mut place = || Vec3::new(random(), random(), random()) * size + Vec3::repeat(far);
            let points_mm = (0..count).map(|_| place()).collect();
            let mut corner = || (random() * count as f64) as u32;
            let scattered = (0..2 * count).map(|_| [corner(), corner(), corner()]);
            ComparedSurface {
                points_mm,
                // The first one has area.
                faces: [[0, 1, 2]].into_iter().chain(scattered).collect(),
                contact: Some((0..count).map(|v| v % 3 == 0).collect()),
                ..ComparedSurface::default()
            }
        };
        for count in [3, 7, 40] {
            let found = compared(&scatter(count), &scatter(30));
            for part in [
                found.as_given.whole,
                found.aligned.whole,
                found.as_given.in_contact.unwrap(),
            ] {
                for d in surface_rows(&part) {
                    let numbers = [d.mean_mm, d.sd_mm, d.rms_mm, d.p05_mm, d.p95_mm, d.max_mm];
                    assert!(numbers.iter().all(|x| x.is_finite()), "{size} {far} {d:?}");
                }
            }
            let a = found.alignment;
            assert!(
                a.offset_mm.iter().chain(&a.translation_mm).all(|x| x.is_finite()),
                "{a:?}"
            );
            assert!(a.rms_mm[1] <= a.rms_mm[0] && a.rotation_deg.is_finite(), "{a:?}");
        }
    }
}
