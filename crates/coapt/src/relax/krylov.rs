//! Generalised conjugate residuals (Eisenstat, Elman & Schultz 1983), preconditioned from the right.
//!
//! The true tangent is S + N with S symmetric, positive definite and factorised, N antisymmetric and confined to
//! the free margin. S⁻¹(S + N) then has its eigenvalues on the line 1 + iλ, nearly all of them at 1, so that a
//! few products suffice where S alone would converge slowly, or, on a soft flap, not at all.
//!
//! What is left of the right-hand side is the least that these products allow, as with generalised minimal residuals (Saad &
//! Schultz 1986), but the directions can be kept: the next solution with the same matrix begins with the best that they allow.
//! Twenty valves like the healthy one under a ring of 30 mm took 176 products each instead of 520, when each eigenvalue was sought in fifty
//! solutions.

use crate::Vec3;

/// The most products of one solution.
const LIMIT: usize = 30;
/// So many directions are kept; beyond, they are gathered anew. Our choice: each takes 48 bytes a free vertex, all of them some 300 MB at
/// 100,000 faces; fewer, and the last solutions for an eigenvalue begin from nothing.
const KEPT: usize = 120;

/// What a solution took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Products with the matrix.
    pub products: usize,
    /// The part of the right-hand side that is left [1]; more than was asked for, or not a number, where the solution failed.
    pub left: f64,
}

/// Solves with one matrix after the other, keeping its room.
#[derive(Clone, Debug, Default)]
pub struct Krylov {
    /// Shape `[direction][size]`; the first `kept` are in use.
    directions: Vec<Vec<Vec3>>,
    /// The products with them, orthonormal.
    images: Vec<Vec<Vec3>>,
    kept: usize,
    /// What is left of the right-hand side.
    residual: Vec<Vec3>,
}

impl Krylov {
    /// Makes ready for another matrix.
    pub fn forget(&mut self) {
        self.kept = 0;
    }

    /// Solves A x = b in place, given the product with A and the solution with a matrix near A, until the residual has
    /// fallen to `tolerance` times the right-hand side, or the most products are made; says what it took. Shape `[size]`. A is
    /// that of the last call unless [`Krylov::forget`] was called since.
    pub fn solve(
        &mut self,
        mut multiply: impl FnMut(&[Vec3], &mut [Vec3]),
        precondition: impl Fn(&mut [Vec3]),
        right: &mut [Vec3],
        tolerance: f64,
    ) -> Effort {
        let asked = norm(right);
        let wanted = tolerance * asked;
        self.residual.clear();
        self.residual.extend_from_slice(right);
        right.fill(Vec3::zeros());
        for known in 0..self.kept {
            self.descend(known, right);
        }
        let mut products = 0;
        while norm(&self.residual) > wanted && products < LIMIT {
            if self.kept == KEPT {
                self.forget();
            }
            self.make_room();
            let (known, new) = self.directions.split_at_mut(self.kept);
            let (known_images, new_image) = self.images.split_at_mut(self.kept);
            let (direction, image) = (&mut new[0], &mut new_image[0]);
            direction.copy_from_slice(&self.residual);
            precondition(direction);
            multiply(direction, image);
            products += 1;
            for (known, known_image) in known.iter().zip(&*known_images) {
                let part = dot(known_image, image);
                add_scaled(image, -part, known_image);
                add_scaled(direction, -part, known);
            }
            let length = norm(image);
            if length == 0.0 || !length.is_finite() {
                break;
            }
            for vector in [direction, image] {
                vector.iter_mut().for_each(|value| *value /= length);
            }
            self.kept += 1;
            self.descend(self.kept - 1, right);
        }
        Effort {
            products,
            left: if asked == 0.0 {
                0.0
            } else {
                norm(&self.residual) / asked
            },
        }
    }

    /// Goes along a direction until its image is no longer in the residual.
    fn descend(&mut self, number: usize, solution: &mut [Vec3]) {
        let (direction, image) = (&self.directions[number], &self.images[number]);
        let part = dot(image, &self.residual);
        add_scaled(&mut self.residual, -part, image);
        add_scaled(solution, part, direction);
    }

