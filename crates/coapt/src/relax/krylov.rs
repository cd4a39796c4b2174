//! Generalised minimal residuals (Saad & Schultz 1986), preconditioned from the right.
//!
//! The true tangent is S + N with S symmetric, positive definite and factorised, N antisymmetric and confined to
//! the free margin. S⁻¹(S + N) then has its eigenvalues on the line 1 + iλ, nearly all of them at 1, so that a
//! few products suffice where S alone would converge slowly, or, on a soft flap, not at all.

use crate::Vec3;

/// The most products of one solution.
const LIMIT: usize = 30;

/// Solves, keeping its vectors from call to call.
#[derive(Clone, Debug, Default)]
pub struct Krylov {
    basis: Vec<Vec<Vec3>>,
    directions: Vec<Vec<Vec3>>,
    /// Columns of the triangle, each of length [`LIMIT`] + 1.
    triangle: Vec<[f64; LIMIT + 1]>,
    rotations: Vec<(f64, f64)>,
}

impl Krylov {
    /// Solves A x = b in place, given the product with A and the solution with a matrix near A, until the residual has
    /// fallen to `tolerance` times the right-hand side; returns how many products that took. Shape `[size]`.
    pub fn solve(
        &mut self,
        mut multiply: impl FnMut(&[Vec3], &mut [Vec3]),
        precondition: impl Fn(&mut [Vec3]),
        right: &mut [Vec3],
        tolerance: f64,
    ) -> usize {
        let norm = dot(right, right).sqrt();
        if norm == 0.0 {
            return 0;
        }
        self.make_room(1, right.len());
        copy_scaled(right, 1.0 / norm, &mut self.basis[0]);
        self.triangle.clear();
        self.rotations.clear();
        let mut remainder = [0.0; LIMIT + 1];
        remainder[0] = norm;
        let mut count = 0;
        while count < LIMIT {
            self.make_room(count + 2, right.len());
            self.directions[count].copy_from_slice(&self.basis[count]);
            precondition(&mut self.directions[count]);
            let (known, next) = self.basis.split_at_mut(count + 1);
            let next = &mut next[0];
            multiply(&self.directions[count], next);
            let mut column = orthogonalise(next, known);
            let length = dot(next, next).sqrt();
            for (k, &(cosine, sine)) in self.rotations.iter().enumerate() {
                let (upper, lower) = (column[k], column[k + 1]);
                column[k] = cosine * upper + sine * lower;
                column[k + 1] = cosine * lower - sine * upper;
            }
            let diagonal = column[count].hypot(length);
            if diagonal == 0.0 {
                break;
            }
            let (cosine, sine) = (column[count] / diagonal, length / diagonal);
            self.rotations.push((cosine, sine));
            column[count] = diagonal;
            self.triangle.push(column);
            let last = remainder[count];
            remainder[count] = cosine * last;
            remainder[count + 1] = -sine * last;
            count += 1;
            if remainder[count].abs() <= tolerance * norm {
                break;
            }
            next.iter_mut().for_each(|value| *value /= length);
        }
        self.combine(count, &remainder, right);
        count
    }

    fn make_room(&mut self, count: usize, size: usize) {
        for vectors in [&mut self.basis, &mut self.directions] {
            while vectors.len() < count {
                vectors.push(Vec::new());
            }
            vectors
                .iter_mut()
                .take(count)
                .for_each(|vector| vector.resize(size, Vec3::zeros()));
        }
    }

    /// Solves the triangular system and sums the directions.
    fn combine(&self, count: usize, right: &[f64; LIMIT + 1], sum: &mut [Vec3]) {
        let mut weights = [0.0; LIMIT];
        for row in (0..count).rev() {
            let known: f64 = (row + 1..count)
                .map(|column| self.triangle[column][row] * weights[column])
                .sum();
            weights[row] = (right[row] - known) / self.triangle[row][row];
        }
        sum.fill(Vec3::zeros());
        for (direction, weight) in self.directions.iter().zip(&weights[..count]) {
            sum.iter_mut()
                .zip(direction)
                .for_each(|(value, along)| *value += along * *weight);
        }
    }
}

/// Takes the basis out of a vector; returns the parts taken.
fn orthogonalise(vector: &mut [Vec3], basis: &[Vec<Vec3>]) -> [f64; LIMIT + 1] {
    let mut parts = [0.0; LIMIT + 1];
    for (part, direction) in parts.iter_mut().zip(basis) {
        *part = dot(direction, vector);
        vector
            .iter_mut()
            .zip(direction)
            .for_each(|(value, along)| *value -= along * *part);
    }
    parts
}

fn dot(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn copy_scaled(from: &[Vec3], factor: f64, to: &mut [Vec3]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = from * factor);
}
