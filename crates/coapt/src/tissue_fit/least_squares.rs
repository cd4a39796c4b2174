//! Least squares of nominal stress: exact in two moduli, by descent in six constants.

use nalgebra::{Matrix6, Vector6};

use super::BiaxialPoint;
use super::lattice::{nominal_stress_mpa, parts, sum};
use crate::scene::SpringBranches;

/// The two moduli [MPa] of isotropic springs with a given transition strain that follow the points best, and the sum of the
/// squared errors, in squared MPa. Neither is negative.
pub(super) fn two_moduli(
    points: &[BiaxialPoint],
    knee: f64,
    compression_modulus_ratio: f64,
) -> ([f64; 2], f64) {
    let branch = |strain: f64| parts(strain, knee, compression_modulus_ratio);
    two_factors(points, |stretch| {
        [
            sum(stretch, |_, strain| branch(strain).0),
            sum(stretch, |_, strain| branch(strain).1),
        ]
    })
}

/// The same, but of tissue that does not soften: where the stiff modulus would be less, both are one.
pub(super) fn two_moduli_that_stiffen(
    points: &[BiaxialPoint],
    knee: f64,
    compression_modulus_ratio: f64,
) -> ([f64; 2], f64) {
    let (moduli, error) = two_moduli(points, knee, compression_modulus_ratio);
    if moduli[0] <= moduli[1] {
        return (moduli, error);
    }
    let ([modulus, _], error) = two_factors(points, |stretch| {
        let alike = |_, strain| {
            let (soft, stiff) = parts(strain, knee, compression_modulus_ratio);
            soft + stiff
        };
        [sum(stretch, alike), [0.0; 2]]
    });
    ([modulus; 2], error)
}

/// The two factors [MPa], neither negative, of a sum of two nominal stresses [1] that follows the points best, and the sum of
/// the squared errors, in squared MPa.
pub(super) fn two_factors(
    points: &[BiaxialPoint],
    stresses: impl Fn([f64; 2]) -> [[f64; 2]; 2],
) -> ([f64; 2], f64) {
    let (mut matrix, mut vector, mut square) = ([[0.0; 2]; 2], [0.0; 2], 0.0);
    for point in points {
        let [first, second] = stresses(point.stretch);
        for axis in 0..2 {
            let (row, stress) = ([first[axis], second[axis]], point.nominal_stress_mpa[axis]);
            for i in 0..2 {
                (0..2).for_each(|j| matrix[i][j] += row[i] * row[j]);
                vector[i] += row[i] * stress;
            }
            square += stress * stress;
        }
    }
    let moduli = solve(&matrix, &vector);
    let quadratic: f64 = (0..2)
        .map(|i| moduli[i] * (matrix[i][0] * moduli[0] + matrix[i][1] * moduli[1]))
        .sum();
    let linear = moduli[0] * vector[0] + moduli[1] * vector[1];
    (moduli, square - 2.0 * linear + quadratic)
}

/// Of two unknowns that must not be negative: where one would be, the other alone.
fn solve(matrix: &[[f64; 2]; 2], vector: &[f64; 2]) -> [f64; 2] {
    let determinant = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
    let alone = |i: usize| {
        if matrix[i][i] > 0.0 {
            (vector[i] / matrix[i][i]).max(0.0)
        } else {
            0.0
        }
    };
    if determinant <= 1e-14 * matrix[0][0] * matrix[1][1] {
        return [alone(0), 0.0];
    }
    let first = (vector[0] * matrix[1][1] - vector[1] * matrix[0][1]) / determinant;
    let second = (vector[1] * matrix[0][0] - vector[0] * matrix[1][0]) / determinant;
    match (first < 0.0, second < 0.0) {
        (true, _) => [0.0, alone(1)],
        (_, true) => [alone(0), 0.0],
        _ => [first, second],
    }
}

/// Parts of the longest strain in each direction at which transition strains start.
const STARTS: [f64; 3] = [0.5, 0.7, 0.9];

/// A constant that goes from its start by a factor of e counts as much as an error of this part of the stress everywhere [1].
/// Springs at 45 degrees bear in both directions, and very different sixes of constants follow one curve to within a half of
/// a percent of each other: without, the posterior leaflet gets a stiff modulus of 20 MPa towards the margin and none around
/// the valve.
const HELD: f64 = 0.02;

/// Ties are let go where that leaves less than this part of the squared error [1]: half the error. Then the curve tells.
const LET_GO: f64 = 0.25;

