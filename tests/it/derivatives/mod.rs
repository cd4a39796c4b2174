//! Every energy: its gradient is the slope of its value, its Hessian the slope of its gradient, and what is
//! internal pushes and turns nothing as a whole.
//!
//! Central differences with step h are off by h² times the third derivative plus rounding over h: with h = 1e-5
//! on quantities of order one, 1e-6 relative is the accuracy to expect of a right formula and 1e-1 of a wrong one.
mod chordae;
mod contact;
mod leaflets;
mod membranes;
mod pressure;

use coapt::energy::{BlockSink, Curvature};
use coapt::{Mat3, Vec3};
use nalgebra::DMatrix;

const STEP: f64 = 1e-5;

/// What a term must offer to be checked.
struct Term<'a> {
    energy: &'a dyn Fn(&[Vec3]) -> f64,
    gradient: &'a dyn Fn(&[Vec3]) -> Vec<Vec3>,
    hessian: &'a dyn Fn(&[Vec3], Curvature) -> DMatrix<f64>,
}

fn nudged(positions: &[Vec3], vertex: usize, axis: usize, by: f64) -> Vec<Vec3> {
    let mut moved = positions.to_vec();
    moved[vertex][axis] += by;
    moved
}

fn assert_gradient(term: &Term, positions: &[Vec3]) {
    let gradient = (term.gradient)(positions);
    let scale = gradient.iter().map(|g| g.norm()).fold(1e-6, f64::max);
    for (vertex, slope) in gradient.iter().enumerate() {
        for (axis, slope) in slope.iter().enumerate() {
            let ahead = (term.energy)(&nudged(positions, vertex, axis, STEP));
            let behind = (term.energy)(&nudged(positions, vertex, axis, -STEP));
            let difference = (ahead - behind) / (2.0 * STEP) - slope;
            assert!(
                difference.abs() <= 1e-6 * scale,
                "vertex {vertex} axis {axis}: {difference} of {scale}"
            );
        }
    }
}

fn assert_hessian(term: &Term, positions: &[Vec3]) {
    let hessian = (term.hessian)(positions, Curvature::Exact);
    let scale = hessian.amax().max(1e-6);
    for vertex in 0..positions.len() {
        for axis in 0..3 {
            let ahead = (term.gradient)(&nudged(positions, vertex, axis, STEP));
            let behind = (term.gradient)(&nudged(positions, vertex, axis, -STEP));
            for (row, (a, b)) in ahead.iter().zip(&behind).enumerate() {
                for k in 0..3 {
                    let slope = (a[k] - b[k]) / (2.0 * STEP);
                    let difference = slope - hessian[(3 * row + k, 3 * vertex + axis)];
                    assert!(
                        difference.abs() <= 1e-5 * scale,
                        "({row}, {k}) by ({vertex}, {axis}): {difference} of {scale}"
                    );
                }
            }
        }
    }
}

fn assert_projected_is_semidefinite(term: &Term, positions: &[Vec3]) {
    let projected = (term.hessian)(positions, Curvature::Projected);
    let eigenvalues = projected.symmetric_eigenvalues();
    assert!(
        eigenvalues.min() >= -1e-10 * eigenvalues.amax().max(1e-12),
        "{}",
        eigenvalues.min()
    );
}

fn assert_balanced(term: &Term, positions: &[Vec3]) {
    let gradient = (term.gradient)(positions);
    let scale: f64 = gradient
        .iter()
        .zip(positions)
        .map(|(g, x)| g.norm() * (1.0 + x.norm()))
        .sum();
    let force: Vec3 = gradient.iter().sum();
    let torque: Vec3 = positions.iter().zip(&gradient).map(|(x, g)| x.cross(g)).sum();
    // Rounding only.
    assert!(
        force.norm() <= 1e-13 * scale && torque.norm() <= 1e-13 * scale,
        "{force} {torque} of {scale}"
    );
}

fn assert_all(term: &Term, positions: &[Vec3]) {
    assert_gradient(term, positions);
    assert_hessian(term, positions);
    assert_balanced(term, positions);
}

/// Collects blocks into a dense matrix.
struct Dense(DMatrix<f64>);

impl BlockSink for Dense {
    fn add(&mut self, row: u32, column: u32, block: &Mat3) {
        for k in 0..3 {
            for l in 0..3 {
                self.0[(3 * row as usize + k, 3 * column as usize + l)] += block[(k, l)];
                if row != column {
                    self.0[(3 * column as usize + l, 3 * row as usize + k)] += block[(k, l)];
                }
            }
        }
    }
}

fn dense(vertices: usize, fill: impl FnOnce(&mut Dense)) -> DMatrix<f64> {
    let mut dense = Dense(DMatrix::zeros(3 * vertices, 3 * vertices));
    fill(&mut dense);
    dense.0
}

fn gradient_of(vertices: usize, fill: impl FnOnce(&mut [Vec3])) -> Vec<Vec3> {
    let mut gradient = vec![Vec3::zeros(); vertices];
    fill(&mut gradient);
    gradient
}
