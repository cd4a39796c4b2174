//! What is seen, what is in contact, and on which side things are.

use std::f64::consts::TAU;

use nalgebra::Isometry3;

use super::super::*;
use super::{bowl, compared, moved, plain, square};
use crate::measure::test_models::flared_strips;

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
    let surface = IndexedSurface::new(&spike.faces, spike.points_mm.clone());
    let outside = side::signed(&surface, None, &around, &surface.feet(&around)).unwrap();
    assert!(outside.iter().all(|&d| d > 0.0), "{outside:?}");
    let inside: Vec<Vec3> = around
        .iter()
        .map(|p| Vec3::new(p.x * 0.1, p.y * 0.1, 8.0))
        .collect();
    let inside = side::signed(&surface, None, &inside, &surface.feet(&inside)).unwrap();
    assert!(inside.iter().all(|&d| d < 0.0), "{inside:?}");
}
