//! Distances that are known by hand, under every definition.

use nalgebra::Isometry3;

use super::super::*;
use super::{bowl, compared, flat, hills, moved, square, surface_rows};
use crate::measure::DistanceStatistics;

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
/// them: 0.963 to 1. Both rims are at 60 degree, so that each vertex at one has its foot at the other.
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
    let indexed = IndexedSurface::new(&reference.faces, reference.points_mm.clone());
    assert!((indexed.mean_edge_mm() - 1.0).abs() < 1e-12);
    let result = flat(10, 8.1);
    let centroids = IndexedSurface::new(&result.faces, result.points_mm.clone()).centroids_mm;
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