/// The six constants of springs with a direction: logarithms of soft modulus, transition strain and stiff modulus, along and
/// across.
pub(super) fn descend(points: &[BiaxialPoint], compression_modulus_ratio: f64) -> [SpringBranches; 2] {
    let residual = |logarithms: &Vector6<f64>| -> Vec<f64> {
        let branches = branches(logarithms);
        let error = |point: &BiaxialPoint| {
            let found = nominal_stress_mpa(&branches, compression_modulus_ratio, point.stretch);
            [0, 1].map(|axis| found[axis] - point.nominal_stress_mpa[axis])
        };
        points.iter().flat_map(error).collect()
    };
    let squares = points
        .iter()
        .flat_map(|point| point.nominal_stress_mpa)
        .map(|stress| stress * stress);
    let held_mpa = HELD * squares.sum::<f64>().sqrt();
    let starts = STARTS.iter().flat_map(|&a| STARTS.map(|b| start(points, [a, b])));
    let ends = starts.map(|start| {
        let with_ties = |logarithms: &Vector6<f64>| {
            let mut residual = residual(logarithms);
            residual.extend((logarithms - start).iter().map(|way| held_mpa * way));
            residual
        };
        levenberg_marquardt(&with_ties, start)
    });
    let tied = ends.min_by(|a, b| a.1.total_cmp(&b.1));
    let tied = tied.map_or_else(Vector6::zeros, |(logarithms, _)| logarithms);
    let (free, error) = levenberg_marquardt(&residual, tied);
    let tied_error: f64 = residual(&tied).iter().map(|r| r * r).sum();
    branches(if error < LET_GO * tied_error { &free } else { &tied })
}

fn branches(logarithms: &Vector6<f64>) -> [SpringBranches; 2] {
    [0, 3].map(|first| SpringBranches {
        pre_transition_modulus_mpa: logarithms[first].exp(),
        transition_strain: logarithms[first + 1].exp(),
        post_transition_modulus_mpa: logarithms[first + 2].exp(),
    })
}

/// Each direction by itself as if stretched alike in both, with its transition at a part of its longest strain.
fn start(points: &[BiaxialPoint], parts: [f64; 2]) -> Vector6<f64> {
    let mut logarithms = Vector6::zeros();
    for axis in 0..2 {
        let alike = |point: &BiaxialPoint| BiaxialPoint {
            stretch: [point.stretch[axis]; 2],
            nominal_stress_mpa: [point.nominal_stress_mpa[axis]; 2],
        };
        let alike: Vec<BiaxialPoint> = points.iter().map(alike).collect();
        let longest = alike
            .iter()
            .map(|point| point.stretch[0] - 1.0)
            .fold(1e-3, f64::max);
        let knee = parts[axis] * longest;
        let ([soft, stiff], _) = two_moduli(&alike, knee, 1.0);
        let most_mpa = alike
            .iter()
            .map(|point| point.nominal_stress_mpa[0])
            .fold(1e-9, f64::max);
        // By itself a direction may ask for no soft springs at all; a twentieth of the mean slope is a start.
        let positive = |modulus: f64| modulus.max(0.05 * most_mpa / longest).ln();
        logarithms[3 * axis] = positive(soft);
        logarithms[3 * axis + 1] = knee.ln();
        logarithms[3 * axis + 2] = positive(stiff);
    }
    logarithms
}

/// Change of a logarithm for a derivative: half the digits.
const DIFFERENCE: f64 = 1e-7;

/// Steps at most; from the starts above 10 to 60 are enough.
const STEPS: u32 = 300;

/// Longest change of a logarithm in a step: a factor of e.
const LONGEST: f64 = 1.0;

fn levenberg_marquardt(
    residual: &impl Fn(&Vector6<f64>) -> Vec<f64>,
    mut here: Vector6<f64>,
) -> (Vector6<f64>, f64) {
    let square = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    let mut r = residual(&here);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let (matrix, vector) = equations(residual, &here, &r);
        let mut damped = matrix;
        // Where a constant does nothing, a trace of the others' scale keeps the matrix regular.
        (0..6).for_each(|k| damped[(k, k)] += damping * (matrix[(k, k)] + 1e-9 * matrix.trace()));
        let Some(factor) = damped.cholesky() else { break };
        let step = -factor.solve(&vector);
        let step = step.map(|change: f64| change.clamp(-LONGEST, LONGEST));
        let next = here + step;
        let next_r = residual(&next);
        if square(&next_r) < square(&r) {
            (here, r) = (next, next_r);
            damping *= 0.2;
        } else {
            damping *= 5.0;
        }
        if step.amax() < 1e-10 || damping > 1e12 {
            break;
        }
    }
    let error = square(&r);
    (here, error)
}

fn equations(
    residual: &impl Fn(&Vector6<f64>) -> Vec<f64>,
    here: &Vector6<f64>,
    r: &[f64],
) -> (Matrix6<f64>, Vector6<f64>) {
    let slope = |k: usize| -> Vec<f64> {
        let mut moved = *here;
        moved[k] += DIFFERENCE;
        let moved = residual(&moved);
        moved
            .iter()
            .zip(r)
            .map(|(there, here)| (there - here) / DIFFERENCE)
            .collect()
    };
    let slopes: Vec<Vec<f64>> = (0..6).map(slope).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    (
        Matrix6::from_fn(|i, j| dot(&slopes[i], &slopes[j])),
        Vector6::from_fn(|i, _| dot(&slopes[i], r)),
    )
}
