//! Central differences with step h are off by h² times the third derivative plus rounding over h. Lengths are of order
//! one and the band of the penalty is a fifth of that, so h = 1e-6 leaves 1e-7 relative; a wrong formula is off by 1e-1.

use super::{add_gradient, add_hessian, energy};
use crate::contact::pairs::{Pair, PairKind};
use crate::contact::touch::{Touch, touches};
use crate::energy::Curvature;
use crate::{Mat3, Vec3};
use nalgebra::{DMatrix, DVector};

const STEP: f64 = 1e-6;
const STIFFNESS_MPA: f64 = 0.7;

fn pair(kind: PairKind, parallel_limit_mm4: f64) -> Pair {
    Pair {
        kind,
        // Not in order, so that blocks come from both sides of the diagonal.
        vertices: [2, 0, 3, 1],
        activation_mm: 0.5,
        rigid_mm: 0.3,
        area_mm2: 1.3,
        parallel_limit_mm4,
    }
}

fn touch(pair: &Pair, positions: &[Vec3]) -> Vec<Touch> {
    touches(std::slice::from_ref(pair), positions)
}

fn gradient(pair: &Pair, positions: &[Vec3]) -> DVector<f64> {
    let mut gradient = vec![Vec3::zeros(); 4];
    add_gradient(&touch(pair, positions), STIFFNESS_MPA, positions, &mut gradient);
    DVector::from_iterator(12, gradient.iter().flat_map(|g| g.iter().copied()))
}

fn hessian(pair: &Pair, positions: &[Vec3], curvature: Curvature) -> DMatrix<f64> {
    let mut hessian = DMatrix::zeros(12, 12);
    let mut sink = |row: u32, column: u32, block: &Mat3| {
        let (row, column) = (3 * row as usize, 3 * column as usize);
        let mut place = hessian.fixed_view_mut::<3, 3>(row, column);
        place += block;
        if row != column {
            let mut place = hessian.fixed_view_mut::<3, 3>(column, row);
            place += block.transpose();
        }
    };
    add_hessian(
        &touch(pair, positions),
        STIFFNESS_MPA,
        positions,
        curvature,
        &mut sink,
    );
    hessian
}

/// The four corners, in the order of the pair, put where the vertices say.
fn placed(pair: &Pair, corners: [[f64; 3]; 4]) -> Vec<Vec3> {
    let mut positions = vec![Vec3::zeros(); 4];
    for (&vertex, corner) in pair.vertices.iter().zip(corners) {
        positions[vertex as usize] = Vec3::from(corner);
    }
    positions
}

fn assert_derivatives(name: &str, pair: &Pair, corners: [[f64; 3]; 4]) {
    let positions = placed(pair, corners);
    let (slope, curvature) = (
        gradient(pair, &positions),
        hessian(pair, &positions, Curvature::Exact),
    );
    assert!(slope.amax() > 0.0, "{name}: nothing touches");
    for k in 0..12 {
        let [ahead, behind] = [STEP, -STEP].map(|step| {
            let mut moved = positions.clone();
            moved[k / 3][k % 3] += step;
            moved
        });
        let value = |at: &[Vec3]| energy(&touch(pair, at), STIFFNESS_MPA, at);
        let difference = (value(&ahead) - value(&behind)) / (2.0 * STEP) - slope[k];
        assert!(
            difference.abs() <= 1e-6 * slope.amax(),
            "{name}, slope {k}: {difference}"
        );
        let difference =
            (gradient(pair, &ahead) - gradient(pair, &behind)) / (2.0 * STEP) - curvature.column(k);
        let scale = curvature.amax();
        assert!(
            difference.amax() <= 1e-6 * scale,
            "{name}, column {k}: {difference} of {scale}"
        );
    }
    let projected = hessian(pair, &positions, Curvature::Projected).symmetric_eigenvalues();
    assert!(
        projected.min() >= -1e-12 * projected.amax(),
        "{name}: {projected}"
    );
    assert!(projected.amax() > 0.0, "{name}: no stiffness");
}

/// At these heights the law is the steep one and the parabola that goes on below it.
const HEIGHTS_MM: [f64; 3] = [0.42, 0.35, 0.31];

#[test]
fn a_point_over_every_region_of_a_triangle() {
    for height in HEIGHTS_MM {
        let places = [
            ("inside", [0.3, 0.4]),
            ("side ab", [0.5, -0.1]),
            ("side ac", [-0.1, 0.5]),
            ("side bc", [0.8, 0.9]),
            ("corner a", [-0.1, -0.05]),
            ("corner b", [1.3, 0.02]),
            ("corner c", [0.05, 1.6]),
        ];
        let triangle = [[0.0, 0.0, 0.0], [1.2, 0.1, 0.0], [0.1, 1.5, 0.0]];
        let pair = pair(PairKind::PointTriangle, 0.0);
        for (name, [x, y]) in places {
            let [a, b, c] = triangle;
            assert_derivatives(name, &pair, [[x, y, height], a, b, c]);
        }
    }
}

#[test]
fn edges_that_cross_or_meet_at_their_ends() {
    for height in HEIGHTS_MM {
        let edges = [
            ("crossing", [[-0.7, 0.1, height], [0.8, -0.1, height]]),
            ("end on edge", [[0.1, 0.2, height], [0.9, 0.3, height]]),
            ("edge on end", [[-0.5, 0.95, height], [0.7, 0.98, height]]),
            ("ends", [[0.1, 0.95, height], [0.8, 1.2, height]]),
        ];
        for (name, [a, b]) in edges {
            let other = [[0.0, -0.8, 0.0], [0.05, 0.9, 0.02]];
            // Not fading, and fading as it does near a parallel.
            for limit in [1e-3, 20.0] {
                let pair = pair(PairKind::EdgeEdge, limit);
                assert_derivatives(name, &pair, [a, b, other[0], other[1]]);
            }
        }
    }
}

#[test]
fn nearly_parallel_edges_fade() {
    // An angle of 0.6°, a third of that at which fading begins; c = |u × v|² is then a tenth of its limit.
    let pair = pair(PairKind::EdgeEdge, 1e-3);
    for (name, height) in [("overlapping", 0.35), ("steep", 0.31)] {
        let edges = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.1, -0.005, height],
            [1.1, 0.005, height],
        ];
        assert_derivatives(name, &pair, edges);
    }
}

#[test]
fn parallel_edges_and_slivers_stay_finite() {
    let across = [[0.0, 0.0, 0.4], [1.0, 0.0, 0.4], [0.2, 0.0, 0.0], [0.9, 0.0, 0.0]];
    let sliver = [
        [0.4, 0.0, 0.4],
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.5, 1e-9, 0.0],
    ];
    let point = [[0.4, 0.0, 0.4], [0.0; 3], [0.0; 3], [0.0; 3]];
    let cases = [
        (PairKind::EdgeEdge, across),
        (PairKind::PointTriangle, sliver),
        (PairKind::PointTriangle, point),
        (
            PairKind::EdgeEdge,
            [
                [0.0, 0.0, 0.4],
                [0.0, 0.0, 0.4],
                [0.2, 0.0, 0.0],
                [-0.9, 0.0, 0.0],
            ],
        ),
    ];
    for (kind, corners) in cases {
        let pair = pair(kind, 1e-3);
        let positions = placed(&pair, corners);
        for curvature in [Curvature::Exact, Curvature::Projected] {
            let hessian = hessian(&pair, &positions, curvature);
            assert!(hessian.iter().all(|value| value.is_finite()), "{hessian}");
        }
    }
}
