//! Passages of known area. Cubes have edges of half a millimetre: holes of some centimetres are found to 4 %.

use std::f64::consts::{PI, TAU};

use nalgebra::Rotation3;

use super::super::surface::surface;
use super::super::test_models::{commissure_valve, lens_state, two_strips};
use super::*;

const REACH_MM: f64 = 0.5;
const SECTORS: usize = 64;

fn circle(radius_mm: f64, centre_mm: Vec3) -> Vec<Vec3> {
    let point = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / SECTORS as f64).sin_cos();
        centre_mm + Vec3::new(cos, sin, 0.0) * radius_mm
    };
    (0..SECTORS).map(point).collect()
}

/// A band of triangles from one closed curve to another.
fn band(outer: &[Vec3], inner: &[Vec3]) -> Vec<[Vec3; 3]> {
    let quad = |k: usize| {
        let l = (k + 1) % outer.len();
        [[outer[k], outer[l], inner[l]], [outer[k], inner[l], inner[k]]]
    };
    (0..outer.len()).flat_map(quad).collect()
}

fn turned(points: &[Vec3], turn: &Rotation3<f64>) -> Vec<Vec3> {
    points.iter().map(|p| turn * p).collect()
}

/// A round hole of 12 mm in a funnel, upright and lying askew: a circle, less the thickness of the tissue.
#[test]
fn a_round_hole() {
    let exact_mm2 = PI * (6.0 - REACH_MM).powi(2);
    let (outer, inner) = (
        circle(15.0, Vec3::zeros()),
        circle(6.0, Vec3::new(0.0, 0.0, -6.0)),
    );
    for angles in [[0.0; 3], [0.2, 0.0, 0.3], [0.0, 0.35, 1.0], [0.3, -0.3, 2.0]] {
        let turn = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let (outer, inner) = (turned(&outer, &turn), turned(&inner, &turn));
        let found_mm2 = narrowest_mm2(&band(&outer, &inner), &outer, REACH_MM).unwrap();
        assert!(
            (found_mm2 / exact_mm2 - 1.0).abs() < 0.04,
            "{angles:?} {found_mm2} {exact_mm2}"
        );
    }
}

/// A tube that is narrower half-way is as open as its waist, wherever both ends are: its band has to move there.
#[test]
fn a_waist() {
    let radii_mm = [12.0, 10.0, 8.0, 6.5, 5.0, 6.5, 8.0, 10.0, 11.0];
    for lowest in [0, 3] {
        let rings: Vec<Vec<Vec3>> = radii_mm[..radii_mm.len() - lowest]
            .iter()
            .enumerate()
            .map(|(k, &radius_mm)| circle(radius_mm, Vec3::new(0.0, 0.0, -2.0 * k as f64)))
            .collect();
        let leaflets: Vec<[Vec3; 3]> = rings.windows(2).flat_map(|w| band(&w[0], &w[1])).collect();
        let found_mm2 = narrowest_mm2(&leaflets, &rings[0], REACH_MM).unwrap();
        let exact_mm2 = PI * (5.0 - REACH_MM).powi(2);
        assert!(
            (found_mm2 / exact_mm2 - 1.0).abs() < 0.05,
            "{found_mm2} {exact_mm2}"
        );
    }
}

/// What has no hole lets nothing through; a wall in its place neither, however thin its triangles are in the grid.
#[test]
fn a_closed_funnel() {
    for radius_mm in [8.0, 15.0, 21.3] {
        let outer = circle(radius_mm, Vec3::zeros());
        let tip = vec![Vec3::new(0.3, 0.2, -7.0); SECTORS];
        assert_eq!(narrowest_mm2(&band(&outer, &tip), &outer, REACH_MM), Some(0.0));
    }
    assert_eq!(narrowest_mm2(&[], &circle(9.0, Vec3::zeros()), REACH_MM), None);
}

/// Two slits between parabolas y = ±(0.2 + b (1 - (x/a)²)): the integral of the opening less the tissue's thickness, where there is
/// any. Openings of 4 mm cut by cubes of 0.3: 8 %.
#[test]
fn slits_between_leaflets() {
    let model = commissure_valve(64, 16);
    let (a, b) = (4.0, 2.0);
    let positions_mm = lens_state(&model, &[(-5.5, a, b), (5.5, a, b)]);
    let s = surface(&model, &positions_mm);
    let reach_mm = 0.5 * threshold_mm(&model, s.mean_edge_mm);
    let half_mm = 0.2 + b - reach_mm;
    let end_mm = a * (half_mm / b).sqrt();
    let exact_mm2 = 2.0 * (2.0 * end_mm) * half_mm * 2.0 * (2.0 / 3.0);
    let found_mm2 = passage_mm2(&model, &positions_mm).unwrap();
    assert!(
        (found_mm2 / exact_mm2 - 1.0).abs() < 0.08,
        "{found_mm2} {exact_mm2}"
    );
    let closed_mm = lens_state(&model, &[]);
    assert_eq!(passage_mm2(&model, &closed_mm), Some(0.0));
}

/// Nothing parts the two sides beside strips that hang from two parallel lines.
#[test]
fn strips_part_nothing() {
    let model = two_strips(10, 3, 2.0);
    assert_eq!(passage_mm2(&model, &model.rest_mm), None);
}

/// Thin tissue does not make cubes without end: what is closed stays closed, though tissue counts as thicker.
#[test]
fn thin_tissue() {
    let outer = circle(18.0, Vec3::zeros());
    let closed = band(&outer, &vec![Vec3::new(0.0, 0.0, -20.0); SECTORS]);
    let voxels = walled(&closed, &outer, 0.01).unwrap();
    assert!(
        voxels.free.len() <= 1 << 21 && voxels.edge_mm < 0.3,
        "{}",
        voxels.edge_mm
    );
    assert_eq!(narrowest_mm2(&closed, &outer, 0.01), Some(0.0));
}
