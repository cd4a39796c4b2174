//! Pressure.

use super::*;
use coapt::energy::pressure;
use coapt_tests::Random;

/// A fan of six faces around vertex 0, bent at random.
fn fan(random: &mut Random) -> (Vec<[u32; 3]>, Vec<Vec3>) {
    let mut positions = vec![random.vector() * 0.2];
    for k in 0..6 {
        let angle = f64::from(k) * std::f64::consts::FRAC_PI_3;
        positions.push(Vec3::new(angle.cos(), angle.sin(), 0.0) + random.vector() * 0.2);
    }
    ((0..6).map(|k| [0, k + 1, (k + 1) % 6 + 1]).collect(), positions)
}

#[test]
fn pressure_potential_has_the_gradient_it_claims() {
    let mut random = Random(3);
    let (faces, positions) = fan(&mut random);
    let apex = Vec3::new(0.3, -0.2, 1.0);
    let term = Term {
        energy: &|x| pressure::potential(&faces, 0.0133, apex, x),
        gradient: &|x| {
            gradient_of(7, |g| {
                pressure::add_potential_gradient(&faces, 0.0133, apex, x, g)
            })
        },
        hessian: &|_, _| DMatrix::zeros(21, 21),
    };
    assert_gradient(&term, &positions);
}

#[test]
fn pressure_inside_a_rim_is_the_gradient_of_its_potential() {
    let mut random = Random(4);
    let (faces, positions) = fan(&mut random);
    let load = gradient_of(7, |g| pressure::add_gradient(&faces, 1.0, &positions, g));
    let potential = gradient_of(7, |g| {
        pressure::add_potential_gradient(&faces, 1.0, Vec3::new(5.0, 1.0, 2.0), &positions, g)
    });
    assert!(
        (load[0] - potential[0]).norm() < 1e-13,
        "vertex 0 lies inside a ring of faces"
    );
    assert!(
        (load[1] - potential[1]).norm() > 1e-2,
        "vertex 1 lies on an open rim, where the two must differ"
    );
}

#[test]
fn pressure_tangent_is_the_slope_of_the_load_split_in_its_two_parts() {
    let mut random = Random(5);
    let (faces, positions) = fan(&mut random);
    let load = |x: &[Vec3]| gradient_of(7, |g| pressure::add_gradient(&faces, 1.0, x, g));
    let rim = pressure::rim(&faces);
    assert_eq!(rim.len(), 6);
    let symmetric = dense(7, |sink| {
        pressure::add_symmetric_tangent(&faces, 1.0, &positions, sink)
    });
    for column in 0..21 {
        let mut direction = vec![Vec3::zeros(); 7];
        direction[column / 3][column % 3] = 1.0;
        let antisymmetric = gradient_of(7, |g| {
            pressure::add_antisymmetric_product(&rim, 1.0, &positions, &direction, g)
        });
        let ahead = load(&nudged(&positions, column / 3, column % 3, STEP));
        let behind = load(&nudged(&positions, column / 3, column % 3, -STEP));
        for row in 0..21 {
            let slope = (ahead[row / 3][row % 3] - behind[row / 3][row % 3]) / (2.0 * STEP);
            let parts = symmetric[(row, column)] + antisymmetric[row / 3][row % 3];
            // The load is quadratic in the positions: central differences are exact but for rounding over h.
            assert!(
                (slope - parts).abs() < 1e-9,
                "({row}, {column}): {slope} and {parts}"
            );
        }
    }
}

#[test]
fn pressure_on_a_closed_surface_sums_to_nothing() {
    let positions: Vec<Vec3> = vec![
        Vec3::zeros(),
        Vec3::new(2.0, 0.1, 0.0),
        Vec3::new(0.3, 1.5, 0.2),
        Vec3::new(0.4, 0.5, 1.7),
    ];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let load = gradient_of(4, |g| pressure::add_gradient(&faces, 1.0, &positions, g));
    assert!(load.iter().sum::<Vec3>().norm() < 1e-14);
}