    /// Room for one direction more.
    fn make_room(&mut self) {
        for vectors in [&mut self.directions, &mut self.images] {
            if vectors.len() == self.kept {
                vectors.push(Vec::new());
            }
            vectors[self.kept].resize(self.residual.len(), Vec3::zeros());
        }
    }
}

fn norm(vector: &[Vec3]) -> f64 {
    dot(vector, vector).sqrt()
}

fn dot(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn add_scaled(to: &mut [Vec3], factor: f64, from: &[Vec3]) {
    to.iter_mut()
        .zip(from)
        .for_each(|(to, from)| *to += from * factor);
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: usize = 80;

    /// S: 1 + k/10 on the diagonal, so that it is its own preconditioner; N: neighbours pull each other round.
    fn multiply(vector: &[Vec3], product: &mut [Vec3]) {
        for k in 0..SIZE {
            product[k] = vector[k] * stiffness(k);
            if k > 0 {
                product[k] += 0.7 * vector[k - 1];
            }
            if k + 1 < SIZE {
                product[k] -= 0.7 * vector[k + 1];
            }
        }
    }

    fn stiffness(k: usize) -> f64 {
        1.0 + 0.1 * k as f64
    }

    fn precondition(vector: &mut [Vec3]) {
        for (k, value) in vector.iter_mut().enumerate() {
            *value /= stiffness(k);
        }
    }

    fn right(seed: f64) -> Vec<Vec3> {
        let value = |k: usize| Vec3::new((seed * k as f64).sin(), (seed + k as f64).cos(), seed);
        (0..SIZE).map(value).collect()
    }

    /// The part of the right-hand side that a solution leaves [1].
    fn left(solution: &[Vec3], right: &[Vec3]) -> f64 {
        let mut product = vec![Vec3::zeros(); SIZE];
        multiply(solution, &mut product);
        add_scaled(&mut product, -1.0, right);
        norm(&product) / norm(right)
    }

    /// Kept directions make what is asked again free and what is asked anew cheaper, and neither less exact.
    #[test]
    fn solutions_with_one_matrix_share_their_directions() {
        let tolerance = 1e-9;
        let mut krylov = Krylov::default();
        let asked = |krylov: &mut Krylov, seed: f64| {
            let mut solution = right(seed);
            let effort = krylov.solve(multiply, precondition, &mut solution, tolerance);
            // Residuals that are updated part from true ones by rounding.
            assert!(left(&solution, &right(seed)) < 1.01 * tolerance, "seed {seed}");
            assert!(effort.left <= tolerance, "seed {seed}: {effort:?}");
            effort.products
        };
        let first = asked(&mut krylov, 0.3);
        assert!((5..LIMIT).contains(&first), "{first}");
        assert_eq!(asked(&mut krylov, 0.3), 0);
        let kept = asked(&mut krylov, 0.31);
        // More directions than are kept.
        for seed in 1..20 {
            asked(&mut krylov, f64::from(seed));
        }
        krylov.forget();
        let anew = asked(&mut krylov, 0.31);
        assert!(kept < anew, "{kept} {anew}");
    }

    #[test]
    fn nothing_is_solved_by_nothing() {
        let mut zeros = vec![Vec3::zeros(); SIZE];
        let effort = Krylov::default().solve(multiply, precondition, &mut zeros, 1e-9);
        assert_eq!((effort.products, effort.left), (0, 0.0));
        assert_eq!(norm(&zeros), 0.0);
    }

    /// Neither a preconditioner that leads nowhere nor a product that is not a number passes for a solution.
    #[test]
    fn what_is_not_solved_is_told() {
        let reverse = |vector: &mut [Vec3]| vector.reverse();
        let effort = Krylov::default().solve(multiply, reverse, &mut right(0.3), 1e-9);
        assert!(effort.left > 1e-9, "{effort:?}");
        let lost = |_: &[Vec3], product: &mut [Vec3]| product.fill(Vec3::repeat(f64::NAN));
        let effort = Krylov::default().solve(lost, precondition, &mut right(0.3), 1e-9);
        assert!(effort.left > 1e-9 || effort.left.is_nan(), "{effort:?}");
    }
}
