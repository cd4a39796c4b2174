//! Springs and hinges.

use super::*;
use coapt::energy::{bending, bending::Hinges, bilinear_spring, bilinear_spring::Springs};
use coapt_tests::Random;

#[test]
fn springs_in_compression_on_the_soft_and_on_the_stiff_branch() {
    for length in [0.7, 1.1, 1.6] {
        let springs = Springs {
            ends: vec![[0, 1]],
            rest_length_mm: vec![1.0],
            transition_length_mm: vec![1.25],
            soft_n_per_mm: vec![0.3],
            stiff_n_per_mm: vec![11.0],
            compression_n_per_mm: vec![0.2],
        };
        let direction = Vec3::new(1.0, -2.0, 0.5).normalize();
        let positions = vec![
            Vec3::new(3.0, 1.0, -2.0),
            Vec3::new(3.0, 1.0, -2.0) + direction * length,
        ];
        let term = Term {
            energy: &|x| bilinear_spring::energy(&springs, x),
            gradient: &|x| gradient_of(2, |g| bilinear_spring::add_gradient(&springs, x, g)),
            hessian: &|x, _| dense(2, |sink| bilinear_spring::add_hessian(&springs, x, sink)),
        };
        assert_all(&term, &positions);
        // The law itself: f(1.6) = 0.3·0.25 + 11·0.35, f(1.1) = 0.3·0.1, f(0.7) = −0.2·0.3.
        let expected = if length < 1.0 {
            -0.06
        } else if length < 1.25 {
            0.03
        } else {
            0.075 + 3.85
        };
        assert!((springs.tension_and_tangent(0, length).0 - expected).abs() < 1e-14);
    }
}

#[test]
fn bent_hinges() {
    let mut random = Random(7);
    let hinges = Hinges {
        vertices: vec![[0, 1, 2, 3], [1, 2, 4, 0]],
        // As cotangents give them: adding up to nothing.
        weights: vec![[0.5, 1.1, -0.9, -0.7], [0.4, 0.8, -1.3, 0.1]],
        stiffness_n_per_mm: vec![0.3, 2.0],
    };
    let positions: Vec<Vec3> = (0..5).map(|_| random.vector() * 2.0).collect();
    let term = Term {
        energy: &|x| bending::energy(&hinges, x),
        gradient: &|x| gradient_of(5, |g| bending::add_gradient(&hinges, x, g)),
        hessian: &|_, _| dense(5, |sink| bending::add_hessian(&hinges, sink)),
    };
    assert_all(&term, &positions);
    assert_projected_is_semidefinite(&term, &positions);
}
