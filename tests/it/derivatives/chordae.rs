//! Chordae and their laws.

use super::*;
use coapt::energy::{chord, chord::Chords, chord_law::response};
use coapt::scene::ChordLaw;
use coapt_tests::Random;

#[test]
fn chords_taut_and_slack() {
    for length in [0.8, 1.05] {
        let chords = Chords {
            points: vec![vec![(0, 1.0)], vec![(1, 1.0)]],
            ..one_chord()
        };
        let positions = vec![Vec3::new(0.2, 0.1, 0.0), Vec3::new(0.2, 0.1, length)];
        assert_chord(&chords, &positions);
        // T = EA ε in tension, nothing in compression.
        let expected = if length > 1.0 { 12.0 * 0.05 } else { 0.0 };
        assert!((chords.tensions_n(&positions)[0] - expected).abs() < 1e-13);
    }
}

/// From a patch of three vertices to one, and to a patch that shares two of them.
#[test]
fn chords_between_patches() {
    let mut random = Random(6);
    let positions: Vec<Vec3> = (0..5)
        .map(|k| random.vector() + Vec3::z() * f64::from(k))
        .collect();
    for second in [vec![(4, 1.0)], vec![(1, 0.3), (2, 0.2), (3, 0.1), (4, 0.4)]] {
        let chords = Chords {
            points: vec![vec![(0, 0.5), (1, 0.3), (2, 0.2)], second],
            ..one_chord()
        };
        assert!(chords.tensions_n(&positions)[0] > 0.0);
        assert_chord(&chords, &positions);
    }
}

fn one_chord() -> Chords {
    Chords {
        points: Vec::new(),
        ends: vec![[0, 1]],
        rest_length_mm: vec![1.0],
        area_mm2: vec![0.4],
        group: vec![0],
        laws: vec![ChordLaw::Linear { modulus_mpa: 30.0 }],
    }
}

fn assert_chord(chords: &Chords, positions: &[Vec3]) {
    let count = positions.len();
    let term = Term {
        energy: &|x| chord::energy(chords, x),
        gradient: &|x| gradient_of(count, |g| chord::add_gradient(chords, x, g)),
        hessian: &|x, _| dense(count, |sink| chord::add_hessian(chords, x, sink)),
    };
    assert_all(&term, positions);
    assert_projected_is_semidefinite(&term, positions);
    assert_eq!(
        places(chords, positions),
        places(chords, &vec![Vec3::zeros(); count])
    );
}

/// Where a chord's blocks go: the solver looks that up once, so it must not depend on the positions, not even on whether
/// a chord is slack.
fn places(chords: &Chords, positions: &[Vec3]) -> Vec<[u32; 2]> {
    let mut places = Vec::new();
    let mut sink = |row: u32, column: u32, _: &Mat3| places.push([row, column]);
    chord::add_hessian(chords, positions, &mut sink);
    places
}

/// Each law at strains on both sides of its knees: what it stores has the slope that it pulls with, and that the slope
/// that it says; the figures are worked out by hand.
#[test]
fn chord_laws() {
    let laws = [
        (ChordLaw::Linear { modulus_mpa: 30.0 }, 0.1, 3.0),
        // Paper 000, marginal: 3.06 · 0.025 + 33.4 · 0.075.
        (
            ChordLaw::PiecewiseLinear {
                toe_modulus_mpa: 3.06,
                transition_strain: 0.025,
                modulus_mpa: 33.4,
            },
            0.1,
            2.5815,
        ),
        (
            ChordLaw::Exponential {
                scale_mpa: 0.5,
                exponent: 20.0,
            },
            0.1,
            0.5 * (2.0_f64.exp() - 1.0),
        ),
        (collagen(), 0.1, 4.6434e-4 * (4.99643_f64.exp() - 1.0)),
        // At full recruitment the curve has reached 0.65 MPa, and goes on with 32.5 MPa from there.
        (collagen(), 0.165, 0.65 + 32.5 * 0.02),
        (table(), 0.05, 1.0),
        (table(), 0.15, 5.0),
        (table(), 0.3, 5.0),
        // Far beyond all reason it stays finite.
        (
            ChordLaw::Exponential {
                scale_mpa: 1e-3,
                exponent: 15.0,
            },
            2.0,
            1e-3 * ((15.0_f64.exp() - 1.0) + 15.0 * 15.0_f64.exp()),
        ),
    ];
    for (law, strain, stress_mpa) in laws {
        let [below, at, above] = [strain - STEP, strain, strain + STEP].map(|strain| response(&law, strain));
        // 5e-5: the constants of the collagen curve are printed to that.
        assert!((at.stress_mpa / stress_mpa - 1.0).abs() < 5e-5, "{law:?} {at:?}");
        let slope = (above.energy_mpa - below.energy_mpa) / (2.0 * STEP);
        assert!(
            (slope / at.stress_mpa - 1.0).abs() < 1e-6,
            "{law:?} {slope} {at:?}"
        );
        let slope = (above.stress_mpa - below.stress_mpa) / (2.0 * STEP);
        assert!(
            (slope - at.modulus_mpa).abs() < 1e-6 * (1.0 + slope.abs()),
            "{law:?} {slope} {at:?}"
        );
        assert_eq!(response(&law, -strain).stress_mpa, 0.0);
        let chords = Chords {
            points: vec![vec![(0, 1.0)], vec![(1, 1.0)]],
            laws: vec![law],
            ..one_chord()
        };
        assert_chord(
            &chords,
            &[Vec3::zeros(), Vec3::new(0.6, 0.0, 0.8) * (1.0 + strain)],
        );
    }
}

/// Kaiser et al. (arXiv 1902.00018).
fn collagen() -> ChordLaw {
    ChordLaw::Collagen {
        scale_mpa: 4.6434e-4,
        exponent: 49.9643,
        full_recruitment_strain: 0.145,
        modulus_mpa: 32.5,
    }
}

/// Soft, stiff, and then it gives no more.
fn table() -> ChordLaw {
    ChordLaw::Table {
        strain: vec![0.0, 0.1, 0.12, 0.2],
        stress_mpa: vec![0.0, 2.0, 5.0, 5.0],
    }
}
