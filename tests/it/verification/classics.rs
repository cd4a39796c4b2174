//! Small structures with an answer on paper.

use coapt::Vec3;
use coapt::energy::chord::{self, Chords};
use coapt::energy::pressure;
use coapt::scene::ChordLaw;
use coapt_tests::Random;

use super::report;
use crate::shapes::{cap, lattice};

/// Pressure on a surface pushes as on any other surface with the same rim: p times the rim's vector area, ½ Σ x × x'.
/// Here a crumpled sheet; what is left is rounding.
#[test]
fn pressure_pushes_by_the_rims_vector_area() {
    let mut random = Random(3);
    let mut mesh = lattice(12, 0.0, &mut random);
    mesh.points_mm
        .iter_mut()
        .for_each(|x| *x += random.vector() * 2.0);
    let mut force = vec![Vec3::zeros(); mesh.points_mm.len()];
    pressure::add_gradient(&mesh.faces, 0.016, &mesh.points_mm, &mut force);
    let total: Vec3 = -force.iter().sum::<Vec3>();
    let at = |vertex: u32| mesh.points_mm[vertex as usize];
    let sides = pressure::rim(&mesh.faces);
    let area: Vec3 = sides.iter().map(|&[a, b]| at(a).cross(&at(b)) * 0.5).sum();
    let scale: f64 = force.iter().map(Vec3::norm).sum();
    let off = (total - area * 0.016).norm() / scale;
    report(&format!(
        "pressure on a crumpled sheet: off the rim's vector area by {off:.1e} of all forces"
    ));
    assert!(off < 1e-14);
}

/// On a cap of a sphere of any height that is π r² of its rim.
#[test]
fn pressure_on_a_cap_is_that_on_its_base() {
    let mesh = cap(10, 5.0, 2.0);
    let mut force = vec![Vec3::zeros(); mesh.points_mm.len()];
    pressure::add_gradient(&mesh.faces, 1.0, &mesh.points_mm, &mut force);
    let total: Vec3 = -force.iter().sum::<Vec3>();
    let exact = std::f64::consts::PI * (5.0 * 2.0_f64.sin()).powi(2);
    // The rim is a polygon of 60 sides, closer where the mesh is finer.
    assert!(
        total.xy().norm() < 1e-12 && super::error(total.z, exact) < 5e-3,
        "{total} {exact}"
    );
}

/// Shorter than at rest by an ulp or by all its length, a chord pulls with exactly nothing, whatever its law.
#[test]
fn a_slack_chord_pulls_with_exactly_nothing() {
    let laws = [
        ChordLaw::Linear { modulus_mpa: 1e9 },
        ChordLaw::PiecewiseLinear {
            toe_modulus_mpa: 1e9,
            transition_strain: 0.1,
            modulus_mpa: 1e10,
        },
        ChordLaw::Exponential {
            scale_mpa: 1e6,
            exponent: 100.0,
        },
    ];
    for law in laws {
        let chords = Chords {
            points: vec![vec![(0, 1.0)], vec![(1, 0.5), (2, 0.5)]],
            ends: vec![[0, 1]],
            rest_length_mm: vec![20.0],
            area_mm2: vec![1.0],
            group: vec![0],
            laws: vec![law],
        };
        for length_mm in [20.0, 20.0 - 4e-15, 19.0, 1e-9, 0.0] {
            let ends = [
                Vec3::zeros(),
                Vec3::new(1.0, 0.0, length_mm),
                Vec3::new(-1.0, 0.0, length_mm),
            ];
            let mut force = [Vec3::zeros(); 3];
            chord::add_gradient(&chords, &ends, &mut force);
            assert_eq!(chords.tensions_n(&ends), [0.0], "{length_mm}");
            assert_eq!(chord::energy(&chords, &ends), 0.0);
            assert_eq!(force, [Vec3::zeros(); 3]);
        }
    }
}
