//! Generalised minimal residuals (Saad & Schultz 1986), preconditioned from the right.
//!
//! The true tangent is S + N with S symmetric, positive definite and factorised, N antisymmetric and confined to
//! the free margin. S⁻¹(S + N) then has its eigenvalues on the line 1 + iλ, nearly all of them at 1, so that a
//! few products suffice where S alone would converge slowly, or, on a soft flap, not at all.

use crate::Vec3;

/// The most products of one solution.
const LIMIT: usize = 30;

/// Solves A x = b, given the product with A and the solution with a matrix near A, until the residual has fallen to
/// `tolerance` times the right-hand side. Shape `[size]`.
pub fn solve(
    multiply: impl Fn(&[Vec3]) -> Vec<Vec3>,
    precondition: impl Fn(&[Vec3]) -> Vec<Vec3>,
    right: &[Vec3],
    tolerance: f64,
) -> Vec<Vec3> {
    let norm = dot(right, right).sqrt();
    if norm == 0.0 {
        return right.to_vec();
    }
    let mut basis = vec![scaled(right, 1.0 / norm)];
    let mut directions: Vec<Vec<Vec3>> = Vec::new();
    let mut triangle: Vec<Vec<f64>> = Vec::new();
    let mut rotations: Vec<(f64, f64)> = Vec::new();
    let mut remainder = vec![norm];
    for step in 0..LIMIT {
        directions.push(precondition(&basis[step]));
        let mut next = multiply(&directions[step]);
        let mut column = orthogonalise(&mut next, &basis);
        let length = dot(&next, &next).sqrt();
        for (k, &(cosine, sine)) in rotations.iter().enumerate() {
            let (upper, lower) = (column[k], column[k + 1]);
            column[k] = cosine * upper + sine * lower;
            column[k + 1] = cosine * lower - sine * upper;
        }
        let diagonal = column[step].hypot(length);
        if diagonal == 0.0 {
            directions.pop();
            break;
        }
        let (cosine, sine) = (column[step] / diagonal, length / diagonal);
        rotations.push((cosine, sine));
        column[step] = diagonal;
        triangle.push(column);
        let last = remainder[step];
        remainder[step] = cosine * last;
        remainder.push(-sine * last);
        if remainder[step + 1].abs() <= tolerance * norm {
            break;
        }
        basis.push(scaled(&next, 1.0 / length));
    }
    combine(&directions, &triangle, &remainder, right.len())
}

/// Takes the basis out of a vector; returns the parts taken.
fn orthogonalise(vector: &mut [Vec3], basis: &[Vec<Vec3>]) -> Vec<f64> {
    basis
        .iter()
        .map(|direction| {
            let part = dot(direction, vector);
            vector
                .iter_mut()
                .zip(direction)
                .for_each(|(value, along)| *value -= along * part);
            part
        })
        .collect()
}

/// Solves the triangular system and sums the directions.
fn combine(directions: &[Vec<Vec3>], triangle: &[Vec<f64>], right: &[f64], size: usize) -> Vec<Vec3> {
    let mut weights = vec![0.0; directions.len()];
    for row in (0..directions.len()).rev() {
        let known: f64 = (row + 1..directions.len())
            .map(|column| triangle[column][row] * weights[column])
            .sum();
        weights[row] = (right[row] - known) / triangle[row][row];
    }
    let mut sum = vec![Vec3::zeros(); size];
    for (direction, weight) in directions.iter().zip(weights) {
        sum.iter_mut()
            .zip(direction)
            .for_each(|(value, along)| *value += along * weight);
    }
    sum
}

fn dot(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn scaled(vector: &[Vec3], factor: f64) -> Vec<Vec3> {
    vector.iter().map(|value| value * factor).collect()
}
