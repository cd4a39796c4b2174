//! Whether a balance of forces lasts: eigenvalues of the true tangent.
//!
//! A valve that creeps, M ẋ = f with M the area around each vertex, returns from any small push if every eigenvalue
//! of M⁻¹K has a positive real part. Where the symmetric part S of K is positive definite, all have. Where it is
//! not, follower pressure on a free margin may still hold the valve: the eigenvalues themselves must tell.
//! Arnoldi's method finds those nearest −σ, with σ large enough that S + σM is positive definite; an eigenvalue with
//! a negative real part can lie nowhere else (its real part is not below the least eigenvalue of S, Bendixson 1902).

use crate::Vec3;
use nalgebra::DMatrix;

/// Vectors of the Krylov space, at most. The eigenvalues sought stand apart from all others; 10 to 30 find them.
const KRYLOV_SIZE: usize = 50;
/// The eigenvalues are looked at whenever so many vectors have been added.
const LOOK_EVERY: usize = 4;
/// Relative residual of the solutions that it needs [1]; what is nearer to zero than this part of the shift is taken for zero.
pub const TOLERANCE: f64 = 1e-5;
/// Settled is a value that changes by no more than this part of itself [1], or of the shift by [`TOLERANCE`], so many looks in a row. Of
/// 189 balances of the presets, with and without rings of 24 to 36 mm, at 650 to 2600 faces, whose symmetric part was indefinite, all
/// were judged as by the whole Krylov space, after 21 vectors in the mean. After the first such look values may still fall: from 5.4e-6
/// of the shift to 7e-7.
const SETTLED: f64 = 0.1;
const SETTLED_LOOKS: u32 = 2;

/// The least real part of an eigenvalue of M⁻¹K [MPa/mm], given the solution of (K + σM) x = b, in place, and the diagonal M; nothing
/// where a solution failed, which `solve` answers with false, or was no number. Where the weights of what K does not hold at all are
/// zero, though not those in the solution, its eigenvalues of zero take no part.
pub fn least_real_part(
    mut solve: impl FnMut(&mut [Vec3]) -> bool,
    weight_mm2: &[f64],
    shift: f64,
    start: Vec<Vec3>,
) -> Option<f64> {
    let mut basis = vec![start];
    normalise(&mut basis[0]);
    let mut hessenberg = DMatrix::<f64>::zeros(KRYLOV_SIZE + 1, KRYLOV_SIZE);
    let (mut size, mut last, mut settled) = (0, f64::NEG_INFINITY, 0);
    while size < KRYLOV_SIZE {
        let mut next: Vec<Vec3> = basis[size]
            .iter()
            .zip(weight_mm2)
            .map(|(x, weight)| x * *weight)
            .collect();
        if !solve(&mut next) {
            return None;
        }
        // Twice, because once leaves rounding that later steps would take for signal.
        for _ in 0..2 {
            for (row, direction) in basis.iter().enumerate() {
                let part: f64 = direction.iter().zip(&next).map(|(a, b)| a.dot(b)).sum();
                next.iter_mut()
                    .zip(direction)
                    .for_each(|(x, along)| *x -= along * part);
                hessenberg[(row, size)] += part;
            }
        }
        let length = normalise(&mut next);
        hessenberg[(size + 1, size)] = length;
        size += 1;
        if !length.is_finite() {
            return None;
        }
        if length <= f64::EPSILON * hessenberg[(0, 0)].abs() {
            break;
        }
        basis.push(next);
        if size.is_multiple_of(LOOK_EVERY) {
            let least = least_of(&hessenberg, size, shift);
            let is_settled = (least - last).abs() <= (SETTLED * least.abs()).max(TOLERANCE * shift);
            settled = if is_settled { settled + 1 } else { 0 };
            if settled == SETTLED_LOOKS {
                return Some(least);
            }
            last = least;
        }
    }
    Some(least_of(&hessenberg, size, shift))
}

fn least_of(hessenberg: &DMatrix<f64>, size: usize, shift: f64) -> f64 {
    let square = hessenberg.view((0, 0), (size, size)).clone_owned();
    let real_part = |inverse: &nalgebra::Complex<f64>| inverse.re / inverse.norm_sqr() - shift;
    let values = square.complex_eigenvalues();
    values.iter().map(real_part).fold(f64::INFINITY, f64::min)
}

fn normalise(vector: &mut [Vec3]) -> f64 {
    let length = vector.iter().map(Vec3::norm_squared).sum::<f64>().sqrt();
    vector.iter_mut().for_each(|x| *x /= length);
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    /// K = S + N on three points with M = 1: S = diag, N turns x and y into each other. With S = diag(-1, 3) in the
    /// plane and N = ±n, the eigenvalues are 1 ± √(4 − n²): n = 1 leaves one at 1 − √3 < 0, n = 1.9 makes both
    /// positive although S is indefinite.
    #[test]
    fn rotation_can_hold_what_stiffness_cannot() {
        for (n, expected) in [(1.0, 1.0 - 3.0_f64.sqrt()), (1.9, 1.0 - 0.39_f64.sqrt())] {
            let (shift, weight) = (1.5, [1.0; 3]);
            let solve = |x: &mut [Vec3]| {
                let matrix =
                    crate::Mat3::new(-1.0 + shift, n, 0.0, -n, 3.0 + shift, 0.0, 0.0, 0.0, 9.0 + shift);
                let inverse = matrix.try_inverse().unwrap_or_default();
                for (k, x) in x.iter_mut().enumerate() {
                    *x = inverse * *x / (1.0 + 0.1 * k as f64);
                }
                true
            };
            let start = (1..4).map(|k| Vec3::new(f64::from(k), 1.0, 0.5)).collect();
            let least = least_real_part(solve, &weight, shift, start).unwrap();
            assert!((least - expected).abs() < 1e-9, "{least} {expected}");
        }
    }

    /// A failed solution, or one that is not a number, is no eigenvalue: such a balance must not count as lasting.
    #[test]
    fn what_cannot_be_solved_has_no_eigenvalue() {
        let start = || {
            (1..4)
                .map(|k| Vec3::new(f64::from(k), 1.0, 0.5))
                .collect::<Vec<_>>()
        };
        let failed = |_: &mut [Vec3]| false;
        assert_eq!(least_real_part(failed, &[1.0; 3], 1.0, start()), None);
        let lost = |x: &mut [Vec3]| {
            x.fill(Vec3::repeat(f64::NAN));
            true
        };
        assert_eq!(least_real_part(lost, &[1.0; 3], 1.0, start()), None);
    }

    /// Diagonal stiffnesses 1 and 2, and a point that nothing holds: with its weight its zero is the least, without it 1 is.
    #[test]
    fn what_nothing_holds_takes_no_part() {
        let (shift, stiffness) = (0.5, [1.0, 2.0, 0.0]);
        let solve = |x: &mut [Vec3]| {
            for (x, stiffness) in x.iter_mut().zip(stiffness) {
                *x /= stiffness + shift;
            }
            true
        };
        for (weight, expected) in [(1.0, 0.0), (0.0, 1.0)] {
            let start = (1..4).map(|k| Vec3::new(f64::from(k), 1.0, 0.5)).collect();
            let least = least_real_part(solve, &[1.0, 1.0, weight], shift, start).unwrap();
            assert!((least - expected).abs() < 1e-9, "{least} {expected}");
        }
    }
}
